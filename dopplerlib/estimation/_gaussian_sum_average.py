"""Estimates of the same records under several assumptions, averaged by their evidence."""

import numpy as np
from scipy.special import logsumexp

from ._gaussian_sum_setting import Estimates


def average(found):
    """Return the average of a list of S `Estimates`, and their probabilities (..., O, S).

    Bayes's rule, for assumptions of which one holds for all of a record (Magill 1965). Where no
    members are, the probabilities are equal.
    """
    if len(found) == 1:
        return found[0], np.ones((*found[0].members.shape, 1))
    every = {name: np.stack([getattr(f, name) for f in found], -1) for name in Estimates._fields}
    # A filter with a wrong assumption may have no estimate at a time, although it has members.
    evidence = np.where(np.isnan(every["x"][..., 0, :]), -np.inf, every["evidence"])
    total = logsumexp(evidence, axis=-1)
    there = np.isfinite(total)
    apart = evidence - np.where(there, total, 0.0)[..., None]
    p = np.where(there[..., None], np.exp(apart), 1 / len(found))
    # An assumption without members has no weight, wherever another one has some.
    used = (p > 0) | ~there[..., None]
    x = np.sum(p[..., None, :] * np.where(used[..., None, :], every["x"], 0.0), axis=-1)
    d = every["x"] - x[..., None]
    P = every["P"] + d[..., :, None, :] * d[..., None, :, :]
    P = np.sum(p[..., None, None, :] * np.where(used[..., None, None, :], P, 0.0), axis=-1)
    M, shape = every["weights"].shape[-2], every["members"].shape[:-1]
    weights = (every["weights"] * p[..., None, :]).reshape(*shape, -1)
    order = np.argsort(-weights, axis=-1, kind="stable")[..., :M]

    def heaviest(value, rest):
        value = np.moveaxis(value, -1, len(shape) + 1).reshape(*weights.shape, *rest)
        return np.take_along_axis(
            value, order.reshape(*order.shape, *(1 for _ in rest)), len(shape)
        )

    return Estimates(
        x, P, every["members"].sum(axis=-1), np.take_along_axis(weights, order, axis=-1),
        heaviest(every["means"], (6,)), heaviest(every["covariances"], (6, 6)),
        total - np.log(len(found)),
    ), p  # fmt: skip
