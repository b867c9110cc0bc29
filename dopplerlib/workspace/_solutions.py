"""States that give the same Doppler shifts at an array, counted without noise."""

import numpy as np

from ..model.doppler import doppler_jacobian, doppler_shift

_BOX = np.array([3.0, 3.0, 3.0, 4.0, 4.0, 4.0])  # m and m/s: where solutions are looked for
_EQUAL = 1e-6  # Hz: so far apart shifts are equal
_SAME = 1e-3  # m and m/s: nearer to each other two solutions are one


def same_shifts(x, array, time, *, rng, starts=100):
    """Return the states in front of an array whose shifts are those of one in uniform motion.

    Parameters
    ----------
    x : array_like, shape (6,)
        State at time zero in m and m/s, in front of the array: x > 0.
    array : RadarArray
        The sensors.
    time : array_like, shape (K,)
        Times of the samples in s; [0] for one snapshot.
    rng : numpy.random.Generator
        Source of the starts.
    starts : int
        Searches, by least squares from random states in a box of 3 m and 4 m/s to each side.

    Returns
    -------
    ndarray, shape (S, 6)
        Distinct states that were found, the nearest to x first. Where the shifts leave a curve of
        states, points of it.
    """
    from scipy.optimize import least_squares

    time = np.asarray(time, float)
    F = np.tile(np.eye(6), (len(time), 1, 1))
    F[:, :3, 3:] = time[:, None, None] * np.eye(3)

    def shifts(state):
        return doppler_shift(F @ state, array).ravel()

    def jacobian(state):
        return (doppler_jacobian(F @ state, array) @ F).reshape(-1, 6)

    high = _BOX
    low = np.where(np.arange(6) == 0, 0.01, -high)
    true, found = shifts(x), [x]
    for start in low + (high - low) * rng.random((starts, 6)):
        end = least_squares(
            lambda state: shifts(state) - true, start, jacobian, bounds=(low, high),
            x_scale="jac", xtol=1e-14, ftol=1e-14, gtol=1e-14, max_nfev=200,
        )  # fmt: skip
        near = np.abs(np.subtract(found, end.x)).max(axis=-1).min() < _SAME
        if np.abs(end.fun).max() < _EQUAL and not near:
            found.append(end.x)
    return np.array(sorted(found, key=lambda each: np.linalg.norm(each - x)))
