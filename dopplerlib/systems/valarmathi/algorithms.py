"""The five algorithms of the document, and a sixth that knows how old its measurements are."""

import numpy as np

from ... import _checks
from ..._records import record
from ...signal.synthesis import iq_from_velocity
from .doppler_filter import FilteredDoppler, doppler_filter
from .filters import VelocityTrack, filter_velocity
from .published import VelocityPath, chosen, stated, velocity_path
from .windows import cumulative_error

ALGORITHMS = {
    1: "1 Kalman filter",
    2: "2 adaptive window",
    3: "3 two filters, fused",
    4: "4 two adaptive, fused",
    5: "5 fused, then adaptive",
    6: "6 knows the delay",
}


@record
class AlgorithmRuns:
    """Runs of all algorithms on the same samples of two sensors.

    Attributes
    ----------
    path : VelocityPath
        The truth.
    snr_db : float
        Signal-to-noise ratio of a sample in dB.
    doppler : FilteredDoppler
        Measurements of both sensors.
    fixed : VelocityTrack
        Filters with one window: algorithms 1 and 3.
    own : VelocityTrack
        Filters that choose their windows by themselves: 2 and 4.
    shared : VelocityTrack
        Filters that choose by the fused state: 5.
    delayed : VelocityTrack
        Filters with one window that know its delay: 6.
    """

    path: VelocityPath
    snr_db: float
    doppler: FilteredDoppler
    fixed: VelocityTrack
    own: VelocityTrack
    shared: VelocityTrack
    delayed: VelocityTrack

    @property
    def time(self):
        """Times of the estimates in s, shape (K,)."""
        return self.path.time[self.fixed.first :]

    @property
    def truth(self):
        """True velocities then in m/s, shape (K,)."""
        return self.path.v[self.fixed.first :]

    def velocity(self, algorithm, sensor=1):
        """Return the velocities in m/s, shape (runs, K), of an algorithm from 1 to 6.

        `sensor` is the one whose filter is meant, of those with one sensor: 1, 2 and 6.
        """
        _checks.one_of("algorithm", algorithm, tuple(ALGORITHMS))
        if algorithm in (1, 2, 6):
            track = {1: self.fixed, 2: self.own, 6: self.delayed}[algorithm]
            return track.x[:, _checks.one_of("sensor", sensor, (1, 2)) - 1, :, 0]
        return {3: self.fixed, 4: self.own, 5: self.shared}[algorithm].fused_x[..., 0]

    def during(self, phase):
        """Return which estimates count: in "all", a "maneuver", a "steady" one, or "constant"."""
        masks = {
            "all": self.path.scored,
            "maneuver": self.path.maneuver,
            "steady": self.path.steady,
            "constant": self.path.constant,
        }
        return masks[_checks.one_of("phase", phase, tuple(masks))][self.fixed.first :]

    def rmse(self, algorithm, phase="all", sensor=1):
        """Return the root mean square error of each run in m/s, shape (runs,); see `during`."""
        error = (self.velocity(algorithm, sensor) - self.truth)[:, self.during(phase)]
        return np.sqrt(np.mean(error**2, axis=-1))

    def cee(self, algorithm, sensor=1):
        """Return the document's running error, counted from the first scored sample.

        Shape (runs, K').
        """
        scored = self.during("all")
        return cumulative_error(self.truth[scored], self.velocity(algorithm, sensor)[:, scored])

    def delay(self, algorithm, sensor=1):
        """Return by how much each run is late in a steady maneuver, in s, shape (runs,)."""
        steady = self.during("steady")
        a = self.path.a[self.fixed.first :][steady]
        error = (self.velocity(algorithm, sensor) - self.truth)[:, steady]
        # A velocity that is late by d errs by -a d: least squares.
        return -error @ a / (a @ a)

    def summary(self):
        """Return, by the name of the algorithm, errors and delay of each run by what they are.

        Delays are in halves of the fixed window.
        """
        half = (chosen().fixed_window - 1) / 2 * stated().T
        return {
            name: {
                "maneuver (m/s)": self.rmse(number, "maneuver"),
                "constant velocity (m/s)": self.rmse(number, "constant"),
                "whole record (m/s)": self.rmse(number),
                "delay (half windows)": self.delay(number) / half,
            }
            for number, name in ALGORITHMS.items()
        }


def run_algorithms(name, snr_db, runs, table, *, rng):
    """Run all algorithms on the same samples.

    Parameters
    ----------
    name : {"path 1", "path 2", "fighter"}
        See `velocity_path`.
    snr_db : float
        Signal-to-noise ratio of a sample in dB, the same for both sensors.
    runs : int
        Number of independent records.
    table : WindowTable
        For the choice of windows.
    rng : numpy.random.Generator
        Source of randomness; every run has a child of its own, so that the first runs are the
        same however many follow.

    Returns
    -------
    AlgorithmRuns

    Raises
    ------
    ValueError
        If `name` is unknown or another argument is refused by what it is for.
    """
    path, own, said = velocity_path(name), chosen(), stated()
    both = np.stack([path.v, path.v])
    x = np.stack([
        iq_from_velocity(both, said.T, own.wavelength, snr_db, rng=child)
        for child in rng.spawn(_checks.whole_number("runs", runs))
    ])  # fmt: skip
    doppler = doppler_filter(x, table.windows)
    return AlgorithmRuns(
        path,
        snr_db,
        doppler,
        filter_velocity(doppler, snr_db),
        filter_velocity(doppler, snr_db, table=table, feedback="own"),
        filter_velocity(doppler, snr_db, table=table, feedback="fused"),
        filter_velocity(doppler, snr_db, delayed=True),
    )
