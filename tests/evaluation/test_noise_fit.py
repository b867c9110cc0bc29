"""Noise parameters from innovations: known models, with outliers, and closed forms."""

import numpy as np
import pytest

from dopplerlib import kf
from dopplerlib.estimation.colored_errors import augment_linear
from dopplerlib.estimation.nonlinear_kalman import ekf_records
from dopplerlib.evaluation.noise_fit import fit_noise

ONE = np.eye(1)


def test_the_variance_of_white_noise_is_the_mean_square():
    """Without outliers in the data, the density of outliers takes a share below 1e-3."""
    z = np.random.default_rng(1).standard_normal((400, 5, 1))
    found = fit_noise(lambda r: kf(z, ONE, 0 * ONE, ONE, r * ONE, [0], 0 * ONE), {"r": 3.0})
    assert found.converged
    r = found.parameters["r"]
    assert r.value == pytest.approx(np.mean(z**2), rel=5e-3)
    # A log variance of n values has the deviation sqrt(2 / n).
    assert np.log(r.high / r.low) == pytest.approx(2 * 1.96 * np.sqrt(2 / z.size), rel=0.1)
    assert found.outliers < 0.005


def walk_and_noise(runs, K, rng):
    return np.cumsum(0.2 * rng.standard_normal((runs, K)), axis=1), rng.standard_normal((runs, K))


def test_colored_and_white_part_are_told_apart():
    """Each interval misses with 0.1 %."""
    rng = np.random.default_rng(2)
    walk, y = walk_and_noise(100, 50, rng)
    for k in range(1, 50):
        y[:, k] = 0.8 * y[:, k - 1] + 0.6 * y[:, k]
    z = (walk + y + 0.5 * rng.standard_normal(y.shape))[..., None]

    def tracker(white, sigma, tau):
        return kf(z, *augment_linear(
            ONE, 0.04 * ONE, ONE, white ** 2 * ONE, [0], 0 * ONE,
            sigma=sigma, tau=tau, T=1.0,
        ))  # fmt: skip

    found = fit_noise(tracker, {"white": 1.0, "sigma": 1.0, "tau": 2.0}, confidence=0.999)
    for name, value in {"white": 0.5, "sigma": 1.0, "tau": -1 / np.log(0.8)}.items():
        assert found.parameters[name].low < value < found.parameters[name].high, name


def test_outliers_leave_the_noise_as_it_is():
    """Of 2000 measurements 2 % are off by up to 50 deviations, which is a mean square of 17."""
    rng = np.random.default_rng(3)
    walk, noise = walk_and_noise(40, 50, rng)
    z = walk + noise + np.where(rng.random(walk.shape) < 0.02, 50 * rng.random(walk.shape), 0)

    def tracker(q, r):
        return ekf_records(
            z[..., None], lambda x: x, lambda x: ONE, q ** 2 * ONE, lambda x: x,
            lambda x: ONE, r ** 2 * ONE, [0], 0 * ONE, gate="soft", gate_probability=0.999,
        )  # fmt: skip

    found = fit_noise(tracker, {"q": 0.3, "r": 0.5}, confidence=0.999)
    for name, value in {"q": 0.2, "r": 1.0}.items():
        assert found.parameters[name].low < value < found.parameters[name].high, name
    assert found.outliers > 0.01


def test_a_parameter_without_effect_has_no_interval():
    z = np.random.default_rng(3).standard_normal((20, 5, 1))
    found = fit_noise(lambda r: kf(z, ONE, 0 * ONE, ONE, ONE, [0], 0 * ONE), {"r": 3.0})
    assert not found.converged
    assert np.isnan(found.parameters["r"].low)


def test_wrong_arguments_are_named():
    z = np.ones((5, 1))
    with pytest.raises(ValueError, match="start must hold a parameter"):
        fit_noise(lambda: kf(z, ONE, ONE, ONE, ONE, [0], ONE), {})
    with pytest.raises(ValueError, match=r"tracker must take .* unexpected keyword argument 'r'"):
        fit_noise(lambda q: kf(z, ONE, ONE, ONE, ONE, [0], ONE), {"r": 1.0})
    with pytest.raises(ValueError, match="track must"):
        fit_noise(lambda r: None, {"r": 1.0})
