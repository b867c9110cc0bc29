"""Data association: nearest neighbor, greedy, global nearest neighbor."""

import numpy as np

from .. import _checks
from .._hints import checked
from .._typing import ArrayLike, IntArray


@checked
@_checks.quiet
def nearest_neighbor(distance: ArrayLike, accept: ArrayLike | None = None) -> IntArray:
    """Return the nearest neighbor among the accepted detections.

    Parameters
    ----------
    distance : array_like, shape (..., D)
        Distances of D detections from a track, or their squares; NaN or infinite for one that is
        out of the question.
    accept : array_like of bool, shape (..., D), optional
        Whether a detection passed the gate; all did if None.

    Returns
    -------
    ndarray of int, shape (...)
        Index of the detection, -1 where there is none.

    Notes
    -----
    Each track decides on its own: two tracks may take the same detection. `gnn_assign` does not
    allow that.

    Examples
    --------
    >>> nearest_neighbor([[3.0, 1.0, 2.0]] * 2, [[True, False, True], [False] * 3]).tolist()
    [2, -1]
    """
    distance = _checks.real("distance", distance)
    _checks.check_shape("distance", distance, (None,))
    accept = _checks.booleans("accept", np.ones(distance.shape, bool) if accept is None else accept)
    if accept.shape != distance.shape:
        raise ValueError(
            f"accept must have shape {distance.shape} like distance, got {accept.shape}"
        )
    distance = np.where(accept & np.isfinite(distance), distance, np.inf)
    if not distance.shape[-1]:
        return np.full(distance.shape[:-1], -1)
    nearest = distance.argmin(axis=-1)
    return np.where(np.isfinite(distance.min(axis=-1)), nearest, -1)


@checked
@_checks.quiet
def greedy_assign(cost: ArrayLike, gate: float) -> IntArray:
    """Return the greedy assignment: the cheapest pair first, then the cheapest of the rest.

    Parameters
    ----------
    cost : array_like, shape (tracks, detections)
        Cost of each pair; NaN or infinite for one that is out of the question.
    gate : float
        Largest cost of a pair that is allowed.

    Returns
    -------
    ndarray of int, shape (tracks,)
        Detection of each track, -1 where it has none.

    Notes
    -----
    "Nearest neighbor" for several tracks, such that none takes what another has.

    Examples
    --------
    The first pair takes what the second track would have needed:

    >>> greedy_assign([[1.0, 2.0], [2.0, 8.0]], gate=5.0).tolist()
    [0, -1]
    """
    cost, gate = _costs(cost, gate)
    assigned = np.full(len(cost), -1)
    open_pairs = cost.copy()
    while open_pairs.size and open_pairs.min() <= gate:
        track, detection = np.unravel_index(open_pairs.argmin(), cost.shape)
        assigned[track] = detection
        open_pairs[track, :] = open_pairs[:, detection] = np.inf
    return assigned


@checked
@_checks.quiet
def gnn_assign(cost: ArrayLike, gate: float) -> IntArray:
    """Return the global-nearest-neighbor assignment, that of least total cost.

    Parameters
    ----------
    cost : array_like, shape (tracks, detections)
        Cost of each pair, for example its NIS; NaN or infinite for one that is out of the question.
    gate : float
        Largest allowed cost of a pair, and the cost of a track without a detection.

    Returns
    -------
    ndarray of int, shape (tracks,)
        Detection of each track, -1 where it has none.

    Notes
    -----
    The linear assignment problem, for which Kuhn (1955) gave the Hungarian algorithm; solved by
    `scipy.optimize.linear_sum_assignment`, with one column more for each track to stay alone.

    NIS is not the whole of a likelihood: it lacks ln|S|, so that a coasting track, whose S is
    large, outbids a track that is sure of its target. Where the covariances of tracks differ, add
    ln|S| of each track to its costs, and the largest of them to the gate.

    Examples
    --------
    Each track for itself would take the first detection; together they do better:

    >>> gnn_assign([[1.0, 2.0], [2.0, 8.0]], gate=5.0).tolist()
    [1, 0]
    """
    from scipy.optimize import linear_sum_assignment  # here: it takes long to load

    cost, gate = _costs(cost, gate)
    allowed = cost <= gate
    assigned = np.full(len(cost), -1)
    # A pair of which neither has another is made: it costs no more than its track alone.
    row, column = np.nonzero(allowed)
    choices = np.bincount(row, minlength=len(cost))
    only = (choices[row] == 1) & (np.bincount(column)[column] == 1)
    assigned[row[only]] = column[only]
    track = np.flatnonzero((choices > 0) & (assigned < 0))
    if len(track):
        detection = np.flatnonzero(allowed[track].any(axis=0))
        part = np.ix_(track, detection)
        # More than all tracks alone: such a pair is never part of the cheapest assignment.
        forbidden = (abs(gate) + 1) * (2 * len(track) + 2)
        pairs = np.where(allowed[part], cost[part], forbidden)
        alone = np.where(np.eye(len(track), dtype=bool), gate, forbidden)
        _, column = linear_sum_assignment(np.hstack([pairs, alone]))
        assigned[track] = np.append(detection, np.full(len(track), -1))[column]
    return assigned


def _costs(cost, gate):
    cost = _checks.real("cost", cost)
    if cost.shape == (0,):  # no track
        cost = cost.reshape(0, 0)
    if cost.ndim != 2:
        raise ValueError(f"cost must have shape (tracks, detections), got {cost.shape}")
    return np.where(np.isfinite(cost), cost, np.inf), _checks.one_number("gate", gate)
