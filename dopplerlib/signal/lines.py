"""Lines at known frequencies, such as the hum of mains or a constant that drifts, taken out."""

from collections.abc import Sequence

import numpy as np

from .. import _checks
from .._hints import AboveZero, checked
from .._typing import ArrayLike, BoolArray, ComplexArray
from .sliding import sliding_doppler
from .validity import known_samples

_ROUNDS = 4  # of finding the echo beside the lines, and the lines beside the echo
_SEEN = 20.0  # integrated signal-to-noise ratio of an echo, as that of `track_iq`
_HELD = 1e-6  # of the energy of a knot's function: of less, samples say nothing of its value


@checked
@_checks.quiet
def remove_lines(
    x: ArrayLike,
    fs: AboveZero,
    lines: ArrayLike,
    window: int,
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
        What is nearer to a line is lost, in Hz, see `near_lines`. The amplitude of a line, a
        complex one, goes straight for ``4 / width`` seconds: the mains' frequency is known to a
        tenth of a hertz, and a constant may drift in such a time.
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
        If a valid sample is not finite, a line is not below fs/2, or an argument is refused by
        `sliding_doppler`.

    Notes
    -----
    Least squares over the whole record. The unknowns are the amplitude of each line at knots
    ``4 / width`` apart, straight between them, and that of the echo at knots two windows apart,
    whose phase is the integral of its Doppler shift in sliding windows. Shifts and amplitudes are
    found in turn, four times.

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
    lines = _frequencies(lines, fs)
    n = x.shape[-1]
    rows = x.reshape(-1, n)
    good = np.ones(rows.shape, dtype=bool) if valid is None else valid.reshape(-1, n)
    if not len(lines) or not rows.size:
        return x
    t = np.arange(n) / fs
    waves = np.exp(2j * np.pi * t * np.union1d(lines, -lines)[:, None])
    steady, moving = _hats(n, 4 * fs / width), _hats(n, 2 * window)
    out = np.empty_like(rows)
    for i, (row, sound) in enumerate(zip(rows, good, strict=True)):
        line = _fit(row, sound, waves, steady)
        for _ in range(_ROUNDS):
            phase, seen, near = _echo(
                np.where(sound, row - line, 0.0), sound, fs, window, band, lines, width
            )
            if not seen.any():
                break
            echo = np.where(seen, np.exp(1j * phase), 0.0)
            line = _fit(row, sound & ~near, waves, steady, echo, moving)
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


def _frequencies(lines, fs):
    lines = np.abs(_checks.finite("lines", lines).ravel())
    if not (lines < fs / 2).all():
        raise ValueError(f"lines must be below fs / 2 = {fs / 2:g}, got {lines.max():g}")
    return lines


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


def _fit(x, told, waves, steady, echo=None, moving=None):
    """Return the lines (n,) in samples of which `told` says which tell of them."""
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
    amplitudes = np.zeros(len(whole), complex)
    if len(held):
        amplitudes[held] = splu(N[:, held][held].tocsc()).solve(b[held])
    of_lines = len(waves) * steady.shape[1]
    return A[:, :of_lines] @ amplitudes[:of_lines]
