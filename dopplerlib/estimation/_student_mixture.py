"""A mixture of Student distributions: draws, densities, and a fit to weighted draws; unchecked."""

from typing import NamedTuple

import numpy as np
from scipy.special import gammaln, logsumexp

from .._typing import FloatArray

_DOF = 6.0  # tails heavier than those of a posterior, and still with a covariance
_ALIKE = 0.1  # of the draws come from all members alike
_SOFT = 1 / 6  # efficiency that weights are raised to, by a power below one, before a fit
_FEW = 20  # draws, in effect, that a member needs for a fit


class StudentMixture(NamedTuple):
    """M distributions: logarithm of weights (M,), centers (M, n), scale matrices (M, n, n)."""

    log_weight: FloatArray
    center: FloatArray
    scale: FloatArray

    @classmethod
    def around(cls, weight, center, scale):
        """Return a mixture of members that are drawn by weight, and now and then alike."""
        weight = (1 - _ALIKE) * weight / weight.sum() + _ALIKE / len(weight)
        return cls(np.log(weight), center, scale)

    def draw(self, draws, rng):
        """Return draws (S, n)."""
        member = rng.choice(len(self.center), draws, p=np.exp(self.log_weight))
        stretch = np.sqrt(_DOF / rng.chisquare(_DOF, draws))
        normal = rng.standard_normal((draws, self.center.shape[1])) * stretch[:, None]
        root = np.linalg.cholesky(self.scale)[member]
        return self.center[member] + np.einsum("sij,sj->si", root, normal)

    def log_densities(self, x):
        """Return the logarithm (M, S) of the density of each member, times its weight."""
        n = x.shape[1]
        root = np.linalg.cholesky(self.scale)
        apart = np.linalg.solve(root, (x - self.center[:, None]).mT)
        form = np.einsum("mis,mis->ms", apart, apart)
        volume = np.log(np.diagonal(root, axis1=1, axis2=2)).sum(axis=1)
        factor = gammaln((_DOF + n) / 2) - gammaln(_DOF / 2) - n / 2 * np.log(_DOF * np.pi)
        return (self.log_weight - volume)[:, None] + factor - (_DOF + n) / 2 * np.log1p(form / _DOF)

    def log_density(self, x):
        """Return the logarithm (S,) of the density of the mixture."""
        return logsumexp(self.log_densities(x), axis=0)

    def fitted(self, x, log_weight, inflation):
        """Return the mixture after one step of expectation and maximization.

        Weights of few draws are raised to a power first. A member with few draws stays as it is.
        """
        w = tempered(log_weight)
        each = self.log_densities(x)
        share = np.exp(each - logsumexp(each, axis=0)) * w
        total, many = share.sum(axis=1), efficiency(share) * len(w) > _FEW
        center, scale = self.center.copy(), self.scale.copy()
        for m in np.flatnonzero(many):
            p = share[m] / total[m]
            center[m] = p @ x
            apart = x - center[m]
            scale[m] = inflation * np.einsum("s,si,sj->ij", p, apart, apart)
        used = many | (total > 1e-4)
        return self.around(total[used], center[used], scale[used])


def normalized(log_weight):
    """Return weights of sum one, given their logarithms."""
    return np.exp(log_weight - logsumexp(log_weight))


def efficiency(weight):
    """Return the effective sample size of weights (..., S), as a fraction of S."""
    with np.errstate(invalid="ignore"):
        size = weight.sum(axis=-1) ** 2 / np.sum(weight**2, axis=-1)
    return np.nan_to_num(size) / weight.shape[-1]


def tempered(log_weight):
    """Return weights raised to the power, at most one, that makes them as efficient as asked."""
    below = log_weight - log_weight.max()
    low, high = 0.0, 1.0
    if efficiency(np.exp(below)) >= _SOFT:
        return normalized(log_weight)
    for _ in range(50):
        power = (low + high) / 2
        if efficiency(np.exp(power * below)) < _SOFT:
            high = power
        else:
            low = power
    return normalized(high * below)
