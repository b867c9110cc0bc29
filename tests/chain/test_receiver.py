"""Receivers are found from anywhere, to what is claimed, and wrong shifts cost little."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import optimize, stats

from dopplerlib import crlb
from dopplerlib.chain import _receiver_fit as fit_module
from dopplerlib.chain.receiver import locate_receiver, window_fixes
from dopplerlib.chain.satellites import L1, satellite_links
from dopplerlib.model.doppler import doppler_shift
from dopplerlib.signal.rinex import recorded_receiver

NAMES = ("ublox", "novatel", "javad")
POSITION_AND_CLOCK = np.array([1, 1, 1, 0, 0, 0, 1], bool)


@pytest.fixture(scope="module")
def fixes():
    return {name: (*recorded_receiver(name), locate_receiver(recorded_receiver(name)[0]))
            for name in NAMES}  # fmt: skip


def simulated(name, level, rng, offset=0.0):
    """Return a recording with shifts as the links have them, with noise and satellites' offsets."""
    recording, place = recorded_receiver(name)
    _, links = satellite_links(recording, place, 0.0)
    clock = rng.normal(0, 100, (len(recording.times), 1))
    z = doppler_shift(np.r_[place, np.zeros(4)][None], links) + clock
    z += level * fit_module.relative_deviation(recording.cn0) * rng.normal(size=z.shape)
    z += offset * rng.normal(size=z.shape[1])
    z[np.isnan(recording.doppler)] = np.nan
    return replace(recording, doppler=L1 * np.expm1(z / L1)), place


@pytest.mark.parametrize("name", NAMES)
def test_errors_are_what_is_claimed_and_the_bound_is_near(fixes, name):
    """2.5 deviations, and 1.5 bounds; the place by code ranges is good to 5 m an axis."""
    _, place, fix = fixes[name]
    assert fix.converged
    claimed = np.sqrt(np.trace(fix.P))
    assert np.linalg.norm(fix.position - place) < 2.5 * claimed
    bound = crlb(fix.state, fix.links, fix.sigma_f, free=POSITION_AND_CLOCK)[:3, :3]
    assert claimed < 1.5 * np.sqrt(np.trace(bound))


@pytest.mark.parametrize("name", NAMES)
def test_counted_cycles_place_it_to_meters(fixes, name):
    """Phase is a hundred times as precise as shifts; offsets keep the claim from following."""
    recording, place, _ = fixes[name]
    fix = locate_receiver(recording.counted(5))
    difference = np.linalg.norm(fix.position - place)
    assert difference < 2.5 * np.hypot(np.sqrt(np.trace(fix.P)), 5 * np.sqrt(3))
    assert difference < 20


def test_without_offsets_the_claim_is_the_bound(fixes):
    fix = fixes["novatel"][2]
    assert fix.offset_std == 0
    bound = crlb(fix.state, fix.links, fix.sigma_f, free=POSITION_AND_CLOCK)[:3, :3]
    np.testing.assert_allclose(fix.P, bound, rtol=1e-6, atol=1e-6 * np.trace(bound))


def test_a_single_epoch_leads_there_from_anywhere(fixes):
    """Twelve starts a receiver, on the ground and at twice the radius; the end is the same."""
    rng = np.random.default_rng(3)
    for recording, _, fix in fixes.values():
        epoch = recording.part(7, 1)
        starts = rng.normal(size=(4, 3))
        starts *= np.array([6.4e6, 6.4e6, 1e7, 1.5e7])[:, None] / np.linalg.norm(
            starts, axis=1, keepdims=True
        )
        ends = [locate_receiver(epoch, start, level=fix.level) for start in starts]
        assert all(end.converged for end in ends)
        assert np.ptp([end.position for end in ends], axis=0).max() < 0.1


def test_errors_of_epochs_are_normal_as_claimed(fixes):
    """Simulated: NEES of 413 epochs of white noise, inside its interval of 99.9 %."""
    rng = np.random.default_rng(11)
    values = []
    for name in NAMES:
        recording, place = simulated(name, 0.1, rng)
        fix = locate_receiver(recording, place, level=0.1)
        x, P = window_fixes(fix)
        d = x - place
        values += list(np.einsum("ki,kij,kj->k", d, np.linalg.inv(P), d))
    low, high = stats.chi2.interval(0.999, 3 * len(values))
    assert low < np.sum(values) < high


def test_the_fix_of_a_window_is_that_of_its_epochs_alone(fixes):
    """One step from the whole: what it leaves is (700 m)^2 / 20 000 km, 25 m of 700."""
    recording, _, fix = fixes["ublox"]
    x, _ = window_fixes(fix, 3)
    alone = locate_receiver(recording.part(6, 3), fix.position, level=fix.level)
    np.testing.assert_allclose(x[2], alone.position, rtol=0, atol=50)
    with pytest.raises(ValueError, match="epochs must be at most the 237 of the fix, got 238"):
        window_fixes(fix, 238)
    sigma_f = fix.sigma_f.copy()
    sigma_f[6:9, 2:] = np.nan
    gone, P = window_fixes(replace(fix, sigma_f=sigma_f), 3)
    assert np.isnan(gone[2]).all() and np.isnan(P[2]).all() and np.isfinite(gone[3]).all()


