"""Filters that take one sample at a time give the bits of those that take whole records."""

import numpy as np
import pytest

from dopplerlib import RadarArray, doppler_jacobian, doppler_shift, ekf, ekf_records, ukf
from dopplerlib.estimation.ekf_online import ekf_online
from dopplerlib.estimation.online import ekf_records_online, ukf_online

T = 1e-3
RING = RadarArray.ring(6, 0.2)
START = np.array([0.8, 0.1, 0.09, -0.75, -0.12, -0.02])
P0 = np.diag([0.01, 0.01, 0.01, 0.04, 0.04, 0.04])
FIELDS = ("x", "P", "innovation", "S", "nis", "updated")


def record(samples=60, seed=1):
    """Return noisy shifts (samples, 6) with gaps, a sample without any, and outliers."""
    rng = np.random.default_rng(seed)
    path = np.tile(START, (samples, 1))
    path[:, :3] += (T * np.arange(1, samples + 1))[:, None] * START[3:]
    z = doppler_shift(path, RING) + 0.4 * rng.standard_normal((samples, 6))
    z[5, 2], z[9], z[20], z[31, :4] = np.nan, np.nan, z[20] + 50, np.nan
    return z


def assert_same_bits(one, track, k):
    for name in FIELDS:
        got, want = np.asarray(getattr(one, name)), np.asarray(getattr(track, name)[k])
        assert got.tobytes() == want.tobytes(), (name, k)


@pytest.mark.parametrize("gate", [None, "upper", "two-sided", "soft"])
@pytest.mark.parametrize("noise", ["shared", "per_axis", "horizontal"])
def test_doppler_filter(noise, gate):
    z = record()
    sigma_f = [0.3, 0.4, 0.5, 0.4, 0.3, 0.6]
    track = ekf(z, RING, START, P0, T, 0.4, sigma_f, noise, gate)
    update = ekf_online(RING, START, P0, T, 0.4, sigma_f, noise, gate)
    found = [update(list(sample) if k % 2 else sample) for k, sample in enumerate(z)]
    for k, one in enumerate(found):
        assert_same_bits(one, track, k)


@pytest.mark.parametrize("gate", [None, "soft"])
def test_intervals_may_vary_and_come_back(gate):
    z = record()
    intervals = np.full(len(z), T)
    intervals[[3, 4, 17, 59]] = 2e-3, 5e-4, 3e-3, 7e-4
    track = ekf(z, RING, START, P0, intervals, 0.4, 0.4, gate=gate)
    update = ekf_online(RING, START, P0, T, 0.4, 0.4, gate=gate)
    for k, sample in enumerate(z):
        given = {} if intervals[k] == T else {"T": float(intervals[k])}
        assert_same_bits(update(sample, **given), track, k)


@pytest.mark.parametrize("gate", [None, "soft"])
def test_deviations_may_vary_and_come_back(gate):
    z = record()
    sigma_f = np.full((len(z), 6), 0.4)
    sigma_f[[3, 4, 17]] = np.random.default_rng(2).uniform(0.2, 0.9, (3, 6))
    sigma_f[30:33] = 0.7
    track = ekf(z, RING, START, P0, T, 0.4, sigma_f, gate=gate)
    update, mine = ekf_online(RING, START, P0, T, 0.4, 0.4, gate=gate), np.empty(6)
    for k, sample in enumerate(z):
        mine[:] = sigma_f[k]  # the same array with other numbers
        given = {"sigma_f": 0.7 if k in (30, 31) else mine} if sigma_f[k, 0] != 0.4 else {}
        assert_same_bits(update(sample, **given), track, k)


def test_two_targets_do_not_share_a_state():
    z, other = record(), record(seed=2)
    track = ekf(z, RING, START, P0, T, 0.4, 0.4)
    one, two = (ekf_online(RING, START, P0, T, 0.4, 0.4) for _ in range(2))
    for k in range(len(z)):
        two(other[k])
        assert_same_bits(one(z[k]), track, k)


@pytest.mark.parametrize("gate", [None, "soft"])
@pytest.mark.parametrize("keep", [(), ("P",), ("innovation",), ("S",), ("S", "P")])
def test_keep_leaves_the_rest_out(keep, gate):
    z = record()
    track = ekf(z, RING, START, P0, T, 0.4, 0.4, gate=gate, keep=keep)
    update = ekf_online(RING, START, P0, T, 0.4, 0.4, gate=gate, keep=keep)
    for k, sample in enumerate(z):
        found = update(sample)
        for name in FIELDS:
            got, want = getattr(found, name), getattr(track, name)
            assert (got is None) == (want is None)
            assert want is None or np.asarray(got).tobytes() == want[k].tobytes()


