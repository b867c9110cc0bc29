"""Evidence for every claim of the document that can be checked.

What ranges over signal-to-noise ratios or paths is judged in one cell that stands for all: a claim
about all of them in the one that suits it least, and one that holds nowhere in the one that suits
it best.
"""

import numpy as np

from ..._hints import Runs, checked
from ...evaluation.intervals import ConfidenceInterval, mean_interval, quantile_interval
from ...replication.evidence import Readings
from .algorithms import run_algorithms
from .fusion_study import cell_measures, failure_limit, saved_failures
from .published import reported
from .residual_noise import residual_variance, updated_residual
from .window_law import linear_cost, plane_error
from .window_simulation import window_table
from .window_transform import measurement_variance

# What is simulated if no cells are given: enough for every verdict.
CASES = (
    ("path 1", 0.0),
    ("path 1", 15.0),
    ("path 2", 0.0),
    ("path 2", 15.0),
    ("path 2", 40.0),
    ("fighter", 15.0),
)
FAST, GENTLE, FIGHTER = ("path 2",), ("path 1",), ("fighter",)
BOTH = GENTLE + FAST
LOWEST = 0.0  # dB; below, all algorithms begin to fail, and ratios of their errors say little


@checked
def evidence(*, rng: np.random.Generator, runs: Runs = 100, cells: dict | None = None) -> dict:
    """Collect the evidence for ``data/valarmathi/claims.toml``.

    Parameters
    ----------
    rng : numpy.random.Generator
        Source of randomness.
    runs : int
        Number of records of both sensors on each path and at each signal-to-noise ratio. Less
        than 73 leave what one run in twenty exceeds without an upper bound.
    cells : dict, optional
        Measures of runs by path and signal-to-noise ratio, as `FusionStudy.cells` returns them. If
        None, a few cells are simulated.

    Returns
    -------
    dict
        By the id of the claim; see `judge_all`.

    Raises
    ------
    ValueError
        If `runs` is not a positive whole number, or `rng` is not a generator.
    """
    for_table, for_filter, *own = rng.spawn(2 + len(CASES))
    table = window_table(rng=for_table)
    simulated = {}
    for case, child in zip(CASES, own, strict=True):
        if cells is None or case == ("path 2", 15.0):
            result = run_algorithms(*case, runs, table, rng=child)
            simulated[case] = cell_measures(result)  # the runs themselves would fill the memory
            if case == ("path 2", 15.0):
                residuals = _residuals(result)
    after_filter = window_table(
        [5.0, 20.0, 40.0], [0.0, 20.0], rng=for_filter, runs=5, judge="filter"
    )
    found = simulated if cells is None else cells
    return {
        **_arithmetic(),
        **_windows(table, after_filter),
        **_maneuvers(found),
        **_constant(found),
        **_comparisons(found),
        **_limits(found),
        **residuals,
    }


def _residuals(result):
    """Return the evidence from the errors over time: fraction due to delay, variance by Eq 14."""
    steady = result.during("steady")
    a = result.path.a[result.fixed.first :][steady]
    error = result.velocity(1)[:, steady] - result.truth[steady]
    rest = error + result.delay(1)[:, None] * a
    share = 1 - np.mean(rest**2, axis=-1) / np.mean(error**2, axis=-1)
    constant = result.during("constant")
    R = float(measurement_variance(reported().chosen.fixed_window, result.snr_db))
    nu, S = (one[:, 0, constant] for one in (result.fixed.innovation, result.fixed.S))
    residual, HPH = updated_residual(nu, S, R)
    return {
        "delay-share": mean_interval(share),
        "eq-14": mean_interval(residual_variance(residual, HPH[:, -1]) / R),
    }


def _arithmetic():
    said, own = reported().stated, reported().chosen
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
    said, own = reported().stated, reported().chosen
    a, snr_db = said.linear_above_acceleration, said.linear_above_snr_db
    region = (a, said.g_positive_si), (snr_db, own.table_snrs_db[-1])
    nodes = (
        [one for one in own.table_accelerations if one >= a],
        [one for one in own.table_snrs_db if one >= snr_db],
    )
    return {
        "window-acceleration": Readings(
            {name: best(one, 5.0, 20.0) / best(one, 40.0, 20.0) for name, one in judges.items()}
        ),
        "window-snr": Readings(
            {name: best(one, 20.0, 0.0) / best(one, 20.0, 20.0) for name, one in judges.items()}
        ),
        "window-short": cee(40.0, 20.0, 96) / cee(40.0, 20.0, 12),
        "window-long": cee(5.0, 0.0, 8) / cee(5.0, 0.0, 48),
        "window-plane": float(np.abs(plane_error(*region)).max()),
        "window-linear": Readings(
            {
                "between the corners of the region": float(linear_cost(*region).max()),
                "between the nodes of a table": float(linear_cost(*nodes).max()),
            }
        ),
    }


