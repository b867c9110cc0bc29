"""Evidence from the printed settings and formulas of the thesis, without a simulation."""

import numpy as np

from ....estimation.linear_kalman import kf
from ....estimation.radial_velocity import radial_velocity_terms
from ....model.range_rate import range_rate, range_rate_jacobian
from ....replication.evidence import Readings
from ..cartesian_tracker import range_and_angle_jacobian
from ..expected_error import error_area, one_scan_bound
from ..noise import noise_std, resolutions, snr
from ..published import reported
from ..scene import maneuver_track, radar_positions, straight_track
from ..settings import filter_settings


def settings_and_formulas():
    """Return the evidence that follows from the printed settings and formulas alone.

    Returns
    -------
    dict
    """
    s, q = reported().scenario, reported().quoted
    n = s.noise
    code, text = filter_settings("code"), filter_settings("text")
    ends = [track(np.array([s.tracks.duration]))[0, :2]
            for track in (straight_track, maneuver_track)]  # fmt: skip
    corner = np.abs(error_area(snr_db=s.error_area.snr) - s.error_area.position)
    front = s.error_area.position
    wavelengths = {
        "c / f": n.speed_of_light / n.frequency,
        "code": q.noise.wavelength_code,
        "printed": q.noise.wavelength_printed,
    }
    velocities = {name: one / (2 * n.integration) for name, one in wavelengths.items()}
    at = np.hypot(*(np.array(front) - radar_positions()).T)
    return {
        "range-variance": float(code.R(1.0)[0]),
        "process-noise": np.diag(code.Q),
        "wavelength": wavelengths["c / f"],
        "velocity-resolution": Readings(velocities),
        "range-resolution": resolutions()[0],
        "range-resolution-formula": n.speed_of_light * 10.0**q.noise.pulse_exponent_printed / 2,
        "snr-at-one": float(snr(1.0)),
        "speed": float(np.hypot(*s.tracks.velocity)),
        "straight-end": float(np.hypot(*ends[0])),
        "maneuver-end": ends[1],
        "maneuver-distance": float(np.hypot(*ends[1])),
        "both-axes": float(np.hypot(q.range.axis, q.range.axis)),
        "error-area": corner.max(axis=0),
        "error-area-snr": float(snr(at).mean()),
        "shared-integration": 1 - s.tracks.T / n.integration,
        "R2-approaches": float(range_rate(straight_track([0.0]), radar_positions())[0, 1, 1]),
        "R1-distance": _range_at(0, q.departure.R1_time),
        "R2-distance": _range_at(1, q.departure.R2_time),
        "gate-grows": gate_growth(text),
        "directional-cosine": _printed_cosine(),
        "extra-variance": _extra_variance_ratio(),
        "pseudo-innovation": _printed_pseudo_innovation(),
        "table-3-2": _printed_angle_innovation(),
        "difference-bias": _difference_bias(),
        "baseline": float(np.sqrt(_across(s.real.baseline) / _across(None))),
        "closest-radar": _influence_ratio(),
    }


def gate_growth(own, early=2, late=450):
    """Return the half-width of the printed gate at a late scan over that at an early one.

    Parameters
    ----------
    own : Settings
        Settings of the filter.
    early, late : int
        Scans that are compared; between them the last hundred have no measurement.

    Returns
    -------
    float
        Half-width at `late` over that at `early`.

    Notes
    -----
    Eqs 4.3 and 4.6: an innovation passes if its square over S is below c sigma over S.
    """
    f = reported().scenario.filter
    c, sigma = f.c, f.sigma_range
    F = np.array([[1.0, own.T], [0.0, 1.0]])
    z = np.zeros((late + 1, 2))
    z[late - 100 :] = np.nan
    track = kf(z, F, own.Q, np.eye(2), np.diag(own.R(1.0)), np.zeros(2), own.P0)
    S = track.S[[early, late], 0, 0]
    before, after = np.sqrt(c * sigma / S * S)
    return round(float(after / before), 9)


def _range_at(radar, time):
    return float(range_rate(straight_track([time]), radar_positions())[0, radar, 0])


def _across(baseline):
    return one_scan_bound(reported().scenario.error_area.position, baseline)[0, 0]


def _influence_ratio():
    """Return the sensitivity of a position to the far radar's range over that to the near one's."""
    p = np.array([*reported().quoted.range.compared, 0.0, 0.0])
    follows = np.linalg.inv(range_rate_jacobian(p, radar_positions())[:, 0, :2])
    far, near = np.linalg.norm(follows, axis=0)
    return round(float(far / near), 9)


def _printed_cosine():
    Y = np.array(reported().quoted.range.compared)
    return float(np.linalg.norm(np.sqrt(Y @ Y) * Y))


def _example():
    """Return a state in the plane and its covariance, in the middle of the straight track."""
    x = straight_track([reported().scenario.tracks.duration / 2])[0]
    return x, np.diag([0.2, 0.1, 0.05, 0.1]) ** 2


def _extra_variance_ratio():
    x, P = _example()
    right, printed = (
        radial_velocity_terms(x, P, 1.0, variance=name).R[0, 0] - 1.0
        for name in ("corrected", "printed")
    )
    return float(printed / right)


def _printed_pseudo_innovation():
    """Return the innovation of Eq 3.25 for a measurement that is exactly as predicted."""
    x, P = _example()
    terms = radial_velocity_terms(x, P, 1.0)
    return float(terms.predicted[0] - np.trace(terms.C))


def _printed_angle_innovation():
    """Return alpha - H x, the innovation of Table 3.2 for an angle exactly as predicted."""
    x, _ = _example()
    return float(np.arctan2(x[1], x[0]) - range_and_angle_jacobian(x)[1] @ x)


def _difference_bias():
    """Return the error of a differenced rate at the first scan, in noise standard deviations."""
    T = reported().scenario.tracks.T
    first, second = range_rate(straight_track([0.0, T]), radar_positions()[:1])[:, 0]
    return float(((second[0] - first[0]) / T - first[1]) / noise_std(first[0])[1])
