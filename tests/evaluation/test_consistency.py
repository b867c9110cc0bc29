"""NEES, NIS and their intervals, against draws of which the answer is known.

Where a test is about random numbers, it holds for all but the stated share of seeds. The seeds were
written down once and are not chosen.
"""

import math
import tomllib
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import binom, chi2, kstest, norm

from dopplerlib import Track, chi2_interval, nees, nis
from dopplerlib.estimation.imm import ImmTrack

DATA = Path(__file__).resolve().parents[2] / "data" / "mittermaier2016"
FALSE_ALARM = 1e-6


def covariances(rng, *shape):
    """Return positive definite matrices of `shape` (..., n, n) with eigenvalues around n."""
    factor = rng.normal(size=shape)
    return factor @ factor.swapaxes(-1, -2) + 0.1 * np.eye(shape[-1])


def draws(rng, P):
    """Return one Gaussian draw of mean zero for each covariance."""
    normal = rng.standard_normal((*P.shape[:-1], 1))
    return (np.linalg.cholesky(P) @ normal)[..., 0]


def track(x, P):
    return Track(x, P, None, None, None, None)


@pytest.fixture
def record():
    """Return truth, and a track whose errors are exactly as large as it claims."""
    rng = np.random.default_rng(11)
    P = covariances(rng, 50, 200, 6, 6)
    truth = rng.normal(size=(200, 6))
    return truth, track(truth + draws(rng, P), P)


def test_several_models_are_judged_like_one(record):
    truth, one = record
    many = ImmTrack(one.x, one.P, np.ones((*one.x.shape[:-1], 1)))
    np.testing.assert_array_equal(nees(many, truth), nees(one, truth))
    with pytest.raises(ValueError, match=r"^track must be a Track, got 'x'"):
        nees("x", truth)


def by_inverse(error, P):
    return np.einsum("...i,...ij,...j->...", error, np.linalg.inv(P), error)


def test_nees_is_the_quadratic_form_with_the_inverse_covariance(record):
    truth, estimate = record
    expected = by_inverse(truth - estimate.x, estimate.P)
    # Condition numbers of up to 1e4 cost an inverse four of sixteen digits.
    np.testing.assert_allclose(nees(estimate, truth), expected, rtol=1e-10)


def test_nis_is_the_quadratic_form_with_the_inverse_covariance(record):
    truth, estimate = record
    innovation = truth - estimate.x
    expected = by_inverse(innovation, estimate.P)
    np.testing.assert_allclose(nis(innovation, estimate.P), expected, rtol=1e-10)


def test_an_error_of_one_deviation_in_each_of_n_axes_has_the_value_n():
    sigma = np.array([0.5, 2.0, 8.0])
    assert nis(sigma, np.diag(sigma**2)) == 3
    assert nees(track(sigma[None], np.diag(sigma**2)[None]), np.zeros((1, 3))).tolist() == [3]


def test_nees_of_a_consistent_filter_is_chi_square_distributed(record):
    truth, estimate = record
    assert kstest(nees(estimate, truth).ravel(), chi2(6).cdf).pvalue > FALSE_ALARM


def test_nees_of_a_filter_that_claims_ten_per_cent_too_little_is_not(record):
    """The test above can fail: 10 000 values show a deviation that is 10 % too small."""
    truth, estimate = record
    too_sure = track(estimate.x, estimate.P * 0.9**2)
    assert kstest(nees(too_sure, truth).ravel(), chi2(6).cdf).pvalue < FALSE_ALARM


@pytest.mark.parametrize("m", [1, 2, 6, 9])
def test_nis_of_a_consistent_filter_has_as_its_mean_the_number_of_measurements(m):
    rng = np.random.default_rng(12)
    S = covariances(rng, 10_000, m, m)
    values = nis(draws(rng, S), S)
    total = values.sum()
    assert chi2.ppf(FALSE_ALARM / 2, m * 10_000) < total < chi2.isf(FALSE_ALARM / 2, m * 10_000)
    assert kstest(values, chi2(m).cdf).pvalue > FALSE_ALARM


