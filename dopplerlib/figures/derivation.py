"""Figures of the chapter on derivation: printed forms, errors of derivatives, a wrong sign."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch

from .._hints import Array
from .style import BOUND, ORANGE, OURS, PINK, PUBLISHED, TRUTH, drawing

_DOUBLE = 2.0**-53  # relative error of one rounding


@drawing(7.0, 2.5)
def one_text(figure: Figure, stages: Sequence[str], products: Sequence[str]) -> None:
    """Draw the path from one formula to its printed forms.

    stages: Boxes in a row, the formula first.
    products: Boxes to which the last stage leads.
    """
    ax = figure.subplots()
    ax.set(xlim=(0, len(stages) + 1), ylim=(-0.1, len(products) + 0.1))
    ax.axis("off")
    middle = len(products) / 2

    def box(x, y, text, height, color):
        corner, rounded = (x + 0.09, y - height / 2), "round,pad=0,rounding_size=0.06"
        patch = FancyBboxPatch(corner, 0.82, height, boxstyle=rounded, mutation_aspect=3)
        patch.set(facecolor="white", edgecolor=color, linewidth=1.4)
        ax.add_patch(patch)
        ax.text(x + 0.5, y, text, ha="center", va="center", fontsize=9, color=TRUTH)

    def arrow(start, end):
        ax.add_patch(FancyArrowPatch(start, end, arrowstyle="-|>", mutation_scale=11, color=BOUND))

    for i, text in enumerate(stages):
        box(i, middle, text, 1.5, BOUND if i else PUBLISHED)
        if i:
            arrow((i - 0.08, middle), (i + 0.08, middle))
    for i, text in enumerate(reversed(products)):
        box(len(stages), i + 0.5, text, 0.72, OURS)
        arrow((len(stages) - 0.08, middle), (len(stages) + 0.08, i + 0.5))


@drawing(7.0, 3.8)
def derivative_errors(figure: Figure, steps: Array, errors: dict[str, Array]) -> None:
    """Draw the relative error of numerical derivatives against the step.

    steps (M,): Steps in m.
    errors (M,): Relative error of each method. Below one rounding of a double it is drawn there.
    """
    ax = figure.subplots()
    markers = ("o", "s", "^", "D")
    for (label, error), marker, color in zip(
        errors.items(), markers, (ORANGE, PINK, OURS, TRUTH), strict=False
    ):
        shown = np.maximum(error, _DOUBLE)
        ax.loglog(steps, shown, marker=marker, ms=3.5, lw=1.0, color=color, label=label)
    ax.axhline(_DOUBLE, color=BOUND, ls="--", lw=1.0)
    ax.text(
        steps.max(), 1.4 * _DOUBLE, "one rounding", ha="right", va="bottom", color=BOUND, fontsize=9
    )
    ax.set(xlabel="step (m)", ylabel="relative error", ylim=(2e-17, 100))
    ax.legend(loc="center left", bbox_to_anchor=(0.03, 0.4))


@drawing(7.0, 3.6)
def position_errors(figure: Figure, time: Array, errors: dict[str, Array]) -> None:
    """Draw position errors of many runs: median, and the range of the central 95 % of the runs.

    time (K,): Time in s.
    errors (runs, K): Distances between estimate and truth in m, by label.
    """
    ax = figure.subplots()
    for (label, error), color, style in zip(
        errors.items(), (OURS, ORANGE), ("-", "--"), strict=False
    ):
        lower, middle, upper = np.quantile(error, [0.025, 0.5, 0.975], axis=0)
        ax.fill_between(time, lower, upper, color=color, alpha=0.2, lw=0)
        ax.semilogy(time, middle, style, color=color, label=label)
    ax.set(xlabel="time (s)", ylabel="position error (m)", xlim=(time[0], time[-1]))
    ax.legend(loc="lower left")
