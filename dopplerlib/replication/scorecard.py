"""Scorecards: the verdicts on all claims of a document, as tables."""

from collections import Counter

from .. import _checks
from .._records import record
from ._cells import badge, flips, link, ours, place, published, table
from .claims import VERDICTS, Claim, check_claim
from .verdicts import Judgment

_COUNTED_APART = {
    "arithmetic": "Arithmetic on published numbers, which cannot fail:",
    "misprint": "Misprints:",
    "follows": "What follows: assumptions, demands, and inferences of this book:",
}


@record
class Scorecard:
    """Judgments, shown as tables with links to the cells behind them.

    Attributes
    ----------
    judgments : tuple of Judgment
        As `judge_all` or `read_judgments` returns them.

    Raises
    ------
    ValueError
        If one is no `Judgment` of a `Claim`, or holds what neither may.

    Examples
    --------
    >>> from dopplerlib.replication.claims import Claim
    >>> from dopplerlib.replication.verdicts import judge
    >>> claim = Claim("pi", "Sec 1", "the circle's number", "number", "reproduced",
    ...               "page", "cell", "test", ("3.14",), published=3.14, rounding=0.005)
    >>> Scorecard([judge(claim, 3.14159)]).counts
    {'reproduced': 1}
    """

    judgments: tuple

    def __post_init__(self):
        """Check the fields."""
        judgments = _checks.records("judgments", self.judgments, Judgment)
        _checks.records("claims of judgments", [one.claim for one in judgments], Claim)
        for one in judgments:
            check_claim(f"judgments, claim {one.claim.id!r},", one.claim)
            _checks.one_of("verdict of judgments", one.verdict, VERDICTS)
        object.__setattr__(self, "judgments", judgments)

    @property
    def counts(self) -> dict[str, int]:
        """Number of results by verdict, in the order of the verdicts.

        Without arithmetic, misprints, other kinds of statements, and surrogates.
        """
        return _counts(self._groups().get("", []))

    def __repr__(self):
        lines = []
        for group, judgments in self._groups().items():
            total = ", ".join(f"{count} {verdict}" for verdict, count in _counts(judgments).items())
            told = f" ({group})" if group else ""
            lines.append(f"{len(judgments)} claims{told}: {total}")
        return "\n".join([*lines, *self._turned()]) or "0 claims"

    def _repr_markdown_(self):
        parts = []
        for group, judgments in self._groups().items():
            if group:
                on = f"On {group}; these verdicts do not count above:"
                parts.append(_COUNTED_APART.get(group, on))
            parts.append(table(("claim", "published", "ours"), map(_row, judgments)))
        return "\n\n".join([*parts, *self._turned()])

    def _turned(self):
        """Return a line on the verdicts that would change beyond the ranges of our choices."""
        tried = [one for one in self.judgments if any(point.beyond for point in one.points)]
        if not tried:
            return []
        turned = ", ".join(one.claim.id for one in tried if one.turned)
        return [
            f"Beyond the declared ranges {len(tried)} verdicts were tried; these would change: "
            f"{turned or 'none'}"
        ]

    def _groups(self):
        """Return the judgments by what they count as; the findings of the document come first."""
        groups: dict[str, list[Judgment]] = {name: [] for name in ("", *_COUNTED_APART)}
        for one in self.judgments:
            groups.setdefault(_group(one.claim), []).append(one)
        return {name: found for name, found in groups.items() if found}


def _group(claim):
    if claim.surrogate:
        return claim.surrogate
    if claim.kind != "result":
        return "follows"
    return "" if claim.weight == "finding" else claim.weight


def _counts(judgments):
    counts = Counter(one.verdict for one in judgments)
    return {verdict: counts[verdict] for verdict in VERDICTS if counts[verdict]}


def _row(judgment):
    claim = judgment.claim
    # The first sentence is what is claimed; others tell how it was made measurable.
    first, stop, rest = claim.statement.partition(". ")
    kind = "" if claim.kind == "result" else f" ({claim.kind})"
    anchor = f'<span id="claim-{claim.id}"></span>'
    said = [f"{anchor}{badge('verdict', judgment.verdict)} {claim.where}{kind}"]
    said.append(f"**{first}{stop.strip()}** {rest}".strip())
    if claim.premises:
        said.append(f"Provided that: {claim.premises}")
    if claim.note:
        said.append(claim.note)
    test = claim.test.split("::")[-1].replace("_", " ")
    shown = f'<a href="{claim.page}.html#cell-judged">number</a>'
    said.append(f'{shown} · {link(claim)} · <span class="test">{test}</span>')
    found = [ours(judgment)]
    if judgment.nearest.percentile is not None:
        found.append(f"published at the percentile {judgment.nearest.percentile}")
    if judgment.nearest.at:
        found.append(f"nearest at {place(judgment.nearest.at)}")
    return "<br>".join(said), published(judgment), "<br>".join(found + flips(judgment))
