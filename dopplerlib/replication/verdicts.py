"""Verdicts: comparison of claims with our evidence."""

from collections.abc import Iterable
from reprlib import repr as short
from typing import Any

import numpy as np

from .. import _checks
from .._records import record
from .._typing import ArrayLike
from ..evaluation.intervals import ConfidenceInterval, proportion_interval
from .choices import Choice, check_choice
from .claims import OPEN, VERDICTS, Claim, check_claim
from .evidence import Draws, Sweep, combinations

# Share of our runs that a typical draw leaves on either side of it.
_TAIL = 0.025
# An interval of 95 % this many times as wide is left once in ten thousand: another seed agrees.
_WIDER = 2

_HOLDS = {"<": np.less, "<=": np.less_equal, ">": np.greater, ">=": np.greater_equal}
_BEST_FIRST = ("reproduced", "typical", "undecided", "atypical", "contradicted")
_OF_OTHERS = {
    "reproduced": "holds",
    "typical": "holds",
    "atypical": "fails",
    "contradicted": "fails",
}


@record
class Point:
    """One comparison: for one value of each choice.

    Attributes
    ----------
    at : dict
        Value of each choice, by its name; the choice of the limit is the last one.
    verdict : str
        See `judge`.
    ours : ConfidenceInterval or float or ndarray
        Our number; of a random run the median, with the interval in which 95 % of ours lie.
    published : float or tuple of float
        The number that it was compared with.
    percentile : ConfidenceInterval, optional
        Share of our runs below the published one, in percent, with its Monte Carlo interval.
    beyond : bool
        Whether a value lies beyond its declared range, so that the verdict does not count.

    Raises
    ------
    ValueError
        If a field is of another kind, or not finite.
    """

    at: dict
    verdict: str
    ours: ConfidenceInterval | float | np.ndarray
    published: float | tuple
    percentile: ConfidenceInterval | None = None
    beyond: bool = False

    def __post_init__(self):
        """Check the fields."""
        for name, value in _checks.instance("at", self.at, dict).items():
            _checks.text("at", name, least=1)
            if not isinstance(value, str):
                _checks.one_number(f"at {name}", value)
        _checks.one_of("verdict", self.verdict, VERDICTS)
        for name in ("ours", "percentile"):
            value = getattr(self, name)
            if isinstance(value, ConfidenceInterval):
                _checks.finite(name, [value.value, value.low, value.high])
            elif name == "ours":
                _check_numbers(name, value)
            elif value is not None:
                raise ValueError(f"{name} must be a ConfidenceInterval, got {short(value)}")
        _check_numbers("published", self.published)
        shapes = np.shape(self.published), np.shape(self.ours)
        if not isinstance(self.ours, ConfidenceInterval) and shapes[0] != shapes[1]:
            raise ValueError(f"ours must have the shape of published, {shapes[0]}, got {shapes[1]}")
        _checks.one_boolean("beyond", self.beyond)