def test_the_value_does_not_depend_on_the_units_or_axes_in_which_it_is_computed(record):
    truth, estimate = record
    A = np.random.default_rng(13).normal(size=(6, 6)) + 3 * np.eye(6)
    innovation, S = truth - estimate.x, estimate.P
    np.testing.assert_allclose(
        nis(innovation @ A.T, symmetric(A @ S @ A.T)), nis(innovation, S), rtol=1e-9
    )


def symmetric(matrix):
    return (matrix + matrix.swapaxes(-1, -2)) / 2


def test_a_batch_is_its_members(record):
    truth, estimate = record
    values = nees(estimate, truth)
    assert values.shape == (50, 200)
    for run in (0, 49):
        alone = track(estimate.x[run], estimate.P[run])
        np.testing.assert_array_equal(nees(alone, truth), values[run])
    innovation = truth - estimate.x
    np.testing.assert_array_equal(nis(innovation, estimate.P), values)
    np.testing.assert_array_equal(nis(innovation[3, 4], estimate.P[3, 4]), values[3, 4])


def test_one_covariance_serves_many_innovations(record):
    truth, estimate = record
    S = estimate.P[0, 0]
    many = nis(truth, S)
    assert many.shape == (200,)
    np.testing.assert_allclose(many, [nis(one, S) for one in truth], rtol=1e-12)


def test_each_run_may_have_a_truth_of_its_own(record):
    truth, estimate = record
    each = np.broadcast_to(truth, estimate.x.shape)
    np.testing.assert_array_equal(nees(estimate, each), nees(estimate, truth))


EYE = np.eye(2)
WITHOUT_P = track(np.zeros((4, 2)), None)
FINE = track(np.zeros((3, 4, 2)), np.tile(EYE, (3, 4, 1, 1)))


@pytest.mark.parametrize(
    ("estimate", "truth", "message"),
    [
        (FINE, np.zeros((5, 2)), r"truth must have shape \(\.\.\., 4, 2\), got \(5, 2\)"),
        (FINE, np.zeros((4, 6)), r"truth must have shape \(\.\.\., 4, 2\), got \(4, 6\)"),
        (FINE, np.zeros(2), r"truth must have shape \(\.\.\., 4, 2\), got \(2,\)"),
        (FINE, np.full((4, 2), np.nan), "truth must be finite, got nan"),
        (FINE, np.zeros((2, 4, 2)), r"truth must have leading axes .*\(3,\) of track\.x, got \(2,"),
        (WITHOUT_P, np.zeros((4, 2)), r'track must hold P, got None: ask ekf .*keep=\("P",\)'),
        (
            track(FINE.x, 0 * FINE.P),
            np.ones((4, 2)),
            "track.P must be positive definite, .*singular",
        ),
        (
            track(FINE.x, -FINE.P),
            np.ones((4, 2)),
            "track.P must be positive semidefinite, got a smallest eigenvalue of -1",
        ),
    ],
)
def test_nees_refuses_what_does_not_belong_together(estimate, truth, message):
    with pytest.raises(ValueError, match=message):
        nees(estimate, truth)


@pytest.mark.parametrize(
    ("innovation", "S", "message"),
    [
        ([1, 2, 3], EYE, r"S must have shape \(\.\.\., 3, 3\), got \(2, 2\)"),
        (1.0, EYE, r"innovation must have shape \(\.\.\., any\), got \(\)"),
        ([1, np.inf], EYE, "innovation must be finite, or NaN where it is missing, got inf"),
        ([1, np.nan], [[-1, 0], [0, 1]], "S must be positive definite"),
        ([1, np.nan], [[np.nan, 0], [0, 1]], "S must be finite, got nan"),
        ([1, 2], np.inf * np.ones((2, 2)), "S must be finite, got inf"),
        ([1, 2], [[1, 0.5], [0, 1]], "S must be symmetric, got a difference of 0.5"),
        ([1, 2], [[1, 2], [2, 1]], "S must be positive definite, got a smallest eigenvalue of -1"),
        ([1, 2], [[1, 1], [1, 1]], "S must be positive definite"),
        (np.ones((5, 2)), np.tile(EYE, (4, 1, 1)), r"innovation must have leading .*\(4,\) of S"),
    ],
)
def test_nis_refuses_what_is_no_innovation_with_its_covariance(innovation, S, message):
    with pytest.raises(ValueError, match=message):
        nis(innovation, S)


