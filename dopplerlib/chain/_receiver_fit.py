"""One linear step of a receiver's fix: clocks eliminated, wrong shifts found, offsets allowed for.

Arrays are residuals r (K, S) in Hz, derivatives H (K, S, 3), and standard deviations sigma (K, S),
NaN where there is no measurement.
"""

import numpy as np
from scipy.optimize import brentq

REFERENCE = 45.0  # dB-Hz, at which a deviation is one unit of the level
_ROUNDS = 30  # of reweighting towards least absolute residuals


def relative_deviation(cn0):
    """Return standard deviations relative to that at the reference, 1 where C/N0 is missing."""
    return np.where(np.isnan(cn0), 1.0, 10 ** ((REFERENCE - cn0) / 20))


def reduced(r, H, sigma, weight=1.0):
    """Return r and H less their weighted means over each epoch, and weights (K, S).

    This eliminates a clock for each epoch from the least squares problem.
    """
    there = ~np.isnan(sigma) & ~np.isnan(r)
    w = np.where(there, weight / np.where(there, sigma, 1.0) ** 2, 0.0)
    share = w / np.where(w.any(axis=1, keepdims=True), w.sum(axis=1, keepdims=True), 1.0)
    r = np.where(there, r, 0.0)
    r = r - np.sum(share * r, axis=1, keepdims=True)
    return r, H - np.einsum("ks,ksi->ki", share, H)[:, None], w


def least_absolute(r, H, sigma):
    """Return the residuals of the fit that makes the sum of |r| / sigma least, NaN if missing."""
    weight = np.ones(r.shape)
    there = ~np.isnan(sigma)
    for _ in range(_ROUNDS):
        left, G, w = reduced(r, H, sigma, weight)
        left = left - G @ np.linalg.lstsq(_rows(G, w), _rows(left, w), rcond=None)[0]
        size = np.abs(left[there]) / sigma[there]
        floor = 1e-3 * np.median(size) + 1e-300
        weight[there] = 1 / np.maximum(size, floor)
    return np.where(there, left, np.nan)


def _rows(array, w):
    return (array.T * np.sqrt(w).T).T.reshape(w.size, *array.shape[2:])


def typical(size, unknowns):
    """Return the standard deviation of normal errors by residuals of least absolute sum.

    As many of these are zero as there are unknowns: `unknowns`, and a clock for each epoch. Of the
    others the median is 0.6745 deviations.
    """
    there = ~np.isnan(size)
    unknowns += int(there.any(axis=1).sum())
    size = np.sort(np.abs(size[there]))[unknowns:]
    return np.median(size) / 0.6745 if len(size) else np.inf


def solve(r, H, sigma, level):
    """Return the step, and what `ReceiverFix` says of it, as a dict."""
    left, G, w = reduced(r, H, sigma)
    S = w.shape[1]
    unknowns = 3 + int(w.any(axis=1).sum())
    degrees = np.count_nonzero(w) - unknowns
    if degrees < 1:
        raise ValueError(
            f"recording must have more measurements than its {unknowns} unknowns, got "
            f"{np.count_nonzero(w)}"
        )
    # Columns of the offsets, one for each satellite, less their means as those of H.
    share = w / np.where(w.any(axis=1, keepdims=True), w.sum(axis=1, keepdims=True), 1.0)
    J = np.concatenate([G, np.eye(S) - share[:, None, :]], axis=-1)
    weighted = J * w[..., None]
    N = np.einsum("ksi,ksj->ij", weighted, J)
    b = np.einsum("ksi,ks->i", weighted, left)
    white = _solved(N[:3, :3], np.column_stack([b[:3], N[:3, 3:]]))
    x, through = white[:, 0], white[:, 1:]
    if level is None:
        level = float(np.sqrt(max(np.sum(w * left**2) - b[:3] @ x, 0.0) / degrees))
        level = max(level, 1e-12)  # shifts without any noise
    N, b = N / level**2, b / level**2
    score = b[3:] - N[3:, :3] @ x
    spread = N[3:, 3:] - N[3:, :3] @ through
    variance = offset_variance(score, spread)
    if variance > 0:
        N = N + np.diag(np.r_[np.zeros(3), np.full(S, 1 / variance)])
        P = np.linalg.inv(N)[:3, :3]
        x = np.linalg.solve(N, b)[:3]
    else:
        P = _solved(N[:3, :3], np.eye(3))
    total = np.where(w.any(axis=0), w.sum(axis=0) / level**2, np.nan)
    free = r - H @ x
    seen = w.any(axis=1)
    clock = np.where(seen, np.nansum(share * np.where(w > 0, free, 0.0), axis=1), np.nan)
    return {
        "step": x,
        "P": (P + P.T) / 2,
        "clock": clock,
        "residual": np.where(w > 0, free - clock[:, None], np.nan),
        "sigma_f": level * np.where(w > 0, sigma, np.nan),
        "level": level,
        "offset_std": float(np.sqrt(variance)),
        "offset": score / total,
        "offset_error": np.sqrt(np.maximum(np.diag(spread), 0.0)) / total,
    }


def _solved(N, b):
    try:
        return np.linalg.solve(N, b)
    except np.linalg.LinAlgError:
        raise ValueError("recording must have satellites that tell a place, got too few") from None


def offset_variance(score, spread):
    """Return the variance of offsets by restricted maximum likelihood.

    `score` is the derivative of the log likelihood by the offsets where they are zero, `spread` its
    covariance if they are. With eigenvalues g and components s along the eigenvectors, the
    derivative of the log likelihood by the variance v is half the sum of
    s^2 / (1 + v g)^2 - g / (1 + v g).
    """
    g, V = np.linalg.eigh((spread + spread.T) / 2)
    g, s = np.maximum(g, 0.0), V.T @ score

    def slope(v):
        return np.sum((s / (1 + v * g)) ** 2 - g / (1 + v * g))

    if not slope(0.0) > 0:
        return 0.0
    v = 1 / g.max()
    while slope(v) > 0:
        v *= 2
    return float(brentq(slope, 0.0, v, xtol=1e-12 * v))
