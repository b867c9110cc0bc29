"""Yardsticks: the saved studies come out again, ratios and shares are those of small cases."""

import numpy as np
import pytest

from dopplerlib.workspace import yardsticks
from studies import exact_posterior
from studies import yardsticks as study


def test_the_saved_posterior_comes_out_again():
    """The first run of case D; the draws hang on the Gaussian sum, so up to their scatter."""
    seed, draws = (exact_posterior.PARAMETERS[name] for name in ("seed", "draws"))
    saved = yardsticks.saved_yardsticks("D")
    efficiency, nees, position, velocity = yardsticks.posterior_errors(
        "D", 0, 1, seed=seed, draws=draws
    )[:, 0]
    # A mean is off by 1 / sqrt(effective draws) deviations: five of these, in each of the two.
    least = np.minimum(efficiency, saved.efficiency[0])
    scatter = 5 * np.sqrt(2 / (draws * least))
    assert (np.abs(np.sqrt(nees) - np.sqrt(saved.nees[0])) < 6**0.5 * scatter + 0.1).all()
    for one, other in ((position, saved.position[0]), (velocity, saved.velocity[0])):
        deviation = np.abs(one - other) / np.maximum(one, other)
        assert (deviation < 0.05 + 3 * scatter).all()


def test_the_saved_errors_of_the_gaussian_sum_come_out_again():
    seed = study.PARAMETERS["seed"]
    for case in "BC":
        got = yardsticks.bank_errors(case, 0, 2, seed=seed)
        saved = yardsticks.saved_yardsticks(case)
        names = "bank_nees", "bank_position", "bank_velocity", "position_bound", "velocity_bound"
        for value, name in zip(got, names, strict=True):
            # Four digits are saved.
            np.testing.assert_allclose(getattr(saved, name)[:2], value, rtol=1e-3)


def test_the_exact_posterior_is_consistent_and_no_tracker_beats_it():
    """Of truths from the prior: mean NEES is 6 within four standard errors (6e-5 each)."""
    for case in "AB":
        y = yardsticks.saved_yardsticks(case)
        # A mean over what came out would hide a run in which the posterior did not.
        np.testing.assert_array_equal(np.isnan(y.nees), np.isnan(y.bank_nees))
        for nees, own, bank in zip(y.nees.T, y.position.T, y.bank_position.T, strict=True):
            nees = nees[~np.isnan(nees)]
            assert abs(nees.mean() - 6) < 4 * nees.std() / len(nees) ** 0.5
            ratio = yardsticks.rms_ratio(bank, own, rng=np.random.default_rng(1))
            assert ratio.high > 1
        assert np.nanmedian(y.efficiency, axis=0).min() > 0.2


def test_a_ratio_leaves_out_runs_without_both():
    rng = np.random.default_rng(2)
    one, other = [3.0, np.nan, 4.0, 7.0], [1.0, 5.0, 2.0, np.nan]
    found = yardsticks.rms_ratio(one, other, rng=rng)
    assert found.value == pytest.approx((25 / 5) ** 0.5)
    with pytest.raises(ValueError, match="other must have the shape"):
        yardsticks.rms_ratio(one, other[:3], rng=rng)


def test_the_means_of_a_shell_are_arithmetic_and_harmonic():
    P = np.array([np.diag([v, *[1e-30] * 5]) for v in (1.0, 3.0, 10.0)])
    arithmetic, harmonic = yardsticks.shell_bounds([0.2, 0.3, 0.8], P, [0, 0.5, 1, 2])
    np.testing.assert_allclose(arithmetic**2, [2, 10, np.nan])
    np.testing.assert_allclose(harmonic**2, [1.5, 10, np.nan])
