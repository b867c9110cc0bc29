"""Figures of the chapter on geometry: lines of sight, iso-Doppler cones, sensitivities."""

from collections.abc import Sequence

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from .._hints import Array
from ..model.doppler import doppler_shift
from ..model.iso_doppler import iso_doppler_directions
from ..model.radar_array import RadarArray
from .style import (
    BOUND,
    HALO,
    LABEL,
    OURS,
    SENSOR,
    TRUTH,
    arrow,
    doppler_lines,
    drawing,
    project,
    sensor_colors,
)


@drawing(7, 3.6)
def doppler_curves(
    figure: Figure,
    time: Array,
    shifts: Array,
    names: Sequence[str] | None = None,
    close: tuple[float, float] | None = None,
) -> None:
    """Draw the Doppler shift at each sensor over time.

    time (K,): Times in s.
    shifts (K, N): Doppler shifts in Hz.
    names: Labels of the sensors; their numbers, from 1, if None.
    close: Times in s of a second panel, which has the labels: for curves that meet at their ends.
    """
    *whole, ax = figure.subplots(1, 1 if close is None else 2, squeeze=False)[0]
    inside = slice(None) if close is None else slice(*np.searchsorted(time, close))
    doppler_lines(ax, time[inside], shifts[inside], names)
    for left in whole:
        for curve, color in zip(shifts.T, sensor_colors(shifts.shape[-1]), strict=True):
            left.plot(time, curve, color=color)
        left.axvspan(*close, color=BOUND, alpha=0.15, lw=0)
        left.set(xlabel="time (s)", ylabel="Doppler shift (Hz)", xlim=(time[0], time[-1]))
    if shifts.min() < 0 < shifts.max():
        for each in figure.axes:
            each.axhline(0, color=BOUND, lw=0.8)


@drawing(7, 3.4)
def two_sensors(figure: Figure, array: RadarArray, x: Array) -> None:
    """Draw the top view of a moving platform, and of the same scene from the platform.

    array: Two sensors or more in the plane z = 0.
    x (6,): State of the target relative to the platform in m and m/s, in the plane z = 0.
    """
    x = np.asarray(x, float)
    p, v, sensors = x[:2], x[3:5], array.positions[:, :2]
    scale = 0.4  # meters on paper for 1 m/s
    arc = np.exp(1j * np.linspace(-0.6, 0.9, 200))
    axes = figure.subplots(1, 2, sharex=True, sharey=True)
    titles = ("The platform moves ...", "... or, seen from it, the target")
    for ax, title in zip(axes, titles, strict=True):
        for n, s in enumerate(sensors, start=1):
            circle = np.linalg.norm(p - s) * arc
            ax.plot(s[0] + circle.real, s[1] + circle.imag, "--", color=BOUND, lw=0.9)
            ax.plot(*np.transpose([s, p]), ":", color=SENSOR, lw=1)
            ax.plot(*s, "o", color=SENSOR, ms=9)
            ax.annotate(rf"$\mathbf{{s}}_{n}$", s, (-15, 0), color=SENSOR, **LABEL)
        ax.plot(*sensors.T, color=SENSOR, lw=5, alpha=0.3, zorder=0)
        ax.plot(*p, "s", color=TRUTH, ms=7, zorder=5)
        ax.annotate(r"$\mathbf{p}$", p, (13, 6), **LABEL)
        ax.set(title=title, xlabel="x (m)", aspect="equal")
    platform = r"\mathbf{v}_\mathrm{s}"
    arrow(axes[0], sensors.mean(axis=0), -scale * v, SENSOR, f"${platform}$", (-10, 8))
    arrow(axes[1], p, scale * v, TRUTH, rf"$\mathbf{{v}} = -{platform}$", (36, -2))
    for s, shift in zip(sensors, doppler_shift(x, array), strict=True):
        toward = (s - p) / np.linalg.norm(s - p)
        closing = scale * (toward @ v) * toward
        axes[1].plot(*np.transpose([p, p + closing]), color=OURS, lw=4, solid_capstyle="butt")
        axes[1].plot(*np.transpose([p + scale * v, p + closing]), ":", color=TRUTH, lw=1)
        axes[1].annotate(
            f"{shift:+.0f} Hz", p + 0.7 * (s - p), (0, 0), color=OURS, bbox=HALO, **LABEL
        )
    axes[0].set(ylabel="y (m)", xlim=(-0.15, p[0] + 0.3), ylim=(-0.35, 0.45))


