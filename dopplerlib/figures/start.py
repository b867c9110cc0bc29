"""Where to start: the misfit over position, and errors of starts."""

import numpy as np
from matplotlib.colors import BoundaryNorm

from .style import BOUND, OURS, PUBLISHED, TRUTH, VARIANTS, styled

_LEVELS = (0, 1, 2, 3, 10, 30, 100, 300, 1000)


def reduced_cost(panels, marks, labels):
    """Return maps of the misfit that the best velocity leaves at every position.

    Parameters
    ----------
    panels : dict of str to tuple of ndarray
        By title: places along the horizontal axis (A,) and the vertical one (B,) in m, and the
        chi-square (B, A).
    marks : sequence of dict of str to array_like, shape (2,)
        Points (horizontal, vertical) of each panel, by label.
    labels : sequence of tuple of str
        What the axes of each panel are.

    Returns
    -------
    matplotlib.figure.Figure
    """
    styles = (("s", TRUTH), ("X", OURS))
    colors = BoundaryNorm(_LEVELS, 256)
    with styled(7, 3.3) as figure:
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
        return figure


def error_distributions(errors, marks, bounds):
    """Return which share of starts has smaller errors, for position and velocity.

    Parameters
    ----------
    errors : dict of str to tuple of ndarray, shape (runs,)
        Errors of position in m and of velocity in m/s, by label.
    marks : dict of str to tuple of float
        The same two errors of single published starts.
    bounds : tuple of float
        Root mean square bounds of both.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with styled(7, 3.9) as figure:
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
        axes[0].set_ylabel("share of starts below (1)")
        figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper center", ncols=2)
        return figure


def errors_by_samples(samples, errors, bound, printed):
    """Return how the position errors of starts fall with the length of the record.

    Parameters
    ----------
    samples : sequence of int, length M
        Lengths of the records.
    errors : sequence of ndarray, shape (runs,)
        Position errors in m for each length.
    bound : ndarray, shape (M,)
        Root mean square bounds in m.
    printed : tuple of float
        Number of samples and error of the published start.

    Returns
    -------
    matplotlib.figure.Figure
    """
    low, first, middle, third, high = np.transpose(
        [np.percentile(error, [5, 25, 50, 75, 95]) for error in errors]
    )
    with styled(7, 3.6) as figure:
        ax = figure.subplots()
        ax.fill_between(samples, low, high, color=OURS, alpha=0.2, lw=0, label="central 90 %")
        ax.fill_between(samples, first, third, color=OURS, alpha=0.35, lw=0, label="central 50 %")
        ax.loglog(samples, middle, "o-", color=OURS, ms=4, label="median of our starts")
        ax.loglog(samples, bound, color=BOUND, label="bound, root mean square")
        ax.plot(*printed, "D", color=PUBLISHED, ms=8, mec="white", label="printed in Table 2")
        ax.set_xticks(samples, labels=[f"{k}" for k in samples])
        ax.set_xticks([], minor=True)
        ax.set(xlabel="samples in the record (1)", ylabel="position error (m)")
        ax.legend(loc="lower left")
        return figure
