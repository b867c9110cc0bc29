"""Lines at known frequencies, such as the hum of mains or a constant that drifts, taken out."""

from collections.abc import Sequence
from typing import Annotated

import numpy as np
import scipy.fft

from .. import _checks
from .._hints import AboveZero, checked, up_to
from .._typing import ArrayLike, BoolArray, ComplexArray
from .sliding import _MOST, sliding_doppler
from .validity import known_samples

_ROUNDS = 4  # of finding the echo beside the lines, and the lines beside the echo
_SEEN = 20.0  # integrated signal-to-noise ratio of an echo, as that of `track_iq`
_FINE = 8  # points of a spectrum in the resolution of the record
_TOLD = 0.05  # of the energy of a line's knot: of less its value takes part in that of a neighbor
_HELD = 1e-6  # of the energy of a knot's function: of less, samples say nothing of its value


@checked
@_checks.quiet
def remove_lines(
    x: ArrayLike,
    fs: AboveZero,
    lines: ArrayLike,
    window: Annotated[int, up_to(_MOST, 3)],
    *,
    width: AboveZero = 4.0,
    band: Sequence[float] | None = None,
    valid: ArrayLike | None = None,
) -> ComplexArray:
    """Remove lines at known frequencies from samples: hum, its harmonics, a constant that drifts.

    Parameters
    ----------
    x : array_like of complex, shape (..., n)
        IQ samples, or the analytic signal of a module without Q.
    fs : float
        Sampling rate in Hz.
    lines : array_like, shape (L,)
        Frequencies in Hz, each of which is removed at its negative as well: I and Q of a hum have
        any amplitudes. 0 is the constant.
    window : int
        Samples in which the Doppler shift of an echo changes little, as for `sliding_doppler`.
    width : float
        What is nearer to a line is lost, in Hz, see `near_lines`. The frequency of a line may be
        off by a quarter of it, and its amplitude, a complex one, goes straight for ``4 / width``
        seconds: so fast a constant may drift, and the frequency of mains wander.
    band : tuple of float, optional
        Lowest and highest Doppler shift in Hz; -fs/2 and fs/2 if None.
    valid : array_like of bool, broadcast to (..., n), optional
        Which samples are measurements, see `valid_samples`; all if None. The others do not count,
        and become 0.

    Returns
    -------
    ndarray of complex, shape (..., n)
        Samples without lines; nothing is delayed.

    Raises
    ------
    ValueError
        If a valid sample is not finite, a line is not below fs/2, two lines are nearer to each
        other than `width`, or an argument is refused by `sliding_doppler`.

    Notes
    -----
    Least squares over the whole record. The unknowns are the amplitude of each line at knots
    ``4 / width`` apart, straight between them, and that of the echo at knots two windows apart,
    whose phase is the integral of its Doppler shift in sliding windows. Shifts, the frequencies of
    lines, within a quarter of `width`, and amplitudes are found in turn, four times.

    Without the echo among the unknowns, as in a notch filter, lines take whatever part of the
    record's spectrum they stand in: an echo whose shift wanders by R Hz in a second has 1/R of its
    energy in each Hz, and misses it later. While an echo is nearer to a line than `width`, these
    samples tell nothing of the line. An echo that stays within twice the width for seconds takes
    its part: its shifts have up to twice the variance then that `sliding_doppler` states.

    Memory grows with samples times lines, some 500 bytes for each: decimate first.

    Examples
    --------
    A hum, half as strong as an echo that crosses it, goes by 40 dB:

    >>> t = np.arange(2000) / 1e3
    >>> echo = np.exp(2j * np.pi * (80 * t + 20 * t**2))
    >>> hum = 0.5 * np.cos(2 * np.pi * 100 * t + 1)
    >>> left = remove_lines(echo + hum, 1e3, [100], window=50) - echo
    >>> bool(np.sqrt(np.mean(np.abs(left) ** 2)) < 0.01 * np.sqrt(np.mean(hum**2)))
    True
    """
    x, valid = known_samples("x", x, valid, (None,))
    n = x.shape[-1]
    lines = _frequencies(lines, fs, max(width, 2 * fs / max(n, 1)))
    rows = x.reshape(-1, n)
    good = np.ones(rows.shape, dtype=bool) if valid is None else valid.reshape(-1, n)
    if not len(lines) or not rows.size:
        return x
    steady, moving = _hats(n, 4 * fs / width), _hats(n, 2 * window)
    out = np.empty_like(rows)
    for i, (row, sound) in enumerate(zip(rows, good, strict=True)):
        line, echo = _fit(row, sound, _waves(row, lines, fs, width), steady)
        for _ in range(_ROUNDS):
            phase, seen, near = _echo(
                np.where(sound, row - line, 0.0), sound, fs, window, band, lines, width
            )
            told = sound & ~near
            if not told.any():
                break
            # Of a few samples the frequency of a line would be anything.
            search = width if 2 * told.sum() > sound.sum() else 0.0
            waves = _waves(np.where(told, row - echo, 0.0), lines, fs, search)
            carrier = np.where(seen, np.exp(1j * phase), 0.0)
            line, echo = _fit(row, told, waves, _tied(steady, told), carrier, moving)
        out[i] = np.where(sound, row - line, 0.0)
    return _checks.estimates("x", out.reshape(x.shape), what="samples")


