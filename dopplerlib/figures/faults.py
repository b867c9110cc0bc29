"""Figure of the chapter on faults: a map of trackers and what goes wrong."""

import numpy as np
from matplotlib.figure import Figure

from .style import drawing, ink


@drawing(7.0, 7.4)
def fault_map(figure: Figure, fractions: dict[str, dict[str, float]], quantity: str) -> None:
    """Draw fractions as a map with numbers: a row for each fault, a column for each tracker.

    fractions: For each fault, that of each tracker.
    quantity: Of what, for the color bar.
    """
    faults = list(fractions)
    trackers = list(dict.fromkeys(name for row in fractions.values() for name in row))
    value = 100 * np.array([[fractions[f].get(t, np.nan) for t in trackers] for f in faults])
    ax = figure.subplots()
    image = ax.imshow(value, cmap="cividis_r", vmin=0, vmax=100, aspect="auto")
    ax.set_facecolor("#DDDDDD")
    ax.grid(False)
    for (i, j), percent in np.ndenumerate(value):
        if np.isfinite(percent):
            color = ink(image.cmap(image.norm(percent)))
            ax.annotate(f"{percent:.0f}", (j, i), ha="center", va="center", color=color, size=8)
    ax.set_xticks(range(len(trackers)), trackers, rotation=45, ha="left", rotation_mode="anchor")
    ax.set_yticks(range(len(faults)), faults)
    ax.tick_params(top=True, bottom=False, labeltop=True, labelbottom=False, length=0)
    figure.colorbar(image, ax=ax, fraction=0.03, shrink=0.6, pad=0.06).set_label(f"{quantity} (%)")
