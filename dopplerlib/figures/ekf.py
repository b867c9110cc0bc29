"""Figures of the chapter on the Kalman filter: bands, linearization, consistency, covariances."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from .._hints import Array
from .style import BOUND, OURS, TRUTH, VARIANTS, drawing


@drawing(7.0, 3.4)
def bands(
    figure: Figure,
    time: Array,
    truth: Array,
    x: Array,
    deviation: Array,
    measured: Array | None = None,
) -> None:
    """Draw position and velocity on one axis: truth, estimate and two standard deviations.

    time (K,): Time in s.
    truth (K, 2): True position in m and velocity in m/s.
    x (K, 2): Estimates.
    deviation (K, 2): Standard deviations of `x` as the filter reports them.
    measured (K,): Velocities that the measurements alone give, in m/s.
    """
    for i, ax in enumerate(figure.subplots(1, 2)):
        if i == 1 and measured is not None:
            ax.plot(time, measured, ".", color=BOUND, ms=2.5, label="measured alone")
        ax.fill_between(
            time, *(x[:, i] + sign * 2 * deviation[:, i] for sign in (-1, 1)),
            color=OURS, alpha=0.25, lw=0, label="± 2 standard deviations",
        )  # fmt: skip
        ax.plot(time, x[:, i], color=OURS, label="estimate")
        ax.plot(time, truth[:, i], color=TRUTH, ls="--", label="truth")
        ax.set(xlabel="time (s)", ylabel=("position (m)", "velocity (m/s)")[i])
    figure.legend(*ax.get_legend_handles_labels(), loc="outside upper center", ncols=4)


@drawing(7.0, 3.2)
def tangent(figure: Figure, step: Array, shift: Array, line: Array, sigma_f: float) -> None:
    """Draw the Doppler shift along a line through the state space, and its tangent.

    step (M,): Distance from the point of tangency, in standard deviations of the prior.
    shift (M,): Doppler shift in Hz.
    line (M,): The linear approximation of `shift` in Hz.
    sigma_f: Standard deviation of a measurement in Hz.
    """
    left, right = figure.subplots(1, 2)
    left.plot(step, shift, color=TRUTH, label="Doppler shift, Eq 6")
    left.plot(step, line, color=OURS, ls="--", label="linearized, Eq 7")
    left.set(ylabel="Doppler shift (Hz)")
    missed = np.abs(shift - line)
    right.plot(step, missed, color=OURS, label="their difference")
    right.axhline(sigma_f, color=BOUND, ls=":", label="noise, one standard deviation")
    right.set(yscale="log", ylabel="absolute value (Hz)", ylim=(sigma_f / 100, 30 * missed.max()))
    for ax, place in ((left, "upper right"), (right, "upper center")):
        ax.set_xlabel("distance (standard deviations)")
        ax.legend(loc=place)


@drawing(7.0, 3.0)
def second_order(figure: Figure, time: Array, ratios: dict[str, Array], ylabel: str) -> None:
    """Draw the terms that linearization neglects over time, for several filters.

    time (K,): Time in s; it is drawn on a logarithmic axis.
    ratios (K,): For each label, the neglected term as a multiple of the noise.
    ylabel: Label of the vertical axis.
    """
    ax = figure.subplots()
    for (label, ratio), (color, ls) in zip(ratios.items(), VARIANTS, strict=False):
        ax.plot(time, ratio, color=color, ls=ls, label=label)
    ax.axhline(1, color=BOUND, ls=":", label="as large as the noise")
    ax.set(xscale="log", yscale="log", xlabel="time (s)", ylabel=ylabel)
    ax.legend()


@drawing(7.0, 4.6)
def consistency(
    figure: Figure,
    time: Array,
    averages: Sequence[dict[str, tuple[Array, Array]]],
    intervals: tuple[tuple[float, float], tuple[float, float]],
    titles: Sequence[str],
) -> None:
    """Draw average NEES and NIS of many runs, for several targets side by side.

    time (K,): Time in s.
    averages (K,): For each target, what each filter reached: averages of NEES and of NIS over the
        runs.
    intervals: Where the averages of a consistent filter lie, for NEES and for NIS.
    titles: Names of the targets.
    """
    axes = figure.subplots(2, len(averages), sharex=True, sharey="row", squeeze=False)
    for column, (filters, title) in enumerate(zip(averages, titles, strict=True)):
        axes[0, column].set_title(title)
        for row, interval in enumerate(intervals):
            ax = axes[row, column]
            ax.axhspan(*interval, color=BOUND, alpha=0.35, lw=0, label="consistent")
            for (label, pair), (color, ls) in zip(filters.items(), VARIANTS, strict=False):
                ax.plot(time, pair[row], color=color, ls=ls, lw=1.2, label=label)
            ax.set_yscale("log")
        axes[1, column].set_xlabel("time (s)")
    axes[0, 0].set_ylabel("average NEES")
    axes[1, 0].set_ylabel("average NIS")
    axes[0, 0].legend()


@drawing(7.0, 3.4)
def gap(
    figure: Figure, time: Array, deviations: dict[str, Array], gaps: Sequence[tuple[float, float]]
) -> None:
    """Draw standard deviations over time for several records, and where sensors are missing.

    time (K,): Time in s.
    deviations (K, 6): For each label, the standard deviations of the state.
    gaps: When sensors were missing, in s.
    """
    axes = figure.subplots(1, 2)
    for ax, i, name in zip(axes, (0, 3), ("$x$ (mm)", "$v_x$ (mm/s)"), strict=True):
        for start, end in gaps:
            ax.axvspan(start, end, color=BOUND, alpha=0.2, lw=0)
        for (label, deviation), (color, ls) in zip(deviations.items(), VARIANTS, strict=False):
            ax.plot(time, 1e3 * deviation[:, i], color=color, ls=ls, label=label)
        ax.set(xlabel="time (s)", ylabel=f"standard deviation of {name}", ylim=(0, None))
    axes[0].legend(loc="lower left")


@drawing(7.0, 4.8)
def covariance_health(figure: Figure, step: Array, results: dict[str, dict[str, Array]]) -> None:
    """Draw asymmetry and smallest eigenvalue of a computed covariance over a long run.

    step (M,): Array of the steps at which the matrices were looked at.
    results (up to M, 6, 6): For each title of a column and each label, covariances scaled to a unit
        diagonal. A series that is shorter than the others of its column ended because a variance
        became negative.
    """
    axes = figure.subplots(2, len(results), sharex="col", sharey="row", squeeze=False)
    for (top, bottom), (title, series) in zip(axes.T, results.items(), strict=True):
        top.set_title(title)
        longest = max(map(len, series.values()))
        for (label, C), (color, ls) in zip(series.items(), VARIANTS, strict=False):
            across = np.swapaxes(C, -1, -2)
            asymmetry = np.abs(C - across).max(axis=(-2, -1))
            least = np.linalg.eigvalsh((C + across) / 2)[:, 0]
            at = step[: len(C)] / 1000
            style = {"color": color, "ls": ls, "lw": 1.2}
            top.plot(at, np.where(asymmetry > 0, asymmetry, np.nan), **style)
            bottom.plot(at, np.where(least > 0, least, np.nan), label=label, **style)
            if len(C) < longest:
                top.plot(at[-1], asymmetry[-1], "x", color=color, mew=2)
                bottom.plot(at[-1], np.abs(least[-1]), "x", color=color, mew=2)
        top.set(yscale="log", ylim=(1e-16, 30))
        bottom.set(yscale="log", ylim=(5e-8, 3), xlabel="step (thousands)")
    axes[0, 0].set_ylabel("relative asymmetry")
    axes[1, 0].set_ylabel("relative least eigenvalue")
    axes[1, 0].legend(loc="upper right", ncols=2)
