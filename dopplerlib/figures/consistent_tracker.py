"""Figures of the comparison of trackers: a sum of Gaussians, NEES, errors over bounds."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse

from .._hints import Array
from ..workspace.errors import ErrorSummary
from .style import BOUND, ORANGE, OURS, PINK, PUBLISHED, SKY, TRUTH, drawing, looks, plain_log_ticks

# Trackers of the workspace have one look each, in the chapter on the decision to stop as well.
TRACKERS = {
    "truth": (TRUTH, ":", "x"),
    "sum": (OURS, "-", "o"),
    "paper": (PUBLISHED, "--", "s"),
    "P = 0.1 I": (PUBLISHED, "--", "s"),
    "Bayes": (ORANGE, "-.", "^"),
    "IEKF": (SKY, "-.", "P"),
    "UKF": (PINK, ":", "D"),
    "EKF": (PINK, "--", "v"),
}
# Settings of one tracker: right, two of sigma_f, two of sigma_a, and another prior.
_SETTINGS = (
    (OURS, "-"),
    (ORANGE, "--"),
    (ORANGE, "-."),
    (PINK, "--"),
    (PINK, ":"),
    (BOUND, "-"),
)
_MEAN, _MEDIAN = 6.0, 5.348  # of chi-square with six degrees of freedom
_FAINTEST = 0.12  # opacity of a Gaussian of no weight


@drawing(7.0, 5.6)
def members(
    figure: Figure,
    times: Sequence[float],
    weights: Array,
    means: Array,
    covariances: Array,
    truth: Array,
    other: Array,
    other_covariances: Array,
) -> None:
    """Draw the Gaussians of a sum at some times, seen from the ring, and another filter's ellipse.

    times (P,): In s, one for each panel.
    weights (P, M): Weights of the Gaussians, 0 where there are fewer.
    means (P, M, 2): Their means of y and z in m.
    covariances (P, M, 2, 2): Their covariances.
    truth (P, 2): The true place.
    other (P, 2): Estimate of the other filter.
    other_covariances (P, 2, 2): Its covariances.
    """
    rows = -(-len(times) // 3)
    panels = figure.subplots(rows, 3, sharex=True, sharey=True, squeeze=False)
    for i, ax in enumerate(panels.ravel()):
        if i >= len(times):
            ax.remove()
            continue
        there = weights[i] > 0
        heaviest = weights[i].max()
        for w, m, P in zip(weights[i][there], means[i][there], covariances[i][there], strict=True):
            alpha = _FAINTEST + (1 - _FAINTEST) * float(w / heaviest)
            ax.add_patch(_ellipse(m, P, ec=OURS, fc="none", lw=1.2, alpha=alpha))
        ax.add_patch(
            _ellipse(other[i], other_covariances[i], ec=PUBLISHED, fc="none", lw=1.6, ls="--")
        )
        ax.plot(*other[i], "x", color=PUBLISHED, ms=6)
        ax.plot(*truth[i], "+", color=TRUTH, ms=11, mew=1.8)
        count = int(there.sum())
        ax.set_title(f"{1e3 * times[i]:g} ms: {count} Gaussian{'s' * (count > 1)}")
        ax.set(xlim=(-0.6, 0.6), ylim=(-0.6, 0.6), aspect="equal")
        ax.set(xticks=(-0.5, 0, 0.5), yticks=(-0.5, 0, 0.5))
    for ax in panels[-1]:
        ax.set_xlabel("y (m)")
    for ax in panels[:, 0]:
        ax.set_ylabel("z (m)")
    handles = [
        ([], [], {"color": OURS, "label": "Gaussians of the sum"}),
        ([], [], {"color": PUBLISHED, "ls": "--", "marker": "x", "label": "EKF of the paper"}),
        ([], [], {"color": TRUTH, "ls": "", "marker": "+", "ms": 9, "label": "truth"}),
    ]
    for x, y, style in handles:
        panels[0, 0].plot(x, y, **style)
    figure.legend(*panels[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=3)


@drawing(7.0, 5.6)
def nees(figure: Figure, cases: dict[str, dict[str, ErrorSummary]]) -> None:
    """Draw mean and median of the NEES of trackers over time, one column for each case.

    The mean has two standard errors, where these are less than half of it: a mean that one run
    makes has none. Beyond 1e8 nothing is shown: there a covariance is singular to rounding.

    cases: By title of the panel, the statistics of each tracker by its label.
    """
    panels = figure.subplots(2, len(cases), sharex=True, sharey=True, squeeze=False)
    for (mean, median), (title, trackers) in zip(panels.T, cases.items(), strict=True):
        for label, (color, ls, _) in looks(trackers, TRACKERS).items():
            found = trackers[label]
            mean.plot(found.time, found.nees, color=color, ls=ls, label=label)
            width = np.where(4 * found.nees_error < found.nees, 2 * found.nees_error, np.nan)
            band = found.nees - width, found.nees + width
            mean.fill_between(found.time, *band, color=color, alpha=0.2, lw=0)
            median.plot(found.time, found.nees_median, color=color, ls=ls)
        for ax, consistent in ((mean, _MEAN), (median, _MEDIAN)):
            ax.axhline(consistent, color=BOUND, lw=0.8, label="consistent")
            ax.set(yscale="log", ylim=(3, 1e8), xlim=(0, 1))
        mean.set_title(title)
        median.set_xlabel("time (s)")
    for ax, what in zip(panels[:, 0], ("mean NEES", "median NEES"), strict=True):
        ax.set_ylabel(what)
    _below(figure, panels[0, 0])


@drawing(7.0, 5.6)
def over_bound(figure: Figure, cases: dict[str, dict[str, ErrorSummary]]) -> None:
    """Draw root mean square position errors over the mean bound, one panel for each case.

    cases: By title of the panel, the statistics of each tracker by its label.
    """
    panels = figure.subplots(-(-len(cases) // 2), 2, sharex=True, sharey=True, squeeze=False)
    for ax, (title, trackers) in zip(panels.ravel(), cases.items(), strict=False):
        for label, (color, ls, _) in looks(trackers, TRACKERS).items():
            found = trackers[label]
            ratio = found.position / found.position_bound
            ax.plot(found.time, ratio, color=color, ls=ls, label=label)
        ax.axhline(1, color=BOUND, lw=0.8, label="bound")
        ax.set(title=title, yscale="log", xlim=(0, 1), ylim=(0.8, 300))
    for ax in panels[-1]:
        ax.set_xlabel("time (s)")
    figure.supylabel("position error over bound (ratio)", fontsize="medium")
    _below(figure, panels[0, 0])


@drawing(7.0, 3.2)
def wrong_settings(figure: Figure, found: dict[str, ErrorSummary]) -> None:
    """Draw mean NEES and position error over the bound of one tracker with several settings.

    found: Statistics by what the tracker assumes; the first one as the truths are.
    """
    left, right = figure.subplots(1, 2)
    for (label, one), (color, ls) in zip(found.items(), _SETTINGS, strict=False):
        left.plot(one.time, one.nees, color=color, ls=ls, label=label)
        right.plot(one.time, one.position / one.position_bound, color=color, ls=ls)
    left.axhline(6, color=BOUND, lw=0.8)
    right.axhline(1, color=BOUND, lw=0.8)
    left.set(xlabel="time (s)", ylabel="mean NEES", yscale="log", xlim=(0, 1))
    plain_log_ticks(left.yaxis)
    right.set(xlabel="time (s)", ylabel="error over bound (ratio)", xlim=(0, 1))
    _below(figure, left)


def _below(figure, ax):
    figure.legend(*ax.get_legend_handles_labels(), loc="outside lower center", ncols=3)


def _ellipse(mean, P, **style):
    """Return the ellipse of two standard deviations."""
    size, axis = np.linalg.eigh(P)
    width, height = 4 * np.sqrt(size)
    angle = np.degrees(np.arctan2(axis[1, 0], axis[0, 0]))
    return Ellipse(mean, width, height, angle=angle, **style)
