"""Evidence for every claim of the document that can be checked."""

import numpy as np

from ...evaluation.intervals import mean_interval, quantile_interval
from ...evaluation.verdicts import Readings
from .algorithms import run_algorithms
from .doppler_filter import measurement_variance
from .noise import residual_variance, updated_residual
from .published import chosen, stated
from .window_law import linear_cost
from .windows import window_table

CASES = (
    ("path 1", 15.0),
    ("path 2", -10.0),
    ("path 2", 0.0),
    ("path 2", 15.0),
    ("path 2", 40.0),
    ("fighter", 15.0),
)
PHASES = ("all", "maneuver", "constant")


def evidence(*, rng, runs=75):
    """Collect the evidence for ``data/valarmathi/claims.toml``.

    Parameters
    ----------
    rng : numpy.random.Generator
        Source of randomness.
    runs : int
        Number of records of both sensors on each path and at each signal-to-noise ratio. Less
        than 73 leave what one run in twenty exceeds without an upper bound.

    Returns
    -------
    dict
        By the id of the claim; see `judge_all`.
    """
    for_table, for_filter, *own = rng.spawn(2 + len(CASES))
    table = window_table(rng=for_table)
    found = {}
    for (name, snr_db), child in zip(CASES, own, strict=True):
        result = run_algorithms(name, snr_db, runs, table, rng=child)
        found[name, snr_db] = _measures(result)  # the runs themselves would fill the memory
    after_filter = window_table(
        [5.0, 20.0, 40.0], [0.0, 20.0], rng=for_filter, runs=5, judge="filter"
    )
    return {
        **_arithmetic(),
        **_windows(table, after_filter),
        **_maneuvers(found),
        **_limits(found),
        "eq-14": mean_interval(found["path 2", 15.0]["eq14"]),
    }


def _measures(result):
    """Return numbers of each run, by what they are."""
    sensors = {1: (1, 2), 2: (1, 2), 3: (1,), 4: (1,), 5: (1,)}
    measures = {}
    for algorithm, each in sensors.items():
        for phase in PHASES:
            rmse = [result.rmse(algorithm, phase, sensor) for sensor in each]
            measures[algorithm, phase] = np.mean(rmse, axis=0)
        cee = [result.cee(algorithm, sensor)[:, -1] for sensor in each]
        measures[algorithm, "cee"] = np.mean(cee, axis=0)
        measures[algorithm, "delay"] = result.delay(algorithm)
    steady = result.during("steady")
    a = result.path.a[result.fixed.first :][steady]
    error = result.velocity(1)[:, steady] - result.truth[steady]
    late = error + result.delay(1)[:, None] * a
    measures["delay share"] = 1 - np.mean(late**2, axis=-1) / np.mean(error**2, axis=-1)
    constant = result.during("constant")
    R = float(measurement_variance(chosen().fixed_window, result.snr_db))
    nu, S = (one[:, 0, constant] for one in (result.fixed.innovation, result.fixed.S))
    residual, HPH = updated_residual(nu, S, R)
    measures["eq14"] = residual_variance(residual, HPH[:, -1]) / R
    return measures


def _ratio(measures, over, under, what):
    return mean_interval(measures[over, what] / measures[under, what])


def _arithmetic():
    said, own = stated(), chosen()
    return {
        "duration": said.T * said.samples,
        "acceleration": (said.v_before - said.v_after) / said.maneuver,
        "nine-g": said.g_positive * own.g,
        "minus-g": said.g_negative * own.g,
        "gain": float(10 * np.log10(2)),
    }


def _windows(table, after_filter):
    def best(one, a, snr_db):
        i = np.flatnonzero(one.accelerations == a)[0]
        return float(one.best[i, np.flatnonzero(one.snrs_db == snr_db)[0]])

    def cee(a, snr_db, window):
        axes = (table.accelerations, a), (table.snrs_db, snr_db), (table.windows, window)
        return float(table.cee[tuple(np.flatnonzero(axis == one)[0] for axis, one in axes)])

    judges = {"velocities of the Doppler filter": table, "of the Kalman filter": after_filter}
    return {
        "window-acceleration": Readings(
            {name: best(one, 5.0, 20.0) / best(one, 40.0, 20.0) for name, one in judges.items()}
        ),
        "window-snr": Readings(
            {name: best(one, 20.0, 0.0) / best(one, 20.0, 20.0) for name, one in judges.items()}
        ),
        "window-short": cee(40.0, 20.0, 96) / cee(40.0, 20.0, 12),
        "window-long": cee(5.0, 0.0, 8) / cee(5.0, 0.0, 48),
        "linear": float(linear_cost((10.0, stated().g_positive_si), (10.0, 40.0)).max()),
    }


def _maneuvers(found):
    fast, gentle, low = found["path 2", 15.0], found["path 1", 15.0], found["path 2", 0.0]
    range_ = [found[case] for case in CASES if case[0] == "path 2"]
    worst = max((_ratio(one, 4, 2, "maneuver") for one in range_), key=lambda e: e.value)
    apart = [
        mean_interval(np.abs(one[5, "all"] / one[4, "all"] - 1))
        for one in (low, fast, found["path 2", 40.0])
    ]
    gains = {name: one[3, "cee"] / one[1, "cee"] for name, one in (("2", fast), ("1", gentle))}
    rivals = {"than algorithm 1": 1, "than algorithm 2": 2}
    return {
        "delay-share": mean_interval(fast["delay share"]),
        "adaptive-maneuver": _ratio(fast, 2, 1, "maneuver"),
        "fusion-maneuver": _ratio(fast, 3, 1, "maneuver"),
        "fusion-delay": _ratio(fast, 3, 1, "delay"),
        "adaptive-delay": _ratio(fast, 4, 3, "delay"),
        "fusion-fast": _ratio(fast, 4, 2, "cee"),
        "fusion-every-snr": worst,
        "constant": _ratio(fast, 2, 4, "constant"),
        "smoothing": _ratio(fast, 3, 4, "constant"),
        "same": max(apart, key=lambda e: e.value),
        "paths": mean_interval(gains["2"] / gains["1"]),
        "low-snr": Readings(
            {
                name: max((_ratio(low, a, other, "all") for a in (4, 5)), key=lambda e: e.value)
                for name, other in rivals.items()
            }
        ),
    }


def _limits(found):
    def worst(algorithms, *cases):
        bounds = [
            quantile_interval(found[case][a, "all"], 0.95) for case in cases for a in algorithms
        ]
        return max(bounds, key=lambda e: e.value)

    at_15 = ("path 1", 15.0), ("path 2", 15.0)
    return {
        "kalman-fails": worst((1,), ("path 2", 15.0)),
        "limit-fused": worst((4, 5), *at_15),
        "limit-fused-below": worst((4, 5), ("path 2", 0.0)),
        "limit-single": worst((1, 2), *at_15),
        "fighter": worst((4, 5), ("fighter", 15.0)),
    }
