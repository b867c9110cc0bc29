"""Figures of the chapter on a failed filter: symptoms, repairs, and alarms."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from .._hints import Array, Booleans
from ..replication.published import Published
from ..systems.sombatsatien import PostMortem
from .style import BOUND, OURS, PUBLISHED, TRUTH, VARIANTS, drawing


@drawing(7.0, 2.9)
def symptoms(figure: Figure, result: PostMortem, told: Published, run: int = 0) -> None:
    """Draw distance, speed and position error of many runs beside the reported end values.

    result: Runs of the report's system.
    told: Results of the report.
    run: Which run to draw on its own.
    """
    x = result.track.x
    panels = (
        ("distance x (m)", x[..., 0], result.truth[:, 0], told.final_x),
        (
            "speed (m/s)",
            np.linalg.norm(x[..., 3:], axis=-1),
            np.linalg.norm(result.truth[:, 3:], axis=-1),
            np.linalg.norm(told.final_velocity),
        ),
        ("position error (m)", result.position_error, None, told.final_position_error),
    )
    axes = figure.subplots(1, 3)
    for ax, (label, values, truth, final) in zip(axes, panels, strict=True):
        low, high = np.percentile(values, [2.5, 97.5], axis=0)
        ax.fill_between(
            result.time, low, high, color=OURS, alpha=0.25, lw=0, label="95 % of our runs"
        )
        ax.plot(result.time, values[run], color=OURS, lw=1, label="one run")
        if truth is not None:
            ax.plot(result.time, truth, color=TRUTH, ls="--", label="truth")
        ax.plot(
            result.time[-1], final, "o", color=PUBLISHED, ms=6, mec="white", zorder=3,
            clip_on=False, label="report, at the end",
        )  # fmt: skip
        ax.set(xlabel="time (s)", ylabel=label)
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper center", ncols=4)


@drawing()
def repair_ranges(
    figure: Figure, rows: dict[str, dict[str, Array]], reported: dict[str, tuple[str, float]]
) -> None:
    """Draw median and central 95 % of the runs for each quantity and repair.

    rows (runs,): For each variant, by its name, the same quantities by theirs.
    reported: Value of the report or of a consistent filter, by the name of the quantity: a pair of
        label and number.
    """
    names = list(next(iter(rows.values())))
    place = -np.arange(len(rows))
    figure.set_size_inches(7.0, 0.3 * len(rows) + 1.2)
    axes = figure.subplots(1, len(names), sharey=True, squeeze=False)[0]
    for ax, name in zip(axes, names, strict=True):
        for y, quantities in zip(place, rows.values(), strict=True):
            low, middle, high = np.percentile(quantities[name], [2.5, 50, 97.5])
            ax.plot([low, high], [y, y], color=OURS, lw=2, alpha=0.45, solid_capstyle="butt")
            ax.plot(middle, y, "o", color=OURS, ms=5)
        label, value = reported[name]
        color = PUBLISHED if label == "report" else BOUND
        ax.axvline(value, color=color, ls=":" if label == "report" else "--", lw=1.3)
        ax.text(
            value, 0.7, f" {label}", color=color, fontsize=8.5, va="center",
            ha="left",
        )  # fmt: skip
        ax.set(xscale="log", ylim=(place[-1] - 0.6, 1.1))
        ax.set_xlabel(name, fontsize=9.5)
        ax.grid(axis="y", visible=False)
    axes[0].set_yticks(place, rows)


@drawing(7.0, 2.9)
def alarm_shares(
    figure: Figure, looks: Sequence[int], cases: dict[str, dict[str, Booleans]]
) -> None:
    """Draw the fraction of runs in which each test has raised an alarm, over the samples.

    looks: Numbers of samples after which the tests were taken.
    cases (runs, looks): For each filter, by its name, what `innovation_alarms` returned.
    """
    axes = figure.subplots(1, len(cases), sharey=True, squeeze=False)[0]
    for ax, (title, alarms) in zip(axes, cases.items(), strict=True):
        for (name, hits), (color, ls) in zip(alarms.items(), VARIANTS, strict=False):
            share = np.logical_or.accumulate(hits, axis=-1).mean(axis=0)
            ax.step(looks, share, where="post", color=color, ls=ls, label=name)
        ax.set(xscale="log", xlabel="samples", ylim=(-0.03, 1.03))
        ax.set_title(title, fontsize=9.5)
    axes[0].set_ylabel("fraction of runs")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper center", ncols=3)
