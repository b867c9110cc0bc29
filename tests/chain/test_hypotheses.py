"""Hypotheses about the start: which are kept, how likely each is, how well it is known.

Seeds were written down once and are not chosen.
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.stats import multivariate_normal

from dopplerlib import doppler_jacobian, doppler_shift, ekf
from dopplerlib.chain._hypotheses import filters, parts, start_covariances
from dopplerlib.chain.simulation import simulate_baseband
from dopplerlib.systems import mittermaier2016 as paper

S = paper.reported().scenario
T, USED, APART = 0.0125, 21, 2
ALL = np.ones(6, dtype=bool)


def moved(state, time):
    return state + np.concatenate([time * state[3:], np.zeros(3)])


@pytest.fixture(scope="module")
def found():
    iq = simulate_baseband(
        paper.reported().scenario, 4, rng=np.random.default_rng(91), faults=False
    )
    return paper.track_iq(iq, hop=T, start=0.2, remove_dc=False, balance=False)


def test_the_quarters_cover_the_room():
    lower, upper = paper.start_box()
    boxes = parts((lower, upper), S.array)
    volume = sum(np.prod(high - low) for low, high in boxes)
    assert volume == pytest.approx(np.prod(upper - lower))
    assert len({(low[1] == 0, low[2] == 0) for low, _ in boxes}) == 4


@pytest.mark.parametrize(
    ("above", "kept"), [(0, True), (29, True), (31, False), (np.inf, False), (np.nan, False)]
)
def test_hypotheses_a_million_times_less_likely_are_dropped(above, kept):
    """exp(-30 / 2) is 3e-7: 29 is kept, and 31 is not."""
    z = np.tile(doppler_shift(S.x0, S.array), (USED, 1))
    costs = np.array([7.0, 7.0 + above])
    *_, score = filters(
        z, 0 * z + 0.1, 0 * z + 0.1, S.array, T, USED, 1, 0.4, ALL, [S.x0] * 2, costs
    )
    assert_array_equal(np.isfinite(score), [[True], [kept]])


def test_the_score_is_the_likelihood_of_all_shifts(found):
    """Of the start the chi-square, of each innovation the density that a filter run again gives."""
    step = found.time[1] - found.time[0]
    for run in range(2):
        i = int(np.argmin(found.score[run, :, 0]))
        early = slice((found.used - 1) % APART, found.used, APART)
        back = found.time[early] - found.time[found.used - 1]
        h = np.array([doppler_shift(moved(found.x[run, i, 0], t), S.array) for t in back])
        variance = np.mean(found.shift_std[run, early] ** 2)
        chi_square = np.sum((found.shift[run, early] - h) ** 2) / variance
        assert_allclose(found.score[run, i, 0], chi_square, rtol=1e-6)
        t = ekf(
            found.shift[run, found.used :],
            S.array,
            found.x[run, i, 0],
            found.P[run, i, 0],
            step,
            found.velocity_random_walk / np.sqrt(step),
            found.shift_std[run, found.used :],
        )
        density = [
            multivariate_normal(cov=cov).logpdf(nu)
            for nu, cov in zip(t.innovation, t.S, strict=True)
        ]
        expected = -2 * np.array(density) - 6 * np.log(2 * np.pi)
        assert_allclose(np.diff(found.score[run, i]), expected, rtol=1e-7, atol=1e-7)


def test_a_missing_module_adds_nothing_to_the_score(found):
    """The same as a filter that has five modules only."""
    z, std = found.shift[0].copy(), found.shift_std[0].copy()
    z[:, 4], std[:, 4] = np.nan, np.inf
    x = found.x[0, np.argmin(found.score[0, :, 0]), 0]
    five = type(S.array)(np.delete(S.array.positions, 4, axis=0), S.array.wavelength)
    rest = (np.delete(a, 4, axis=1) for a in (z, std, std[:USED:APART]))
    used, common = found.used, (T, found.used, APART, 0.4, ALL, [x], np.array([1.0]))
    weights = std[:used:APART]
    x, P, nu, cov, *rest_of_six = filters(z, std, weights, S.array, *common)
    assert np.isnan(nu[..., 4]).all()
    nu, cov = np.delete(nu, 4, axis=-1), np.delete(np.delete(cov, 4, axis=-1), 4, axis=-2)
    six = x, P, nu, cov, *rest_of_six
    z5, std5, _ = rest
    other = filters(z5, std5, np.delete(weights, 4, axis=1), five, *common)
    for name, a, b in zip(
        ("x", "P", "innovation", "S", "nis", "lag1_autocorrelation", "score"),
        six,
        other,
        strict=True,
    ):
        if name != "lag1_autocorrelation":  # says nothing where a module is missing
            assert_allclose(a, b, rtol=1e-6, atol=1e-9, err_msg=name)


@pytest.mark.parametrize("used", [8, 9])
def test_the_state_of_a_start_belongs_to_its_last_sample(used):
    """Without noise it is the truth there, whichever of the overlapping windows are taken.

    The blur in a window of 25 ms moves a shift by 0.01 Hz, and a position by a few millimeters;
    one window earlier the target was 9.5 mm away.
    """
    iq = simulate_baseband(
        paper.reported().scenario, 1, rng=np.random.default_rng(92), snr_db=None, faults=False
    )
    first = paper.track_iq(iq, hop=T, remove_dc=False, balance=False).available_at[0]
    start = first + (used - 1) * T + 24 * T
    f = paper.track_iq(iq, hop=T, start=start, remove_dc=False, balance=False)
    assert f.used == used + 24
    best = np.argmin(f.score[0, :, 0])
    truth = moved(S.x0, f.time[f.used - 1])
    assert np.linalg.norm((f.x[0, best, 0] - truth)[:3]) < 0.003


def test_the_covariance_of_a_start_is_the_inverse_of_all_information():
    """Other deviations for every shift, some shifts missing, so that order and weights matter."""
    rng = np.random.default_rng(93)
    std = rng.uniform(0.05, 0.5, (12, 6))
    std[3, 1] = std[7] = np.inf
    J = np.zeros((6, 6))
    for k in range(12):
        F = np.eye(6)
        F[:3, 3:] = (k - 11) * T * np.eye(3)
        H = doppler_jacobian(moved(S.x0, (k - 11) * T), S.array) @ F
        J += H.T @ (H / std[k][:, None] ** 2)
    expected = np.linalg.inv(J)
    scale = np.sqrt(np.diagonal(expected))
    (found,), _ = start_covariances(S.x0[None], S.array, std, T, ALL)
    # The information has a condition of 1e6 or so.
    assert_allclose(found / np.outer(scale, scale), expected / np.outer(scale, scale), atol=1e-7)


def test_a_start_from_too_little_has_no_covariance():
    """A ring sees no range from a snapshot; nor is there one of a state that was not found."""
    states = np.array([np.full(6, np.nan), S.x0])
    for samples, expected in ((1, [False, False]), (9, [False, True])):
        std = np.full((samples, 6), 0.1)
        covariances, known = start_covariances(states, S.array, std, T, ALL)
        assert_array_equal(known, expected)
        assert len(covariances) == sum(expected)
    assert not start_covariances(states[:1], S.array, std, T, ALL)[1].any()
