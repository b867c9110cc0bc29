"""Figure of two gates: the box of the thesis and the ellipse of a gate on NIS."""

import numpy as np
from matplotlib.patches import Ellipse, Rectangle

from .style import BOUND, ORANGE, OURS, SENSOR, TRUTH, styled


def gates(predictions, box, factor):
    """Draw the fixed box and the ellipse of a gate on NIS at several moments (Figs 4.2 and 4.3).

    Parameters
    ----------
    predictions : sequence of dict
        For each moment its `title`, the innovation covariances `S` (2, 2) of the settings whose
        gate is drawn, and `detections` (M, 2) relative to the prediction.
    box : tuple of float
        Half-widths in m and m/s.
    factor : float
        Bound on NIS.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with styled(7.0, 2.9) as figure:
        axes = figure.subplots(1, len(predictions), sharex=True, sharey=True)
        for ax, moment in zip(axes, predictions, strict=True):
            w, h = box
            ax.add_patch(Rectangle((-w, -h), 2 * w, 2 * h, fill=False, ec=ORANGE, ls="--", lw=1.6,
                                   label="box of the thesis"))  # fmt: skip
            values, vectors = np.linalg.eigh(moment["S"])
            angle = np.degrees(np.arctan2(vectors[1, 1], vectors[0, 1]))
            size = 2 * np.sqrt(factor * values[::-1])
            ax.add_patch(Ellipse((0, 0), *size, angle=angle, fill=False, ec=OURS, lw=1.6,
                                 label="NIS gate"))  # fmt: skip
            d = moment["detections"]
            nis = np.sum(d * np.linalg.solve(moment["S"], d.T).T, axis=-1)
            inside = nis <= factor
            ax.plot(*d[inside].T, "o", color=SENSOR, ms=5, label="inside the ellipse")
            ax.plot(*d[~inside].T, "x", color=BOUND, ms=6, mew=1.6, label="outside")
            if inside.any():
                nearest = d[inside][np.argmin(nis[inside])]
                ax.plot(*nearest, "o", mfc="none", mec=TRUTH, ms=11, label="nearest")
            ax.plot(0, 0, "+", color=TRUTH, ms=10, mew=1.6)
            ax.set(title=moment["title"], xlabel="range − prediction in m")
            ax.set(xlim=(-1.7, 1.7), ylim=(-1.2, 1.2))
        axes[0].set_ylabel("velocity − prediction in m/s")
        handles, labels = axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=5, fontsize=8.5)
        return figure
