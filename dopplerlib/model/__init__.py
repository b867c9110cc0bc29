"""The world as numbers: sensors, Doppler shift, motion, scenarios, simulation."""

from .._lazy import attach

__getattr__, __dir__ = attach(__name__, __path__)
