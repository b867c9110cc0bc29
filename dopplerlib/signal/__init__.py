"""IQ samples of moving targets, and Doppler shifts from IQ samples."""

from .._lazy import attach

__getattr__, __dir__ = attach(__name__, __path__)
