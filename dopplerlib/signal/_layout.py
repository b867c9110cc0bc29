"""Channels of a file as samples of sensors, and whether I and Q turn together."""

import numpy as np

LAYOUTS = ("iq", "qi", "real")
_WINDOWS = (0.05, 0.4)  # s: short for a Doppler shift that changes, long for a small one
_LEAST = 64  # samples of a window: fewer have too few frequencies for a noise floor
_MOST = 64  # windows: more than enough, whatever the length of the record
_NEAR_DC = 4  # bins: the mean and the noise that grows towards 0 Hz
_AROUND = 33  # bins whose median tells the noise
_STRONG = 36  # of that median: 18 dB above the noise
_TURNS = 0.8  # an image 9.5 dB below the line; no usable module comes near it
_FEW = 6  # strong windows that are needed for a verdict


def samples(values, layout):
    """Return values (n, C) of C channels as samples (S, n) of sensors, complex or real."""
    if layout == "real":
        return values.T
    if layout == "qi":
        values = values.reshape(len(values), -1, 2)[..., ::-1].reshape(values.shape)
    return np.ascontiguousarray(values, dtype=float).view(complex).T


def analytic(x):
    """Return the analytic signal of real samples (S, n): their positive frequencies, doubled."""
    from scipy.fft import next_fast_len
    from scipy.signal import hilbert

    n = x.shape[-1]
    return np.stack([hilbert(row, next_fast_len(n))[:n] for row in x])


def turning(x, valid, fs):
    """Tell for each sensor whether I and Q turn together.

    x (S, n)
    valid (S, n)
    Returns (S,): Share of the windows with a strong line in which such a line turns; NaN if there
        are too few to tell.

    Notes
    -----
    The Doppler shift of an echo has one sign: a line at f has an image at -f that is weaker by the
    imbalance of I and Q, 15 to 30 dB. Two real channels give each line twice, as strong at -f as at
    f; if both see the same Doppler shift, their phases happen to be a quarter turn apart for some
    of the time. So a line turns if its image is at least 9.5 dB weaker.
    """
    strong, turns = np.zeros((2, len(x)), dtype=int)
    n = x.shape[-1]
    for seconds in _WINDOWS:
        length = 2 ** round(np.log2(max(seconds * fs, _LEAST)))
        if length > n:
            continue
        starts = np.arange(0, n - length + 1, length // 2)
        starts = starts[:: -(-len(starts) // _MOST)]
        for i, (row, good) in enumerate(zip(x, valid, strict=True)):
            for a in starts:
                if good[a : a + length].all():
                    found, turned = _lines(row[a : a + length])
                    strong[i] += found
                    turns[i] += turned
    return np.where(strong >= _FEW, turns / np.maximum(strong, 1), np.nan)


def _lines(window):
    """Return whether a window has a strong line, and whether one of them turns."""
    from scipy.ndimage import median_filter

    n = len(window)
    taper = np.hanning(n + 1)[:n]
    window = window - np.average(window, weights=taper)
    power = np.abs(np.fft.fft(window * taper)) ** 2
    positive, negative = power[1 : n // 2], power[: n // 2 : -1]
    both = positive + negative
    floor = median_filter(both, _AROUND, mode="nearest")
    line = both > _STRONG * floor
    line[: _NEAR_DC - 1] = False
    turned = np.abs(positive - negative) > _TURNS * both
    return line.any(), (line & turned).any()
