"""Judgments on record: written once, read by every page that shows a verdict."""

import json
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from .. import _checks
from .._data import read_json, results
from .._records import record
from ..evaluation.intervals import ConfidenceInterval
from ._cells import badge, flips, ours, published, table
from .claims import Claim
from .documents import documents, read_document
from .verdicts import Judgment, Point

_DIGITS = 8  # of a number on record: more than a page shows, fewer than processors differ in
_ENDS = ("value", "low", "high")


def judgments_text(judgments: Iterable[Judgment], seed: int) -> str:
    """Return judgments as the text of the file that `read_judgments` reads.

    Parameters
    ----------
    judgments : iterable of Judgment
        As `judge_all` returns them.
    seed : int
        Of all noise behind them.

    Returns
    -------
    str
        JSON with a line for each comparison.

    Raises
    ------
    ValueError
        If one is no `Judgment`, or `seed` is no whole number.

    Examples
    --------
    >>> from dopplerlib.replication.documents import read_document
    >>> '"judgments"' in judgments_text(read_judgments("valarmathi"), 2016)
    True
    """
    judgments = _checks.records("judgments", judgments, Judgment)
    seed = _checks.whole_number("seed", seed, 0)
    entries = []
    for one in judgments:
        points = ",\n".join("      " + json.dumps(_packed(point)) for point in one.points)
        entries.append(
            f'    {json.dumps(one.claim.id)}: {{"verdict": {json.dumps(one.verdict)}, '
            f'"points": [\n{points}\n    ]}}'
        )
    inside = ",\n".join(entries)
    return f'{{\n  "seed": {seed},\n  "judgments": {{\n{inside}\n  }}\n}}\n'


def read_judgments(document: str) -> tuple[Judgment, ...]:
    """Read the judgments on all claims of a document, as ``make judge`` wrote them.

    Parameters
    ----------
    document : str
        One of `documents`.

    Returns
    -------
    tuple of Judgment
        In the order of the claims.

    Raises
    ------
    ValueError
        If there is no such document.

    Examples
    --------
    >>> read_judgments("mittermaier2016")[0].claim.id
    'sensitivity'
    """
    return _read(document, _claims(document))


def _claims(document):
    return read_document(_checks.one_of("document", document, documents())).claims


def _read(document, claims):
    """Return the judgments on some claims of a document, as far as there are any."""
    found = read_json(f"{document}.verdicts.json", folder=results)["judgments"]
    return tuple(
        Judgment(
            claim,
            found[claim.id]["verdict"],
            tuple(Point(**_unpacked(point)) for point in found[claim.id]["points"]),
        )
        for claim in claims
        if claim.id in found
    )


@record
class PageVerdicts:
    """Judgments on the claims that a page tries, shown as a table.

    Attributes
    ----------
    document : str
        One of `documents`.
    judgments : tuple of Judgment
        On its claims.

    Raises
    ------
    ValueError
        If there is no such document, or one is no `Judgment`.

    Examples
    --------
    >>> len(PageVerdicts("valarmathi", read_judgments("valarmathi")[:2]).judgments)
    2
    """

    document: str
    judgments: tuple

    def __post_init__(self):
        """Check the fields."""
        _checks.one_of("document", self.document, documents())
        judgments = _checks.records("judgments", self.judgments, Judgment)
        _checks.records("claims of judgments", [one.claim for one in judgments], Claim)
        object.__setattr__(self, "judgments", judgments)

    def __repr__(self):
        lines = []
        for one in self.judgments:
            lines.append(f"{one.claim.id}: {one.verdict}")
            lines.append(f"  published {published(one)}, ours {ours(one)}")
            lines += [f"  {line}" for line in flips(one)]
        return "\n".join(lines)

    def _repr_markdown_(self):
        rows = []
        for one in self.judgments:
            claim = one.claim
            said = claim.statement.partition(". ")[0].strip(".")
            row = f"scorecard_{self.document}.html#claim-{claim.id}"
            links = f'<a href="{row}">row</a> · <a href="#cell-{claim.cell}">cell</a>'
            word = "<br>".join([badge("verdict", one.verdict), *flips(one)])
            rows.append((f"{said}.<br>{links}", published(one), ours(one), word))
        return table(("claim", "published", "ours", "verdict"), rows)


def verdicts_on_page(document: str, page: str) -> PageVerdicts:
    """Return the judgments on the claims of a document that one page of the book tries.

    Parameters
    ----------
    document : str
        One of `documents`.
    page : str
        Name of a page, as the claims have it.

    Returns
    -------
    PageVerdicts

    Raises
    ------
    ValueError
        If there is no such document, or none of its claims is on such a page.

    Examples
    --------
    >>> one = verdicts_on_page("mittermaier2016", "geometry").judgments[0]
    >>> one.claim.id, one.verdict
    ('sensitivity', 'reproduced')
    """
    claims = _claims(document)
    _checks.one_of("page", page, tuple(sorted({claim.page for claim in claims})))
    return PageVerdicts(document, _read(document, [one for one in claims if one.page == page]))


def _packed(point) -> dict[str, Any]:
    """Return the fields of a comparison that say something."""
    fields = {"at": dict(point.at), "verdict": point.verdict, "ours": _plain(point.ours)}
    fields["published"] = _plain(point.published)
    if point.percentile is not None:
        fields["percentile"] = _plain(point.percentile)
    if point.beyond:
        fields["beyond"] = True
    return fields


def _plain(value):
    if isinstance(value, ConfidenceInterval):
        return {name: _plain(getattr(value, name)) for name in _ENDS}
    return _rounded(np.asarray(value, float)).tolist()


def _rounded(values):
    with np.errstate(divide="ignore"):
        places = _DIGITS - 1 - np.floor(np.log10(np.abs(values)))
    return np.vectorize(lambda one, most: round(one, int(most)) if one else 0.0, otypes=[float])(
        values, np.where(np.isfinite(places), places, 0)
    )


def _unpacked(fields: Mapping[str, Any]) -> dict[str, Any]:
    made = dict(fields)
    for name in ("ours", "published", "percentile"):
        value = made.get(name)
        if isinstance(value, dict):
            made[name] = ConfidenceInterval(*(value[end] for end in _ENDS))
        elif isinstance(value, list):
            made[name] = np.array(value) if name == "ours" else tuple(value)
    return made
