"""Figures of the chapter on two radars: the error area, positions, and their errors."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from .._hints import Array
from .style import BOUND, MEASURED, ORANGE, OURS, PINK, PUBLISHED, SENSOR, TRUTH, drawing, looks

# Color, line and mark of a tracker by the first of these words in its label, in all figures.
TRACKERS = {
    "measured": (MEASURED, "-", "."),
    "one filter": (OURS, "-", "o"),
    "without its gate": (OURS, "-", "o"),
    "thesis": (ORANGE, "--", "s"),
    "code": (ORANGE, "--", "s"),
    "apart": (PINK, "-.", "^"),
    "bilaterate": (PINK, "-.", "^"),
    "modern": (PINK, "-.", "^"),
}


@drawing(7.0, 3.1)
def error_areas(
    figure: Figure,
    p: Array,
    sensors: Array,
    rings: Sequence[Array],
    areas: Sequence[Array],
    titles: Sequence[str],
) -> None:
    """Draw rings around both radars and the area of their intersection (Fig 5.5).

    p (2,): True position in m.
    sensors (2, 2): Positions of the radars in m.
    rings (2,): For each pair of panels, half-widths of the rings of both radars in m.
    areas (M, 2): Outline of the area for each.
    titles: Of the panels: the first rings in whole, then each in detail.
    """
    angle = np.linspace(0, np.pi, 2000)
    unit = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    axes = figure.subplots(1, 1 + len(rings), width_ratios=[1.7] + [1] * len(rings))
    for ax, (half, corners), title in zip(
        axes, [(rings[0], areas[0]), *zip(rings, areas, strict=True)], titles, strict=True
    ):
        for n, (color, ls) in enumerate(((OURS, "-"), (ORANGE, "--"))):
            d = np.hypot(*(p - sensors[n]))
            for sign in (-1, 1):
                ax.plot(*(sensors[n] + (d + sign * half[n]) * unit).T, color=color, ls=ls, lw=1.2)
        ax.fill(*corners.T, color=SENSOR, alpha=0.35, lw=0)
        ax.plot(*p, "*", color=TRUTH, ms=9)
        ax.set(title=title, xlabel="x (m)")
    axes[0].plot(*sensors.T, "o", color=SENSOR)
    axes[0].set(ylabel="y (m)", xlim=(-5, 5), ylim=(-0.5, 5.4), aspect="equal")
    axes[1].set_ylabel("y (m)")
    reach = 1.25 * np.abs(areas[-1] - p).max(axis=0)
    for ax in axes[1:]:
        ax.set(xlim=p[0] + reach[0] * np.array([-1, 1]), ylim=p[1] + reach[1] * np.array([-1, 1]))


@drawing(7.0, 3.6)
def plane(
    figure: Figure,
    truth: Array,
    sets: Sequence[dict[str, Array]],
    sensors: Array,
    limits: tuple[tuple[float, float], tuple[float, float]],
    titles: Sequence[str] = (),
) -> None:
    """Draw positions in the plane, one panel for each set of labeled positions.

    truth (K, 2): True positions in m.
    sets (K, 2): For each panel, positions by label; the last label of a panel is the estimate.
    sensors (2, 2): Positions of the radars in m.
    limits: Limits of x and of y.
    titles: Of the panels.
    """
    axes = figure.subplots(1, len(sets), squeeze=False, sharey=True)[0]
    for i, (ax, positions) in enumerate(zip(axes, sets, strict=True)):
        labels = list(positions)
        for label in labels[:-1]:
            ax.plot(*positions[label].T, ".", color=MEASURED, ms=3, label=label)
        ax.plot(*positions[labels[-1]].T, color=OURS, label=labels[-1])
        ax.plot(*truth.T, color=TRUTH, ls="--", label="true")
        ax.plot(*sensors.T, "o", color=SENSOR)
        ax.set(xlabel="x (m)", xlim=limits[0], ylim=limits[1])
        if titles:
            ax.set_title(titles[i])
    figure.legend(*ax.get_legend_handles_labels(), loc="outside upper center", ncols=3)
    axes[0].set_ylabel("y (m)")


@drawing(7.0, 3.0)
def triangulated(
    figure: Figure,
    time: Array,
    truth: Array,
    raw: Array,
    estimate: Array,
    sensors: Array,
    limits: tuple[tuple[float, float], tuple[float, float]],
) -> None:
    """Draw x and y over time, and the positions in the plane (Fig 5.10).

    time (K,): Time in s.
    truth, raw, estimate (K, 2): Positions in m.
    sensors (2, 2): Positions of the radars in m.
    limits: Limits of x and of y.
    """
    axes = figure.subplots(1, 3)
    for i, name in enumerate("xy"):
        axes[i].plot(time, raw[:, i], color=MEASURED, lw=0.7, label="measured, inside the gate")
        axes[i].plot(time, truth[:, i], color=TRUTH, ls="--", label="true")
        axes[i].plot(time, estimate[:, i], color=OURS, label="filtered")
        axes[i].set(xlabel="time (s)", ylabel=f"{name} (m)", ylim=limits[i])
    axes[2].plot(*raw.T, ".", color=MEASURED, ms=3)
    axes[2].plot(*truth.T, color=TRUTH, ls="--")
    axes[2].plot(*estimate.T, color=OURS)
    axes[2].plot(*sensors.T, "o", color=SENSOR)
    axes[2].set(xlabel="x (m)", ylabel="y (m)", xlim=limits[0], ylim=limits[1])
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=3)


@drawing(7.0, 3.6)
def error_over_distance(
    figure: Figure,
    distance: Array,
    errors: dict[str, Array],
    limit: float = 1.0,
    published: float | None = None,
) -> None:
    """Draw the root mean square error of many runs over the distance from the origin.

    distance (K,): True distance in m.
    errors (runs, K): Position errors in m by label; NaN where there is no estimate.
    limit: Error in m above which a position is called useless.
    published: Usable range in m that the thesis reports.
    """
    ax = figure.subplots()
    for label, (color, ls, _) in looks(errors, TRACKERS).items():
        rms = np.sqrt(np.nanmean(np.square(errors[label]), axis=0))
        ax.plot(distance, rms, color=color, ls=ls, label=label)
    ax.axhline(limit, color=BOUND, lw=1.0)
    if published is not None:
        ax.axvline(published, color=PUBLISHED, ls=":", label="usable range in the thesis")
    ax.set(xlabel="distance from the origin (m)", ylabel="RMS position error (m)")
    ax.set(yscale="log", ylim=(1e-3, 100))
    ax.legend(loc="upper left")