def test_results_stay_as_they_were():
    update = ekf_online(RING, START, P0, T, 0.4, 0.4)
    first, *rest = record()
    first = update(first)
    kept = {name: np.array(getattr(first, name)) for name in FIELDS}
    for sample in rest:
        update(sample)
    for name, value in kept.items():
        np.testing.assert_array_equal(getattr(first, name), value)
    with pytest.raises(ValueError, match="read-only"):
        first.P[0, 0] = 1.0


def moved(x):
    return np.concatenate([x[..., :3] + T * x[..., 3:], x[..., 3:]], axis=-1)


MOTION = np.eye(6) + T * np.eye(6, k=3)
Q = 1e-6 * np.eye(6)
R = 0.16 * np.eye(6)
HANDED = {
    ekf_records: (ekf_records_online, (moved, lambda x: MOTION, Q),
                  (lambda x: doppler_shift(x, RING), lambda x: doppler_jacobian(x, RING), R)),
    ukf: (ukf_online, (moved, Q), (lambda x: doppler_shift(x, RING), R)),
}  # fmt: skip


@pytest.mark.parametrize("gate", [None, "upper", "soft"])
@pytest.mark.parametrize("iterations", [1, 3])
@pytest.mark.parametrize("whole", HANDED, ids=lambda function: function.__name__)
def test_filters_of_any_functions(whole, gate, iterations):
    online, motion, measurement = HANDED[whole]
    z = record()
    setting = *motion, *measurement, START, P0
    options = {"gate": gate, "iterations": iterations}
    track = whole(z, *setting, **options)
    update = online(*setting, **options)
    for k, sample in enumerate(z):
        assert_same_bits(update(sample), track, k)


@pytest.mark.parametrize("sample", [np.zeros(5), np.zeros((1, 6)), 1.0, [np.inf] * 6, ["1"] * 6])
@pytest.mark.parametrize("function", [ekf_online, ekf_records_online, ukf_online])
def test_a_sample_that_is_none_is_named_and_changes_nothing(function, sample):
    if function is ekf_online:
        update, other = (function(RING, START, P0, T, 0.4, 0.4) for _ in range(2))
    else:
        whole = ekf_records if function is ekf_records_online else ukf
        setting = *HANDED[whole][1], *HANDED[whole][2], START, P0
        update, other = function(*setting), function(*setting)
    z = record()
    assert update(z[0]) == other(z[0])
    with pytest.raises(ValueError, match=r"^z must .*got"):
        update(sample)
    assert update(z[1]) == other(z[1])


@pytest.mark.parametrize("name", ["T", "sigma_f"])
@pytest.mark.parametrize("value", [0.0, -1.0, np.inf, np.nan, "1", [1.0, 2.0]])
def test_a_setting_that_is_none_is_named_and_changes_nothing(name, value):
    z = record()
    update, other = (ekf_online(RING, START, P0, 1e-3, 0.4, 0.4) for _ in range(2))
    assert update(z[0]) == other(z[0])
    with pytest.raises(ValueError, match=rf"^{name} must .*got"):
        update(z[1], **{"T": 2e-3, "sigma_f": 0.7} | {name: value})
    assert update(z[1]) == other(z[1])


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"x0": np.zeros((2, 6))}, "x0 must"),
        ({"P0": np.tile(np.eye(6), (2, 1, 1))}, "P0 must"),
        ({"P0": -np.eye(6)}, "P0 must"),
        ({"T": [0.1, 0.2]}, "T must"),
        ({"sigma_f": np.ones((2, 6))}, "sigma_f must"),
        ({"gate": "hard"}, "gate must"),
        ({"x0": [0, 0.2, 0, 0, 0, 0], "array": RadarArray([[0, 0.2, 0]])}, "F x0 must"),
    ],
)
def test_bad_settings_are_named(changed, message):
    setting = {"array": RING, "x0": START, "P0": P0, "T": T, "sigma_a": 0.4, "sigma_f": 0.4}
    with pytest.raises(ValueError, match=message):
        ekf_online(**(setting | changed))
