"""Figures of the chapter on ring coordinates: knowledge from nowhere, valleys, beliefs."""

import numpy as np
from matplotlib.figure import Figure

from .._hints import Array
from .style import BOUND, HALO, LABEL, ORANGE, OURS, PINK, SKY, TRUTH, drawing, plain_log_ticks

_DEPTHS = (OURS, "#74B3D9", "#C5E0F0")  # one, two and three sigma
_GRAYS = ("#EDEDED", "#D0D0D0", "#A8A8A8")  # the most likely 99, 90 and 50 %
_LINES = ((SKY, ":"), (ORANGE, "--"), (PINK, "-."), (TRUTH, (0, (1, 1))), (OURS, "-"))


@drawing(7, 3.1)
def knowledge(
    figure: Figure, claims: dict[str, Array], errors: dict[str, Array], attainable: float
) -> None:
    """Draw the accuracy of the scale that filters claim, and their errors.

    claims (K + 1,): Standard deviation of ln rho that each filter claims before the first sample
        and after each one, by its label.
    errors (K + 1,): Root mean squared errors, by the same labels.
    attainable: Standard deviation that all samples together can give at best.
    """
    both = figure.subplots(1, 2, sharey=True)
    for ax, values in zip(both, (claims, errors), strict=True):
        ax.axhline(attainable, color=BOUND, lw=1)
        for (label, value), (color, style) in zip(values.items(), _LINES, strict=False):
            ax.semilogy(np.arange(len(value)), value, color=color, ls=style, label=label)
        ax.set(xlabel="number of samples")
        ax.margins(x=0)
    both[0].annotate("attainable", (0.97, attainable), (0, -7), color=BOUND,
                     xycoords=("axes fraction", "data"), **LABEL | {"ha": "right"})  # fmt: skip
    both[0].set(ylabel="relative error of rho", title="claimed")
    both[1].set(title="made")
    both[1].legend(loc="lower left")
    plain_log_ticks(both[0].yaxis)


@drawing(7, 2.9)
def valleys(
    figure: Figure,
    eta_y: Array,
    eta_z: Array,
    misfits: dict[str, Array],
    states: dict[str, Array],
) -> None:
    """Draw the misfit to a snapshot over eta, one panel for each target.

    eta_y (A,): First coordinates in 1/m.
    eta_z (B,): Second ones.
    misfits (B, A): Chi-square of the best beta and b, without noise, by target.
    states (M, 2): Eta of the target, and of its twin if it has one, by target.
    """
    axes = figure.subplots(1, len(misfits), sharex=True, sharey=True)
    for ax, (label, misfit) in zip(axes, misfits.items(), strict=True):
        ax.contourf(eta_y, eta_z, np.sqrt(misfit), [0, 1, 2, 3], colors=_DEPTHS)
        for name, place, marker in zip(("target", "twin"), states[label], "sX", strict=False):
            ax.plot(*place, marker, color=TRUTH, ms=6, mec="white")
            ax.annotate(name, place, (0, 11), bbox=HALO, **LABEL)
        ax.set(title=label, xlabel=r"$\eta_y$ (1/m)", aspect="equal")
        ax.locator_params(nbins=3)
    axes[0].set_ylabel(r"$\eta_z$ (1/m)")


@drawing(7, 5.0)
def three_steps(
    figure: Figure,
    across: Array,
    ahead: Array,
    density: Array,
    draws: dict[str, Array],
    truth: Array,
) -> None:
    """Draw beliefs of filters over the exact posterior, two rows of panels.

    across (A,): Positions to the side in m.
    ahead (B,): Distances before the ring in m.
    density (B, A): Exact posterior density, up to a factor.
    draws (D, 2): Draws of both from what a filter claims, by its label.
    truth (2,): The target.
    """
    share = np.sort(density, axis=None)[::-1]
    inside = np.cumsum(share) / share.sum()
    levels = [share[np.searchsorted(inside, part)] for part in (0.99, 0.9, 0.5)]
    axes = figure.subplots(2, len(draws) // 2, sharex=True, sharey=True)
    for ax, (label, drawn) in zip(axes.flat, draws.items(), strict=True):
        ax.contourf(across, ahead, density, [*levels, share[0]], colors=_GRAYS)
        ax.plot(*drawn.T, ".", color=OURS, ms=2.5, mew=0)
        ax.plot(*truth, "s", color=TRUTH, ms=5, mec="white")
        ax.set(title=label, xlim=across[[0, -1]], ylim=ahead[[0, -1]])
    for ax in axes[-1]:
        ax.set(xlabel="z (m)")
    for ax in axes[:, 0]:
        ax.set(ylabel="x (m)")