@drawing(7, 4.1)
def iso_doppler_lines(
    figure: Figure, array: RadarArray, x: Array, extent: tuple[float, ...] = (0.0, 1.0, -0.45, 0.45)
) -> None:
    """Draw the iso-Doppler lines of one sensor, and the lines of all sensors through a target.

    array: Sensors in the plane z = 0.
    x (6,): State of the target in m and m/s, in the plane z = 0.
    extent: Left, right, lower and upper edge of what is shown, in m.
    """
    x = np.asarray(x, float)
    left, right, lower, upper = extent
    middle = type(array)(array.positions[len(array) // 2][None], array.wavelength)
    grid = np.zeros((200, 200, 6)) + x
    grid[..., 0], grid[..., 1] = np.meshgrid(
        np.linspace(left + 1e-6, right, 200), np.linspace(lower, upper, 200)
    )
    parts = figure.subplots(2, 2, height_ratios=(1, 0.05), gridspec_kw={"hspace": 0.03})
    (one, every), (scale, key) = parts
    top = array.doppler_per_speed * np.linalg.norm(x[3:])
    area = one.contourf(grid[..., 0], grid[..., 1], doppler_shift(grid, middle)[..., 0],
                        top * np.linspace(-1, 1, 17), cmap="PuOr_r")  # fmt: skip
    figure.colorbar(area, cax=scale, label="Doppler shift (Hz)", location="bottom",
                    ticks=[-100, -50, 0, 50, 100])  # fmt: skip
    _draw_lines(one, middle, x, (TRUTH,))
    _draw_lines(every, array, x, sensor_colors(len(array)))
    key.axis("off")
    key.legend(
        [Line2D([], [], color=SENSOR, ls=style) for style in ("-", "--")],
        ["side of the target", "other side"],
        loc="upper center",
        ncols=2,
    )
    for ax, shown in ((one, middle), (every, array)):
        ax.plot(*shown.positions[:, :2].T, "o", color=SENSOR, ms=8, mec="white", zorder=5)
        ax.plot(*x[:2], "s", color=TRUTH, ms=7, zorder=5)
        arrow(ax, x[:2], 0.25 * x[3:5], TRUTH, r"$\mathbf{v}$", (11, -4))
        ax.set(xlim=(left - 0.05, right), ylim=(lower, upper), xlabel="x (m)", aspect="equal")
        ax.grid(False)
    one.set(ylabel="y (m)", title="One sensor: shift by position")
    every.set_title(f"{len(array)} sensors: lines of the target's shift")


def _draw_lines(ax, array, x, colors):
    """Draw both branches of the iso-Doppler line of state `x` at each sensor."""
    for s, branches, color in zip(
        array.positions, iso_doppler_directions(x, array, [0.0, np.pi]), colors, strict=True
    ):
        for branch, style in zip(branches, ("-", "--"), strict=True):
            ax.plot(*(s + np.outer([0, 5], branch))[:, :2].T, style, color=color, lw=1.3)


@drawing(7, 3.6)
def iso_doppler_cones(
    figure: Figure, array: RadarArray, x: Array, azimuth: float = -62.0, elevation: float = 20.0
) -> None:
    """Draw the iso-Doppler cones of all sensors in space, and their cut at the target's range.

    array: Sensors near the plane x = 0.
    x (6,): State of the target in m and m/s.
    azimuth, elevation: From where the cones are seen, in degrees; see `project`.
    """
    x = np.asarray(x, float)
    around = np.linspace(0, 2 * np.pi, 181)
    cut = _cut(array, x, around)

    def view(points):
        return project(points, azimuth, elevation)

    space, plane = figure.subplots(1, 2, width_ratios=(1.5, 1))
    for n, color in enumerate(sensor_colors(len(array))):
        s = array.positions[n]
        rays = np.stack([np.broadcast_to(s, cut[n, ::9].shape), cut[n, ::9]], axis=1)
        lines = LineCollection(view(rays), colors=color, linewidths=0.4, alpha=0.6)
        space.add_collection(lines)
        space.plot(*view(cut[n]).T, color=color, lw=1.4)
        space.plot(*view(s), "o", color=color, ms=7, mec="white")
        plane.plot(cut[n, :, 1], cut[n, :, 2], color=color, lw=1.4, label=f"{n + 1}")
        far = cut[n, 90]
        plane.annotate(f"{n + 1}", far[1:], (0, 0), color=TRUTH, bbox=HALO, **LABEL)
    target = view(x[:3])
    space.plot(*target, "s", color=TRUTH, ms=7, zorder=5)
    step = view(x[:3] + 0.3 * x[3:]) - target
    arrow(space, target, step, TRUTH, r"$\mathbf{v}$", (0, -13))
    space.set(aspect="equal", title="Six cones, one for each sensor")
    space.axis("off")
    plane.plot(x[1], x[2], "s", color=TRUTH, ms=7, zorder=5)
    plane.set(
        aspect="equal", xlabel="y (m)", ylabel="z (m)", title=f"Their cut at x = {x[0]:.2f} m"
    )


def _cut(array, x, around):
    """Return the curves (N, M, 3) in which the plane of the target, across x, cuts the cones.

    Where a line of a cone never meets the plane they are NaN.
    """
    directions = iso_doppler_directions(x, array, around)
    distance = np.full(directions.shape[:2], np.nan)
    ahead = x[0] - array.positions[:, :1]
    meets = np.sign(ahead) * directions[..., 0] > 1e-12  # beyond rounding of a unit vector
    np.divide(ahead, directions[..., 0], out=distance, where=meets)
    return array.positions[:, None] + distance[..., None] * directions


@drawing(7, 3.5)
def sensitivities(figure: Figure, time: Array, jacobian: Array, sigma_f: float) -> None:
    """Draw the sensitivity of a snapshot to each coordinate, the others known.

    time (K,): Times in s.
    jacobian (K, N, 6): Derivatives of the Doppler shifts, in Hz per m and Hz per m/s.
    sigma_f: Standard deviation of a Doppler measurement in Hz.
    """
    per_cm = np.sqrt((jacobian**2).sum(axis=-2)) / 100
    styles = ("-", "--", ":")
    axes = figure.subplots(1, 2, sharey=True)
    names = (("x", "y", "z"), (r"v_x", r"v_y", r"v_z"))
    units = ("Hz per cm", "Hz per cm/s")
    parts = ("position", "velocity")
    panels = zip(axes, parts, (0, 3), names, units, strict=True)
    for ax, part, first, group, unit in panels:
        for i, (name, style) in enumerate(zip(group, styles, strict=True)):
            ax.semilogy(time, per_cm[:, first + i], style, color=OURS, label=f"${name}$", lw=2)
        ax.axhline(sigma_f, color=BOUND, lw=1)
        ax.annotate(r"$\sigma_f$", (time[-1], sigma_f), (-8, 7), color=BOUND, **LABEL)
        ax.set(
            xlabel="time (s)", ylabel=f"sensitivity ({unit})", title=f"{part}, all sensors together"
        )
        ax.legend()
        ax.margins(x=0)
