"""Choices of a document, narrowed to a few values: evidence then takes a second."""

from dataclasses import replace

from dopplerlib.replication.documents import read_document


def narrowed(document, **wanted):
    """Return a function of names that gives choices; those not wanted keep their first value."""
    choice = read_document(document).choice

    def few(*names):
        return tuple(
            replace(
                one, values=tuple(wanted.get(one.id.replace("-", "_"), one.values[:1])), beyond=()
            )
            for one in choice(*names)
        )

    return few
