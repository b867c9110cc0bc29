"""The best window in closed form, and what interpolating it linearly costs."""

from typing import Annotated, Literal

import numpy as np

from ... import _checks
from ..._hints import Count, Real, Reals, checked
from ..._typing import FloatArray
from ...signal.laws import optimal_window_end
from .published import reported
from .window_choice import Rising, WindowTable
from .window_transform import measurement_variance

Decibels = Annotated[FloatArray, _checks.decibels]
Span = tuple[Real, Real]


@checked
def best_window(acceleration: Reals, snr_db: Decibels) -> FloatArray:
    """Return the window whose velocity, used as that of its end, has the least error.

    acceleration (...): In m/s^2, not zero.
    snr_db: Signal-to-noise ratio of a sample in dB.
    Returns (...): Length in samples, any number: a constant times the acceleration to the power
        -2/5 and the signal-to-noise ratio to the power -1/5.
    Raises ValueError if an argument is not of the kind described or an acceleration is zero.

    Examples
    --------
    >>> best_window(10.0, 15.0).round().item()
    27.0
    """
    T = reported().stated.T
    if (acceleration == 0).any():
        raise ValueError("acceleration must not be zero, where the longest window is best, got 0")
    chirp = 2 * acceleration / reported().chosen.wavelength
    return optimal_window_end(10 ** (snr_db / 10) / T, chirp) / T


@checked
def law_rmse(window: Reals, acceleration: Reals, snr_db: Decibels) -> FloatArray:
    """Return the error of the Doppler filter's velocity, taken as that of the window's end.

    window, acceleration, snr_db: Length in samples, at least 2; m/s^2; dB.
    Returns (...): Root mean square in m/s: the Cramér-Rao bound and half a window of delay.
    Raises ValueError if an argument is not of the kind described, or a window is shorter than 2
        samples.

    Examples
    --------
    >>> law_rmse(64, 10.0, 15.0).round(2).item()
    0.95
    """
    delay = (_checks.positive("window", window) - 1) / 2 * reported().stated.T
    return np.sqrt(measurement_variance(window, snr_db) + (delay * acceleration) ** 2)


@checked
def linear_cost(accelerations: Rising, snrs_db: Rising, points: Count = 40) -> FloatArray:
    """Return the growth of the error by linear interpolation of the best window between nodes.

    accelerations, snrs_db (A,) and (B,): Nodes at which the best window is known, rising: two or
        more of each.
    points: Points along each axis, from the first node to the last.
    Returns (points, points): Error with the interpolated window over the error with the best one.
    Raises ValueError if an argument is not of the kind described, or an acceleration is not
        positive.

    Examples
    --------
    >>> linear_cost([10.0, 80.0], [10.0, 40.0], points=10).max().round(2).item()
    1.32
    """
    _checks.positive("accelerations", accelerations)
    points = _checks.count("points", points, 1000)
    a = np.linspace(accelerations[0], accelerations[-1], points)
    s = np.linspace(snrs_db[0], snrs_db[-1], points)
    nodes = best_window(accelerations[:, None], snrs_db)
    rows = np.stack([np.interp(a, accelerations, column) for column in nodes.T], axis=-1)
    linear = np.stack([np.interp(s, snrs_db, row) for row in rows])
    a = a[:, None]
    return law_rmse(linear, a, s) / law_rmse(best_window(a, s), a, s)