@record
class Judgment:
    """A verdict, with the claim and all comparisons behind it.

    Attributes
    ----------
    claim : Claim
        The claim.
    verdict : str
        See `judge`.
    points : tuple of Point
        For every combination of what the claim leaves open; one if it leaves nothing open.

    Raises
    ------
    ValueError
        If a field is of another kind, or no point lies inside the declared ranges.
    """

    claim: Claim
    verdict: str
    points: tuple

    def __post_init__(self):
        """Check the fields."""
        check_claim("claim", self.claim)
        _checks.one_of("verdict", self.verdict, VERDICTS)
        points = _checks.records("points", self.points, Point)
        if all(one.beyond for one in points):
            raise ValueError("points must hold one inside the declared ranges, got none")
        if len({tuple(one.at) for one in points}) > 1:
            raise ValueError("points must be for the same choices, got others")
        object.__setattr__(self, "points", points)

    @property
    def nearest(self) -> Point:
        """The comparison in the declared range that is kindest to the document."""
        return min((one for one in self.points if not one.beyond), key=_distance)

    @property
    def flips(self) -> dict[str, dict[str, tuple[Any, ...]]]:
        """For each choice on which the verdict hangs, its values by the verdicts found at them.

        Verdicts that differ among the other choices are joined with "or".
        """
        within = [one for one in self.points if not one.beyond]
        found: dict[str, dict[str, tuple[Any, ...]]] = {}
        for name in within[0].at:
            by_value: dict[Any, dict[str, None]] = {}
            for one in within:
                by_value.setdefault(one.at[name], {})[one.verdict] = None
            if len({frozenset(verdicts) for verdicts in by_value.values()}) > 1:
                table: dict[str, tuple[Any, ...]] = {}
                for value, verdicts in by_value.items():
                    label = " or ".join(sorted(verdicts))
                    table[label] = (*table.get(label, ()), value)
                found[name] = table
        return found

    @property
    def turned(self) -> tuple[Point, ...]:
        """Comparisons beyond the declared ranges that would change the verdict."""
        within = [one.verdict for one in self.points if not one.beyond]
        return tuple(
            one
            for one in self.points
            if one.beyond and _together([*within, one.verdict]) != self.verdict
        )


def judge(claim: Claim, evidence: ArrayLike | Sweep, choices: Iterable[Choice] = ()) -> Judgment:
    """Compare a claim with the evidence.

    Parameters
    ----------
    claim : Claim
        The claim.
    evidence : float, array_like, ConfidenceInterval, Draws or Sweep
        Our number (as many as are published); a `ConfidenceInterval`, or a float without
        uncertainty, for a relation or a size; `Draws` for a random run. A `Sweep` holds one of
        these for each combination of the choices that the claim names.
    choices : iterable of Choice
        Those that the claim names, and any others.

    Returns
    -------
    Judgment

    Raises
    ------
    ValueError
        If the claim is one that `read_claims` refuses, the evidence is not of the kind that it
        needs, is NaN or an interval with its ends in the wrong order, the published number is
        missing or given twice, a choice is not among `choices`, or a sweep leaves out a
        combination of their values.

    Notes
    -----
    * *reproduced*: a number within its rounding; a relation that holds, or a size within its
      factor, on the whole interval of our estimate.
    * *typical*, *atypical*: a random outcome inside or outside the central 95 % of ours.
    * *contradicted*: any other number; a relation or size that holds nowhere on the interval.
    * *undecided*: our runs are too few to tell.
    * *underdetermined*: what the document leaves open leads to different verdicts.

    What is decided stays so on an interval of twice the width of 95 %. For other kinds of
    statements than results, *holds* stands for the first two words and *fails* for the next two.

    Examples
    --------
    >>> from dopplerlib.replication.claims import Claim
    >>> claim = Claim("pi", "Sec 1", "the circle's number", "number", "reproduced",
    ...               "page", "cell", "test", ("3.14",), published=3.14, rounding=0.005)
    >>> judge(claim, 3.14159).verdict
    'reproduced'
    """
    check_claim(f"claim {getattr(claim, 'id', None)!r}", claim)
    known = {one.id: one for one in _checks.records("choices", choices, Choice)}
    axes = [_choice(claim, name, known) for name in claim.choices]
    limit = None if claim.limit is None else _choice(claim, claim.limit, known)
    points = []
    for at, piece in _pieces(claim, evidence, axes):
        outside = any(at[one.id] in one.beyond for one in axes)
        if limit is None:
            points.append(_point(claim, piece, at, None, outside))
            continue
        for value in limit.values + (() if outside else limit.beyond):
            there = at | {limit.id: value}
            points.append(_point(claim, piece, there, value, outside or value in limit.beyond))
    verdict = _together([one.verdict for one in points if not one.beyond])
    return Judgment(claim, verdict, points)


