"""Probability of a collision beside geometry, closed forms and many random draws."""

import numpy as np
import pytest
from scipy.stats import multivariate_normal, ncx2, norm

from dopplerlib.chain.collision import collision_probability

# Of 1024 points; random ones would have a standard deviation of 0.016 at one half.
POINTS, ERROR = 1024, 0.012
COMING = np.array([1.0, 0.0, 0.0, -2.0, 0.0, 0.0])
KNOWN = np.zeros((6, 6))


def only(*deviations):
    return np.diag(np.square(deviations))


@pytest.mark.parametrize(
    ("x", "within", "hit"),
    [
        (COMING, 0.449, 0),  # 0.9 m at 2 m/s
        (COMING, 0.451, 1),
        (-COMING, np.inf, 1),
        (COMING * [-1, 1, 1, 1, 1, 1], np.inf, 0),  # goes away
        (np.add(COMING, [0, 0.099, 0, 0, 0, 0]), np.inf, 1),
        (np.add(COMING, [0, 0.101, 0, 0, 0, 0]), np.inf, 0),
        ([0.05, 0.05, 0, 1, 0, 0], 0.0, 1),  # is in, and leaves
        ([0.05, 0, 0, 0, 0, 0], np.inf, 1),  # rests inside, and outside
        ([0.15, 0, 0, 0, 0, 0], np.inf, 0),
        ([0.3, 0.3, 0, 0, -1, 0], np.inf, 0),
        ([0.09, 0.3, 0, 0, -1, 0], 0.25, 0),  # is in at 0.2564 s
        ([0.09, 0.3, 0, 0, -1, 0], 0.26, 1),
    ],
)
def test_a_known_state_hits_or_not(x, within, hit):
    assert collision_probability(x, KNOWN, 0.1, within) == hit
    moved = np.add(x, [3, -2, 1, 0, 0, 0])
    assert collision_probability(moved, KNOWN, 0.1, within, center=[3, -2, 1]) == hit


def test_braking_adds_speed_over_twice_the_deceleration():
    # 20 ms at 2 m/s and 4 / (2 * 10) m of braking: 0.24 m before the ball.
    x = COMING + np.outer([0.001, -0.001], np.eye(6)[0]) - [0.66, 0, 0, 0, 0, 0]
    found = collision_probability(x, KNOWN, 0.1, 0.02, deceleration=10.0)
    np.testing.assert_array_equal(found, [0, 1])
    both = collision_probability(x, KNOWN, 0.1, [0.02, 0.02], deceleration=[10.0, np.inf])
    np.testing.assert_array_equal(both, [[0, 0], [1, 0]])


@pytest.mark.parametrize("offset", [0.0, 0.05, 0.1, 0.2])
def test_across_the_line_it_is_a_disc_of_a_normal_distribution(offset):
    x = np.add(COMING, [0, offset, 0, 0, 0, 0])
    found = collision_probability(x, only(0, 0.06, 0.06, 0, 0, 0), 0.1, np.inf, points=POINTS)
    assert abs(found - ncx2.cdf((0.1 / 0.06) ** 2, 2, (offset / 0.06) ** 2)) < ERROR


def test_along_the_line_it_is_a_normal_distribution():
    within = np.linspace(0.3, 0.6, 7)
    found = collision_probability(COMING, only(0.1, 0, 0, 0, 0, 0), 0.1, within, points=POINTS)
    np.testing.assert_allclose(found, norm.cdf((2 * within - 0.9) / 0.1), atol=ERROR)


def test_an_uncertain_direction_is_an_angle():
    # Velocity across v_x = -2, normal with 0.1: enters if |p x v| < 0.1 |v|.
    found = collision_probability(COMING, only(0, 0, 0, 0, 0.1, 0), 0.1, np.inf, points=POINTS)
    expected = 2 * norm.cdf(2 * np.tan(np.arcsin(0.1)) / 0.1) - 1
    assert abs(found - expected) < ERROR


@pytest.fixture(scope="module")
def gaussians():
    """Means and covariances as of a tracker: a few centimeters and tenths of a meter per second."""
    rng = np.random.default_rng(1)
    x = [0.6, 0.05, -0.05, -0.8, -0.05, 0.05] + rng.standard_normal((30, 6)) * 0.05
    root = rng.standard_normal((30, 6, 6)) * np.array([0.02] * 3 + [0.04] * 3)[:, None]
    return x, root @ root.mT


def drawn(x, P, within, count, rng):
    """Return the share of random states that come nearer than 0.1 m, tried every 5 ms.

    The nearest time is missed by 2.5 ms at most, or 2 mm of the way: 0.02 mm of the distance.
    """
    states = multivariate_normal(x, P).rvs(count, random_state=rng)
    times = np.arange(0, within, 0.005)
    path = states[:, None, :3] + times[:, None] * states[:, None, 3:]
    return (np.sum(path**2, axis=-1).min(axis=1) < 0.01).mean()


@pytest.mark.parametrize(("points", "rms"), [(128, 0.03), (POINTS, 0.01)])
def test_the_error_is_as_stated(gaussians, points, rms):
    x, P = gaussians
    found = collision_probability(x, P, 0.1, 0.8, points=points)
    rng, count = np.random.default_rng(2), 2000
    expected = np.array([drawn(m, C, 0.8, count, rng) for m, C in zip(x, P, strict=True)])
    middle = (expected > 0.02) & (expected < 0.98)
    assert middle.sum() > 10
    # The draws' own variance is at most a quarter over their number.
    error = np.mean((found - expected)[middle] ** 2) - 0.25 / count
    assert error < rms**2


def test_a_mixture_is_the_mean_of_its_parts_and_what_has_no_weight_may_be_nan(gaussians):
    x, P = (part[:6].reshape(2, 3, *part.shape[1:]) for part in gaussians)
    weights = np.array([[0.5, 0.3, 0.2], [0.6, 0.2, 0.0]])
    parts = collision_probability(x, P, 0.1, [0.5, np.inf])
    expected = np.einsum("rm,rmh->rh", weights, parts) / weights.sum(axis=1)[:, None]
    x, P = x.copy(), P.copy()
    x[1, 2], P[1, 2] = np.nan, np.nan
    found = collision_probability(x, P, 0.1, [0.5, np.inf], weights=weights)
    np.testing.assert_allclose(found, expected, rtol=1e-12)
    none = collision_probability(x * np.nan, P, 0.1, [0.5, np.inf], weights=weights)
    assert np.isnan(none).all() and none.shape == (2, 2)


def test_one_is_what_it_is_among_many(gaussians):
    x, P = gaussians
    many = collision_probability(np.tile(x, (150, 1)), np.tile(P, (150, 1, 1)), 0.1, 0.8)
    np.testing.assert_array_equal(many, np.tile(collision_probability(x, P, 0.1, 0.8), 150))


@pytest.mark.parametrize(
    ("changed", "text"),
    [
        ({"within": -0.1}, "within must not be negative"),
        ({"within": np.nan}, "within must not be negative"),
        ({"within": [[1.0]]}, "within must be one number"),
        ({"deceleration": [1.0, 2.0]}, "deceleration must be one number"),
        ({"weights": [0.5, 0.5]}, "weights must have leading axes"),
        ({"radius": 0}, "radius must"),
    ],
)
def test_errors_name_the_argument(changed, text):
    with pytest.raises(ValueError, match=text):
        collision_probability(**{"x": COMING, "P": KNOWN, "radius": 0.1, "within": 1.0} | changed)
