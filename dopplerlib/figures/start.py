"""Figures of the chapter on initialization: the misfit, errors of starts, maps of errors."""

from collections.abc import Sequence

import numpy as np
from matplotlib.colors import BoundaryNorm, LogNorm
from matplotlib.figure import Figure

from .._hints import Array
from ..model.radar_array import RadarArray
from .style import BOUND, ORANGE, OURS, PUBLISHED, SENSOR, TRUTH, VARIANTS, drawing

_LEVELS = (0, 1, 2, 3, 10, 30, 100, 300, 1000)


@drawing(7, 3.3)
def reduced_cost(
    figure: Figure,
    panels: dict[str, tuple[Array, ...]],
    marks: Sequence[dict[str, Array]],
    labels: Sequence[tuple[str, ...]],
) -> None:
    """Draw maps of the misfit that the best velocity leaves at every position.

    panels: By title: places along the horizontal axis (A,) and the vertical one (B,) in m, and the
        chi-square (B, A).
    marks (2,): Points (horizontal, vertical) of each panel, by label.
    labels: What the axes of each panel are.
    """
    styles = (("s", TRUTH), ("X", OURS))
    colors = BoundaryNorm(_LEVELS, 256)
    axes = figure.subplots(1, len(panels), squeeze=False)[0]
    named = {}
    for ax, (title, (across, up, cost)), points, names in zip(
        axes, panels.items(), marks, labels, strict=True
    ):
        off = np.sqrt(np.maximum(cost - np.nanmin(cost), 0))
        area = ax.contourf(across, up, off, _LEVELS, norm=colors, cmap="Blues_r", extend="max")
        ax.contour(across, up, off, [3], colors="white", linewidths=0.9)
        for (label, point), (mark, color) in zip(points.items(), styles, strict=False):
            named[label] = ax.plot(*point, mark, color=color, ms=6, mec="white")[0]
        ax.set(title=title, xlabel=names[0], ylabel=names[1], aspect="equal")
        ax.grid(False)
    key = figure.colorbar(
        area, ax=axes, location="bottom", aspect=45,
        label="misfit beyond that of the best position (standard deviations)",
    )  # fmt: skip
    key.set_ticks(_LEVELS, labels=[f"{level:g}" for level in _LEVELS])
    figure.legend(named.values(), named, loc="outside upper center", ncols=len(named))