@checked
def linear_error(
    accelerations: Span,
    snrs_db: Span,
    points: Count = 40,
    along: Literal["acceleration", "snr", "both"] = "both",
) -> FloatArray:
    """Return the relative error of the least-squares line or plane through the best windows.

    accelerations, snrs_db: Smallest and largest.
    points: Points along each axis.
    along: Variable of the line, one for each value of the other variable; or the plane in both.
    Returns (points, points): The line, in acceleration or in dB, over the best window, less one.
    Raises ValueError if an argument is not of the kind described, a range does not rise, or an
        acceleration is not positive.

    Examples
    --------
    >>> for along in ("acceleration", "snr", "both"):
    ...     error = linear_error((10.0, 80.0), (10.0, 40.0), points=10, along=along)
    ...     print(np.abs(error).max().round(2))
    0.17
    0.26
    1.2
    """
    _checks.positive("accelerations", accelerations)
    points = _checks.count("points", points, 1000)
    a = np.linspace(*_checks.increasing_pair("accelerations", accelerations), points)
    s = np.linspace(*_checks.increasing_pair("snrs_db", snrs_db), points)
    best = best_window(a[:, None], s)
    if along == "both":
        a, s = np.broadcast_arrays(a[:, None], s)
        design = np.stack([a.ravel(), s.ravel(), np.ones(a.size)], axis=-1)
        weights, *_ = np.linalg.lstsq(design, best.ravel())
        return (design @ weights).reshape(best.shape) / best - 1
    lines = best if along == "acceleration" else best.T
    x = a if along == "acceleration" else s
    design = np.stack([x, np.ones_like(x)], axis=-1)
    weights, *_ = np.linalg.lstsq(design, lines)
    error = design @ weights / lines - 1
    return error if along == "acceleration" else error.T


@checked
def best_lengths(table: WindowTable) -> FloatArray:
    """Return the best windows of a simulation, interpolated by a parabola in logarithms.

    table: As `window_table` returns it.
    Returns (A, B): In samples, any number; NaN where the best of the windows tried is the first or
        last one.
    Raises ValueError if `table` is not of the kind described, or an error is not positive.

    Examples
    --------
    >>> windows = np.arange(4, 40)
    >>> a, snr_db = np.array([5.0, 20.0])[:, None, None], np.array([0.0, 20.0])[:, None]
    >>> table = WindowTable([5, 20], [0, 20], windows, law_rmse(windows, a, snr_db))
    >>> best_lengths(table).round(1).tolist()
    [[nan, 28.5], [nan, 16.5]]
    """
    _checks.positive("table.cee", table.cee)
    log_n, log_cee = np.log(table.windows), np.log(table.cee)
    lengths = np.full(table.inside.shape, np.nan)
    for i, j in np.argwhere(table.inside):
        lengths[i, j] = np.exp(_vertex(log_n, log_cee[i, j]))
    return lengths


@checked
def law_exponents(table: WindowTable) -> tuple[float, float]:
    """Fit powers of acceleration and signal-to-noise ratio to the best windows of a simulation.

    table: As `window_table` returns it. Cells whose best window is the first or last one, or that
        have no acceleration, do not count.
    Returns acceleration: Exponent of the acceleration; -2/5 in the law.
        snr: Exponent of the signal-to-noise ratio; -1/5 in the law.
    Raises ValueError if `table` is not of the kind described, or less than four cells count.

    Examples
    --------
    >>> windows = np.arange(4, 128)
    >>> a, snr_db = np.array([5.0, 10.0, 20.0])[:, None, None], np.array([10.0, 20.0])[:, None]
    >>> table = WindowTable([5, 10, 20], [10, 20], windows, law_rmse(windows, a, snr_db))
    >>> [round(one, 1) for one in law_exponents(table)]
    [-0.4, -0.2]
    """
    best = best_lengths(table)
    counts = ~np.isnan(best) & (table.accelerations != 0)[:, None]
    if counts.sum() < 4:
        raise ValueError(f"table must have four cells with a minimum inside, got {counts.sum()}")
    i, j = np.nonzero(counts)
    log_a, log_snr = np.log(table.accelerations[i]), table.snrs_db[j] / 10 * np.log(10)
    design = np.stack([log_a, log_snr, np.ones_like(log_a)], axis=-1)
    (first, second, _), *_ = np.linalg.lstsq(design, np.log(best[counts]))
    return float(first), float(second)


def _vertex(x, y):
    """Return where a parabola through the least value and its neighbors is least."""
    k = int(np.argmin(y))
    near = slice(k - 1, k + 2)
    bend, slope, _ = np.polyfit(x[near] - x[k], y[near], 2)
    return x[k] - slope / (2 * bend)
