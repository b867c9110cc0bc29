"""Figures of the chapter on windows and fusion: paths, errors, failures, correlation."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from .._hints import Array
from ..evaluation.intervals import ConfidenceInterval, quantile_interval
from ..systems.valarmathi import ALGORITHMS, AlgorithmRuns, FusionStudy, VelocityPath, WindowTable
from .style import BOUND, ORANGE, OURS, PINK, PUBLISHED, SENSOR, TRUTH, VARIANTS, drawing

# The color of algorithms 1 to 6, and a line and a mark for print in gray.
_STYLES = {
    1: (BOUND, "-", "o"),
    2: (ORANGE, "--", "s"),
    3: (TRUTH, ":", "v"),
    4: (PINK, "-.", "D"),
    5: (SENSOR, "--", "^"),
    6: (OURS, "-", "X"),
}
# A legend inside of the axes covers the grid behind it.
_FRAME = dict(frameon=True, facecolor="white", edgecolor="none", framealpha=1.0)


@drawing(7.0, 2.8)
def paths(figure: Figure, several: Sequence[VelocityPath]) -> None:
    """Draw velocity over time for several paths.

    several: To draw, each with its name.
    """
    ax = figure.subplots()
    for path, (color, line) in zip(several, VARIANTS, strict=False):
        ax.plot(path.time, path.v, color=color, ls=line, label=path.name)
    ax.set(xlabel="time (s)", ylabel="velocity (m/s)", ylim=(0, None))
    ax.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0))


@drawing(7.0, 3.4)
def window_error(figure: Figure, table: WindowTable, snr_db: float) -> None:
    """Draw the cumulative error over the window, a line for each acceleration: Fig 3.

    table: Of a simulation.
    snr_db: One of its signal-to-noise ratios.
    """
    j = int(np.flatnonzero(table.snrs_db == snr_db)[0])
    shades = np.linspace(0.75, 0.0, len(table.accelerations))
    ax = figure.subplots()
    for a, cee, shade in zip(table.accelerations, table.cee[:, j], shades, strict=True):
        color = (shade * 0.8, 0.3 + 0.5 * shade, 0.55 + 0.35 * shade)
        ax.plot(table.windows, cee, color=color)
        best = int(np.argmin(cee))
        ax.plot(table.windows[best], cee[best], "o", color=color, ms=6, mec="white")
        ax.annotate(
            f"{a:g} m/s²", (table.windows[-1], cee[-1]), xytext=(5, 0), va="center",
            textcoords="offset points", fontsize=9, annotation_clip=False,
        )  # fmt: skip
    ax.set(xscale="log", xlabel="window (samples)")
    ax.set(yscale="log", ylabel="running relative error (cee)")
    ax.set_xticks(table.windows, [str(window) for window in table.windows])
    ax.minorticks_off()


@drawing()
def velocities(
    figure: Figure,
    results: Sequence[AlgorithmRuns],
    run: int = 0,
    numbers: Sequence[Sequence[int]] = (),
) -> None:
    """Draw velocities of sensor 1, sensor 2 and both, fixed window: Figs 7 to 9 and 11 to 13.

    results: A row for each.
    run: Which run to draw.
    numbers: For each result, the numbers of the three figures of the document.
    """
    figure.set_size_inches(7.0, 2.5 * len(results) + 0.5)
    rows = figure.subplots(len(results), 3, sharex=True, sharey="row", squeeze=False)
    told = numbers or [(0, 0, 0)] * len(results)
    for result, axes, three in zip(results, rows, told, strict=True):
        panels = (
            ("sensor 1", result.velocity(1, sensor=1)),
            ("sensor 2", result.velocity(1, sensor=2)),
            ("fused", result.velocity(3)),
        )
        window = (result.time > 5.7) & (result.time < 7.0)
        for ax, (name, v), number in zip(axes, panels, three, strict=True):
            ax.plot(result.time, result.truth, color=TRUTH, ls="--", lw=1.2, label="truth")
            ax.plot(result.time, v[run], color=OURS, lw=1.2, label="estimate")
            ax.set_title(f"{name} (their Fig {number})" if number else name)
            inset = ax.inset_axes([0.3, 0.56, 0.68, 0.42])
            inset.plot(result.time[window], result.truth[window], color=TRUTH, ls="--", lw=1)
            inset.plot(result.time[window], v[run, window], color=OURS, lw=1)
            inset.set(xticks=[], yticks=[])
            ax.indicate_inset_zoom(inset, edgecolor=BOUND)
            inset.grid(False)
        low, high = result.truth.min(), result.truth.max()
        space = 0.05 * (high - low)
        axes[0].set_ylim(low - space, high + 1.4 * (high - low))  # room for the insets
        axes[0].set_yticks(
            np.linspace(low, high, 3), [f"{v:.0f}" for v in np.linspace(low, high, 3)]
        )
        axes[0].set_ylabel(f"{result.path.name}: velocity (m/s)")
    for ax in rows[-1]:
        ax.set(xlabel="time (s)", xticks=range(0, 16, 5))
    figure.legend(*rows[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=2)


@drawing()
def cumulative_errors(
    figure: Figure,
    results: Sequence[AlgorithmRuns],
    lines: Sequence[Sequence[tuple[int, int]]],
    titles: Sequence[str] = (),
    ncols: int = 2,
) -> None:
    """Draw the running error of some algorithms, mean over the runs: Figs 10, 14, 15 and 16.

    results: A panel for each.
    lines: For each panel, which algorithms, and the filter of which sensor.
    titles: Of the panels; the names of the paths if empty.
    ncols: Panels side by side.
    """
    nrows = -(-len(results) // ncols)
    figure.set_size_inches(7.0, 2.5 * nrows + 0.5)
    axes = figure.subplots(nrows, ncols, sharex=True, squeeze=False).flat
    titles = titles or [result.path.name for result in results]
    for ax, result, shown, title in zip(axes, results, lines, titles, strict=True):
        time = result.time[result.during("all")]
        for algorithm, sensor in shown:
            color, line, _ = _STYLES[algorithm]
            single = algorithm in (1, 2, 6)
            behind = single and sensor == 1  # wide and pale: both sensors are nearly the same
            ax.plot(
                time, 100 * result.cee(algorithm, sensor).mean(axis=0), color=color,
                ls="-" if behind else line, lw=4 if behind else 1.4, alpha=0.4 if behind else 1,
                label=ALGORITHMS[algorithm] + (f", sensor {sensor}" if single else ""),
            )  # fmt: skip
        ax.set_title(title)
        ax.set(ylabel="relative error, cee (%)", ylim=(0, None), xticks=range(0, 16, 5))
        ax.legend(fontsize=8.5, **_FRAME)
    for ax in figure.axes[-ncols:]:
        ax.set_xlabel("time (s)")


@drawing(7.0, 6.6)
def sweep(figure: Figure, study: FusionStudy, failed: float, limits: Sequence[float]) -> None:
    """Draw RMS errors over the SNR: in the maneuvers, and at constant velocity.

    study: Drawn are the medians over the runs with their 95 % intervals: of each path in the
        maneuver, and of its second one at constant velocity.
    failed: Error in m/s from which a run has failed.
    limits: Signal-to-noise ratios in dB at which the document sees its limits.
    """
    panels = [(path, "maneuver", f"{path}, in the maneuver") for path in study.paths]
    panels.append((study.paths[1], "constant", f"{study.paths[1]}, constant velocity"))
    axes = figure.subplots(2, 2, sharex=True, sharey="row")
    for ax, (path, phase, title) in zip(axes.flat, panels, strict=True):
        for algorithm, name in ALGORITHMS.items():
            color, line, mark = _STYLES[algorithm]
            found = [quantile_interval(runs) for runs in study.of(phase, path, algorithm)]
            middle, low, high = np.array([[e.value, e.low, e.high] for e in found]).T
            ax.fill_between(study.snrs_db, low, high, color=color, alpha=0.25, lw=0)
            ax.plot(
                study.snrs_db, middle, color=color, ls=line, marker=mark, ms=3.5, lw=1.3,
                label=name,
            )  # fmt: skip
        ax.axhline(failed, color=BOUND, lw=0.8, label=f"failed: {failed:g} m/s")
        for i, limit in enumerate(limits):
            named = f"limits in the document: {' and '.join(f'{one:g}' for one in limits)} dB"
            label = named if i == 0 else None
            ax.axvline(limit, color=PUBLISHED, lw=1.2, ls=":", label=label)
        ax.set_title(title)
        ax.set(yscale="log")
    for ax in axes[:, 0]:
        ax.set_ylabel("RMSE (m/s)")
    for ax in axes[-1]:
        ax.set_xlabel("SNR (dB)")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=3)


@drawing(7.0, 3.1)
def failures(
    figure: Figure,
    shares: dict[tuple[str, int], tuple[Array, Sequence[ConfidenceInterval]]],
    failed_share: float,
) -> None:
    """Draw the percentage of failed runs over the SNR, for each path.

    shares: By path and algorithm, as `failed_shares` returns it.
    failed_share: Fraction of failed runs from which an algorithm has failed.
    """
    paths_ = list(dict.fromkeys(path for path, _ in shares))
    axes = figure.subplots(1, len(paths_), sharey=True, squeeze=False)[0]
    for ax, path in zip(axes, paths_, strict=True):
        for algorithm, name in ALGORITHMS.items():
            color, line, mark = _STYLES[algorithm]
            snrs_db, found = shares[path, algorithm]
            value, low, high = 100 * np.array([[e.value, e.low, e.high] for e in found]).T
            ax.fill_between(snrs_db, low, high, color=color, alpha=0.2, lw=0)
            ax.plot(snrs_db, value, color=color, ls=line, marker=mark, ms=3.5, lw=1.3, label=name)
        failed = f"failed: {failed_share:.0%} of the runs"
        ax.axhline(100 * failed_share, color=BOUND, lw=0.8, label=failed)
        ax.set_title(path)
        ax.set_xlabel("SNR (dB)")
    axes[0].set_ylabel("failed runs (%)")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper center", ncols=3)


@drawing(7.0, 2.8)
def correlation(figure: Figure, measured: Array, law: Array) -> None:
    """Draw the autocorrelation of measurement errors beside its closed form.

    measured, law (lags + 1,): From lag 0 on, in samples.
    """
    ax = figure.subplots()
    ax.plot(measured, color=OURS, label="simulation")
    ax.plot(law, color=TRUTH, ls="--", lw=1.2, label="closed form")
    ax.axhline(0, color=BOUND, lw=0.8)
    ax.set(xlabel="lag (samples)", ylabel="autocorrelation", ylim=(-0.6, 1))
    ax.legend(**_FRAME)
