"""Numeric code printed by `dopplerlib.derive`: readable, committed, never edited by hand."""

from .._lazy import attach

__getattr__, __dir__ = attach(__name__, __path__)
