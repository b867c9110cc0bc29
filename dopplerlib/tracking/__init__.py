"""Gating, data association, track management and fusion."""

from .._lazy import attach

__getattr__, __dir__ = attach(__name__, __path__)
