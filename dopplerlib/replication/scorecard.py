"""Scorecards: the verdicts on all claims of a document, as a table."""

from collections import Counter

import numpy as np

from .. import _checks
from .._records import record
from ..evaluation.intervals import ConfidenceInterval
from ._cells import badge, link, table
from .claims import VERDICTS, Claim, check_claim
from .verdicts import Judgment


@record
class Scorecard:
    """Judgments, shown as a table with links to the cells behind them.

    Attributes
    ----------
    judgments : tuple of Judgment
        As `judge_all` returns them.

    Raises
    ------
    ValueError
        If one is no `Judgment` of a `Claim`, or holds what neither may.

    Examples
    --------
    >>> from dopplerlib.replication.claims import Claim
    >>> from dopplerlib.replication.verdicts import judge
    >>> claim = Claim("pi", "Sec 1", "the circle's number", "deterministic", "reproduced",
    ...               "page", "cell", "test", published=3.14, rounding=0.005)
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
        """Number of claims by verdict, in the order of the verdicts; without surrogates."""
        return _counts(self._groups().get("", []))

    def __repr__(self):
        lines = []
        for surrogate, judgments in self._groups().items():
            total = ", ".join(f"{count} {verdict}" for verdict, count in _counts(judgments).items())
            on = f" on {surrogate}" if surrogate else ""
            lines.append(f"{len(judgments)} claims{on}: {total}")
        return "\n".join(lines) or "0 claims"

    def _repr_markdown_(self):
        parts = []
        for surrogate, judgments in self._groups().items():
            if surrogate:
                parts.append(f"On {surrogate}; these verdicts do not count above:")
            parts.append(table(("claim", "published", "ours"), map(_row, judgments)))
        return "\n\n".join(parts)

    def _groups(self):
        """Return the judgments by surrogate; those on the document itself come first."""
        groups = {}
        for one in sorted(self.judgments, key=lambda one: one.claim.surrogate != ""):
            groups.setdefault(one.claim.surrogate, []).append(one)
        return groups


def _counts(judgments):
    counts = Counter(one.verdict for one in judgments)
    return {verdict: counts[verdict] for verdict in VERDICTS if counts[verdict]}


def _row(judgment):
    claim = judgment.claim
    # The first sentence is what is claimed; others tell how it was made measurable.
    first, stop, rest = claim.statement.partition(". ")
    said = [f"{badge('verdict', judgment.verdict)} {claim.where}"]
    said.append(f"**{first}{stop.strip()}** {rest}".strip())
    if claim.note:
        said.append(claim.note)
    test = claim.test.split("::")[-1].replace("_", " ")
    said.append(f'{link(claim)} · <span class="test">{test}</span>')
    relation = f"{claim.relation} " if claim.relation else ""
    published = f"{relation}{_number(judgment.published)} {claim.unit}".strip()
    ours = [f"{_number(judgment.ours)} {claim.unit}".strip()]
    if judgment.percentile is not None:
        ours.append(f"published at the percentile {judgment.percentile}")
    if judgment.reading is not None:
        ours.append(f"nearest reading: {judgment.reading}")
    return "<br>".join(said), published, "<br>".join(ours)


def _number(value):
    if isinstance(value, ConfidenceInterval):
        return f"{value.value:.3g}" if value.low == value.high else str(value)
    return ", ".join(f"{one:.4g}" for one in np.atleast_1d(value))
