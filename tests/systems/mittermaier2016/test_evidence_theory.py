"""What is judged of covariances, right models and other motions, computed by another route."""

import numpy as np
import pytest

from dopplerlib._data import read_json, results
from dopplerlib.systems.mittermaier2016.evidence import (
    _first_covariance as first_covariance,
)
from dopplerlib.systems.mittermaier2016.evidence import (
    _other_motion as other_motion,
)
from dopplerlib.systems.mittermaier2016.evidence import (
    _right_models as right_models,
)
from studies import turned_ring as study
from tests.systems.mittermaier2016 import textbook

RUNS = 6
STARTS = {"Table 2": textbook.TABLE2, "as drawn": np.r_[0.677, textbook.TABLE2[1:]]}


def records(rng, sensors, truth, runs=RUNS):
    """Return shifts with the noise that a record of the library has."""
    noise = np.stack([run.standard_normal((len(truth), 6)) for run in rng.spawn(runs)])
    return textbook.shift(truth, sensors) + 0.4 * noise


def distance(x, truth):
    return np.sqrt(np.sum((x - truth)[..., :3] ** 2, axis=-1))


# The initial covariance


@pytest.fixture(scope="module")
def covariances():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(first_covariance, "_RUNS", RUNS)
        return first_covariance.covariance_evidence(np.random.default_rng(4))


@pytest.fixture(scope="module")
def children():
    return np.random.default_rng(4).spawn(6)


def test_a_larger_covariance_is_compared_with_a_smaller_one(covariances):
    rng = np.random.default_rng(4).spawn(6)[0].spawn(2)[0]
    sensors, truth = textbook.ring(), textbook.path()
    z = records(rng, sensors, truth)
    large, small = (
        distance(textbook.extended(z, STARTS["as drawn"], p * np.eye(6), sensors)[0], truth)
        for p in (0.01, 0.001)
    )
    points = covariances["larger-covariance"].points
    for average, power in (("mean", 1), ("root mean square", 2)):
        ratio = (large**power).mean(axis=1) / (small**power).mean(axis=1)
        point = points["as drawn", "0.01 I with 0.001 I", average]
        assert point.value == pytest.approx(np.median(ratio ** (1 / power)), rel=1e-4)


def test_noise_on_a_covariance_stays_off_the_diagonal_and_has_its_size():
    """Eigenvalues are positive; 15 elements of 4000 matrices tell a deviation to 0.3 %.

    A twentieth of the diagonal is so small that none is refused: the deviation is as asked for.
    """
    P = first_covariance.noisy_covariances(0.05, 4000, np.random.default_rng(5))
    np.testing.assert_allclose(P, np.swapaxes(P, -1, -2), atol=0)
    np.testing.assert_array_equal(np.diagonal(P, axis1=-2, axis2=-1), 0.1)
    upper = P[:, *np.triu_indices(6, 1)]
    assert upper.std() == pytest.approx(0.005, rel=0.02)
    wild = first_covariance.noisy_covariances(0.3, 50, np.random.default_rng(5))
    np.linalg.cholesky(wild)


def test_noise_on_the_covariance_changes_the_error_at_a_time(covariances):
    """The matrices are those of the evidence, since noise is refused until it is a covariance."""
    records_of, noise = np.random.default_rng(4).spawn(6)[:2]
    sensors, truth = textbook.ring(), textbook.path(101)
    z = records(records_of.spawn(2)[0], sensors, textbook.path())[:, :101]
    P0 = first_covariance.noisy_covariances(0.1, RUNS, noise.spawn(5)[1])
    noisy, plain = (
        distance(textbook.extended(z, STARTS["Table 2"], P, sensors)[0], truth)
        for P in (P0, 0.1 * np.eye(6))
    )
    for moment, k in ((0.1, 100), (0.05, 50)):
        point = covariances["noise-on-covariance"].points["Table 2", 0.1, moment]
        assert point.value == pytest.approx(np.median(noisy[:, k] / plain[:, k]), rel=1e-4)


