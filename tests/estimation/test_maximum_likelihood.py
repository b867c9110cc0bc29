"""The maximum-likelihood start: efficient, globally right, the same however it is called."""

import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation
from scipy.stats import chi2

from dopplerlib import (
    RadarArray,
    crlb,
    doppler_jacobian,
    doppler_shift,
    ml_initialize,
    ring_family,
    ring_family_limits,
)

T = 1e-3
LINE, RING = RadarArray.linear(5, 0.4), RadarArray.ring(6, 0.2)
SPACE = np.array([[0.1, -0.75, -0.75, -2, -2, -2], [1.5, 0.75, 0.75, 2, 2, 2]])
PLANE = SPACE * [1, 1, 0, 1, 1, 0]
CASES = {
    "line, static": (LINE, PLANE, "stationary"),
    "line, moving": (LINE, PLANE, "constant_velocity"),
    "ring, static": (RING, SPACE, "stationary"),
    "ring, moving": (RING, SPACE, "constant_velocity"),
}
STATE = np.array([0.5, 0.2, 0.1, -1.0, 0.5, 0.3])
FIELDS = (
    "x", "P", "cost", "at_bound", "identifiable", "converged", "second_x", "second_cost", "degrees",
    "weights", "scale",
)  # fmt: skip

each_case = pytest.mark.parametrize("case", CASES.values(), ids=CASES)


def path(x, samples, likelihood="constant_velocity"):
    """Return the states (..., K, 6) of a target at constant velocity, or at rest in its state."""
    x = np.asarray(x, dtype=float)
    states = np.repeat(x[..., None, :], samples, axis=-2)
    if likelihood == "constant_velocity":
        states[..., :3] += (T * np.arange(samples))[:, None] * x[..., None, 3:]
    return states


def scenarios(case, count, seed, samples=10):
    """Yield measurements and their deviation for targets anywhere in the box, any velocity."""
    array, box, likelihood = case
    rng = np.random.default_rng(seed)
    for _ in range(count):
        x = rng.uniform(*box)
        x[3:] = rng.normal(size=3) * (box[0, 3:] < box[1, 3:])
        x[3:] *= rng.uniform(0.1, 2) / np.linalg.norm(x[3:])
        sigma_f = 10 ** rng.uniform(-2, 0)
        shifts = doppler_shift(path(x, samples, likelihood), array)
        yield shifts + sigma_f * rng.standard_normal(shifts.shape), sigma_f


def problem(z, sigma_f, case):
    """Return residuals and Jacobian of the free components, for SciPy."""
    array, box, likelihood = case
    free = box[0] < box[1]
    deviation = np.broadcast_to(sigma_f, z.shape)[..., None]
    F = np.eye(6) + np.zeros((len(z), 6, 6))
    if likelihood == "constant_velocity":
        F[:, :3, 3:] = (T * np.arange(len(z)))[:, None, None] * np.eye(3)

    def state(u):
        x = box[0].copy()
        x[free] = u
        return F @ x

    def residuals(u):
        return ((doppler_shift(state(u), array) - z) / sigma_f).ravel()

    def jacobian(u):
        return (doppler_jacobian(state(u), array) @ F / deviation).reshape(-1, 6)[:, free]

    return residuals, jacobian, box[:, free]


def scipy_fit(z, sigma_f, case, start):
    """Return chi-square after a fit by SciPy from `start` (free components)."""
    residuals, jacobian, bounds = problem(z, sigma_f, case)
    fit = least_squares(residuals, start, jacobian, bounds, x_scale="jac", max_nfev=1000)
    return 2 * fit.cost


def assert_same_bits(start, other):
    for name in FIELDS:
        assert getattr(start, name).tobytes() == getattr(other, name).tobytes(), name


# ------------------------------------------------------------------------ is the estimate right?


@each_case
def test_measurements_without_noise_give_the_state_back(case):
    array, box, likelihood = case
    x = STATE * (box[0] < box[1])
    start = ml_initialize(
        doppler_shift(path(x, 10, likelihood), array), array, 0.1, T, box, likelihood
    )
    assert start.converged
    assert start.cost < 1e-12
    if start.identifiable:
        # The search ends when a step gains 1e-12; along the weakest direction of the moving ring,
        # whose standard deviation is some 0.1 m, that is 1e-7 m.
        np.testing.assert_allclose(start.x, x, atol=1e-6)
        assert not start.at_bound.any()


