"""The spectrum of noise, measured: a quantile over time of the power at each frequency."""

from typing import Annotated, Literal

import numpy as np

from .. import _checks
from .._hints import Count, Positive, Probability, checked, up_to
from .._records import record
from .._typing import ArrayLike, FloatArray
from ._periodograms import sliding_windows
from ._tapers import APART, power_correlation
from .detections import Detections

_MOST = 2**24  # samples in a window
_BESIDE = 4  # bins on each side with which one is compared


@checked
@record
class NoiseSpectrum:
    """Power of the noise in each bin of the transform of a window.

    Attributes
    ----------
    frequency : ndarray, shape (B,)
        Frequencies of the bins in Hz.
    power : ndarray, shape (..., B)
        Variance of a complex sample of white noise that has as much power there; NaN in a record
        without a window that is valid.
    degrees : float
        The number of independent exponential values whose mean is as uncertain as the power that
        has fewest windows.
    window : int
        Samples of a window.
    fs : float
        Sampling rate in Hz.
    taper : {"hann", "rectangular"}
    """

    frequency: np.ndarray
    power: np.ndarray
    degrees: Positive
    window: Annotated[int, up_to(_MOST)]
    fs: Positive
    taper: Literal["hann", "rectangular"]

    def __post_init__(self):
        """Check the fields."""
        frequency = _checks.one_row("frequency", self.frequency)
        power = _checks.measured("power", self.power, frequency.shape)
        if (power < 0).any():
            raise ValueError(f"power must not be negative, got {np.nanmin(power):g}")
        return {"frequency": frequency, "power": power}

    @checked
    def lines(self, false_alarm: Probability = 1e-3) -> list[FloatArray]:
        """Return the frequencies of steady lines: bins that stand out from their neighbors.

        Parameters
        ----------
        false_alarm : float
            Probability that a record has any whose noise is smooth: with Hann's taper, across 24
            bins.

        Returns
        -------
        list of ndarray
            Frequencies in Hz of the highest bins, an array for each record.

        Notes
        -----
        A bin is compared with the median of four bins on each side whose noise is independent of
        it and of one another. The ratio is F distributed, with 2 `degrees` and, by the efficiency
        of a median, 2 / pi of 16 `degrees`; the false alarm is shared by all bins.
        """
        from scipy.special import chdtri, fdtri  # here: it takes longer to load than all the rest

        B, apart = len(self.frequency), APART[self.taper]
        beside = np.arange(1, _BESIDE + 1) * apart
        places = np.arange(B)[:, None] + np.concatenate([-beside, beside])
        places = places[(places >= 0).all(axis=-1) & (places < B).all(axis=-1)]
        if not len(places):
            return [np.empty(0) for _ in self.power.reshape(-1, B)]
        first, m = _BESIDE * apart, self.degrees
        # A median of values with 2 m degrees is a little less than their mean.
        middle = chdtri(2 * m, 0.5) / (2 * m)
        limit = fdtri(2 * m, 4 * _BESIDE * m * 2 / np.pi, 1 - false_alarm / len(places))
        found = []
        for row in self.power.reshape(-1, B):
            ratio = np.zeros(B)
            with np.errstate(all="ignore"):
                level = np.median(row[places], axis=-1) / middle
                ratio[first : first + len(places)] = row[first : first + len(places)] / level
            top = ratio > limit
            for k in range(1, apart):
                top[k:] &= ratio[k:] >= ratio[:-k]
                top[:-k] &= ratio[:-k] > ratio[k:]
            found.append(self.frequency[top])
        return found


