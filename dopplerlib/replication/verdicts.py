"""Verdicts: comparison of claims with our evidence."""

from collections.abc import Iterable
from reprlib import repr as short
from typing import Any

import numpy as np

from .. import _checks
from .._records import record
from .._typing import ArrayLike
from ..evaluation.intervals import ConfidenceInterval, proportion_interval
from .claims import Claim, check_claim
from .readings import Draws, Readings

# Share of our runs that a typical draw leaves on either side of it.
_TAIL = 0.025

_HOLDS = {"<": np.less, "<=": np.less_equal, ">": np.greater, ">=": np.greater_equal}


@record
class Judgment:
    """A verdict, with the claim and the evidence behind it.

    Attributes
    ----------
    claim : Claim
        The claim.
    verdict : str
        See `Claim`.
    ours : ConfidenceInterval or float or ndarray
        Our number; of a random run the median, with the interval in which 95 % of ours lie.
    published : float or tuple of float
        The number that it was compared with.
    percentile : ConfidenceInterval, optional
        Share of our runs below the published one, in percent, with its Monte Carlo interval.
    reading : str, optional
        The reading that comes nearest.
    decided : bool
        Whether the runs were enough: another seed would hardly change the verdict.
    """

    claim: Claim
    verdict: str
    ours: ConfidenceInterval | float | np.ndarray
    published: float | tuple
    percentile: ConfidenceInterval | None = None
    reading: str | None = None
    decided: bool = True


def judge(claim: Claim, evidence: ArrayLike) -> Judgment:
    """Compare a claim with the evidence.

    Parameters
    ----------
    claim : Claim
        The claim.
    evidence : float, array_like, ConfidenceInterval, Draws or Readings
        Our number for a deterministic claim (as many as are published); a `ConfidenceInterval`, or
        a float without uncertainty, for a relation; `Draws` for a random run. `Readings` holds one
        of these for each way to read the claim.

    Returns
    -------
    Judgment

    Raises
    ------
    ValueError
        If the claim is one that `read_claims` refuses, the evidence is not of the kind that it
        needs, is NaN or an interval with its ends in the wrong order, or the published number is
        missing or given twice.

    Notes
    -----
    * *reproduced*: a deterministic number within its rounding; a relation that holds on the whole
      interval of our estimate.
    * *typical*, *atypical*: a random outcome inside or outside the central 95 % of ours.
    * *contradicted*: any other number; a relation that holds nowhere on the interval.
    * *underdetermined*: the readings lead to different verdicts, or the interval of the estimate
      holds the limit.

    Examples
    --------
    >>> from dopplerlib.replication.claims import Claim
    >>> claim = Claim("pi", "Sec 1", "the circle's number", "deterministic", "reproduced",
    ...               "page", "cell", "test", published=3.14, rounding=0.005)
    >>> judge(claim, 3.14159).verdict
    'reproduced'
    """
    check_claim(f"claim {getattr(claim, 'id', None)!r}", claim)
    if isinstance(evidence, Readings):
        return _judge_readings(claim, evidence)
    published = _published(claim, evidence)
    if claim.kind == "random":
        if not isinstance(evidence, Draws):
            raise _wrong(claim, "Draws", evidence)
        return _judge_draw(claim, published, evidence)
    if claim.kind == "relation":
        if isinstance(evidence, (Readings, Draws)):
            raise _wrong(claim, "a ConfidenceInterval or a float", evidence)
        if not isinstance(evidence, ConfidenceInterval):
            evidence = ConfidenceInterval(*[_checks.one_number(_name(claim), evidence)] * 3)
        if not evidence.low <= evidence.value <= evidence.high:  # as it is not if one is NaN
            raise _wrong(claim, "a ConfidenceInterval whose value lies between its ends", evidence)
        return _judge_relation(claim, published, evidence)
    if isinstance(evidence, (ConfidenceInterval, Draws)):
        raise _wrong(claim, "a number", evidence)
    ours = _checks.finite(_name(claim), evidence)
    if np.shape(published) != ours.shape:
        raise _wrong(claim, f"numbers of shape {np.shape(published)}", evidence)
    # Half a unit of the last digit, and a little for the rounding of decimal fractions.
    same = np.abs(ours - published) <= claim.rounding * (1 + 1e-9) + 1e-12 * np.abs(published)
    verdict = "reproduced" if same.all() else "contradicted"
    return Judgment(claim, verdict, ours if ours.ndim else float(ours), published)