@checked
def near_lines(f: ArrayLike, lines: ArrayLike, width: AboveZero) -> BoolArray:
    """Return which Doppler shifts are so near to a line that they went with it.

    Parameters
    ----------
    f : array_like, shape (...)
        Doppler shifts in Hz; NaN is near to none.
    lines : array_like, shape (L,)
        Frequencies in Hz, as for `remove_lines`.
    width : float
        That of `remove_lines` in Hz.

    Returns
    -------
    ndarray of bool, shape (...)
        Whether a shift is less than `width` from a line or its negative. It is no measurement then.

    Examples
    --------
    >>> near_lines([-49.5, 60.0, 0.5], lines=[50, 100], width=4.0).tolist()
    [True, False, False]
    """
    f = _checks.measured("f", f, ())
    lines = _checks.finite("lines", lines)
    return (np.abs(np.abs(f)[..., None] - np.abs(lines.ravel())) < width).any(axis=-1)


def _frequencies(lines, fs, apart):
    """Return the absolute values of lines, or raise if two of them are too near to each other."""
    lines = np.abs(_checks.finite("lines", lines).ravel())
    if not (lines < fs / 2).all():
        raise ValueError(f"lines must be below fs / 2 = {fs / 2:g}, got {lines.max():g}")
    both = _both(lines)
    around = np.diff(both, append=both[:1] + fs)
    if len(lines) and not around.min() >= apart:
        raise ValueError(
            f"lines must be {apart:.4g} Hz apart or more, also from their negatives, got "
            f"{around.min():.4g} Hz"
        )
    return lines


def _waves(x, lines, fs, width):
    """Return waves (2 L, n) of the strongest lines near given ones, and their conjugates.

    Neither mains nor a converter's clock keep their frequency: a quarter of the width is searched
    on either side of each line but 0.
    """
    n = len(x)
    size = scipy.fft.next_fast_len(_FINE * n)
    X = scipy.fft.fft(x, size)
    power = np.abs(X) ** 2 + np.abs(np.roll(X[::-1], 1)) ** 2  # of f and -f
    found = []
    for line in lines:
        reach = width / 4 if line else 0.0
        k = np.arange(round((line - reach) * size / fs), round((line + reach) * size / fs) + 1)
        found.append(line if len(k) < 2 else k[np.argmax(power[k])] * fs / size)
    return np.exp(2j * np.pi * np.arange(n) / fs * _both(np.array(found))[:, None])


def _both(lines):
    return np.union1d(lines, -lines)


def _echo(x, sound, fs, window, band, lines, width):
    """Return the phase of the echo (n,), where there is one, and where it is near to a line."""
    d = sliding_doppler([x], fs, window, max(1, window // 4), band=band, valid=[sound])
    whole = ~np.isnan(d.noise_variance[:, 0])
    f = np.where(window * d.snr >= _SEEN, d.frequency, np.nan)[whole, 0]
    time, known, t = d.time[whole], ~np.isnan(f), np.arange(len(x)) / fs
    if not known.any():
        nowhere = np.zeros(len(x), dtype=bool)
        return t, nowhere, nowhere
    # A sample beside a gap belongs to the nearest window that is whole.
    nearest = np.searchsorted((time[1:] + time[:-1]) / 2, t)
    phase = 2 * np.pi / fs * np.cumsum(np.interp(t, time[known], f[known]))
    return phase, known[nearest], near_lines(f, lines, width)[nearest]


def _hats(n, distance):
    """Return the functions that are straight between knots `distance` samples apart (n, K)."""
    from scipy.sparse import csr_array

    pieces = max(1, int(np.ceil((n - 1) / distance)))
    place = np.arange(n) * (pieces / max(1, n - 1))
    knot = np.minimum(place.astype(int), pieces - 1)
    part = place - knot
    values = np.stack([1 - part, part], axis=1).ravel()
    columns = np.stack([knot, knot + 1], axis=1).ravel()
    return csr_array((values, columns, 2 * np.arange(n + 1)), shape=(n, pieces + 1))


def _tied(hats, told):
    """Return the functions of knots, those with hardly any sample added to the nearest."""
    from scipy.sparse import csr_array

    squares = hats.power(2)
    share = squares.T @ told.astype(float) / squares.sum(axis=0)
    held = np.flatnonzero(share > max(_TOLD * share.max(), 1e-300))
    knots = np.arange(hats.shape[1])
    nearest = np.searchsorted((held[1:] + held[:-1]) / 2, knots)
    return hats @ csr_array((np.ones(len(knots)), (knots, nearest)))


def _fit(x, told, waves, steady, echo=None, moving=None):
    """Return the lines and the echo (n,) in samples of which `told` says which tell of them."""
    from scipy.sparse import diags_array, hstack
    from scipy.sparse.linalg import splu

    shapes, carriers = [steady] * len(waves), list(waves)
    if echo is not None:
        shapes, carriers = [*shapes, moving], [*carriers, echo]
    A = hstack([diags_array(c) @ shape for c, shape in zip(carriers, shapes, strict=True)], "csc")
    AH = (diags_array(told.astype(float)) @ A).conj().T
    N, b = (AH @ A).tocsc(), AH @ x
    whole = np.concatenate([shape.power(2).sum(axis=0) for shape in shapes])
    held = np.flatnonzero(N.diagonal().real > _HELD * whole)
    of_lines = len(waves) * steady.shape[1]
    values = np.zeros(len(whole), complex)
    if len(held):
        values[held] = splu(N[:, held][held].tocsc()).solve(b[held])
    return A[:, :of_lines] @ values[:of_lines], A[:, of_lines:] @ values[of_lines:]
