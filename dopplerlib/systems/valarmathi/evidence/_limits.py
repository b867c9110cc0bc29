"""Evidence on limits of the signal-to-noise ratio, on the fighter, and arithmetic."""

import numpy as np

from ....evaluation.intervals import ConfidenceInterval, mean_interval, quantile_interval
from ..algorithms import operations
from ..fusion_study import saved_study
from ..fusion_sweep import PATHS, saved_sweep
from ..published import reported
from ._axes import swept
from ._comparisons import _largest


def limits():
    """Return the evidence on how low the ratio may be, on the fighter, and on published numbers."""
    said, own = reported().stated, reported().chosen
    fused = said.snr_limit_fused_db

    def down_to(order, share, path):
        return _worst(order, share, path, fused, np.inf)

    def below(order, share, path):
        return _worst(order, share, path, 0.0, fused - 1)

    def single(algorithm, below, share, path):
        return _worst(algorithm, share, path, below, below)

    def fails(fixed, snr, q, path):
        return mean_interval(saved_sweep().of("whole", "1", fixed, path=path, snr_db=snr, q=q))

    return {
        "duration": said.T * said.samples,
        "acceleration": (said.v_before - said.v_after) / said.maneuver,
        "nine-g": said.g_positive * own.g,
        "minus-g": said.g_negative * own.g,
        "cost": min(operations(a) for a in (2, 3, 4, 5)) / operations(1),
        "kalman-fails": swept("fixed snr q path", fails),
        "limit-fused": swept("order share path", down_to),
        "limit-fused-below": swept("order share path", below),
        "limit-single": swept("single below share path", single),
        "limits-apart": swept("share path failed", _limits_apart),
        "fighter": swept("fixed grid q", _fighter),
    }


def _worst(algorithm, share, path, low, high):
    """Return the error that a fraction of the runs exceeds, the largest over some ratios."""
    study = saved_study()
    levels = np.flatnonzero((low <= study.snrs_db) & (study.snrs_db <= high))
    runs = study.of("whole", PATHS[path][0], int(algorithm))
    return _largest(quantile_interval(runs[j], 1 - share) for j in levels)


def _limits_apart(share, path, failed):
    """Return the limit of one adaptive filter minus that of two, fused, in dB."""
    study = saved_study()
    one, two = (
        [quantile_interval(runs, 1 - share) for runs in study.of("whole", PATHS[path][0], a)]
        for a in (2, 4)
    )
    ends = {
        (name, end): _crossing(study.snrs_db, [getattr(level, end) for level in errors], failed)
        for name, errors in (("one", one), ("two", two))
        for end in ("value", "low", "high")
    }
    return ConfidenceInterval(
        ends["one", "value"] - ends["two", "value"],
        ends["one", "low"] - ends["two", "high"],
        ends["one", "high"] - ends["two", "low"],
    )


def _crossing(snrs_db, errors, failed):
    """Return the ratio from which on errors stay below a limit: the first or last one at least."""
    above = np.flatnonzero(np.array(errors) > failed)
    if not len(above) or above[-1] == len(errors) - 1:
        return float(snrs_db[0] if not len(above) else snrs_db[-1])
    k = above[-1]
    logs = np.log(errors[k : k + 2])
    if not np.isfinite(logs).all():
        return float(snrs_db[k + 1])
    part = (logs[0] - np.log(failed)) / (logs[0] - logs[1])
    return float(snrs_db[k] + part * (snrs_db[k + 1] - snrs_db[k]))


def _fighter(fixed, grid, q):
    """Return the error of the worst algorithm at 20 and 40 dB."""
    settings = {"1": fixed, "2": grid, "3": fixed, "4": grid, "5": grid}
    return _largest(
        mean_interval(saved_sweep().of("whole", a, setting, path="fighter", snr_db=snr_db, q=q))
        for a, setting in settings.items()
        for snr_db in (20, 40)
    )
