"""Figures of the chapter on the linear filter: tracks, claims over settings, lag, NIS."""

from collections.abc import Sequence

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from .._hints import Array
from ..evaluation.intervals import ConfidenceInterval
from ..systems.macaveiu2013 import AutomotiveSettings, VehicleRuns, decided_claims
from .style import BOUND, ORANGE, OURS, PINK, TRUTH, VARIANTS, drawing, plain_log_ticks

_KMH = 3.6  # km/h for each m/s
_SETTINGS = {
    "sigma_x": r"position noise $\sigma_x$ (m)",
    "sigma_v": r"velocity noise $\sigma_v$ (m/s)",
    "w": "velocity step $w$ of the filter (m/s)",
}


@drawing(7.0, 3.0)
def three_panels(figure: Figure, time: Array, runs: VehicleRuns, run: int = 0) -> None:
    """Draw position and both speeds as in Figs 7 to 11: measurements, truth, estimate.

    time (K,): Time in s.
    runs: From `track`; one of the runs is drawn, and the range of all for the speeds.
    run: Which run.
    """
    truth, z, x = runs.path.truth, runs.z[run], runs.x[run]
    axes = figure.subplots(1, 3)
    for ax, part in zip(axes, ((0, 2), (1,), (3,)), strict=True):
        if len(part) == 2:
            lines = [(one[:, 0], one[:, 2]) for one in (z, truth, x)]
            ax.set(xlabel="x (m)", ylabel="y (m)", title="a: position")
            ax.margins(x=0.25)
        else:
            (i,) = part
            lines = [(time, _KMH * one[:, i]) for one in (z, truth, x)]
            band = _KMH * np.quantile(runs.x[:, 1:, i], [0.025, 0.975], axis=0)
            look = {"color": OURS, "alpha": 0.25, "lw": 0, "label": "95 % of all runs"}
            ax.fill_between(time[1:], *band, **look)
            name = {1: "$v_x$", 3: "$v_y$"}[i]
            ax.set(
                xlabel="time (s)",
                ylabel=f"{name} (km/h)",
                title={1: "b: speed along x", 3: "c: speed along y"}[i],
            )
            middle = (_KMH * truth[:, i].max() + _KMH * truth[:, i].min()) / 2
            half = max(5, 0.8 * _KMH * np.ptp(truth[:, i]))
            ax.set_ylim(middle - half, middle + half)
        ax.plot(*lines[0], "x", color=BOUND, ms=2.5, mew=0.5, alpha=0.6, label="measured")
        ax.plot(*lines[2], color=OURS, lw=1.4, label="estimate")
        ax.plot(*lines[1], color=TRUTH, ls="--", lw=1.2, label="truth")
    figure.legend(*ax.get_legend_handles_labels(), loc="outside upper center", ncols=4)


@drawing(7.0, 5.2)
def claim_map(
    figure: Figure,
    rows: tuple[str, Sequence[float]],
    columns: tuple[str, Sequence[float]],
    shares: dict[str, Array],
    settings: AutomotiveSettings,
) -> None:
    """Draw the percentage of runs in which each claim holds, over two settings.

    rows, columns: Name and values of a setting, as `regions.claim_map` takes them.
    shares (3, rows, columns): Fraction of the runs for each claim, and the ends of its interval,
        which decide: a line surrounds the places in which a claim holds for sure; where the runs
        are too few to tell, the place is hatched.
    settings: Our choice, to be marked.
    """
    (row, heights), (column, widths) = rows, columns
    x, y = widths.index(getattr(settings, column)), heights.index(getattr(settings, row))
    axes = figure.subplots(2, 2, sharex=True, sharey=True)
    for ax, (title, share) in zip(axes.ravel(), shares.items(), strict=True):
        ax.imshow(share[0], origin="lower", aspect="auto", cmap="cividis", vmin=0, vmax=1)
        verdict = decided_claims(share)
        for (i, j), value in np.ndenumerate(share[0]):
            color = "black" if value > 0.6 else "white"
            ax.text(j, i, f"{100 * value:.0f}", ha="center", va="center", color=color, size=9.5)
            if not verdict[i, j]:
                undecided = Rectangle((j - 0.5, i - 0.5), 1, 1, fc="none", ec=color, lw=0)
                undecided.set(hatch="////", alpha=0.4)
                ax.add_patch(undecided)
        _surround(ax, verdict > 0)
        ax.add_patch(Rectangle((x - 0.46, y - 0.46), 0.92, 0.92, fc="none", ec=OURS, lw=2))
        ax.grid(False)
        ax.set_xticks(range(len(widths)), [f"{one:g}" for one in widths])
        ax.set_yticks(range(len(heights)), [f"{one:g}" for one in heights])
        ax.set_title(title)
    for ax in axes[-1]:
        ax.set_xlabel(_SETTINGS[column])
    for ax in axes[:, 0]:
        ax.set_ylabel(_SETTINGS[row])


