"""Targets that appear in front of the ring and come near, and trackers compared on them."""

from .._lazy import attach

__getattr__, __dir__ = attach(__name__, __path__)
