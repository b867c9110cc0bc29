"""The Gaussian sum filter beside other estimators, and its own claims over many runs."""

import numpy as np
import pytest
from scipy import stats

from dopplerlib import RadarArray, constant_velocity, doppler_jacobian, doppler_shift, ekf
from dopplerlib.estimation._gaussian_sum_average import average
from dopplerlib.estimation._gaussian_sum_setting import blank
from dopplerlib.estimation.gaussian_sum import gaussian_sum, gaussian_sum_online
from dopplerlib.workspace.targets import draw_records, draw_targets

ARRAY = RadarArray.ring(6, 0.2)
CENTERED = RadarArray(np.vstack([RadarArray.ring(5, 0.2).positions, np.zeros(3)]))
OFF_PLANE = RadarArray(ARRAY.positions + 0.05 * np.eye(3)[0] * [[1], [-1], [0.4], [-1], [1], [0]])
X0 = np.array([0.8, 0.0, 0.0, -0.75, 0.0, 0.0])
P0 = np.diag([0.2, 0.25, 0.25, 0.25, 0.25, 0.25]) ** 2
T = 1e-3


def records(runs, samples, rng, sigma_a=0.4, sigma_f=0.4, x0=X0, P0=P0, array=ARRAY, least=0.3):
    """Return true paths from the prior, in front of the array, and their measurements."""
    F, Q = constant_velocity(T, 1.0, "per_axis")
    root = sigma_a * np.linalg.cholesky(Q + 1e-18 * np.eye(6))
    x = x0 + rng.standard_normal((40 * runs, 6)) @ np.linalg.cholesky(P0).T
    x = x[x[:, 0] + np.minimum(x[:, 3], 0) * samples * T > least][:runs]
    path = np.empty((runs, samples, 6))
    for k in range(samples):
        x = x @ F.T + rng.standard_normal((runs, 6)) @ root.T
        path[:, k] = x
    shifts = doppler_shift(path, array)
    return path, shifts + sigma_f * rng.standard_normal(shifts.shape)


# The second target leaves the ring's plane, where cells of the start have room on both sides.
@pytest.mark.parametrize(
    ("x", "v", "size", "apart"), [(0.8, -0.7, 1.0, 0.03), (0.04, 0.7, 0.1, 0.1)]
)
def test_from_a_narrow_prior_it_is_the_extended_filter(x, v, size, apart):
    x0 = np.array([x, 0.1, 0.1, v, 0.05, 0.0])
    P0 = (size * np.diag([2e-3, 2e-3, 2e-3, 5e-3, 5e-3, 5e-3])) ** 2
    _, z = records(1, 60, np.random.default_rng(1), x0=x0, P0=P0, least=0.03)
    found = gaussian_sum(z[0], ARRAY, x0, P0, T, 0.4, 0.4, block=1)
    other = ekf(z[0], ARRAY, x0, P0, T, 0.4, 0.4, noise="per_axis")
    deviation = np.sqrt(np.diagonal(other.P, axis1=-2, axis2=-1))
    assert (found.members == 1).all()
    # Curvature over two millimeters, or 0.2 near the plane, is all that the two treat differently.
    assert np.abs((found.x - other.x) / deviation).max() < apart
    np.testing.assert_allclose(found.P, other.P, rtol=0.03, atol=1e-7)