def judge_all(claims: Iterable[Claim], evidence: dict[str, Any]) -> tuple[Judgment, ...]:
    """Compare all claims of a document with the evidence.

    Parameters
    ----------
    claims : iterable of Claim
        As `read_claims` returns them.
    evidence : dict
        Evidence by the id of the claim, for each of them and no others.

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
    A count of 7 that 50 runs of ours spread about, and one that they do not reach:

    >>> from dopplerlib.replication.claims import Claim
    >>> claims = [Claim(name, "Sec 1", "a count", "random", "typical", "page", "cell", "test",
    ...                 published=7.0) for name in ("near", "far")]
    >>> evidence = {"near": Draws(np.arange(50.0)), "far": Draws(100 + np.arange(50.0))}
    >>> [one.verdict for one in judge_all(claims, evidence)]
    ['typical', 'atypical']
    >>> judge(claims[0], Readings({"mean": evidence["near"], "sum": evidence["far"]})).verdict
    'underdetermined'
    """
    claims = _checks.records("claims", claims, Claim)
    _checks.instance("evidence", evidence, dict)
    names = [_checks.text("id of a claim", claim.id, least=1) for claim in claims]
    for name in names:
        if name not in evidence:
            raise ValueError(f"evidence must hold every claim, got none for {name!r}")
    for name in evidence:
        if name not in names:
            raise ValueError(f"evidence must belong to a claim, got {name!r}, which is none")
    return tuple(judge(claim, evidence[claim.id]) for claim in claims)


def _judge_draw(claim, published, draws):
    values = _checks.finite(_name(claim), draws.values)
    if values.ndim != 1 or not len(values):
        raise _wrong(claim, "Draws with a number from each run", draws)
    # What is printed as 5.82 may be anything from 5.815 to 5.825.
    below = proportion_interval(values <= published + claim.rounding, 0.999)
    above = proportion_interval(values >= published - claim.rounding, 0.999)
    tail = min(below, above, key=lambda share: share.value)
    low, middle, high = np.quantile(values, [_TAIL, 0.5, 1 - _TAIL])
    share = proportion_interval(values < published)
    return Judgment(
        claim,
        "typical" if tail.value >= _TAIL else "atypical",
        ConfidenceInterval(float(middle), float(low), float(high)),
        published,
        percentile=ConfidenceInterval(100 * share.value, 100 * share.low, 100 * share.high),
        decided=not tail.low < _TAIL < tail.high,
    )


def _judge_relation(claim, limit, estimate):
    holds = _HOLDS[claim.relation]
    at_ends = holds(estimate.low, limit), holds(estimate.high, limit)
    verdict = "underdetermined"
    if all(at_ends) or not any(at_ends):
        verdict = "reproduced" if all(at_ends) else "contradicted"
    # An interval of 95 % that comes this near may hold the limit for another seed.
    near = estimate.value - limit
    room = estimate.value - estimate.low if near > 0 else estimate.high - estimate.value
    return Judgment(
        claim, verdict, estimate, limit, decided=bool(room == 0 or abs(near) > 2 * room)
    )


def _judge_readings(claim, readings):
    if not isinstance(readings.by_name, dict) or len(readings.by_name) < 2:
        raise _wrong(claim, "two Readings or more, in a dict by their names", readings)
    found = {name: judge(claim, one) for name, one in readings.by_name.items()}
    order = ("reproduced", "typical", "underdetermined", "atypical", "contradicted")
    nearest = min(
        found, key=lambda name: (order.index(found[name].verdict), _distance(found[name]))
    )
    verdicts = {one.verdict for one in found.values()}
    best = found[nearest]
    return Judgment(
        claim,
        best.verdict if len(verdicts) == 1 else "underdetermined",
        best.ours,
        best.published,
        best.percentile,
        nearest,
        all(one.decided for one in found.values()),
    )


def _distance(judgment):
    ours = judgment.ours.value if isinstance(judgment.ours, ConfidenceInterval) else judgment.ours
    return float(np.max(np.abs(np.subtract(ours, judgment.published))))


def _published(claim, evidence):
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
    return ValueError(
        f"{_name(claim)}, a {claim.kind} claim, must be {wanted}, got {short(evidence)}"
    )
