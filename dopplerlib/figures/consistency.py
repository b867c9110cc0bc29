"""Figures of the chapter on consistency: chi-square, averages, clouds of errors, causes."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse

from .._hints import Array
from ..systems.mittermaier2016 import Consistency
from .style import BOUND, ORANGE, OURS, PINK, SENSOR, TRUTH, VARIANTS, drawing

# A cause is told from the others by color, line and marker.
CAUSES = (
    (TRUTH, "-", "o"),
    (BOUND, "--", "s"),
    (ORANGE, "-", "v"),
    (PINK, "-.", "D"),
    (OURS, "-", "^"),
    (SENSOR, "-", "P"),
)


@drawing(7.0, 3.4)
def chi_square(
    figure: Figure,
    densities: dict[int, tuple[Array, Array]],
    interval: tuple[float, ...],
    sums: dict[int, Array],
    filled: int,
) -> None:
    """Draw chi-square densities, one with its interval filled, over histograms of simulated sums.

    densities (M,): For each number of degrees of freedom, places and density.
    interval: What to fill.
    sums (R,): For each number of degrees of freedom, sums of that many squares of normal numbers.
    filled: Of which density.
    """
    ax = figure.subplots()
    edges = np.linspace(0, 20, 81)
    for (dof, (q, density)), (color, ls) in zip(densities.items(), VARIANTS, strict=False):
        counts, _ = np.histogram(sums[dof], edges)
        height = counts / len(sums[dof]) / np.diff(edges)
        ax.stairs(height, edges, color=color, lw=0.8, alpha=0.5)
        ax.plot(q, density, color=color, ls=ls, label=f"{dof} degrees of freedom")
        if dof == filled:
            inside = (q >= interval[0]) & (q <= interval[1])
            ax.fill_between(
                q[inside], density[inside], color=color, alpha=0.2, lw=0,
                label=f"95 %: {interval[0]:.3f} to {interval[1]:.3f}",
            )  # fmt: skip
    ax.set(xlabel="sum of squares", ylabel="probability density", xlim=(0, 20), ylim=(0, 0.5))
    ax.legend(loc="upper right")


@drawing(7.0, 3.6)
def clouds(
    figure: Figure, errors: dict[str, Array], covariances: dict[str, Array], names: Sequence[str]
) -> None:
    """Draw errors of many runs in two components, and the ellipse in which 95 % should lie.

    errors (runs, 2): Errors for each filter, in m.
    covariances (2, 2): Covariances that each filter reports.
    names: The two components.
    """
    axes = figure.subplots(1, len(errors), sharex=True, sharey=True)
    for ax, (label, error) in zip(axes, errors.items(), strict=True):
        ax.plot(*error.T, "o", color=OURS, ms=2, alpha=0.4, mec="none", label="errors of runs")
        size, axis = np.linalg.eigh(covariances[label])
        # Two degrees of freedom: the probability outside is exp(-r^2 / 2).
        width, height = 2 * np.sqrt(-2 * np.log(0.05) * size)
        angle = np.degrees(np.arctan2(axis[1, 0], axis[0, 0]))
        ax.add_patch(
            Ellipse(
                (0, 0), width, height, angle=angle, fill=False, color=TRUTH, lw=1.6,
                label="95 % by its covariance",
            )
        )  # fmt: skip
        ax.set_title(label)
        ax.set(xlabel=f"{names[0]} (m)", xlim=(-0.4, 0.4), ylim=(-0.3, 0.3))
    axes[0].set_ylabel(f"{names[1]} (m)")
    axes[0].legend(loc="upper left")


@drawing(7.0, 4.0)
def one_run(
    figure: Figure, time: Array, values: dict[str, Array], interval: tuple[float, ...]
) -> None:
    """Draw statistics of a single run over time, with the interval of a single value.

    time (K,): Time in s.
    values (K,): Each statistic, by name.
    interval: Where 95 % of the values lie.
    """
    axes = figure.subplots(len(values), sharex=True, sharey=True)
    for ax, (name, value) in zip(axes, values.items(), strict=True):
        ax.axhspan(*interval, color=BOUND, alpha=0.25, lw=0, label="95 % of single values")
        ax.plot(time, value, color=OURS, lw=0.8, label="one run")
        ax.set(ylabel=name, ylim=(0, 25))
    axes[0].legend(loc="upper right", ncols=2)
    axes[-1].set(xlabel="time (s)", xlim=(time[0], time[-1]))


@drawing(7.0, 3.0)
def averages_spread(
    figure: Figure, averages: dict[str, Array], intervals: dict[str, dict[str, tuple[float, ...]]]
) -> None:
    """Draw the distribution of time averages over consistent runs, with two intervals.

    averages (runs,): Time averages of each statistic, one for each run.
    intervals: For each statistic, intervals by label.
    """
    axes = figure.subplots(1, len(averages), sharex=True)
    for ax, (name, average) in zip(axes, averages.items(), strict=True):
        ax.hist(average, np.linspace(2, 12, 81), color=OURS, alpha=0.45, label="consistent runs")
        styles = ((TRUTH, "--"), (ORANGE, "-"))
        for (label, interval), (color, ls) in zip(intervals[name].items(), styles, strict=False):
            for bound, text in zip(interval, (label, None), strict=True):
                ax.axvline(bound, color=color, ls=ls, label=text)
        ax.set(xlabel=f"{name} averaged over a run", xlim=(2, 12))
    axes[0].set_ylabel("number of runs")
    handles = {}  # the panels share labels
    for ax in axes:
        handles |= {
            text: handle for handle, text in zip(*ax.get_legend_handles_labels(), strict=True)
        }
    figure.legend(handles.values(), handles.keys(), loc="outside upper center", ncols=3)


@drawing(7.0, 3.4)
def autocorrelations(figure: Figure, curves: dict[str, Array], bound: float) -> None:
    """Draw the autocorrelation of innovations of several filters, and the band of white ones.

    curves (lags,): Mean autocorrelation at lags 1, 2, ... of each filter, by label.
    bound: Half width of the band in which 95 % of the values of a white record are.
    """
    ax = figure.subplots()
    ax.axhspan(-bound, bound, color=BOUND, alpha=0.25, lw=0, label="95 % of a white record")
    for (label, curve), (color, ls, marker) in zip(curves.items(), CAUSES, strict=False):
        lags = np.arange(1, len(curve) + 1)
        ax.plot(lags, curve, color=color, ls=ls, marker=marker, ms=4, label=label)
    ax.set(xlabel="lag (samples used)", ylabel="autocorrelation of innovations", ylim=(-0.2, 1))
    ax.legend(loc="upper right")


@drawing(7.0, 5.0)
def causes(
    figure: Figure, results: dict[str, Consistency], interval: tuple[float, ...], median: float
) -> None:
    """Draw the median NEES and NIS of several filters over time, both axes logarithmic.

    results: Runs of each filter, by label.
    interval: Where 95 % of single values of a consistent filter lie.
    median: Their median.
    """
    axes = figure.subplots(1, 2, sharex=True, sharey=True)
    for ax, name in zip(axes, ("nees", "nis"), strict=True):
        ax.axhspan(*interval, color=BOUND, alpha=0.25, lw=0, label="95 % of consistent values")
        ax.axhline(median, color=BOUND, lw=1, label="their median")
        for (label, result), (color, ls, marker) in zip(results.items(), CAUSES, strict=False):
            values = np.median(getattr(result, name), axis=0)
            # The first sample, at 0, belongs to a logarithmic axis at one interval.
            time = result.time + (result.time[1] - result.time[0])
            ax.plot(time, values, color=color, ls=ls, marker=marker, ms=4, label=label)
        ax.set(xscale="log", yscale="log", xlabel="time (s)", ylim=(0.05, 1000))
        ax.set_ylabel(f"median {name.upper()}")
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=2)


@drawing(7.0, 3.4)
def claims(figure: Figure, time: Array, spread: Array, claimed: dict[str, Array]) -> None:
    """Draw the actual error of the range, and the standard deviation that two filters state.

    time (M,): Time since the start in s.
    spread (M,): Size of the actual error in m.
    claimed (M,): Standard deviation of the range as each filter reports it, in m.
    """
    ax = figure.subplots()
    ax.plot(time, spread, color=TRUTH, marker="o", ms=4, label="actual error of the EKF")
    styles = ((OURS, "--", "s"), (SENSOR, "-.", "^"))
    for (label, value), (color, ls, marker) in zip(claimed.items(), styles, strict=False):
        ax.plot(time, value, color=color, ls=ls, marker=marker, ms=4, label=label)
    ax.set(xscale="log", yscale="log", xlabel="time (s)", ylabel="error of the range (m)")
    ax.legend(loc="lower left")
