"""One module per source document, assembling the library as that document does."""

from .._lazy import attach

__getattr__, __dir__ = attach(__name__, __path__)
