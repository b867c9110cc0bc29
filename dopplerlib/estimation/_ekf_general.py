"""The EKF for links that move and have clocks: the recursion of all filters, vectorized over runs.

For sensors that stand still it does what `_ekf_loop` does, some twenty times slower.
"""

from collections.abc import Sequence

import numpy as np

from .._typing import FloatArray
from ..model.doppler import check_clear_of_sensors, doppler_jacobian, doppler_shift
from ..model.links import DopplerLinks
from ..model.motion import constant_velocity
from ..model.radar_array import RadarArray
from . import gaussian, models, recursion
from .recursion import Bounds
from .track import Track


def filter_general(
    z: FloatArray,
    array: RadarArray | DopplerLinks,
    x0: FloatArray,
    P0: FloatArray,
    motion: tuple[FloatArray, FloatArray],
    variance: FloatArray,
    bounds: Bounds | None,
) -> Track:
    """Return the track of measurements (..., K, N), checked, of a sampled array.

    `motion` are F and Q (K, n, n), `variance` (K, N) that of the measurements.
    """
    K = z.shape[-2]
    each = [array.at_sample(k) if isinstance(array, DopplerLinks) else array for k in range(K)]
    check_clear_of_sensors("F x0", (x0 @ motion[0][0].T)[..., :6], each[0])
    rules = general_rules(z, each, motion, variance)
    track = recursion.filter_records(x0, P0, *rules, range(K), z.ndim - 2, bounds)
    return recursion.finite("z, array, x0, P0", track)


def general_rules(
    z: FloatArray,
    each: Sequence[RadarArray | DopplerLinks],
    motion: tuple[FloatArray, FloatArray],
    variance: FloatArray,
) -> tuple[recursion.Predict, recursion.Correct]:
    """Return the functions of `recursion.cycle`, with arguments as above and an array a sample."""

    def correct(k, x, P):
        try:
            innovation = z[..., k, :] - doppler_shift(x, each[k])
            H = doppler_jacobian(x, each[k])
        except ValueError as error:
            raise ValueError(
                f"z, array, x0, P0 must keep the predictions near the target, got at sample {k}: "
                f"{error}"
            ) from None
        R = variance[k] * np.eye(z.shape[-1])
        try:
            return innovation, *gaussian.gain(P, H, R, ~np.isnan(innovation))
        except ValueError as error:
            raise ValueError(
                "sigma_f must be large enough against P0 and sigma_clock for their sums to hold "
                f"it, got at sample {k}: {error}"
            ) from None

    return models.linear_motion(*motion), correct


def general_motion(
    array: RadarArray | DopplerLinks, T: FloatArray, K: int, sigma_a: float, noise: str,
    sigma_clock: float, sigma_drift: float,
) -> tuple[RadarArray | DopplerLinks, tuple[FloatArray, FloatArray]]:  # fmt: skip
    """Return the array at its samples, and F and Q (K, n, n) of the steps that lead to them.

    ValueError if the intervals are not those of the times that links have, or the clocks would have
    no process noise that they need.
    """
    if isinstance(array, RadarArray):
        F, Q = constant_velocity(T, sigma_a, noise)
    else:
        if array.clock_model == "epoch" and array.n > 6 and not sigma_clock > 0:
            raise ValueError(
                'sigma_clock must be positive for clocks of the model "epoch", got 0.0: it is the '
                "standard deviation of each new offset"
            )
        given, array = array.times, array.sampled(K, T if len(T) > 1 else float(T[0]))
        if given is not None:
            steps = np.diff(given)
            if len(T) > 1 and not np.allclose(T[1:], steps, rtol=1e-6):
                raise ValueError(
                    "T must have the intervals of the times of the links, of which it is one "
                    f"number or all, got {T[1:].tolist()}"
                )
            T = np.append(T[0], steps)
        F, Q = array.motion(T, sigma_a, noise, sigma_clock, sigma_drift)
    n = F.shape[-1]
    return array, (np.broadcast_to(F, (K, n, n)), np.broadcast_to(Q, (K, n, n)))
