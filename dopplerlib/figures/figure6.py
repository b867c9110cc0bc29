"""Figures of the chapter on Fig 6: the scene, position errors and NIS, published and ours."""

import numpy as np
from matplotlib.figure import Figure

from ..model.radar_array import RadarArray
from ..systems.mittermaier2016 import ExampleRuns, PublishedFigure6
from .style import BOUND, OURS, PUBLISHED, SENSOR, TRUTH, VARIANTS, drawing

_AXES = ("x", "y", "z")


@drawing(7.0, 5.0)
def scene(
    figure: Figure,
    result: ExampleRuns,
    published: PublishedFigure6,
    array: RadarArray,
    run: int = 0,
) -> None:
    """Draw the paper's scene from above and from the side: sensors, path, estimates of two runs.

    result: Our runs.
    published: The digitized figure.
    array: The sensors.
    run: Which run to draw.
    """
    estimate = result.track.x[run, ::20, :3]
    axes = figure.subplots(2, sharex=True, sharey=True)
    for i, (ax, title) in enumerate(zip(axes, ("from above", "from the side"), strict=True), 1):
        shown = [0, i]
        ax.plot(*array.positions[:, shown].T, "^", color=SENSOR, ms=8, label="sensors")
        ax.plot(*result.truth[:, shown].T, color=TRUTH, label="true path")
        ax.plot(*estimate[:, shown].T, "o", color=OURS, ms=3.5, label="our estimates")
        ax.plot(
            *published.path[:, shown].T, "s", mfc="none", mec=PUBLISHED, ms=4.5,
            label="published estimates",
        )  # fmt: skip
        ax.set(title=title, ylabel=f"{_AXES[i]} (m)", ylim=(-0.26, 0.26))
    axes[-1].set(xlabel="x (m)", xlim=(-0.03, 1))
    figure.legend(*ax.get_legend_handles_labels(), loc="outside upper center", ncols=4)


@drawing(7.0, 5.2)
def errors(figure: Figure, result: ExampleRuns, published: PublishedFigure6, run: int = 0) -> None:
    """Draw the absolute position errors of one run, and the published ones, axis by axis.

    result: Our runs.
    published: The digitized figure.
    run: Which run to draw.
    """
    axes = figure.subplots(3, sharex=True, sharey=True)
    for i, (ax, name) in enumerate(zip(axes, _AXES, strict=True)):
        ax.plot(
            published.time, 100 * published.error[:, i], "-D", color=PUBLISHED, lw=1, ms=5,
            markevery=50, mec="white", label="published",
        )  # fmt: skip
        ax.plot(result.time, 100 * result.error[run, :, i], color=OURS, label="ours, one run")
        ax.set(ylabel=f"error of {name} (cm)", ylim=(0, 16))
    axes[0].legend(loc="upper right")
    axes[-1].set(xlabel="time (s)", xlim=(0, 1))


@drawing(7.0, 6.4)
def error_bands(figure: Figure, result: ExampleRuns, published: PublishedFigure6) -> None:
    """Draw percentile bands of the absolute errors over all runs, and the published curves.

    result: Our runs.
    published: The digitized figure.
    """
    runs = len(result.error)
    axes = figure.subplots(3, sharex=True, sharey=True)
    for i, (ax, name) in enumerate(zip(axes, _AXES, strict=True)):
        band = 1000 * np.percentile(result.error[:, :, i], [2.5, 25, 50, 75, 97.5], axis=0)
        ax.fill_between(
            result.time, band[0], band[4], color=OURS, alpha=0.2, lw=0,
            label=f"central 95 % of {runs} runs",
        )  # fmt: skip
        ax.fill_between(
            result.time, band[1], band[3], color=OURS, alpha=0.35, lw=0, label="central 50 %"
        )
        ax.plot(result.time, band[2], color=OURS, label="median")
        ax.plot(
            published.time, 1000 * published.error[:, i], color=PUBLISHED, lw=1,
            label="published run",
        )  # fmt: skip
        ax.set(ylabel=f"error of {name} (mm)", yscale="log", ylim=(0.01, 400))
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper center", ncols=4)
    axes[-1].set(xlabel="time (s)", xlim=(0, 1))