def judge_all(
    claims: Iterable[Claim], evidence: dict[str, Any], choices: Iterable[Choice] = ()
) -> tuple[Judgment, ...]:
    """Compare all claims of a document with the evidence.

    Parameters
    ----------
    claims : iterable of Claim
        As `read_claims` returns them.
    evidence : dict
        Evidence by the id of the claim, for each of them and no others.
    choices : iterable of Choice
        As `read_choices` returns them.

    Returns
    -------
    tuple of Judgment
        In the order of the claims.

    Raises
    ------
    ValueError
        If a claim has no evidence, evidence has no claim, or the two do not fit; see `judge`.

    Examples
    --------
    A count of 7 that 500 runs of ours spread about, and one that they do not reach:

    >>> from dopplerlib.replication.claims import Claim
    >>> claims = [Claim(name, "Sec 1", "a count", "draw", "typical", "page", "cell", "test",
    ...                 ("7",), published=7.0) for name in ("near", "far")]
    >>> counts = np.arange(500) % 50
    >>> evidence = {"near": Draws(counts), "far": Draws(100 + counts)}
    >>> [one.verdict for one in judge_all(claims, evidence)]
    ['typical', 'atypical']
    """
    claims = _checks.records("claims", claims, Claim)
    choices = _checks.records("choices", choices, Choice)
    _checks.instance("evidence", evidence, dict)
    names = [_checks.text("id of a claim", claim.id, least=1) for claim in claims]
    for name in names:
        if name not in evidence:
            raise ValueError(f"evidence must hold every claim, got none for {name!r}")
    for name in evidence:
        if name not in names:
            raise ValueError(f"evidence must belong to a claim, got {name!r}, which is none")
    return tuple(judge(claim, evidence[claim.id], choices) for claim in claims)


def _check_numbers(name, value):
    if not _checks.finite(name, value).size:
        raise ValueError(f"{name} must be a number or more, got {short(value)}")


def _choice(claim, name, known):
    if name not in known:
        raise ValueError(f"choices must hold those of {claim.id!r}, got none called {name!r}")
    check_choice(f"choice {name!r}", known[name])
    return known[name]


def _pieces(claim, evidence, axes):
    """Return the values of the choices, by their names, and the evidence for each of them."""
    if not axes:
        return [({}, evidence)]
    if not isinstance(evidence, Sweep):
        raise _wrong(claim, f"a Sweep over {', '.join(claim.choices)}", evidence)
    if tuple(evidence.axes) != claim.choices:
        raise _wrong(claim, f"a Sweep over {', '.join(claim.choices)}", evidence.axes)
    wanted, points = combinations(axes), evidence.points
    if not isinstance(points, dict) or set(points) != set(wanted):
        raise _wrong(claim, f"a Sweep at {wanted}", points)
    return [(dict(zip(claim.choices, at, strict=True)), points[at]) for at in wanted]


def _together(verdicts):
    """Return the verdict over several comparisons."""
    decided = {one for one in verdicts if one not in OPEN}
    if len(decided) > 1:
        return "underdetermined"
    return next((one for one in reversed(OPEN) if one in verdicts), *decided)


def _point(claim, evidence, at, limit, beyond):
    published = _published(claim, evidence, limit)
    judged = {"number": _number, "draw": _draw, "relation": _relation, "size": _size}[claim.form]
    verdict, ours, percentile = judged(claim, evidence, published, limit)
    if claim.kind != "result":
        verdict = _OF_OTHERS.get(verdict, verdict)
    return Point(at, verdict, ours, published, percentile, beyond)


def _number(claim, evidence, published, limit):
    if isinstance(evidence, (ConfidenceInterval, Draws, Sweep)):
        raise _wrong(claim, "a number", evidence)
    ours = _checks.finite(_name(claim), evidence)
    if np.shape(published) != ours.shape:
        raise _wrong(claim, f"numbers of shape {np.shape(published)}", evidence)
    # Half a unit of the last digit, and a little for the rounding of decimal fractions.
    same = np.abs(ours - published) <= claim.rounding * (1 + 1e-9) + 1e-12 * np.abs(published)
    return "reproduced" if same.all() else "contradicted", ours if ours.ndim else float(ours), None


