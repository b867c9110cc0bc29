"""Figures of the chapter on Fig 4: errors of the start against the noise."""

import numpy as np
from matplotlib.figure import Figure

from .._hints import Array
from ..systems.mittermaier2016 import NoiseSweep, PublishedFigure4
from .style import BOUND, ORANGE, OURS, PINK, PUBLISHED, drawing

_PARTS = (("position", "m"), ("velocity", "m/s"))


@drawing(7, 3.3)
def errors_by_noise(
    figure: Figure, ours: NoiseSweep, published: PublishedFigure4 | None = None
) -> None:
    """Draw mean errors against the variance of the noise, as in Fig 4 but on two log axes.

    ours: Drawn as a band from the least to the largest sequence, and their mean.
    published: Drawn as dots.
    """
    for ax, (part, unit) in zip(figure.subplots(1, 2), _PARTS, strict=True):
        error = getattr(ours, part)
        ax.fill_between(ours.variance, error.min(axis=1), error.max(axis=1), color=OURS,
                        alpha=0.3, lw=0, label="ours, all sequences")  # fmt: skip
        ax.plot(ours.variance, error.mean(axis=1), color=OURS, label="ours, mean")
        if published is not None:
            dots = getattr(published, part)
            x = np.repeat(published.variance, dots.shape[1])
            ax.plot(x, dots.ravel(), ".", color=PUBLISHED, ms=3, label="published")
        bound = getattr(ours, f"bound_{part}").mean(axis=1)
        ax.plot(ours.variance, bound, "--", color=BOUND, label="at the CRLB")
        ax.set(xscale="log", yscale="log", xlabel="variance of the noise (Hz²)",
               ylabel=f"{part} error ({unit})")  # fmt: skip
    figure.axes[0].legend(loc="upper left")


@drawing(7, 3.5)
def mean_and_median(
    figure: Figure, results: dict[str, tuple[Array, Array]], bound: Array, variance: Array
) -> None:
    """Draw errors divided by the standard deviation of the noise: flat where the problem is linear.

    results (L, D): Position errors in m by label: the mean and the median over the grid.
    bound (L,): Mean position error at the bound, in m, of the first of `results`.
    variance (L,): Of the noise, in Hz^2.
    """
    sigma_f = np.sqrt(variance)
    ax = figure.subplots()
    looks = ((OURS, "o"), (ORANGE, "s"), (PINK, "D"))
    for (label, pair), (color, marker) in zip(results.items(), looks, strict=False):
        for values, style, name in zip(pair, ("-", ":"), ("mean", "median"), strict=True):
            ax.plot(variance, values.mean(axis=1) / sigma_f, style, color=color, marker=marker,
                    ms=5, mfc=color if name == "mean" else "white",
                    label=f"{label}: {name}")  # fmt: skip
    ax.plot(variance, bound / sigma_f, "--", color=BOUND, label="mean at the CRLB")
    ax.set(xscale="log", xlabel="variance of the noise (Hz²)",
           ylabel="position error / $\\sigma_f$ (m/Hz)")  # fmt: skip
    ax.set_ylim(bottom=0)
    figure.legend(loc="outside upper center", ncols=2)


@drawing(7, 3.6)
def sequences(figure: Figure, sets: dict[str, tuple[Array, Array]]) -> None:
    """Draw the mean error of each sequence over the levels, position against velocity.

    sets (D,): By label: position errors in m/Hz and velocity errors in (m/s)/Hz, both divided by
        the deviation of the noise and averaged over levels. The first is the published one.
    """
    looks = ((PUBLISHED, "o"), (OURS, "^"), (ORANGE, "s"), (PINK, "x"), (BOUND, "+"))
    ax = figure.subplots()
    for (label, pair), (color, marker) in zip(sets.items(), looks, strict=False):
        ax.plot(*pair, marker, color=color, ms=5, label=label)
    ax.set(xlabel="position error / $\\sigma_f$ (m/Hz)",
           ylabel="velocity error / $\\sigma_f$ (m/s/Hz)")  # fmt: skip
    figure.legend(loc="outside upper center", ncols=3)
