"""One cycle of the interacting multiple model estimator, on estimates of any meaning; unchecked.

A state is a tuple: the states of all models, their covariances, and the logarithms of the models'
probabilities but for a constant.
"""

import numpy as np

from .. import _checks
from . import covariances, densities, gaussian, sigma_points


def cycle(k, state, models, rules, log_transition):
    """Return the state after sample k: mix, predict, update.

    `rules` holds for each model its functions that predict and correct, see `recursion.cycle`.
    """
    xs, Ps, log_mode = state
    # Joint probability of the model before (axis -2) and the model now (axis -1).
    joint = log_mode[..., :, None] + log_transition
    now = np.logaddexp.reduce(joint, axis=-2)
    # A model that cannot be reached has probability zero, but its state has to stay finite.
    joint = np.where(now[..., None, :] > -np.inf, joint, log_mode[..., :, None])
    weight = probabilities(joint, axis=-2)

    common = [_common(model, x, P) for model, x, P in zip(models, xs, Ps, strict=True)]
    after = []
    for j, rule in enumerate(rules):
        parts = [_own(models, i, j, common, xs, Ps) for i in range(len(models))]
        after.append(_filtered(k, rule, *_mixture(parts, weight[..., j])))
    xs, Ps, likelihoods = zip(*after, strict=True)
    log_mode = now + np.stack(likelihoods, axis=-1)
    log_mode = log_mode - log_mode.max(axis=-1, keepdims=True)
    return xs, Ps, log_mode


def _filtered(k, rule, x, P):
    """Return the estimate of one model after sample k, and the log likelihood of that sample."""
    predict, correct = rule
    x, P = predict(k, x, P)
    innovation, K, P, S = correct(k, x, P)
    return gaussian.moved(x, K, innovation), P, densities.log_density(innovation, S)


def combined(models, state):
    """Return mean and covariance of the mixture in the common meaning, and the probabilities."""
    xs, Ps, log_mode = state
    mode = probabilities(log_mode, axis=-1)
    common = [_common(model, x, P) for model, x, P in zip(models, xs, Ps, strict=True)]
    return (*_mixture(common, mode), mode)


def probabilities(log_weight, axis):
    """Return weights that add to 1 along the axis; at least one of their logarithms is finite."""
    with np.errstate(under="ignore"):  # a weight of zero is what it should be
        weight = np.exp(log_weight - log_weight.max(axis=axis, keepdims=True))
        return weight / weight.sum(axis=axis, keepdims=True)


def _mixture(parts, weight):
    """Return mean and covariance of a mixture of estimates of one meaning."""
    x = np.stack([x for x, _ in parts], axis=-2)
    P = np.stack([P for _, P in parts], axis=-3)
    return densities.mixture(x, P, weight)


def _common(model, x, P):
    """Return the estimate of a model in the common meaning."""
    if model.to_common is None:
        return x, P
    return _through("to_common", model.to_common, None, x, covariances.square_root(P))


def _own(models, i, j, common, xs, Ps):
    """Return the estimate of model i in the meaning of model j."""
    convert = models[j].from_common
    if i == j:
        return xs[j], Ps[j]
    if convert is None:
        return common[i]
    # What the common state does not tell comes from the estimate of model j, as uncorrelated.
    (x, P), c = common[i], common[i][0].shape[-1]
    L, L_own = covariances.square_root(P), covariances.square_root(Ps[j])
    upper = np.concatenate([L, np.zeros((*L.shape[:-1], L_own.shape[-1]))], axis=-1)
    lower = np.concatenate([np.zeros((*L_own.shape[:-1], c)), L_own], axis=-1)
    return _through(
        "from_common", lambda both: convert(both[..., :c], both[..., c:]), xs[j].shape[-1],
        np.concatenate([x, xs[j]], axis=-1), np.concatenate([upper, lower], axis=-2),
    )  # fmt: skip


def _through(name, function, length, x, L):
    """Return mean and covariance of a function of a Gaussian, by cubature points."""

    def checked(points):
        value = _checks.called(name, function, points.copy())
        shape = (*points.shape[:-1], length or np.shape(value)[-1:][0])
        return _checks.each_run(f"{name}(x)", _checks.finite(f"{name}(x)", value), shape, ())

    mean, slope, rest = sigma_points.regression(checked, x, L, sigma_points.scaling(x.shape[-1]))
    return mean, covariances.squared(np.concatenate([slope, rest], axis=-1))
