"""Multi-target tracking: predict, gate, assign, update, initiate."""

from collections.abc import Callable, Iterable
from typing import Annotated, Any

import numpy as np

from .. import _checks
from .._hints import checked, exactly
from .._records import record
from .._typing import ArrayLike, BoolArray, FloatArray, IntArray
from ..estimation import densities, gaussian
from ..estimation.extended_update import predicted_measurement, wrapped
from .association import gnn_assign
from .management import CONFIRMED, DELETED, TrackManager, _advanced, _begun


def _whole(name, value):
    array = _checks.finite(name, value, (None,))
    if array.ndim != 1 or not len(array) or (array % 1 != 0).any() or (np.abs(array) > 2**53).any():
        raise ValueError(f"{name} must be a row of whole numbers, got {array.tolist()}")
    return array.astype(int)


@checked
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

    Raises
    ------
    ValueError
        If a field is not of the kind described, or they have different numbers of scans.
    """

    scan: Annotated[IntArray, _whole]
    x: Annotated[FloatArray, exactly(None, None, check=_checks.finite)]
    P: Annotated[FloatArray, exactly(None, None, None, check=_checks.finite)]
    detection: Annotated[IntArray, _whole]
    confirmed: Annotated[BoolArray, exactly(None, check=_checks.booleans)]

    def __post_init__(self):
        """Check that the fields have one number of scans."""
        n = self.x.shape[-1]
        for name, shape in (("x", (n,)), ("P", (n, n)), ("detection", ()), ("confirmed", ())):
            _checks.exact_shape(name, getattr(self, name), (len(self.scan), *shape))


@_checks.quiet
def track_scans(
    scans: Iterable[ArrayLike],
    F: ArrayLike,
    Q: ArrayLike | Callable[..., Any],
    h: Callable[..., Any],
    H: Callable[..., Any],
    R: ArrayLike | Callable[..., Any],
    start: Callable[..., Any],
    manager: TrackManager,
    gate_probability: float = 0.999,
    assign: Callable[..., Any] = gnn_assign,
    wrap: Iterable[int] = (),
    new: Callable[..., Any] | None = None,
    exclusive: bool = False,
) -> list[ManagedTrack]:
    """Track an unknown number of targets in a sequence of scans.

    Parameters
    ----------
    scans : iterable of array_like, shape (detections, m)
        Measurements of each scan; their number may vary, also to none. One with a NaN in it is not
        there: detections with other components cannot be compared.
    F : array_like, shape (n, n)
        Transition matrix from one scan to the next.
    Q : array_like, shape (n, n), or callable
        Covariance of the process noise between two scans. A function takes the states (tracks, n)
        before the step and returns one for each, (tracks, n, n).
    h, H : callable
        Measurement function and its Jacobian, see `ekf_update`.
    R : array_like, shape (m, m), or callable
        Covariance of the measurement noise. A function takes the states (tracks, n) of what is
        measured and returns one for each, (tracks, m, m): for noise that depends on the range.
    start : callable
        Takes measurements (..., m), returns states (..., n) and covariances (..., n, n).
    manager : TrackManager
        Rules of confirmation and deletion.
    gate_probability : float
        Probability of the chi-square gate.
    assign : callable
        `gnn_assign` or `greedy_assign`: takes NIS of all pairs and the size of the gate.
    wrap : iterable of int
        Components of the measurement that are angles.
    new : callable, optional
        Takes measurements (detections, m), returns booleans (detections,): which of them may start
        a track or belong to a tentative one; all if None.
    exclusive : bool
        Whether a detection inside the gate of a track, or of one that this scan has started, starts
        none of its own: for bodies that give several echoes.

    Returns
    -------
    list of ManagedTrack
        In the order in which they began. A deleted track ends with its last scan before deletion.

    Raises
    ------
    ValueError
        If shapes do not fit, also those that `start`, `h`, `H`, `Q`, `R`, `assign`, `new` return; a
        value is not finite, also of an estimate; `Q` or `R` is not a covariance, or `R` so small
        that the covariance of an innovation is singular to rounding; `manager` is no TrackManager;
        or `gate_probability` is not between 0 and 1.

    Notes
    -----
    The loop of a tracker as Blackman and Popoli (1999) draw it. Confirmed tracks choose first, then
    tentative ones; an unassigned detection starts a track of its own.

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

    scans = tuple(_checks.iterable("scans", scans))
    if callable(R):
        m = max((np.shape(scan)[-1] for scan in scans if np.size(scan)), default=1)
    else:
        R = _checks.matrix("R", R, (None, None))
        m = len(R)
        R = _checks.covariance("R", R, m)
    F = _checks.matrix("F", F, (None, None))
    n = F.shape[0]
    F = _checks.matrix("F", F, (n, n))
    if not callable(Q):
        Q = _checks.matrix("Q", _checks.covariance("Q", Q, n, definite=False), (n, n))
    size = chdtri(m, 1 - _checks.probability("gate_probability", gate_probability))
    _checks.instance("manager", manager, TrackManager)
    wrap = _checks.components("wrap", wrap, m)
    for name, value in (("start", start), ("assign", assign), ("new", new)):
        if value is not None or name != "new":
            _checks.function(name, value)
    done, alive = [], []
    exclusive = _checks.one_boolean("exclusive", exclusive)

    def gated(x, P, z):
        """Return predictions, gains, updated covariances, and NIS or infinity outside the gate."""
        predicted, J = predicted_measurement(x, m, h, H)
        predicted = _checks.each_run("h(x)", predicted, (len(x),), (m,))
        J = _checks.each_run("H(x)", J, (len(x),), (m, n))
        noise = _checks.covariance("R(x)", _checks.called("R", R, x), m) if callable(R) else R
        K, updated, S = gaussian.gain(P, J, noise)
        track, place = _close(predicted, z, S, size, wrap)
        nu = wrapped(z[place] - predicted[track], wrap)
        nis = densities.quadratic_form(nu, S[track])
        cost = np.full((len(x), len(z)), np.inf)
        cost[track, place] = np.where(nis <= size, nis, np.inf)
        return predicted, K, updated, cost

    for number, scan in enumerate(scans):
        z = _checks.detections(f"scans[{number}]", scan, m)
        z = _checks.one_matrix(f"scans[{number}]", z)
        places = np.flatnonzero(~np.isnan(z).any(axis=-1))
        z = z[places]
        may_start = np.ones(len(z), bool)
        if new is not None and len(z):
            may_start = _checks.booleans("new(z)", _checks.called("new", new, z), (len(z),))
        free = np.ones(len(z), bool)
        if alive:
            x, P = (np.stack([track[name][-1] for track in alive]) for name in ("x", "P"))
            step = Q
            if callable(Q):
                step = _checks.covariance("Q(x)", _checks.called("Q", Q, x), n, definite=False)
                _checks.check_shape("Q(x)", step, (len(x), n, n))
            x, P = gaussian.predict(x, P, F, step)
            _checks.estimates("F, Q", x, P)
            predicted, K, updated, cost = gated(x, P, z)
            first = np.array([track["confirmed"][-1] for track in alive])
            assigned = np.full(len(alive), -1)
            for some, open_to_them in ((first, True), (~first, may_start)):
                if some.any():
                    pairs = np.where(free & open_to_them, cost[some], np.inf)
                    assigned[some] = _assigned(assign, pairs, size)
                    free[assigned[assigned >= 0]] = False
            seen = assigned >= 0
            nu = wrapped(z[assigned[seen]] - predicted[seen], wrap)
            x[seen] = gaussian.moved(x[seen], K[seen], nu)
            P[seen] = updated[seen]
            _checks.estimates("h, H, R", x, P)
            for i, track in enumerate(alive):
                place = places[assigned[i]] if seen[i] else -1
                _extend(track, number, x[i], P[i], place, manager)
            if exclusive:
                free &= np.isinf(cost).all(axis=0)
        left = np.flatnonzero(may_start & free)
        x, P = _started(start, z[left], n) if len(left) else ((), ())
        if exclusive and len(left) > 1:
            *_, cost = gated(x, P, z[left])
            kept = []
            for i in range(len(left)):
                if np.isinf(cost[kept, i]).all():
                    kept.append(i)
            left, x, P = left[kept], x[kept], P[kept]
        started = [_begin(number, *one, manager) for one in zip(x, P, places[left], strict=True)]
        done += started
        alive = [track for track in alive if track["life"][0] != DELETED] + started
    return [_frozen(track) for track in done]


