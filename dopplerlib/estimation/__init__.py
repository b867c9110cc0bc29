"""Initialization, Kalman filters and smoothing."""

from .._lazy import attach

__getattr__, __dir__ = attach(__name__, __path__)