def _maneuvers(found):
    return {
        "adaptive-maneuver": _largest(_ratios(found, FAST, 2, 1, "maneuver", low=-np.inf)),
        "fusion-maneuver": _smallest(_ratios(found, FAST, 3, 1, "maneuver")),
        "fusion-delay": _smallest(_ratios(found, BOTH, 3, 1, "delay")),
        "adaptive-delay": _by_path(lambda path: _largest(_ratios(found, path, 4, 3, "delay"))),
        "fusion-fast": mean_interval(
            np.mean([cell[4, "cee"] / cell[2, "cee"] for cell in _cells(found, FAST)], axis=0)
        ),
        "fusion-every-snr": max(
            (
                _smallest(pair)
                for pair in zip(
                    *(_ratios(found, BOTH, a, 2, "maneuver", low=-np.inf) for a in (4, 5)),
                    strict=True,
                )
            ),
            key=lambda one: one.low,  # where some runs fail, the ratio is known badly
        ),
        "paths": _largest(
            mean_interval(_taken_away(cell) - _taken_away(found["path 1", snr_db]))
            for (path, snr_db), cell in found.items()
            if path == "path 2" and snr_db >= LOWEST and ("path 1", snr_db) in found
        ),
    }


def _constant(found):
    return {
        "constant": _smallest(_ratios(found, BOTH, 2, 4, "constant", low=-np.inf)),
        "smoothing": _smallest(_ratios(found, BOTH, 3, 4, "constant", low=-np.inf)),
        "trade-off": _largest(
            _largest(pair)
            for pair in zip(
                *(_ratios(found, FAST, 4, 3, phase) for phase in ("maneuver", "constant")),
                strict=True,
            )
        ),
    }


def _comparisons(found):
    def worse(path, other):
        return _largest(
            one for a in (4, 5) for one in _ratios(found, path, a, other, "whole", high=5.0)
        )

    return {
        "same": _by_path(
            lambda path: _largest(
                mean_interval(np.abs(cell[5, "whole"] / cell[4, "whole"] - 1))
                for cell in _cells(found, path)
            )
        ),
        "low-snr": Readings(
            {
                f"than algorithm {other}, {path[0]}": worse(path, other)
                for other in (1, 2)
                for path in (FAST, GENTLE)
            }
        ),
    }


def _limits(found):
    def worst(algorithms, paths, low, high=np.inf):
        return _largest(
            quantile_interval(cell[a, "whole"], 1 - reported().chosen.failed_share)
            for cell in _cells(found, paths, low, high)
            for a in algorithms
        )

    said = reported().stated
    fused, single = said.snr_limit_fused_db, said.snr_limit_single_db
    return {
        "kalman-fails": worst((1,), BOTH, LOWEST),
        "limit-fused": worst((4, 5), BOTH, fused),
        "limit-fused-below": worst((4, 5), BOTH, LOWEST, fused - 5),
        "limit-single": worst((1, 2), BOTH, LOWEST, single - 5),
        "limits-apart": _largest(_limits_apart()),
        "fighter": worst((1, 2, 3, 4, 5), FIGHTER, fused),
    }


def _limits_apart():
    """Yield the limit of one adaptive filter minus that of two, on each path."""
    shares = saved_failures()
    for path in BOTH:
        two, one = (failure_limit(*shares[path, a]) for a in (4, 2))
        yield ConfidenceInterval(one.value - two.value, one.low - two.high, one.high - two.low)


def _cells(found, paths, low=LOWEST, high=np.inf):
    return [
        cell for (path, snr_db), cell in found.items() if path in paths and low <= snr_db <= high
    ]


def _ratios(found, paths, over, under, what, low=LOWEST, high=np.inf):
    """Return the mean ratio of two algorithms in each cell."""
    return [
        mean_interval(cell[over, what] / cell[under, what])
        for cell in _cells(found, paths, low, high)
    ]


def _taken_away(cell):
    """Return the reduction of the cee by fusion without adaptation, in percent."""
    return 100 * (1 - cell[3, "cee"] / cell[1, "cee"])


def _by_path(judged):
    return Readings({"path 2": judged(FAST), "path 1, which is ours": judged(GENTLE)})


def _largest(estimates):
    return max(estimates, key=lambda one: one.value)


def _smallest(estimates):
    return min(estimates, key=lambda one: one.value)