def _draw(claim, draws, published, limit):
    if not isinstance(draws, Draws):
        raise _wrong(claim, "Draws", draws)
    values = _checks.finite(_name(claim), draws.values)
    if values.ndim != 1 or not len(values):
        raise _wrong(claim, "Draws with a number from each run", draws)
    # What is stated as 5.82 may be anything from 5.815 to 5.825.
    below = proportion_interval(values <= published + claim.rounding, 0.999)
    above = proportion_interval(values >= published - claim.rounding, 0.999)
    tail = min(below, above, key=lambda share: share.value)
    verdict = "typical" if tail.value >= _TAIL else "atypical"
    low, middle, high = np.quantile(values, [_TAIL, 0.5, 1 - _TAIL])
    share = proportion_interval(values < published)
    return (
        "undecided" if tail.low < _TAIL < tail.high else verdict,
        ConfidenceInterval(float(middle), float(low), float(high)),
        ConfidenceInterval(100 * share.value, 100 * share.low, 100 * share.high),
    )


def _relation(claim, evidence, published, limit):
    estimate = _estimate(claim, evidence)
    holds = [_HOLDS[claim.relation](end, published) for end in _ends(estimate)]
    return _decided(holds), estimate, None


def _size(claim, evidence, published, factor):
    estimate = _estimate(claim, evidence)
    low, high = sorted((published / factor, published * factor))
    ends = _ends(estimate)
    if ends[0] < low < ends[1] or ends[0] < high < ends[1]:
        return "undecided", estimate, None
    return _decided([low <= end <= high for end in ends]), estimate, None


def _decided(holds):
    if all(holds) or not any(holds):
        return "reproduced" if all(holds) else "contradicted"
    return "undecided"


def _estimate(claim, evidence):
    if isinstance(evidence, (Sweep, Draws)):
        raise _wrong(claim, "a ConfidenceInterval or a float", evidence)
    if not isinstance(evidence, ConfidenceInterval):
        evidence = ConfidenceInterval(*[_checks.one_number(_name(claim), evidence)] * 3)
    if not evidence.low <= evidence.value <= evidence.high:  # as it is not if one is NaN
        raise _wrong(claim, "a ConfidenceInterval whose value lies between its ends", evidence)
    return evidence


def _ends(estimate):
    """Return the ends of an interval about the estimate that other seeds would hardly leave."""
    middle = estimate.value
    return (
        middle - _WIDER * (middle - estimate.low),
        middle + _WIDER * (estimate.high - middle),
    )


def _distance(point):
    """Order comparisons, those first that are kinder to the document."""
    word = {"holds": "reproduced", "fails": "contradicted"}.get(point.verdict, point.verdict)
    ours = point.ours.value if isinstance(point.ours, ConfidenceInterval) else point.ours
    return _BEST_FIRST.index(word), float(np.max(np.abs(np.subtract(ours, point.published))))


def _published(claim, evidence, limit):
    if claim.form == "relation" and claim.limit is not None:
        return limit
    brought = getattr(evidence, "published", None)
    if (claim.published is None) == (brought is None):
        times = "twice" if brought is not None else "not at all"
        raise ValueError(
            f"the published number of {claim.id!r} must be given by the claim or by the "
            f"evidence, got it {times}"
        )
    if brought is None:
        return claim.published
    return _checks.one_number(f"the published number of {claim.id!r}", brought)


def _name(claim):
    return f"the evidence for {claim.id!r}"


def _wrong(claim, wanted, evidence):
    return ValueError(f"{_name(claim)}, a {claim.form}, must be {wanted}, got {short(evidence)}")
