"""Section 3.2 of Mittermaier et al. (2016): is the bound attained? Every estimator against it."""

from functools import partial

import numpy as np

from ... import _checks
from ..._data import read_json, results
from ..._records import record
from ...evaluation.intervals import ConfidenceInterval, mean_interval, proportion_interval
from ...signal import interpolation, phase
from ...signal.frequency import ml_frequency, ml_frequency_dc
from ...signal.laws import crlb_frequency_std
from ...signal.synthesis import tone

RACE_SAMPLES, RACE_FS = 100, 10e3  # a window of 10 ms; ratios to the bound do not depend on fs
RACE_LEVELS = (*range(-15, 16), 20, 25, 30, 35, 40)  # dB: fine where the thresholds are
RACE_WINDOWS = 20_000
RACE_SEED = 32
_TONES = (50.0, 350.0)  # Hz: three whole bins, so that every place between two is as likely
_PADDED = 4 * RACE_SAMPLES

RACE = {
    "highest bin": interpolation.peak_bin,
    "parabola": interpolation.parabolic,
    "parabola, padded": partial(interpolation.parabolic, nfft=_PADDED),
    "log parabola": partial(interpolation.parabolic, scale="log"),
    "log parabola, padded": partial(interpolation.parabolic, nfft=_PADDED, scale="log"),
    "three highest": interpolation.parabolic_three_highest,
    "three highest, padded": partial(interpolation.parabolic_three_highest, nfft=_PADDED),
    "Jacobsen": interpolation.jacobsen,
    "Candan": interpolation.candan,
    "Quinn 1": interpolation.quinn1,
    "Quinn 2": interpolation.quinn2,
    "Aboutanios-Mulgrew": interpolation.aboutanios_mulgrew,
    "maximum likelihood": ml_frequency,
    "beside a constant": ml_frequency_dc,
    "Kay": phase.kay,
    "pulse pair": phase.pulse_pair,
}


@record
class Race:
    """Errors of the estimators of `RACE` at the levels of `RACE_LEVELS`.

    Attributes
    ----------
    snr_db : ndarray, shape (L,)
        Signal-to-noise ratios of a sample in dB.
    bound : ndarray, shape (L,)
        Cramér-Rao bound in Hz, amplitude and phase unknown.
    windows : int
        Windows at each level; all estimators get the same ones.
    ratio : dict of str to list of ConfidenceInterval, length L
        Root-mean-square errors over the bound, of all windows, by estimator.
    outliers : dict of str to list of ConfidenceInterval, length L
        Shares of estimates that are off by more than a bin.
    """

    snr_db: np.ndarray
    bound: np.ndarray
    windows: int
    ratio: dict
    outliers: dict

    def at(self, snr_db):
        """Return which of the levels has this signal-to-noise ratio in dB."""
        return int(np.flatnonzero(self.snr_db == snr_db)[0])

    def threshold(self, name, share=0.01):
        """Return the ratio in dB above which less than this share of estimates are outliers.

        Parameters
        ----------
        name : str
            Estimator.
        share : float
            Share of outliers.

        Returns
        -------
        ConfidenceInterval
            Where the measured shares, and the ends of their intervals, come down to `share`
            for good, interpolated on a logarithmic scale; infinite if they never do.

        Raises
        ------
        ValueError
            If `share` is not between 0 and 1.
        """
        share = _checks.probability("share", share)
        return ConfidenceInterval(
            *(
                self._crossing([getattr(e, end) for e in self.outliers[name]], share)
                for end in ("value", "low", "high")
            )
        )

    def _crossing(self, shares, share):
        above = np.flatnonzero(np.array(shares) > share)
        if not len(above):
            return -np.inf
        k = above[-1]
        if k == len(shares) - 1:
            return np.inf
        # No outlier seen has no logarithm: half a window in all stands for it.
        here, there = np.log(np.maximum(shares[k : k + 2], 0.5 / self.windows))
        step = (here - np.log(share)) / (here - there)
        return float(self.snr_db[k] + step * (self.snr_db[k + 1] - self.snr_db[k]))


def race_windows(snr_db, windows=RACE_WINDOWS):
    """Return the windows of one level, and the true frequencies in them.

    Parameters
    ----------
    snr_db : float
        One of `RACE_LEVELS`.
    windows : int
        How many.

    Returns
    -------
    x : ndarray of complex, shape (windows, RACE_SAMPLES)
        IQ samples.
    f : ndarray, shape (windows,)
        Frequencies in Hz.

    Raises
    ------
    ValueError
        If `snr_db` is none of the levels or `windows` is no positive whole number.

    Notes
    -----
    The seed is made from `RACE_SEED` and the number of the level, so that each level can be made
    again alone.
    """
    level = RACE_LEVELS.index(_checks.one_of("snr_db", snr_db, RACE_LEVELS))
    windows = _checks.whole_number("windows", windows)
    rng = np.random.default_rng((RACE_SEED, level))
    f = rng.uniform(*_TONES, windows)
    return tone(f, RACE_FS, RACE_SAMPLES, snr_db, rng=rng), f


def race_cell(name, x, f, snr_db):
    """Return how one estimator does at one level.

    Parameters
    ----------
    name : str
        A key of `RACE`.
    x : ndarray of complex, shape (windows, n)
        IQ samples.
    f : ndarray, shape (windows,)
        True frequencies in Hz.
    snr_db : float
        Signal-to-noise ratio of a sample in dB.

    Returns
    -------
    ratio : ConfidenceInterval
        Root-mean-square error over the bound.
    outliers : int
        Estimates that are off by more than a bin.

    Raises
    ------
    ValueError
        If `name` is no estimator of the race, or the estimator refuses the samples.

    Notes
    -----
    The interval joins two of 97.5 %: of what the windows without an outlier contribute to the mean
    square, and of the share of outliers, times the mean square of those that were seen. Where
    none was seen it holds the first part only.
    """
    estimator = RACE[_checks.one_of("name", name, tuple(RACE))]
    bound = crlb_frequency_std(10 ** (snr_db / 10), x.shape[-1], RACE_FS)
    error = estimator(x, RACE_FS) - f
    square = (error / bound) ** 2
    out = np.abs(error) > RACE_FS / x.shape[-1]
    near = mean_interval(np.where(out, 0.0, square), confidence=0.975)
    far = square[out].mean() if out.any() else 0.0
    share = proportion_interval(out, confidence=0.975)
    ends = (getattr(near, end) + getattr(share, end) * far for end in ("value", "low", "high"))
    return ConfidenceInterval(*(float(np.sqrt(end)) for end in ends)), int(out.sum())


def saved_race():
    """Return the race as it was saved.

    Returns
    -------
    Race

    Notes
    -----
    Made by ``make study NAME=frequency_benchmark``; see the README of ``results``.
    """
    saved = read_json("frequency_benchmark.json", folder=results)
    levels, windows = np.array(saved["snr_db"], dtype=float), saved["windows"]
    ends = [saved[end] for end in ("ratio", "low", "high")]
    ratio = {
        name: [ConfidenceInterval(*at) for at in zip(*(end[name] for end in ends), strict=True)]
        for name in saved["ratio"]
    }
    outliers = {
        name: [proportion_interval(np.arange(windows) < count) for count in counts]
        for name, counts in saved["outliers"].items()
    }
    bound = crlb_frequency_std(10 ** (levels / 10), RACE_SAMPLES, RACE_FS)
    return Race(levels, bound, windows, ratio, outliers)
