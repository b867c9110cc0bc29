"""Targets of the workspace: their distribution, where a record ends, and the same runs again."""

import numpy as np
import pytest
from scipy.stats import kstest, norm, truncnorm

from dopplerlib import RadarArray, Scenario, constant_velocity, doppler_shift
from dopplerlib._data import data
from dopplerlib.workspace.targets import (
    ARRAY,
    INTERVAL,
    NEAREST,
    PRIOR_COVARIANCE,
    PRIOR_MEAN,
    SIGMA_A,
    SIGMA_F,
    TABLE_2,
    draw_records,
    draw_targets,
)

RUNS, FALSE_ALARM = 300, 1e-6


def test_the_setting_is_that_of_the_paper():
    paper = Scenario.from_toml(data("mittermaier2016", "scenario.toml"))
    np.testing.assert_array_equal(TABLE_2, paper.x0)
    np.testing.assert_allclose(ARRAY.positions, paper.array.positions, atol=1e-12)
    assert (INTERVAL, SIGMA_F, SIGMA_A) == (paper.T, paper.sigma_f, paper.sigma_a)


@pytest.fixture(scope="module")
def paths():
    return draw_targets(RUNS, rng=np.random.default_rng(1))


def test_runs_are_the_same_among_few_and_many_in_pieces_and_shorter(paths):
    few = draw_targets(5, rng=np.random.default_rng(1))
    np.testing.assert_array_equal(few, paths[:5])
    rng = np.random.default_rng(1)
    rng.spawn(3)
    np.testing.assert_array_equal(draw_targets(2, rng=rng), paths[3:5])
    np.testing.assert_array_equal(draw_targets(2, rng=rng), paths[5:7])
    for samples in (100, 700):
        short = draw_targets(5, rng=np.random.default_rng(1), samples=samples)
        np.testing.assert_array_equal(short, paths[:5, :samples])


def test_truths_have_the_distribution_of_the_prior_within_its_cuts(paths):
    # One interval back along a straight line is time zero but for less than a micrometer.
    start = paths[:, 0] - INTERVAL * np.pad(paths[:, 0, 3:], ((0, 0), (0, 3)))
    assert (start[:, 0] > 0.45).all()
    assert (np.linalg.norm(start[:, :3], axis=-1) < 1.35).all()
    deviation = np.sqrt(np.diagonal(PRIOR_COVARIANCE))
    scaled = (start - PRIOR_MEAN) / deviation
    # Cuts leave the velocity across as it is, and symmetric what they touch across.
    for i in (4, 5):
        assert kstest(scaled[:, i], norm.cdf).pvalue > FALSE_ALARM
    limit = norm.isf(FALSE_ALARM / 2) / np.sqrt(RUNS)
    assert np.abs(scaled[:, [1, 2, 4, 5]].mean(axis=0)).max() < limit
    # Those that come in fast from near are left out, the cut from below is the larger part.
    low = (0.45 - PRIOR_MEAN[0]) / deviation[0]
    assert abs(scaled[:, 0].mean() - truncnorm.mean(low, np.inf)) < 0.1 + limit


def test_another_prior_gives_other_targets():
    prior = np.array([0.8, 0, 0, -1.75, 0, 0]), np.diag([0.01, 0, 0, 0, 0, 0])
    path = draw_targets(30, rng=np.random.default_rng(1), prior=prior, sigma_a=0, samples=1)[:, 0]
    np.testing.assert_allclose(path[:, 1:], np.tile([0, 0, -1.75, 0, 0], (30, 1)), atol=1e-15)
    assert path[:, 0].min() > 0.45 - 1.75 * INTERVAL
    assert 0.05 < path[:, 0].std() < 0.15


def test_accelerations_are_those_of_the_model(paths):
    F, Q = constant_velocity(INTERVAL, SIGMA_A, "per_axis")
    noise = paths[:, 1:200] - paths[:, :199] @ F.T
    a = noise[..., 3:] / INTERVAL
    np.testing.assert_allclose(noise[..., :3], INTERVAL**2 / 2 * a, atol=1e-14)
    assert kstest(a[::3].ravel() / SIGMA_A, norm.cdf).pvalue > FALSE_ALARM
    found = np.cov(noise[::3].reshape(-1, 6).T)
    np.testing.assert_allclose(found, Q, atol=0.05 * Q.max())


def test_without_acceleration_motion_is_uniform():
    path = draw_targets(1, rng=np.random.default_rng(2), sigma_a=0, x0=TABLE_2)[0]
    expected = np.tile(TABLE_2, (1000, 1))
    expected[:, :3] += INTERVAL * np.arange(1, 1001)[:, None] * TABLE_2[3:]
    np.testing.assert_allclose(path, expected, atol=1e-12)
    same = draw_targets(3, rng=np.random.default_rng(1), sigma_a=0, samples=1)
    with_noise = draw_targets(3, rng=np.random.default_rng(1), samples=1)
    assert np.abs(same - with_noise).max() < 0.01  # the same truths in both models


def test_a_record_ends_at_contact_and_stays_ended(paths):
    there = np.isfinite(paths).all(axis=-1)
    assert there[:, :200].all()
    assert (there[:, :-1] >= there[:, 1:]).all()
    assert 0.3 < there[:, -1].mean() < 0.7
    assert paths[there][:, 0].min() >= NEAREST
    # The step after the last would have led beyond.
    ended = np.flatnonzero(~there[:, -1])
    last = paths[ended, there[ended].sum(axis=1) - 1]
    assert (last[:, 0] + 1.01 * INTERVAL * last[:, 3] < NEAREST + 1e-4).all()


def test_a_sensor_out_of_the_plane_ends_a_record():
    array = RadarArray([[0.4, 0, 0], [0, 0.2, 0], [0, 0, 0.2]])
    x0 = [0.8, 0, 0, -1, 0, 0]
    path = draw_targets(1, rng=np.random.default_rng(1), sigma_a=0, x0=x0, array=array)[0]
    there = np.isfinite(path[:, 0])
    # From 0.8 m to 0.45 m, at 1 mm a sample.
    assert there.sum() in (349, 350)
    z = draw_records(path[None], rng=np.random.default_rng(2), array=array)
    np.testing.assert_array_equal(np.isfinite(z), np.repeat(there, 3).reshape(1, 1000, 3))


def test_records_are_shifts_with_white_noise(paths):
    z = draw_records(paths[:40], rng=np.random.default_rng(3))
    few = draw_records(paths[:2], rng=np.random.default_rng(3))
    np.testing.assert_array_equal(few, z[:2])
    there = np.isfinite(paths[:40, :, 0])
    noise = (z[there] - doppler_shift(paths[:40][there], ARRAY)) / SIGMA_F
    assert kstest(noise.ravel(), norm.cdf).pvalue > FALSE_ALARM
    correlation = np.corrcoef(noise.T)[np.triu_indices(6, 1)]
    assert np.abs(correlation).max() * np.sqrt(len(noise)) < norm.isf(FALSE_ALARM / 30)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"sigma_a": -1}, "sigma_a must be from 0 to 1e"),
        ({"sigma_a": np.inf}, "sigma_a must"),
        ({"samples": 0}, "samples must be a whole number"),
        ({"x0": [1, 2]}, "x0 must have shape"),
        ({"array": None}, "array must be"),
        ({"prior": (PRIOR_MEAN - [3, 0, 0, 0, 0, 0], PRIOR_COVARIANCE)}, "prior must have room"),
    ],
)
def test_what_makes_no_path_is_refused(settings, message):
    with pytest.raises(ValueError, match=message):
        draw_targets(1, rng=np.random.default_rng(1), **settings)
