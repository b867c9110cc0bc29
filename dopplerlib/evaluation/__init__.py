"""Is a filter right: statistics of its errors and innovations, intervals and bounds."""

from .._lazy import attach

__getattr__, __dir__ = attach(__name__, __path__)