@drawing(7.0, 5.0)
def nis(
    figure: Figure,
    result: ExampleRuns,
    published: PublishedFigure6,
    interval: tuple[float, ...],
    run: int = 0,
) -> None:
    """Draw NIS of one run above the published NIS, with the samples that were not used.

    result: Our runs.
    published: The digitized figure.
    interval: Bounds of NIS for a consistent filter.
    run: Which run to draw.
    """
    ours = result.track.nis[run], ~result.track.updated[run], "ours, one run", OURS
    theirs = published.nis, published.skipped, "published", PUBLISHED
    axes = figure.subplots(2, sharex=True, sharey=True)
    for ax, (values, skipped, label, color) in zip(axes, (ours, theirs), strict=True):
        ax.plot(result.time, values, color=color, lw=0.6, alpha=0.7)
        ax.plot(
            result.time[skipped], values[skipped], "o", mfc="none", color=TRUTH, ms=4.5,
            label=f"{label}: {skipped.sum()} samples not used",
        )  # fmt: skip
        for bound in interval:
            ax.axhline(bound, color=BOUND, ls="--", lw=1)
        ax.legend(loc="lower left", bbox_to_anchor=(0, 1), borderaxespad=0)
        ax.set(ylabel="NIS", yscale="log")
    axes[-1].set(xlabel="time (s)", xlim=(0, 1))


@drawing(7.0, 3.4)
def nis_averages(
    figure: Figure,
    results: dict[str, ExampleRuns],
    published_average: dict[str, float],
    interval: tuple[float, ...],
) -> None:
    """Draw the distribution over runs of the time average of NIS, for several filters.

    results: Runs of each filter, by label.
    published_average: Published averages, by label.
    interval: In which the average of a consistent filter lies.
    """
    ax = figure.subplots()
    for (label, result), (color, ls) in zip(results.items(), VARIANTS, strict=False):
        average = np.sort(result.track.nis.mean(axis=-1))
        share = np.arange(1, len(average) + 1) / len(average)
        ax.step(average, share, where="post", color=color, ls=ls, label=label)
    ax.axvspan(*interval, color=BOUND, alpha=0.25, lw=0, label="95 % if consistent")
    for (label, value), style in zip(published_average.items(), ("-", ":"), strict=False):
        ax.axvline(value, color=TRUTH, ls=style, lw=1.2, label=label)
    ax.set(xscale="log", xlim=(5, 100), ylim=(0, 1))
    ax.set_xticks([5, 6, 8, 10, 20, 50, 100], ["5", "6", "8", "10", "20", "50", "100"])
    ax.set_xticks([], minor=True)
    ax.set(xlabel="NIS averaged over one run", ylabel="fraction of runs below")
    ax.legend(loc="lower right")


@drawing(7.0, 3.8)
def skipped_counts(figure: Figure, result: ExampleRuns, published: PublishedFigure6) -> None:
    """Draw the number of samples that each run did not use: too good against too bad.

    result: Runs with the two-sided gate.
    published: The digitized figure.
    """

    def counts(values, skipped):
        # Both bounds of the gate lie on their own side of the mean, 6.
        low = np.sum(skipped & (values < 6), axis=-1)
        return low, np.sum(skipped, axis=-1) - low

    ax = figure.subplots()
    low, high = counts(result.track.nis, ~result.track.updated)
    ax.plot(low, high, "o", color=OURS, ms=3, alpha=0.3, mec="none", label="our runs")
    low, high = counts(published.nis, published.skipped)
    ax.plot(low, high, "D", color=PUBLISHED, ms=8, mec="white", label="published run")
    ax.set(yscale="log", ylim=(8, 1100))
    ax.set(xlabel="number of samples below the gate", ylabel="number of samples above")
    ax.legend(loc="upper right")