def _surround(ax, inside):
    """Draw the border between the places of an image that are inside and the others."""
    framed = np.pad(inside, 1)
    upright = np.argwhere(framed[:, 1:] != framed[:, :-1])
    level = np.argwhere(framed[1:] != framed[:-1])
    sides = [((j - 0.5, i - 1.5), (j - 0.5, i - 0.5)) for i, j in upright]
    sides += [((j - 1.5, i - 0.5), (j - 0.5, i - 0.5)) for i, j in level]
    for color, width in (("white", 4.5), (TRUTH, 2.2)):  # black on bright cells, a rim on dark ones
        look = {"colors": color, "linewidths": width, "capstyle": "projecting", "zorder": 3}
        ax.add_collection(LineCollection(sides, clip_on=False, **look), autolim=False)


@drawing(7.0, 3.2)
def lags(
    figure: Figure,
    w: Array,
    predicted: Array,
    noise: Array,
    measured: dict[float, tuple[ConfidenceInterval, ConfidenceInterval]],
) -> None:
    """Draw lag and residual noise over the velocity step of the filter.

    w (M,): Velocity steps of the filter in m/s.
    predicted (M, 2): Predicted lag of position in m and speed in m/s.
    noise (M, 2): Predicted deviation by noise.
    measured: For some w, the mean error of position and speed in many runs.
    """
    for i, ax in enumerate(figure.subplots(1, 2)):
        ax.plot(w, predicted[:, i], color=PINK, ls="-.", label="lag, predicted")
        ax.plot(w, noise[:, i], color=ORANGE, ls="--", label="noise, predicted")
        both = np.hypot(predicted, noise)[:, i]
        ax.plot(w, both, color=BOUND, ls=":", label="both")
        points = [pair[i] for pair in measured.values()]
        middle = np.array([one.value for one in points])
        ends = np.array([[one.value - one.low, one.high - one.value] for one in points]).T
        ax.errorbar(
            list(measured), middle, yerr=ends, fmt="o", color=OURS, ms=4, capsize=3,
            label="mean error of the runs",
        )  # fmt: skip
        ax.set(xscale="log", yscale="log", xlabel="velocity step $w$ (m/s)")
        ax.set_ylabel(("position error (m)", "speed error (m/s)")[i])
        ax.set_ylim(0.004, None)
    figure.legend(*ax.get_legend_handles_labels(), loc="outside upper center", ncols=4)


@drawing(7.0, 3.2)
def nis_and_nees(
    figure: Figure,
    time: Array,
    averages: dict[str, tuple[Array, Array]],
    intervals: tuple[tuple[float, float], tuple[float, float]],
) -> None:
    """Draw the average NIS and NEES of several paths.

    time (K,): Time in s.
    averages (K,): For each path, averages over the runs of NIS and NEES.
    intervals: Intervals of both averages for a consistent filter.
    """
    axes = figure.subplots(1, 2, sharey=True)
    for i, (ax, name) in enumerate(zip(axes, ("NIS", "NEES"), strict=True)):
        ax.axhspan(*intervals[i], color=BOUND, alpha=0.4, lw=0, label="consistent")
        for (label, pair), (color, ls) in zip(averages.items(), VARIANTS, strict=False):
            ax.plot(time, pair[i], color=color, ls=ls, lw=1.1, label=label)
        ax.set(xlabel="time (s)", ylabel=f"average {name}", yscale="log")
        plain_log_ticks(ax.yaxis)
    axes[0].legend(loc="upper right")
