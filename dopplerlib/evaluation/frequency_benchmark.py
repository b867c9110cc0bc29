"""Benchmark of frequency estimators: errors over the Cramér-Rao bound, and outliers."""

from collections.abc import Callable
from functools import partial
from typing import Annotated

import numpy as np

from .. import _checks
from .._data import read_json, results
from .._hints import Count, Probability, Real, between, checked, exactly, up_to
from .._records import record
from .._typing import ComplexArray, FloatArray
from ..signal import interpolation, phase
from ..signal.frequency import ml_frequency, ml_frequency_dc
from ..signal.laws import crlb_frequency_std
from ..signal.synthesis import tone
from .intervals import ConfidenceInterval, mean_interval, proportion_interval

SAMPLES, FS = 100, 10e3  # a window of 10 ms; ratios to the bound do not depend on fs
LEVELS = (*range(-15, 16), 20, 25, 30, 35, 40)  # dB: fine where the thresholds are
WINDOWS = 20_000
SEED = 32
_TONES = (50.0, 350.0)  # Hz: three whole bins, so that every place between two is as likely
_PADDED = 4 * SAMPLES

ESTIMATORS: dict[str, Callable[..., FloatArray]] = {
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
    "ML with DC offset": ml_frequency_dc,
    "Kay": phase.kay,
    "pulse pair": phase.pulse_pair,
}


Intervals = tuple[ConfidenceInterval, ...]


@checked
@record
class FrequencyBenchmark:
    """Errors of the estimators of `ESTIMATORS` at the levels of `LEVELS`.

    Attributes
    ----------
    snr_db : ndarray, shape (L,)
        Signal-to-noise ratios of a sample in dB.
    bound : ndarray, shape (L,)
        Cramér-Rao bound in Hz, amplitude and phase unknown.
    windows : int
        Windows at each level; all estimators get the same ones.
    ratio : dict of str to tuple of ConfidenceInterval, length L
        Root-mean-square errors over the bound, of all windows, by estimator.
    outliers : dict of str to tuple of ConfidenceInterval, length L
        Fractions of estimates that are off by more than a bin.
    """

    snr_db: Annotated[FloatArray, exactly(None)]
    bound: Annotated[FloatArray, exactly(None)]
    windows: Count
    ratio: dict[str, Intervals]
    outliers: dict[str, Intervals]

    def __post_init__(self):
        """Check that there is a number for each level."""
        levels = {"bound": self.bound}
        levels |= {f"ratio[{name!r}]": values for name, values in self.ratio.items()}
        levels |= {f"outliers[{name!r}]": values for name, values in self.outliers.items()}
        for name, values in levels.items():
            if len(values) != len(self.snr_db):
                raise ValueError(f"{name} must have {len(self.snr_db)} levels, got {len(values)}")

    @checked
    def at(self, snr_db: Real) -> int:
        """Place of the level with a signal-to-noise ratio.

        Parameters
        ----------
        snr_db : float
            In dB, one of the levels.

        Returns
        -------
        int

        Examples
        --------
        >>> saved_benchmark().at(0)
        15
        """
        places = np.flatnonzero(self.snr_db == snr_db)
        if not len(places):
            raise ValueError(f"snr_db must be one of the levels {self.snr_db}, got {snr_db}")
        return int(places[0])

    @checked
    def threshold(self, name: str, fraction: Probability = 0.01) -> ConfidenceInterval:
        """Signal-to-noise ratio in dB above which fewer than a fraction of estimates are outliers.

        Parameters
        ----------
        name : str
            Estimator.
        fraction : float
            Of outliers.

        Returns
        -------
        ConfidenceInterval
            Where the measured fractions, and the ends of their intervals, fall to `fraction`
            for good, interpolated on a logarithmic scale; infinite if they never do.

        Examples
        --------
        >>> saved_benchmark().threshold("maximum likelihood").value < 0
        True
        """
        _checks.one_of("name", name, tuple(self.outliers))
        return ConfidenceInterval(
            *(
                self._crossing([getattr(e, end) for e in self.outliers[name]], fraction)
                for end in ("value", "low", "high")
            )
        )

    def _crossing(self, fractions, fraction):
        above = np.flatnonzero(np.array(fractions) > fraction)
        if not len(above):
            return -np.inf
        k = above[-1]
        if k == len(fractions) - 1:
            return np.inf
        # No outlier seen has no logarithm: half a window in all stands for it.
        least = min(0.5 / self.windows, fraction)
        here, there = np.log(np.maximum(fractions[k : k + 2], least))
        step = (here - np.log(fraction)) / (here - there)
        return float(self.snr_db[k] + step * (self.snr_db[k + 1] - self.snr_db[k]))


