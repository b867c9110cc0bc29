"""A filter that is exactly right, and faults put into it one at a time.

The world is the paper's example with its tangent in place of the Doppler shift: motion and
measurement are linear, so that a Kalman filter with the right numbers is consistent, and whatever a
test finds was put there.
"""

from collections.abc import Iterator
from typing import Annotated, Any

import numpy as np

from ...._hints import Covariance, Measurements, Positive, Runs, State, checked, exactly
from ...._typing import FloatArray
from ....estimation import recursion
from ....estimation.track import Track
from ....model.doppler import doppler_jacobian, doppler_shift
from ....model.motion import constant_velocity
from ..published import reported
from .ablation import Noise, ablated_ekf


@checked
def linear_world(runs: Runs, *, rng: np.random.Generator) -> tuple[FloatArray, FloatArray]:
    """Return paths with random starts and pushes around the paper's, and their measurements.

    runs: Number of independent records.
    rng: Source of starts, pushes and noise.
    Returns truth (runs, K, 6): True states: the start has the covariance of the scenario, 0.1 I,
        and each axis is pushed independently with `sigma_a`.
        z (runs, K, N): What the tangent at the paper's path makes of them, with noise, in Hz.
    Raises ValueError if `runs` is not a positive whole number, or `rng` is not a generator.

    Examples
    --------
    >>> truth, z = linear_world(1, rng=np.random.default_rng(1))
    >>> truth.shape, z.shape
    ((1, 1001, 6), (1, 1001, 6))
    """
    s = reported().scenario
    F, _ = constant_velocity(s.T, s.sigma_a)
    pushes = s.sigma_a * rng.standard_normal((runs, s.samples, 3))
    push = np.hstack([s.T**2 / 2 * np.eye(3), s.T * np.eye(3)])

    def step(k, state):
        state = state @ F.T + pushes[:, k] @ push
        return state, (state,)

    start = rng.multivariate_normal(np.zeros(6), s.P0, size=runs)
    (away,) = recursion.scan(step, start, range(s.samples), axis=1)
    z = s.sigma_f * rng.standard_normal((runs, s.samples, len(s.array)))
    z += doppler_shift(s.truth, s.array)
    z += (doppler_jacobian(s.truth, s.array) @ away[..., None])[..., 0]
    return s.truth + away, z


@checked
def linear_filter(
    z: Measurements,
    *,
    noise: Noise = "per_axis",
    sigma_f: Positive | None = None,
    sigma_a: Positive | None = None,
    P0: Covariance | None = None,
    start: State | None = None,
) -> Track:
    """Track in the linear world.

    z (runs, K, N): Measurements of `linear_world`.
    noise: Process noise; "per_axis" is right.
    sigma_f, sigma_a: Standard deviations of the measurement in Hz and of the push in m/s^2; right
        if None.
    P0 (6, 6): Covariance of the start; right if None.
    start (6,): By how much the start is moved; not at all if None.
    Returns: With P and S of leading axis 1.

    Examples
    --------
    >>> linear_filter(linear_world(1, rng=np.random.default_rng(1))[1]).x.shape
    (1, 1001, 6)
    """
    s = reported().scenario
    F, _ = constant_velocity(s.T, s.sigma_a)
    before = np.linalg.solve(F, s.x0) + (0 if start is None else start)
    return ablated_ekf(
        z, s.array, before, s.P0 if P0 is None else P0, s.T, sigma_a or s.sigma_a,
        sigma_f or s.sigma_f, noise, path=s.truth, tangent_at="path", curvature=0.0,
    )  # fmt: skip


@checked
def faulty_filters(
    truth: Annotated[FloatArray, exactly(None, None, 6)], z: Measurements
) -> Iterator[tuple[str, Track, FloatArray, FloatArray]]:
    """Yield filters with one fault each, the first with none.

    truth (runs, K, 6): States of `linear_world`.
    z (runs, K, N): Their measurements.
    Yields label: What is wrong.
        track
        F, Q (6, 6): Motion as the filter assumes it.

    Examples
    --------
    >>> truth, z = linear_world(1, rng=np.random.default_rng(1))
    >>> next(faulty_filters(truth, z))[0]
    'nothing'
    """
    s = reported().scenario
    biased = z + np.eye(len(s.array))[0] * s.sigma_f / 4
    late = np.concatenate([z[:, :1].repeat(10, axis=1), z[:, :-10]], axis=1)
    memory = np.empty_like(z)
    noise = z - doppler_shift(s.truth, s.array)
    noise -= (doppler_jacobian(s.truth, s.array) @ (truth - s.truth)[..., None])[..., 0]
    memory[:, 0] = noise[:, 0]
    for k in range(1, s.samples):
        memory[:, k] = 0.3 * memory[:, k - 1] + np.sqrt(1 - 0.3**2) * noise[:, k]
    memory += z - noise
    blind = np.linalg.svd(doppler_jacobian(s.x0, s.array)).Vh[-1]
    cases: dict[str, tuple[FloatArray, dict[str, Any]]] = {
        "nothing": (z, {}),
        "noise assumed 10 % too small": (z, {"sigma_f": 0.9 * s.sigma_f}),
        "noise assumed 10 % too large": (z, {"sigma_f": 1.1 * s.sigma_f}),
        "colored noise, 0.3": (memory, {}),
        "one sensor off by sigma_f / 4": (biased, {}),
        "10 samples late": (late, {}),
        "pushes assumed 3 times too small": (z, {"sigma_a": s.sigma_a / 3}),
        "pushes assumed 3 times too large": (z, {"sigma_a": 3 * s.sigma_a}),
        "pushes assumed shared, Eq 17": (z, {"noise": "shared"}),
        "start 5 deviations off, blind direction": (z, {"start": 5 * np.sqrt(s.P0[0, 0]) * blind}),
    }
    for label, (measured, settings) in cases.items():
        sigma_a, kind = settings.get("sigma_a", s.sigma_a), settings.get("noise", "per_axis")
        yield label, linear_filter(measured, **settings), *constant_velocity(s.T, sigma_a, kind)