def _close(predicted, z, S, size, wrap):
    """Return pairs of a track and a detection, among them all that are inside the gate.

    The NIS is at least that of the first component: a search in the sorted detections finds
    the few of each track, where the gate alone would look at all.
    """
    if 0 in wrap:
        return np.divmod(np.arange(len(predicted) * len(z)), max(len(z), 1))
    reach = np.sqrt((1 + 1e-9) * size * S[:, 0, 0])  # not less by rounding
    order = np.argsort(z[:, 0])
    first = np.searchsorted(z[order, 0], predicted[:, 0] - reach)
    count = np.searchsorted(z[order, 0], predicted[:, 0] + reach, side="right") - first
    track = np.repeat(np.arange(len(predicted)), count)
    before = np.cumsum(count) - count  # pairs of the tracks before
    return track, order[np.arange(len(track)) - (before - first)[track]]


def _assigned(assign, cost, gate):
    """Return the result of `assign`: for each track a detection, none twice, or -1."""
    tracks, detections = cost.shape
    array = np.asarray(_checks.called("assign", assign, cost, gate))
    good = array.dtype.kind in "iu" and array.shape == (tracks,)
    if good:
        taken = array[array >= 0]
        good = array.min() >= -1 and array.max() < detections and len(set(taken)) == len(taken)
    if not good:
        raise ValueError(
            f"assign(cost, gate) must be whole numbers of shape {(tracks,)} from -1 to "
            f"{detections - 1}, none but -1 twice, got {array.tolist()}"
        )
    return array


def _started(start, z, n):
    states, count = _checks.called("start", start, z), len(z)
    try:
        x, P = states
    except (TypeError, ValueError):
        raise ValueError(f"start(z) must be a pair (x, P), got {states!r}") from None
    P = _checks.covariance("start(z)[1]", P, n, definite=False)
    _checks.check_shape("start(z)[1]", P, (count, n, n))
    return _checks.finite("start(z)[0]", x, (count, n)), P


def _begin(number, x, P, detection, manager):
    track = {name: [] for name in ("scan", "x", "P", "detection", "confirmed")}
    _append(track, _begun(manager), number, x, P, detection)
    return track


def _extend(track, number, x, P, detection, manager):
    life = _advanced(manager, *track["life"], bool(detection >= 0))
    if life[0] == DELETED:
        track["life"] = life
    else:
        _append(track, life, number, x, P, detection)


def _append(track, life, number, x, P, detection):
    track["life"] = life
    track["scan"].append(number)
    track["x"].append(x)
    track["P"].append(P)
    track["detection"].append(detection)
    track["confirmed"].append(life[0] == CONFIRMED)


def _frozen(track):
    names = ("scan", "x", "P", "detection", "confirmed")
    return ManagedTrack(*(np.array(track[name]) for name in names))
