"""Evidence from the published settings and formulas of the thesis, without a simulation."""

import numpy as np

from ....estimation.linear_kalman import kf
from ....estimation.radial_velocity import radial_velocity_terms
from ....model.range_rate import range_rate, range_rate_jacobian
from ....replication.evidence import sweep
from ..cartesian_tracker import range_and_angle_jacobian
from ..expected_error import error_area, one_scan_bound
from ..noise import noise_std, resolutions, snr
from ..published import reported
from ..scene import maneuver_track, radar_positions, scan_times, straight_track
from ..settings import filter_settings
from ._ratios import choices, ends


def settings_and_formulas():
    """Return the evidence that follows from the published settings and formulas alone."""
    s, q = reported().scenario, reported().quoted
    n = s.noise
    code = filter_settings("code")
    corner = np.abs(error_area(snr_db=s.error_area.snr) - s.error_area.position)
    front = s.error_area.position
    wavelengths = {
        "c / f": n.speed_of_light / n.frequency,
        "of the code": q.noise.wavelength_code,
        "published": q.noise.wavelength_published,
    }
    at = np.hypot(*(np.array(front) - radar_positions()).T)
    return {
        "range-variance": float(code.R(1.0)[0]),
        "process-noise": np.diag(code.Q),
        "wavelength": wavelengths["c / f"],
        "velocity-resolution": sweep(
            choices("wavelength"), lambda name: wavelengths[name] / (2 * n.integration)
        ),
        "range-resolution": resolutions()[0],
        "range-resolution-formula": sweep(
            choices("exponent"), lambda sign: n.speed_of_light * 10.0 ** int(sign) / 2
        ),
        "snr-at-one": float(snr(1.0)),
        "speed": float(np.hypot(*s.tracks.velocity)),
        "straight-end": float(np.hypot(*straight_track([s.tracks.duration])[0, :2])),
        **sweep(choices("turn-frame", "turn-length", "turn-time"), _end_of_the_turn),
        "both-axes": float(np.hypot(q.range.axis, q.range.axis)),
        "error-area": corner.max(axis=0),
        "error-area-snr": float(snr(at).mean()),
        "shared-integration": 1 - s.tracks.T / n.integration,
        "R2-approaches": float(range_rate(straight_track([0.0]), radar_positions())[0, 1, 1]),
        "R1-distance": sweep(choices("time-R1"), lambda time: _range_at(0, time)),
        "R2-distance": _range_at(1, q.departure.R2_time),
        "gate-grows": sweep(choices("uncertainty"), _gate_growth_of),
        "directional-cosine": _printed_cosine(),
        "extra-variance": sweep(choices("state"), _extra_variance_ratio),
        "pseudo-innovation": _printed_pseudo_innovation(),
        "table-3-2": _printed_angle_innovation(),
        "difference-bias": sweep(choices("rate-over"), _difference_bias),
        "closest-radar": _influence_ratio(),
        "radars-far-apart": sweep(choices("in-front"), _far_apart),
        "radars-too-close": sweep(choices("too-close"), _too_close),
        "below-ten-db": sweep(choices("value", "below", "spread"), _noise_below),
        "filter-first-simpler": 2 * 2**3 / 4**3,
        "offset-at-four": sweep(choices("delay", "walk-time"), _late_at_four),
    }


def gate_growth(own, early=2, late=450):
    """Return the half-width of the published gate at a late scan over that at an early one.

    own: Settings of the filter.
    early, late: Scans that are compared; between them the last hundred have no measurement.
    Returns: Half-width at `late` over that at `early`.

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


def _gate_growth_of(uncertainty):
    if uncertainty == "the filter is less certain":
        return gate_growth(filter_settings("text"))
    f = reported().scenario.filter
    # The published half-width, with twice the deviation of the measurement; S cancels.
    once, twice = (np.sqrt(f.c * factor * f.sigma_range) for factor in (1, 2))
    return float(twice / once)


def _end_of_the_turn(frame, length, time):
    end = maneuver_track([length], ends(time))[0, :2]
    shown = end if frame == "as defined" else np.abs(end)[::-1]
    return {"maneuver-end": shown, "maneuver-distance": float(np.hypot(*end))}


def _error(position, baseline=None):
    """Return the least root mean square error of a position from one scan."""
    return float(np.sqrt(np.trace(one_scan_bound(position, baseline))))


def _far_apart(y):
    return _error([0.0, y], reported().quoted.radars.far_apart) / _error([0.0, y])


def _too_close(baseline):
    front = reported().scenario.error_area.position
    return _error(front, baseline) / _error(front)


def _noise_below(value, decibels, spread):
    """Return the error of a range, or of a position in front, where the ratio is so low."""
    n = reported().scenario.noise
    d = (n.snr_at_zero - decibels) / n.snr_slope
    front = [0.0, np.sqrt(d**2 - (reported().scenario.radars.baseline / 2) ** 2)]
    return spread * (float(noise_std(d)[0]) if value == "range" else _error(front))


def _late_at_four(delay, walk_time):
    """Return the error of x on a walk along y if radar 2 measures later and nothing is noisy."""
    s = reported().scenario.real
    far = reported().quoted.real.turned_at
    speed, b = (far - s.start[1]) / walk_time, s.baseline
    first, second = (np.hypot(b / 2, 4.0 + dt * speed) for dt in (0.0, delay))
    return float((second**2 - first**2) / (2 * b))


def _influence_ratio():
    """Return the sensitivity of a position to the far radar's range over that to the near one's."""
    p = np.array([*reported().quoted.range.compared, 0.0, 0.0])
    follows = np.linalg.inv(range_rate_jacobian(p, radar_positions())[:, 0, :2])
    far, near = np.linalg.norm(follows, axis=0)
    return round(float(far / near), 9)


def _printed_cosine():
    Y = np.array(reported().quoted.range.compared)
    return float(np.linalg.norm(np.sqrt(Y @ Y) * Y))


def _example(time):
    """Return a state on the straight track, and a covariance."""
    return straight_track([time])[0], np.diag([0.2, 0.1, 0.05, 0.1]) ** 2


def _extra_variance_ratio(state):
    x, P = _example(float(state.split()[1]))
    right, published = (
        radial_velocity_terms(x, P, 1.0, variance=name).R[0, 0] - 1.0
        for name in ("corrected", "published")
    )
    return float(published / right)


def _printed_pseudo_innovation():
    """Return the innovation of Eq 3.25 for a measurement that is exactly as predicted."""
    x, P = _example(reported().scenario.tracks.duration / 2)
    terms = radial_velocity_terms(x, P, 1.0)
    return float(terms.predicted[0] - np.trace(terms.C))


def _printed_angle_innovation():
    """Return alpha - H x, the innovation of Table 3.2 for an angle exactly as predicted."""
    x, _ = _example(reported().scenario.tracks.duration / 2)
    return float(np.arctan2(x[1], x[0]) - range_and_angle_jacobian(x)[1] @ x)


def _difference_bias(scans):
    """Return the size of the error of a differenced rate, in its standard deviations."""
    T = reported().scenario.tracks.T
    d = range_rate(straight_track(scan_times()), radar_positions()[:1])[:, 0]
    off = np.abs(np.diff(d[:, 0]) / T - d[:-1, 1]) / noise_std(d[:-1, 0])[:, 1]
    return float(off.max() if scans == "worst scan" else np.median(off))