# What windows of this size leave: more where sensors see the range, across some of them.
@pytest.mark.parametrize(("array", "left"), [(ARRAY, 0.05), (CENTERED, 0.15), (OFF_PLANE, 0.15)])
def test_the_start_is_the_posterior_that_sampling_finds(array, left):
    # In five microseconds nothing moves: one scan, in which the shifts are linear in the velocity.
    rng = np.random.default_rng(2)
    truth = np.array([0.9, -0.2, 0.3, -0.6, 0.2, 0.1])
    z = doppler_shift(truth, array) + 0.4 * rng.standard_normal((5, 6))
    found = gaussian_sum(z, array, X0, P0, 1e-6, 0.1, 0.4, every=5)
    p = X0[:3] + rng.standard_normal((120_000, 3)) @ np.sqrt(P0[:3, :3])
    there = p[:, 0] > 0.05
    p = p[there]
    H = doppler_jacobian(np.concatenate([p, np.zeros_like(p)], axis=-1), array)[..., 3:]
    V, r = P0[3:, 3:], 0.4**2 / 5
    S = H @ V @ H.swapaxes(-1, -2) + r * np.eye(6)
    innovation = z.mean(axis=0) - H @ X0[3:]
    solved = np.linalg.solve(S, innovation[..., None])[..., 0]
    log = -0.5 * np.sum(innovation * solved, axis=-1) - 0.5 * np.linalg.slogdet(2 * np.pi * S)[1]
    w = np.exp(log - log.max())
    evidence = log.max() + np.log(w.sum() / len(there))
    w /= w.sum()
    effective = 1 / np.sum(w**2)
    assert effective > 800
    x = np.concatenate([p, X0[3:] + np.einsum("ij,rnj,rn->ri", V, H, solved)], axis=-1)
    mean = w @ x
    P = (x - mean).T @ ((x - mean) * w[:, None])
    given = V - V @ H.swapaxes(-1, -2) @ np.linalg.solve(S, H @ V)  # of a velocity, given p
    P[3:, 3:] += np.einsum("r,rij->ij", w, given)
    deviation = np.sqrt(np.diagonal(P))
    limit = 4 / np.sqrt(effective) + left  # four standard errors of the sampling
    assert np.abs((found.x[0] - mean) / deviation).max() < limit
    np.testing.assert_allclose(np.sqrt(np.diagonal(found.P[0])), deviation, rtol=limit)
    # Five samples of each sensor about their mean: what the scan's density leaves out.
    inside = stats.norm.logpdf(z, z.mean(axis=0), 0.4).sum()
    inside -= 6 * stats.norm.logpdf(0, scale=0.4 / np.sqrt(5))
    assert found.evidence[0] == pytest.approx(evidence + inside, abs=limit)


@pytest.mark.parametrize(
    ("array", "sigma_a"), [(ARRAY, 0.4), (CENTERED, 0.4), (OFF_PLANE, 0.4), (ARRAY, 0.0)]
)
def test_its_covariance_is_that_of_its_errors(array, sigma_a):
    rng = np.random.default_rng(3)
    path, z = records(150, 200, rng, sigma_a=sigma_a, array=array)
    found = gaussian_sum(z, array, X0, P0, T, sigma_a, 0.4, every=100)
    error = found.x - path[:, 99::100]
    nees = np.einsum("roi,roi->ro", error, np.linalg.solve(found.P, error[..., None])[..., 0])
    standard_error = nees.std(axis=0) / np.sqrt(len(nees))
    # False alarm: 1e-4 for two means, taken as normal.
    assert (np.abs(nees.mean(axis=0) - 6) < 4 * standard_error).all()
    assert standard_error.max() < 0.8


def exact_evidence(z, x0, P0, at, shape, draws):
    """Return the log density of one scan (K, 6), by importance sampling, and the effective draws.

    Given a position the shifts are linear in the velocity; positions are drawn around `at`.
    """
    proposal = stats.multivariate_t(at, 4 * shape, df=5, seed=1)
    p = proposal.rvs(draws)
    H = doppler_jacobian(np.concatenate([p, np.zeros_like(p)], axis=-1), ARRAY)[..., 3:]
    S = H @ P0[3:, 3:] @ H.swapaxes(-1, -2) + 0.4**2 / len(z) * np.eye(6)
    innovation = z.mean(axis=0) - H @ x0[3:]
    solved = np.linalg.solve(S, innovation[..., None])[..., 0]
    log = -0.5 * np.sum(innovation * solved, axis=-1) - 0.5 * np.linalg.slogdet(2 * np.pi * S)[1]
    log += stats.multivariate_normal.logpdf(p, x0[:3], P0[:3, :3]) - proposal.logpdf(p)
    log[p[:, 0] < 0.03] = -np.inf
    w = np.exp(log - log.max())
    inside = stats.norm.logpdf(z, z.mean(axis=0), 0.4).sum()
    inside -= 6 * stats.norm.logpdf(0, scale=0.4 / np.sqrt(len(z)))
    return log.max() + np.log(w.mean()) + inside, w.sum() ** 2 / np.sum(w**2)


