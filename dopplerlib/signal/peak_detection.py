"""Detection of tones in sliding windows, at a constant false-alarm rate (CFAR)."""

from collections.abc import Sequence
from typing import Annotated, Literal

import numpy as np
from scipy.ndimage import maximum_filter1d

from .. import _checks
from .._hints import Count, Positive, Probability, checked, up_to
from .._typing import ArrayLike
from ._bins import TAGS, limits
from ._cells import levels, reference
from ._periodograms import sliding_windows
from ._tapers import APART, side_lobes
from .cfar import cfar_factor
from .detections import Detections
from .frequency import peaks
from .noise_spectrum import NoiseSpectrum

_MOST = 2**24  # samples in a window
_AT_ONCE = 2**20  # cells at a time
_MARGIN = 4.0  # 6 dB: so much a peak has to stand out of the side lobes of a stronger one


@checked
@_checks.quiet
def detect_peaks(
    x: ArrayLike,
    fs: Positive,
    window: Annotated[int, up_to(_MOST)],
    hop: Count,
    *,
    band: Sequence[float] | None = None,
    false_alarm: Probability = 1e-3,
    noise: NoiseSpectrum | None = None,
    cfar: Literal["ordered", "averaging"] = "ordered",
    extent: float = 0.0,
    most: Annotated[int, up_to(1000)] = 8,
    taper: Literal["hann", "rectangular"] = "hann",
    timestamp: Literal["center", "end", "start"] = "center",
    valid: ArrayLike | None = None,
) -> Detections:
    """Detect tones in sliding windows, several or none in each, and measure their frequencies.

    Parameters
    ----------
    x : array_like of complex, shape (..., n)
        Samples; a module without Q has real ones. Of an analytic signal take the real part.
    fs : float
        Sampling rate in Hz.
    window : int
        Samples of a window, from 18 (6 without taper) to n.
    hop : int
        Samples from the start of one window to that of the next.
    band : tuple of float, optional
        Lowest and highest frequency in Hz; all if None. Real samples have positive ones, but for
        three bins at each end.
    false_alarm : float
        Probability that a window of noise alone has a detection, at most.
    noise : NoiseSpectrum, optional
        Spectrum of the noise with the same window, taper and sampling rate. Without it, the noise
        is taken to be white across the reference cells of a bin.
    cfar : {"ordered", "averaging"}
        Level of the reference cells: a power of three quarters of their ranks, which a second
        target among them hardly moves, or their mean.
    extent : float
        Width in Hz of the echo of one target, whose parts move at different speeds. Tones nearer
        than that to a stronger one are taken for parts of it, and reference cells stay as far away.
        It keeps the ridge of one vehicle whole; where several cross, 0 keeps them apart.
    most : int
        Largest number P of tones in a window.
    taper : {"hann", "rectangular"}
        Weights of the samples in a window. Hann's keep a strong tone from other frequencies, and
        cost 15 % in the deviation of a pure tone.
    timestamp : {"center", "end", "start"}
        Which moment of the window its time is.
    valid : array_like of bool, broadcast to (..., n), optional
        Which samples are measurements, see `valid_samples`; all if None. A window that touches
        another one has no detection and is not `known`.

    Returns
    -------
    Detections

    Raises
    ------
    ValueError
        If a valid sample is not finite or too large, `window` does not fit, `band` holds no bin or
        the windows are too short for eight reference cells, or `noise` is of other windows.

    Notes
    -----
    Each bin is compared with 24 (or as many as there are) reference cells on both sides, so far
    apart that the taper leaves their noise uncorrelated: three bins with Hann's. So the law of
    `cfar_factor` is exact in white noise of any power. The false alarm of a window is shared by
    its bins; it is less than their sum, since neighbors are correlated with a taper.

    With `noise`, powers are first divided by it, so that noise which is steady and colored becomes
    white, and a steady line as high as its surroundings. Then a bin must pass twice: over the
    measured noise, and over the reference cells, in case the noise has grown. The echo of a wide
    body raises these, and is missed where it is wider than `extent`.

    The window should be as long as the frequency lets it: see `optimal_window_detection` for the
    largest chirp that is to be seen. For measurements on a steady stretch it may be longer.

    A tone is the highest bin of its main lobe, above the side lobes of stronger ones by 6 dB. Its
    frequency is that of the highest point of the weighted periodogram within a bin.

    Examples
    --------
    Two tones, then none:

    >>> from dopplerlib.signal.synthesis import complex_noise
    >>> t = np.arange(1024) / 1e3
    >>> x = complex_noise(1024, 1.0, rng=np.random.default_rng(2))
    >>> x[:512] += (np.exp(200j * np.pi * t) + 2 * np.exp(-300j * np.pi * t))[:512]
    >>> found = detect_peaks(x, 1e3, window=256, hop=256)
    >>> found.detected.tolist(), found.frequency[0, :3].round(0).tolist()
    ([True, True, False, False], [-150.0, 100.0, nan])
    """
    windows, leading = sliding_windows(x, fs, window, hop, taper, valid)
    B, apart = len(windows.bins), APART[taper]
    if not 0 <= extent < fs:
        raise ValueError(f"extent must be from 0 to fs = {fs:g}, got {extent:g}")
    wide = max(apart, int(np.ceil(extent * window / fs)))
    guard = apart + wide
    if B < 8 * apart + 2 * guard:
        raise ValueError(
            f"window must give {8 * apart + 2 * guard} bins or more with an extent of {extent:g} "
            f"Hz, got {B} of {window} samples"
        )
    low, high, _ = limits(band, fs)
    inside = (windows.frequency >= low) & (windows.frequency <= high)
    if not inside.any():
        raise ValueError(f"band must hold a bin, a multiple of {fs / window:g} Hz, got {band}")
    level = None if noise is None else _level(noise, windows, window, taper, leading)
    cells = reference(B, windows.x.dtype.kind == "c", guard, apart)
    each = -np.expm1(np.log1p(-false_alarm) / inside.sum())
    rank = max(1, cells.shape[1] * 3 // 4) if cfar == "ordered" else None
    factor = cfar_factor(each, cells.shape[1], rank)
    least = None if noise is None else noise.degrees * np.expm1(-np.log(each) / noise.degrees)
    R, K = len(windows.x), len(windows.firsts)
    place = np.full((R, K, most), -1)
    snr = np.full((R, K, most), np.nan)
    gain = np.sum(windows.w**2) / np.sum(windows.w) ** 2
    for row, part, power in windows.powers():
        if level is not None:
            power = power / level[row]
        around = levels(power, cells, rank)
        over = inside & (power > factor * around) & windows.known[row, part, None]
        if least is None:
            mean = 1.0 if rank is None else np.sum(1.0 / (cells.shape[1] - np.arange(rank)))
            own = around / mean
        else:
            over &= power > least
            own = np.ones_like(around)
        raw = power if level is None else power * level[row]
        place[row, part], ratio = _strongest(windows, raw, power / own, over, most, taper, wide)
        snr[row, part] = np.maximum(ratio - 1, 1 / _MOST) * gain
    f = _refined(windows, place)
    order = np.argsort(np.where(np.isnan(f), np.inf, -snr), axis=-1, kind="stable")
    f, snr = (
        np.take_along_axis(v, order, axis=-1) for v in (f, np.where(np.isnan(f), np.nan, snr))
    )
    shape = (*leading, K, most)
    time = (windows.firsts + TAGS[timestamp] * (window - 1)) / fs
    return Detections(
        time, windows.known.reshape(shape[:-1]), f.reshape(shape), snr.reshape(shape),
        window, hop, fs, taper, windows.x.dtype.kind == "c", extent,
    )  # fmt: skip


def _level(noise, windows, window, taper, leading):
    """Return the power of the noise (R, B) for each record, or raise if it is of other windows."""
    got = noise.window, noise.taper, noise.fs, len(noise.frequency)
    wanted = window, taper, windows.fs, len(windows.bins)
    if got != wanted:
        raise ValueError(
            f"noise must be of the same windows (samples, taper, fs, bins) {wanted}, got {got}"
        )
    level = _checks.each_run("noise.power", noise.power, leading, windows.bins.shape)
    return level.reshape(len(windows.x), -1)


def _strongest(windows, power, ratio, over, most, taper, wide):
    """Return bins (K, most) of the strongest peaks, -1 for none, and their ratios to the noise."""
    bins = windows.bins
    n = len(windows.w)
    circular = windows.x.dtype.kind == "c"
    top = power >= maximum_filter1d(
        power, 2 * APART[taper] - 1, axis=-1, mode="wrap" if circular else "nearest"
    )
    open_to = np.where(over & top, power, 0.0)
    leak = np.zeros_like(power)
    place = np.full((len(power), most), -1)
    found = np.full((len(power), most), np.nan)
    rows = np.arange(len(power))
    for j in range(most):
        best = np.argmax(open_to, axis=-1)
        height = open_to[rows, best]
        some = height > 0
        if not some.any():
            break
        place[some, j], found[some, j] = best[some], ratio[rows, best][some]
        off = np.abs(bins - bins[best][:, None])
        off = np.minimum(off, n - off) if circular else off
        leak += height[:, None] * side_lobes(taper, off)
        open_to = np.where((off >= wide) & (power > _MARGIN * leak), open_to, 0.0)
        open_to[~some] = 0.0
    return place, found


def _refined(windows, place):
    """Return the frequencies in Hz of the peaks near the bins `place`, NaN for none."""
    n, fs = len(windows.w), windows.fs
    f = np.full(place.shape, np.nan)
    rows, times, _ = where = np.nonzero(place >= 0)
    bins = windows.bins[place[where]]
    views = np.lib.stride_tricks.sliding_window_view(windows.x, n, axis=-1)
    found = np.empty(len(rows))
    t = np.arange(n)
    step = max(1, _AT_ONCE // (4 * n))
    for a in range(0, len(rows), step):
        part = slice(a, a + step)
        turn = np.exp(-2j * np.pi / n * ((bins[part, None] * t) % n))
        x = views[rows[part], windows.firsts[times[part]]] * windows.w * turn
        one = np.arange(len(x))
        found[part], _ = peaks(x, one, 0 * one, n, fs, (-fs / n, fs / n))
    f[where] = bins * fs / n + found
    return f
