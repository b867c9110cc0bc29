"""Hypotheses about the start of the whole chain, and the filters that begin with them.

Mirrored starts explain the first samples equally well: a plane array cannot tell its two sides
apart, nor a line of sensors the places around it. So every part of the box keeps its best state, a
filter begins with each, and what follows decides: the score of a hypothesis is minus twice its log
likelihood,

    chi^2 of the start + sum over samples (nu' S^-1 nu + log |S|),

up to a constant that all hypotheses share.
"""

from itertools import product

import numpy as np

from ..estimation.extended_kalman import ekf
from ..estimation.maximum_likelihood import ml_initialize
from ..estimation.whitening import whitening_matrices
from ..model.doppler import doppler_jacobian

# Hypotheses whose chi-square is higher than the least by this have a likelihood of 3e-7 of it.
CARRIED = 30.0


def parts(box, array):
    """Return the parts of a box between the planes through the middle of an array.

    There is a plane at right angles to each axis along which the sensors lie apart, unless it
    misses the box: a ring has two of them, and a box in front of it four parts.
    """
    lower, upper = box
    low, high = array.positions.min(axis=0), array.positions.max(axis=0)
    # The middle of a ring is at the origin but for rounding.
    middle = np.round((low + high) / 2, 12) + 0.0
    cut = (high > low) & (lower[:3] < middle) & (middle < upper[:3])
    boxes = []
    for above in product((False, True), repeat=int(cut.sum())):
        first, last = lower.copy(), upper.copy()
        for axis, positive in zip(np.flatnonzero(cut), above, strict=True):
            (first if positive else last)[axis] = middle[axis]
        boxes.append((first, last))
    return boxes


def without_wrong(z, std, array, T, box, rng):
    """Return shifts and standard deviations (runs, K, N) without those that fit no start.

    What fits is decided by a robust start in the whole box. It takes the deviations for right up to
    a factor of each run.
    """
    z, std = z.copy(), std.copy()
    for some, deviations, child in zip(z, std, rng.spawn(len(z)), strict=True):
        sigma_f = np.where(np.isinf(deviations), 1.0, deviations)
        found = ml_initialize(
            some, array, sigma_f, T, box, loss="bisquare", scale="estimated", rng=child, workers=1
        )
        wrong = found.weights == 0
        some[wrong], deviations[wrong] = np.nan, np.inf
    return z, std


def hypotheses(z, std, array, T, apart, boxes, correlation=None):
    """Return initial states (runs, H, 6), chi-squares (runs, H), and weights (runs, K, N).

    All shifts of a record get the same weight, so the search does not depend on how large it is.
    The weights are standard deviations, infinite where a shift is missing.
    """
    # Overlapping windows share samples, and their errors are correlated. Unless this is known, of
    # every `apart` windows one is taken, counted back from the last: the start is the state at its
    # time.
    early = slice((z.shape[1] - 1) % apart, None, apart)
    z, missing = z[:, early], np.isinf(std[:, early])
    total = np.sum(np.where(missing, 0.0, std[:, early]) ** 2, axis=(1, 2))
    variance = total / np.maximum(np.sum(~missing, axis=(1, 2)), 1)
    # The search gets a deviation of one; its chi-squares are divided by the variance afterwards.
    found = [
        ml_initialize(z, array, 1.0, apart * T, box, at="last", correlation=correlation)
        for box in boxes
    ]
    states, costs = [s.x for s in found], [s.cost for s in found]
    if len(boxes) == 1:  # no plane cuts the box: the second-best state is the other hypothesis
        states, costs = [*states, found[0].second_x], [*costs, found[0].second_cost]
    weights = np.where(missing, np.inf, np.sqrt(variance)[:, None, None])
    return np.stack(states, axis=1), np.stack(costs, axis=1) / variance[:, None], weights


