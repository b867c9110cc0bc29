"""Evidence without random numbers: consistency of the printed and the drawn values."""

import numpy as np

from ....evaluation.bounds import crlb
from ....evaluation.consistency import chi2_interval
from ....model.doppler import doppler_jacobian, doppler_shift
from ....replication.evidence import Readings
from ..published import reported
from ..start import samples_needed, start_misfit

_SPEED_OF_LIGHT = 299_792_458.0  # m/s
_CARRIER = 24e9  # Hz, Section 2


def printed_evidence() -> dict[str, object]:
    """Return evidence by the id of the claim, see `evidence`."""
    return (
        _sensors() | _table2() | _figure4() | _figure6() | _chi_square() | _window() | _covariance()
    )


def _sensors():
    s = reported().scenario
    return {
        "sensitivity": 2 * _CARRIER / _SPEED_OF_LIGHT,
        "unit-of-acceleration": -2.0,  # the power of the second
        "state-from-constant": float(np.linalg.matrix_rank(doppler_jacobian(s.x0, s.array))),
        "poor-observability": float(
            np.sqrt(np.trace(crlb(s.x0, s.array, s.sigma_f, 10, s.T, "constant_velocity")[:3, :3]))
        ),
        "many-measurements": float(samples_needed(0.01)),
    }


def _table2():
    s, table, drawn = reported().scenario, reported().table2, reported().figure6
    error, error_drawn = table.x_ml - s.x0, drawn.start - s.x0
    return {
        "table2-position-norm": float(np.linalg.norm(error[:3])),
        "table2-velocity-norm": float(np.linalg.norm(error[3:])),
        "start-drawn": float(drawn.start[0]),
        "first-z-error": 100 * float(drawn.first_error[2]),
        "start-likely": Readings(
            {
                "start of Table 2": start_misfit(table.x_ml, rounding=0.0005) / 2,
                "start as drawn": start_misfit(drawn.start, rounding=0.0005) / 2,
            }
        ),
        "nees-small": float(error_drawn @ np.linalg.solve(s.P0, error_drawn)),
        "final-true": s.truth[-1, :3],
    }


def _figure4():
    drawn = reported().figure4
    return {
        "figure4-dots": float(drawn.position.shape[1]),
        "figure4-position": float(drawn.position.max()),
        "figure4-velocity": float(drawn.velocity.max()),
    }


def _figure6():
    drawn = reported().figure6
    lower, upper = chi2_interval(6)
    inside = (lower <= drawn.nis) & (drawn.nis <= upper)
    estimated = np.array(reported().quoted.final_estimated_position_m)
    # What is unknown lies above the axis and before the second tenth.
    squared = np.nansum(drawn.error[1:] ** 2, axis=-1)
    tenths = np.sqrt(squared.reshape(10, -1).mean(axis=-1))
    average = np.nanmean(drawn.error, axis=0)
    return {
        "nis-average-drawn": float(drawn.nis.mean()),
        "nis-inside-drawn": 100 * float(inside.mean()),
        "final-errors-drawn": 100 * drawn.error[-1],
        "final-estimate-near": 100
        * float(np.linalg.norm(estimated - reported().scenario.truth[-1, :3])),
        "decreasing-drawn": float(np.max(tenths[1:] / tenths[:-1])),
        "z-worst-drawn": float(average[2] / max(average[:2])),
    }


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


def _window():
    """Return the mean of ten samples minus the first, in standard errors of the mean."""
    s, p = reported().scenario, reported().figure3
    states = np.zeros((len(p.x), len(p.y), 6))
    states[..., 0], states[..., 1] = p.x[:, None], p.y
    states[..., 3:] = p.velocity
    apart = np.linalg.norm(states[..., None, :3] - p.array.positions, axis=-1).min(axis=-1)
    drift = _drift(states[apart > 1e-9], p.array, p.T, p.sigma_f)
    return {
        "constant-table2": float(_drift(s.x0[None], s.array, s.T, s.sigma_f)[0]),
        "constant-figure3": float(np.median(drift)),
    }


def _drift(x, array, T, sigma_f, samples=10):
    path = np.repeat(x[:, None], samples, axis=1)
    path[..., :3] += T * np.arange(samples)[:, None] * path[..., 3:]
    h = doppler_shift(path, array)
    return np.abs(h.mean(axis=1) - h[:, 0]).max(axis=-1) / (sigma_f / samples**0.5)


def _covariance():
    """Return the variance of one axis as estimated from the maps of Fig 3, in three ways."""
    p = reported().figure3
    error = np.where(p.below, 0.0, p.error)
    left, right = (panel[~np.isnan(panel)] ** 2 / 2 for panel in error)  # two axes, in a plane
    return {
        "covariance-from-figure3": Readings(
            {
                "mean, left map": float(left.mean()),
                "mean, right map": float(right.mean()),
                "median, left map": float(np.median(left)),
            }
        )
    }
