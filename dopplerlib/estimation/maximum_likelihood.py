"""Maximum-likelihood initialization from the first measurements."""

import os
from dataclasses import replace
from typing import Annotated, Literal

import numpy as np

from .. import _checks
from .._hints import Count, Index, checked, up_to
from .._typing import ArrayLike
from ..model.information import inverse_information
from ..model.links import DopplerLinks, sample_times, state_size
from ..model.radar_array import RadarArray
from ._ekf_setting import measurements
from ._ml_fit import Options, fit_run
from ._ml_links import links_problem
from ._ml_problem import Found, array_problem
from .initial_estimate import InitialEstimate
from .whitening import whitening_matrices


@checked
@_checks.quiet
def ml_initialize(
    z: ArrayLike,
    array: RadarArray | DopplerLinks,
    sigma_f: ArrayLike,
    T: ArrayLike,
    box: tuple[ArrayLike, ArrayLike],
    likelihood: Literal["constant_velocity", "stationary"] = "constant_velocity",
    *,
    at: Literal["first", "last"] = "first",
    loss: Literal["least_squares", "bisquare"] = "least_squares",
    scale: Literal["given", "estimated"] = "given",
    correlation: ArrayLike | None = None,
    covariance: Literal["information", "sandwich", "bootstrap"] = "information",
    lags: Index | None = None,
    resamples: Annotated[int, up_to(10**6, 2)] = 200,
    rng: np.random.Generator | None = None,
    workers: Count | None = None,
) -> InitialEstimate:
    """Return initial estimates: the global maximum of the likelihood in a box.

    Parameters
    ----------
    z : array_like, shape (..., K, N)
        Doppler measurements in Hz; NaN says that this sensor is missing at this sample.
    array : RadarArray or DopplerLinks
        The N sensors, or links with C clocks.
    sigma_f : array_like, broadcast to (K, N)
        Standard deviation of the measurements in Hz.
    T : array_like, scalar or shape (K,)
        Sampling interval in s, or the interval before each sample, of which the first is without
        effect. Links that have times keep them.
    box : pair of array_like, shape (6,)
        Lower and upper bounds of the target's state at the first sample. Equal bounds fix a
        component: z = v_z = 0 makes the problem one in a plane. Clocks have no bounds.
    likelihood : {"constant_velocity", "stationary"}
        "constant_velocity": the target moves at constant velocity. "stationary": its state is the
        same at all samples, Eq 10 as published. Sensors that move and clocks go on in both.
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
    correlation : array_like, shape (L,), optional
        Correlation of the errors of a sensor, as a function of the lag in samples: 1 at lag zero,
        0 from lag L on; as `overlap_correlation_discrete` gives it for windows that overlap. If
        None errors are independent. With it measurements that the loss takes for wrong are left
        out, and all others count in full. That law is of a tone in white noise, whose errors cancel
        in sums. Those of an extended body have other reasons and do not: with the law `P` would be
        ten times too small. Then leave it None, take windows side by side, and `P` by a bootstrap.
    covariance : {"information", "sandwich", "bootstrap"}
        Source of `P`. "information": the deviations and correlations that are assumed. "sandwich":
        the scatter of the residuals about the fit, whatever their deviations and for errors that
        are correlated over up to `lags` samples and between the sensors of a sample. "bootstrap":
        the scatter of fits to blocks of ``lags + 1`` samples, drawn with replacement. The last two
        need many more samples than unknowns. Where residuals are correlated over a good part of the
        record, as of a driver who brakes, the sandwich claims too little and the bootstrap does
        not.
    lags : int, optional
        See `covariance`. If None, the choice of Andrews (1991) for autoregressive errors.
    resamples : int
        Number of fits of the bootstrap.
    rng : numpy.random.Generator, optional
        Source of the subsets with which the loss "bisquare" begins, and of the bootstrap; needed
        for both.
    workers : int, optional
        Threads among which the runs are shared; one for each processor if None. The result does
        not depend on it.

    Returns
    -------
    InitialEstimate
        Leading axes are those of `z`. With links, states have n = 6 + C or 6 + 2 C components, see
        `DopplerLinks`; `x` holds the "epoch" clocks of its sample. A run that is too incomplete to
        be solved is NaN, with `converged` and `identifiable` False.

    Raises
    ------
    ValueError
        If an argument has the wrong shape, is not finite and positive where it has to be, the box
        is empty, even complete measurements would be fewer than the unknowns, or `correlation` is
        not positive definite.

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

    Correlated errors are made white in time, sensor by sensor (generalized least squares). The
    sandwich is that of Newey and West (1987). Clocks are eliminated from each step; links are
    searched on a grid of positions without the rules above for states that are equally good, which
    takes some 0.3 s a run.

    `P` is of first order. Where a long valley of likely states is curved, as that of a car's radars
    for a target far ahead, errors are larger than it says and a filter that starts with it is too
    sure; then begin with several states, see `gaussian_sum`.

    Examples
    --------
    >>> from dopplerlib import doppler_shift
    >>> array = RadarArray.linear(5, 0.4)
    >>> z = doppler_shift([0.5, 0.2, 0, -1, 0.5, 0], array)[None]
    >>> box = [0.1, -1, 0, -2, -2, 0], [2, 1, 0, 2, 2, 0]
    >>> (ml_initialize(z, array, 0.1, 0.001, box).x.round(6) + 0.0).tolist()
    [0.5, 0.2, 0.0, -1.0, 0.5, 0.0]
    """
    z = measurements(z, array)
    samples, sensors = z.shape[-2:]
    times = sample_times(array, samples, T)
    times = times - times[0]
    sigma_f = _checks.deviation("sigma_f", sigma_f)
    deviations = _checks.each_run("sigma_f", sigma_f, (samples, sensors), ())
    lower, upper = _box(box)
    robust, estimated = loss == "bisquare", scale == "estimated"
    if robust or covariance == "bootstrap":
        _checks.generator("rng", rng)
    workers = (os.cpu_count() or 1) if workers is None else workers

    batch = z.shape[:-2]
    runs = int(np.prod(batch))
    moving = likelihood == "constant_velocity" and samples > 1
    if isinstance(array, RadarArray):
        problem = array_problem(array, lower, upper, times, moving, workers)
        values = samples * sensors if moving else sensors
    else:
        problem = links_problem(array.sampled(samples, T), lower, upper, times, moving)
        values = samples * sensors
    if correlation is not None:
        if problem.epoch:
            raise ValueError("correlation must be None for clocks that are others at each sample")
        correlation = _checks.one_row("correlation", correlation)
        whitening_matrices(correlation, np.ones((samples, 1), bool))  # or raise
    needed = problem.unknowns(np.ones(samples * sensors, bool))
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
    n = state_size(array)
    weights, scales, own = np.where(np.isnan(z), np.nan, 1.0), np.ones(runs), None
    plain = not robust and correlation is None and covariance == "information"
    if plain and isinstance(array, RadarArray):
        found = problem.search(z, deviations)
    else:
        last = samples - 1 if at == "last" else 0
        options = Options(robust, estimated, correlation, covariance, lags, resamples, last)
        found, own, weights, scales = _each_run(problem, z, deviations, options, n, rng)
    x, information, cost, arrived, second_x, second_cost = found

    solved = ~np.isnan(cost)
    at_bound = (lower < upper) & ((x[:, :6] <= lower) | (x[:, :6] >= upper))
    there = weights > 0
    degrees = np.sum(there, axis=(1, 2)) - problem.unknowns(there.reshape(runs, -1))
    if estimated and not (robust and correlation is None):
        factor = np.sqrt(np.where(degrees > 0, cost / degrees, np.nan))
        scales, cost, second_cost = scales * factor, cost / factor**2, second_cost / factor**2
        information = information / factor[:, None, None] ** 2
    F = np.eye(n)
    if at == "last":
        F[:3, 3:6] = moving * times[-1] * np.eye(3)
        if n > 6 and array.clock_model == "drift":
            half = (n - 6) // 2
            F[6 : 6 + half, 6 + half :] = times[-1] * np.eye(half)
    if at == "last" and (moving or n > 6):
        back = np.linalg.inv(F)
        x, second_x = x @ F.T, second_x @ F.T
        information = back.T @ information @ back
    P = np.full((runs, n, n), np.nan)
    identifiable = np.zeros(runs, bool)
    _checks.estimates("z, array, sigma_f, T, box", information[solved])
    free = np.append(lower < upper, np.ones(n - 6, bool))
    P[solved], identifiable[solved] = inverse_information(information[solved], free)
    if own is not None:
        P[identifiable] = (F @ own @ F.T)[identifiable]
    fields = x, P, cost, at_bound, identifiable, arrived, second_x, second_cost, degrees
    each = (field.reshape((*batch, *field.shape[1:])) for field in (*fields, weights, scales))
    estimate = InitialEstimate(*each)
    return replace(estimate, converged=estimate.converged & estimate.plausible)