# The first, because a window that promised much was believed without a look at what it kept; the
# others, because there were no windows so far out.
@pytest.mark.parametrize(
    ("width", "out"),
    [
        (0.15, [-0.61, 0.34, 0.67, -0.25, 0.04, -0.1]),
        (0.3, [-0.31, -0.04, -0.73, -0.06, 0.6, -0.06]),
        (0.3, [-0.21, -0.15, -0.62, -0.47, -0.48, 0.32]),
    ],
)
def test_a_target_far_out_in_the_prior_has_its_evidence(width, out):
    P = width**2 * P0
    truth = X0 + 7 * np.sqrt(np.diag(P)) * out
    rng = np.random.default_rng(14)
    z = doppler_shift(truth, ARRAY) + 0.4 * rng.standard_normal((5, 6))
    found = gaussian_sum(z, ARRAY, X0, P, 1e-6, 0.0, 0.4, every=5)
    expected, effective = exact_evidence(z, X0, P, found.x[0, :3], found.P[0, :3, :3], 10_000)
    assert effective > 1000
    # Seven deviations out, windows and Laplace are good to a factor of four.
    assert found.evidence[0] == pytest.approx(expected, abs=1.5)


def test_a_valley_still_curved_keeps_its_members():
    # So slow that after 0.15 s one Gaussian at the mode of all scans leaves out where the rest is.
    truth = np.array([0.516, -0.171, 0.255, -0.252, 0.021, -0.077])
    path = np.tile(truth, (200, 1))
    path[:, :3] += T * np.arange(200)[:, None] * truth[3:]
    noise = 0.4 * np.random.default_rng(13).standard_normal((40, 400, 6))
    found = gaussian_sum(doppler_shift(path, ARRAY) + noise[:, :200], ARRAY, X0, P0, T, 0, 0.4,
                         every=200)  # fmt: skip
    error = (found.x - path[-1])[:, 0]
    nees = np.einsum("ri,ri->r", error, np.linalg.solve(found.P[:, 0], error[..., None])[..., 0])
    # False alarm: 1e-4 for all, taken as chi-square.
    assert nees.max() < stats.chi2.isf(1e-4 / len(nees), 6)


def test_a_member_without_a_state_leaves_the_others_an_estimate():
    # Of these targets one each gave an estimate of NaN, although there were members.
    truths, noise = np.random.default_rng([9101, 66]).spawn(2)
    for before, samples in ((31, 10), (669, 30)):
        truths.spawn(before)
        noise.spawn(before)
        path = draw_targets(1, rng=truths, sigma_a=0.0, samples=samples)
        z = draw_records(path, rng=noise)
        found = gaussian_sum(z, ARRAY, X0, P0, T, 0.0, 0.4, every=5, mixture=400)
        assert (found.members > 1).all()
        assert np.isfinite(found.x).all()
        np.testing.assert_array_equal((found.weights > 0).sum(axis=-1), found.members)


def test_another_frame_gives_the_same():
    # A ring whose plane is z = 0, elsewhere, with the target below.
    _, z = records(3, 100, np.random.default_rng(4))
    expected = gaussian_sum(z, ARRAY, X0, P0, T, 0.4, 0.4, every=50)
    turn = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]])
    array = RadarArray(ARRAY.positions @ turn.T + [1.0, 2.0, 3.0])
    both = np.kron(np.eye(2), turn)
    found = gaussian_sum(
        z, array, both @ X0 + [1, 2, 3, 0, 0, 0], both @ P0 @ both.T, T, 0.4, 0.4, every=50
    )
    moved = expected.x @ both.T + [1, 2, 3, 0, 0, 0]
    deviation = np.sqrt(np.diagonal(found.P, axis1=-2, axis2=-1))
    # The windows of the start may lie turned; the sum of Gaussians is good to that.
    assert np.abs((found.x - moved) / deviation).max() < 0.1


def test_sensors_may_be_missing_and_workers_change_nothing():
    _, z = records(4, 60, np.random.default_rng(5))
    z[:, 7:23, 1] = np.nan
    z[:, 30:41] = np.nan
    z[0, :5] = np.nan
    one = gaussian_sum(z, ARRAY, X0, P0, T, 0.4, 0.4, every=20, workers=1)
    two = gaussian_sum(z, ARRAY, X0, P0, T, 0.4, 0.4, every=20, workers=2)
    for name in ("x", "P", "members"):
        np.testing.assert_array_equal(getattr(one, name), getattr(two, name))
    assert np.isfinite(one.x).all()


