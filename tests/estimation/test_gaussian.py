"""The algebra of all filters, against the same without the rows of missing measurements."""

import numpy as np
import pytest

from dopplerlib.estimation import gaussian

n, m, runs = 4, 3, 5
RNG = np.random.default_rng(21)


def covariance(size, *batch):
    root = RNG.standard_normal((*batch, size, size))
    return root @ root.mT + 0.1 * np.eye(size)


x, P = RNG.standard_normal((runs, n)), covariance(n, runs)
F, Q, H, R = RNG.standard_normal((n, n)), covariance(n), RNG.standard_normal((m, n)), covariance(m)
innovation = RNG.standard_normal((runs, m))


@pytest.mark.parametrize("there", [[True, False, True], [False, True, False]])
def test_missing_components_are_as_if_they_had_no_row(there):
    """The marginal of a Gaussian is what is left of it without the row."""
    holes = np.where(there, innovation, np.nan)
    got, got_P, S = gaussian.update(x, P, holes, H, R)
    want, want_P, small = gaussian.update(x, P, innovation[:, there], H[there], R[there][:, there])
    # The same sums in another order, of numbers of about one.
    np.testing.assert_allclose(got, want, rtol=0, atol=1e-12)
    np.testing.assert_allclose(got_P, want_P, rtol=0, atol=1e-12)
    np.testing.assert_allclose(S, H @ P @ H.T + R, rtol=1e-12)
    np.testing.assert_allclose(S[:, there][:, :, there], small, rtol=1e-12)


def test_each_run_may_miss_something_else_and_one_that_misses_all_keeps_every_bit():
    holes = innovation.copy()
    holes[1, 0] = holes[2, 1:] = holes[3] = np.nan
    got, got_P, _ = gaussian.update(x, P, holes, H, R)
    for run in range(runs):
        there = ~np.isnan(holes[run])
        want, want_P, _ = gaussian.update(
            x[run], P[run], holes[run][there], H[there], R[there][:, there]
        )
        np.testing.assert_allclose(got[run], want, rtol=0, atol=1e-12)
        np.testing.assert_allclose(got_P[run], want_P, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(got[3], x[3])
    np.testing.assert_array_equal(got_P[3], P[3])


def test_results_are_symmetric_whatever_rounding_the_arguments_have_across_the_diagonal():
    lopsided = 1e-10 * np.triu(np.ones((n, n)), 1)
    _, predicted = gaussian.predict(x, P + lopsided, F, Q + lopsided)
    _, updated, S = gaussian.update(x, P + lopsided, innovation, H, R + lopsided[:m, :m])
    _, smoothed = gaussian.smooth(x, P + lopsided, F, Q + lopsided, x, P + lopsided)
    for matrix in (predicted, updated, S, smoothed):
        np.testing.assert_array_equal(matrix, matrix.mT)


def test_what_is_not_finite_stays_so_and_does_not_reach_the_other_runs():
    broken = P.copy()
    broken[1, 0, 0] = np.inf
    _, got_P = gaussian.predict(x, broken, F, Q)
    _, want_P = gaussian.predict(x, P, F, Q)
    others = [0, 2, 3, 4]
    np.testing.assert_allclose(got_P[others], want_P[others], rtol=1e-12)
    assert not np.isfinite(got_P[1]).all()
    _, updated, _ = gaussian.update(x, broken, innovation, H, R)
    assert np.isfinite(updated[others]).all() and not np.isfinite(updated[1]).any()
