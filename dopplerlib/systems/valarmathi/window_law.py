"""The best window in closed form, and what interpolating it linearly costs."""

import numpy as np

from ... import _checks
from ...signal.laws import optimal_window_end
from .doppler_filter import measurement_variance
from .published import chosen, stated
from .windows import rising


def best_window(acceleration, snr_db):
    """Return the window whose velocity, used as that of its end, has the least error.

    Parameters
    ----------
    acceleration : array_like, shape (...)
        In m/s^2, not zero.
    snr_db : array_like, broadcast to (...)
        Signal-to-noise ratio of a sample in dB.

    Returns
    -------
    ndarray, shape (...)
        Length in samples, any number: a constant times the acceleration to the power -2/5 and the
        signal-to-noise ratio to the power -1/5.

    Raises
    ------
    ValueError
        If a value is not finite or an acceleration is zero.
    """
    T = stated().T
    chirp = 2 * np.asarray(acceleration, float) / chosen().wavelength
    return optimal_window_end(10 ** (np.asarray(snr_db) / 10) / T, chirp) / T


def law_rmse(window, acceleration, snr_db):
    """Return the error of the Doppler filter's velocity, taken as that of the window's end.

    Parameters
    ----------
    window, acceleration, snr_db : array_like, broadcast to (...)
        Length in samples, at least 2; m/s^2; dB.

    Returns
    -------
    ndarray, shape (...)
        Root mean square in m/s: the Cramér-Rao bound and half a window of delay.

    Raises
    ------
    ValueError
        If a window is shorter than 2 samples.
    """
    delay = (_checks.positive("window", window) - 1) / 2 * stated().T
    return np.sqrt(measurement_variance(window, snr_db) + (delay * acceleration) ** 2)


def linear_cost(accelerations, snrs_db, points=40):
    """Return what linear interpolation of the best window costs between some nodes.

    Parameters
    ----------
    accelerations, snrs_db : sequence of float
        Nodes at which the best window is known, rising: two or more of each.
    points : int
        Points along each axis, from the first node to the last.

    Returns
    -------
    ndarray, shape (points, points)
        Error with the interpolated window over the error with the best one.

    Raises
    ------
    ValueError
        If nodes do not rise, are less than two, or the accelerations begin at zero.
    """
    accelerations = rising("accelerations", accelerations)
    snrs_db = rising("snrs_db", snrs_db)
    a = np.linspace(accelerations[0], accelerations[-1], points)
    s = np.linspace(snrs_db[0], snrs_db[-1], points)
    nodes = best_window(accelerations[:, None], snrs_db)
    rows = np.stack([np.interp(a, accelerations, column) for column in nodes.T], axis=-1)
    linear = np.stack([np.interp(s, snrs_db, row) for row in rows])
    a = a[:, None]
    return law_rmse(linear, a, s) / law_rmse(best_window(a, s), a, s)


def plane_error(accelerations, snrs_db, points=40):
    """Return how far the plane that fits the best windows best is off, relative to them.

    Parameters
    ----------
    accelerations, snrs_db : tuple of float
        Smallest and largest.
    points : int
        Points along each axis.

    Returns
    -------
    ndarray, shape (points, points)
        The plane, in acceleration and dB, over the best window, less one.

    Raises
    ------
    ValueError
        If a range does not rise, or the accelerations begin at zero.
    """
    a, s = np.meshgrid(
        np.linspace(*_checks.increasing_pair("accelerations", accelerations), points),
        np.linspace(*_checks.increasing_pair("snrs_db", snrs_db), points),
        indexing="ij",
    )
    best = best_window(a, s)
    design = np.stack([a, s, np.ones_like(a)], axis=-1)
    weights, *_ = np.linalg.lstsq(design.reshape(-1, 3), best.ravel())
    return design @ weights / best - 1


def law_exponents(table):
    """Fit powers of acceleration and signal-to-noise ratio to the best windows of a simulation.

    Parameters
    ----------
    table : WindowTable
        As `window_table` returns it. Cells whose best window is the first or last one, or that
        have no acceleration, do not count.

    Returns
    -------
    acceleration : float
        Exponent of the acceleration; -2/5 in the law.
    snr : float
        Exponent of the signal-to-noise ratio; -1/5 in the law.

    Raises
    ------
    ValueError
        If less than four cells count.
    """
    log_n, log_cee = np.log(table.windows), np.log(table.cee)
    rows = []
    for i, a in enumerate(table.accelerations):
        for j, snr_db in enumerate(table.snrs_db):
            k = int(np.argmin(log_cee[i, j]))
            if a == 0 or k in (0, len(log_n) - 1):
                continue
            near = slice(k - 1, k + 2)
            bend, slope, _ = np.polyfit(log_n[near] - log_n[k], log_cee[i, j, near], 2)
            rows.append((np.log(a), snr_db / 10 * np.log(10), log_n[k] - slope / (2 * bend)))
    if len(rows) < 4:
        raise ValueError(f"table must have four cells with a minimum inside, got {len(rows)}")
    log_a, log_snr, best = np.array(rows).T
    design = np.stack([log_a, log_snr, np.ones_like(log_a)], axis=-1)
    (first, second, _), *_ = np.linalg.lstsq(design, best)
    return float(first), float(second)