def test_the_mixture_has_the_moments_that_are_returned():
    _, z = records(2, 60, np.random.default_rng(6))
    found = gaussian_sum(z, ARRAY, X0, P0, T, 0.4, 0.4, every=20, mixture=400)
    np.testing.assert_array_equal((found.weights > 0).sum(axis=-1), found.members)
    assert found.members.min() > 3
    np.testing.assert_allclose(found.weights.sum(axis=-1), 1, rtol=1e-12)
    assert (np.diff(found.weights, axis=-1) <= 0).all()
    assert np.array_equal(np.isnan(found.means[..., 0]), found.weights == 0)
    means, covariances = np.nan_to_num(found.means), np.nan_to_num(found.covariances)
    mean = np.einsum("rom,romi->roi", found.weights, means)
    np.testing.assert_allclose(mean, found.x, rtol=1e-12)
    apart = means - mean[..., None, :]
    P = np.einsum("rom,romij->roij", found.weights, covariances)
    P += np.einsum("rom,romi,romj->roij", found.weights, apart, apart)
    np.testing.assert_allclose(P, found.P, rtol=1e-9, atol=1e-12)  # of differences of squares
    heaviest = gaussian_sum(z, ARRAY, X0, P0, T, 0.4, 0.4, every=20, mixture=3)
    for name in ("weights", "means", "covariances"):
        np.testing.assert_array_equal(getattr(heaviest, name), getattr(found, name)[:, :, :3])


@pytest.mark.parametrize("sigma_a", [0.4, 0.0, (0.0, 0.4)])
def test_samples_may_come_one_by_one(sigma_a):
    _, z = records(1, 203, np.random.default_rng(7), sigma_a=np.max(sigma_a))
    z[0, 50:58, 2] = np.nan
    setting = ARRAY, X0, P0, T, sigma_a, 0.4
    whole = gaussian_sum(z[0], *setting, mixture=4)
    update = gaussian_sum_online(*setting, mixture=4)
    for k in range(203):
        found = update(z[0, k])
        for name in (
            "x",
            "P",
            "members",
            "weights",
            "means",
            "covariances",
            "evidence",
            "probabilities",
        ):
            np.testing.assert_array_equal(getattr(found, name), getattr(whole, name)[k])
    assert np.isnan(whole.x[:4]).all()
    assert np.isfinite(whole.x[4:]).all()


def test_an_estimate_knows_nothing_of_later_samples():
    _, z = records(1, 60, np.random.default_rng(8))
    whole = gaussian_sum(z[0], ARRAY, X0, P0, T, 0.4, 0.4)
    for K in (7, 23, 45):
        other = gaussian_sum(np.concatenate([z[0, :K], z[0, K:] + 3]), ARRAY, X0, P0, T, 0.4, 0.4)
        np.testing.assert_array_equal(other.x[:K], whole.x[:K])


def test_the_evidence_is_that_of_the_kalman_filter():
    # From a narrow prior, with several samples in a block and with one.
    x0 = np.array([0.8, 0.1, 0.1, -0.7, 0.05, 0.0])
    P0 = np.diag([2e-3, 2e-3, 2e-3, 5e-3, 5e-3, 5e-3]) ** 2
    _, z = records(1, 60, np.random.default_rng(1), x0=x0, P0=P0)
    other = ekf(z[0], ARRAY, x0, P0, T, 0.4, 0.4, noise="per_axis")
    zero = np.zeros(6)
    expected = sum(
        stats.multivariate_normal.logpdf(e, zero, S)
        for e, S in zip(other.innovation, other.S, strict=True)
    )
    # Curvature over two millimeters; in a block of five, too, a velocity that is no longer one:
    # 2 ms of 0.4 m/s^2 move a shift by a tenth of its deviation, in 360 measurements.
    for block, left in ((1, 0.01), (5, 360 * 0.1**2 / 2)):
        found = gaussian_sum(z[0], ARRAY, x0, P0, T, 0.4, 0.4, block=block, every=60)
        assert found.evidence[-1] == pytest.approx(expected, abs=left)


def test_an_assumption_without_an_estimate_has_no_weight():
    x = [np.array([[np.nan] * 6, [1.0] * 6]), np.array([[2.0] * 6, [2.0] * 6])]
    found = [blank(2, mixture=1)._replace(x=at, P=np.ones((2, 6, 6)) + at[:, :1, None],
             evidence=np.zeros(2)) for at in x]  # fmt: skip
    mean, p = average(found)
    np.testing.assert_array_equal(p, [[0, 1], [0.5, 0.5]])
    np.testing.assert_array_equal(mean.x, [[2.0] * 6, [1.5] * 6])
    np.testing.assert_array_equal(mean.P[0], 3)


