"""Evidence from the saved sweep: one algorithm against another on the same samples."""

import numpy as np

from ....evaluation.intervals import ConfidenceInterval, mean_interval
from ..fusion_sweep import saved_sweep
from ._axes import swept

FAST = "path 2"
Q = 30  # where the intensity of the jerk is no matter of the claim, or one of many
GRID = "4 to 96"
_MEASURES = {
    "root mean square in the maneuver": "maneuver",
    "cee of the record": "cee",
    "root mean square": "whole",
    "cee": "cee",
}


def comparisons():
    """Return the evidence on delay, fusion, smoothing and adaptation."""
    return {**_delays(), **_in_maneuvers(), **_at_constant_velocity(), **_of_records()}


def ratio(measure, over, under, sensors="equal", **where):
    """Return the mean ratio of two algorithms, each with its setting, in the same runs."""
    of = saved_sweep().of
    above, below = (of(measure, *one, sensors=sensors, **where) for one in (over, under))
    return mean_interval(above / below)


def _delays():
    def explained(fixed, snr, q, path):
        return mean_interval(saved_sweep().of("late", "1", fixed, path=path, snr_db=snr, q=q))

    def fused(algorithm, fixed, sensors, snr, path):
        setting = fixed if algorithm == "3" else GRID
        where = dict(path=path, snr_db=snr, q=Q)
        return ratio("delay", (algorithm, setting), ("1", fixed), sensors, **where)

    def adaptive(order, fixed, grid, snr, path):
        return ratio("delay", (order, grid), ("3", fixed), path=path, snr_db=snr, q=Q)

    return {
        "kalman-delay": swept("fixed snr q path", explained),
        "fusion-delay": swept("fused fixed sensors snr path", fused),
        "adaptive-delay": swept("order fixed grid snr path", adaptive),
    }


def _in_maneuvers():
    def adaptive(fixed, grid, snr, q, error):
        where = dict(path=FAST, snr_db=snr, q=q)
        return ratio(_MEASURES[error], ("2", grid), ("1", fixed), **where)

    def fusion(fixed, sensors, snr, q, error):
        where = dict(path=FAST, snr_db=snr, q=q)
        return ratio(_MEASURES[error], ("3", fixed), ("1", fixed), sensors, **where)

    def fast(order, grid, sensors, snr, q, error):
        where = dict(path=FAST, snr_db=snr, q=q)
        return ratio(_MEASURES[error], (order, grid), ("2", grid), sensors, **where)

    def every(order, path, grid, sensors, snr, q):
        where = dict(path=path, snr_db=snr, q=q)
        return ratio("maneuver", (order, grid), ("2", grid), sensors, **where)

    return {
        "adaptive-maneuver": swept("fixed grid snr q error-maneuver", adaptive),
        "fusion-maneuver": swept("fixed sensors snr q error-maneuver", fusion),
        "fusion-fast": swept("order grid sensors snr q error-maneuver", fast),
        "fusion-every-snr": swept("order path grid sensors snr q", every),
    }


def _at_constant_velocity():
    def single(order, path, grid, sensors, snr, q):
        where = dict(path=path, snr_db=snr, q=q)
        return ratio("constant", ("2", grid), (order, grid), sensors, **where)

    def smoothing(fixed, grid, sensors, snr, q):
        where = dict(path=FAST, snr_db=snr, q=q)
        rivals = ("1", fixed), ("2", grid), ("4", grid), ("5", grid)
        return _largest(ratio("constant", ("3", fixed), one, sensors, **where) for one in rivals)

    def excluding(order, fixed, grid, snr, q):
        where = dict(path=FAST, snr_db=snr, q=q)
        delay, noise = (
            ratio(measure, (order, grid), ("3", fixed), **where)
            for measure in ("delay", "constant")
        )
        return _apart(delay, noise)

    return {
        "constant": swept("order path grid sensors snr q", single),
        "smoothing": swept("fixed grid sensors snr q", smoothing),
        "trade-off": swept("order fixed grid snr q", excluding),
    }


def _of_records():
    def same(path, sensors, snr, q, error, feedback):
        five = "5" if feedback == "acceleration and ratio" else "5 state"
        where = dict(path=path, snr_db=snr, q=q)
        found = ratio(_MEASURES[error], (five, GRID), ("4", GRID), sensors, **where)
        return _size(found.value - 1, found.low - 1, found.high - 1)

    def paths(gentle, fixed, sensors, snr, gain):
        gains = []
        for path in (FAST, f"path 1, {gentle} m/s²"):
            where = dict(path=path, snr_db=snr, q=Q, sensors=sensors)
            one, two = (saved_sweep().of("cee", a, fixed, **where) for a in ("1", "3"))
            gains.append(100 * (1 - two / one) if gain == "fraction of the error" else one - two)
        return mean_interval(gains[0] - gains[1])

    def low(order, rival, low, path, fixed, error):
        where = dict(path=path, snr_db=low, q=Q)
        other = rival, (GRID if rival == "2" else fixed)
        return ratio(_MEASURES[error], (order, GRID), other, **where)

    return {
        "same": swept("path sensors snr q error feedback", same),
        "paths": swept("gentle fixed sensors snr gain", paths),
        "low-snr": swept("order rival low-snr path fixed error", low),
    }


def _largest(estimates):
    return max(estimates, key=lambda one: one.value)


def _apart(one, other):
    """Return a number above 1 if one ratio lies above 1 and the other below: the nearer one.

    A ratio below 1 counts by its inverse.
    """
    up, down = sorted((one, other), key=lambda ratio: -ratio.value)
    if down.value <= 0:  # a delay that is zero but for noise: its inverse is beyond all numbers
        return up
    highest = 1 / down.low if down.low > 0 else np.inf
    inverse = ConfidenceInterval(1 / down.value, 1 / down.high, highest)
    return min((up, inverse), key=lambda ratio: ratio.value)


def _size(value, low, high):
    """Return the interval of an absolute value."""
    return ConfidenceInterval(
        abs(value), max(low, -high, 0.0), float(np.max(np.abs([value, low, high])))
    )
