"""Many detections a scan, an unknown number of targets: predict, gate, assign, update, start."""

import numpy as np

from .. import _checks
from .._records import record
from ..estimation.extended_update import _corrected, _innovation
from .association import gnn_assign
from .management import CONFIRMED, DELETED


@record
class ManagedTrack:
    """One track from its first detection to its end.

    Attributes
    ----------
    scan : ndarray of int, shape (L,)
        Numbers of the scans, without gaps.
    x : ndarray, shape (L, n)
        State estimates, after the updates.
    P : ndarray, shape (L, n, n)
        Their covariances.
    detection : ndarray of int, shape (L,)
        Which detection of the scan belongs to it; -1 where it was only predicted.
    confirmed : ndarray of bool, shape (L,)
        Whether it was confirmed by then.
    """

    scan: np.ndarray
    x: np.ndarray
    P: np.ndarray
    detection: np.ndarray
    confirmed: np.ndarray


def track_scans(
    scans, F, Q, h, H, R, start, manager, probability=0.999, assign=gnn_assign, wrap=(), new=None
):
    """Track all targets in a sequence of scans.

    Parameters
    ----------
    scans : sequence of ndarray, shape (detections, m)
        Measurements of each scan; their number may vary.
    F, Q : array_like, shape (n, n)
        Transition matrix; covariance of the process noise between two scans.
    h, H : callable
        Measurement function and its Jacobian, see `ekf_update`.
    R : array_like, shape (m, m)
        Covariance of the measurement noise.
    start : callable
        Takes measurements (..., m), returns states (..., n) and covariances (..., n, n).
    manager : TrackManager
        Rules of confirmation and deletion.
    probability : float
        Probability of the chi-square gate.
    assign : callable
        `gnn_assign` or `greedy_assign`: takes NIS of all pairs and the size of the gate.
    wrap : sequence of int
        Components of the measurement that are angles.
    new : callable, optional
        Takes measurements (detections, m), returns booleans (detections,): which of them may start
        a track or belong to a tentative one; all if None.

    Returns
    -------
    list of ManagedTrack
        In the order in which they began. A deleted track ends with its last scan before deletion.

    Raises
    ------
    ValueError
        If shapes do not fit, also those that `start`, `h`, `H` and `new` return; a value is not
        finite; `Q` or `R` is not a covariance; or `probability` is not between 0 and 1.

    Notes
    -----
    The loop of a tracker as Blackman and Popoli (1999) draw it. Confirmed tracks choose first, then
    tentative ones; what nobody takes starts a track of its own.

    Examples
    --------
    One target that moves on by one, and a false alarm in the second scan:

    >>> from dopplerlib import TrackManager
    >>> scans = [np.array([[0.0]]), np.array([[9.0], [1.0]]), np.array([[2.0]])]
    >>> tracks = track_scans(
    ...     scans, [[1.0]], [[2.0]], lambda x: x, lambda x: np.eye(1), [[0.1]],
    ...     start=lambda z: (z, np.ones((*z.shape, 1))), manager=TrackManager(2, 3, 3),
    ... )
    >>> [(track.scan.tolist(), bool(track.confirmed[-1])) for track in tracks]
    [([0, 1, 2], True), ([1, 2], False)]
    """
    from scipy.special import chdtri  # here: it takes longer to load than all the rest

    m = _checks.matrix("R", R, (None, None)).shape[0]
    R = _checks.covariance("R", R, m)
    n = _checks.matrix("F", F, (None, None)).shape[0]
    F = _checks.matrix("F", F, (n, n))
    Q = _checks.matrix("Q", _checks.covariance("Q", Q, n, definite=False), (n, n))
    size = chdtri(m, 1 - _checks.probability("probability", probability))
    done, alive = [], []
    for number, scan in enumerate(scans):
        z = _checks.matrix(f"scans[{number}]", scan, (None, m))
        may_start = np.ones(len(z), bool) if new is None or not len(z) else _allowed(new(z), len(z))
        free = np.ones(len(z), bool)
        if alive:
            x = np.stack([track["x"][-1] for track in alive]) @ F.T
            P = F @ np.stack([track["P"][-1] for track in alive]) @ F.T + Q
            nu, S, J = _innovation(x[:, None], P[:, None], z, h, H, R, wrap)
            S, J = S[:, 0], np.broadcast_to(J, (len(alive), 1, *J.shape[-2:]))[:, 0]
            cost = np.sum(nu * np.linalg.solve(S, nu.swapaxes(1, 2)).swapaxes(1, 2), axis=-1)
            cost = np.where(cost <= size, cost, np.inf)
            first = np.array([track["confirmed"][-1] for track in alive])
            assigned = np.full(len(alive), -1)
            for some, open_to_them in ((first, True), (~first, may_start)):
                if some.any():
                    pairs = np.where(free & open_to_them, cost[some], np.inf)
                    assigned[some] = assign(pairs, size)
                    free[assigned[assigned >= 0]] = False
            seen = assigned >= 0
            x[seen], P[seen] = _corrected(
                x[seen], P[seen], nu[seen, assigned[seen]], S[seen], J[seen], R
            )
            for i, track in enumerate(alive):
                _extend(track, number, x[i], P[i], assigned[i], manager)
        left = np.flatnonzero(may_start & free)
        x, P = _started(start(z[left]), len(left), n) if len(left) else ((), ())
        begun = [_begin(number, *state, manager) for state in zip(x, P, left, strict=True)]
        done += begun
        alive = [track for track in alive if track["life"].status != DELETED] + begun
    return [_frozen(track) for track in done]


def _allowed(value, detections):
    value = np.asarray(value)
    if value.dtype != bool or value.shape != (detections,):
        raise ValueError(
            f"new(z) must be made of booleans, of shape {(detections,)}, "
            f"got {value.dtype} of shape {value.shape}"
        )
    return value


def _started(states, count, n):
    x, P = states
    P = _checks.covariance("start(z)[1]", P, n, definite=False)
    _checks.check_shape("start(z)[1]", P, (count, n, n))
    return _checks.finite("start(z)[0]", x, (count, n)), P


def _begin(number, x, P, detection, manager):
    life = manager.start()
    return {
        "life": life,
        "scan": [number],
        "x": [x],
        "P": [P],
        "detection": [detection],
        "confirmed": [life.status == CONFIRMED],
    }


def _extend(track, number, x, P, detection, manager):
    track["life"] = life = manager.advance(track["life"], detection >= 0)
    if life.status != DELETED:
        track["scan"].append(number)
        track["x"].append(x)
        track["P"].append(P)
        track["detection"].append(detection)
        track["confirmed"].append(life.status == CONFIRMED)


def _frozen(track):
    names = ("scan", "x", "P", "detection", "confirmed")
    return ManagedTrack(*(np.array(track[name]) for name in names))