@pytest.mark.parametrize("likelihood", ["stationary", "constant_velocity"])
def test_the_estimate_attains_the_cramer_rao_bound_at_high_signal_to_noise_ratio(likelihood):
    # At 1 mHz the standard deviations are some 0.1 mm and 1 mm/s: the Doppler shift is straight.
    runs, samples, sigma_f = 2000, 10, 1e-3
    x = STATE * (PLANE[0] < PLANE[1])
    rng = np.random.default_rng(60)
    shifts = doppler_shift(path(x, samples, likelihood), LINE)
    z = shifts + sigma_f * rng.standard_normal((runs, samples, len(LINE)))
    start = ml_initialize(z, LINE, sigma_f, T, PLANE, likelihood)
    free = np.ix_(PLANE[0] < PLANE[1], PLANE[0] < PLANE[1])
    bound = crlb(x, LINE, sigma_f, samples, T, likelihood, free=PLANE[0] < PLANE[1])[free]
    error = (start.x - x)[:, PLANE[0] < PLANE[1]]
    # Whitened by the bound, errors are independent with unit variance. Six tests of two tails of
    # 1e-5 each: together they fail by chance once in 8000.
    white = np.linalg.solve(np.linalg.cholesky(bound), error.T)
    for sum_of_squares, dof in (
        *((np.sum(row**2), runs) for row in white), (np.sum(white**2), 4 * runs),
    ):  # fmt: skip
        low, high = chi2.ppf([1e-5, 1 - 1e-5], dof)
        assert low < sum_of_squares < high
    nees = np.einsum("ri,rij,rj->r", error, np.linalg.inv(start.P[:, *free]), error)
    low, high = chi2.ppf([1e-5, 1 - 1e-5], 4 * runs)
    assert low < nees.sum() < high


@each_case
def test_no_fit_by_scipy_is_better(case):
    # SciPy starts where we ended, and anywhere. Costs are equal to 1e-9, the tolerance of both.
    rng = np.random.default_rng(61)
    for z, sigma_f in scenarios(case, 6, seed=62):
        start = ml_initialize(z, case[0], sigma_f, T, *case[1:2], case[2])
        lower, upper = problem(z, sigma_f, case)[2]
        inside = np.clip(start.x[case[1][0] < case[1][1]], lower + 1e-9, upper - 1e-9)
        for first in (inside, *rng.uniform(lower, upper, (6, len(lower)))):
            assert start.cost <= scipy_fit(z, sigma_f, case, first) * (1 + 1e-9) + 1e-9


def test_of_two_optima_on_one_family_the_better_one_is_found():
    # Motion hardly tells the members of a ring's family apart. In about one scenario of a hundred
    # the grid leads to the worse of two optima on it; this is one of them.
    case = CASES["ring, moving"]
    *_, (z, sigma_f) = scenarios(case, 140, seed=73)
    start = ml_initialize(z, RING, sigma_f, T, SPACE)
    low, high = ring_family_limits(start.x, 0.2)
    family = ring_family(np.tile(start.x, (12, 1)), 0.2, np.geomspace(low, high, 14)[1:-1])
    inside = family[((family > SPACE[0]) & (family < SPACE[1])).all(axis=1)]
    assert len(inside) > 3
    for first in inside:
        assert start.cost <= scipy_fit(z, sigma_f, case, first) * (1 + 1e-9) + 1e-9


def test_the_static_likelihood_needs_the_mean_only():
    case = CASES["line, static"]
    ((z, sigma_f),) = scenarios(case, 1, seed=63)
    start = ml_initialize(z, LINE, sigma_f, T, PLANE, "stationary")
    mean = ml_initialize(z.mean(axis=0)[None], LINE, sigma_f / np.sqrt(10), T, PLANE, "stationary")
    # The search ends when a step gains 1e-12 of the cost, some 1e-6 of a standard deviation.
    assert (np.abs(start.x - mean.x) <= 1e-5 * np.sqrt(np.diag(mean.P))).all()
    np.testing.assert_allclose(start.P, mean.P, rtol=1e-4)
    scatter = np.sum((z - z.mean(axis=0)) ** 2) / sigma_f**2
    assert start.cost == pytest.approx(mean.cost + scatter, rel=1e-12)


