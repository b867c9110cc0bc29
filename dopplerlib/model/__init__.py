"""Sensors, Doppler shift, motion, scenarios and simulation."""

from .._lazy import attach

__getattr__, __dir__ = attach(__name__, __path__)
