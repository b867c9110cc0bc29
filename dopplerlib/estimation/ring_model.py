"""Motion and Doppler shifts in ring coordinates, as the filters for any model take them."""

from typing import Literal

import numpy as np

from .. import _checks
from .._hints import Positive, checked
from .._records import record
from .._typing import ArrayLike, FloatArray
from ..kernels import ring_coordinates as kernel
from ..model.motion import dwna_gain
from ..model.radar_array import RadarArray
from . import covariances

_LEAST = 0.15  # of the radius: nearer to the plane of the sensors no state is taken
_FARTHEST = 46.0  # ln of rho in m
_CLEAR = 1e-3  # square of the distance of target and sensor over rho, at least
# Where the derivatives of the state by the coordinates are not zero, in the order of the kernel.
_SLOPES = [(0, 0), (0, 1), (0, 5), (1, 0), (1, 5), (2, 1), (2, 5), *((3, j) for j in range(6)),
           (4, 2), (4, 5), (5, 3), (5, 5)]  # fmt: skip


@checked
@record
class RingModel:
    """A target at nearly constant velocity before a plane array, in the coordinates of its ring.

    Its methods are the functions of `ekf_records` and `ukf`: `f`, `F`, `Q`, `h` and `H`. In these
    coordinates a filter cannot invent knowledge of range, wherever it linearizes.

    Parameters
    ----------
    array : RadarArray
        Sensors in the plane x = 0, not all of them in the origin. The target is at x > 0.
    T : float
        Sampling interval in s.
    sigma_a : float
        Standard deviation of the acceleration in m/s^2, see `constant_velocity`.
    noise : {"shared", "per_axis"}
        Process noise, see `constant_velocity`.

    Notes
    -----
    The coordinates are those of `to_ring_coordinates`, with the root of the sensors' mean squared
    distance from the origin as the radius r. Motion is that of the state, and exact; so is its
    Jacobian. The noise of the state is carried over by the derivatives of the coordinates at the
    end of the interval. A filter that is lost may come to coordinates that no state at 0.15 r or
    more before the plane has: they are taken for others, with a larger rho, or a smaller eta.

    Examples
    --------
    An iterated filter for a tenth of a second, from a prior that is broad:

    >>> from dopplerlib import doppler_shift, ekf_records
    >>> array = RadarArray.ring(6, 0.2)
    >>> path = np.tile([0.83, 0.11, 0.09, -0.75, -0.13, -0.02], (100, 1))
    >>> path[:, :3] += 1e-3 * np.arange(100)[:, None] * path[:, 3:]
    >>> z = doppler_shift(path, array) + 0.4 * np.random.default_rng(1).standard_normal((100, 6))
    >>> model = RingModel(array, T=1e-3, sigma_a=0.4)
    >>> prior = [0.8, 0, 0, -0.75, 0, 0], np.diag([0.2, 0.25, 0.25, 0.25, 0.25, 0.25]) ** 2
    >>> track = ekf_records(
    ...     z, model.f, model.F, model.Q, model.h, model.H, 0.16 * np.eye(6), *model.start(*prior),
    ...     iterations=3,
    ... )
    >>> x, P = model.state(track.x[-1], track.P[-1])
    >>> bool((np.abs(x - path[-1]) < 3 * np.sqrt(np.diag(P))).all())
    True
    """

    array: RadarArray
    T: Positive
    sigma_a: Positive
    noise: Literal["shared", "per_axis"] = "per_axis"

    def __post_init__(self):
        """Check the array."""
        ahead = self.array.positions[:, 0]
        if ahead.any() or not self.radius > 0:
            raise ValueError(
                "array must have its sensors in the plane x = 0, and not all in the origin, got x "
                f"= {ahead.tolist()}"
            )

    @property
    def radius(self) -> float:
        """Root mean squared distance of the sensors from the center in m, that of a ring."""
        return float(np.sqrt(np.mean(np.sum(self.array.positions**2, axis=-1))))

    @_checks.quiet
    def start(self, x0: ArrayLike, P0: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Return mean and covariance of the coordinates of Gaussian states.

        Parameters
        ----------
        x0 : array_like, shape (..., 6)
            Means in m and m/s.
        P0 : array_like, shape (..., 6, 6)
            Covariances.

        Returns
        -------
        ndarray, shape (..., 6)
        ndarray, shape (..., 6, 6)
        """
        x0, P0 = _checks.moderate("x0", x0, (6,)), _checks.covariance("P0", P0, 6, definite=False)
        _checks.check_leading(x0=(x0, 1), P0=(P0, 2))
        return _moments(self._coordinates_and_slopes, x0, P0, (0, 1, 2))

    @_checks.quiet
    def state(self, xi: ArrayLike, P: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Return mean and covariance of the states of Gaussian coordinates.

        Parameters
        ----------
        xi : array_like, shape (..., 6)
            Means of the coordinates.
        P : array_like, shape (..., 6, 6)
            Their covariances.

        Returns
        -------
        ndarray, shape (..., 6)
            In m and m/s.
        ndarray, shape (..., 6, 6)
        """
        xi, P = _checks.moderate("xi", xi, (6,)), _checks.covariance("P", P, 6, definite=False)
        _checks.check_leading(xi=(xi, 1), P=(P, 2))
        return _moments(self._state_and_slopes, xi, P, (0, 1, 5))

    @_checks.quiet
    def f(self, xi: ArrayLike) -> FloatArray:
        """Return coordinates (..., 6) after an interval, from those before it."""
        return self._coordinates(self._after(self._state(xi)))

    @_checks.quiet
    def F(self, xi: ArrayLike) -> FloatArray:
        """Return the derivatives (..., 6, 6) of `f`."""
        state, slopes = self._state_and_slopes(xi)
        v = state[..., 3:]
        by_speed = 2 * (v[..., None, :] @ slopes[..., 3:, :])[..., 0, :]
        *seen, ell = np.moveaxis(self._held(xi), -1, 0)
        rest = [np.exp(-ell), np.sum(v * v, axis=-1), *np.moveaxis(by_speed, -1, 0)]
        entries = kernel.moved(*seen, *rest, T=self.T)[6:]
        return np.stack(entries, axis=-1).reshape(*ell.shape, 6, 6)

    @_checks.quiet
    def Q(self, xi: ArrayLike) -> FloatArray:
        """Return the covariance (..., 6, 6) of the noise, from coordinates before the interval."""
        after = self._after(self._state(xi))
        at = [*np.moveaxis(after, -1, 0), np.exp(self._coordinates(after)[..., 5])]
        G, sigma_a = dwna_gain(np.array(self.T), self.sigma_a, self.noise)
        columns = [np.stack(kernel.pushed(*at, *change), axis=-1) for change in sigma_a * G.T]
        return covariances.squared(np.stack(columns, axis=-1))

    @_checks.quiet
    def h(self, xi: ArrayLike) -> FloatArray:
        """Return Doppler shifts (..., N) in Hz at the sensors."""
        return self._measured(xi)[..., 0]

    @_checks.quiet
    def H(self, xi: ArrayLike) -> FloatArray:
        """Return the derivatives (..., N, 6) of `h`; on a ring the last ones are zero."""
        return self._measured(xi)[..., 1:]

    def _measured(self, xi):
        """Return shift and gradient (..., N, 7) at all sensors.

        Range plays no part in what a ring measures, not even where there is no state: only as much
        is taken from eta as keeps all sensors at a distance.
        """
        xi = _checks.moderate("xi", xi, (6,)).copy()
        xi[..., 5] = np.clip(xi[..., 5], *self._scales)
        _, s_y, s_z = self.array.positions.T
        off = (s_y**2 + s_z**2 - self.radius**2) * np.exp(-2 * xi[..., 5, None])
        beside = 2 * (xi[..., 0, None] * s_y + xi[..., 1, None] * s_z)
        most = 1 + off - _CLEAR
        near = beside > most
        xi[..., :2] *= np.where(near, most / np.where(near, beside, 1.0), 1.0).min(-1)[..., None]
        *seen, ell = np.moveaxis(xi[..., None, :], -1, 0)
        unseen = 0.0, 0.0  # x and v_x, as long as all sensors are in the plane
        sensors = *self.array.positions.T, self.radius, self.array.doppler_per_speed
        shift_and_gradient = kernel.shift_and_gradient(*seen, np.exp(-ell), *unseen, *sensors)[:7]
        return np.stack(np.broadcast_arrays(*shift_and_gradient), axis=-1)

    def _coordinates(self, x):
        *seen, rho = kernel.to_coordinates(*np.moveaxis(x, -1, 0), self.radius)
        return np.stack([*seen, np.log(rho)], axis=-1)

    def _coordinates_and_slopes(self, x):
        """Return coordinates, and their derivatives (..., 6, 6) by the state."""
        xi = self._coordinates(x)
        at = [*np.moveaxis(x, -1, 0), np.exp(xi[..., 5])]
        columns = [np.stack(kernel.pushed(*at, *axis), axis=-1) for axis in np.eye(6)]
        return xi, np.stack(columns, axis=-1)

    def _after(self, x):
        return np.concatenate([x[..., :3] + self.T * x[..., 3:], x[..., 3:]], axis=-1)

    def _state(self, xi):
        return self._state_and_slopes(xi)[0]

    def _state_and_slopes(self, xi):
        """Return states, and their derivatives (..., 6, 6) by the coordinates."""
        *seen, ell = np.moveaxis(self._held(xi), -1, 0)
        values = kernel.to_state(*seen, np.exp(ell), self.radius)
        slopes = np.zeros((*ell.shape, 6, 6))
        for (i, j), slope in zip(_SLOPES, values[6:], strict=True):
            slopes[..., i, j] = slope
        return np.stack(values[:6], axis=-1), slopes

    @property
    def _scales(self):
        """Least and largest ln rho."""
        return np.log(1.001 * self.radius**2 * (1 + _LEAST**2)) / 2, _FARTHEST

    def _held(self, xi):
        """Return coordinates of states with x >= `_LEAST` times the radius."""
        held = _checks.moderate("xi", xi, (6,)).copy()
        held[..., 5] = np.clip(held[..., 5], *self._scales)
        least = self.radius**2 * (1 + _LEAST**2)  # rho^2 on the axis
        square = np.exp(2 * held[..., 5])
        across = np.hypot(held[..., 0], held[..., 1])
        most = np.sqrt(square - least) / square
        far = across > most
        held[..., :2] *= np.where(far, most / np.where(far, across, 1.0), 1.0)[..., None]
        return held


def _moments(function, x, P, given):
    """Return mean and covariance of a function of Gaussians x (..., 6), P (..., 6, 6).

    The function returns values and derivatives. Given three of its arguments it is linear in the
    others, whose part is integrated by formula; over those three, by Gauss and Hermite's rule with
    three points an axis.
    """
    node, share = np.polynomial.hermite_e.hermegauss(3)
    points = np.stack(np.meshgrid(node, node, node), axis=-1).reshape(-1, 3)
    weight = np.prod(np.meshgrid(*[share / share.sum()] * 3), axis=0).ravel()
    order = [*given, *(i for i in range(6) if i not in given)]
    P = P[..., order, :][..., order]
    slope = covariances.solve(P[..., :3, :3], P[..., :3, 3:]).mT
    left = covariances.square_root(P[..., 3:, 3:] - slope @ P[..., :3, 3:])
    steps = points @ covariances.square_root(P[..., :3, :3]).mT
    steps = np.concatenate([steps, steps @ slope.mT], axis=-1)
    value, slopes = function(x[..., None, :] + steps[..., np.argsort(order)])
    mean = weight @ value
    root = np.sqrt(weight)[:, None]
    off = root * (value - mean[..., None, :])
    spread = root[..., None] * (slopes[..., order[3:]] @ left[..., None, :, :])
    spread = np.moveaxis(spread, -3, -1)
    return mean, covariances.squared(
        np.concatenate([off.mT, spread.reshape(*spread.shape[:-2], -1)], axis=-1)
    )
