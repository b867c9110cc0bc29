"""Errors that are correlated in time, made white: matrices for least squares."""

from typing import Annotated

import numpy as np

from .. import _checks
from .._hints import checked, exactly
from .._typing import ArrayLike, BoolArray, FloatArray


@checked
def whitening_matrices(
    correlation: ArrayLike,
    there: Annotated[BoolArray, exactly(None, None, check=_checks.booleans)],
) -> FloatArray:
    """Return matrices that make errors white which are correlated in time, sensor by sensor.

    Parameters
    ----------
    correlation : array_like, shape (L,)
        Correlation of the errors of a sensor, as a function of the lag in samples: 1 at lag zero,
        0 from lag L on; as `overlap_correlation_discrete` gives it for windows that overlap.
    there : array_like of bool, shape (K, N)
        Which of the measurements of N sensors are there.

    Returns
    -------
    ndarray, shape (N, K, K)
        W with W C W' = I for the correlations C of what is there, zero elsewhere.

    Raises
    ------
    ValueError
        If `correlation` does not begin with 1, or is not that of any errors.

    Notes
    -----
    Generalized least squares: with C = L L', W is the inverse of L. Kay (1993), Section 4.5.

    Examples
    --------
    >>> W = whitening_matrices([1, 0.6], [[True], [True], [False]])
    >>> W[0].round(2).tolist()
    [[1.0, 0.0, 0.0], [-0.75, 1.25, 0.0], [0.0, 0.0, 0.0]]
    """
    correlation = _checks.one_row("correlation", correlation)
    samples, sensors = there.shape
    if correlation[0] != 1:
        raise ValueError(f"correlation must begin with 1, at lag zero, got {correlation[0]}")
    lag = np.abs(np.subtract.outer(np.arange(samples), np.arange(samples)))
    known = np.minimum(lag, len(correlation) - 1)
    C = np.where(lag < len(correlation), correlation[known], 0.0)
    W = np.zeros((sensors, samples, samples))
    try:
        for w, some in zip(W, there.T, strict=True):
            rows = np.flatnonzero(some)
            w[np.ix_(rows, rows)] = np.linalg.inv(np.linalg.cholesky(C[np.ix_(rows, rows)]))
    except np.linalg.LinAlgError:
        raise ValueError(
            f"correlation must be that of some errors, a positive definite matrix of {samples} "
            f"samples, got {correlation.tolist()}"
        ) from None
    return W
