"""From a recording to pictures, tables and a verdict: ``python -m dopplerlib``."""

from .._lazy import attach

__getattr__, __dir__ = attach(__name__, __path__)