def test_the_velocity_of_a_receiver_at_rest_is_zero_as_claimed(fixes):
    """Measured, 413 epochs: NEES in its interval of 99.9 %, and 20 % for the rule by C/N0."""
    values = []
    for _, _, fix in fixes.values():
        v, P = window_fixes(fix, unknown="velocity")
        values += list(np.einsum("ki,kij,kj->k", v, np.linalg.inv(P), v))
    low, high = stats.chi2.interval(0.999, 3 * len(values))
    assert low * 0.8 < np.sum(values) < high * 1.2


def test_offsets_are_found_and_claimed():
    """Twelve recordings of 20 s with offsets of 0.05 Hz; NEES inside its interval of 99.9 %.

    White noise alone would claim a tenth of the variance.
    """
    rng = np.random.default_rng(5)
    values, white, found = [], [], []
    for _ in range(12):
        recording, place = simulated("javad", 0.06, rng, offset=0.05)
        recording = recording.part(0, 20)
        fix = locate_receiver(recording, place)
        d = fix.position - place
        values.append(d @ np.linalg.solve(fix.P, d))
        bound = crlb(fix.state, fix.links, fix.sigma_f, free=POSITION_AND_CLOCK)[:3, :3]
        white.append(d @ np.linalg.solve(bound, d))
        found.append(fix.offset_std)
    low, high = stats.f.interval(0.999, 3 * 12, 12 * 8)  # the deviation comes from eight residuals
    assert low < np.mean(values) / 3 < high
    assert np.mean(white) / 3 > 2 * high
    assert 0.035 < np.mean(found) < 0.065


def test_wrong_shifts_are_left_out():
    """A fifth of all shifts 30 Hz off, and one satellite 50 Hz off all the time."""
    rng = np.random.default_rng(2)
    recording, place = simulated("novatel", 0.1, rng)
    doppler = recording.doppler.copy()
    wrong = rng.random(doppler.shape) < 0.2
    doppler[wrong] += 30 * rng.choice([-1, 1], wrong.sum())
    doppler[:, 3] += 50.0
    wrong[:, 3] = True
    fix = locate_receiver(replace(recording, doppler=doppler))
    assert (fix.wrong == wrong).all() and (np.isnan(fix.z) == wrong).all()
    d = fix.position - place
    assert d @ np.linalg.solve(fix.P, d) < stats.chi2.isf(1e-3, 3)


def test_the_least_absolute_fit_is_the_one_of_linear_programming():
    """One epoch: three components and a clock, so that four residuals are zero."""
    rng = np.random.default_rng(8)
    r, H = rng.normal(size=(1, 9)) * 5, rng.normal(size=(1, 9, 3))
    sigma = rng.uniform(0.5, 2, (1, 9))
    left = fit_module.least_absolute(r, H, sigma)
    A = np.column_stack([H[0], np.ones(9)]) / sigma.T
    b = (r / sigma)[0]
    one = np.eye(9)
    least = optimize.linprog(
        np.r_[np.zeros(4), np.ones(9)],
        A_ub=np.block([[A, -one], [-A, -one]]), b_ub=np.r_[b, -b], bounds=(None, None),
    ).fun  # fmt: skip
    assert np.abs(left / sigma).sum() == pytest.approx(least, rel=0.02)  # of 30 rounds
    assert fit_module.typical(left / sigma, 3) == pytest.approx(
        np.median(np.sort(np.abs(left / sigma)[0])[4:]) / 0.6745
    )


def test_the_variance_of_offsets_maximizes_the_restricted_likelihood():
    """Beside its value by determinants and inverses of the covariance of all contrasts."""
    rng = np.random.default_rng(4)
    S, K = 7, 5
    X, B = rng.normal(size=(K * S, 3)), np.tile(np.eye(S), (K, 1))
    y = B @ rng.normal(size=S) + rng.normal(size=K * S)
    contrasts = np.linalg.svd(X)[0][:, 3:].T
    projector = contrasts.T @ contrasts
    found = fit_module.offset_variance(B.T @ projector @ y, B.T @ projector @ B)

    def cost(v):
        V = contrasts @ (v * B @ B.T + np.eye(K * S)) @ contrasts.T
        e = contrasts @ y
        return np.linalg.slogdet(V)[1] + e @ np.linalg.solve(V, e)

    best = optimize.minimize_scalar(cost, bounds=(0, 20), method="bounded", options={"xatol": 1e-8})
    assert found == pytest.approx(best.x, rel=1e-4)
    assert fit_module.offset_variance(np.zeros(S), np.eye(S)) == 0.0


def test_too_few_measurements_are_refused(fixes):
    recording, place, fix = fixes["novatel"]
    few = recording.part(0, 1).without(recording.satellites[4:])
    with pytest.raises(ValueError, match="recording must have more measurements than its 4 unk"):
        locate_receiver(few, place)
    with pytest.raises(ValueError, match="are the signs and the day right"):
        locate_receiver(replace(recording, doppler=-recording.doppler))
    with pytest.raises(ValueError, match="recording must have Doppler shifts, got none"):
        locate_receiver(replace(recording, doppler=np.full_like(recording.doppler, np.nan)))
    assert fix.state.shape == (7,)