@pytest.mark.parametrize("likelihood", ["stationary", "constant_velocity"])
def test_a_ring_turned_about_its_axis_finds_the_turned_target(likelihood):
    # No bound is active, so the box, which does not turn, takes no part.
    rng = np.random.default_rng(64)
    z = doppler_shift(path(STATE, 10), RING) + 0.01 * rng.standard_normal((10, 6))
    box = SPACE * [1, 1, 1, 2, 2, 2]
    turn = Rotation.from_euler("x", 40, degrees=True).as_matrix()
    turned_ring = RadarArray(RING.positions @ turn.T)
    start, turned = (
        ml_initialize(z, array, 0.01, T, box, likelihood) for array in (RING, turned_ring)
    )
    assert not (start.at_bound.any() or turned.at_bound.any())
    assert turned.cost == pytest.approx(start.cost, rel=1e-9)
    if likelihood == "constant_velocity":
        expected = np.r_[turn @ start.x[:3], turn @ start.x[3:]]
    else:  # then both are members of one family, which are told apart by the box alone
        across, turned_across = (np.hypot(s.x[1], s.x[2]) for s in (start, turned))
        family = ring_family(start.x, 0.2, np.sqrt(turned_across / across))
        expected = np.r_[turn @ family[:3], turn @ family[3:]]
    np.testing.assert_allclose(turned.x, expected, atol=1e-4)


def test_a_less_certain_sensor_counts_less():
    case = CASES["line, moving"]
    ((z, _),) = scenarios(case, 1, seed=65)
    sigma_f = np.array([0.1, 0.2, 0.1, 0.3, 0.1])
    start = ml_initialize(z, LINE, sigma_f, T, PLANE)
    lower, upper = problem(z, sigma_f, case)[2]
    inside = np.clip(start.x[[0, 1, 3, 4]], lower + 1e-9, upper - 1e-9)
    assert start.cost == pytest.approx(scipy_fit(z, sigma_f, case, inside), rel=1e-8)
    without = z.copy()
    without[:, 3] = np.nan
    hardly = ml_initialize(z, LINE, sigma_f * [1, 1, 1, 1e6, 1], T, PLANE)
    np.testing.assert_allclose(
        hardly.x, ml_initialize(without, LINE, sigma_f, T, PLANE).x, atol=1e-5
    )


# ------------------------------------------------------------------------------- how it is called


@each_case
def test_a_run_is_the_same_alone_in_a_batch_and_for_any_number_of_workers(case):
    array, box, likelihood = case
    z = np.stack([z for z, _ in scenarios(case, 12, seed=66)]).reshape(3, 4, 10, -1)
    z[0, 1, 2:, 0] = z[1, 2, :, 1] = np.nan  # other weights for two of them
    together = ml_initialize(z, array, 0.3, T, box, likelihood, workers=1)
    assert together.x.shape == (3, 4, 6) and together.P.shape == (3, 4, 6, 6)
    assert_same_bits(together, ml_initialize(z, array, 0.3, T, box, likelihood, workers=5))
    for i in np.ndindex(3, 4):
        alone = ml_initialize(z[i], array, 0.3, T, box, likelihood)
        for name in FIELDS:
            assert getattr(alone, name).tobytes() == getattr(together, name)[i].tobytes(), name


@pytest.mark.parametrize("likelihood", ["stationary", "constant_velocity"])
def test_the_covariance_is_the_bound_at_the_estimate(likelihood):
    ((z, sigma_f),) = scenarios(CASES["line, moving"], 1, seed=67)
    start = ml_initialize(z, LINE, sigma_f, T, PLANE, likelihood)
    bound = crlb(start.x, LINE, sigma_f, 10, T, likelihood, free=PLANE[0] < PLANE[1])
    # Two orders of summation, and a condition number of some 1e5.
    np.testing.assert_allclose(start.P, bound, rtol=1e-8)


def test_the_last_state_is_the_first_one_moved():
    ((z, sigma_f),) = scenarios(CASES["ring, moving"], 1, seed=68)
    first, last = (ml_initialize(z, RING, sigma_f, T, SPACE, at=at) for at in ("first", "last"))
    F = np.eye(6)
    F[:3, 3:] = 9 * T * np.eye(3)
    np.testing.assert_allclose(last.x, F @ first.x, rtol=1e-14)
    np.testing.assert_allclose(last.P, F @ first.P @ F.T, rtol=1e-6, atol=1e-9)
    assert last.cost == first.cost and (last.at_bound == first.at_bound).all()
    static = [
        ml_initialize(z, RING, sigma_f, T, SPACE, "stationary", at=at) for at in ("first", "last")
    ]
    assert_same_bits(*static)


def test_a_sensor_that_is_always_missing_might_as_well_not_be_there():
    ((z, sigma_f),) = scenarios(CASES["ring, moving"], 1, seed=69)
    missing = z.copy()
    missing[:, 2] = np.nan
    there = [0, 1, 3, 4, 5]
    start = ml_initialize(missing, RING, sigma_f, T, SPACE)
    other = ml_initialize(z[:, there], RadarArray(RING.positions[there]), sigma_f, T, SPACE)
    assert start.cost == pytest.approx(other.cost, rel=1e-9)
    np.testing.assert_allclose(start.x, other.x, atol=1e-5)


