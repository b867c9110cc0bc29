"""The verdicts on all claims of a document, as a table for a page."""

from collections import Counter

import numpy as np

from .. import _checks
from .._records import record
from ..evaluation.intervals import ConfidenceInterval
from .claims import VERDICTS
from .verdicts import Judgment


@record
class Scorecard:
    """Judgments that a notebook shows as a table, with links to the cells behind them.

    Attributes
    ----------
    judgments : tuple of Judgment
        As `judge_all` returns them.

    Raises
    ------
    ValueError
        If one is no `Judgment`.

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
        object.__setattr__(self, "judgments", judgments)

    @property
    def counts(self) -> dict[str, int]:
        """Number of claims by verdict, in the order of the verdicts."""
        counts = Counter(one.verdict for one in self.judgments)
        return {verdict: counts[verdict] for verdict in VERDICTS if counts[verdict]}

    def __repr__(self):
        total = ", ".join(f"{count} {verdict}" for verdict, count in self.counts.items())
        return f"{len(self.judgments)} claims: {total}"

    def _repr_markdown_(self):
        head = ["| claim | published | ours |", "|---|---|---|"]
        return "\n".join(head + [_row(one) for one in self.judgments])


def _row(judgment):
    claim = judgment.claim
    badge = f'<span class="verdict verdict-{judgment.verdict}">{judgment.verdict}</span>'
    # The first sentence is what is claimed; others tell how it was made measurable.
    first, stop, rest = claim.statement.partition(". ")
    told = [f"{badge} {claim.where}", f"**{first}{stop.strip()}** {rest}".strip()]
    if claim.note:
        told.append(claim.note)
    told.append(
        f'<a href="{claim.page}.html#cell-{claim.cell}">{claim.page.replace("_", " ")}</a> · '
        f'<span class="test">{claim.test.split("::")[-1].replace("_", " ")}</span>'
    )
    relation = f"{claim.relation} " if claim.relation else ""
    published = f"{relation}{_number(judgment.published)} {claim.unit}".strip()
    ours = [f"{_number(judgment.ours)} {claim.unit}".strip()]
    if judgment.percentile is not None:
        ours.append(f"published at the percentile {judgment.percentile}")
    if judgment.reading is not None:
        ours.append(f"nearest reading: {judgment.reading}")
    cells = "<br>".join(told), published, "<br>".join(ours)
    return f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |"


def _number(value):
    if isinstance(value, ConfidenceInterval):
        return f"{value.value:.3g}" if value.low == value.high else str(value)
    return ", ".join(f"{one:.4g}" for one in np.atleast_1d(value))
