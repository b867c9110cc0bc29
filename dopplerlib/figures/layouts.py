"""Figures of the chapter on where to put the sensors: layouts, goals, errors, losses and maps."""

from collections.abc import Sequence
from textwrap import fill

import numpy as np
from matplotlib.figure import Figure

from .._hints import Array
from ..evaluation.intervals import ConfidenceInterval
from ..model.radar_array import RadarArray
from ..workspace.layout_results import TIMES, LayoutErrors
from .style import BOUND, LABEL, ORANGE, OURS, PINK, SENSOR, TRUTH, drawing, ink, plain_log_ticks

_MARKS = (
    (BOUND, "o", "-"), (OURS, "s", "--"), (PINK, "v", "-."), (ORANGE, "D", ":"),
    (SENSOR, "^", "-"), (TRUTH, "P", "--"),
)  # fmt: skip
_DISC = 0.2  # m
_COLUMNS = 4
_SIX = 9  # layouts of six sensors stand in front


@drawing(7, 6.8)
def gallery(figure: Figure, arrays: dict[str, RadarArray], notes: dict[str, str]) -> None:
    """Draw layouts as the target sees them, numbered, with a note below each.

    arrays: Layouts by name; sensors behind the plane are drawn hollow, with their depth in mm.
    notes: Text below each of them.
    """
    axes = figure.subplots(-(-len(arrays) // _COLUMNS), _COLUMNS).ravel()
    around = np.linspace(0, 2 * np.pi, 181)
    for number, (ax, (name, array)) in enumerate(zip(axes, arrays.items(), strict=False), 1):
        ax.plot(_DISC * np.cos(around), _DISC * np.sin(around), color=BOUND, lw=0.8)
        for x, y, z in array.positions:
            back = x < -0.002
            ax.plot(y, z, "o", ms=9, mec=SENSOR, mew=2, color="white" if back else SENSOR)
            if back:
                ax.annotate(f"{-1e3 * x:.0f}", (y, z), (11, -7), fontsize=8, **LABEL)
        ax.set_title(fill(f"{number}  {name}", 21), fontsize=9)
        ax.text(0.5, -0.02, notes[name], ha="center", va="top", transform=ax.transAxes, fontsize=9)
        ax.set(aspect="equal", xlim=(-0.23, 0.23), ylim=(-0.23, 0.23))
    for ax in axes:
        ax.axis("off")


@drawing(7, 3.6)
def goals(figure: Figure, bound: dict[str, float], wrong: dict[str, ConfidenceInterval]) -> None:
    """Draw the fraction of wrong sides of layouts over their bound, by their numbers.

    bound: Bound of the position by layout in mm.
    wrong: Fraction of runs on the wrong side by layout, in the same order.
    """
    ax = figure.subplots()
    for number, (name, x) in enumerate(bound.items(), 1):
        one = wrong[name]
        value, low, high = 100 * one.value, 100 * one.low, 100 * one.high
        color, marker = (ORANGE, "D") if number > _SIX else (OURS, "o")
        error = [[value - low], [high - value]]
        ax.errorbar(x, value, error, fmt=marker, color=color, ms=6, lw=0.8, capsize=2)
        ax.annotate(f"{number}", (x, value), (9, 6), fontsize=9, color=TRUTH, **LABEL)
    ax.plot([], [], "o", color=OURS, label="six sensors")
    ax.plot([], [], "D", color=ORANGE, label="seven, eight")
    ax.set(
        xlabel="bound of the position after 0.1 s, workspace (mm)",
        ylabel="runs on the wrong side after 0.2 s (%)",
    )
    ax.legend()


@drawing(7, 5.6)
def errors(
    figure: Figure,
    workspace: dict[str, LayoutErrors],
    table_2: dict[str, LayoutErrors],
) -> None:
    """Draw errors of range and wrong sides over time, with 95 % intervals.

    workspace: Errors of the tracker by layout, targets of the workspace.
    table_2: The same with the start of Table 2.
    """
    axes = figure.subplots(2, 2, sharex=True, sharey="row")
    titles = "targets of the workspace", "start of Table 2"
    for column, title, cases in zip(axes.T, titles, (workspace, table_2), strict=True):
        for (name, found), (color, marker, line) in zip(cases.items(), _MARKS, strict=False):
            style = {"color": color, "marker": marker, "ls": line, "ms": 4, "capsize": 2}
            _interval(column[0], found.range, 1.0, label=name, **style)
            _interval(column[1], found.wrong, 100.0, **style)
        column[0].set(title=title, yscale="log", xscale="log")
        column[1].set(xlabel="time (s)")
        plain_log_ticks(column[0].xaxis)
        plain_log_ticks(column[0].yaxis)
    axes[0, 0].set_ylabel("RMS range error (mm)")
    axes[1, 0].set_ylabel("wrong side, runs (%)")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=2)


@drawing(7, 3.6)
def losses(
    figure: Figure,
    whole: dict[str, LayoutErrors],
    lost: dict[str, Sequence[LayoutErrors]],
) -> None:
    """Draw the error of position after 0.2 s with all sensors, and with each of them lost.

    whole: Errors of the tracker by layout.
    lost: By layout, errors without one sensor after the other.
    """
    at = TIMES.index(0.2)
    ax = figure.subplots()
    for row, (name, found) in enumerate(whole.items()):
        values = [one.position[at].value for one in lost[name]]
        ax.plot(values, np.full(len(values), row), "o", color=ORANGE, mfc="white", ms=7,
                label="one sensor lost" if not row else None)  # fmt: skip
        ax.plot(found.position[at].value, row, "D", color=OURS, ms=7,
                label="all sensors" if not row else None)  # fmt: skip
    ax.set(
        xlabel="RMS error of position after 0.2 s (mm)", yticks=range(len(whole)),
        yticklabels=list(whole), xscale="log", ylim=(len(whole) - 0.5, -0.5),
    )  # fmt: skip
    plain_log_ticks(ax.xaxis)
    figure.legend(*ax.get_legend_handles_labels(), loc="outside upper center", ncols=2)


@drawing(7, 4.8)
def maps(
    figure: Figure, x: Array, y: Array, bound: dict[str, Array], chance: dict[str, Array]
) -> None:
    """Draw the bound and the probability of the second valley over the workspace, for some layouts.

    x (X,), y (Y,): Places of the target at time zero in m, in the plane z = 0.
    bound (Y, X): Bound of the position in mm by layout.
    chance (Y, X): Chance of the second valley by layout.
    """
    axes = figure.subplots(2, len(bound), sharex=True, sharey=True)
    rows = (
        (bound, "bound (mm)", "viridis", "{:.0f}", 1.0),
        (chance, "second valley (%)", "magma_r", "{:.1f}", 100.0),
    )
    for line, (values, label, colors, text, factor) in zip(axes, rows, strict=True):
        top = factor * max(np.max(each) for each in values.values())
        for ax, (name, value) in zip(line, values.items(), strict=True):
            value = factor * np.asarray(value)
            area = ax.pcolormesh(x, y, value, vmin=0, vmax=top, cmap=colors, shading="nearest")
            for (j, i), one in np.ndenumerate(value):
                ax.text(x[i], y[j], text.format(one), ha="center", va="center", fontsize=8,
                        color=ink(area.cmap(area.norm(one))))  # fmt: skip
            ax.grid(False)
            if values is bound:
                ax.set_title(fill(name, 17), fontsize=9)
        figure.colorbar(area, ax=list(line), label=label, aspect=20)
    for ax in axes[:, 0]:
        ax.set_ylabel("y (m)")
    for ax in axes[1]:
        ax.set_xlabel("x (m)")


def _interval(ax, intervals, factor, **style):
    value, low, high = np.transpose([(one.value, one.low, one.high) for one in intervals]) * factor
    ax.errorbar(TIMES, value, [value - low, high - value], **style)
