"""Figures of the chapter on SIMULATED recordings of real radars; each title says so."""

from collections.abc import Sequence
from itertools import cycle

import numpy as np
from matplotlib.figure import Figure

from .._hints import Array
from ..tracking.multi_target import ManagedTrack
from .style import BOUND, MEASURED, ORANGE, OURS, PINK, SENSOR, TRUTH, drawing

_LABEL = "SIMULATED"
_TRACKS = ((OURS, "."), (ORANGE, "x"), (SENSOR, "^"), (TRUTH, "+"))


@drawing(7.0, 3.4)
def records(
    figure: Figure,
    time: Array,
    panels: dict[str, dict[str, Array]],
    window: tuple[float, float],
    gap: tuple[float, float],
) -> None:
    """Draw detections, the chosen ones and the filtered range over time (Figs 6.1 to 6.4).

    time (K,): Time of each scan in s.
    panels: For each title: `detections` (K, M), and optionally `chosen` (K,), `filtered` (K,) and
        `truth` (K,); ranges in m.
    window: Ranges between which the radar sees something, in m.
    gap: Between these times nothing is seen, in s.
    """
    axes = figure.subplots(1, len(panels), sharey=True, squeeze=False)[0]
    for ax, (title, data) in zip(axes, panels.items(), strict=True):
        ax.axvspan(*gap, color=BOUND, alpha=0.15, lw=0)
        for edge in window:
            ax.axhline(edge, color=BOUND, lw=0.8, ls=":")
        d = data["detections"]
        ax.plot(np.repeat(time, d.shape[1]), d.ravel(), "o", mfc="none", mec=MEASURED, ms=4,
                label="detections")  # fmt: skip
        if "truth" in data:
            ax.plot(time, data["truth"], color=TRUTH, ls="--", label="true")
        if "chosen" in data:
            ax.plot(time, data["chosen"], "o", color=SENSOR, ms=4, label="chosen")
        if "filtered" in data:
            ax.plot(time, data["filtered"], "+", color=OURS, ms=6, mew=1.4, label="filtered")
        ax.set(title=f"{_LABEL}: {title}", xlabel="time (s)", ylim=(0.5, 7.5))
    axes[0].set_ylabel("range (m)")
    handles, labels = axes[-1].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4)


@drawing(7.0, 3.2)
def positions(figure: Figure, truth: Array, raw: Array, estimate: Array, sensors: Array) -> None:
    """Draw bilaterated positions in the plane (Fig 6.4(c)).

    truth, raw, estimate (K, 2): Positions in m.
    sensors (2, 2): Positions of the radars in m.
    """
    ax = figure.subplots()
    across, away = 0, 1
    for xy, look in (
        (raw, {"marker": "o", "mfc": "none", "mec": MEASURED, "ls": "", "ms": 5,
               "label": "detections, bilaterated"}),
        (estimate, {"marker": "+", "color": OURS, "ls": "", "ms": 7, "mew": 1.5,
                    "label": "filtered, bilaterated"}),
        (truth, {"color": TRUTH, "ls": "--", "label": "true"}),
        (sensors, {"marker": "o", "color": SENSOR, "ls": "", "ms": 7, "label": "radars"}),
    ):  # fmt: skip
        ax.plot(xy[:, away], xy[:, across], **look)
    ax.set(title=f"{_LABEL}: position from both radars", xlabel="y (m)", ylabel="x (m)")
    figure.legend(*ax.get_legend_handles_labels(), loc="outside lower center", ncols=4)


@drawing(7.0, 3.2)
def coasting(
    figure: Figure,
    time: Array,
    truth: Sequence[Array],
    runs: Sequence[Array],
    gap: tuple[float, float],
    titles: Sequence[str],
) -> None:
    """Draw the filtered ranges of many walks through the gap.

    time (K,): Time of each scan in s.
    truth (K,): True range for each panel in m.
    runs (runs, K): Filtered ranges in m.
    gap: Between these times nothing is seen, in s.
    titles: One for each panel.
    """
    axes = figure.subplots(1, len(runs), sharey=True)
    for ax, true, d, title in zip(axes, truth, runs, titles, strict=True):
        ax.axvspan(*gap, color=BOUND, alpha=0.15, lw=0)
        ax.plot(time, d.T, color=OURS, lw=0.6, alpha=0.5)
        ax.plot([], [], color=OURS, lw=0.8, label=f"filtered, {len(d)} walks")
        ax.plot(time, true, color=TRUTH, ls="--", lw=2, label="true")
        ax.set(title=f"{_LABEL}: {title}", xlabel="time (s)", ylim=(0, 12))
        ax.legend(loc="upper left")
    axes[0].set_ylabel("range (m)")


@drawing(7.0, 3.3)
def managed(
    figure: Figure,
    time: Array,
    detections: Array,
    tracks: Sequence[ManagedTrack],
    truth: Array,
    gap: tuple[float, float],
    alternative: Array,
) -> None:
    """Draw confirmed tracks of one record, and a single track with probabilistic association.

    time (K,): Time of each scan in s.
    detections (K, M): Ranges in m.
    tracks: As `managed_tracks` returns them.
    truth (K,): True range in m.
    gap: Between these times nothing is seen, in s.
    alternative (K,): Ranges of the filter with association by probability, in m.
    """
    left, right = figure.subplots(1, 2, sharey=True)
    for ax in (left, right):
        ax.axvspan(*gap, color=BOUND, alpha=0.15, lw=0)
        ax.plot(np.repeat(time, detections.shape[1]), detections.ravel(), "o", mfc="none",
                mec=MEASURED, ms=4, label="detections")  # fmt: skip
        ax.plot(time, truth, color=TRUTH, ls="--", label="true")
        ax.set(xlabel="time (s)", ylim=(0.5, 6.5))
    for i, (track, (color, marker)) in enumerate(zip(tracks, cycle(_TRACKS), strict=False), 1):
        left.plot(time[track.scan], track.x[:, 0], color=color, marker=marker, ms=4,
                  markevery=2, label=f"track {i}")  # fmt: skip
    right.plot(time, alternative, color=PINK, marker=".", ms=4, label="PDA")
    left.set(title=f"{_LABEL}: managed tracks", ylabel="range (m)")
    right.set_title(f"{_LABEL}: one track, PDA")
    entries = {}
    for ax in (left, right):
        for handle, label in zip(*ax.get_legend_handles_labels(), strict=True):
            entries.setdefault(label, handle)
    figure.legend(entries.values(), entries, loc="outside lower center", ncols=6, fontsize=8.5)
