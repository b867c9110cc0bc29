"""Figures of the chapter on observability: likelihood, the blind family, bounds."""

from collections.abc import Sequence

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse
from matplotlib.patheffects import withStroke

from .._hints import Array
from ..model.radar_array import RadarArray
from .style import (
    BOUND,
    HALO,
    LABEL,
    ORANGE,
    OURS,
    PINK,
    PUBLISHED,
    SENSOR,
    SKY,
    TRUTH,
    arrow,
    drawing,
    project,
)

_STYLES = ("-", "--", ":", "-.")
# None of them means published or sensor.
_COLORS = (OURS, PINK, ORANGE, SKY)
_DEPTHS = (OURS, "#74B3D9", "#C5E0F0")  # one, two and three sigma


@drawing(7, 2.9)
def likelihood_ridges(
    figure: Figure,
    position: Array,
    speed: Array,
    misfits: dict[str, Array],
    truth: tuple[float, ...],
    bounds: dict[str, Array] | None = None,
) -> None:
    """Draw contours of the likelihood over distance and speed, one panel for each record.

    position (A,): Distances in m.
    speed (B,): Speeds in m/s.
    misfits (B, A): Chi-square without noise, by label: twice what the log-likelihood loses against
        the truth.
    truth: True distance and speed.
    bounds (2, 2): Covariances of distance and speed of some of the records, drawn as two-sigma
        ellipses.
    """
    axes = figure.subplots(1, len(misfits), sharex=True, sharey=True)
    for ax, (label, misfit) in zip(axes, misfits.items(), strict=True):
        ax.contourf(position, speed, np.sqrt(misfit), [0, 1, 2, 3], colors=_DEPTHS)
        if label in (bounds or {}):
            width, axis = np.linalg.eigh(bounds[label])
            angle = np.degrees(np.arctan2(axis[1, 1], axis[0, 1]))
            ax.add_patch(
                Ellipse(truth, *4 * np.sqrt(width[::-1]), angle=angle, fill=False,
                        color=BOUND, lw=1.8, label="bound, two sigma")
            )  # fmt: skip
            ax.legend(loc="upper right")
        ax.plot(*truth, "s", color=TRUTH, ms=6, mec="white")
        ax.set(title=label, xlabel="distance (m)")
    axes[0].set_ylabel("speed (m/s)")


@drawing(7, 3.0)
def blind_family(
    figure: Figure,
    array: RadarArray,
    x: Array,
    family: Array,
    azimuth: float = -68.0,
    elevation: float = 22.0,
) -> None:
    """Draw the states that a ring cannot tell apart, in space and by their coordinates.

    array: The ring.
    x (6,): The true state.
    family (M, 6): States with the same Doppler shifts, in order.
    azimuth, elevation: From where they are seen, in degrees; see `project`.
    """

    def view(points):
        return project(points, azimuth, elevation)

    space, speeds = figure.subplots(1, 2, width_ratios=(1.7, 1))
    angle = np.linspace(0, 2 * np.pi, 121)
    radius = np.linalg.norm(array.positions[0])
    circle = np.stack([0 * angle, radius * np.cos(angle), radius * np.sin(angle)], axis=-1)
    space.plot(*view(circle).T, color=SENSOR, lw=0.8)
    space.plot(*view(array.positions).T, "o", color=SENSOR, ms=7, mec="white")
    space.plot(*view(family[:, :3]).T, color=OURS, lw=2)
    for state in family[:: max(1, len(family) // 7)]:
        start = view(state[:3])
        space.plot(*start, "o", color=OURS, ms=4)
        arrow(space, start, view(state[:3] + 0.1 * state[3:]) - start, OURS, "")
    start = view(x[:3])
    arrow(space, start, view(x[:3] + 0.1 * x[3:]) - start, TRUTH, "")
    space.plot(*start, "s", color=TRUTH, ms=7, mec="white", zorder=6)
    space.annotate("target", start, (0, -16), color=TRUTH, bbox=HALO, **LABEL)
    space.set(aspect="equal")
    space.axis("off")
    for i, (name, style) in enumerate(zip((r"v_x", r"v_y", r"v_z"), _STYLES, strict=False)):
        speeds.plot(family[:, 0], family[:, 3 + i], style, color=OURS, label=f"${name}$")
        speeds.plot(x[0], x[3 + i], "s", color=TRUTH, ms=5)
    speeds.set(xlabel="x (m)", ylabel="velocity (m/s)")
    speeds.legend(loc="center right")


@drawing(7, 3.4)
def bounds_by_change(
    figure: Figure, change: Array, bounds: dict[str, Array], plain: dict[str, float] | None = None
) -> None:
    """Draw the bound against the size of a change of the array.

    change (M,): Sizes of the change in m.
    bounds (M,): Bounds on the position error in m, by kind of change.
    plain: Bounds in m for the array as it is, by label.
    """
    ax = figure.subplots()
    for (label, bound), style, color in zip(bounds.items(), _STYLES, _COLORS, strict=False):
        ax.loglog(100 * np.asarray(change), bound, style, color=color, label=label)
    for label, value in (plain or {}).items():
        ax.axhline(value, color=BOUND, lw=1)
        ax.annotate(label, (100 * change[0], value), (4, 3), textcoords="offset points",
                    color=BOUND)  # fmt: skip
    ax.set(xlabel="size of the change (cm)", ylabel="bound on position error (m)")
    ax.margins(x=0)
    ax.legend(loc="upper center")


@drawing(7, 3.2)
def bounds_by_motion(
    figure: Figure, size: Array, turning: dict[str, Array], accelerating: dict[str, Array]
) -> None:
    """Draw the bound on range against the motion of the platform, one panel for each kind.

    size (M,): Rates of turning in rad/s, and accelerations in m/s^2.
    turning, accelerating (M,): Bounds in m, by label.
    """
    panels = figure.subplots(1, 2, sharey=True)
    kinds = {"rate of the turn (rad/s)": turning, "acceleration (m/s²)": accelerating}
    for ax, (name, bounds) in zip(panels, kinds.items(), strict=True):
        for (label, bound), style, color in zip(bounds.items(), _STYLES, _COLORS, strict=False):
            ax.semilogy(size, bound, style, color=color, label=label)
        ax.set(xlabel=name)
        ax.margins(x=0)
        ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.18))
    panels[0].set_ylabel("bound on range (m)")


