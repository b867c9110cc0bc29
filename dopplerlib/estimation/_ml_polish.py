"""Refine states by damped Gauss-Newton steps in a box, for any model, loss, clocks, correlation.

A loss turns standardized residuals r into costs and weights w, with which a step d solves

    (J'WJ + factor diag(J'WJ)) d = -J'W r:

least squares with w = 1, iteratively reweighted least squares for a bounded loss, and the
concentration steps of least trimmed squares, which give the smaller half of the residuals w = 1.

Clocks c are linear, r = r(x) + D c, so they are eliminated from each step (Schur complement), which
then is one of the target's components alone: in one group for the whole record, or in one for each
sample if clocks are others at each. Rows are states that are refined at the same time.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

# With c = 4.685 the bisquare has an efficiency of 95 % for normal errors: with psi(r) = r w(r),
# (E psi')^2 / E psi^2 = 0.95.
BISQUARE, EFFICIENCY = 4.685, 0.95

ITERATIONS = 200  # of one refinement; ten are usual

TOLERANCE = 1e-12  # stop when a step gains less, relative to the cost


class Data(NamedTuple):
    """One run: measurements, a model that predicts them, and their standard deviations.

    `z`, `weight` (K, N) are measurements and one over their deviations, both zero where one is
    missing. `design` (K, N, C) holds the derivatives by the clocks, `epoch` says whether these are
    others at each sample. `roots` (N, K, K) make errors white in time, for each sensor.
    """

    predict: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
    z: np.ndarray
    weight: np.ndarray
    design: np.ndarray
    epoch: bool
    roots: np.ndarray | None = None

    @property
    def there(self):
        """Whether a measurement is there, shape (K N,)."""
        return self.weight.ravel() > 0

    @property
    def columns(self):
        """Standardized derivatives by the clocks, shape (groups, K N / groups, C)."""
        C = self._white((self.design * self.weight[..., None])[None])[0]
        groups = len(self.z) if self.epoch else 1
        return C.reshape(groups, self.z.size // groups, C.shape[-1])

    def residuals(self, x):
        """Return standardized residuals (rows, K N) without clocks and slopes (rows, K N, 6)."""
        h, J = self.predict(x)
        r = self._white(((h - self.z) * self.weight)[..., None])
        J = self._white(J * self.weight[..., None])
        return r.reshape(len(x), self.z.size), J.reshape(len(x), self.z.size, x.shape[1])

    def _white(self, values):
        if self.roots is None:
            return values
        return np.moveaxis(self.roots @ np.moveaxis(values, 2, 1), 1, 2)


def least_squares(r, m):
    """Return costs and weights (rows, M) of residuals (rows, M), each of which counts m times."""
    return m * r * r, m + np.zeros_like(r)


def bisquare(r, m):
    """Return costs and weights of Tukey's bisquare; near zero they are those of least squares."""
    u = np.maximum(1 - (r / BISQUARE) ** 2, 0.0)
    return m * (BISQUARE**2 / 3 * (1 - u**3)), m * u * u


def trimmed(count):
    """Return a loss: the `count` smallest squares."""

    def loss(r, m):
        square = np.where(m > 0, r * r, np.inf)
        kept = np.argpartition(square, count - 1, axis=1)[:, :count]
        w = np.zeros_like(r)
        np.put_along_axis(w, kept, 1.0, axis=1)
        return np.where(w > 0, square, 0.0), w

    return loss


class Refined(NamedTuple):
    """States (rows, 6), clocks (rows, groups, C), costs (rows,), and whether they are optima."""

    x: np.ndarray
    clocks: np.ndarray
    cost: np.ndarray
    arrived: np.ndarray

    def of(self, rows):
        """Return some of the rows."""
        return Refined(*(field[rows] for field in self))