@checked
def benchmark_windows(
    snr_db: Real, windows: Annotated[int, up_to(10**6)] = WINDOWS
) -> tuple[ComplexArray, FloatArray]:
    """Return the windows of one level, and the true frequencies in them.

    Parameters
    ----------
    snr_db : float
        One of `LEVELS`.
    windows : int
        How many.

    Returns
    -------
    x : ndarray of complex, shape (windows, SAMPLES)
        IQ samples.
    f : ndarray, shape (windows,)
        Frequencies in Hz.

    Notes
    -----
    The seed is made from `SEED` and the number of the level, so that each level can be made
    again alone.

    Examples
    --------
    >>> x, f = benchmark_windows(0, windows=2)
    >>> x.shape, f.shape
    ((2, 100), (2,))
    """
    if snr_db not in LEVELS:
        raise ValueError(f"snr_db must be one of {', '.join(map(str, LEVELS))}, got {snr_db}")
    level = LEVELS.index(snr_db)
    rng = np.random.default_rng((SEED, level))
    f = rng.uniform(*_TONES, windows)
    return tone(f, FS, SAMPLES, snr_db, rng=rng), f


@checked
def benchmark_cell(
    name: str,
    x: Annotated[ComplexArray, exactly(None, None, check=_checks.finite_complex)],
    f: Annotated[FloatArray, exactly(None)],
    snr_db: Annotated[float, between(-200, 200)],
) -> tuple[ConfidenceInterval, int]:
    """Return the error of one estimator over the bound, and its outliers, at one noise level.

    Parameters
    ----------
    name : str
        A key of `ESTIMATORS`.
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

    Notes
    -----
    The interval joins two of 97.5 %: of what the windows without an outlier contribute to the mean
    square, and of the fraction of outliers, times the mean square of those that were seen. Where
    none was seen it holds the first part only.

    Examples
    --------
    >>> x, f = benchmark_windows(20, windows=100)
    >>> benchmark_cell("maximum likelihood", x, f, 20)[1]
    0
    """
    if len(f) != len(x) or len(f) < 2:
        raise ValueError(f"f must have two frequencies or more, one for each window, got {len(f)}")
    estimator = ESTIMATORS[_checks.one_of("name", name, tuple(ESTIMATORS))]
    bound = crlb_frequency_std(10 ** (snr_db / 10), x.shape[-1], FS)
    error = estimator(x, FS) - f
    _checks.estimates("x", error)
    square = (error / bound) ** 2
    out = np.abs(error) > FS / x.shape[-1]
    near = mean_interval(np.where(out, 0.0, square), confidence=0.975)
    far = square[out].mean() if out.any() else 0.0
    fraction = proportion_interval(out, confidence=0.975)
    ends = (getattr(near, end) + getattr(fraction, end) * far for end in ("value", "low", "high"))
    return ConfidenceInterval(*(float(np.sqrt(max(end, 0.0))) for end in ends)), int(out.sum())


def saved_benchmark() -> FrequencyBenchmark:
    """Return the benchmark as it was saved.

    Returns
    -------
    FrequencyBenchmark

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
    bound = crlb_frequency_std(10 ** (levels / 10), SAMPLES, FS)
    return FrequencyBenchmark(levels, bound, windows, ratio, outliers)
