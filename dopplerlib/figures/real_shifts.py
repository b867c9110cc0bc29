"""Figures of the chapter on receivers that hear GPS satellites."""

import numpy as np
from matplotlib.figure import Figure

from .._hints import Array
from .style import BOUND, MEASURED, OURS, SENSOR, TRUTH, VARIANTS, drawing

_QUANTILE = 5.991  # of chi-square with two degrees of freedom: 95 %
_ANGLE = np.linspace(0, 2 * np.pi, 181)


@drawing(7.0, 3.4)
def steps(figure: Figure, distances: dict[str, Array]) -> None:
    """Draw the distance of a search from its end, step by step, from many starts.

    distances: For each receiver the distances (starts, steps) in m.
    """
    ax = figure.subplots()
    for (name, values), (color, line) in zip(distances.items(), VARIANTS, strict=False):
        number = np.arange(values.shape[1])
        ax.semilogy(number, values.T, color=color, ls=line, lw=0.6, alpha=0.6)
        ax.plot([], [], color=color, ls=line, label=f"{name}, {len(values)} starts")
    ax.axhline(6.371e6, color=BOUND, lw=0.8, ls=":")
    ax.annotate("radius of the earth", (0.98, 6.371e6), xycoords=("axes fraction", "data"),
                xytext=(0, -12), textcoords="offset points", ha="right", color=BOUND)  # fmt: skip
    ax.set(xlabel="number of steps", ylabel="distance from the end (m)", ylim=(0.5, 5e7))
    ax.legend(loc="lower left")


@drawing(7.0, 5.0)
def fixes(
    figure: Figure,
    epochs: dict[str, Array],
    spread: dict[str, Array],
    places: dict[str, dict[str, tuple[Array, Array]]],
) -> None:
    """Draw fixes of single epochs above, and of whole recordings below, with their ellipses.

    epochs: For each receiver the fixes (K, 2) of single epochs, east and north of the place by
        code ranges, in m.
    spread: For each receiver the covariance (2, 2) that they claim.
    places: For each receiver and way the fix (2,) of the whole recording and its covariance (2, 2).
    """
    axes = figure.subplots(2, len(epochs))
    for (upper, lower), name in zip(axes.T, epochs, strict=True):
        upper.plot(*epochs[name].T, ".", color=MEASURED, ms=3, label="one epoch")
        upper.plot(*_ellipse(np.zeros(2), spread[name]), color=OURS, label="claimed, 95 %")
        for (way, (place, P)), (color, line) in zip(places[name].items(), VARIANTS, strict=False):
            lower.plot(*place, "o", color=color, ms=4)
            lower.plot(*_ellipse(place, P), color=color, ls=line, label=way)
        for ax in (upper, lower):
            ax.plot(0, 0, "+", color=TRUTH, ms=9, mew=1.5, label="code ranges")
            ax.set_aspect("equal", adjustable="datalim")
        upper.set_title(name)
        lower.set_xlabel("east (m)")
    for row in axes:
        row[0].set_ylabel("north (m)")
    handles = {
        label: handle
        for ax in axes[:, 0]
        for handle, label in zip(*ax.get_legend_handles_labels(), strict=True)
    }
    figure.legend(handles.values(), handles, loc="outside lower center", ncols=5)


@drawing(7.0, 3.4)
def noise(figure: Figure, seen: dict[str, tuple[Array, Array]], levels: dict[str, float]) -> None:
    """Draw the standard deviation of the residuals of each satellite over its C/N0.

    seen: For each receiver C/N0 (S,) in dB-Hz and standard deviations (S,) in Hz.
    levels: The standard deviation at 45 dB-Hz in Hz, of the rule that falls by ten for 20 dB.
    """
    ax = figure.subplots()
    axis = np.array([36.0, 54.0])
    for (name, (cn0, sigma)), (color, line), mark in zip(
        seen.items(), VARIANTS, "osD", strict=False
    ):
        ax.semilogy(axis, levels[name] * 10 ** ((45 - axis) / 20), color=color, ls=line)
        ax.plot(cn0, sigma, mark, color=color, ms=5, label=name)
    ax.set(xlabel="C/N0 (dB-Hz)", ylabel="standard deviation (Hz)")
    ax.legend()


@drawing(7.0, 3.0)
def filtered(
    figure: Figure,
    time: dict[str, Array],
    error: dict[str, Array],
    claimed: dict[str, Array],
    batch: dict[str, float],
) -> None:
    """Draw the errors of the filter from epoch to epoch, and its standard deviation.

    time, error, claimed: For each receiver (K,): s, and m.
    batch: Errors of the fix by all epochs at once in m.
    """
    axes = figure.subplots(1, len(time), sharey=True)
    for ax, name in zip(axes, time, strict=True):
        ax.semilogy(time[name], error[name], color=OURS, label="error")
        ax.plot(time[name], claimed[name], color=SENSOR, ls="--", label="claimed")
        ax.axhline(batch[name], color=BOUND, lw=1, ls=":", label="all at once")
        ax.set(title=name, xlabel="time (s)")
    axes[0].set_ylabel("position (m)")
    axes[-1].legend(loc="upper right")


def _ellipse(center, P):
    """Return the points of the ellipse that holds 95 % of a normal density, shape (2, 181)."""
    circle = np.array([np.cos(_ANGLE), np.sin(_ANGLE)])
    return center[:, None] + np.linalg.cholesky(_QUANTILE * P) @ circle
