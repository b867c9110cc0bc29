"""Figures of the chapter on benchmarks: times, with the spread of their rounds."""

import numpy as np
from matplotlib.figure import Figure

from .._hints import Array
from .style import BOUND, OURS, PUBLISHED, TRUTH, drawing

_MARKERS = ("o", TRUTH), ("s", PUBLISHED), ("^", BOUND)


@drawing(7.0, 4.2)
def step_times(figure: Figure, times: dict[str, dict[str, Array]], unit: str) -> None:
    """Draw times as a marker at the median and a line from least to most, a row for each name.

    times (R,): For each kind and name the times of all rounds; a name may be of some kinds only.
    unit: Unit of the times, as the axis shows it.
    """
    ax = figure.subplots()
    names = list(dict.fromkeys(name for kind in times.values() for name in kind))
    for (kind, rows), (marker, color) in zip(times.items(), _MARKERS, strict=False):
        least, middle, most = np.quantile(list(rows.values()), [0, 0.5, 1], axis=-1)
        places = [names.index(name) for name in rows]
        error = np.stack([middle - least, most - middle])
        ax.errorbar(
            middle, places, xerr=error, fmt=marker, color=color, ms=5, capsize=2, label=kind
        )
    ax.set(xlabel=f"time ({unit})", xscale="log", ylim=(len(names) - 0.5, -0.5))
    ax.set_yticks(range(len(names)), names)
    for label, name in zip(ax.get_yticklabels(), names, strict=True):
        label.set(color=OURS if name.startswith("dopplerlib") else TRUTH)
    ax.grid(visible=True, axis="x")
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, 1.12), ncols=len(times))
