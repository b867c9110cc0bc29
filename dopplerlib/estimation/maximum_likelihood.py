"""Maximum-likelihood initialization from the first measurements."""

import os
from dataclasses import replace
from typing import Literal

import numpy as np

from .. import _checks
from .._typing import ArrayLike
from ..model.information import inverse_information
from ..model.radar_array import RadarArray
from ._ml_polish import EFFICIENCY
from ._ml_problem import Found, array_problem
from ._ml_robust import robust_fit
from .extended_kalman import _measurements
from .initial_estimate import InitialEstimate


@_checks.quiet
def ml_initialize(
    z: ArrayLike,
    array: RadarArray,
    sigma_f: ArrayLike,
    T: float,
    box: tuple[ArrayLike, ArrayLike],
    likelihood: Literal["constant_velocity", "stationary"] = "constant_velocity",
    *,
    at: Literal["first", "last"] = "first",
    loss: Literal["least_squares", "bisquare"] = "least_squares",
    scale: Literal["given", "estimated"] = "given",
    rng: np.random.Generator | None = None,
    workers: int | None = None,
) -> InitialEstimate:
    """Return initial estimates: the global maximum of the likelihood in a box.

    Parameters
    ----------
    z : array_like, shape (..., K, N)
        Doppler measurements in Hz; NaN says that this sensor is missing at this sample.
    array : RadarArray
        The N sensors.
    sigma_f : array_like, broadcast to (K, N)
        Standard deviation of the measurements in Hz.
    T : float
        Sampling interval in s.
    box : pair of array_like, shape (6,)
        Lower and upper bounds of the state at the first sample. Equal bounds fix a component:
        z = v_z = 0 makes the problem one in a plane.
    likelihood : {"constant_velocity", "stationary"}
        "constant_velocity": the target moves at constant velocity. "stationary": its state is the
        same at all samples, Eq 10 as printed.
    at : {"first", "last"}
        Sample to which `x`, `P` and `second_x` belong. With "stationary" they are the
        same.
    loss : {"least_squares", "bisquare"}
        "least_squares": all measurements count as `sigma_f` says. "bisquare": up to half of them
        may be wrong, wherever they lie; those more than 4.7 deviations off get the weight zero.
        With normal errors and none of them wrong its efficiency is 95 %. It needs more than twice
        as many measurements as unknowns, and takes a hundred times as long.
    scale : {"given", "estimated"}
        "given": the standard deviations are those of `sigma_f`. "estimated": they are proportional
        to it, and the factor comes from the residuals.
    rng : numpy.random.Generator, optional
        Source of the subsets with which the loss "bisquare" begins; needed for it.
    workers : int, optional
        Threads among which the runs are shared; one for each processor if None. The result does
        not depend on it.

    Returns
    -------
    InitialEstimate
        Leading axes are those of `z`. A run that is too incomplete to be solved is NaN, with
        `converged` and `identifiable` False.

    Raises
    ------
    ValueError
        If an argument has the wrong shape, is not finite and positive where it has to be, the box
        is empty, or even complete measurements would be fewer than the unknowns.

    Notes
    -----
    Mittermaier et al. (2016), Eq 10. The Doppler shift is linear in the velocity once the
    position is given, so only positions need to be searched (variable projection, Golub and
    Pereyra 1973): on a grid that is finer near the array, then by Levenberg-Marquardt in the box.
    Where a direction is hardly determined, it is searched on its own.
    The search is not exhaustive; its success rates are in ``benchmarks/README.md``.

    The loss "bisquare" begins with fits to random subsets and least trimmed squares, which half of
    wrong measurements would break; it ends with the M-estimate of Tukey's bisquare, c = 4.685
    (Yohai 1987, Rousseeuw and Van Driessen 2006). Wrong measurements that agree with the right
    state within a few deviations, as where two vehicles' lines cross, are not told from right
    ones. `P` is that of the accepted measurements over 0.95.

    Examples
    --------
    >>> from dopplerlib import doppler_shift
    >>> array = RadarArray.linear(5, 0.4)
    >>> z = doppler_shift([0.5, 0.2, 0, -1, 0.5, 0], array)[None]
    >>> box = [0.1, -1, 0, -2, -2, 0], [2, 1, 0, 2, 2, 0]
    >>> (ml_initialize(z, array, 0.1, 0.001, box).x.round(6) + 0.0).tolist()
    [0.5, 0.2, 0.0, -1.0, 0.5, 0.0]
    """
    _checks.instance("array", array, RadarArray)
    z = _measurements(z, array)
    T = _checks.positive_number("T", T)
    sigma_f = _checks.deviation("sigma_f", sigma_f)
    deviations = _checks.each_run("sigma_f", sigma_f, z.shape[-2:], ())
    lower, upper = _box(box)
    _checks.one_of("likelihood", likelihood, ("constant_velocity", "stationary"))
    _checks.one_of("at", at, ("first", "last"))
    _checks.one_of("loss", loss, ("least_squares", "bisquare"))
    _checks.one_of("scale", scale, ("given", "estimated"))
    robust = loss == "bisquare"
    if robust:
        _checks.generator("rng", rng)
    workers = (os.cpu_count() or 1) if workers is None else _checks.whole_number("workers", workers)

    batch, (samples, sensors) = z.shape[:-2], z.shape[-2:]
    runs = int(np.prod(batch))
    moving = likelihood == "constant_velocity" and samples > 1
    problem = array_problem(array, lower, upper, T, samples, moving, workers)
    needed = problem.unknowns
    values = samples * sensors if moving else sensors
    if values < needed:
        raise ValueError(
            f"z must hold at least as many values as there are unknowns, got {values} "
            f"({likelihood} likelihood) for {needed}; equal bounds in box fix a component"
        )
    if robust and samples * sensors <= 2 * needed:
        raise ValueError(
            f"z must hold more than twice as many values as there are unknowns for the loss "
            f"bisquare, got {samples * sensors} for {needed}"
        )
    z = np.ascontiguousarray(z).reshape(runs, samples, sensors)
    there = ~np.isnan(z)
    weights, scales = np.where(there, 1.0, np.nan), np.ones(runs)
    if robust:
        found, weights, scales = _each_robust(problem, z, deviations, scale == "estimated", rng)
    else:
        found = problem.search(z, deviations)
    x, information, cost, arrived, second_x, second_cost = found

    at_bound = (lower < upper) & ((x <= lower) | (x >= upper))
    solved = ~np.isnan(cost)
    degrees = np.sum(weights > 0, axis=(1, 2)) - needed
    if scale == "estimated" and not robust:
        scales = np.sqrt(np.where(degrees > 0, cost / degrees, np.nan))
        cost, second_cost, information = (
            value / (scales**2).reshape(-1, *[1] * (value.ndim - 1))
            for value in (cost, second_cost, information)
        )
    if at == "last" and moving:
        F = np.eye(6)
        F[:3, 3:] = (samples - 1) * T * np.eye(3)
        back = np.linalg.inv(F)
        x, second_x = x @ F.T, second_x @ F.T
        information = back.T @ information @ back
    P = np.full((runs, 6, 6), np.nan)
    identifiable = np.zeros(runs, bool)
    _checks.estimates("z, array, sigma_f, T, box", information[solved])
    P[solved], identifiable[solved] = inverse_information(information[solved], lower < upper)
    fields = x, P, cost, at_bound, identifiable, arrived, second_x, second_cost, degrees
    each = (field.reshape((*batch, *field.shape[1:])) for field in (*fields, weights, scales))
    estimate = InitialEstimate(*each)
    return replace(estimate, converged=estimate.converged & estimate.plausible)