@drawing(7, 3.9)
def error_distributions(
    figure: Figure,
    errors: dict[str, tuple[Array, ...]],
    marks: dict[str, tuple[float, ...]],
    bounds: tuple[float, ...],
) -> None:
    """Draw the distributions of the errors of starts, for position and velocity.

    errors (runs,): Errors of position in m and of velocity in m/s, by label.
    marks: The same two errors of single published starts.
    bounds: Root mean square bounds of both.
    """
    axes = figure.subplots(1, 2, sharey=True)
    names = "position error (m)", "velocity error (m/s)"
    for i, (ax, name) in enumerate(zip(axes, names, strict=True)):
        for (label, pair), (color, style) in zip(errors.items(), VARIANTS, strict=False):
            value = np.sort(pair[i])
            share = np.arange(1, len(value) + 1) / len(value)
            step = max(1, len(value) // 500)
            ax.semilogx(value[::step], share[::step], style, color=color, label=label)
        for (label, pair), style in zip(marks.items(), ("-", ":"), strict=False):
            ax.axvline(pair[i], color=PUBLISHED, ls=style, label=label)
        ax.axvline(bounds[i], color=BOUND, lw=1.2, label="bound, root mean square")
        ax.set(xlabel=name, ylim=(0, 1))
    axes[0].set_ylabel("fraction of initial estimates below")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper center", ncols=2)


@drawing(7, 3.6)
def errors_by_samples(
    figure: Figure,
    samples: Sequence[int],
    errors: Sequence[Array],
    bound: Array,
    published: tuple[float, ...],
) -> None:
    """Draw the position errors of starts against the length of the record.

    samples (M,): Lengths of the records.
    errors (runs,): Position errors in m for each length.
    bound (M,): Root mean square bounds in m.
    published: Number of samples and error of the start of Table 2.
    """
    low, first, middle, third, high = np.transpose(
        [np.percentile(error, [5, 25, 50, 75, 95]) for error in errors]
    )
    ax = figure.subplots()
    ax.fill_between(samples, low, high, color=OURS, alpha=0.2, lw=0, label="central 90 %")
    ax.fill_between(samples, first, third, color=OURS, alpha=0.35, lw=0, label="central 50 %")
    ax.loglog(samples, middle, "o-", color=OURS, ms=4, label="median of our starts")
    ax.loglog(samples, bound, color=BOUND, label="bound, root mean square")
    ax.plot(*published, "D", color=PUBLISHED, ms=8, mec="white", label="Table 2")
    ax.set_xticks(samples, labels=[f"{k}" for k in samples])
    ax.set_xticks([], minor=True)
    ax.set(xlabel="number of samples", ylabel="position error (m)")
    figure.legend(*ax.get_legend_handles_labels(), loc="outside upper center", ncols=3)


@drawing()
def error_maps(
    figure: Figure,
    x: Array,
    y: Array,
    maps: dict[str, Array],
    arrays: Sequence[RadarArray],
    velocities: Sequence[Array],
    columns: int = 3,
    limits: tuple[float, ...] = (0.025, 1.0),
) -> None:
    """Draw maps of position errors over the plane, x upwards as in the paper.

    x, y (A,): Places in m.
    maps (A, A): Errors in m, one panel for each; NaN stays white.
    arrays: Sensors of each map.
    velocities (3,): Velocity of the target in each map in m/s, drawn as an arrow in a corner.
    columns: Panels side by side.
    limits: Ends of the color scale in m.
    """
    rows = -(-len(maps) // columns)
    figure.set_size_inches(7, 0.9 + 2.35 * rows * 3 / columns)
    axes = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    for ax in axes.flat[len(maps) :]:
        ax.set_visible(False)
    shown = zip(axes.flat, maps.items(), arrays, velocities, strict=False)
    for ax, (label, error), array, velocity in shown:
        area = ax.pcolormesh(
            y, x, np.clip(error, *limits), norm=LogNorm(*limits), cmap="viridis", rasterized=True
        )
        ax.plot(array.positions[:, 1], array.positions[:, 0], "o", color=SENSOR, ms=4, mec="white")
        along = 0.2 * np.asarray(velocity) / np.linalg.norm(velocity)
        ax.annotate(
            "", (0.7 + along[1], -0.7 + along[0]), (0.7 - along[1], -0.7 - along[0]),
            arrowprops={"arrowstyle": "-|>", "color": "white", "lw": 2, "mutation_scale": 12},
        )  # fmt: skip
        ax.set(title=label, aspect="equal", xticks=[-0.8, 0, 0.8], yticks=[-0.8, 0, 0.8])
        ax.grid(False)
    for ax in axes[:, 0]:
        ax.set_ylabel("x (m)")
    for ax in axes[-1]:
        ax.set_xlabel("y (m)")
    key = figure.colorbar(
        area, ax=axes, location="bottom", aspect=45, extend="both", label="error (m)"
    )
    ticks = [t for t in (0.01, 0.025, 0.05, 0.1, 0.2, 0.5, 1) if limits[0] <= t <= limits[1]]
    key.set_ticks(ticks, labels=[f"{t:g}" for t in ticks])
    key.ax.minorticks_off()


@drawing(7, 3.4)
def area_fractions(figure: Figure, limits: Array, panels: dict[str, dict[str, Array]]) -> None:
    """Draw the fraction of the area above an error, ours as bands of draws, and published.

    limits (L,): Errors in m.
    panels (L,) or (L, draws): Fractions by title of the panel and label of the curve. What has
        draws is ours and is drawn with the range of the central 95 % of them; what has none is
        published.
    """
    axes = figure.subplots(1, len(panels), sharex=True, sharey=True, squeeze=False)[0]
    for ax, (title, curves) in zip(axes, panels.items(), strict=True):
        variants = iter(VARIANTS)
        for label, share in curves.items():
            if share.ndim == 1:
                ax.loglog(limits, share, "D", color=PUBLISHED, ms=5, mec="white", label=label)
                continue
            color, style = next(variants)
            low, middle, high = np.percentile(share, [2.5, 50, 97.5], axis=1)
            middle[middle == 0] = np.nan  # not on this scale
            ax.fill_between(limits, low, high, color=color, alpha=0.25, lw=0)
            ax.loglog(limits, middle, style, color=color, label=label)
        ax.set(
            title=title,
            xlabel="error (m)",
            xlim=(0.9 * limits[0], 1.1 * limits[-1]),
            ylim=(5e-4, 1),
        )
        ticks = [limit for limit in (0.05, 0.1, 0.2, 0.5) if limits[0] <= limit <= limits[-1]]
        ax.set_xticks(ticks, labels=[f"{t:g}" for t in ticks])
        ax.set_xticks([], minor=True)
        ax.legend(loc="lower left")
    axes[0].set_ylabel("fraction of the area above")


@drawing(7, 3.2)
def line_profiles(
    figure: Figure, axis: Array, profiles: dict[str, Array], bound: Array, lowest: float
) -> None:
    """Draw errors along two lines through the middle of a map.

    axis (A,): Places along the line in m.
    profiles (A,): Published errors in m by label, the first along the sensors as drawn, the second
        across; NaN where the error is below the lowest contour or hidden.
    bound (A,): Bound across the sensors in m: what they see well.
    lowest: Lowest contour in m.
    """
    ax = figure.subplots()
    marks = (("o", TRUTH), ("D", PUBLISHED))
    for (label, error), (mark, color) in zip(profiles.items(), marks, strict=True):
        ax.semilogy(axis, error, mark, color=color, ms=5, mec="white", label=label)
    ax.semilogy(axis, bound, color=OURS, label="bound across a line of sensors")
    ax.axhline(lowest, color=TRUTH, lw=1, ls=":", label="lowest contour")
    ax.set(xlabel="place on the line (m)", ylabel="position error (m)", ylim=(5e-3, 60))
    figure.legend(*ax.get_legend_handles_labels(), loc="outside upper center", ncols=2)


@drawing(7, 3.6)
def wrong_windows(figure: Figure, panels: dict[str, dict[str, Array]]) -> None:
    """Draw errors of starts against the fraction of wrong windows, over those without any.

    panels: By title and by kind of wrong windows: for the robust and the plain start fractions,
        ratios, and the ends of their intervals (2, F, 4).
    """
    axes = figure.subplots(1, len(panels), sharey=True, squeeze=False)[0]
    marks = "osD^v"
    for ax, (title, kinds) in zip(axes, panels.items(), strict=True):
        for i, (kind, found) in enumerate(kinds.items()):
            for (x, ratio, low, high), color, name in zip(
                np.moveaxis(found, -1, 1), (OURS, ORANGE), ("robust", "plain"), strict=True
            ):
                ax.errorbar(
                    100 * x + 0.4 * (i - 1), ratio, [ratio - low, high - ratio], color=color,
                    marker=marks[i % len(marks)], ms=4, lw=1, ls="-" if name == "robust" else "--",
                    label=f"{name}, {kind}",
                )  # fmt: skip
        ax.axhline(2, color=BOUND, lw=1, ls=":")
        ax.set(title=title, xlabel="wrong windows (%)", yscale="log")
    axes[0].set(ylabel="error over that of the right windows (ratio)")
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=len(labels) // 2)