def upper_tail(x, dof):
    """Return the probability that chi-square exceeds x: a finite sum if dof is even."""
    assert dof % 2 == 0
    half = x / 2
    logs = [j * math.log(half) - half - math.lgamma(j + 1) for j in range(dof // 2)]
    return math.fsum(math.exp(value) for value in logs)


@pytest.mark.parametrize("confidence", [0.5, 0.9, 0.95, 0.99, 1 - 1e-6, 1 - 3 * 2**-53])
@pytest.mark.parametrize(("dof", "runs"), [(2, 1), (4, 1), (6, 1), (6, 50), (3, 20), (1, 1000)])
def test_the_interval_leaves_the_same_probability_on_either_side(dof, runs, confidence):
    lower, upper = chi2_interval(dof, runs, confidence)
    tail = (1 - confidence) / 2
    assert upper_tail(runs * upper, runs * dof) == pytest.approx(tail, rel=1e-9, abs=0)
    if tail > 1e-9:  # below that, one minus the sum has no digits left
        assert 1 - upper_tail(runs * lower, runs * dof) == pytest.approx(tail, rel=1e-6, abs=0)


def test_the_interval_for_one_degree_of_freedom_is_that_of_a_squared_normal():
    lower, upper = chi2_interval(1)
    assert upper == pytest.approx(norm.isf(0.0125) ** 2, rel=1e-12)
    assert lower == pytest.approx(norm.isf(0.4875) ** 2, rel=1e-12)


def test_the_interval_is_the_one_that_the_paper_prints():
    printed = tomllib.loads((DATA / "table2.toml").read_text(encoding="utf-8"))["quoted"]
    assert [round(bound, 3) for bound in chi2_interval(6)] == printed["nis_bounds_95"]


@pytest.mark.parametrize("runs", [1, 10])
def test_the_interval_holds_its_share_of_averages(runs):
    trials = 20_000
    rng = np.random.default_rng(14)
    average = np.mean(np.sum(rng.standard_normal((trials, runs, 6)) ** 2, axis=-1), axis=-1)
    lower, upper = chi2_interval(6, runs)
    inside = np.sum((lower <= average) & (average <= upper))
    fair = binom(trials, 0.95)
    assert fair.ppf(FALSE_ALARM / 2) <= inside <= fair.isf(FALSE_ALARM / 2)


def test_averaging_narrows_the_interval_about_the_degrees_of_freedom():
    lower, upper = chi2_interval(6, runs=1_000_000)
    # The average is nearly normal with variance 2 * 6 / 1e6; the next term is about 1e-3 of it.
    half = norm.isf(0.025) * math.sqrt(12e-6)
    assert upper - 6 == pytest.approx(half, rel=5e-3)
    assert 6 - lower == pytest.approx(half, rel=5e-3)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"dof": 0}, "dof must be a whole number of at least 1, got 0"),
        ({"dof": 6.0}, "dof must be a whole number of at least 1, got 6.0"),
        ({"dof": 6, "runs": 0}, "runs must be a whole number of at least 1, got 0"),
        ({"dof": 6, "confidence": 1.0}, "confidence must lie between 0 and 1, got 1.0"),
        ({"dof": 6, "confidence": 95}, "confidence must lie between 0 and 1, got 95"),
        ({"dof": 6, "confidence": 0}, "confidence must .*, got 0"),
        ({"dof": 6, "confidence": np.nan}, "confidence must be finite, got nan"),
    ],
)
def test_an_impossible_interval_is_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        chi2_interval(**arguments)