def test_a_long_record_is_explained_as_well():
    # The target moves 0.4 m: the grid sees the first samples, the estimate all of them.
    x = STATE * [2, 1, 0, 1, 1, 0]
    z = doppler_shift(path(x, 400), LINE)
    start = ml_initialize(z, LINE, 0.1, T, PLANE)
    np.testing.assert_allclose(start.x, x, atol=1e-6)


# --------------------------------------------------------------------------- what it has to admit


def test_an_active_bound_is_flagged():
    x = STATE * (PLANE[0] < PLANE[1])
    box = PLANE.copy()
    box[1, 0] = 0.4  # nearer than the target
    # With one deviation the shifts fit the nearest state in the box, with another they cannot.
    for sigma_f, plausible in ((5.0, True), (0.1, False)):
        start = ml_initialize(doppler_shift(path(x, 10), LINE), LINE, sigma_f, T, box)
        assert start.at_bound.tolist() == [True, False, False, False, False, False]
        assert start.x[0] == 0.4
        assert start.identifiable and start.cost > 1e-3
        assert start.converged == start.plausible == plausible


def test_of_equally_likely_states_the_one_nearest_to_the_center_of_the_box_is_taken():
    center, width = SPACE.mean(axis=0), SPACE[1] - SPACE[0]
    for z, sigma_f in scenarios(CASES["ring, static"], 20, seed=70):
        start = ml_initialize(z, RING, sigma_f, T, SPACE, "stationary")
        assert not start.identifiable and np.isinf(np.diag(start.P)).all()
        if start.at_bound.any():
            continue
        low, high = ring_family_limits(start.x, 0.2)
        t = np.geomspace(low * 1.0001, high * 0.9999, 2001)
        family = ring_family(np.broadcast_to(start.x, (2001, 6)), 0.2, t)
        near = np.abs(np.log(t)) < 0.2
        distance = np.linalg.norm((family - center) / width, axis=1)
        here = np.linalg.norm((start.x - center) / width)
        # The search stops when a step is below 1e-6 of the box; distance is stationary there.
        assert here <= distance[near].min() + 1e-6


def test_a_target_behind_a_plane_array_is_as_likely_as_one_before_it():
    box = PLANE.copy()
    box[0, 0] = -1.5
    x = np.array([0.5, 0.2, 0, -1, 0.5, 0])
    mirrored = x * [-1, 1, 1, -1, 1, 1]
    z = doppler_shift(path(mirrored, 10), LINE)
    z += 0.1 * np.random.default_rng(71).standard_normal(z.shape)
    start = ml_initialize(z, LINE, 0.1, T, box)
    assert start.x[0] > 0  # the rule for equal costs
    np.testing.assert_allclose(start.second_x, start.x * [-1, 1, 1, -1, 1, 1], atol=1e-6)
    assert start.second_cost == pytest.approx(start.cost, rel=1e-9)


@each_case
def test_the_second_basin_is_another_optimum_and_not_better(case):
    array, box, likelihood = case
    z = np.stack([z for z, _ in scenarios(case, 60, seed=72)])
    start = ml_initialize(z, array, 0.3, T, box, likelihood)
    there = np.isfinite(start.second_cost)
    assert there.any()
    assert (start.second_cost[there] >= start.cost[there] * (1 - 1e-9)).all()
    width = np.where(box[0] < box[1], box[1] - box[0], 1)
    apart = np.abs(start.second_x - start.x)[there] / width
    assert (apart.max(axis=1) > 1e-3).all()
    assert np.isnan(start.second_x[~there]).all()


@pytest.mark.parametrize("likelihood", ["stationary", "constant_velocity"])
def test_a_run_with_fewer_measurements_than_unknowns_is_flagged(likelihood):
    z = np.tile(doppler_shift(STATE * (PLANE[0] < PLANE[1]), LINE), (4, 1, 1))
    z[1] = np.nan
    z[2, :, 1:3] = np.nan  # three for four unknowns
    z[3, :, 1] = np.nan  # four are enough
    start = ml_initialize(z, LINE, 0.1, T, PLANE, likelihood)
    solved = [True, False, False, True]
    assert start.converged.tolist() == start.identifiable.tolist() == solved
    for name in ("x", "P", "cost", "second_x", "second_cost"):
        value = getattr(start, name).reshape(4, -1)
        assert np.isnan(value[1:3]).all(), name
    assert np.isfinite(start.x[solved]).all()
    assert not start.at_bound[1:3].any()