def refine(
    data: Data,
    x: np.ndarray,
    box: tuple[np.ndarray, np.ndarray],
    loss: Callable[..., Any] = least_squares,
    m: np.ndarray | None = None,
    clocks: np.ndarray | None = None,
    iterations: int = ITERATIONS,
) -> Refined:
    """Return states and clocks that are refined from `x` (rows, 6) and `clocks`, zero if None.

    `m` (rows, K N) says how often each measurement counts; once if None.
    """
    lower, upper = box
    m = data.there + 0.0 if m is None else m * data.there
    D = data.columns
    groups, each, count = D.shape
    x, rows, n = x.copy(), len(x), x.shape[1]
    c = np.zeros((rows, groups, count)) if clocks is None else clocks.copy()
    factor, growth = np.full(rows, 1e-6), np.full(rows, 4.0)
    arrived, diagonal, fixed = np.zeros(rows, bool), np.eye(n, dtype=bool), lower == upper

    def at(x, c):
        r, J = data.residuals(x)
        if count:
            r = r + (D @ c[..., None]).reshape(r.shape)
        costs, w = loss(r, m)
        return r, J, w, costs.sum(axis=1)

    r, J, w, cost = at(x, c)
    for _ in range(iterations):
        weighted = J * w[..., None]
        H, g = weighted.mT @ J, (weighted.mT @ r[..., None])[..., 0]
        promise = np.zeros(rows)
        if count:
            DW = D.mT * w.reshape(rows, groups, 1, each)
            inverse = _inverse(DW @ D)
            g_c = (DW @ r.reshape(rows, groups, each, 1))[..., 0]
            mixed = DW @ J.reshape(rows, groups, each, n)
            alone = (inverse @ g_c[..., None])[..., 0]  # step of the clocks if x stays
            H = H - np.einsum("rgci,rgcj->rij", mixed, inverse @ mixed)
            g = g - np.einsum("rgci,rgc->ri", mixed, alone)
            promise = np.sum(g_c * alone, axis=(1, 2))
        held = fixed | ((x <= lower) & (g > 0)) | ((x >= upper) & (g < 0))
        size = np.sqrt(np.maximum(np.diagonal(H, axis1=1, axis2=2), 0.0))
        size = np.where((size > 0) & ~held, size, 1.0)
        C = H / (size[:, :, None] * size[:, None])
        C[held[:, :, None] | held[:, None]] = 0.0
        C[:, diagonal] = np.where(held, 1.0, np.maximum(C[:, diagonal], 1e-15) + factor[:, None])
        # A state on a sensor has no slopes: it stays where it is.
        lost = ~np.isfinite(C).all(axis=(1, 2)) | ~np.isfinite(g).all(axis=1) | ~np.isfinite(cost)
        C[lost] = np.eye(n)
        rhs = np.where(held | lost[:, None], 0.0, -g / size)
        new = np.clip(x + np.linalg.solve(C, rhs[..., None])[..., 0] / size, lower, upper)
        d = new - x
        promise = promise - 2 * np.sum(g * d, axis=1) - np.einsum("ri,rij,rj->r", d, H, d)
        new_c = c
        if count:
            new_c = c - alone - (inverse @ (mixed @ d[:, None, :, None]))[..., 0]
        fresh = new, new_c, *at(new, new_c)
        gain = cost - fresh[-1]
        # Rounding of the predictions by some 1e-15 of the measurements is no gain.
        enough = TOLERANCE * (cost + 1e-6)
        better = (gain > 0) & ~arrived
        arrived |= (np.abs(promise) <= enough) & (gain <= enough) & (factor < 1) & ~lost
        with np.errstate(all="ignore"):
            # Nielsen (1999): damping follows how well the quadratic model foretold the gain.
            easier = np.fmax(1 / 9, 1 - (2 * gain / promise - 1) ** 3)
        factor = np.where(better, np.maximum(factor * easier, 1e-14), factor * growth)
        growth = np.where(better, 4.0, growth * 2)
        for old, value in zip((x, c, r, J, w, cost), fresh, strict=True):
            old[better] = value[better]
        if np.all(arrived | lost | (factor > 1e12)):
            break
    return Refined(x, c, cost, arrived)


def _inverse(H):
    """Return inverses of small symmetric matrices (..., C, C); of zeros where nothing counts."""
    if H.shape[-1] == 1:
        return np.where(H > 0, 1 / np.where(H > 0, H, 1.0), 0.0)
    bad = ~np.isfinite(H).all(axis=(-2, -1), keepdims=True)
    return np.linalg.pinv(np.where(bad, 0.0, H), rcond=1e-12, hermitian=True)
