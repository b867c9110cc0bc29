"""Evidence without random numbers: consistency of the stated and the drawn values."""

import numpy as np

from ...._data import read_json
from ....evaluation.consistency import chi2_interval
from ....model.doppler import doppler_shift
from ....replication.evidence import sweep
from ..published import reported
from ._runs import choices, starts
from ._tracking import block_errors

_SPEED_OF_LIGHT = 299_792_458.0  # m/s
_CARRIER = 24e9  # Hz, Section 2


def stated_evidence() -> dict[str, object]:
    """Return evidence by the id of the claim, see `evidence`."""
    return (
        _sensors()
        | _scene()
        | _table2()
        | _figure6()
        | _chi_square()
        | {"real-time": 1 / reported().scenario.T * operations(6, 6)}
    )


def _sensors():
    return {
        "sensitivity": 2 * _CARRIER / _SPEED_OF_LIGHT,
        "unit-of-acceleration": -2.0,  # the power of the second
    }


def _scene():
    s = reported().scenario
    sensors = read_json("mittermaier2016", "fig6_geometry.json")["sensors"]
    return {
        "ring-radius": float(np.mean(np.linalg.norm(sensors["measured_yz_m"], axis=-1))),
        "figure1-circles": told_of_range(s.x0, s.array),
        "velocity-sign": sweep(choices("letter-v"), least_shift),
    }


def told_of_range(x, array):
    """Return the change of a shift, in Hz, if the target is 10 cm farther from its sensor.

    The largest change over the sensors: each time on the line of sight, at the same velocity.
    """
    found = []
    for place in range(len(array)):
        sight = x[:3] - array.positions[place]
        farther = np.concatenate([x[:3] + 0.1 * sight / np.linalg.norm(sight), x[3:]])
        found.append(abs(doppler_shift(farther, array)[place] - doppler_shift(x, array)[place]))
    return float(max(found))


def least_shift(whose):
    """Return the least shift at the start of Table 2, in Hz, by whose velocity Eq 6 has in it."""
    s = reported().scenario
    sign = {"of the target": 1, "of the platform": -1}[whose]
    x = np.concatenate([s.x0[:3], sign * s.x0[3:]])
    return float(doppler_shift(x, s.array).min())


def operations(n, m):
    """Return additions and multiplications of a cycle of Table 1, as published, for dense matrices.

    A product of a x b and b x c takes 2 a b c, a solution of m equations for c columns
    2 m^3 / 3 + 2 m^2 c; a shift and its row of the Jacobian some 60.
    """
    predict = 2 * n * n + 4 * n**3 + n * n
    innovation = 60 * m + 2 * m * n * n + 2 * m * m * n + m * m + m
    gain = 2 * m**3 / 3 + 2 * m * m * n
    update = 2 * n * m + n + 2 * n * n * m + n * n + 2 * n**3
    return predict + innovation + gain + update


def _table2():
    s, table, drawn = reported().scenario, reported().table2, reported().figure6
    error = table.x_ml - s.x0
    return {
        "table2-position-norm": float(np.linalg.norm(error[:3])),
        "table2-velocity-norm": float(np.linalg.norm(error[3:])),
        "start-drawn": float(drawn.start[0]),
        "first-z-error": 100 * float(drawn.first_error[2]),
        "nees-small": sweep(choices("start"), initial_nees),
        "final-true": s.truth[-1, :3],
    }


def initial_nees(start):
    """Return the NEES of a start under the published covariance, over its expectation."""
    s = reported().scenario
    error = starts()[start] - s.x0
    return float(error @ np.linalg.solve(s.P0, error)) / 6


def _figure6():
    drawn = reported().figure6
    lower, upper = chi2_interval(6)
    inside = (lower <= drawn.nis) & (drawn.nis <= upper)
    estimated = np.array(reported().quoted.final_estimated_position_m)
    quoted = reported().quoted.nis_avg
    return {
        "nis-average-drawn": float(drawn.nis.mean()),
        "nis-inside-drawn": 100 * float(inside.mean()),
        "final-errors-drawn": 100 * drawn.error[-1],
        "final-estimate-near": float(
            np.linalg.norm(estimated - reported().quoted.final_true_position_m)
        ),
        "nis-matches": abs(quoted - 6) / float(np.sqrt(12 / reported().scenario.samples)),
        "decreasing-drawn": sweep(choices("blocks"), _worst_block),
        "z-worst-drawn": sweep(choices("mean-error"), _z_to_others),
    }


def _worst_block(number):
    errors = block_errors(reported().figure6.error, number)
    return float(np.max(errors[1:] / errors[:-1]))


def _z_to_others(average):
    error = reported().figure6.error
    power = 1 if average == "mean" else 2
    size = np.nanmean(error**power, axis=0) ** (1 / power)
    return float(size[2] / max(size[:2]))


def _chi_square():
    """Return moments of chi-square by sums over its density, independent of their formulas."""
    from scipy.special import chdtr

    edges = np.linspace(0, 200, 200_001)
    value, mass = (edges[1:] + edges[:-1]) / 2, np.diff(chdtr(6, edges))
    mean = float(np.sum(value * mass))
    return {
        "chi-square-mean": mean,
        "chi-square-variance": float(np.sum((value - mean) ** 2 * mass)),
        "chi-square-interval": np.array(chi2_interval(6)),
    }
