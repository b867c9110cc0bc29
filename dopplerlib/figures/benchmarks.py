"""Figures of the chapter on benchmarks: times, with the spread of their rounds."""

import numpy as np
from matplotlib.figure import Figure

from .._hints import Array, Booleans, Positive
from ..evaluation.intervals import ConfidenceInterval
from .style import BOUND, ORANGE, OURS, PINK, TRUTH, VARIANTS, drawing, plain_log_ticks

_MARKERS = ("o", TRUTH), ("s", ORANGE), ("^", BOUND)


@drawing(7.0, 4.2)
def step_times(figure: Figure, times: dict[str, dict[str, Array]], unit: str) -> None:
    """Draw times as a marker at the median and a line from least to most, a row for each name.

    times (R,): For each kind and name the times of all rounds; a name may be of some kinds only.
    unit: Unit of the times, as the axis shows it.
    """
    ax = figure.subplots()
    names = list(dict.fromkeys(name for kind in times.values() for name in kind))
    for (kind, rows), (marker, color) in zip(times.items(), _MARKERS, strict=False):
        least, middle, most = np.quantile(list(rows.values()), [0, 0.5, 1], axis=-1)
        places = [names.index(name) for name in rows]
        error = np.stack([middle - least, most - middle])
        ax.errorbar(
            middle, places, xerr=error, fmt=marker, color=color, ms=5, capsize=2, label=kind
        )
    ax.set(xlabel=f"time ({unit})", xscale="log", ylim=(len(names) - 0.5, -0.5))
    ax.set_yticks(range(len(names)), names)
    for label, name in zip(ax.get_yticklabels(), names, strict=True):
        label.set(color=OURS if name.startswith("dopplerlib") else TRUTH)
    ax.grid(visible=True, axis="x")
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, 1.12), ncols=len(times))


@drawing(7.0, 5.0)
def start_success(
    figure: Figure,
    points: dict[str, dict[str, tuple[Positive, ConfidenceInterval]]],
    curves: dict[str, tuple[Array, Array]],
) -> None:
    """Draw the fraction of scenarios whose optimum is found, by time, a panel for each case.

    points: For each case and method the time of a scenario in ms, and the share with its interval.
    curves (M,), (M,): For each case times in ms and shares of random starts, from one start on.
    """
    panels = figure.subplots(2, 2, sharex=True, sharey=True).flat
    for ax, (case, methods) in zip(panels, points.items(), strict=True):
        ax.plot(*curves[case], "-", color=TRUTH, label="least_squares, random starts")
        looks = ("o", OURS), ("s", OURS), ("^", ORANGE), ("D", PINK)
        for (marker, color), (name, (ms, share)) in zip(looks, methods.items(), strict=True):
            error = [[share.value - share.low], [share.high - share.value]]
            ax.errorbar(ms, share.value, error, fmt=marker, color=color, capsize=2, label=name)
        ax.set(title=case, xscale="log", ylim=(0, 1.05))
    for ax in figure.axes[2:]:
        ax.set(xlabel="time a scenario (ms)")
    for ax in figure.axes[::2]:
        ax.set(ylabel="fraction of optima found")
    handles, names = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, names, loc="outside upper center", ncols=3)


@drawing(7.0, 3.6)
def frequency_error(
    figure: Figure, errors: dict[str, tuple[Array, Array, Array]], allowed: Positive
) -> None:
    """Draw the error of padded transforms beyond that of the maximum of the likelihood.

    errors (M,), (M,), (M,): For each method points of the transform, the ratio of its rms error to
        that of the likelihood, and the standard error of this ratio; a band has two of them.
    allowed: The ratio that is allowed.
    """
    ax = figure.subplots()
    ax.axhline(100 * (allowed - 1), ls=":", color=BOUND)
    for (color, line), (name, (points, ratio, deviation)) in zip(
        VARIANTS, errors.items(), strict=False
    ):
        excess, width = 100 * (ratio - 1), 200 * deviation
        ax.plot(points, excess, line, marker=".", color=color, label=name)
        low = np.maximum(excess - width, 1e-2)
        ax.fill_between(points, low, excess + width, color=color, alpha=0.2, lw=0)
    ax.set(xscale="log", yscale="log", ylim=(0.1, None))
    ax.set(xlabel="number of points of the transform", ylabel="error beyond the likelihood's (%)")
    ax.legend()