def test_assumptions_are_weighed_by_their_evidence():
    _, z = records(3, 63, np.random.default_rng(9))
    several, setting = (0.4, 0, 4), (ARRAY, X0, P0, T)
    tracks = [gaussian_sum(z, *setting, s, 0.4, every=21, mixture=5) for s in several]
    together = gaussian_sum(z, *setting, several, 0.4, every=21, mixture=5)
    p = together.probabilities
    density = np.exp(np.stack([t.evidence for t in tracks], axis=-1) + 150)
    np.testing.assert_allclose(p, density / density.sum(axis=-1, keepdims=True), rtol=1e-9)
    np.testing.assert_allclose(np.exp(together.evidence + 150), density.mean(axis=-1), rtol=1e-9)
    x = np.stack([t.x for t in tracks], axis=-1)
    np.testing.assert_allclose(together.x, np.sum(p[..., None, :] * x, axis=-1), rtol=1e-9)
    square = np.stack([t.P + t.x[..., None] * t.x[..., None, :] for t in tracks], axis=-1)
    expected = np.sum(p[..., None, None, :] * square, axis=-1)
    found = together.P + together.x[..., None] * together.x[..., None, :]
    np.testing.assert_allclose(found, expected, rtol=1e-9)
    every = np.concatenate([p[..., [i]] * t.weights for i, t in enumerate(tracks)], axis=-1)
    np.testing.assert_allclose(together.weights, -np.sort(-every, axis=-1)[..., :5])
    first = np.concatenate([t.means for t in tracks], axis=-2)
    place = np.argmax(every, axis=-1)[..., None, None]
    np.testing.assert_array_equal(
        together.means[..., 0, :], np.take_along_axis(first, place, axis=-2)[..., 0, :]
    )


@pytest.mark.parametrize(
    ("array", "x0", "message"),
    [
        (RadarArray.linear(5, 0.4), X0, "array must have three sensors that are not on a line"),
        (ARRAY, [0, 0.5, 0, 0, 0, 0], "x0 must lie in front of the sensors"),
    ],
)
def test_what_it_cannot_track_is_refused(array, x0, message):
    with pytest.raises(ValueError, match=message):
        gaussian_sum(np.zeros((5, len(array))), array, x0, P0, T, 0.4, 0.4)


@pytest.mark.parametrize("array", [ARRAY, OFF_PLANE])
def test_what_the_gate_refuses_counts_as_missing(array):
    """To the last bit: wrong samples, also of the first block, and none where they stood."""
    rng = np.random.default_rng(11)
    _, z = records(3, 60, rng, array=array)
    wrong = rng.random(z.shape) < 0.1
    # Refused by others than the median they come in two of five at most.
    wrong[:, :5] = np.arange(5)[:, None] == [0, 1, 2, 3, 4, 0]
    off = np.where(wrong, z + rng.choice([-1, 1], z.shape) * rng.uniform(60, 300, z.shape), z)
    setting = array, X0, P0, T, 0.4, 0.4
    got = gaussian_sum(off, *setting, gate_probability=0.999)
    want = gaussian_sum(np.where(wrong, np.nan, z), *setting, gate_probability=0.999)
    np.testing.assert_array_equal(got.x, want.x)
    np.testing.assert_array_equal(got.P, want.P)
    # As evidence each counts as one at the edge of the gate, whose deviation is 0.4 Hz at least.
    edge = 0.5 * (stats.chi2.ppf(0.999, 1) + np.log(2 * np.pi * 0.4**2))
    lost = want.evidence[:, -1] - got.evidence[:, -1]
    assert lost.min() > edge * wrong.sum(axis=(1, 2)).min()


def test_a_gate_so_wide_that_nothing_is_outside_is_none():
    _, z = records(2, 60, np.random.default_rng(12))
    none = gaussian_sum(z, ARRAY, X0, P0, T, 0.4, 0.4)
    wide = gaussian_sum(z, ARRAY, X0, P0, T, 0.4, 0.4, gate_probability=1 - 1e-15)
    for name in ("x", "P", "evidence"):
        np.testing.assert_array_equal(getattr(wide, name), getattr(none, name))
    update = gaussian_sum_online(ARRAY, X0, P0, T, 0.4, 0.4, gate_probability=0.99)
    narrow = gaussian_sum(z[0], ARRAY, X0, P0, T, 0.4, 0.4, gate_probability=0.99)
    for k in range(60):
        np.testing.assert_array_equal(update(z[0, k]).x, narrow.x[k])
    assert not np.array_equal(narrow.x[-1], none.x[0, -1])
