"""The interacting multiple model (IMM) estimator."""

from collections.abc import Iterable
from typing import Any

import numpy as np

from .. import _checks
from .._typing import ArrayLike
from . import recursion
from ._imm_cycle import combined, cycle
from .imm_records import ImmModel, ImmState, ImmTrack, _prepared


@_checks.quiet
def imm(
    z: ArrayLike,
    models: Iterable[ImmModel],
    transition: ArrayLike,
    x0: Any,
    P0: Any,
    mode0: ArrayLike | None = None,
) -> ImmTrack:
    """Filter whole records with an interacting multiple model estimator, many runs at once.

    Every cycle mixes, predicts, then updates.

    Parameters
    ----------
    z : array_like, shape (..., K, m)
        Measurements; NaN says that a component is missing at this sample, see `kf`.
    models : iterable of ImmModel
        Linear or not; all have the same measurements.
    transition : array_like, shape (M, M) or (K, M, M)
        Probability to go from the model of the row to the model of the column in one step; at
        uneven times for each sample, that of the step which leads to it.
    x0 : array_like, shape (..., n), or sequence of them
        State one step before the first measurement; leading axes broadcast against those of `z`.
        If the state of a model has a meaning of its own, one for each model, each in its own.
    P0 : array_like, shape (..., n, n), or sequence of them
        Its covariance; it may be singular: a component can be known exactly.
    mode0 : array_like, shape (M,), optional
        Probabilities of the models one step before the first measurement; equal if None.

    Returns
    -------
    ImmTrack

    Raises
    ------
    ValueError
        If shapes do not fit, there is no model or no sample, a value is not finite (but for a NaN
        in `z`), also of what functions return and of what comes out, a matrix is not a covariance,
        an `R` is so small that the covariance of an innovation is singular to rounding, or
        probabilities are negative or do not add to 1.

    Notes
    -----
    Blom and Bar-Shalom (1988); Bar-Shalom, Li, Kirubarajan (2001), Sec 11.6.6. With one model it is
    `kf`, `ekf_records` or `ukf`. Inside, probabilities are logarithms: a model too improbable for a
    float may come back.

    Where meanings differ, the estimate of one model is brought into the common meaning and from
    there into that of another one by cubature points, which are exact for linear functions. What
    the common state does not tell, the other model takes from its own estimate (Yuan, Bar-Shalom,
    Willett, Mozeson, Pollak, Hardiman 2012), as uncorrelated with the rest.

    Examples
    --------
    A constant that may begin to wander:

    >>> calm, wandering = (ImmModel([[1.0]], [[q]], [[1.0]], [[1.0]]) for q in (0.0, 25.0))
    >>> switch = [[0.95, 0.05], [0.05, 0.95]]
    >>> track = imm([[0.0], [0.1], [9.0]], [calm, wandering], switch, [0.0], [[1.0]])
    >>> (track.mode[:, 1] > 0.5).tolist()
    [False, False, True]
    """
    models = _models(models)
    z = _checks.measured("z", z, (None, models[0].R.shape[-1]))
    if not z.size:
        raise ValueError(f"z must hold at least one run and one sample, got shape {z.shape}")
    batch, K = z.shape[:-2], z.shape[-2]
    last = _start(models, x0, P0, mode0, batch)
    log_transition = _logarithms(transition, K, len(models))
    rules = _rules(models, z)

    def step(k, state):
        nonlocal last
        last = cycle(k, state, models, rules, log_transition[k])
        return last, combined(models, last)

    x, P, mode = recursion.scan(step, last, range(K), len(batch))
    track = ImmTrack(x, P, mode, _state(models, last))
    _checks.estimates("models, x0, P0, z", track.x, track.P, track.mode)
    return track


@_checks.quiet
def imm_start(
    models: Iterable[ImmModel], x0: Any, P0: Any, mode0: ArrayLike | None = None
) -> ImmState:
    """Return the initial state of an IMM estimator, for `imm_step`.

    Parameters
    ----------
    models : iterable of ImmModel
        As for `imm`.
    x0 : array_like, shape (..., n), or sequence of them
        States, see `imm`. Leading axes are those of the runs.
    P0 : array_like, shape (..., n, n), or sequence of them
        Their covariances.
    mode0 : array_like, shape (M,), optional
        Probabilities of the models; equal if None.

    Returns
    -------
    ImmState

    Raises
    ------
    ValueError
        See `imm`.

    Notes
    -----
    Bar-Shalom, Li, Kirubarajan (2001), Sec 11.6.6; see `imm`.

    Examples
    --------
    >>> models = [ImmModel([[1.0]], [[q]], [[1.0]], [[1.0]]) for q in (0.0, 25.0)]
    >>> imm_start(models, [0.0], [[1.0]], mode0=[0.9, 0.1]).mode.round(3).tolist()
    [0.9, 0.1]
    """
    models = _models(models)
    if all(model.to_common is None for model in models):
        first = x0 = _checks.finite("x0", x0, (models[0].n,))
    else:
        x0 = _each_model("x0", x0, models)
        first = _checks.finite("x0", x0[0], (models[0].n,))
    batch = first.shape[:-1]
    state = _state(models, _start(models, x0, P0, mode0, batch))
    _checks.estimates("models, x0, P0", state.x, state.P, state.mode)
    return state


