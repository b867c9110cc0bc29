"""Blocks of samples, the prior, and where a search for a second valley starts."""

import numpy as np

from .targets import INTERVAL, PRIOR_COVARIANCE, SIGMA_F

_BLOCK = 10  # samples that are taken together: the bound grows by 0.2 % at most
LEAST = 0.03  # in m: a valley nearer to the plane x = 0 is none


def prior():
    """Return the information (6, 6) of the prior."""
    return np.linalg.inv(PRIOR_COVARIANCE)


def blocks(samples, sensors, block=_BLOCK):
    """Return times (B,) of blocks of samples, and weights (B, N) of their means."""
    edges = np.append(np.arange(0, samples, block), samples)
    weights = np.diff(edges)[:, None] / SIGMA_F**2 * np.ones(sensors)
    return (edges[:-1] + edges[1:] + 1) / 2 * INTERVAL, weights


def starts(x, array, middle, turns):
    """Return states (R, S, 6) whose p.v, |p| and first harmonic are those of x after `middle`.

    In ring coordinates eta turns about m / b, as far as the target stays in front; else x is -1.
    """
    around = array.positions - array.positions.mean(axis=0)
    square = np.mean(np.sum(around**2, axis=-1))
    p, v = x[:, :3] + middle * x[:, 3:], x[:, 3:]
    rho = np.sqrt(np.sum(p**2, axis=-1) + square)[:, None]
    b = np.sum(p * v, axis=-1)[:, None] / rho
    eta = p[:, 1:] / rho**2
    with np.errstate(all="ignore"):
        axis = v[:, 1:] / rho / b - eta
        delta = eta - axis
        turn = np.exp(1j * turns) * (delta[:, 0] + 1j * delta[:, 1])[:, None]
        eta = axis[:, None] + np.stack([turn.real, turn.imag], axis=-1)
        rho, b = rho[:, None], b[:, None]
        across, across_v = eta * rho**2, (axis[:, None] + eta) * b * rho
        ahead = np.sqrt(rho**2 - square - np.sum(across**2, axis=-1, keepdims=True))
        ahead_v = (rho * b - np.sum(across * across_v, axis=-1, keepdims=True)) / ahead
        starts = np.concatenate([ahead, across, ahead_v, across_v], axis=-1)
        starts[..., :3] -= middle * starts[..., 3:]
        return np.where(np.isfinite(starts).all(axis=-1, keepdims=True), starts, -1.0)