@drawing(7, 3.5)
def estimates(
    figure: Figure,
    sets: dict[str, Array],
    x: Array,
    others: dict[str, Array],
    bounds: dict[str, Array],
    axes: Sequence[tuple[int, ...]],
) -> None:
    """Draw estimates beside the truth and the states that could be mistaken for it.

    sets (runs, 6): Estimates, one panel for each.
    x (6,): The true state.
    others (M, 6): States that look alike, by label: several as a curve, one as a cross.
    bounds (6, 6): Covariances by the labels of `sets`, drawn as ellipses about the truth: two
        standard deviations in every direction.
    axes: The two coordinates that each panel shows, out of 0, 1, 2.
    """
    panels = figure.subplots(1, len(sets))
    for ax, (label, found), pair in zip(panels, sets.items(), axes, strict=True):
        pair = list(pair)
        ax.plot(*found[:, pair].T, "o", color=OURS, ms=2.5, alpha=0.4, mec="none")
        width, axis = np.linalg.eigh(bounds[label][np.ix_(pair, pair)])
        angle = np.degrees(np.arctan2(axis[1, 1], axis[0, 1]))
        ax.add_patch(Ellipse(x[pair], *4 * np.sqrt(width[::-1]), angle=angle, fill=False,
                             color=BOUND, lw=1.8, label="bound, two sigma"))  # fmt: skip
        curves = iter(("--", ":", "-."))
        for name, states in others.items():
            one = len(states) == 1
            mark = {"ms": 10, "mec": "white"} if one else {"lw": 1.6}
            style = "X" if one else next(curves)
            ax.plot(*states[:, pair].T, style, color=TRUTH, label=name, **mark)
        ax.plot(*x[pair], "s", color=TRUTH, ms=8, mec="white", label="truth")
        low, high = np.percentile(found[:, pair], [0.5, 99.5], axis=0)
        edge = 0.15 * (high - low)
        ax.set(xlim=(low[0] - edge[0], high[0] + edge[0]))
        ax.set(ylim=(low[1] - edge[1], high[1] + edge[1]), title=label)
        ax.set(xlabel=f"{'xyz'[pair[0]]} (m)", ylabel=f"{'xyz'[pair[1]]} (m)")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=3)


@drawing(7, 3.6)
def bound_maps(
    figure: Figure, x: Array, y: Array, maps: dict[str, Array], arrays: Sequence[RadarArray]
) -> None:
    """Draw maps of the bound on the position error over the plane z = 0.

    x (A,): Distances before the array in m.
    y (B,): Positions to the side in m.
    maps (A, B): Bounds in m, one panel for each.
    arrays: Sensors of each map, shown in the plane.
    """
    levels = np.geomspace(1e-3, 10, 9)
    panels = figure.subplots(1, len(maps), sharex=True, sharey=True)
    for ax, (label, bound), array in zip(panels, maps.items(), arrays, strict=True):
        shown = np.clip(bound, levels[0], levels[-1])
        area = ax.contourf(y, x, shown, levels, norm=LogNorm(), cmap="viridis_r")
        lines = ax.contour(y, x, bound, [0.01, 0.1, 1], colors="white", linewidths=0.9)
        for text in ax.clabel(lines, fmt=lambda v: f"{100 * v:g} cm", fontsize=8.5):
            text.set_path_effects([withStroke(linewidth=2, foreground=TRUTH)])  # on bright areas
        ax.plot(array.positions[:, 1], 0 * array.positions[:, 1], "o", color=SENSOR,
                ms=6, mec="white", clip_on=False)  # fmt: skip
        ax.set(title=label, xlabel="y (m)", aspect="equal", ylim=(0, x[-1]), xticks=[-0.4, 0, 0.4])
        ax.grid(False)
    panels[0].set_ylabel("x (m)")
    key = figure.colorbar(area, ax=panels, location="bottom", aspect=40,
                          label="bound on position error (m)")  # fmt: skip
    key.set_ticks([1e-3, 1e-2, 1e-1, 1, 10], labels=["0.001", "0.01", "0.1", "1", "10"])


@drawing(7, 3.8)
def bounds_over_time(
    figure: Figure,
    time: Array,
    bounds: dict[str, Array],
    law: Array,
    marks: dict[str, tuple[float, ...]] | None = None,
) -> None:
    """Draw the bound on the position error against the length of the record.

    time (M,): Lengths of the record in s.
    bounds (M,): Bounds in m, by label.
    law (M,): The power law of short records in m.
    marks: Points (length in s, error in m), by label.
    """
    ax = figure.subplots()
    for (label, bound), style, color in zip(bounds.items(), _STYLES, _COLORS, strict=False):
        ax.loglog(time, bound, style, color=color, label=label)
    ax.loglog(time, law, color=BOUND, lw=1, label="law of short records, ring")
    for label, (when, error) in (marks or {}).items():
        ax.plot(when, error, "D", color=PUBLISHED, ms=7, mec="white", label=label)
    ax.set(xlabel="length of the record (s)", ylabel="bound on position error (m)")
    ax.set(xlim=(time[0], time[-1]), ylim=(3e-4, 20))
    ax.legend(loc="lower left")
