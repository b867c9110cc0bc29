"""Evidence on the best window: its dependence on acceleration and noise, and its linearity."""

from functools import cache

import numpy as np

from ....evaluation.intervals import ConfidenceInterval, mean_interval
from ..published import reported
from ..window_law import best_lengths, linear_cost, linear_error
from ..window_simulation import window_table
from ._axes import swept

LENGTHS = (3, 4, 5, 6, 8, 10, 12, 16, 20, 24, 32, 40, 48, 64, 80, 96, 112)
ACCELERATIONS, SNRS_DB = (5.0, 20.0, 40.0), (0.0, 20.0)
BATCHES, RUNS = 8, 10
PAIRS, MANY = (12, 16, 64, 96), 40  # two windows only, of which the shorter one fails at times
_ALONG = {"acceleration": "acceleration", "signal-to-noise ratio in dB": "snr", "both": "both"}


def windows(rng):
    """Return the evidence on the best window."""
    seeds = rng.integers(2**32, size=BATCHES)

    @cache
    def simulated(q, lengths, runs):
        judge = "measurement" if q is None else "filter"
        return [
            window_table(
                ACCELERATIONS, SNRS_DB, rng=np.random.default_rng(seed), runs=runs,
                windows=lengths, judge=judge, q=q,
            )
            for seed in seeds
        ]  # fmt: skip

    def tables(velocities, q, *settings):
        return simulated(None if velocities == "of the Doppler filter" else q, *settings)

    def best(velocities, q, over, under):
        lengths = np.array([best_lengths(one) for one in tables(velocities, q, LENGTHS, RUNS)])
        ratio = lengths[:, *_cell(*over)] / lengths[:, *_cell(*under)]
        if np.isnan(ratio).any():  # an optimum at the end of the windows tried is none
            return ConfidenceInterval(1.0, -np.inf, np.inf)
        return _mean(ratio)

    def error(velocities, q, cell, over, under):
        over, under = (PAIRS.index(one) for one in (over, under))
        cee = np.array([one.cee[_cell(*cell)] for one in tables(velocities, q, PAIRS, MANY)])
        return _mean(cee[:, over] / cee[:, under])

    def late(pair, velocities, q):
        return error(velocities, q, (40.0, 20.0), *_pair(pair))

    def noisy(pair, velocities, q):
        return error(velocities, q, (5.0, 0.0), *_pair(pair)[::-1])

    return {
        "window-acceleration": swept(
            "velocities q", lambda v, q: best(v, q, (5.0, 20.0), (40.0, 20.0))
        ),
        "window-snr": swept("velocities q", lambda v, q: best(v, q, (20.0, 0.0), (20.0, 20.0))),
        "window-short": swept("pair velocities q", late),
        "window-long": swept("pair velocities q", noisy),
        "window-linear": swept("line top top-snr distance", _line),
        "window-interpolation": swept("nodes top top-snr", _interpolation),
    }


def _mean(ratios):
    """Return the geometric mean, with its interval: half and twice are equally far from one."""
    logs = mean_interval(np.log(ratios))
    return ConfidenceInterval(*(float(np.exp(end)) for end in (logs.value, logs.low, logs.high)))


def _cell(a, snr_db):
    return ACCELERATIONS.index(a), SNRS_DB.index(snr_db)


def _pair(pair):
    return [int(one) for one in pair.split(" and ")]


def _line(line, top, top_snr, distance):
    said = reported().stated
    region = (said.linear_above_acceleration, top), (said.linear_above_snr_db, top_snr)
    off = np.abs(linear_error(*region, along=_ALONG[line]))
    return float(off.max() if distance == "largest" else np.sqrt(np.mean(off**2)))


def _interpolation(nodes, top, top_snr):
    said = reported().stated
    a, s = said.linear_above_acceleration, said.linear_above_snr_db
    if nodes == "corners of the region":
        return float(linear_cost((a, top), (s, top_snr)).max()) - 1
    inside = [a * 2**k for k in range(4) if a * 2**k < top], np.arange(s, top_snr, 10)
    return float(linear_cost([*inside[0], top], [*inside[1], top_snr]).max()) - 1