def test_the_initial_nees_without_noise_is_a_sum_of_squares(covariances):
    for name, start in STARTS.items():
        values = covariances["nees-initial"].points[name, 0.0].values
        expected = np.sum((start - textbook.TRUTH) ** 2) / 0.1
        np.testing.assert_allclose(values, expected, rtol=1e-9)


def test_the_initial_nees_with_noise_has_the_mean_of_a_series():
    """E[(1 + N)^-1] to second order: 1 + E[N^2], which is 1 + 5 share^2 on the diagonal.

    The fourth order is some 70 share^4, 0.04 % at a twentieth; 20 000 draws are good to 0.2 %.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(first_covariance, "_MATRICES", 20_000)
        found = first_covariance._initial_nees(np.random.default_rng(6), "as drawn", 0.05)
    plain = np.sum((STARTS["as drawn"] - textbook.TRUTH) ** 2) / 0.1
    expected = plain * (1 + 5 * 0.05**2)
    assert found["nees-initial"].values.mean() == pytest.approx(expected, rel=0.005)


def test_a_mirrored_state_has_the_same_shifts_and_the_others_another_range():
    sensors = textbook.ring()
    mirrored = first_covariance.bad_start("mirrored in the plane of the sensors")
    np.testing.assert_allclose(
        textbook.shift(mirrored, sensors), textbook.shift(textbook.TRUTH, sensors), rtol=1e-12
    )
    assert mirrored[0] == -textbook.TRUTH[0]
    for name, away in (("0.3 m too far", 0.3), ("0.3 m too near", -0.3)):
        state = first_covariance.bad_start(name)
        change = np.linalg.norm(state[:3]) - np.linalg.norm(textbook.TRUTH[:3])
        assert change == pytest.approx(away)
        np.testing.assert_array_equal(state[3:], textbook.TRUTH[3:])


def test_a_bad_start_is_compared_with_that_of_table_2(covariances):
    name = "0.3 m too far"
    order = ["mirrored in the plane of the sensors", name, "0.3 m too near"]
    rng = np.random.default_rng(4).spawn(6)[3].spawn(3)[order.index(name)]
    sensors, truth = textbook.ring(), textbook.path()
    z = records(rng, sensors, truth)
    P0, start = 0.1 * np.eye(6), textbook.TRUTH.copy()
    start[:3] *= 1 + 0.3 / np.linalg.norm(start[:3])
    bad, usual = (
        distance(textbook.extended(z, x, P0, sensors)[0], truth).mean(axis=1)
        for x in (start, textbook.TABLE2)
    )
    point = covariances["bad-start"].points[name,]
    assert point.value == pytest.approx(np.median(bad / usual), rel=1e-4)


def test_what_the_tangent_misses_of_the_actual_start(covariances):
    sensors = textbook.ring()
    for name, start in STARTS.items():
        error = textbook.TRUTH - start
        missed = textbook.shift(textbook.TRUTH, sensors) - textbook.shift(start, sensors)
        missed -= textbook.slope(start, sensors) @ error
        expected = np.sqrt(np.mean(missed**2)) / 0.4
        point = covariances["tangent-first"].points[name, "actual"]
        assert point.value == pytest.approx(expected, rel=1e-6)


def test_what_the_tangent_misses_under_a_small_covariance_is_half_the_curvature():
    """To second order the missed shift is x' C x / 2: mean square (tr C)^2 / 4 + tr C^2 / 2.

    Third order is of relative size sigma over the distance, 1 %; 40 draws of 400 states leave 2 %.
    """
    sensors, sigma = textbook.ring(), 0.003
    x = np.repeat(textbook.TRUTH[None], 400, axis=0)
    tried = first_covariance.errors_of(
        x, sigma**2 * np.eye(6), textbook.TRUTH, "believed", np.random.default_rng(8)
    )
    steps = 1e-5 * np.eye(6)
    curved = (
        textbook.slope(textbook.TRUTH + steps, sensors)
        - textbook.slope(textbook.TRUTH - steps, sensors)
    ) / 2e-5
    C = np.swapaxes(curved, 0, 1)  # sensor, component, component
    mean = np.trace(C, axis1=1, axis2=2) / 2
    square = mean**2 + np.sum(C * np.swapaxes(C, 1, 2), axis=(1, 2)) / 2
    expected = sigma**2 * np.sqrt(square.mean()) / 0.4
    found = np.sqrt(np.mean(first_covariance.neglected(x, tried) ** 2))
    assert found == pytest.approx(expected, rel=0.1)


@pytest.fixture(scope="module")
def ungated():
    """Return runs of the filter from Table 2 without a gate, as the evidence draws them."""
    child = np.random.default_rng(4).spawn(6)[4].spawn(6)[0]
    sensors, truth = textbook.ring(), textbook.path()
    z = records(child, sensors, truth)
    return truth, textbook.extended(z, textbook.TABLE2, 0.1 * np.eye(6), sensors)


def test_how_many_runs_are_consistent(covariances, ungated):
    truth, (x, P, *_) = ungated
    for moment, k in ((0.05, 50), (0.1, 100), (0.5, 500), (1.0, 1000)):
        error = x[:, k] - truth[k]
        nees = [float(e @ np.linalg.inv(p) @ e) for e, p in zip(error, P[:, k], strict=True)]
        share = np.mean([textbook.LOW < one < textbook.HIGH for one in nees])
        point = covariances["filter-consistent"].points["none", "Table 2", moment]
        assert point.value == pytest.approx(share)


def test_what_the_tangent_misses_of_later_errors(covariances, ungated):
    truth, (x, *_) = ungated
    sensors = textbook.ring()
    for moment, k in ((0.2, 200), (0.5, 500)):
        error = truth[k] - x[:, k]
        missed = textbook.shift(truth[k], sensors) - textbook.shift(x[:, k], sensors)
        missed -= (textbook.slope(x[:, k], sensors) @ error[..., None])[..., 0]
        expected = np.median(np.sqrt(np.mean(missed**2, axis=-1))) / 0.4
        point = covariances["tangent-later"].points["none", "Table 2", moment, "actual"]
        assert point.value == pytest.approx(expected, rel=1e-3)


# Right models


def test_matched_targets_move_as_the_filter_expects():
    """Eq 17: one push for all axes; its moments from 400 runs of 200 steps, to 1 %."""
    truth, z = right_models.matched_records(np.random.default_rng(9), 400, 0.01, 200)
    kicks = np.diff(truth[..., 3:], axis=1)
    np.testing.assert_allclose(kicks, kicks[..., :1].repeat(3, axis=-1), atol=1e-12)
    assert kicks.std() == pytest.approx(0.4 * 1e-3, rel=0.02)
    moved = np.diff(truth[..., :3], axis=1) - 1e-3 * truth[:, :-1, 3:]
    np.testing.assert_allclose(moved, kicks * 1e-3 / 2, atol=1e-12)
    noise = z - textbook.shift(truth, textbook.ring())
    assert noise.std() == pytest.approx(0.4, rel=0.01)
    before = truth[:, 0, :3] - 1e-3 * truth[:, 0, 3:] - textbook.TRUTH[:3]
    # 1200 numbers tell a deviation to 2 %: five times that.
    assert before.std() == pytest.approx(0.01, rel=0.1)


@pytest.fixture(scope="module")
def right():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(right_models, "_RUNS", 40)
        patch.setattr(right_models, "_MANY", 2000)
        return right_models.right_evidence(np.random.default_rng(10))


def test_averages_are_the_dimension_if_all_is_right(right):
    """Forty averages of NIS are good to 0.3 %, two thousand NEES to 1.3 %: four times that."""
    for deviation in (0.001, 0.01):
        assert right["nis-expectation"].points[deviation,].value < 0.012
        assert right["nees-expectation"].points[deviation,].value < 0.06
        assert right["nis-expectation"].points[deviation,].low >= 0


def test_a_difference_is_told_without_its_sign():
    below = right_models._away_from(6, 5.7 + 0.01 * np.random.default_rng(1).standard_normal(99))
    assert below.value == pytest.approx(0.05, abs=1e-3)
    assert below.low < below.value < below.high


def test_nis_of_right_models_is_worth_what_independent_numbers_are(right):
    """Of 40 000 numbers, twenty autocorrelations are good to 0.5 % each, their sum to 4.5 %."""
    assert right["nis-independent"].points[0.01,].value == pytest.approx(1, abs=0.2)
    rng = np.random.default_rng(11)
    free = rng.chisquare(6, (50, 1001))
    assert right_models.worth(free).value == pytest.approx(1, abs=0.15)
    # A moving average of two has the autocorrelation one half at lag 1: worth half as much. Its
    # values are made to have the mean and the variance of the others again.
    pairs = 6 + (free[:, 1:] + free[:, :-1] - 12) / np.sqrt(2)
    assert right_models.worth(pairs).value == pytest.approx(0.5, abs=0.06)


def test_nees_of_right_models_is_worth_few_numbers(right):
    """By the spread of averages over a record: 12 over the variance is their number.

    The variance of 60 averages with heavy tails is known to 22 %: three times that.
    """
    truth, z = right_models.matched_records(np.random.default_rng(12), 60, 0.01, 1001)
    x, P, *_ = textbook.extended(
        z, textbook.TRUTH + np.r_[1e-3 * textbook.TRUTH[3:], 0, 0, 0], 1e-4 * np.eye(6),
        textbook.ring(),
    )  # fmt: skip
    error = x - truth
    nees = np.sum(error * np.linalg.solve(P, error[..., None])[..., 0], axis=-1)
    number = 12 / np.var(nees.mean(axis=1))
    found = 1001 * right["nees-independent"].points[0.01,]
    assert found == pytest.approx(number, rel=0.66)


def test_innovations_of_right_models_have_the_mean_of_their_noise(right):
    """The largest of six half-normal numbers has a median of 1.6 deviations, here of 0.4 / root K.

    Innovations are hardly larger than the noise; medians of 40 runs are good to 6 %.
    """
    for left_out in (0, 10, 100, 150):
        expected = 1.6 * 0.4 / np.sqrt(1001 - left_out)
        found = np.median(right["innovation-zero"].points[0.001, left_out].values)
        assert found == pytest.approx(expected, rel=0.3)


@pytest.mark.parametrize("size", [3.5, 5, 10, 15])
def test_an_outlier_is_seen_as_often_as_in_a_simulation(right, size):
    """NIS of six normal numbers, one of them moved; 40 000 tries are good to 0.25 %."""
    normal = np.random.default_rng(13).standard_normal((40_000, 6))
    normal[:, 0] += size
    share = np.mean((normal**2).sum(axis=1) > textbook.HIGH)
    assert right["nis-outliers"].points[size,] == pytest.approx(share, abs=0.01)


def test_the_kalman_filter_is_the_best_linear_estimator(right):
    assert right["best-linear"] == pytest.approx(1, abs=1e-6)


# Other rings and motions


def test_a_turned_ring_is_compared_with_the_one_as_drawn():
    found = other_motion.turned_rings("upper", "as drawn", 4, np.random.default_rng(14))
    noise = 0.4 * np.random.default_rng(14).standard_normal((4, 1001, 6))
    truth, error = textbook.path(), {}
    for angle in (0, 20):
        sensors = textbook.ring(angle)
        z = textbook.shift(truth, sensors) + noise
        x, *_ = textbook.extended(z, STARTS["as drawn"], 0.1 * np.eye(6), sensors, gate="upper")
        error[angle] = np.abs(x - truth)[..., [1, 2, 5]]
    for place, size in enumerate(
        ({a: e.mean(axis=1) for a, e in error.items()}, {a: e[:, -1] for a, e in error.items()})
    ):
        np.testing.assert_allclose(np.exp(found[:, 1, place]), size[20] / size[0], rtol=1e-3)


def test_parts_of_the_study_come_out_again_and_make_the_ratios():
    """One of its parts; and the geometric mean over all of them, by hand, with its interval."""
    stored = read_json("turned_ring.json", folder=results)
    settings = study.PARAMETERS | {"gate": "two-sided", "start": "Table 2"}
    again = study.compute(settings, settings["seed"], range(5, 6))
    kept = next(
        one
        for one in stored["parts"]
        if (one["gate"], one["start"], one["chunk"]) == ("two-sided", "Table 2", 5)
    )
    # Five digits are kept, and processors differ in the last bits of a thousand cycles.
    np.testing.assert_allclose(again["mean"][0], kept["mean"], atol=1e-4)
    np.testing.assert_allclose(again["square"][0], kept["square"], atol=1e-3)
    parts = [p for p in stored["parts"] if (p["gate"], p["start"]) == ("none", "as drawn")]
    means = np.array([p["mean"] for p in parts])
    found = other_motion._rotation()
    for axis, place in (("y", 0), ("z", 1), ("vz", 2)):
        point = found[f"rotation-{axis}"].points["none", "as drawn", 30, "at the end"]
        of_parts = means[:, 2, 1, place]
        assert point.value == pytest.approx(np.exp(of_parts.mean()))
        # The spread of the parts tells the interval, too, but their number is small: within 2.5.
        half = 1.96 * of_parts.std(ddof=1) / np.sqrt(len(parts))
        assert np.log(point.high / point.low) / 2 == pytest.approx(half, rel=1.5)


def test_what_the_tangent_misses_of_a_braking_target():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(other_motion, "_BRAKING", 6)
        found = other_motion._decelerated(
            np.random.default_rng(15), 0.75, "shared", "Table 2", 0.3, "actual"
        )
    sensors, truth = textbook.ring(), textbook.path(301)
    # The speed falls evenly from the first sample on: the way is that of the mean speed.
    speed = np.linalg.norm(textbook.TRUTH[3:])
    t = 1e-3 * np.arange(301)
    slower = (speed - 0.75 * t) / speed
    truth[:, 3:] *= slower[:, None]
    way = (speed + (speed - 0.75 * t)) / 2 * t
    truth[:, :3] = textbook.TRUTH[:3] + way[:, None] * textbook.TRUTH[3:] / speed
    noise = 0.4 * np.random.default_rng(15).standard_normal((6, 301, 6))
    x, *_ = textbook.extended(
        textbook.shift(truth, sensors) + noise, textbook.TABLE2, 0.1 * np.eye(6), sensors,
        Q=0.75**2 * np.outer(textbook.G, textbook.G),
    )  # fmt: skip
    error = truth[-1] - x[:, -1]
    missed = textbook.shift(truth[-1], sensors) - textbook.shift(x[:, -1], sensors)
    missed -= (textbook.slope(x[:, -1], sensors) @ error[..., None])[..., 0]
    expected = np.median(np.sqrt(np.mean(missed**2, axis=-1))) / 0.4
    assert found["constant-acceleration"].value == pytest.approx(expected, rel=1e-3)


def test_filters_of_a_turning_target():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(other_motion, "_TURNING", 4)
        found = other_motion._turning(np.random.default_rng(16), 3.0, 0.5)
    sensors, rng = textbook.ring(), np.random.default_rng(16)
    # On a circle about the point to the left of the target, by complex numbers in the plane.
    t = 1e-3 * np.arange(1001)
    velocity = complex(*textbook.TRUTH[3:5]) * np.exp(3j * t)
    place = complex(*textbook.TRUTH[:2]) + (velocity - velocity[0]) / 3j
    truth = np.zeros((1001, 6))
    truth[:, 0], truth[:, 1], truth[:, 2] = place.real, place.imag, textbook.TRUTH[2]
    truth[:, 3], truth[:, 4] = velocity.real, velocity.imag
    z = textbook.shift(truth, sensors) + 0.4 * rng.standard_normal((4, 1001, 6))
    start = truth[0] + 0.01 * rng.standard_normal((4, 6))
    push = 0.5 * 3.0 * abs(velocity[0])
    gain = np.concatenate([0.5e-6 * np.eye(3), 1e-3 * np.eye(3)])
    Q, P0 = push**2 * gain @ gain.T, 1e-4 * np.eye(6)
    bent = textbook.cubature(z, start, P0, sensors, Q)
    straight, *_ = textbook.extended(z, start, P0, sensors, Q=Q)
    ratio = np.divide(*(np.sqrt((distance(x, truth) ** 2).mean(axis=1)) for x in (bent, straight)))
    assert found["ukf-turns"].value == pytest.approx(np.median(ratio), rel=1e-6)
