"""Studies whose run is a row of a table, of whatever JSON can hold."""

import json

import numpy as np


def texts(rows):
    """Return rows as results of `run_study`."""
    return {"row": np.array([json.dumps(row) for row in rows])}


def rows(found):
    """Return the rows of the results of one part."""
    return [json.loads(text) for text in found["row"].tolist()]


def by_kind(rows):
    """Return a JSON document with a list of rows for each of their kinds, a line for each row."""
    lists = {row["kind"]: [] for row in rows}
    for row in rows:
        lists[row["kind"]].append("    " + json.dumps(row))
    parts = (f'  "{kind}": [\n' + ",\n".join(lines) + "\n  ]" for kind, lines in lists.items())
    return "{\n" + ",\n".join(parts) + "\n}\n"
