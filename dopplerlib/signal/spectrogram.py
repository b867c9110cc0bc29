"""Spectrogram of a recording, to look at before anything else."""

from typing import Literal

import numpy as np

from .. import _checks
from .._hints import Positive, checked
from .._records import record
from .._typing import ArrayLike, FloatArray
from .validity import known_samples

_AT_ONCE = 2**20  # values of one block of transforms: of a long recording there is never more


@checked
@record
class Spectrogram:
    """Power density of samples over time and frequency.

    Attributes
    ----------
    time : ndarray, shape (M,)
        Middle of each column in s, counted from the first sample.
    frequency : ndarray, shape (F,)
        Increasing, from -fs/2 on, in Hz.
    density : ndarray, shape (..., F, M)
        Power in 1 Hz, in squares of the samples' unit; NaN where no window is valid.
    """

    time: np.ndarray
    frequency: np.ndarray
    density: np.ndarray

    def __post_init__(self):
        """Check the fields."""
        time = _checks.one_row("time", self.time)
        frequency = _checks.one_row("frequency", self.frequency)
        density = _checks.measured("density", self.density, (len(frequency), len(time)))
        if (density < 0).any():
            raise ValueError(f"density must not be negative, got {np.nanmin(density):g}")
        return {"time": time, "frequency": frequency, "density": density}

    @property
    def db(self) -> FloatArray:
        """Power density in dB, shape (..., F, M); minus infinity where there is no power."""
        with np.errstate(divide="ignore"):
            return 10 * np.log10(self.density)


@checked
@_checks.quiet
def spectrogram(
    x: ArrayLike,
    fs: Positive,
    window: int,
    hop: int | None = None,
    *,
    valid: ArrayLike | None = None,
    columns: int = 1000,
    combine: Literal["max", "mean"] = "max",
) -> Spectrogram:
    """Compute the spectrogram of samples, with few columns however long the recording is.

    Parameters
    ----------
    x : array_like of complex, shape (..., n)
        Samples.
    fs : float
        Sampling rate in Hz.
    window : int
        Samples of a window, at least 2 and at most n. Two tones are told apart if they differ by
        ``2 fs / window`` or more.
    hop : int, optional
        Samples from one window to the next; half a window if None.
    valid : array_like of bool, broadcast to (..., n), optional
        Which samples are measurements, see `valid_samples`; all if None. A window that touches
        another one does not count.
    columns : int
        Largest number of columns. Neighboring windows share one if there are more.
    combine : {"max", "mean"}
        What such a column shows: the largest power at each frequency, in which an event of a single
        window stays visible, or the mean, in which noise is smooth.

    Returns
    -------
    Spectrogram

    Raises
    ------
    ValueError
        If a valid sample is not finite, `window` does not fit into the record, or a number is not
        positive.

    Notes
    -----
    `scipy.signal.ShortTimeFFT` with a Hann window. The transforms are computed in blocks, so that
    memory does not grow with the length of the recording.

    Examples
    --------
    >>> from dopplerlib.signal.synthesis import tone
    >>> x = tone(-100.0, 1e3, 20000, 20.0, rng=np.random.default_rng(1))
    >>> s = spectrogram(x, 1e3, window=200, columns=50)
    >>> s.density.shape, float(s.frequency[np.argmax(s.db[:, 7])])
    ((200, 50), -100.0)
    """
    from scipy.signal import ShortTimeFFT
    from scipy.signal.windows import hann

    x, valid = known_samples("x", x, valid, (None,))
    n = x.shape[-1]
    window = _checks.whole_number("window", window, least=2)
    if window > n:
        raise ValueError(f"window must be at most the {n} samples of the record, got {window}")
    hop = max(1, window // 2) if hop is None else _checks.whole_number("hop", hop)
    count = (n - window) // hop + 1  # windows inside the record
    share = -(-count // _checks.whole_number("columns", columns))
    transform = ShortTimeFFT(hann(window, sym=False), hop, fs, fft_mode="centered", scale_to="psd")
    rows = x.reshape(-1, n)
    good = np.ones((1, n), dtype=bool) if valid is None else valid.reshape(-1, n)
    density = np.empty((len(rows), window, -(-count // share)))
    step = share * max(1, _AT_ONCE // (max(1, len(rows)) * window * share))
    for a in range(0, count, step):
        b = min(a + step, count)
        block = slice(a * hop, (b - 1) * hop + window)
        X = transform.stft(rows[:, block], 0, b - a, k_offset=transform.m_num_mid)
        whole = _whole(good[:, block], window, hop, b - a)
        density[..., a // share : -(-b // share)] = _combined(
            X.real**2 + X.imag**2, whole[:, None], share, combine
        )
    first = np.arange(density.shape[-1]) * share
    last = np.minimum(first + share, count) - 1
    time = ((first + last) / 2 * hop + (window - 1) / 2) / fs
    return Spectrogram(time, transform.f, density.reshape(*x.shape[:-1], *density.shape[1:]))


def _whole(good, window, hop, count):
    """Return which windows hold valid samples alone (R, count)."""
    bad = np.zeros((len(good), good.shape[1] + 1), dtype=int)
    np.cumsum(~good, axis=-1, out=bad[:, 1:])
    first = np.arange(count) * hop
    return bad[:, first + window] == bad[:, first]


def _combined(power, whole, share, combine):
    """Return the largest or mean power (R, F, columns) of `share` windows each that are whole."""
    first = np.arange(0, power.shape[-1], share)
    seen = np.add.reduceat(whole, first, axis=-1, dtype=int)
    reduce = np.maximum if combine == "max" else np.add
    power = _checks.estimates("x", np.where(whole, power, 0.0), what="power")
    found = reduce.reduceat(power, first, axis=-1)
    if combine == "mean":
        found = found / np.maximum(seen, 1)
    return np.where(seen > 0, found, np.nan)
