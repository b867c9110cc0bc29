"""The path of one radar: gate, nearest neighbor, Kalman filter (Chapters 3 and 4)."""

from typing import Annotated, Literal

import numpy as np

from ... import _checks
from ..._hints import Array, Booleans, checked, shaped
from ..._records import record
from ..._typing import FloatArray
from ...estimation import recursion
from ...tracking.association import nearest_neighbor
from ...tracking.gates import chi2_gate, fixed_box_gate
from .noise import _near
from .settings import FilterSettings

Detections = Annotated[FloatArray, shaped(None, None, 2, check=_checks.bounded)]
Starts = Annotated[FloatArray, shaped(2, check=_near)]


@checked
@record
class RangeTrack:
    """Estimates of one radar's filter, and the detections that it used.

    x (..., K, 2): Estimates of range in m and range rate in m/s.
    P (..., K, 2, 2): Their covariances as the filter reports them.
    chosen (..., K, 2): The detection that was used; NaN where none was.
    updated (..., K): Whether a detection was used. One that starts the track counts as used; a
        start without one does not.
    nis (..., K): Least normalized innovation squared of the detections, inside the gate or not; NaN
        where there was no detection, and at the first scan.
    """

    x: Annotated[FloatArray, shaped(None, 2)]
    P: Annotated[FloatArray, shaped(None, 2, 2)]
    chosen: Annotated[FloatArray, shaped(None, 2, check=_checks.measured)]
    updated: Booleans
    nis: Array


@checked
def track_ranges(
    detections: Detections,
    settings: FilterSettings,
    *,
    doppler: bool = True,
    association: Literal["gate-first", "nearest-first"] = "gate-first",
    reuse_first: bool = False,
    x0: Starts | None = None,
) -> RangeTrack:
    """Run gate, nearest neighbor and Kalman filter over records of one radar.

    detections (..., K, M, 2): Range in m and range rate in m/s of up to M detections in each of K
        scans; NaN where there is none.
    settings: Settings of the filter, see `filter_settings`.
    doppler: Whether the range rate updates the filter. The box looks at it in any case, as in the
        code; a gate on NIS only if it updates.
    association: "gate-first": the nearest of the detections inside the gate, by NIS, as the text
        says; "nearest-first": the nearest in range alone, dropped if it is outside, as the code
        does.
    reuse_first: Whether the first detection starts the filter and then updates it once more, as the
        code does. If not, it only starts it.
    x0 (2,) or (..., 2): Start where the first scan is empty. No detection counts as used there.
    Raises ValueError if a shape or a name does not fit, there is no scan or no room for a
        detection, a first scan is empty and no `x0` is given, or numbers are too large for a
        filter.

    Notes
    -----
    Åsheim (2015), Appendix A.5 to A.7. The noise of range and range rate is independent, so that
    updating with the one and then with the other, as Table 3.3 does, is the same as with both at
    once; and each such update is one of scalars, without a matrix to invert.

    Examples
    --------
    >>> from dopplerlib.systems.asheim2015 import filter_settings
    >>> detections = [[[2.0, 0.1]], [[2.1, 0.1]], [[np.nan, np.nan]]]
    >>> track_ranges(detections, filter_settings("code")).updated.tolist()
    [True, True, False]
    """
    z = detections
    if not z.shape[-3] or not z.shape[-2]:
        raise ValueError(f"detections must have scans and detections in each, got shape {z.shape}")
    batch, K = z.shape[:-3], z.shape[-3]
    x = _start(z[..., 0, :, :], x0)
    P = np.broadcast_to(settings.P0[[0, 0, 1], [0, 1, 1]], (*batch, 3))
    m = 2 if doppler else 1

    def step(k, state):
        x, P = _predicted(*state, settings)
        R = settings.R(x[..., 0])
        nu = z[..., k, :, :] - x[..., None, :]
        nis, accept = _gate(nu, P, R, settings, m)
        if k == 0:
            accept = np.isfinite(nis)
        if association == "gate-first":
            index = nearest_neighbor(nis, accept)
        else:
            index = nearest_neighbor(np.abs(nu[..., 0]), np.isfinite(nis))
        picked = np.maximum(index, 0)[..., None]
        used = (index >= 0) & np.take_along_axis(accept, picked, -1)[..., 0]
        chosen = np.take_along_axis(z[..., k, :, :], picked[..., None], -2)[..., 0, :]
        chosen = np.where(used[..., None], chosen, np.nan)
        for i in range(m):
            x, P = _updated(x, P, i, chosen[..., i], R[..., i], used)
        with np.errstate(invalid="ignore"):
            least = np.fmin.reduce(nis, axis=-1)
        return (x, P), (x, P, chosen, used, least)

    times, first = range(K), None
    if not reuse_first:
        seen = np.isfinite(z[..., 0, :, :]).all(axis=-1).any(axis=-1)
        times = range(1, K)
        first = x, P, np.where(seen[..., None], x, np.nan), seen, np.full(batch, np.nan)
    x, P, *rest = recursion.scan(step, (x, P), times, len(batch), first=first)
    _checks.estimates("detections, settings, x0", x, P)
    return RangeTrack(x, P[..., [0, 1, 1, 2]].reshape(*P.shape[:-1], 2, 2), *rest)


