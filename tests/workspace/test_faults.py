"""Each fault changes what it says, by its size, and leaves the noise as it was."""

import numpy as np
import pytest
from scipy.stats import binom, chi2, norm

from dopplerlib import RadarArray, doppler_shift
from dopplerlib.workspace.faults import BAND, FAULTS, with_fault
from dopplerlib.workspace.targets import (
    ARRAY,
    INTERVAL,
    SIGMA_F,
    draw_records,
    draw_targets,
)

TRUTHS, NOISE = np.random.default_rng(2016).spawn(2)
PATHS = draw_targets(4, rng=TRUTHS, sigma_a=0, samples=300)
Z = draw_records(PATHS, rng=NOISE)
TIME = INTERVAL * np.arange(1, 301)
THERE = ~np.isnan(PATHS[..., 0])
ALMOST_NEVER = 1e-6  # false alarm of the random tests


def changed(kind, size, seed=5, paths=PATHS, z=Z):
    return with_fault(paths, z, kind, size, rng=np.random.default_rng(seed))


def noise_of(paths, z):
    there = ~np.isnan(paths[..., 0])
    return z[there] - doppler_shift(paths[there], ARRAY)


@pytest.mark.parametrize("name", FAULTS)
def test_a_run_is_the_same_alone_and_among_others_and_keeps_its_ends(name):
    fault = FAULTS[name]
    paths, z = changed(fault.kind, fault.size)
    few_paths, few = changed(fault.kind, fault.size, paths=PATHS[:2], z=Z[:2])
    np.testing.assert_array_equal(few, z[:2])
    np.testing.assert_array_equal(few_paths, paths[:2])
    assert np.isnan(z[np.isnan(paths[..., 0])]).all()
    assert np.isnan(paths[np.isnan(PATHS[..., 0])]).all()
    if fault.kind != "none":
        assert not np.array_equal(z, Z, equal_nan=True)


@pytest.mark.parametrize(
    "kind", ["biased", "positions", "late", "each late", "acceleration", "turn"]
)
def test_a_fault_of_size_zero_is_none(kind):
    paths, z = changed(kind, 0.0)
    np.testing.assert_allclose(z, Z, rtol=0, atol=1e-9)
    np.testing.assert_allclose(paths, PATHS, rtol=0, atol=1e-12)


def test_one_sensor_dies_is_biased_or_noisier():
    _, dead = changed("dead", 0.1)
    gone = np.isnan(dead) & THERE[..., None]
    for run in range(4):
        (sensor,) = np.flatnonzero(gone[run].any(axis=0))
        assert gone[run, :, sensor].argmax() == np.argmax(TIME >= 0.1)
        assert np.count_nonzero(gone[run]) == np.count_nonzero(THERE[run] & (TIME >= 0.1))
    _, biased = changed("biased", 5.0)
    off = np.where(THERE[..., None], biased - Z, 0)
    assert sorted(np.unique(off.round(9))) == [0, 5]
    assert (np.count_nonzero(off[:, 0], axis=-1) == 1).all()
    _, noisier = changed("noisier", 3.0)
    added = (noisier - Z)[THERE]
    one = added[np.abs(added) > 1e-9]
    assert len(one) == THERE.sum()
    # Its variance is (9 - 1) sigma_f^2.
    form = np.sum(one**2) / (8 * SIGMA_F**2)
    assert chi2.ppf(ALMOST_NEVER / 2, len(one)) < form < chi2.isf(ALMOST_NEVER / 2, len(one))


def test_two_exchanged_sensors_are_exchanged():
    _, z = changed("exchanged", 0.0)
    for one, was in zip(z, Z, strict=True):
        same = (one[0] == was[0]).sum()
        assert same == 4
        np.testing.assert_array_equal(np.sort(one[0]), np.sort(was[0]))


@pytest.mark.parametrize("kind", ["outliers", "dropouts"])
def test_a_share_of_the_samples_is_wrong_or_missing(kind):
    _, z = changed(kind, 0.1)
    hit = (np.isnan(z) if kind == "dropouts" else z != Z) & THERE[..., None]
    n = 6 * THERE.sum()
    low, high = binom.ppf([ALMOST_NEVER / 2, 1 - ALMOST_NEVER / 2], n, 0.1)
    assert low <= hit.sum() <= high
    if kind == "outliers":
        wrong = z[hit]
        assert np.abs(wrong).max() <= BAND
        # Their mean over their deviation of BAND / sqrt(3).
        assert abs(wrong.mean()) < norm.isf(ALMOST_NEVER / 2) * BAND / np.sqrt(3 * len(wrong))


