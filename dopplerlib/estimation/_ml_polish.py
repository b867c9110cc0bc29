"""Refine states by damped Gauss-Newton steps in a box, for any loss and any model.

A loss turns standardized residuals r into a cost and weights w, with which a step solves

    (J'WJ + factor diag(J'WJ)) d = -J'W r:

least squares with w = 1, iteratively reweighted least squares for a bounded loss, and the
concentration steps of least trimmed squares, which give the smaller half of the residuals w = 1.
Rows are states that are refined at the same time.
"""

import numpy as np

# With c = 4.685 the bisquare has an efficiency of 95 % for normal errors: with psi(r) = r w(r),
# (E psi')^2 / E psi^2 = 0.95.
BISQUARE, EFFICIENCY = 4.685, 0.95

ITERATIONS = 200  # of one refinement; ten are usual

TOLERANCE = 1e-12  # stop when a step gains less, relative to the cost


def least_squares(r):
    """Return cost and weights (rows, M) of residuals (rows, M)."""
    return np.sum(r * r, axis=1), np.ones_like(r)


def bisquare(r):
    """Return cost and weights of Tukey's bisquare; near zero the cost is that of least squares."""
    u = np.maximum(1 - (r / BISQUARE) ** 2, 0.0)
    return BISQUARE**2 / 3 * np.sum(1 - u**3, axis=1), u * u


def trimmed(count):
    """Return a loss: the sum of the `count` smallest squares."""

    def loss(r):
        square = r * r
        order = np.argpartition(square, count - 1, axis=1)[:, :count]
        w = np.zeros_like(r)
        np.put_along_axis(w, order, 1.0, axis=1)
        return np.sum(np.take_along_axis(square, order, axis=1), axis=1), w

    return loss


def refine(residuals, x, lower, upper, loss=least_squares, iterations=ITERATIONS):
    """Return refined states (rows, n), their costs (rows,), and whether they are optima.

    `residuals` (x) returns residuals (rows, M) and their Jacobian (rows, M, n).
    """
    x = x.copy()
    rows, n = x.shape
    factor, growth = np.full(rows, 1e-6), np.full(rows, 4.0)
    arrived = np.zeros(rows, bool)
    r, J = residuals(x)
    cost, w = loss(r)
    fixed = lower == upper
    eye = np.eye(n, dtype=bool)
    for _ in range(iterations):
        weighted = J * w[..., None]
        H, g = weighted.mT @ J, np.einsum("rmi,rm->ri", weighted, r)
        held = fixed | ((x <= lower) & (g > 0)) | ((x >= upper) & (g < 0))
        size = np.sqrt(np.diagonal(H, axis1=1, axis2=2))
        size = np.where((size > 0) & ~held, size, 1.0)
        C = H / (size[:, :, None] * size[:, None])
        C[held[:, :, None] | held[:, None]] = 0.0
        C[:, eye] = np.where(held, 1.0, np.maximum(C[:, eye], 1e-15) + factor[:, None])
        # A state on a sensor has no slopes: it stays where it is.
        lost = ~np.isfinite(C).all(axis=(1, 2)) | ~np.isfinite(g).all(axis=1)
        C[lost] = np.eye(n)
        rhs = np.where(held | lost[:, None], 0.0, -g / size)
        d = np.linalg.solve(C, rhs[..., None])[..., 0] / size
        new = np.clip(x + d, lower, upper)
        d = new - x
        promise = -2 * np.sum(g * d, axis=1) - np.einsum("ri,rij,rj->r", d, H, d)
        r_new, J_new = residuals(new)
        cost_new, w_new = loss(r_new)
        gain = cost - cost_new
        # Rounding of the predictions by some 1e-15 of the measurements is no gain.
        enough = TOLERANCE * (cost + 1e-6)
        better = (gain > 0) & ~arrived
        arrived |= (np.abs(promise) <= enough) & (gain <= enough) & (factor < 1) & ~lost
        with np.errstate(all="ignore"):
            easier = np.maximum(1 / 9, 1 - (2 * gain / promise - 1) ** 3)
        factor = np.where(better, np.maximum(factor * easier, 1e-14), factor * growth)
        growth = np.where(better, 4.0, growth * 2)
        for old, fresh in ((x, new), (r, r_new), (J, J_new), (w, w_new), (cost, cost_new)):
            old[better] = fresh[better]
        if np.all(arrived | lost | (factor > 1e12)):
            break
    return x, cost, arrived
