"""Common parts of the tables of claims, sentences and documented deviations, in Markdown."""

import numpy as np

from ..evaluation.intervals import ConfidenceInterval


def badge(kind, word):
    """Return a word in a frame whose color is that of its kind."""
    return f'<span class="verdict {kind}-{word}">{word}</span>'


def link(entry):
    """Return the link to the cell of a chapter that a record names."""
    return f'<a href="{entry.page}.html#cell-{entry.cell}">computation</a>'


def table(head, rows):
    """Return a table; a bar inside a cell, as in a formula, does not end it."""
    lines = [head, ["---"] * len(head)]
    lines += [[cell.replace("|", r"\|") for cell in row] for row in rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def published(judgment):
    """Return the number, or the range of limits, that a claim was compared with."""
    claim = judgment.claim
    values = {number(one.published): None for one in judgment.points if not one.beyond}
    several = (
        f"{next(iter(values))} to {list(values)[-1]}" if len(values) > 1 else next(iter(values))
    )
    if claim.form == "size":
        factors = [number(one.at[claim.limit]) for one in judgment.points if not one.beyond]
        several += f" within a factor of {' to '.join(dict.fromkeys((factors[0], factors[-1])))}"
    relation = f"{claim.relation} " if claim.relation else ""
    return f"{relation}{several} {claim.unit}".strip()


def ours(judgment):
    """Return our number at the nearest comparison."""
    return f"{number(judgment.nearest.ours)} {judgment.claim.unit}".strip()


def flips(judgment):
    """Return lines on the choices that turn the verdict, or on the range for which it stands."""
    claim, lines = judgment.claim, []
    for name, by_verdict in judgment.flips.items():
        parts = [f"{verdict} ({_values(values)})" for verdict, values in by_verdict.items()]
        lines.append(f"{name}: {'; '.join(parts)}")
    if claim.limit is not None and claim.form == "relation":
        found = sorted(_middle(one.ours) for one in judgment.points if not one.beyond)
        turns = [f"{one:.3g}" for one in (found[0], found[-1])]
        lines.append(f"turns at a limit of {' to '.join(dict.fromkeys(turns))}")
    beyond = [one for one in judgment.turned]
    if beyond:
        where = "; ".join(f"{place(one.at)}: {one.verdict}" for one in beyond[:3])
        more = f" and {len(beyond) - 3} more" if len(beyond) > 3 else ""
        lines.append(f"beyond its range, {where}{more}")
    return lines


def number(value):
    """Return a number, several, or an interval as text."""
    if isinstance(value, ConfidenceInterval):
        return f"{value.value:.3g}" if value.low == value.high else str(value)
    return ", ".join(f"{one:.4g}" for one in np.atleast_1d(value))


def _middle(value):
    return value.value if isinstance(value, ConfidenceInterval) else float(np.max(value))


def _values(values):
    return ", ".join(one if isinstance(one, str) else f"{one:g}" for one in values)


def place(at):
    """Return the values of choices as text."""
    return ", ".join(f"{name} {_values([value])}" for name, value in at.items())
