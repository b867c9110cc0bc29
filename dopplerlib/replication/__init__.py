"""Claims of documents, our evidence, and the verdicts."""

from .._lazy import attach

__getattr__, __dir__ = attach(__name__, __path__)
