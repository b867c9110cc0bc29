"""The figure of the first page: the measurements of one run, the tracks of many."""

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from .._hints import Array
from ..model.scenario import Scenario
from .style import (
    BOUND,
    HALO,
    OURS,
    PUBLISHED,
    SENSOR,
    TRUTH,
    doppler_lines,
    drawing,
    project,
    sensor_colors,
)

_FLOOR = -0.27  # m below the middle of the ring
_GRID = "#DDDDDD"


@drawing(7, 6.4)
def hero(
    figure: Figure,
    scenario: Scenario,
    z: Array,
    tracks: Array,
    start: Array,
    azimuth: float = -62.0,
    elevation: float = 16.0,
) -> None:
    """Draw one record of Doppler shifts, the tracks of many, and their errors.

    scenario: Ring of sensors, true path and its sampling.
    z (K, N): Doppler measurements of one run in Hz.
    tracks (runs, K, 6): Estimated states of many runs in m and m/s.
    start (6,): State with which every run starts.
    azimuth, elevation: From where the scene is seen, in degrees; see `project`.
    """
    grid = figure.add_gridspec(2, 2, height_ratios=(1.45, 1))
    scene = figure.add_subplot(grid[0, :])
    _draw_scene(scene, scenario, tracks, start, lambda p: project(p, azimuth, elevation))
    curves = figure.add_subplot(grid[1, 0])
    doppler_lines(curves, scenario.time, z)
    curves.set_title("Measured: six Doppler shifts (one run)")
    errors = figure.add_subplot(grid[1, 1])
    _draw_errors(errors, scenario, tracks)


def _draw_scene(ax, scenario, tracks, start, view):
    for line in _floor():
        ax.plot(*view(line).T, color=_GRID, lw=0.7)
    for x in (0.0, 0.5, 1.0):
        ax.annotate(f"{x:g} m", view([x, -0.2, _FLOOR]), (0, -9), color=BOUND,
                    textcoords="offset points", ha="center", va="center")  # fmt: skip
    _draw_ring(ax, scenario.array, view)

    first = np.broadcast_to(start[:3], (len(tracks), 1, 3))
    fan = view(np.concatenate([first, tracks[:, ::4, :3]], axis=1))
    ax.add_collection(LineCollection(fan, colors=OURS, linewidths=0.5, alpha=0.3))
    path = scenario.truth[:, :3]
    shadow = path * [1, 1, 0] + [0, 0, _FLOOR]
    ax.plot(*view(shadow).T, color=BOUND, lw=2, alpha=0.4)
    for k in (0, -1):
        ax.plot(*view([path[k], shadow[k]]).T, ":", color=BOUND, lw=0.8)
    ax.plot(*view(path).T, color=TRUTH, lw=2)
    tail, head = view(path[[len(path) // 2, len(path) * 6 // 10]])
    ax.annotate("", head, tail, zorder=6,
                arrowprops={"arrowstyle": "-|>", "color": TRUTH, "mutation_scale": 20})  # fmt: skip
    ax.plot(*view(path[-1]), "s", color=TRUTH, ms=6)
    ax.plot(*view(start[:3]), "o", color=PUBLISHED, ms=6.5, mec="white", zorder=5)
    for text, point, place, color in (
        ("true path", view(path[0]), (48, -44), TRUTH),
        ("start of all runs (paper)", view(start[:3]), (42, 56), PUBLISHED),
    ):
        ax.annotate(text, point, place, color=color, textcoords="offset points",
                    arrowprops={"arrowstyle": "-", "color": color, "lw": 0.8})  # fmt: skip
    ax.set(aspect="equal", title=f"Computed: where {len(tracks)} runs of the filter see the target")
    ax.axis("off")


def _floor():
    for x in np.linspace(0, 1, 6):
        yield np.array([[x, -0.2, _FLOOR], [x, 0.2, _FLOOR]])
    for y in (-0.2, 0.0, 0.2):
        yield np.array([[0, y, _FLOOR], [1, y, _FLOOR]])


def _draw_ring(ax, array, view):
    around = np.linspace(0, 2 * np.pi, 181)
    radius = np.linalg.norm(array.positions[0])
    circle = np.stack([0 * around, radius * np.cos(around), radius * np.sin(around)], axis=-1)
    ax.plot(*view(circle).T, color=SENSOR, lw=5, alpha=0.25)
    for n, (s, color) in enumerate(zip(array.positions, sensor_colors(len(array)), strict=True)):
        outward = view(s) / np.linalg.norm(view(s))
        ax.plot(*view(s), "o", color=color, ms=9, mec="white")
        ax.annotate(str(n + 1), view(s), 13 * outward, color=TRUTH, textcoords="offset points",
                    ha="center", va="center")  # fmt: skip


def _draw_errors(ax, scenario, tracks):
    distance = 100 * np.linalg.norm(tracks[..., :3] - scenario.truth[:, :3], axis=-1)
    lines = [np.stack([scenario.time[::4], run], axis=-1) for run in distance[:, ::4]]
    ax.add_collection(LineCollection(lines, colors=OURS, linewidths=0.4, alpha=0.35))
    median = np.median(distance, axis=0)
    ax.plot(scenario.time, median, color=TRUTH)
    ax.annotate("median", (scenario.time[-1] * 0.78, median[len(median) * 78 // 100]), (-62, -44),
                textcoords="offset points", color=TRUTH, bbox=HALO,
                arrowprops={"arrowstyle": "-", "color": TRUTH, "lw": 0.8})  # fmt: skip
    ax.set(xlabel="time (s)", ylabel="error (cm)", yscale="log", ylim=(0.008, 60),
           title=f"{len(tracks)} runs: error of the position")  # fmt: skip
    ax.set_yticks([0.01, 0.1, 1, 10], ["0.01", "0.1", "1", "10"])
    ax.margins(x=0)
