"""Filters from the formulas of a textbook, by another route than the library's.

Shifts from the range's rate of change, Jacobians from complex steps, whole matrices, plain Joseph
form: slow, and nothing of it shared with what is tested.
"""

import numpy as np

WAVELENGTH, T, SIGMA = 0.0125, 1e-3, 0.4  # Section 2 and Section 4
F = np.eye(6) + T * np.eye(6, k=3)
G = np.array([T * T / 2] * 3 + [T] * 3)
TRUTH = np.array([0.833, 0.111, 0.092, -0.750, -0.125, -0.018])
TABLE2 = np.array([0.767, 0.086, 0.124, -0.757, -0.113, -0.076])
# Quantiles of chi-square with six degrees of freedom at 2.5, 95 and 97.5 %, from a printed table.
LOW, UPPER, HIGH = 1.2373, 12.5916, 14.4494


def ring(degrees=0.0):
    """Return six places on a circle of 20 cm in the plane x = 0."""
    angle = np.deg2rad(degrees + 60.0 * np.arange(6))
    return np.stack([np.zeros(6), 0.2 * np.cos(angle), 0.2 * np.sin(angle)], axis=-1)


def shift(x, sensors):
    """Return shifts in Hz: twice the speed of approach over the wavelength."""
    away = x[..., None, :3] - sensors
    rate = np.sum(away * x[..., None, 3:], axis=-1) / np.sqrt(np.sum(away * away, axis=-1))
    return -2 / WAVELENGTH * rate


def slope(x, sensors):
    """Return the Jacobian by complex steps, exact to rounding."""
    steps = x[..., None, :] + 1e-30j * np.eye(6)
    return np.swapaxes(shift(steps, sensors).imag / 1e-30, -1, -2)


def path(samples=1001):
    """Return the true states of Table 2, straight on."""
    states = np.repeat(TRUTH[None], samples, axis=0)
    states[:, :3] += T * np.arange(samples)[:, None] * TRUTH[3:]
    return states


def extended(z, start, P0, sensors, *, sigma=SIGMA, Q=None, gate=None):
    """Filter whole records; `start` is the prediction for the first sample but for its noise.

    Returns states, covariances, innovations, NIS and which samples were used.
    """
    runs, samples = z.shape[:2]
    Q = 0.16 * np.outer(G, G) if Q is None else Q
    x = np.broadcast_to(start, (runs, 6)).copy()
    x[:, :3] -= T * x[:, 3:]
    P = np.broadcast_to(P0, (runs, 6, 6))
    sigma = np.broadcast_to(sigma, (samples,))
    low, high = {None: (0, np.inf), "upper": (0, UPPER), "two-sided": (LOW, HIGH)}[gate]
    kept = [[], [], [], [], []]
    for k in range(samples):
        x, P = x @ F.T, F @ P @ F.T + Q
        H = slope(x, sensors)
        S = H @ P @ np.swapaxes(H, -1, -2) + sigma[k] ** 2 * np.eye(6)
        nu = z[:, k] - shift(x, sensors)
        weighted = np.linalg.solve(S, nu[..., None])[..., 0]
        nis = np.sum(nu * weighted, axis=-1)
        used = (low <= nis) & (nis <= high)
        K = np.where(used[:, None, None], P @ np.swapaxes(H, -1, -2) @ np.linalg.inv(S), 0)
        x = x + (K @ nu[..., None])[..., 0]
        A = np.eye(6) - K @ H
        P = A @ P @ np.swapaxes(A, -1, -2) + sigma[k] ** 2 * K @ np.swapaxes(K, -1, -2)
        for where, value in zip(kept, (x, P, nu, nis, used), strict=True):
            where.append(value)
    return [np.stack(one, axis=1) for one in kept]


def cubature(z, start, P0, sensors, Q):
    """Return the states of a cubature filter, all runs at once (Arasaratnam and Haykin, 2009)."""
    x = start.copy()
    x[:, :3] -= T * x[:, 3:]
    P = np.broadcast_to(P0, (len(z), 6, 6))
    corners = np.sqrt(6) * np.concatenate([np.eye(6), -np.eye(6)])
    found = []
    for k in range(z.shape[1]):
        x, P = x @ F.T, F @ P @ F.T + Q
        points = x[:, None] + corners @ np.swapaxes(np.linalg.cholesky(P), -1, -2)
        seen = shift(points, sensors)
        mean = seen.mean(axis=1)
        off, there = points - x[:, None], seen - mean[:, None]
        S = np.swapaxes(there, -1, -2) @ there / 12 + SIGMA**2 * np.eye(6)
        K = np.swapaxes(off, -1, -2) @ there / 12 @ np.linalg.inv(S)
        x = x + (K @ (z[:, k] - mean)[..., None])[..., 0]
        P = P - K @ S @ np.swapaxes(K, -1, -2)
        P = (P + np.swapaxes(P, -1, -2)) / 2
        found.append(x)
    return np.stack(found, axis=1)