def _predicted(x, P, settings):
    """Move states (..., 2) and entries dd, dv, vv of their covariances (..., 3) on by T."""
    T, Q = settings.T, settings.Q
    d, v = x[..., 0], x[..., 1]
    dd, dv, vv = P[..., 0], P[..., 1], P[..., 2]
    x = np.stack([d + T * v, v], axis=-1)
    P = [dd + 2 * T * dv + T * T * vv + Q[0, 0], dv + T * vv + Q[0, 1], vv + Q[1, 1]]
    return x, np.stack(P, axis=-1)


def _updated(x, P, i, z, r, used):
    """Update with a measurement (...) of component i, of variance r, where it is used."""
    own, other, cross = P[..., 2 * i], P[..., 2 - 2 * i], P[..., 1]
    S = own + r
    # Where nothing is used the gain is zero and nothing shrinks.
    nu, shrink = np.where(used, z - x[..., i], 0.0), np.where(used, r / S, 1.0)
    lost = np.where(used, cross * cross / S, 0.0)
    gain = [own / S, cross / S]
    x = x + np.stack(gain if i == 0 else gain[::-1], axis=-1) * nu[..., None]
    kept = [shrink * own, shrink * cross, other - lost]
    return x, np.stack(kept if i == 0 else kept[::-1], axis=-1)


def _gate(nu, P, R, settings, m):
    a, b, c = (
        part[..., None] for part in (P[..., 0] + R[..., 0], P[..., 1], P[..., 2] + R[..., 1])
    )
    d, v = nu[..., 0], nu[..., 1]
    there = np.isfinite(d) & np.isfinite(v)
    # The quadratic form of the inverse of [a b; b c], written out: a solver takes longer.
    nis = d * d / a if m == 1 else (c * d * d - 2 * b * d * v + a * v * v) / (a * c - b * b)
    nis = np.where(there, nis, np.nan)
    if settings.gate == "box":
        return nis, fixed_box_gate(nu, settings.box)
    if settings.gate == "nis":
        return nis, chi2_gate(nis, m, settings.gate_probability)
    return nis, there


def _start(z, x0):
    """Return the first detection of the first scan (..., 2), or `x0` where there is none."""
    there = np.isfinite(z).all(axis=-1)
    index = np.argmax(there, axis=-1)[..., None, None]
    first = np.take_along_axis(z, index, -2)[..., 0, :]
    empty = ~there.any(axis=-1)
    if not empty.any():
        return first
    if x0 is None:
        raise ValueError("x0 must be given where the first scan is empty, got None")
    _checks.check_broadcast("x0", x0.shape[:-1], "detections", empty.shape)
    return np.where(empty[..., None], x0, first)