def test_the_other_target_is_a_target():
    _, z = changed("other target", 0.5)
    hit = (z != Z) & THERE[..., None]
    assert 0.3 < hit.sum() / THERE.sum() / 6 < 0.6
    for run in range(4):
        sensors = [z[run, hit[run, :, n], n] for n in range(6)]
        # A target's shifts move slowly, and its noise is that of the record.
        assert max(np.abs(np.diff(one)).max() for one in sensors if len(one) > 1) < 20


def test_an_accelerated_target_has_that_acceleration_and_its_own_shifts():
    paths, z = changed("acceleration", 3.0)
    a = np.diff(paths[..., 3:], axis=1) / INTERVAL
    size = np.linalg.norm(a, axis=-1)
    np.testing.assert_allclose(size[~np.isnan(size)], 3.0, rtol=1e-9)
    start = PATHS[:, 0, :3] - INTERVAL * PATHS[:, 0, 3:]  # uniform motion: this is time zero
    a0 = a[:, 0]
    want = start[:, None] + TIME[:, None] * PATHS[:, :1, 3:] + TIME[:, None] ** 2 / 2 * a0[:, None]
    there = ~np.isnan(paths[..., 0])
    np.testing.assert_allclose(paths[there, :3], want[there], atol=1e-9)
    both = there & THERE
    np.testing.assert_allclose(
        z[both] - doppler_shift(paths[both], ARRAY), Z[both] - doppler_shift(PATHS[both], ARRAY),
        atol=1e-9,
    )  # fmt: skip


def test_a_turning_target_keeps_its_speed_on_a_circle():
    paths, z = changed("turn", 3.0)
    there = ~np.isnan(paths[..., 0])
    speed = np.linalg.norm(paths[..., 3:], axis=-1)
    np.testing.assert_allclose(speed[there], np.repeat(speed[:, 0], there.sum(axis=1)), rtol=1e-9)
    for path, one in zip(paths, there, strict=True):
        known = path[one]
        sideways = np.array([-known[0, 4], known[0, 3]])
        radius = np.hypot(*known[0, 3:5]) / 3.0
        apart = []
        for side in (-1, 1):
            middle = known[0, :2] + side * radius * sideways / np.linalg.norm(sideways)
            apart.append(np.ptp(np.linalg.norm(known[:, :2] - middle, axis=1)))
        assert min(apart) < 1e-6  # the trapezoid is off by (w T)^2 / 12 of the way
    both = there & THERE
    difference = z[both] - doppler_shift(paths[both], ARRAY) - noise_of(PATHS, Z)[both[THERE]]
    assert np.abs(difference).max() < 1e-9


def test_sensors_elsewhere_are_those_of_another_array():
    _, z = changed("positions", 0.005)
    generators = np.random.default_rng(5).spawn(4)
    for path, one, was, child in zip(PATHS, z, Z, generators, strict=True):
        moved = RadarArray(
            ARRAY.positions + 0.005 * child.standard_normal((6, 3)), ARRAY.wavelength
        )
        there = ~np.isnan(path[:, 0])
        want = was[there] - doppler_shift(path[there], ARRAY) + doppler_shift(path[there], moved)
        np.testing.assert_allclose(one[there], want, atol=1e-9)


def test_late_shifts_are_those_of_the_time_before():
    """Motion is uniform, so the place is known, also before the record begins."""
    _, z = changed("late", 0.0125)
    _, each = changed("each late", 0.0125)
    before = PATHS.copy()
    before[..., :3] -= 0.0125 * before[..., 3:]
    np.testing.assert_allclose(
        z[THERE] - doppler_shift(before[THERE], ARRAY), noise_of(PATHS, Z), atol=1e-9
    )
    delays = np.stack([g.uniform(-0.0125, 0.0125, 6) for g in np.random.default_rng(5).spawn(4)])
    for n in range(6):
        then = PATHS.copy()
        then[..., :3] -= delays[:, n, None, None] * then[..., 3:]
        got = each[THERE][:, n] - doppler_shift(then[THERE], ARRAY)[:, n]
        np.testing.assert_allclose(got, noise_of(PATHS, Z)[:, n], atol=1e-9)


def test_shapes_and_sizes_that_do_not_fit_are_refused():
    with pytest.raises(ValueError, match=r"^size must be from 0 to 1e"):
        changed("biased", -1.0)
    with pytest.raises(ValueError, match=r"^z must have shape \(4, 300, 6\)"):
        changed("biased", 1.0, z=Z[:, :-1])
