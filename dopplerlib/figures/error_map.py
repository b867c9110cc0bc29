"""Fig 3 of Mittermaier et al. (2016): maps of the error of a start, and how much area is bad."""

import numpy as np
from matplotlib.colors import LogNorm

from .style import OURS, PUBLISHED, SENSOR, TRUTH, VARIANTS, styled


def error_maps(x, y, maps, arrays, velocities, columns=3, limits=(0.025, 1.0)):
    """Return maps of position errors over the plane, x upwards as in the paper.

    Parameters
    ----------
    x, y : ndarray, shape (A,)
        Places in m.
    maps : dict of str to ndarray, shape (A, A)
        Errors in m, one panel for each; NaN stays white.
    arrays : sequence of RadarArray
        Sensors of each map.
    velocities : sequence of array_like, shape (3,)
        Velocity of the target in each map in m/s, drawn as an arrow in a corner.
    columns : int
        Panels side by side.
    limits : tuple of float
        Ends of the color scale in m.

    Returns
    -------
    matplotlib.figure.Figure
    """
    rows = -(-len(maps) // columns)
    with styled(7, 0.9 + 2.35 * rows * 3 / columns) as figure:
        axes = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
        for ax in axes.flat[len(maps) :]:
            ax.set_visible(False)
        shown = zip(axes.flat, maps.items(), arrays, velocities, strict=False)
        for ax, (label, error), array, velocity in shown:
            area = ax.pcolormesh(
                y,
                x,
                np.clip(error, *limits),
                norm=LogNorm(*limits),
                cmap="viridis",
                rasterized=True,
            )
            ax.plot(
                array.positions[:, 1], array.positions[:, 0], "o", color=SENSOR, ms=4, mec="white"
            )
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
        return figure


def shares(limits, panels):
    """Return the share of the area above an error, ours as bands of draws, and published.

    Parameters
    ----------
    limits : ndarray, shape (L,)
        Errors in m.
    panels : dict of str to dict of str to ndarray, shape (L,) or (L, draws)
        Shares by title of the panel and label of the curve. What has draws is ours and is drawn
        with the range of the central 95 % of them; what has none is published.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with styled(7, 3.4) as figure:
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
        axes[0].set_ylabel("share of the area above (1)")
        return figure


def line_profiles(axis, profiles, bound, lowest):
    """Return errors along two lines through the middle of a map.

    Parameters
    ----------
    axis : ndarray, shape (A,)
        Places along the line in m.
    profiles : dict of str to ndarray, shape (A,)
        Published errors in m by label, the first along the sensors as drawn, the second across;
        NaN where the error is below the lowest contour or hidden.
    bound : ndarray, shape (A,)
        Bound across the sensors in m: what they see well.
    lowest : float
        Lowest contour in m.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with styled(7, 3.2) as figure:
        ax = figure.subplots()
        marks = (("o", TRUTH), ("D", PUBLISHED))
        for (label, error), (mark, color) in zip(profiles.items(), marks, strict=True):
            ax.semilogy(axis, error, mark, color=color, ms=5, mec="white", label=label)
        ax.semilogy(axis, bound, color=OURS, label="bound across a line of sensors")
        ax.axhline(lowest, color=TRUTH, lw=1, ls=":")
        ax.annotate(
            "lowest contour",
            (0, lowest),
            (0, 3),
            textcoords="offset points",
            ha="center",
            fontsize=9,
        )
        ax.set(xlabel="place on the line (m)", ylabel="position error (m)", ylim=(5e-3, 60))
        figure.legend(*ax.get_legend_handles_labels(), loc="outside upper center", ncols=3)
        return figure
