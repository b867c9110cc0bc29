"""Figures of the chapter on a module beside a road: ridges on a spectrogram, and their errors."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from .._hints import Array
from ..chain.ridges import Ridge
from ..signal.spectrogram import Spectrogram
from .style import BOUND, MEASURED, ORANGE, OURS, PINK, SKY, drawing

_RANGE = 45.0  # dB
_COLORS = ORANGE, PINK, OURS, "#F0E442", SKY


@drawing(7, 3.6)
def ridges(figure: Figure, seen: Spectrogram, found: Sequence[Ridge]) -> None:
    """Draw ridges over the spectrogram of one module without Q.

    seen: Spectrogram of real samples, of which the positive frequencies are drawn.
    found: What was followed in them.
    """
    up = seen.frequency > 0
    db = seen.db[up]
    left, right = figure.subplots(1, 2, sharex=True, sharey=True)
    for ax in (left, right):
        top = db.max()
        area = ax.pcolormesh(
            seen.time, seen.frequency[up], db, vmin=top - _RANGE, vmax=top, cmap="gray_r",
            rasterized=True,
        )  # fmt: skip
        ax.set(xlabel="time (s)", xlim=(seen.time[0], seen.time[-1]))
        ax.grid(False)
    left.set(ylabel="frequency (Hz)", title="spectrogram")
    for i, ridge in enumerate(found):
        color = _COLORS[i % len(_COLORS)]
        right.plot(ridge.time, np.abs(ridge.frequency), ".", ms=3, color=color)
    right.set_title("followed")
    figure.colorbar(area, ax=[left, right], label="power density (dB)", aspect=30)


@drawing(7, 3.3)
def deviations(figure: Figure, ridge: Ridge, truth: Array) -> None:
    """Draw the errors of a ridge beside two claims of their standard deviation.

    ridge: A ridge.
    truth (K,): True frequencies in Hz.
    """
    ax = figure.subplots()
    error = np.abs(np.abs(ridge.frequency) - np.abs(truth))
    ax.semilogy(ridge.time, error, ".", ms=3, color=MEASURED, label="error, absolute value")
    ax.semilogy(ridge.time, ridge.std, "-", color=OURS, label="deviation from the data")
    ax.semilogy(ridge.time, ridge.bound, "--", color=BOUND, label="bound of a pure tone")
    ax.set(xlabel="time (s)", ylabel="frequency (Hz)", ylim=(0.05, 2000))
    figure.legend(*ax.get_legend_handles_labels(), loc="outside upper center", ncols=3)