def _each_run(problem, z, deviations, options, n, rng):
    """Return the fits of all runs, their covariances, weights and scales."""
    runs = len(z)
    found = Found(
        np.full((runs, n), np.nan), np.full((runs, n, n), np.nan), np.full(runs, np.nan),
        np.zeros(runs, bool), np.full((runs, n), np.nan), np.full(runs, np.nan),
    )  # fmt: skip
    weights = np.full(z.shape, np.nan)
    own = None if options.covariance == "information" else np.full((runs, n, n), np.nan)
    scales = np.full(runs, np.nan)
    # A run has its own draws.
    children = [None] * runs if rng is None else rng.spawn(runs)
    for i, child in enumerate(children):
        fit = fit_run(problem, z[i], deviations, options, child)
        if fit is None:
            continue
        found.x[i], found.information[i], found.cost[i] = fit.x, fit.information, fit.cost
        found.converged[i], found.second_x[i] = fit.arrived, fit.second_x
        found.second_cost[i], weights[i], scales[i] = fit.second_cost, fit.weights, fit.scale
        if own is not None:
            own[i] = fit.P
    return found, own, weights, scales


def _box(box):
    bounds = [
        _checks.finite(f"the {name} bound of box", bound, (6,))
        for name, bound in zip(("lower", "upper"), box, strict=True)
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
