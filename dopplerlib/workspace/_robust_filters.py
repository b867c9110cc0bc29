"""Trackers of the workspace that doubt: gates, weights, adaptive noise, several motions; unchecked.

Starts and filters are called as those of `_filters`.
"""

from ..estimation.extended_kalman import ekf
from ..estimation.gaussian_sum import gaussian_sum
from ..estimation.robust_kalman import robust_ekf
from ._filters import FIRST, in_state
from .targets import INTERVAL

PASSED = 0.999  # of right samples, by all gates but the paper's
PAPER = 0.95  # by that of Fig 6
# In m/s^2, of each axis, a thousand times in a second: in half of it velocities change by 9 mm/s,
# as the paper assumes, 9 cm/s, as in a turn, and 0.9 m/s, as in a strike.
MOTIONS = 0.4, 4.0, 40.0


def from_gated_bayes(z, s):
    """Return mean and covariance of the posterior of the first samples, with a gate."""
    found = gaussian_sum(z[:, :FIRST], *s.given, every=FIRST, gate_probability=PASSED)
    return FIRST, found.x[:, 0], found.P[:, 0]


def gated_bank(z, s):
    """Filter by the Gaussian sum with a gate."""
    found = gaussian_sum(z, *s.given, every=s.every, gate_probability=PASSED)
    return found.x, found.P


def moving_bank(z, s):
    """Filter by gated Gaussian sums for several accelerations, weighed by their evidence."""
    found = gaussian_sum(
        z, s.array, s.mean, s.P, INTERVAL, MOTIONS, s.sigma_f, every=s.every,
        gate_probability=PASSED,
    )  # fmt: skip
    return found.x, found.P


def gated(gate, probability=PASSED):
    """Return the extended filter with a gate that judges all sensors of a sample as one."""

    def follow(z, s, x, P):
        track = ekf(
            z, s.array, x, P, INTERVAL, s.sigma_a, s.sigma_f, noise="per_axis", gate=gate,
            gate_probability=probability, keep=("P",),
        )  # fmt: skip
        return track.x, track.P

    return follow


def robust(method):
    """Return the extended filter that weighs each measurement."""

    def follow(z, s, x, P):
        track = robust_ekf(z, *in_state(s), s.R, x, P, method, gate_probability=PASSED)
        return track.x, track.P

    return follow
