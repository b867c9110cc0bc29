"""Figures of the chapter on the decision to stop: one approach, leads, misses."""

import numpy as np
from matplotlib.figure import Figure

from .._hints import Array, Index
from ..workspace.stopping import NEAR_MISS, RADIUS
from .consistent_tracker import TRACKERS
from .style import BOUND, TRUTH, drawing, looks

_PERCENT = 100


@drawing(7, 5.4)
def one_approach(
    figure: Figure,
    time: Array,
    panels: dict[str, dict[str, Array]],
    marks: dict[str, dict[str, float]],
    threshold: float,
) -> None:
    """Draw the probability of a collision by each tracker, over the time of single courses.

    time (O,): Time since the target has appeared, in s.
    panels (O,): By title of a course, then by tracker: probability; NaN after the end of a record.
    marks: By the same title, times in s that are named.
    threshold: Probability from which on the machine stops.
    """
    axes = figure.subplots(len(panels), 1, sharex=True, sharey=True, squeeze=False)[:, 0]
    for ax, (title, curves) in zip(axes, panels.items(), strict=True):
        for label, (color, line, _) in looks(curves, TRACKERS).items():
            ax.plot(time, curves[label], line, color=color, label=label)
        ax.axhline(threshold, color=BOUND, lw=0.8)
        for name, at in marks[title].items():
            ax.axvline(at, color=TRUTH, ls=":", lw=1)
            ax.annotate(
                name, (at, 0.5), (-3, 0), textcoords="offset points", rotation=90, fontsize="small",
                ha="right", va="center",
            )  # fmt: skip
        ax.set(title=title, ylabel="probability", ylim=(-0.03, 1.03))
    axes[-1].set_xlabel("time since the target has appeared (s)")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper center", ncols=4)


@drawing(7, 4.2)
def lead_by_false_alarms(
    figure: Figure, curves: dict[str, dict[str, Array]], marked: Index, titles: dict[str, str]
) -> None:
    """Draw the lead of trackers against their false alarms, a point for each threshold.

    curves (thresholds, 2): By rule, then by tracker: fraction of false alarms, and lead in s, minus
        infinite where there is none.
    marked: Place of the threshold whose points are filled.
    titles: By rule.
    """
    axes = figure.subplots(1, len(curves), squeeze=False)[0]
    for ax, (rule, trackers) in zip(axes, curves.items(), strict=True):
        for label, (color, line, mark) in looks(trackers, TRACKERS).items():
            false, lead = trackers[label].T
            false, lead = _PERCENT * false, np.maximum(lead, 0.0)
            ax.plot(
                false, lead, line, color=color, lw=1.2, marker=mark, ms=4, mfc="white", mew=0.9,
                label=label,
            )  # fmt: skip
            ax.plot(false[marked], lead[marked], mark, color=color, ms=7)
        ax.set_xscale("symlog", linthresh=0.5, linscale=0.5)
        ticks = [0, 0.5, 1, 2, 5, 10, 20, 50]
        ax.set_xticks(ticks, labels=[f"{tick:g}" for tick in ticks])
        ax.set_xticks([], minor=True)
        ax.set(title=titles[rule], xlabel="false alarms (%)", xlim=(-0.07, 60))
    axes[0].set_ylabel("lead of 95 % of the collisions (s)")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper center", ncols=2)


@drawing(7, 3.6)
def warned_by_time(figure: Figure, alarms: dict[str, Array], shaded: tuple[float, ...]) -> None:
    """Draw the fraction of the collisions that are foreseen, over the time since appearance.

    alarms (collisions,): By label, times in s of the decisions to stop; infinite without one.
    shaded: Range of times in s.
    """
    ax = figure.subplots()
    ax.axvspan(*shaded, color=BOUND, alpha=0.2, lw=0)
    for label, (color, line, _) in looks(alarms, TRACKERS).items():
        times = np.sort(alarms[label])
        share = _PERCENT * np.arange(1, len(times) + 1) / len(times)
        ax.step(times, share, line, color=color, where="post", label=label)
    ax.set(
        xlabel="time since the target has appeared (s)", ylabel="collisions foreseen (%)",
        xlim=(0, 0.5), ylim=(0, 101),
    )  # fmt: skip
    ax.legend(loc="lower right")


@drawing(7, 3.6)
def stopped_by_miss(figure: Figure, edges: Array, curves: dict[str, Array]) -> None:
    """Draw the fraction of courses for which the machine stops, over the closest approach.

    edges (B + 1,): Closest approaches in m from one class to the next.
    curves (B, 3): By tracker: fraction of the courses for which the machine stops, and the ends of
        its interval; NaN where there is no course.
    """
    ax = figure.subplots()
    ax.axvspan(*(_PERCENT * d for d in NEAR_MISS), color=BOUND, alpha=0.25, lw=0)
    ax.axvline(_PERCENT * RADIUS, color=TRUTH, ls=":", lw=1)
    middle = _PERCENT * (edges[1:] + edges[:-1]) / 2
    for label, (color, line, mark) in looks(curves, TRACKERS).items():
        value, low, high = _PERCENT * curves[label].T
        ax.errorbar(
            middle, value, [value - low, high - value], color=color, ls=line, marker=mark, ms=4,
            lw=1.2, elinewidth=0.8, label=label,
        )  # fmt: skip
    ax.set(xlabel="closest approach to the center (cm)", ylabel="machine stops (%)", ylim=(-3, 103))
    ax.set_xlim(0, _PERCENT * edges[-1])
    ax.legend(loc="upper right")