@checked
@_checks.quiet
def noise_spectrum(
    x: ArrayLike,
    fs: Positive,
    window: Annotated[int, up_to(_MOST)],
    hop: Count | None = None,
    *,
    without: Detections | None = None,
    quantile: Probability = 0.5,
    taper: Literal["hann", "rectangular"] = "hann",
    valid: ArrayLike | None = None,
) -> NoiseSpectrum:
    """Return the spectrum of the noise, measured where most windows hold no target.

    Parameters
    ----------
    x : array_like of complex, shape (..., n)
        Samples of a stretch without a target, or with targets that are at any one frequency for
        a small part of the time only. Real ones have positive frequencies alone.
    fs : float
        Sampling rate in Hz.
    window : int
        Samples of a window, as for `detect_peaks`.
    hop : int, optional
        Samples from one window to the next; half a window if None.
    without : Detections, optional
        What was found in these samples with these windows: in a window, bins nearer than the main
        lobe or the extent of a target to a detection do not count, unless all do at that frequency.
    quantile : float
        Quantile over time of the power in a bin; 0.5 is the median. A target that is at a frequency
        for a share s of the time makes of it the quantile ``quantile / (1 - s)``.
    taper : {"hann", "rectangular"}
        Weights of the samples in a window. Hann's keep a loud thing away from other frequencies.
    valid : array_like of bool, broadcast to (..., n), optional
        Which samples are measurements, see `valid_samples`; all if None.

    Returns
    -------
    NoiseSpectrum

    Notes
    -----
    The power of Gaussian noise in a bin is exponential. Of K such values, the r-th smallest has the
    mean 1/K + 1/(K - 1) + ... + 1/(K - r + 1), by which the quantile is divided: for many, the
    median has 0.69. The sum of the squares of these terms is its variance; overlapping
    windows count as K / (1 + 2 sum of the correlations of their powers).

    A target that stays at one frequency throughout is noise to this function, and so is a steady
    line: that is as it should be for mains and electronics. What is weaker than they are cannot be
    told beside them.

    Examples
    --------
    White noise of variance 2, and a line:

    >>> rng = np.random.default_rng(1)
    >>> x = rng.standard_normal((4096, 2)) @ [1, 1j] + 0.5 * np.exp(0.5j * np.arange(4096))
    >>> noise = noise_spectrum(x, 1e3, window=128)
    >>> round(float(np.median(noise.power)), 1), noise.lines()[0].round(1).tolist()
    (2.0, [78.1])
    """
    hop = max(1, window // 2) if hop is None else hop
    w, leading = sliding_windows(x, fs, window, hop, taper, valid)
    R, K, B = len(w.x), len(w.firsts), len(w.bins)
    if without is not None:
        _checks.exact_shape("without.known", without.known, (*leading, K))
        targets = without.frequency.reshape(R, K, -1)
        near = max(APART[taper] * w.fs / window, without.extent)
    power, counts = np.full((R, B), np.nan), np.zeros((R, B), dtype=int)
    whole = np.empty((K, B))
    for row, part, values in w.powers():
        whole[part] = values
        if part.stop < K:
            continue
        free = np.repeat(w.known[row][:, None], B, axis=-1)
        if without is not None:
            for target in np.moveaxis(targets[row], -1, 0):
                free &= ~(np.abs(w.frequency - target[:, None]) < near)  # true where it is NaN
            free |= w.known[row][:, None] & ~free.any(axis=0)
        ordered = np.sort(np.where(free, whole, np.inf), axis=0)
        counts[row] = free.sum(axis=0)
        for count in np.unique(counts[row][counts[row] > 0]):
            some, terms = counts[row] == count, _terms(count, quantile)
            power[row, some] = ordered[len(terms) - 1, some] / terms.sum()
    least = max(1, counts.min(initial=K))
    terms = _terms(least, quantile)
    lags = np.arange(1, min(least, -(-window // hop)))
    alike = 1 + 2 * np.sum((1 - lags / least) * power_correlation(w.w, lags * hop))
    degrees = max(float(terms.sum() ** 2 / np.sum(terms**2) / alike), 1.0)
    return NoiseSpectrum(w.frequency, power.reshape(*leading, B), degrees, window, fs, taper)


def _terms(count, quantile):
    """Return the terms of the mean of an order statistic of exponential values."""
    rank = min(count, max(1, int(np.ceil(quantile * count))))
    return 1.0 / (count - np.arange(rank))
