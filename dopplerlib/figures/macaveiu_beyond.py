"""Figures of the chapter on polar measurements, clutter, maneuvers and crossings."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from .._hints import Array, Booleans
from ..evaluation.intervals import ConfidenceInterval
from .style import BOUND, ORANGE, OURS, PUBLISHED, TRUTH, VARIANTS, drawing, plain_log_ticks

_KMH = 3.6  # km/h for each m/s


@drawing(7.0, 3.2)
def side_by_side(
    figure: Figure,
    time: Array,
    truth: Array,
    tracks: dict[str, Array],
    limits: tuple[float, float] | None = None,
) -> None:
    """Draw the path and the speed along x as estimated by several filters.

    time (K,): Time in s.
    truth (K, 4): True states.
    tracks (runs, K, 4): Estimates of each filter; some runs are drawn.
    limits: Limits of the y axis of the path in m.
    """
    left, right = figure.subplots(1, 2)
    looks = ((OURS, "-"), (ORANGE, "--"), (PUBLISHED, "-."))
    for (label, x), (color, ls) in zip(tracks.items(), looks, strict=False):
        for i, one in enumerate(x[:10]):
            name = label if i == 0 else None
            left.plot(one[:, 0], one[:, 2], color=color, ls=ls, lw=0.8, alpha=0.7, label=name)
            right.plot(time, _KMH * one[:, 1], color=color, ls=ls, lw=0.8, alpha=0.7)
    left.plot(truth[:, 0], truth[:, 2], color=TRUTH, ls="--", label="truth")
    right.plot(time, _KMH * truth[:, 1], color=TRUTH, ls="--", label="truth")
    left.set(xlabel="x (m)", ylabel="y (m)")
    if limits is not None:
        left.set_ylim(*limits)
    right.set(xlabel="time (s)", ylabel="$v_x$ (km/h)")
    left.legend(loc="best")


@drawing(7.0, 3.2)
def hole(
    figure: Figure, time: Array, rates: dict[str, Array], v_min: float, deviations: dict[str, Array]
) -> None:
    """Draw the range rates that a clutter rule tests, and the errors during the gap that it leaves.

    time (K,): Time in s.
    rates (K,): Range rate of each path in m/s.
    v_min: Range rate below which a detection is deleted, in m/s.
    deviations (K,): For each way to use the rule, the root mean square position error in m.
    """
    left, right = figure.subplots(1, 2)
    left.axhspan(-v_min, v_min, color=BOUND, alpha=0.3, lw=0, label="deleted")
    for (label, rate), (color, ls) in zip(rates.items(), VARIANTS, strict=False):
        left.plot(time, rate, color=color, ls=ls, label=label)
    left.set(xlabel="time (s)", ylabel="range rate (m/s)")
    left.legend(loc="best")
    for (label, error), (color, ls) in zip(deviations.items(), VARIANTS, strict=False):
        right.plot(time[1:], error[1:], color=color, ls=ls, label=label)
    right.set(xlabel="time (s)", ylabel="RMS position error (m)", yscale="log")
    plain_log_ticks(right.yaxis)
    right.legend(loc="best")


@drawing()
def over_time(
    figure: Figure,
    time: Array,
    errors: dict[str, Array],
    shaded: Booleans,
    ylabel: str,
    mode: Array | None = None,
) -> None:
    """Draw the root mean square error of several estimators over time.

    time (K,): Time in s.
    errors (K,): Error of each estimator.
    shaded (K,): When the target turns.
    ylabel: Name and unit of the error.
    mode (K,): Probability of the agile model, drawn below.
    """
    rows = 1 if mode is None else 2
    ratios = [1] if mode is None else [3, 1]
    figure.set_size_inches(7.0, 3.0 + 1.2 * (rows - 1))
    axes = figure.subplots(rows, 1, sharex=True, squeeze=False, height_ratios=ratios)[:, 0]
    for ax in axes:
        if shaded.any():
            ax.axvspan(*time[shaded][[0, -1]], color=BOUND, alpha=0.2, lw=0)
    for (label, error), (color, ls) in zip(errors.items(), VARIANTS, strict=False):
        axes[0].plot(time, error, color=color, ls=ls, label=label)
    axes[0].set(ylabel=ylabel, yscale="log")
    axes[0].legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=3, fontsize=8.5)
    if mode is not None:
        axes[1].plot(time, mode, color=OURS)
        axes[1].set(ylabel="probability\nof agile", ylim=(0, 1))
    axes[-1].set_xlabel("time (s)")


@drawing(7.0, 3.2)
def crossings(
    figure: Figure,
    truth: Array,
    estimates: Array,
    shares: dict[str, Sequence[ConfidenceInterval]],
    angles: Sequence[float],
) -> None:
    """Draw two crossing targets, and the fraction of runs with swapped or merged tracks.

    truth (2, K, 4): True states.
    estimates (2, K, 4): Estimates of one run.
    shares: For each label, the fraction of the runs at each angle.
    angles: In degrees.
    """
    left, right = figure.subplots(1, 2)
    for one, color in zip(estimates, (OURS, ORANGE), strict=True):
        left.plot(one[:, 0], one[:, 2], color=color, lw=1.3)
    for one in truth:
        left.plot(one[:, 0], one[:, 2], color=TRUTH, ls="--", lw=1)
    left.set(xlabel="x (m)", ylabel="y (m)", title="one run, Hungarian")
    for (label, share), (color, ls) in zip(shares.items(), VARIANTS, strict=False):
        middle = np.array([one.value for one in share])
        ends = np.array([[one.value - one.low, one.high - one.value] for one in share]).T
        right.errorbar(
            angles, middle, yerr=ends, color=color, ls=ls, marker="o", ms=3.5, capsize=3,
            label=label,
        )  # fmt: skip
    right.set(xlabel="angle between the paths (degrees)", ylabel="fraction of runs")
    right.set_ylim(-0.03, 1.03)
    right.legend(loc="upper right")