def _each_robust(problem, z, deviations, estimate_scale, rng):
    """Return the robust fits of all runs, their weights and scales; a run has its own draws."""
    runs, n = len(z), len(problem.lower)
    found = Found(
        np.full((runs, n), np.nan), np.full((runs, n, n), np.nan), np.full(runs, np.nan),
        np.zeros(runs, bool), np.full((runs, n), np.nan), np.full(runs, np.nan),
    )  # fmt: skip
    weights, scales = np.full(z.shape, np.nan), np.full(runs, np.nan)
    for i, child in enumerate(rng.spawn(runs)):
        if np.sum(~np.isnan(z[i])) <= 2 * problem.unknowns:
            continue
        fit = robust_fit(problem, z[i], deviations, estimate_scale, child)
        if fit is None:
            continue
        found.x[i], found.converged[i], w, scale, found.second_x[i], more = fit
        weights[i], scales[i] = w, scale
        h, J = (value[0] for value in problem.predict(found.x[[i]]))
        kept = w > 0
        r, J = (
            (h - z[i])[kept] / (scale * deviations[kept]),
            J[kept] / (scale * deviations[kept])[:, None],
        )
        found.cost[i], found.information[i] = r @ r, EFFICIENCY * J.T @ J
        found.second_cost[i] = found.cost[i] + more
    return found, weights, scales


def _box(box):
    try:
        lower, upper = box
    except (TypeError, ValueError):
        raise ValueError(f"box must be a pair (lower, upper), got {box!r}") from None
    bounds = [
        _checks.finite(f"the {name} bound of box", bound, (6,))
        for name, bound in (("lower", lower), ("upper", upper))
    ]
    for bound in bounds:
        if bound.ndim != 1:
            raise ValueError(f"box must be a pair of arrays of shape (6,), got {bound.shape}")
    lower, upper = bounds
    if (lower > upper).any():
        i = int(np.argmax(lower > upper))
        raise ValueError(
            f"box must not be empty, got lower {lower[i]} above upper {upper[i]} at index {i}"
        )
    return lower.copy(), upper.copy()
