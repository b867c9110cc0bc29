"""A start with wrong measurements: efficient without them, hardly worse with them, and honest."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.stats import chi2, norm

from dopplerlib import RadarArray, doppler_shift, ml_initialize
from dopplerlib.estimation._ml_polish import BISQUARE, EFFICIENCY, Data, bisquare, refine
from dopplerlib.estimation.initial_estimate import FALSE_ALARM

ROAD = RadarArray([[0.0, 0.0, 0.0]])  # one module beside a road
LANE = [-100, 0.5, 0, 3, 0, 0], [0, 15, 0, 30, 0, 0]
FREE = np.ix_([0, 1, 3], [0, 1, 3])
K, T, SIGMA = 80, 0.06, 5.0


def passing(x):
    """Return the shifts (K, 1) of a vehicle that drives straight on."""
    states = np.tile(np.asarray(x, float), (K, 1))
    states[:, :3] += T * np.arange(K)[:, None] * states[:, 3:]
    return doppler_shift(states, ROAD)


def vehicle(rng):
    return np.array([rng.uniform(-35, -20), rng.uniform(2, 6), 0, rng.uniform(8, 14), 0, 0])


def measured(rng, share, kind):
    """Return a state, its shifts with a share of wrong ones, and which of them are wrong."""
    x = vehicle(rng)
    z = passing(x) + SIGMA * rng.standard_normal((K, 1))
    count, wrong = round(share * K), np.zeros((K, 1), bool)
    noise = SIGMA * rng.standard_normal((K, 1))
    if kind == "line":  # steady, for a while, far from the vehicle's shifts
        wrong[:count] = True
        z[wrong] = (1.5 * z.max() + noise)[wrong]
    else:
        wrong[rng.choice(K, count, replace=False)] = True
        other = rng.uniform(-2500, 2500, (K, 1))
        if kind == "vehicle":
            other = passing(vehicle(rng) * [1, 1, 1, 1.5, 1, 1]) + noise
        z[wrong] = other[wrong]
    return x, z, wrong


def test_the_bisquare_has_the_efficiency_that_is_stated():
    # Of an M-estimate of location: (E psi')^2 / E psi^2 at normal errors.
    def psi(r):
        return r * bisquare(np.array([[r]]), 1.0)[1][0, 0]

    def slope(r):
        u = (r / BISQUARE) ** 2
        return (1 - u) * (1 - 5 * u)

    inside = {"a": -BISQUARE, "b": BISQUARE}
    mean = quad(lambda r: slope(r) * norm.pdf(r), **inside)[0]
    square = quad(lambda r: psi(r) ** 2 * norm.pdf(r), **inside)[0]
    assert mean**2 / square == pytest.approx(EFFICIENCY, abs=1e-4)  # c has four digits
    # And seen: means of 50 values, of which both estimates share most of the error. The ratio of
    # their variances scatters by 0.8 %; five times that is passed by chance once in a million.
    z = np.random.default_rng(1).standard_normal((3000, 50))

    def predict(x):
        return x[:, None] - z[:, None], np.ones((3000, 1, 50, 1))

    data = Data(predict, np.zeros((1, 50)), np.ones((1, 50)), np.zeros((1, 50, 0)), False)
    box = np.full(1, -9.0), np.full(1, 9.0)
    found, _, _, arrived = refine(data, np.zeros((3000, 1)), box, bisquare)
    assert arrived.all()
    assert z.mean(axis=1).var() / found.var() == pytest.approx(EFFICIENCY, abs=0.04)


@pytest.mark.parametrize("kind", ["scattered", "line", "vehicle"])
def test_thirty_percent_wrong_windows_cost_less_than_a_factor_of_two(kind):
    """In root mean squares, beside a fit to the sound windows, whitened by its covariance.

    Of two equal fits without any error in common the ratio of 24 squares each passes 4 with a
    probability of 6e-4; these two share most of their error.
    """
    squares = []
    for rng in np.random.default_rng(3).spawn(8):
        x, z, wrong = measured(rng, 0.3, kind)
        start = ml_initialize(z, ROAD, SIGMA, T, LANE, loss="bisquare", rng=rng)
        sound = ml_initialize(np.where(wrong, np.nan, z), ROAD, SIGMA, T, LANE)
        assert start.converged and start.weights.shape == z.shape
        assert start.degrees == np.sum(start.weights > 0) - 3
        # Wrong windows within some deviations of the right curve are not to be told from it.
        far = np.abs(z - passing(x)) > 8 * SIGMA
        assert not start.weights[far].any()
        P = sound.P[FREE]
        errors = (start.x - x)[[0, 1, 3]], (sound.x - x)[[0, 1, 3]]
        squares.append([error @ np.linalg.solve(P, error) for error in errors])
        plain = ml_initialize(z, ROAD, SIGMA, T, LANE)
        assert not plain.converged and not plain.plausible
    robust, sound = np.mean(squares, axis=0)
    assert robust < 4 * sound


def test_a_wrong_sensor_of_a_ring_is_found_and_so_is_another_target():
    ring, x = RadarArray.ring(6, 0.2), np.array([0.8, 0.1, -0.2, -0.7, 0.2, 0.1])
    box = [0.1, -0.75, -0.75, -2, -2, -2], [1.5, 0.75, 0.75, 2, 2, 2]
    rng = np.random.default_rng(4)
    times = 0.02 * np.arange(20)[:, None]
    z = np.stack([
        doppler_shift(np.hstack([s[:3] + times * s[3:], np.tile(s[3:], (20, 1))]), ring)
        for s in (x, np.array([1.1, -0.4, 0.3, 0.5, 1.0, -0.4]))
    ])  # fmt: skip
    z += 0.4 * rng.standard_normal(z.shape)
    wrong = (np.arange(6) == 2) | (rng.random((20, 1)) < 0.2)
    start = ml_initialize(
        np.where(wrong, z[1], z[0]), ring, 0.4, 0.02, box, loss="bisquare", rng=rng
    )
    assert start.converged
    assert np.mean((start.weights == 0) == wrong) > 0.95
    error = start.x - x
    # Six squares of normal errors: passed once in a million times.
    assert error @ np.linalg.solve(start.P, error) < chi2.isf(1e-6, 6)


def test_the_covariance_of_a_robust_start_is_that_of_its_errors():
    squares = []
    for rng in np.random.default_rng(5).spawn(12):
        x, z, _ = measured(rng, 0.0, "scattered")
        start = ml_initialize(z, ROAD, SIGMA, T, LANE, loss="bisquare", rng=rng)
        error = (start.x - x)[[0, 1, 3]]
        squares.append(error @ np.linalg.solve(start.P[FREE], error))
        plain = ml_initialize(z, ROAD, SIGMA, T, LANE)
        np.testing.assert_allclose(start.P[FREE] * EFFICIENCY, plain.P[FREE], rtol=0.05)
    low, high = chi2.ppf([1e-5, 1 - 1e-5], 36)
    assert low < np.sum(squares) < high


@pytest.mark.parametrize("loss", ["least_squares", "bisquare"])
def test_estimated_deviations_do_not_depend_on_the_given_ones(loss):
    rng = np.random.default_rng(6)
    _, z, _ = measured(rng, 0.0 if loss == "least_squares" else 0.2, "line")
    right, small = (
        ml_initialize(
            z, ROAD, sigma_f, T, LANE, loss=loss, scale="estimated", rng=np.random.default_rng(7)
        )
        for sigma_f in (SIGMA, SIGMA / 5)
    )
    # The deviation of a deviation of 64 values or more is 1 / sqrt(128): five of them.
    assert right.scale == pytest.approx(1, abs=5 / np.sqrt(128))
    assert small.scale == pytest.approx(5 * right.scale, rel=1e-6)
    # Fits end when a step gains 1e-12 of the cost: 1e-6 of a deviation.
    assert (np.abs(right.x - small.x) <= 1e-5 * np.sqrt(np.diag(right.P))).all()
    np.testing.assert_allclose(right.P, small.P, rtol=1e-4, atol=1e-12)
    assert small.cost == pytest.approx(small.degrees, rel=1e-6) and small.converged
    far = ml_initialize(
        z, ROAD, SIGMA / 50, T, LANE, loss=loss, scale="estimated", rng=np.random.default_rng(7)
    )
    assert far.scale > 10 and not far.plausible and not far.converged
    given = ml_initialize(
        z, ROAD, SIGMA / 5, T, LANE, loss=loss, rng=np.random.default_rng(7)
    )  # fmt: skip
    assert given.scale == 1 and not given.converged


def test_a_fit_is_not_plausible_beyond_the_quantile_of_chi_square():
    rng = np.random.default_rng(8)
    z = passing([-30, 4, 0, 12, 0, 0]) + SIGMA * rng.standard_normal((K, 1))
    cost = ml_initialize(z, ROAD, SIGMA, T, LANE).cost
    limit = chi2.isf(FALSE_ALARM, K - 3)
    for factor, right in ((0.999, True), (1.001, False)):
        sigma_f = SIGMA * np.sqrt(cost / (factor * limit))
        start = ml_initialize(z, ROAD, sigma_f, T, LANE)
        assert start.plausible == start.converged == right


def test_a_majority_on_another_line_is_not_plausible_or_takes_over():
    rng = np.random.default_rng(9)
    _, z, _ = measured(rng, 0.0, "line")
    z[rng.choice(K, 50, replace=False)] = rng.uniform(-2500, 2500, (50, 1))
    start = ml_initialize(z, ROAD, SIGMA, T, LANE, loss="bisquare", rng=rng)
    assert 2 * np.sum(start.weights > 0) <= K and not start.plausible and not start.converged


def test_runs_are_the_same_for_any_number_of_workers_and_may_be_incomplete():
    rng = np.random.default_rng(10)
    z = np.stack([measured(rng, 0.1, "vehicle")[1] for _ in range(3)])
    z[1, 6:] = np.nan  # six values for three unknowns
    z[2, ::3] = np.nan
    one, many = (
        ml_initialize(
            z, ROAD, SIGMA, T, LANE, loss="bisquare", rng=np.random.default_rng(1), workers=workers
        )
        for workers in (1, 4)
    )
    assert one == many
    assert np.isnan(one.x[1]).all() and one.converged.tolist() == [True, False, True]
    assert (np.isnan(one.weights[2]) == np.isnan(z[2])).all()
    assert one.degrees[2] == np.sum(one.weights[2] > 0) - 3


def test_a_robust_start_at_the_last_sample_is_the_first_one_moved():
    _, z, _ = measured(np.random.default_rng(11), 0.1, "vehicle")
    first, last = (
        ml_initialize(z, ROAD, SIGMA, T, LANE, at=at, loss="bisquare", rng=np.random.default_rng(1))
        for at in ("first", "last")
    )
    F = np.eye(6)
    F[:3, 3:] = (K - 1) * T * np.eye(3)
    np.testing.assert_allclose(last.x, F @ first.x, rtol=1e-12)
    # Condition numbers of 1e4, squared.
    np.testing.assert_allclose(last.P, F @ first.P @ F.T, rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"loss": "huber"}, "loss must be one of 'least_squares', 'bisquare'"),
        ({"scale": 2}, "scale must be one of 'given', 'estimated'"),
        ({"rng": None}, "rng must be a numpy.random.Generator"),
        ({"z": np.zeros((6, 1))}, "z must hold more than twice as many values .* got 6 for 3"),
    ],
)
def test_a_wrong_argument_is_named(change, message):
    arguments = {
        "z": np.zeros((K, 1)), "array": ROAD, "sigma_f": SIGMA, "T": T, "box": LANE,
        "loss": "bisquare", "rng": np.random.default_rng(1),
    }  # fmt: skip
    with pytest.raises(ValueError, match=message):
        ml_initialize(**arguments | change)
