"""The posterior by importance sampling, against quadrature and where the problem is linear."""

import numpy as np
import pytest
from scipy.special import logsumexp
from scipy.stats import chi2

from dopplerlib import RadarArray, doppler_shift, ekf
from dopplerlib.estimation.importance_sampling import importance_posterior

RING = RadarArray.ring(6, 0.2)
MEAN = np.array([0.8, 0, 0, -0.75, 0, 0])
PRIOR = np.diag([0.2, 0.25, 0.25, 0.25, 0.25, 0.25]) ** 2
T, SIGMA_F = 1e-3, 0.4
TRUTH = np.array([0.83, 0.11, 0.09, -0.75, -0.13, -0.02])
# A mean of S draws of efficiency e scatters by 1 / sqrt(e S) deviations, a variance by sqrt(2)
# times that, at least. Seven of these: below 1e-9 if they were Gaussian; tails are heavier.
SIGMAS = 7


def record(x, K, seed, sigma_f=SIGMA_F):
    """Return shifts (K, N) along a straight path that is at `x` one interval before the first."""
    path = np.tile(x, (K, 1))
    path[:, :3] += T * np.arange(1, K + 1)[:, None] * path[:, 3:]
    noise = np.random.default_rng(seed).standard_normal((K, len(RING)))
    return doppler_shift(path, RING) + sigma_f * noise


def agree(found, mean, covariance, draws):
    """Compare moments, of the first components, in terms of the scatter of so many draws."""
    n = len(mean)
    scatter = SIGMAS / np.sqrt(found.efficiency * draws)
    root = np.linalg.inv(np.linalg.cholesky(covariance))
    assert np.abs(root @ (found.x[:n] - mean)).max() < scatter
    assert np.abs(root @ found.P[:n, :n] @ root.T - np.eye(n)).max() < 3 * scatter


def test_two_unknown_components_agree_with_quadrature():
    """x from 0.4 to 1.2 m and y from -0.6 to 0.6 m; the rest is known to 0.1 mm and mm/s."""
    K, draws, sigma_f = 10, 8000, 10.0
    pinned = 1e-4
    mean = np.array([0.8, 0, *TRUTH[2:]])
    prior = np.diag([0.2, 0.25, *[pinned] * 4]) ** 2
    z = record(TRUTH, K, 1, sigma_f)
    found = importance_posterior(
        z, RING, mean, prior, T, 0.0, sigma_f, rng=np.random.default_rng(2), draws=draws
    )
    x, y = np.meshgrid(np.linspace(0.4, 1.6, 601), np.linspace(-0.6, 0.6, 601), indexing="ij")
    log = -(((x - 0.8) / 0.2) ** 2 + (y / 0.25) ** 2) / 2
    for k in range(K):
        for n, s in enumerate(RING.positions):
            v = TRUTH[3:]
            d = [s[0] - x - (k + 1) * T * v[0], s[1] - y - (k + 1) * T * v[1]]
            d.append(s[2] - TRUTH[2] - (k + 1) * T * v[2])
            shift = 160 * sum(a * b for a, b in zip(d, v, strict=True))
            shift = shift / np.sqrt(sum(a * a for a in d))
            log -= ((z[k, n] - shift) / sigma_f) ** 2 / 2
    w = np.exp(log - logsumexp(log))
    points = np.stack([x + K * T * v[0], y + K * T * v[1]], axis=-1)
    want = np.einsum("ij,ija->a", w, points)
    apart = points - want
    covariance = np.einsum("ij,ija,ijb->ab", w, apart, apart)
    assert covariance[0, 0] ** 0.5 > 0.05  # broad, and so not Gaussian
    agree(found, want, covariance, draws)


@pytest.mark.parametrize("noise", ["shared", "per_axis"])
def test_with_a_narrow_prior_it_is_the_kalman_filter(noise):
    """Over a millimeter the shift is linear; accelerations move it by as much as the prior."""
    K, draws, sigma_a = 30, 10_000, 3.0
    prior = np.diag([1e-3, 1e-3, 1e-3, 0.02, 0.02, 0.02]) ** 2
    z = record(TRUTH, K, 3)
    z[5, 2] = np.nan
    want = ekf(z[None], RING, TRUTH, prior, T, sigma_a, SIGMA_F, noise)
    found = importance_posterior(
        z, RING, TRUTH, prior, T, sigma_a, SIGMA_F, noise,
        rng=np.random.default_rng(4), draws=draws,
    )  # fmt: skip
    agree(found, want.x[0, -1], want.P[0, -1], draws)


def test_neither_inflation_nor_frame_moves_the_posterior():
    """A broad prior: another proposal, for sensors turned and moved, and means agree."""
    draws = 4000
    angle = np.linalg.qr(np.random.default_rng(11).standard_normal((3, 3)))[0]
    angle *= np.sign(np.linalg.det(angle))
    turn, shift = np.kron(np.eye(2), angle), np.array([1.0, -2, 3, 0, 0, 0])
    z = record(TRUTH, 60, 12)
    one = importance_posterior(
        z, RING, MEAN, PRIOR, T, 0.0, SIGMA_F, rng=np.random.default_rng(13), draws=draws
    )
    moved = RadarArray(RING.positions @ angle.T + shift[:3], RING.wavelength)
    other = importance_posterior(
        z, moved, turn @ MEAN + shift, turn @ PRIOR @ turn.T, T, 0.0, SIGMA_F,
        rng=np.random.default_rng(14), draws=draws, inflation=2.6,
    )  # fmt: skip
    both = draws / (1 + one.efficiency / other.efficiency)  # their scatters add up
    agree(one, turn.T @ (other.x - shift), turn.T @ other.P @ turn, both)
    assert one.efficiency > 0.2


def test_a_record_may_end_where_no_gaussian_sum_begins():
    """NEES is below the 1 - 1e-6 quantile of chi-square for each of five records."""
    start = np.array([0.1055, 0.05, 0.03, -0.75, 0.0, 0.0])
    P0 = np.diag([0.03, 0.05, 0.05, 0.1, 0.1, 0.1]) ** 2
    z = np.stack([record(start, 100, seed) for seed in range(5)])
    mean = [0.11, 0.04, 0.02, -0.7, 0.0, 0.0]
    rng = np.random.default_rng(5)
    found = importance_posterior(z, RING, mean, P0, T, 0.0, SIGMA_F, rng=rng)
    end = start + 100 * T * np.pad(start[3:], (0, 3))
    assert end[0] == pytest.approx(0.0305)  # one more interval, and no sum begins there
    assert np.median(found.efficiency) > 0.2
    off = end - found.x
    squared = np.sum(off * np.linalg.solve(found.P, off[..., None])[..., 0], axis=-1)
    assert (squared < chi2.isf(1e-6, 6)).all()


def test_a_record_has_the_same_bits_on_any_number_of_workers_and_a_seed_for_each_record():
    z = np.stack([record(TRUTH, 20, seed) for seed in (7, 8, 9)])
    one, three, two = (
        importance_posterior(
            z[:runs], RING, MEAN, PRIOR, T, 0.4, SIGMA_F, rng=np.random.default_rng(10), draws=200,
            workers=workers,
        )
        for runs, workers in ((3, 1), (3, 3), (2, 1))
    )  # fmt: skip
    for name, value in vars(one).items():
        np.testing.assert_array_equal(value, getattr(three, name))
        np.testing.assert_array_equal(value[:2], getattr(two, name))
