"""From a recording to a track, on any array."""

from .._lazy import attach

__getattr__, __dir__ = attach(__name__, __path__)
