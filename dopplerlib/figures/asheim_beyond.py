"""Figures of the chapter on better trackers: bounds, consistency, and sweeps of settings."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse

from .._hints import Array
from ..evaluation.intervals import ConfidenceInterval
from .asheim_two import TRACKERS
from .style import BOUND, OURS, SENSOR, TRUTH, VARIANTS, drawing, looks, plain_log_ticks


@drawing(7.0, 7.2)
def bound_map(
    figure: Figure,
    x: Array,
    y: Array,
    deviation: Array,
    sensors: Array,
    points: Array,
    covariances: Array,
    scale: float,
    baselines: Array,
    across: dict[str, Array],
) -> None:
    """Draw the bound on a position over the plane, as ellipses, and over the baseline.

    x, y (M,): Coordinates of the grid in m.
    deviation (L, M): Root of the trace of the bound in m.
    sensors (2, 2): Positions of the radars in m.
    points (J, 2): Centers of the ellipses in m.
    covariances (J, 2, 2): Bounds there.
    scale: Half axes of an ellipse in standard deviations.
    baselines (B,): Baselines in m.
    across (B,): Bounds on a standard deviation by label.
    """
    plane, below = figure.subplots(2, 1, height_ratios=(5, 3))
    levels = [0.01, 0.03, 0.1, 0.3, 1.0, 3.0]
    lines = plane.contour(x, y, deviation, levels, colors=BOUND, linewidths=1.2)
    for label in plane.clabel(lines, fmt="%g m", fontsize=11, colors=TRUTH):
        label.set_bbox({"fc": "white", "ec": "none", "pad": 1.0})
    for p, P in zip(points, covariances, strict=True):
        values, vectors = np.linalg.eigh(P)
        angle = np.degrees(np.arctan2(vectors[1, 1], vectors[0, 1]))
        plane.add_patch(
            Ellipse(p, *(2 * scale * np.sqrt(values[::-1])), angle=angle, fc=OURS, alpha=0.5)
        )
        plane.plot(*p, ".", color=TRUTH, ms=4)
    plane.plot(*sensors.T, "o", color=SENSOR)
    plane.set(xlabel="x (m)", ylabel="y (m)", ylim=(-0.4, 5.6), aspect="equal")
    for (label, values), (color, ls) in zip(across.items(), VARIANTS, strict=False):
        below.plot(baselines, values, color=color, ls=ls, label=label)
    below.set(xlabel="baseline (m)", ylabel="bound on the standard\ndeviation (m)", yscale="log")
    plain_log_ticks(below.yaxis)
    below.legend(loc="upper right")


@drawing(7.0, 3.1)
def consistency(
    figure: Figure,
    time: Array,
    panels: dict[str, dict[str, Array]],
    interval: Sequence[tuple[float, float]],
) -> None:
    """Draw averages of NIS or NEES over time beside their interval for a consistent filter.

    time (K,): Time in s.
    panels (K,): For each title, averages divided by their degrees of freedom by label.
    interval: Interval of the average for a consistent filter, for each panel.
    """
    axes = figure.subplots(1, len(panels), squeeze=False)[0]
    for ax, (title, series), bounds in zip(axes, panels.items(), interval, strict=True):
        ax.axhspan(*bounds, color=BOUND, alpha=0.3, lw=0, label="consistent, 95 %")
        for label, (color, ls, _) in looks(series, TRACKERS).items():
            ax.plot(time, series[label], color=color, ls=ls, lw=1.2, label=label)
        ax.set(title=title, xlabel="time (s)", yscale="log")
        ax.legend(fontsize=8.5)
    axes[0].set_ylabel("average / degrees of freedom")


@drawing(7.0, 3.0)
def reach(figure: Figure, results: dict[str, dict[str, ConfidenceInterval]]) -> None:
    """Draw usable ranges with their intervals, by experiment and tracker.

    results: For each experiment, the usable range of each tracker in m; infinite values are drawn
        at the edge.
    """
    ax = figure.subplots()
    labels = list(next(iter(results.values())))
    edge = 7.2
    styles = {label: (color, mark) for label, (color, _, mark) in looks(labels, TRACKERS).items()}
    for row, series in enumerate(results.values()):
        for i, (label, value) in enumerate(series.items()):
            y = row + 0.22 * (i - (len(labels) - 1) / 2)
            color, mark = styles[label]
            low, middle, high = (min(v, edge) for v in (value.low, value.value, value.high))
            ax.plot([low, high], [y, y], color=color, lw=1.6)
            ax.plot(middle, y, ">" if value.value > edge else mark, color=color, ms=6)
    for label, (color, mark) in styles.items():
        ax.plot([], [], mark, color=color, ms=6, label=label)
    ax.set_yticks(range(len(results)), results)
    ax.set(xlabel="usable range from the origin (m)", xlim=(4.4, 7.4))
    ax.set_ylim(len(results) - 0.5, -0.5)
    figure.legend(loc="outside lower center", ncols=3)


@drawing(7.0, 3.3)
def sweep(
    figure: Figure, values: Array, errors: dict[str, Sequence[ConfidenceInterval]], xlabel: str
) -> None:
    """Draw the error of several trackers over a setting: a delay, a baseline.

    values (M,): Values of the setting.
    errors: Root mean square errors in m by label, one for each value.
    xlabel: Name and unit of the setting.
    """
    ax = figure.subplots()
    for label, (color, ls, mark) in looks(errors, TRACKERS).items():
        found = errors[label]
        low, middle, high = zip(*((e.low, e.value, e.high) for e in found), strict=True)
        ax.plot(values, middle, color=color, ls=ls, marker=mark, ms=5, label=label)
        ax.fill_between(values, low, high, color=color, alpha=0.2, lw=0)
    ax.set(xlabel=xlabel, ylabel="RMS position error (m)", yscale="log")
    plain_log_ticks(ax.yaxis)
    ax.legend()