@_checks.quiet
def imm_step(
    z: ArrayLike, state: ImmState, models: Iterable[ImmModel], transition: ArrayLike
) -> ImmState:
    """Return the state of an IMM estimator after one more measurement.

    Parameters
    ----------
    z : array_like, shape (..., m)
        Measurements; NaN says that a component is missing. Leading axes are those of the runs.
    state : ImmState
        Of the sample before: from `imm_start`, from here, or ``last`` of an `ImmTrack`.
    models : iterable of ImmModel
        As for `imm`, with the matrices and functions of this one step.
    transition : array_like, shape (M, M)
        Probability to go from the model of the row to the model of the column in this step.

    Returns
    -------
    ImmState

    Raises
    ------
    ValueError
        See `imm`; if the state is not one of these models.

    Notes
    -----
    Bar-Shalom, Li, Kirubarajan (2001), Sec 11.6.6; see `imm`.

    Examples
    --------
    The last step of the example of `imm`:

    >>> models = [ImmModel([[1.0]], [[q]], [[1.0]], [[1.0]]) for q in (0.0, 25.0)]
    >>> switch = [[0.95, 0.05], [0.05, 0.95]]
    >>> state = imm([[0.0], [0.1]], models, switch, [0.0], [[1.0]]).last
    >>> state = imm_step([9.0], state, models, switch)
    >>> bool(state.mode[1] > 0.5)
    True
    """
    models = _models(models)
    before, batch = _estimates(_checks.instance("state", state, ImmState), models)
    m = models[0].R.shape[-1]
    z = _checks.each_run("z", _checks.measured("z", z, (m,)), batch, (m,))[..., None, :]
    log_transition = _logarithms(transition, 1, len(models))
    after = _state(models, cycle(0, before, models, _rules(models, z), log_transition[0]))
    _checks.estimates("models, state, z", after.x, after.P, after.mode)
    return after


def _models(models):
    """Return the models as a tuple, or raise unless they have the same measurements."""
    models = _checks.records("models", models, ImmModel)
    if not models:
        raise ValueError("models must hold at least one model, got none")
    lengths = {model.R.shape[-1] for model in models}
    if len(lengths) > 1:
        raise ValueError(f"models must have measurements of one length, got {sorted(lengths)}")
    lengths = {model.n for model in models if model.to_common is None}
    if len(lengths) > 1:
        raise ValueError(
            "models must have states of one length, or to_common and from_common, got lengths "
            f"{sorted(lengths)}"
        )
    return models


def _estimates(state, models):
    """Return the state of the cycle in a record, and the shape of the runs, or raise."""
    mode = _checks.real("state.log_mode", state.log_mode)
    batch, M = mode.shape[:-1], len(models)
    if mode.shape[-1:] != (M,) or not (mode.max(axis=-1) > -np.inf).all() or (mode > 0).any():
        raise ValueError(
            f"state must hold a logarithm of a probability for each of {M} models, got {mode}"
        )
    estimates = []
    for name in ("model_x", "model_P"):
        values = _each_model(f"state.{name}", getattr(state, name), models)
        for model, value in zip(models, values, strict=True):
            shape = (model.n,) if name == "model_x" else (model.n, model.n)
            value = _checks.finite(f"state.{name}", value, shape)
            if name == "model_P":
                _checks.covariance(f"state.{name}", value, model.n, definite=False)
            estimates.append(_checks.each_run(f"state.{name}", value, batch, shape))
    return (tuple(estimates[:M]), tuple(estimates[M:]), mode), batch


def _rules(models, z):
    return [_prepared(f"models[{j}]", model, z) for j, model in enumerate(models)]


def _state(models, state):
    """Return the record of a state of the cycle."""
    return ImmState(*combined(models, state), *state)


def _start(models, x0, P0, mode0, batch):
    """Return the state of the cycle before the first measurement, checked."""
    M = len(models)
    if all(model.to_common is None for model in models):
        n = models[0].n
        x0 = [_checks.finite("x0", x0, (n,))] * M
        P0 = [_checks.covariance("P0", P0, n, definite=False)] * M
    else:
        x0, P0 = _each_model("x0", x0, models), _each_model("P0", P0, models)
    xs, Ps = [], []
    for model, x, spread in zip(models, x0, P0, strict=True):
        n = model.n
        xs.append(_checks.each_run("x0", _checks.finite("x0", x, (n,)), batch, (n,)))
        spread = _checks.covariance("P0", spread, n, definite=False)
        Ps.append(_checks.each_run("P0", spread, batch, (n, n)))
    mode0 = _rows("mode0", np.full(M, 1 / M) if mode0 is None else mode0, (M,), 1)
    with np.errstate(divide="ignore"):  # the logarithm of 0 is what it should be
        return tuple(xs), tuple(Ps), np.log(np.broadcast_to(mode0, (*batch, M)))


def _each_model(name, values, models):
    """Return the values given for each model, or raise."""
    values = tuple(_checks.iterable(name, values, "a sequence with one entry for each model"))
    if len(values) != len(models):
        raise ValueError(f"{name} must have one entry for each model, got {len(values)}")
    return values


def _logarithms(transition, samples, M):
    """Return the logarithms of the transition probabilities of each sample, checked."""
    transition = _rows("transition", transition, (M, M), 3)
    transition = _checks.each_sample("transition", transition, samples, (M, M))
    with np.errstate(divide="ignore"):
        return np.log(transition)


def _rows(name, value, shape, most):
    """Return rows of probabilities in an array of at most so many axes, or raise."""
    value = _checks.finite(name, value, shape)
    if (
        value.ndim > most
        or (value < 0).any()
        or not value.size
        or np.abs(value.sum(axis=-1) - 1).max() > 1e-9
    ):
        raise ValueError(f"{name} must have rows of probabilities that add to 1, got {value}")
    return value
