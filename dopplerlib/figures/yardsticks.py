"""Figures of the chapter on yardsticks: posteriors, and two means of many bounds."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from .._hints import Array
from .style import BOUND, ORANGE, OURS, PINK, SENSOR, TRUTH, drawing, plain_log_ticks

# Exact posterior, tracker, mean bound, posterior bound: told apart by line and marker as well.
_CURVES = ((TRUTH, "-", "o"), (OURS, "--", "s"), (BOUND, "-", None), (PINK, ":", None))


@drawing(7.0, 3.1)
def posteriors(
    figure: Figure, clouds: dict[str, Array], truths: Array, twin: Array, ellipses: Array
) -> None:
    """Draw states drawn from posteriors, across the axis of the ring, as records get longer.

    clouds (S, 2): y and z of draws in m, for each length of the record.
    truths (M, 2): True y and z there.
    twin (2): The other state that explains a short record.
    ellipses (M, 100, 2): Lines that hold 95 % of the draws if the bound at the truth were right.
    """
    axes = figure.subplots(1, len(clouds), sharex=True, sharey=True)
    for ax, (name, cloud), truth, line in zip(axes, clouds.items(), truths, ellipses, strict=True):
        ax.plot(*cloud.T, "o", color=OURS, ms=1.5, alpha=0.35, mec="none", label="posterior")
        ax.plot(*line.T, color=BOUND, lw=1.2, label="95 % by the bound at the truth")
        ax.plot(*truth, "+", color=TRUTH, ms=10, mew=1.8, label="truth")
        ax.plot(*twin, "x", color=ORANGE, ms=8, mew=1.8, label="twin")
        ax.set(title=name, xlabel="y (m)", xlim=(-0.6, 0.6), ylim=(-0.6, 0.6))
        ax.set_aspect("equal")
    axes[0].set_ylabel("z (m)")
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=4)


@drawing(7.0, 3.6)
def errors(
    figure: Figure,
    time: Array,
    measured: dict[str, dict[str, Array]],
    bound_time: Array,
    bounds: dict[str, dict[str, Array]],
) -> None:
    """Draw root mean square position errors over time, in a panel for each case, and bounds.

    time (O,): Times in s of the errors.
    measured (O, 3): For each case and estimator: RMSE in m, and the ends of its interval.
    bound_time (B,): Times in s of the bounds.
    bounds (B,): For each case and bound, in m.
    """
    axes = figure.subplots(1, len(measured), sharex=True, sharey=True)
    for ax, (case, curves) in zip(axes, measured.items(), strict=True):
        places = time * np.linspace(0.98, 1.02, len(curves))[:, None]  # side by side
        for at, (name, curve), (color, ls, marker) in zip(
            places, curves.items(), _CURVES, strict=False
        ):
            value, low, high = curve.T
            ax.errorbar(
                at, value, [value - low, high - value], color=color, ls=ls, marker=marker, ms=4,
                capsize=2, label=name,
            )  # fmt: skip
        for (name, curve), (color, ls, _) in zip(bounds[case].items(), _CURVES[2:], strict=True):
            ax.plot(bound_time, curve, color=color, ls=ls, label=name)
        ax.set(title=case, xlabel="time (s)", xscale="log", yscale="log")
        plain_log_ticks(ax.xaxis)
    axes[0].set_ylabel("position error, RMS (m)")
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=2)


@drawing(7.0, 3.6)
def many_bounds(
    figure: Figure, places: Array, covariances: Array, means: dict[str, Array], sensors: Array
) -> None:
    """Draw the bounds of several targets as ellipses, where they are and about one point.

    places (M, 2): y and x of the targets in m.
    covariances (M, 2, 2): Bounds of y and x in m^2, drawn with two standard deviations.
    means (2, 2): Means of the bounds, by name.
    sensors (N, 2): y and x of the sensors in m.
    """
    left, right = figure.subplots(1, 2)
    angle = np.linspace(0, 2 * np.pi, 100)
    circle = 2 * np.array([np.cos(angle), np.sin(angle)])
    for place, P in zip(places, covariances, strict=True):
        line = (np.linalg.cholesky(P) @ circle).T
        left.plot(*(place + line).T, color=OURS, lw=1)
        right.plot(*(1e3 * line).T, color=OURS, lw=0.7, alpha=0.6)
    left.plot(*sensors.T, "s", color=SENSOR, ms=4, label="sensors")
    left.set(xlabel="y (m)", ylabel="x (m)")
    looks = ((TRUTH, "--"), (PINK, "-"))
    for (name, P), (color, ls) in zip(means.items(), looks, strict=True):
        line = 1e3 * (np.linalg.cholesky(P) @ circle).T
        right.plot(*line.T, color=color, ls=ls, lw=2, label=name)
    right.set(xlabel="error of y (mm)", ylabel="error of x (mm)")
    for ax in (left, right):
        ax.set_aspect("equal", adjustable="datalim")
    figure.legend(loc="outside lower center", ncols=3)


@drawing(7.0, 3.2)
def shells(figure: Figure, edges: Array, bounds: Array, names: Sequence[str]) -> None:
    """Draw two means of the bounds of the targets in each range of distance.

    edges (M + 1,): Ends of the ranges in m.
    bounds (2, M): Position errors in m.
    names: Of the two means.
    """
    ax = figure.subplots()
    looks = ((TRUTH, "--"), (PINK, "-"))
    for curve, name, (color, ls) in zip(bounds, names, looks, strict=True):
        ax.stairs(1e3 * curve, edges, color=color, ls=ls, lw=2, baseline=None, label=name)
    ax.set(xlabel="distance from the ring (m)", ylabel="position error, RMS (mm)", yscale="log")
    plain_log_ticks(ax.yaxis)
    ax.legend(loc="center right")


@drawing(7.0, 3.2)
def nees(
    figure: Figure, values: Array, q: Array, density: Array, spreads: dict[str, tuple[float, ...]]
) -> None:
    """Draw the NEES of many runs beside chi-square, and intervals for their mean.

    values (runs,): NEES of each run.
    q, density (Q,): Places, and the density of chi-square there.
    spreads: For each reason, an interval in which the mean should lie.
    """
    left, right = figure.subplots(1, 2, width_ratios=(3, 2))
    edges = np.linspace(0, 30, 61)
    left.hist(values, edges, density=True, color=OURS, alpha=0.5, label="exact posterior")
    left.plot(q, density, color=TRUTH, label="chi-square")
    left.set(xlabel="NEES", ylabel="probability density", xlim=(0, 30))
    left.legend()
    looks = ((TRUTH, "s"), (OURS, "o"))
    for i, ((name, (low, high)), (color, marker)) in enumerate(
        zip(spreads.items(), looks, strict=True)
    ):
        middle = (low + high) / 2
        right.errorbar(
            middle, i, xerr=[[middle - low], [high - middle]], color=color, marker=marker,
            capsize=4, lw=2,
        )  # fmt: skip
        right.annotate(name, (middle, i), (0, 12), textcoords="offset points", ha="center")
    right.axvline(values.mean(), color=OURS, ls="--", lw=1)
    right.set(xlabel="mean NEES", ylim=(-0.6, 1.7), yticks=[])
