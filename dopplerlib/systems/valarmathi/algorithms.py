"""The five algorithms of the document, and a sixth that models the age of its measurements."""

from typing import Annotated, Literal

import numpy as np

from ... import _checks
from ..._hints import Runs, checked
from ..._records import record
from ..._typing import BoolArray, FloatArray
from ...signal.synthesis import iq_from_velocity
from .error_measures import _titled, run_measures
from .published import reported
from .velocity_filter import VelocityTrack, _decibels, filter_velocity
from .velocity_paths import PathName, VelocityPath, velocity_path
from .window_choice import WindowTable, cumulative_error
from .window_transform import FilteredDoppler, doppler_filter

ALGORITHMS = {
    1: "1 Kalman filter",
    2: "2 adaptive window",
    3: "3 two filters, fused",
    4: "4 two adaptive, fused",
    5: "5 fused, then adaptive",
    6: "6 knows the delay",
}


Number = Literal[1, 2, 3, 4, 5, 6]  # of an algorithm
Sensor = Literal[1, 2]
Phase = Literal["all", "maneuver", "steady", "constant"]


@checked
@record
class AlgorithmRuns:
    """Runs of all algorithms on the same samples of two sensors.

    path: The truth.
    snr_db: Signal-to-noise ratio of a sample in dB.
    doppler: Measurements of both sensors.
    fixed: Filters with one window: algorithms 1 and 3.
    own: Filters that choose their windows by themselves: 2 and 4.
    shared: Filters that choose by the fused state: 5.
    delayed: Filters with one window that know its delay: 6.
    """

    path: VelocityPath
    snr_db: Annotated[float, _decibels]
    doppler: FilteredDoppler
    fixed: VelocityTrack
    own: VelocityTrack
    shared: VelocityTrack
    delayed: VelocityTrack

    def __post_init__(self):
        """Check that the tracks are of one path and of the same runs."""
        runs, count = len(self.fixed.x), len(self.path.time) - self.fixed.first
        for name in ("fixed", "own", "shared", "delayed"):
            one = getattr(self, name)
            if one.x.shape != (runs, 2, count, 2) or one.fused_x.shape != (runs, count, 2):
                raise ValueError(
                    f"{name} must have x of shape {(runs, 2, count, 2)}, got {one.x.shape}"
                )

    @property
    def time(self) -> FloatArray:
        """Times of the estimates in s, shape (K,)."""
        return self.path.time[self.fixed.first :]

    @property
    def truth(self) -> FloatArray:
        """True velocities then in m/s, shape (K,)."""
        return self.path.v[self.fixed.first :]

    @checked
    def velocity(self, algorithm: Number, sensor: Sensor = 1) -> FloatArray:
        """Return the velocities in m/s, shape (runs, K), of an algorithm from 1 to 6.

        `sensor` is the one whose filter is meant, of those with one sensor: 1, 2 and 6.
        """
        if algorithm in (1, 2, 6):
            track = {1: self.fixed, 2: self.own, 6: self.delayed}[algorithm]
            return track.x[:, sensor - 1, :, 0]
        return {3: self.fixed, 4: self.own, 5: self.shared}[algorithm].fused_x[..., 0]

    @checked
    def during(self, phase: Phase) -> BoolArray:
        """Return which estimates count: in "all", a "maneuver", a "steady" one, or "constant"."""
        masks = {
            "all": self.path.scored,
            "maneuver": self.path.maneuver,
            "steady": self.path.steady,
            "constant": self.path.constant,
        }
        return masks[phase][self.fixed.first :]

    @checked
    def measures(self, algorithm: Number, sensor: Sensor = 1) -> dict[str, FloatArray]:
        """Return the measures of every run, see `run_measures`."""
        return run_measures(self.path, self.velocity(algorithm, sensor))

    def cee(self, algorithm: Number, sensor: Sensor = 1) -> FloatArray:
        """Return the document's running error, counted from the first scored sample.

        Shape (runs, K').
        """
        scored = self.during("all")
        return cumulative_error(self.truth[scored], self.velocity(algorithm, sensor)[:, scored])

    def summary(self) -> dict[str, dict[str, FloatArray]]:
        """Return, by the name of the algorithm, errors and delay of each run by what they are.

        Delays are in halves of the fixed window.
        """
        return {name: _titled(self.measures(number)) for number, name in ALGORITHMS.items()}


@checked
def run_algorithms(
    name: PathName,
    snr_db: Annotated[float, _decibels],
    runs: Runs,
    table: WindowTable,
    *,
    rng: np.random.Generator,
) -> AlgorithmRuns:
    """Run all algorithms on the same samples.

    name: See `velocity_path`.
    snr_db: Signal-to-noise ratio of a sample in dB, the same for both sensors.
    runs: Number of independent records.
    table: For the choice of windows.
    rng: Source of randomness; every run has a child of its own, so that the first runs are the same
        however many follow.

    Examples
    --------
    >>> cee = np.array([[[1.0, 2.0], [2.0, 1.0]], [[1.0, 2.0], [1.0, 2.0]]])
    >>> table = WindowTable([0, 10], [0, 20], [8, 64], cee)
    >>> runs = run_algorithms("path 2", 15.0, 1, table, rng=np.random.default_rng(1))
    >>> runs.measures(1)["whole"].shape, runs.cee(4).shape, len(runs.summary())
    ((1,), (1, 4760), 6)
    """
    path, own, said = velocity_path(name), reported().chosen, reported().stated
    both = np.stack([path.v, path.v])
    x = np.stack([
        iq_from_velocity(both, said.T, own.wavelength, snr_db, rng=child)
        for child in rng.spawn(_checks.count("runs", runs, 10**4))
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


@checked
def operations(algorithm: Number) -> int:
    """Return the real additions and multiplications of an algorithm for each sample.

    algorithm: From 1 to 6.

    Notes
    -----
    Of its blocks: a padded transform takes some 5 N log2 N operations and the magnitudes 3 N; the
    parabola, one step of a filter with two states, the choice of a window, and the fusion take some
    tens. What a sensor does, two sensors do twice.

    Examples
    --------
    >>> operations(3) > 2 * operations(1)
    True
    """
    n = int(reported().chosen.nfft)
    blocks = {"transform": round(5 * n * np.log2(n)) + 3 * n, "parabola": 8, "filter": 40}
    sensor = sum(blocks.values()) + 20 * (algorithm in (2, 4, 5))
    return 2 * sensor + 50 if algorithm in (3, 4, 5) else sensor