def filters(z, std, weights, array, T, used, apart, sigma_a, free, states, costs, noise="shared",
            correlation=None):  # fmt: skip
    """Return x, P, innovation, S, nis, memory and score of the filters of one run.

    `free` (6,) says which components of the state are unknown at the start.
    `noise` is that of `constant_velocity`, `correlation` that of the windows of the start.
    """
    shape = (len(states), 1 + len(z) - used)
    x, P = np.full((*shape, 6), np.nan), np.full((*shape, 6, 6), np.nan)
    nis, score = np.full((shape[0], shape[1] - 1), np.nan), np.full(shape, np.inf)
    innovation = np.full((*nis.shape, len(array)), np.nan)
    S = np.full((*innovation.shape, len(array)), np.nan)
    costs = np.where(np.isnan(costs), np.inf, costs)
    states = np.asarray(states)
    likely = np.flatnonzero(costs < costs.min() + CARRIED)
    covariance, known = start_covariances(
        states[likely], array, weights, apart * T, free, correlation
    )
    carried = likely[known]
    x[carried, 0], P[carried, 0], score[carried, 0] = states[carried], covariance, costs[carried]
    memory = np.nan
    if len(carried) and shape[1] > 1:
        # The filter wants a number for what is missing, and does not use it.
        sigma = np.where(np.isinf(std[used:]), 1.0, std[used:])
        records = np.broadcast_to(z[used:], (len(carried), *z[used:].shape))
        t = ekf(
            records, array, states[carried], covariance, T, sigma_a, sigma, noise=noise, workers=1
        )
        x[carried, 1:], P[carried, 1:], nis[carried] = t.x, t.P, t.nis
        innovation[carried], S[carried] = t.innovation, t.S
        factor = _factor(t.S, np.isnan(t.innovation))
        score[carried, 1:] = costs[carried, None] + np.cumsum(_misfit(t.nis, factor), axis=-1)
        best = np.argmin(score[carried, -1])
        memory = _memory(t.innovation[best], factor[best])
    return x, P, innovation, S, nis, memory, score


def _factor(S, missing):
    """Return Cholesky factors of innovation covariances, of size 1 where a sensor is missing."""
    if missing.any():
        apart = missing[..., :, None] | missing[..., None, :]
        S = np.where(apart, np.eye(S.shape[-1]), S)
    return np.linalg.cholesky(S)


def _misfit(nis, factor):
    """Return minus twice the log likelihood of each innovation, up to a constant."""
    diagonal = np.diagonal(factor, axis1=-2, axis2=-1)
    return np.nan_to_num(nis) + 2 * np.log(diagonal).sum(axis=-1)


def _memory(innovation, factor):
    """Return the autocorrelation of normalized innovations at one sample, over all modules."""
    # S = L L', so u = L^-1 nu has the covariance I, and sum u_k'u_(k-1) / sum u_k'u_k is near zero
    # for a filter whose model holds.
    normal = np.empty_like(innovation)
    for i in range(innovation.shape[-1]):  # forward substitution, for all samples at once
        known = np.sum(factor[:, i, :i] * normal[:, :i], axis=-1)
        normal[:, i] = (innovation[:, i] - known) / factor[:, i, i]
    power = np.sum(normal**2)
    return np.sum(normal[1:] * normal[:-1]) / power if power > 0 else np.nan


def start_covariances(x, array, std, T, free, correlation=None):
    """Return covariances (.., 6, 6) of states (H, 6) at the last sample, and whose (H,) they are.

    They are those of the Fisher information; a state that it does not determine has none.
    """
    known = np.isfinite(x).all(axis=-1)
    back = -T * np.arange(len(std))[::-1]
    F = np.tile(np.eye(6), (len(std), 1, 1))
    F[:, :3, 3:] = back[:, None, None] * np.eye(3)
    # An infinite deviation leaves nothing of the slope.
    path = np.einsum("kij,hj->hki", F, x[known])
    slopes = doppler_jacobian(path, array) @ F / std[..., None]
    if correlation is not None:
        W = whitening_matrices(correlation, np.isfinite(std))
        slopes = np.array([np.einsum("nkl,lni->kni", W, one) for one in slopes])
    # The covariance is (J'J)^-1 with J = `slopes`. With columns scaled to length one,
    # J D^-1 = U W V', it is D^-1 V W^-2 V' D^-1: the product of a root with its transpose.
    slopes = np.compress(free, slopes.reshape(len(slopes), std.size, 6), axis=-1)
    scale = np.linalg.norm(slopes, axis=-2)
    lengths = scale.all(axis=-1)
    slopes, scale = slopes[lengths], scale[lengths]
    _, w, vt = np.linalg.svd(slopes / scale[:, None], full_matrices=False)
    sees = w[:, -1] >= 1e-6 * w[:, 0]  # or the start says nothing of a direction
    root = (vt.mT / w[:, None] / scale[..., None])[sees]
    P = np.zeros((len(root), 6, 6))
    P[(slice(None), *np.ix_(free, free))] = root @ root.mT
    for some in (lengths, sees):
        known[known] = some
    return P, known
