"""Links between a target and sensors that move: one way, two ways, bistatic, with clocks."""

from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self, get_args

import numpy as np

from .. import _checks
from .._hints import Count, between, checked
from .._records import record
from .._typing import ArrayLike, FloatArray
from . import _link_fields
from .motion import constant_velocity
from .radar_array import RadarArray

ClockModel = Literal["constant", "drift", "epoch"]
_Deviation = Annotated[float, between(0, 1e60)]


@record
class DopplerLinks:
    """Links that measure Doppler shifts of one target, each with its own ends and wavelength.

    `RadarArray` is the simple case: sensors that stand still and share a known wavelength.

    Parameters
    ----------
    receivers : array_like, shape (N, 6), (N, 3) or (K, N, 6)
        States [x, y, z, v_x, v_y, v_z] of the receivers in m and m/s: at time zero, from where they
        go straight; positions alone stand still; or states at all of `times`.
    transmitters : array_like, shape (N, 6), (N, 3) or (K, N, 6), or None
        The same of the transmitters; None if the target itself sends. One state, or axes of
        length one, broadcast against the receivers, and the other way round.
    wavelength : array_like, broadcast to (N,)
        Wavelength in m.
    bias : array_like, broadcast to (N,) or (K, N)
        Known offset of the measured frequency in Hz.
    clocks : {None, "common", "each"} or array_like, shape (N,) or (N, C)
        Unknown offsets of frequency, which follow the six components of the target in the state.
        None: there are none. "common": one that all links share. "each": one for each link. Whole
        numbers (N,): the clock of each link. A matrix: Hz at each link for 1 Hz of each offset.
    clock_model : {"constant", "drift", "epoch"}
        "constant": an offset stays. "drift": it changes at a constant rate; rates in Hz/s, one for
        each offset, follow the offsets in the state. "epoch": it is another one at each sample.
    times : array_like, shape (K,), optional
        Times of the samples in s, increasing; intervals may differ.

    Raises
    ------
    ValueError
        If a shape or a number does not fit, or times are missing where states over time are given.

    Notes
    -----
    Mittermaier et al. (2016), Eq 2; derived in `dopplerlib.derive.links`. A link measures

    h = -(rate of the path's length) / wavelength + bias + clocks offsets,

    positive when the path gets shorter. The path has one leg if the target sends, or if the sensors
    send and it listens. Otherwise it has two, and a radar is the case of transmitters that are
    receivers. Terms of second order in v / c are left out: of the shift some 1e-7 for a car, 1e-5
    for satellites. A state belongs to the moment at which the wave leaves or arrives there; all
    may be relative to the earth, which rotates.

    An unknown carrier is an offset only if two oscillators are compared. A radar that sends and
    listens with one has no offset but a wavelength that is wrong by some factor. From one sample
    that is the same as a wrong speed; in time a straight flight scaled as a whole, with its
    distance, fits as well, but for the known size of the array. So no state stands for it.

    Examples
    --------
    A satellite heard by two stations, whose receivers are off by a common unknown frequency:

    >>> stations = [[6371e3, 0, 0], [6371e3, 1000e3, 0]]
    >>> links = DopplerLinks.one_way(stations, wavelength=0.68, clocks="common")
    >>> len(links), links.n
    (2, 7)
    """

    receivers: np.ndarray
    transmitters: np.ndarray | None
    wavelength: np.ndarray = 0.0125  # type: ignore[assignment]  # the check makes arrays of these
    bias: np.ndarray = 0.0  # type: ignore[assignment]
    clocks: np.ndarray = None  # type: ignore[assignment]
    clock_model: ClockModel = "constant"
    times: np.ndarray | None = None

    if TYPE_CHECKING:  # what a field holds is an array, what makes it need not be

        def __init__(
            self,
            receivers: ArrayLike,
            transmitters: ArrayLike | None,
            wavelength: ArrayLike = 0.0125,
            bias: ArrayLike = 0.0,
            clocks: Literal["common", "each"] | ArrayLike | None = None,
            clock_model: ClockModel = "constant",
            times: ArrayLike | None = None,
        ) -> None: ...

    def __post_init__(self):
        """Check the fields, and give all of them their full shape."""
        model = _checks.one_of("clock_model", self.clock_model, get_args(ClockModel))
        times = None if self.times is None else _link_fields.increasing(self.times)
        ends = [_link_fields.ends("receivers", self.receivers, times)]
        if self.transmitters is not None:
            ends.append(_link_fields.ends("transmitters", self.transmitters, times))
            _checks.check_leading(receivers=(ends[0], 1), transmitters=(ends[1], 1))
            ends = np.broadcast_arrays(*ends)
        lead = ends[0].shape[:-1]
        wavelength = _checks.moderate("wavelength", _checks.positive("wavelength", self.wavelength))
        _checks.moderate("1 / wavelength", 1 / wavelength)
        bias = _checks.moderate("bias", self.bias)
        return {
            "receivers": ends[0].copy(),
            "transmitters": None if self.transmitters is None else ends[1].copy(),
            "wavelength": _checks.each_run("wavelength", wavelength, lead[-1:], ()).copy(),
            "bias": _checks.each_run("bias", bias, lead[-max(bias.ndim, 1) :], ()).copy(),
            "clocks": _link_fields.clock_matrix(self.clocks, lead[-1]),
            "clock_model": model,
            "times": times,
        }

    def __len__(self):
        """Return the number of links N."""
        return len(self.wavelength)

    @property
    def n(self) -> int:
        """Number of components of the state, six of the target, offsets, and their rates."""
        return 6 + self.clocks.shape[1] * (2 if self.clock_model == "drift" else 1)

    @property
    def legs(self) -> tuple[tuple[FloatArray, FloatArray], ...]:
        """States of the sensors (..., N, 6) and Hz per m/s (N,) of one leg, or of two."""
        if self.transmitters is None:
            return ((self.receivers, 1 / self.wavelength),)
        if np.array_equal(self.receivers, self.transmitters):
            return ((self.receivers, 2 / self.wavelength),)
        return tuple((end, 1 / self.wavelength) for end in (self.receivers, self.transmitters))

    @classmethod
    @checked
    def one_way(cls, receivers: ArrayLike, wavelength: ArrayLike, **rest: Any) -> Self:
        """Return links of one leg: the target sends, or it hears the sensors.

        Parameters
        ----------
        receivers, wavelength
            See `DopplerLinks`.
        **rest
            The other fields.

        Examples
        --------
        >>> DopplerLinks.one_way([[0, 0, 0]], 0.2).legs[0][1].tolist()
        [5.0]
        """
        return cls(receivers, None, wavelength, **rest)

    @classmethod
    @checked
    def two_way(cls, receivers: ArrayLike, wavelength: ArrayLike = 0.0125, **rest: Any) -> Self:
        """Return links of radars, each of which hears its own echo.

        Parameters
        ----------
        receivers, wavelength
            See `DopplerLinks`. The receivers are the transmitters, too.
        **rest
            The other fields.

        Examples
        --------
        >>> DopplerLinks.two_way([[0, 0, 0]]).legs[0][1].tolist()
        [160.0]
        """
        return cls(receivers, receivers, wavelength, **rest)

    @classmethod
    @checked
    def on_platform(
        cls,
        array: RadarArray,
        state: ArrayLike,
        rotation_rate: ArrayLike = (0.0, 0.0, 0.0),
        times: ArrayLike | None = None,
        **rest: Any,
    ) -> Self:
        """Return links of an array of radars on a platform that moves, and may turn.

        Parameters
        ----------
        array : RadarArray
            The N sensors, relative to the platform at time zero.
        state : array_like, shape (6,) or (K, 6)
            State of the platform in m and m/s: at time zero, from where it goes straight; or at
            all `times`.
        rotation_rate : array_like, shape (3,)
            Angular velocity in rad/s, constant, by the right-hand rule.
        times : array_like, shape (K,), optional
            Times of the samples in s. A platform that turns needs them.
        **rest
            The other fields of `DopplerLinks`.

        Examples
        --------
        A car at 10 m/s with a radar in each corner of its front, and a wall 20 m ahead:

        >>> from dopplerlib import doppler_shift
        >>> front = RadarArray([[0, -0.6, 0], [0, 0.6, 0]])
        >>> car = DopplerLinks.on_platform(front, [0, 0, 0, 10, 0, 0])
        >>> doppler_shift([20, 0, 0, 0, 0, 0], car).round(1).tolist()
        [1599.3, 1599.3]
        """
        state = _checks.moderate("state", state, (6,))
        rate = _checks.matrix("rotation_rate", [rotation_rate], (1, 3))[0]
        if times is None and (state.ndim > 1 or rate.any()):
            raise ValueError("times must be given for states over time and a turn, got None")
        arm, sensors = array.positions, state[..., None, :]
        if times is not None:
            from scipy.spatial.transform import Rotation

            times = _link_fields.increasing(times)
            sensors = _link_fields.ends("state", sensors, times)
            arm = arm @ Rotation.from_rotvec(times[:, None] * rate).as_matrix().mT
        places, velocities = sensors[..., :3] + arm, sensors[..., 3:] + np.cross(rate, arm)
        both = np.concatenate([places, velocities], axis=-1)
        return cls.two_way(both, array.wavelength, times=times, **rest)

    @checked
    def sampled(self, K: Count, T: ArrayLike = 0.001) -> Self:
        """Return the links at K samples, with the states of all ends at each.

        Parameters
        ----------
        K : int
            Number of samples.
        T : array_like, scalar or shape (K,)
            Sampling interval in s, or the interval before each sample, of which the first is
            without effect: the first sample is at time zero. Links that have times keep them.

        Examples
        --------
        >>> links = DopplerLinks.two_way([[0, 0, 0, 10, 0, 0]])
        >>> links.sampled(3, 0.5).receivers[:, 0, 0].tolist()
        [0.0, 5.0, 10.0]
        """
        times = sample_times(self, K, T)
        return self if self.times is not None else replace(self, times=times)

    @checked
    def at_sample(self, k: int | slice) -> Self:
        """Return the links of one sample, without times, or of a part of the samples.

        Parameters
        ----------
        k : int or slice
            Which of the `times`.

        Examples
        --------
        >>> links = DopplerLinks.two_way([[0, 0, 0, 10, 0, 0]], times=[0, 0.1, 0.5])
        >>> links.at_sample(2).receivers.tolist(), links.at_sample(slice(1, 3)).times.tolist()
        ([[5.0, 0.0, 0.0, 10.0, 0.0, 0.0]], [0.1, 0.5])
        """
        if self.times is None:
            raise ValueError("links must have times, got None")
        if not isinstance(k, slice) and not (_checks.is_whole(k) and -1 < k < len(self.times)):
            raise ValueError(f"k must be a slice or a sample below {len(self.times)}, got {k!r}")
        there = {
            name: value if value is None or value.ndim < least else value[k]
            for name, value, least in (
                ("receivers", self.receivers, 3),
                ("transmitters", self.transmitters, 3),
                ("bias", self.bias, 2),
                ("times", self.times, 1),
            )
        }
        if not isinstance(k, slice):
            there["times"] = None
        return replace(self, **there)

    @checked
    def transition(self, t: ArrayLike) -> FloatArray:
        """Return the transition matrix of the state over a time.

        Parameters
        ----------
        t : array_like, shape (...)
            Time in s, which may be zero or negative.

        Returns
        -------
        ndarray, shape (..., n, n)
            For a target at constant velocity. Nothing is carried over of an "epoch" clock.

        Examples
        --------
        >>> links = DopplerLinks.two_way([[0, 0, 0]], clocks="common", clock_model="drift")
        >>> links.transition(0.5)[6:, 6:].tolist()
        [[1.0, 0.5], [0.0, 1.0]]
        """
        t = _checks.moderate("t", t)[..., None, None]
        offsets = self.clocks.shape[1]
        F = np.eye(self.n) + t * np.eye(self.n, k=3) * (np.arange(self.n) < 3)[:, None]
        if self.clock_model == "drift":
            F += t * np.eye(self.n, k=offsets) * (np.arange(self.n) >= 6)[:, None]
        elif self.clock_model == "epoch":
            F[..., 6:, 6:] = 0
        return F

    @checked
    @_checks.quiet
    def motion(
        self,
        T: ArrayLike,
        sigma_a: float,
        noise: Literal["shared", "per_axis", "horizontal"] = "shared",
        sigma_clock: _Deviation = 0.0,
        sigma_drift: _Deviation = 0.0,
    ) -> tuple[FloatArray, FloatArray]:
        """Return transition matrix and process noise of target and clocks.

        Parameters
        ----------
        T : array_like, shape (...)
            Sampling intervals in s.
        sigma_a, noise
            See `constant_velocity`.
        sigma_clock : float
            By how much an offset wanders in one second, in Hz. Of "epoch" clocks the standard
            deviation of each new offset, before it is measured.
        sigma_drift : float
            By how much a rate wanders in one second, in Hz/s.

        Returns
        -------
        F, Q : ndarray, shape (..., n, n)
            Transition matrix and covariance of the process noise of each interval.

        Examples
        --------
        >>> links = DopplerLinks.two_way([[0, 0, 0]], clocks="common")
        >>> F, Q = links.motion(0.5, 1.0, sigma_clock=2.0)
        >>> float(Q[6, 6])
        2.0
        """
        _, target = constant_velocity(T, sigma_a, noise)
        T = _checks.deviation("T", T)
        F = self.transition(T)
        Q = np.zeros(F.shape)
        Q[..., :6, :6] = target
        T, one = T[..., None, None], np.eye(self.clocks.shape[1])
        last = 6 + len(one)
        if self.clock_model == "epoch":
            Q[..., 6:, 6:] = sigma_clock**2 * one
        else:
            Q[..., 6:last, 6:last] = (sigma_clock**2 * T) * one
        if self.clock_model == "drift":  # white noise in the rate, integrated once
            density = sigma_drift**2 * one
            Q[..., 6:last, 6:last] += T**3 / 3 * density
            Q[..., 6:last, last:] = Q[..., last:, 6:last] = T**2 / 2 * density
            Q[..., last:, last:] = T * density
        return F, _checks.estimates("T, sigma_clock, sigma_drift", Q, what="process noise")


def state_size(array: RadarArray | DopplerLinks) -> int:
    """Return the number of components of a state. The array is unchecked."""
    return array.n if isinstance(array, DopplerLinks) else 6


def sample_times(
    array: RadarArray | DopplerLinks, K: int | None, T: FloatArray | float
) -> FloatArray:
    """Return the times (K,) of samples at intervals `T`, the first of which is at zero.

    Links that have times keep them; `K`, one if it is None, has to fit. `array`, `K` are unchecked.
    """
    times = getattr(array, "times", None)
    if times is not None:
        if K not in (None, len(times)):
            raise ValueError(f"K must be the number of times of the links, {len(times)}, got {K}")
        return times
    T, K = _checks.moderate("T", _checks.positive("T", T)), 1 if K is None else K
    if not T.ndim:
        return np.arange(K) * T
    return np.append(0.0, np.cumsum(_checks.exact_shape("T", T, (K,))[1:]))
