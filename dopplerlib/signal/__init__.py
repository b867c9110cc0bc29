"""From a moving target to IQ samples, and from IQ samples to Doppler shifts."""

from .._lazy import attach

__getattr__, __dir__ = attach(__name__, __path__)
