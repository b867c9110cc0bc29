"""The systems of the source documents: one package a document, each with the same doors."""

from .._lazy import attach

__getattr__, __dir__ = attach(__name__, __path__)
