"""The role ``{verdict}`` prints the verdict on a claim, and links to its row of the scorecard.

A verdict that is typed into a sentence stays when the verdict changes; this one cannot.
"""

from functools import cache

from docutils import nodes

from dopplerlib.replication.documents import documents, read_document


def setup(app):
    """Register the extension with Sphinx."""
    app.add_role("verdict", _verdict)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def word(text):
    """Return the document, the id and the verdict of ``document:id``, or raise a ValueError."""
    document, colon, claim = text.partition(":")
    if not colon or document not in documents():
        raise ValueError(f"a verdict must be that of document:id, got {text!r}")
    if claim not in _verdicts(document):
        raise ValueError(f"{document} must have the claim, got {claim!r}")
    return document, claim, _verdicts(document)[claim]


@cache
def _verdicts(document):
    return {claim.id: claim.verdict for claim in read_document(document).claims}


def _verdict(name, rawtext, text, lineno, inliner, options=None, content=None):
    try:
        document, claim, found = word(text)
    except ValueError as error:
        message = inliner.reporter.error(str(error), line=lineno)
        return [inliner.problematic(rawtext, rawtext, message)], [message]
    link = f"scorecard_{document}.html#claim-{claim}"
    node = nodes.reference(rawtext, found, refuri=link, internal=True)
    node["classes"] += ["verdict", f"verdict-{found}"]
    return [node], []