@drawing(7.0, 3.8)
def scan_times(figure: Figure, times: dict[str, tuple[Array, Array]]) -> None:
    """Draw the time of a scan by its detections, labeled at the end of each line.

    times (M,), (M, R): For each name numbers of detections, and times in s of all rounds.
    """
    ax = figure.subplots()
    for (color, line), (name, (count, seconds)) in zip(VARIANTS, times.items(), strict=False):
        least, middle, most = 1e3 * np.quantile(seconds, [0, 0.5, 1], axis=-1)
        ax.plot(count, middle, line, marker="o", ms=4, color=color)
        ax.fill_between(count, least, most, color=color, alpha=0.2, lw=0)
        label = {"textcoords": "offset points", "ha": "right", "color": color}
        ax.annotate(name, (count[-1], middle[-1]), (-6, 5), **label)
    ax.set(xscale="log", yscale="log", ylabel="time a scan (ms)")
    ax.set(xlabel="number of detections in a scan")


@drawing(7.0, 3.4)
def memory(figure: Figure, results: dict[str, Positive], most: dict[str, Positive]) -> None:
    """Draw the memory of a call, and that of its results, a row for each filter.

    results, most: For each name bytes a step and run of the results, and of the call at its most.
    """
    ax = figure.subplots()
    rows = range(len(results))
    ax.hlines(rows, list(results.values()), list(most.values()), color=BOUND, lw=3)
    ax.plot(list(results.values()), rows, "|", color=TRUTH, ms=14, mew=2, label="results")
    ax.plot(list(most.values()), rows, "o", color=ORANGE, ms=5, label="at the most")
    ax.set(xlabel="memory of a step and run (byte)", xscale="log", ylim=(len(rows) - 0.5, -0.5))
    ax.set_yticks(rows, list(results))
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, 1.14), ncols=2)


@drawing(7.0, 5.0)
def growth(
    figure: Figure,
    times: dict[str, tuple[Array, Array]],
    fits: dict[str, tuple[Positive, ConfidenceInterval, Booleans]],
) -> None:
    """Draw times by size, a panel for each way to grow, with the power law that was fitted.

    times (M,), (M, R): Sizes, and times in s of all rounds.
    fits: Time at size one in s, the exponent with its interval, and which sizes were fitted (M,).
    """
    panels = figure.subplots(2, 2).flat
    for ax, (name, (size, seconds)) in zip(panels, times.items(), strict=True):
        one, exponent, used = fits[name]
        least, middle, most = 1e3 * np.quantile(seconds, [0, 0.5, 1], axis=-1)
        ax.fill_between(size, least, most, color=OURS, alpha=0.2, lw=0)
        ax.plot(size[~used], middle[~used], "o", color=OURS, mfc="none")
        ax.plot(size[used], middle[used], "o", color=OURS)
        ax.plot(size, 1e3 * one * size**exponent.value, "--", color=TRUTH, lw=1)
        text = f"exponent {exponent.value:.2f}\n({exponent.low:.2f} to {exponent.high:.2f})"
        ax.text(0.05, 0.93, text, transform=ax.transAxes, va="top")
        ax.set(xlabel=f"number of {name}", ylabel="time (ms)")
        ax.set(xscale="log", yscale="log")
        for axis, span in (
            (ax.xaxis, np.ptp(np.log10(size))),
            (ax.yaxis, np.ptp(np.log10(middle))),
        ):
            if span < 2:
                plain_log_ticks(axis)