def test_a_box_that_fixes_everything_leaves_the_misfit():
    z = doppler_shift(STATE, RING)[None] + 0.2
    start = ml_initialize(z, RING, 0.1, T, (STATE, STATE))
    assert start.x.tolist() == STATE.tolist()
    assert start.cost == pytest.approx(6 * 4, rel=1e-9)
    assert not start.P.any() and not start.at_bound.any()


def test_a_box_around_a_sensor_is_searched():
    array = RadarArray(np.vstack([LINE.positions, [0.3, 0.1, 0]]))
    x = np.array([0.5, 0.2, 0, -1, 0.5, 0])
    start = ml_initialize(doppler_shift(path(x, 10), array), array, 0.1, T, PLANE)
    np.testing.assert_allclose(start.x, x, atol=1e-6)
    on_sensor = np.array([[0.3, 0.1, 0, -2, -2, 0], [0.3, 0.1, 0, 2, 2, 0]])
    start = ml_initialize(doppler_shift(path(x, 10), array), array, 0.1, T, on_sensor)
    assert np.isnan(start.cost) and np.isnan(start.x).all() and not start.converged


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"z": np.zeros((1, 5))}, r"z must have shape \(..., None|any, 6\)"),
        ({"z": np.full((1, 6), np.inf)}, "z must be finite, or NaN"),
        ({"array": RING.positions}, "array must be a RadarArray or a DopplerLinks"),
        ({"sigma_f": 0}, "sigma_f must be positive"),
        ({"sigma_f": [1, 2]}, "sigma_f must have leading axes that broadcast"),
        ({"T": -1}, "T must be positive"),
        ({"box": SPACE[0]}, "box must have 2 parts, got 6"),
        ({"box": (SPACE[0], SPACE[1][:3])}, r"upper bound of box must have shape \(..., 6\)"),
        ({"box": SPACE * np.inf}, "lower bound of box must be finite"),
        ({"box": SPACE[::-1]}, "box must not be empty, got lower 1.5 above upper 0.1 at index 0"),
        ({"likelihood": "both"}, "likelihood must be one of 'constant_velocity', 'stationary'"),
        ({"at": "middle"}, "at must be one of 'first', 'last'"),
        ({"workers": 0}, "workers must be a whole number of at least 1"),
    ],
)
def test_a_wrong_argument_is_named(change, message):
    arguments = {
        "z": np.zeros((1, 6)), "array": RING, "sigma_f": 0.4, "T": T, "box": SPACE,
    }  # fmt: skip
    with pytest.raises(ValueError, match=message):
        ml_initialize(**arguments | change)


@pytest.mark.parametrize("likelihood", ["stationary", "constant_velocity"])
def test_too_few_sensors_are_refused(likelihood):
    array = RadarArray.ring(5, 0.2)
    with pytest.raises(ValueError, match=r"got 5 .* for 6; equal bounds in box fix a component"):
        ml_initialize(np.zeros((1, 5)), array, 0.4, T, SPACE, likelihood)


# -------------------------------------------------------------- does it explain the measurements?


@each_case
def test_chi_square_is_as_large_as_its_degrees_of_freedom(case):
    """Averages of 60 runs: five of their deviations are reached in one of a million times."""
    array, box, likelihood = case
    rng = np.random.default_rng(8)
    shifts = doppler_shift(path(STATE * (box[0] < box[1]), 10, likelihood), array)
    z = shifts + 0.1 * rng.standard_normal((60, *shifts.shape))
    z[:, 3, 1] = np.nan
    start = ml_initialize(z, array, 0.1, T, box, likelihood)
    degrees = 10 * len(array.positions) - 1 - np.sum(box[0] < box[1])
    assert (start.degrees == degrees).all() and start.plausible.all()
    assert abs(start.cost.mean() - degrees) < 5 * np.sqrt(2 * degrees / 60)


@pytest.mark.parametrize("wrong", ["sign", "order"])
def test_exchanged_i_and_q_or_sensors_are_not_plausible(wrong):
    """With shifts of the wrong sign the target would have to be behind the array."""
    z = doppler_shift(path(STATE, 10), RING) + 0.1 * np.random.default_rng(9).standard_normal(
        (10, 6)
    )
    assert ml_initialize(z, RING, 0.1, T, SPACE).plausible
    z = -z if wrong == "sign" else z[:, [3, 1, 2, 0, 4, 5]]
    assert not ml_initialize(z, RING, 0.1, T, SPACE).plausible


def test_what_is_too_incomplete_is_not_plausible():
    start = ml_initialize(np.full((10, 6), np.nan), RING, 0.1, T, SPACE)
    assert start.degrees == -6 and not start.plausible
