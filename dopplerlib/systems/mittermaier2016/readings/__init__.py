"""Interpretations of points that the paper leaves open, and ablations of its filter."""

from ...._lazy import attach

__getattr__, __dir__ = attach(__name__, __path__)
