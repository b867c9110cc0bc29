"""The systems of the source documents: one package a document, each with the same doors.

Arguments and fields are checked against their hints: what is not of the kind described is a
ValueError that names it. Docstrings say what else is refused.
"""

from .._lazy import attach

__getattr__, __dir__ = attach(__name__, __path__)
