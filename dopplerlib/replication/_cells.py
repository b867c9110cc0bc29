"""Common parts of the tables of claims and documented deviations, in Markdown."""


def badge(kind, word):
    """Return a word in a frame whose color is that of its kind."""
    return f'<span class="verdict {kind}-{word}">{word}</span>'


def link(entry):
    """Return the link to the cell of a chapter that a record names."""
    page = entry.page.replace("_", " ")
    return f'<a href="{entry.page}.html#cell-{entry.cell}">{page}</a>'


def table(head, rows):
    """Return a table; a bar inside a cell, as in a formula, does not end it."""
    lines = [head, ["---"] * len(head)]
    lines += [[cell.replace("|", r"\|") for cell in row] for row in rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
