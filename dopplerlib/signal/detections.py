"""The record of tones that were detected."""

from typing import Annotated, Literal

import numpy as np

from .. import _checks
from .._hints import Count, Positive, checked, up_to
from .._records import record
from .._typing import BoolArray, FloatArray
from ._tapers import frequency_gain, weights

_MOST = 2**24  # samples in a window


@checked
@record
class Detections:
    """Tones that were detected in windows of samples, the strongest first.

    Attributes
    ----------
    time : ndarray, shape (K,)
        Time of each window in s, counted from the first sample, as tagged.
    known : ndarray of bool, shape (..., K)
        Whether all samples of a window are valid.
    frequency : ndarray, shape (..., K, P)
        Frequencies in Hz of up to P tones; NaN where there is none.
    snr : ndarray, shape (..., K, P)
        Their signal-to-noise ratios per sample, not in dB: power of a complex tone over the
        variance of complex noise that is white and as strong as that around the tone. A real tone
        of amplitude a in noise of variance v has a^2 / (4 v).
    window : int
        Samples of a window.
    hop : int
        Samples from one window to the next.
    fs : float
        Sampling rate in Hz.
    taper : {"hann", "rectangular"}
    signed : bool
        Whether frequencies have their sign; those of real samples are absolute values.
    extent : float
        Width in Hz of the echo of one target.
    """

    time: np.ndarray
    known: np.ndarray
    frequency: np.ndarray
    snr: np.ndarray
    window: Annotated[int, up_to(_MOST, 3)]
    hop: Count
    fs: Positive
    taper: Literal["hann", "rectangular"] = "hann"
    signed: bool = True
    extent: float = 0.0

    def __post_init__(self):
        """Check the fields."""
        frequency = _checks.measured("frequency", self.frequency, (None, None))
        snr = _checks.exact_shape("snr", _checks.measured("snr", self.snr, ()), frequency.shape)
        there = ~np.isnan(frequency)
        if (there & ~(snr > 0)).any():
            raise ValueError(f"snr must be positive, got {snr[there & ~(snr > 0)][0]}")
        known = _checks.booleans("known", self.known)
        _checks.exact_shape("known", known, frequency.shape[:-1])
        time = _checks.finite("time", self.time)
        _checks.exact_shape("time", time, frequency.shape[-2:-1])
        return {"time": time, "known": known, "frequency": frequency, "snr": snr}

    @property
    def detected(self) -> BoolArray:
        """Whether there is a tone in each window, shape (..., K)."""
        return ~np.isnan(self.frequency).all(axis=-1)

    @property
    def frequency_std(self) -> FloatArray:
        """Standard deviation in Hz of pure tones with these ratios, shape (..., K, P).

        NaN where there is none. An echo of an extended target scatters more: see
        `frequency_scatter`.
        """
        gain = frequency_gain(weights(self.taper, self.window)) * self.fs / (2 * np.pi)
        return np.where(np.isnan(self.frequency), np.nan, gain / np.sqrt(self.snr))
