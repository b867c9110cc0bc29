"""Covariances of a start: by its information, by its residuals (sandwich), by a bootstrap."""

import numpy as np

from ._ml_polish import BISQUARE, EFFICIENCY, bisquare, least_squares, refine


def slopes(data, found, kept, group=0):
    """Return standardized residuals (M,) and their slopes (M, 6 + C) by target and clocks.

    Of clocks that are others at each sample, those of sample `group` are kept and all others are
    eliminated: what is left of their samples' slopes is orthogonal to them, where `kept` (M,).
    """
    r, J = (value[0] for value in data.residuals(found.x))
    D, c = data.columns, found.clocks[0]
    r = r + (D @ c[..., None]).ravel()
    groups, each, count = D.shape
    A = np.zeros((groups, each, J.shape[-1] + count))
    A[..., : J.shape[-1]] = J.reshape(groups, each, -1)
    if count and groups > 1:
        C = D * kept.reshape(groups, each, 1)
        rest = A - D @ (np.linalg.pinv(C, rcond=1e-12) @ A)
        rest[group] = A[group]
        A = rest
    A[group, :, J.shape[-1] :] = D[group]
    return r, A.reshape(-1, A.shape[-1])


def information(A, kept, robust):
    """Return the Fisher information of accepted measurements times the efficiency of the loss."""
    A = A[kept]
    return (EFFICIENCY if robust else 1.0) * A.T @ A


def _scores(r, A, kept, robust, samples):
    """Return scores of the samples (K, n) and the slope of their sum (n, n).

    A residual is smaller than its error by what it has pulled the fit; of sample k, with slopes
    A_k, it is (I - A_k B^-1 A_k') of it. The scores are those of the errors (HC3, MacKinnon and
    White 1985), since a few samples may decide a component alone.
    """
    if robust:
        u = np.minimum((r / BISQUARE) ** 2, 1.0)
        psi, slope = r * (1 - u) ** 2, (1 - u) * (1 - 5 * u)
    else:
        psi, slope = r, np.ones_like(r)
    B = A.T @ (A * (slope * kept)[:, None])
    A = (A * kept[:, None]).reshape(samples, -1, A.shape[1])
    pull = A @ np.linalg.solve(B, A.mT)
    error = np.linalg.solve(np.eye(A.shape[1]) - pull, (psi * kept).reshape(samples, -1, 1))
    return (A.mT @ error)[..., 0], B


def sandwich(r, A, kept, robust, samples, lags, free):
    """Return the covariance that follows from the products of the scores of samples over lags.

    Newey and West (1987): S = G_0 + sum over l of (1 - l / (lags + 1)) (G_l + G_l').
    """
    P = np.full((len(free), len(free)), np.nan)
    try:
        g, B = _scores(r, A[:, free], kept, robust, samples)
        half = np.linalg.solve(B, _long_run(g, lags))
        P[np.ix_(free, free)] = np.linalg.solve(B, half.T)
    except np.linalg.LinAlgError:  # no scatter is left: fewer samples than unknowns
        return P
    P[~free] = P[:, ~free] = 0.0
    return P


def _long_run(g, lags):
    if lags is not None:
        return _newey_west(g, min(lags, len(g) - 1))
    # Andrews and Monahan (1992): what is left after an autoregression has few lags.
    past = g[:-1]
    power = np.sum(past**2, axis=0)
    rho = np.sum(g[1:] * past, axis=0) / np.where(power > 0, power, 1.0)
    rho = np.clip(rho, -0.97, 0.97)
    left = np.vstack([g[:1] * np.sqrt(1 - rho**2), g[1:] - rho * past])
    S = _newey_west(left, automatic_lags(left))
    return S / np.outer(1 - rho, 1 - rho)


def _newey_west(g, lags):
    S = g.T @ g
    for lag in range(1, lags + 1):
        product = g[lag:].T @ g[:-lag]
        S += (1 - lag / (lags + 1)) * (product + product.T)
    return S


def automatic_lags(g):
    """Return a number of lags by Andrews (1991): for scores (K, n) that are autoregressive."""
    K = len(g)
    past, power = g[:-1], np.sum(g[:-1] ** 2, axis=0)
    there = power > 0
    rho = np.sum(g[1:] * past, axis=0)[there] / power[there]
    rho = np.clip(rho, -0.97, 0.97)
    variance = np.mean((g[1:, there] - rho * past[:, there]) ** 2, axis=0)
    # Each component counts once, whatever its unit: weights are the inverse squares of variances.
    top = np.mean(4 * rho**2 / ((1 - rho) ** 6 * (1 + rho) ** 2) * (variance > 0))
    bottom = np.mean(1 / (1 - rho) ** 4)
    lags = 1.1447 * (top / bottom * K) ** (1 / 3) if there.any() else 0.0
    return min(int(np.ceil(lags)), K - 1)


def bootstrap(data, found, box, robust, kept, lags, resamples, group, rng):
    """Return the covariance of fits to blocks of samples that are drawn with replacement."""
    samples = len(data.z)
    loss = bisquare if robust else least_squares
    if lags is None:
        r, A = slopes(data, found, kept, group)
        free = np.append(box[0] < box[1], np.ones(A.shape[1] - 6, bool))
        lags = automatic_lags(_scores(r, A[:, free], kept, robust, samples)[0])
    length = min(lags + 1, samples)
    first = rng.integers(samples, size=(resamples, -(-samples // length), 1))
    drawn = ((first + np.arange(length)) % samples).reshape(resamples, -1)[:, :samples]
    m = np.stack([np.bincount(draw, minlength=samples) for draw in drawn])
    m = np.repeat(m, data.z.shape[1], axis=1) * kept
    again = refine(
        data, np.repeat(found.x, resamples, axis=0), box, loss, m,
        np.repeat(found.clocks, resamples, axis=0),
    )  # fmt: skip
    both = np.concatenate([again.x, again.clocks[:, group]], axis=1)
    return np.cov(both.T)
