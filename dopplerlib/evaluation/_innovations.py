"""Innovations of which some are missing: checked, counted, and divided by their deviations."""

import numpy as np

from .. import _checks
from ..estimation.track import Track


def measured(innovation, S, record=False, of=""):
    """Check innovations and their covariances, and set apart what is missing.

    Where a component of an innovation is NaN it was not measured, as a `Track` has it: there the
    innovation becomes 0, and the row and column of S those of a unit matrix. Then the quadratic
    form is that of the components that are there, and so is each of their Cholesky factors.

    Parameters
    ----------
    innovation : array_like, shape (..., m)
        In a record (..., K, m).
    S : array_like, shape (..., m, m)
        Covariances; what belongs to a missing component does not matter. In a record
        (..., K, m, m).
    record : bool
        Whether there is an axis of time, which S must have too.
    of : str
        What stands before the names of both in an error.

    Returns
    -------
    innovation, S : ndarray
    there : ndarray of bool, shape (..., m)
        Where a component was measured.

    Raises
    ------
    ValueError
        If the shapes do not fit, an innovation is infinite, or S is no covariance of what is there.
    """
    names = f"{of}innovation", f"{of}S"
    innovation = _checks.measured(names[0], innovation, (None, None) if record else (None,))
    own = innovation.shape[-2:] if record else innovation.shape[-1:]
    S = _checks.real(names[1], S)
    _checks.check_shape(names[1], S, (own[-1], own[-1]))
    _checks.check_shape(names[1], S, (*own, own[-1]))
    leading = innovation.shape[: -len(own)]
    _checks.check_broadcast(names[0], leading, names[1], S.shape[: -len(own) - 1])
    there = ~np.isnan(innovation)
    if not there.all():
        innovation = np.where(there, innovation, 0.0)
        pairs = there[..., :, None] & there[..., None, :]
        S = np.where(pairs, S, np.eye(own[-1]))
    return innovation, _checks.covariance(names[1], S, own[-1]), there


def of_track(track):
    """Return innovations (..., K, m), S and where there is a value, of a track that has them.

    Raises
    ------
    ValueError
        If it has none, they are refused by `measured`, or a record holds no measurement at all: a
        test of which would be passed by a filter that has failed.
    """
    _checks.instance("track", track, Track)
    for name in ("innovation", "S"):
        if getattr(track, name) is None:
            raise ValueError(f'track must hold {name}, got None: keep "{name}" when filtering')
    innovation, S, there = measured(track.innovation, track.S, record=True, of="track.")
    if not there.any(axis=(-2, -1)).all():
        raise ValueError("track.innovation must hold a value in each record, got only NaN")
    return innovation, S, there


def whiten(innovation, S):
    """Return L^-1 innovation with S = L L': independent values of variance 1 if all is right.

    Factors L that all runs share are used once for all of them.
    """
    L = np.linalg.cholesky(S)
    if innovation.ndim > 2 and L.size == np.prod(L.shape[-3:]):
        runs = innovation.reshape(-1, *innovation.shape[-2:])
        columns = np.linalg.solve(L.reshape(L.shape[-3:]), np.moveaxis(runs, 0, -1))
        return np.moveaxis(columns, -1, 0).reshape(innovation.shape)
    return np.linalg.solve(L, innovation[..., None])[..., 0]


def chi2_tail(statistic, dof):
    """Return the probability of a larger chi-square; NaN without any degree of freedom."""
    from scipy.stats import chi2  # here: it takes longer to load than all the rest

    return np.where(dof > 0, chi2.sf(statistic, np.maximum(dof, 1)), np.nan)[()]
