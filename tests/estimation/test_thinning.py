"""Remedies for correlated errors, and what they cost: closed forms, and filters that were run."""

import numpy as np
import pytest
from scipy.signal import lfilter

from dopplerlib import effective_samples, innovation_whiteness, kf
from dopplerlib.estimation.thinning import remedy_errors, thinning
from dopplerlib.model.motion import cwna_process_noise, ncv_transition

RHO = 0.8
F, Q, H = ncv_transition(1.0, dim=1), cwna_process_noise(1.0, 1e-3, dim=1), np.array([[1.0, 0.0]])


def ar1(runs, K, rng):
    new = rng.standard_normal((runs, K))
    new[:, 1:] *= np.sqrt(1 - RHO**2)
    return lfilter([1], [1, -RHO], new, axis=1)


@pytest.fixture(scope="module")
def errors():
    return ar1(2000, 1000, np.random.default_rng(1))


def test_errors_that_are_kept_are_rejected_as_often_as_stated(errors):
    """Of 2000 records: three deviations of a tenth are 0.02, and 0.01 is the law's own error."""
    kept = thinning(RHO, 1000)
    assert 0.05 < kept.rejected <= 0.1
    for every, want in ((kept.every, kept.rejected), (2 * kept.every, 0.05)):
        some = errors[:, ::every, None]
        p = innovation_whiteness(some, np.ones((1, some.shape[1], 1, 1)), 10).p_value
        assert np.mean(p < 0.05) == pytest.approx(want, abs=0.03)


def test_one_less_would_be_rejected_more_often():
    kept = thinning(RHO, 1000, rejected=0.2)
    fewer = 1000 // (kept.every - 1)
    assert kept.rejected <= 0.2
    assert thinning(RHO ** (kept.every - 1), fewer, rejected=0.2).every == 2


def test_the_loss_for_a_constant_is_that_of_the_best_mean():
    """Of 20 000 samples: the ends matter by 1e-3. Best: the inverse of the covariance, tridiagonal.

    The information of n AR(1) values about their mean is (n - (n - 2) rho) / (1 + rho).
    """
    n = 20_000
    kept = thinning(RHO, n)
    best = (n - (n - 2) * RHO) / (1 + RHO)
    some = n // kept.every
    lags = kept.correlation ** np.arange(1, some)
    assert kept.efficiency == pytest.approx(effective_samples(lags, some) / best, rel=2e-3)
    assert kept.variance_ratio == pytest.approx(some / effective_samples(lags, some), rel=2e-3)


def test_white_errors_are_all_kept_and_lose_nothing():
    kept = thinning(0.0, 1000)
    assert (kept.every, kept.efficiency, kept.variance_ratio) == (1, 1.0, 1.0)


def test_the_variances_are_those_of_filters_that_were_run():
    """A thousand runs, of which each gives some 20 independent errors: 5 % is five deviations."""
    runs, K, every = 1000, 400, 5
    rng = np.random.default_rng(2)
    push = rng.multivariate_normal(np.zeros(2), Q, (runs, K))
    truth = np.empty((runs, K, 2))
    x = np.zeros((runs, 2))
    for k in range(K):
        x = x @ F.T + push[:, k]
        truth[:, k] = x
    z = truth[..., :1] + ar1(runs, K, rng)[..., None]
    thin = np.where((np.arange(K) % every == 0)[:, None], z, np.nan)
    want = remedy_errors(F, Q, H, RHO, every)
    for name, seen, R in (("white", z, 1), ("inflated", z, 9), ("thinned", thin, 1)):
        track = kf(seen, F, Q, H, [[R]], np.zeros(2), np.eye(2))
        settled = slice(150, None)
        error = (track.x - truth)[:, settled]
        power = np.mean(error**2, axis=(0, 1))
        np.testing.assert_allclose(power, np.diagonal(want[name].actual), rtol=0.05)
        reported = track.P[0, settled].mean(axis=0)
        np.testing.assert_allclose(reported, want[name].reported, rtol=1e-6)


def test_a_slow_filter_loses_as_the_mean_of_a_constant():
    """A random walk that hardly moves: variances go with the root of q times that of a mean.

    Thinned, the loss is that of `thinning`; inflated, there is none. At q = 1e-8 the filter
    averages 3000 samples, of which the memory of nine is a part of 3e-3.
    """
    kept = thinning(RHO, 1000)
    errors = remedy_errors([[1]], [[1e-8]], [[1]], RHO, kept.every)
    best = errors["colored"].actual[0, 0]
    assert best == pytest.approx(np.sqrt(1e-8 * (1 + RHO) / (1 - RHO)), rel=5e-3)
    assert errors["inflated"].actual[0, 0] == pytest.approx(best, rel=5e-3)
    thinned, white = errors["thinned"], errors["white"]
    # Between r claimed and R actual, the error is sqrt(q r) (1 + R / r) / 2.
    ratio = kept.variance_ratio
    claimed = np.sqrt(1e-8 * kept.every)
    assert thinned.reported[0, 0] == pytest.approx(claimed, rel=5e-3)
    assert thinned.actual[0, 0] == pytest.approx(claimed * (1 + ratio) / 2, rel=5e-3)
    assert white.actual[0, 0] == pytest.approx(1e-4 * (1 + 9) / 2, rel=5e-3)


def test_no_filter_is_better_than_the_optimal_one_and_all_agree_on_white_errors():
    for rho in (-0.6, 0.3, 0.95):
        errors = remedy_errors(F, Q, H, rho, 3)
        best = errors["colored"].actual
        for error in errors.values():
            assert np.linalg.eigvalsh(error.actual - best)[0] > -1e-9
    for error in remedy_errors(F, Q, H, 0.0, 1).values():
        np.testing.assert_allclose(error.actual, best_of_white(), rtol=1e-8)


def best_of_white():
    return kf(np.zeros((400, 1)), F, Q, H, [[1.0]], np.zeros(2), np.eye(2)).P[-1]


def test_wrong_arguments_are_named():
    for rho in (1.0, -1.0, 2.0):
        with pytest.raises(ValueError, match=r"rho must be inside \(-1, 1\), got"):
            thinning(rho, 100)
        with pytest.raises(ValueError, match=r"rho must be inside \(-1, 1\), got"):
            remedy_errors(F, Q, H, rho)
    with pytest.raises(ValueError, match=r"rejected must be above level = 0\.05, got 0\.04"):
        thinning(0.5, 100, rejected=0.04)
