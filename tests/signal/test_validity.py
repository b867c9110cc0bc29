"""What is no measurement is told from the raw samples, and what is one is kept.

Seeds were written down once and are not chosen.
"""

import numpy as np
import pytest

from dopplerlib.signal._validity_loops import middle_network
from dopplerlib.signal.front_end import lowpass, lowpass_decimate
from dopplerlib.signal.impairments import (
    branches_differ,
    correct_iq_imbalance,
    quantize,
    remove_mean,
)
from dopplerlib.signal.synthesis import complex_noise, tone
from dopplerlib.signal.validity import valid_samples
from tests.signal import slow_validity

FS, N = 10e3, 5000
WHERE = {
    "throughout": slice(None),
    "from the start": slice(0, 2000),
    "in the middle": slice(1500, 3500),
    "to the end": slice(2900, None),
}
FAULTS = {
    "zero": lambda x, rng: 0 * x,
    "stuck": lambda x, rng: np.full(x.shape, 0.3 + 0.1j),
    "stuck at its last value": lambda x, rng: np.full(x.shape, x[0]),
    "stuck with rounding noise": lambda x, rng: 0.3 + complex_noise(x.shape, 1e-8, rng=rng),
    "stuck with a fiftieth of the noise": lambda x, rng: 1j + complex_noise(x.shape, 4e-6, rng=rng),
    "not finite": lambda x, rng: np.full(x.shape, np.nan),
    "infinite": lambda x, rng: np.full(x.shape, np.inf),
}


def six(n=N, snr_db=20.0, seed=1):
    return tone(np.linspace(-120, 120, 6), FS, n, snr_db, rng=np.random.default_rng(seed))


@pytest.mark.parametrize("where", WHERE)
@pytest.mark.parametrize("fault", FAULTS)
def test_a_dead_stretch_is_told_to_the_sample_and_costs_no_other(fault, where):
    """But for a few beside it: where 128 samples together hardly move, some of them may do."""
    x = six()
    part = WHERE[where]
    x[2, part] = FAULTS[fault](x[2, part], np.random.default_rng(2))
    valid = valid_samples(x)
    dead = np.zeros(N, dtype=bool)
    dead[part] = True
    assert not valid[2, dead].any()
    assert np.sum(~valid[2, ~dead]) <= 24
    assert np.delete(valid, 2, axis=0).all()


def test_a_dead_stretch_is_told_without_other_modules_too():
    for fault in FAULTS.values():
        for part in list(WHERE.values())[1:]:
            x = six()[2]
            x[part] = fault(x[part], np.random.default_rng(3))
            valid = valid_samples(x)
            assert not valid[part].any()
            assert valid.sum() >= N - len(x[part]) - 24


@pytest.mark.parametrize("branch", ["I", "Q"])
def test_a_dead_branch_is_a_dead_module(branch):
    x = six()
    part = x[1].view(float).reshape(-1, 2)[:, "IQ".index(branch)]
    part[2000:3000] = part[2000]
    assert not valid_samples(x)[1, 2000:3000].any()


@pytest.mark.parametrize(("below_db", "length"), [(11, 192), (14, 192), (21, 64), (28, 32)])
def test_a_stuck_module_with_noise_of_its_own_is_told_in_short_stretches(below_db, length):
    """Wherever the stretch begins: of 40 records at least 36 lose nine tenths of it."""
    found = 0
    for seed in range(40):
        rng = np.random.default_rng(seed)
        x = six(2000, seed=seed)
        a = int(rng.integers(2000 - length))
        x[2, a : a + length] = 0.3 + complex_noise(length, 10 ** (-2 - below_db / 10), rng=rng)
        found += np.mean(~valid_samples(x)[2, a : a + length]) > 0.9
    assert found >= 36


def test_short_pieces_are_told():
    x = six()
    for a in range(100, N, 500):
        x[4, a : a + 20] = x[4, a]
    dead = (np.arange(N) - 100) % 500 < 20
    np.testing.assert_array_equal(valid_samples(x)[4], ~dead)


@pytest.mark.parametrize("bits", [1, 2, 3, 4, 6, 8, 12, 16, None])
@pytest.mark.parametrize("snr_db", [0.0, 10.0, 20.0, 40.0, None])
def test_a_live_module_is_kept_however_few_bits_it_has(bits, snr_db):
    """A chance of 1e-9 for each branch, by `false_alarm`; of one bit most samples are equal."""
    x = tone([5.0, 100.0, 400.0, -3000.0], FS, 2 * N, snr_db, rng=np.random.default_rng(4))
    if bits:
        x = quantize(x, bits, 8.0 if snr_db == 0 else 2.0)
    assert valid_samples(x).all()


def test_noise_alone_is_kept_as_often_as_promised():
    """4000 records: a hundredth of them may lose a run, a chance of 1e-9 that 80 and more do."""
    rng = np.random.default_rng(5)
    for sigma in (0.6, 1.0, 3.0):  # steps
        x = np.round(sigma * rng.standard_normal((4000, 1, 300)))
        lost = ~valid_samples(x, false_alarm=0.01).all(axis=-1)
        assert lost.sum() < 80, sigma


@pytest.mark.parametrize("gain", [1e-3, 1.0, 1e3, 1e130, 1e-200])
def test_the_scale_does_not_matter(gain):
    x = six()
    x[2, 1000:2000] = 0.1
    np.testing.assert_array_equal(valid_samples(gain * x), valid_samples(x))


def test_an_echo_that_grows_is_kept_with_and_without_noise():
    t = np.arange(N) / FS
    growth = 30 / (1 + 290 * np.abs(t - 0.4))
    for snr_db in (20.0, None):
        assert valid_samples(six(snr_db=snr_db) * growth).all()
        assert valid_samples(six(snr_db=snr_db) * growth + complex_noise(6 * N, 0.01,
                             rng=np.random.default_rng(6)).reshape(6, N)).all()  # fmt: skip


def test_a_slow_target_whose_shift_passes_zero_is_kept():
    for snr_db in (20.0, None):
        x = tone([0.0, 20.0], FS, N, snr_db, rng=np.random.default_rng(7), chirp=-100.0)
        assert valid_samples(x).all()


@pytest.mark.parametrize("loud", [300.0, 1e4, 1e8, 1e139, 1e141, 1e308])
def test_loud_samples_cost_themselves(loud):
    """And what their neighbors are does not matter: at the ends, in pairs, or one in a branch."""
    x = six()
    places = [(0, 0), (0, -1), (2, 7), (2, 8), (3, 1000), (4, 2500)]
    for at in places[:-1]:
        x[at] = loud
    x[places[-1]] -= 1j * loud
    np.testing.assert_array_equal(np.argwhere(~valid_samples(x)), np.argwhere(x != six()))


def test_what_lies_at_the_stop_is_clipped():
    x = six()
    for stop in (0.5, 0.9):
        cut = np.clip(x.real, -stop, stop) + 1j * np.clip(x.imag, -stop, stop)
        expected = (np.abs(x.real) < stop) & (np.abs(x.imag) < stop)
        np.testing.assert_array_equal(valid_samples(cut), expected)
        np.testing.assert_array_equal(valid_samples(cut, full_scale=stop), expected)
    np.testing.assert_array_equal(valid_samples(x, full_scale=2.0), np.ones(x.shape, dtype=bool))


def test_samples_without_Q_are_judged_by_I():
    x = six().real
    x[1, 100:300] = 0.0
    for given in (x, x + 0j):
        valid = valid_samples(given)
        assert not valid[1, 100:300].any()
        assert valid.sum() == x.size - 200


def test_any_leading_axes_give_what_each_record_gives():
    x = np.stack([six(500, seed=k) for k in range(6)]).reshape(2, 3, 6, 500)
    x[0, 1, 2, 100:200] = 0
    x[1, 2, 3, 7] = np.nan
    valid = valid_samples(x)
    for at in np.ndindex(2, 3):
        np.testing.assert_array_equal(valid[at], valid_samples(x[at]))
    assert valid.sum() == x.size - 101
    for shape in ((0,), (3, 0), (0, 5), (2, 0, 5)):
        assert valid_samples(np.zeros(shape)).shape == shape


def test_a_longest_run_that_is_given_counts():
    x = six()[0]
    x[10:14] = x[10]
    assert valid_samples(x, longest_run=4).all()
    assert np.flatnonzero(~valid_samples(x, longest_run=3)).tolist() == [10, 11, 12, 13]


def test_what_makes_no_sense_is_refused_by_name():
    for kwargs, message in [
        ({"x": "text"}, "x must be an array of numbers, got 'text'"),
        ({"x": 1.0}, r"x must have shape \(\.\.\., any\), got \(\)"),
        ({"full_scale": 0}, "full_scale must be positive, got 0"),
        ({"longest_run": 0.5}, "longest_run must be a whole number of at least 1, got 0.5"),
        ({"false_alarm": 1}, "false_alarm must lie between 0 and 1, got 1"),
    ]:
        with pytest.raises(ValueError, match=message):
            valid_samples(**({"x": np.ones(5)} | kwargs))


@pytest.fixture(scope="module")
def masked():
    """Return samples, and a mask that leaves out a gap, a module and the end of another."""
    x = six(400) + (0.5 - 0.2j)
    valid = np.ones(x.shape, dtype=bool)
    valid[0, 100:150] = valid[1] = valid[2, 390:] = False
    return x, valid


@pytest.mark.parametrize("filling", [0.0, np.nan, 1e300])
def test_means_and_moments_are_those_of_valid_samples(masked, filling):
    x, valid = masked
    given = np.where(valid, x, filling)
    with np.errstate(all="raise"):
        centered = remove_mean(given, valid)
        balanced = correct_iq_imbalance(centered, valid)
    assert (centered[~valid] == 0).all()
    assert (balanced[~valid] == 0).all()
    for row, keep in enumerate(valid):
        part = x[row, keep]
        if keep.any():
            np.testing.assert_allclose(centered[row, keep], part - part.mean(), atol=1e-15)
            alone = correct_iq_imbalance(part - part.mean())
            np.testing.assert_allclose(balanced[row, keep], alone, atol=1e-14)
    every = np.ones(x.shape, dtype=bool)
    np.testing.assert_array_equal(remove_mean(x, every), remove_mean(x))
    y = remove_mean(x)
    np.testing.assert_array_equal(correct_iq_imbalance(y, every), correct_iq_imbalance(y))


@pytest.mark.parametrize("factor", [1, 4])
def test_a_filter_spreads_what_is_invalid_by_its_length(masked, factor):
    """What is said to be valid depends on valid samples alone; the first outputs are not."""
    x, valid = masked
    taps = 20 * factor + 1 if factor > 1 else 1
    results = []
    for filling in (0.0, np.nan, 1e8):
        y, fs, delay, kept = lowpass_decimate(np.where(valid, x, filling), FS, factor, valid=valid)
        assert (y.shape, fs, delay) == (kept.shape, FS / factor, (taps - 1) / 2 / FS)
        results.append(y)
        expected = [
            [row[m - taps + 1 : m + 1].all() if m >= taps - 1 else False
             for m in range(0, len(row), factor)]
            for row in valid
        ]  # fmt: skip
        np.testing.assert_array_equal(kept, expected)
        whole, _, _ = lowpass_decimate(x, FS, factor)
        np.testing.assert_allclose(y[kept], whole[kept], atol=1e-12)
    np.testing.assert_array_equal(results[0], results[1])
    assert not lowpass(x[:, :5], FS, 100.0, 7, valid[:, :5])[2].any()


def test_a_module_without_direction_is_told_from_one_that_is_dead():
    x = six(500)
    x[0], x[1], x[2], x[3] = x[0].real, 1j * x[1].imag, (1 - 2j) * x[2].real, 0
    expected = [False, False, False, True, True, True]
    for gain in (1.0, 1e-200, 1e200):
        with np.errstate(all="raise"):
            assert branches_differ(gain * x).tolist() == expected
    valid = np.ones((6, 1), dtype=bool)
    valid[:3] = False
    assert branches_differ(x, valid).all()


def spoiled(rng):
    """Return six modules with faults of all kinds at random places, or with none."""
    n = int(rng.choice([1, 17, 33, 200, 1500]))
    snr_db = rng.choice([0.0, 20.0, 40.0])
    x = tone(rng.uniform(-200, 200, 6), FS, n, snr_db, rng=rng)
    x *= 10.0 ** rng.uniform(-3, 3, (6, 1)) if rng.random() < 0.3 else 1.0
    if rng.random() < 0.6:
        x = quantize(x, int(rng.integers(2, 17)), 1.5)
    for _ in range(rng.integers(4)):
        a, b = np.sort(rng.integers(n, size=2))
        part = x[rng.integers(6), a : min(b, a + int(rng.choice([1, 20, 300, n]))) + 1]
        part[:] = FAULTS[rng.choice(list(FAULTS))](part, rng)
    if rng.random() < 0.3:
        x = np.clip(x.real, -0.6, 0.6) + 1j * x.imag
    if rng.random() < 0.3:
        x[rng.integers(6), rng.integers(n)] = 10.0 ** rng.integers(7)
    return x


@pytest.mark.parametrize("seed", range(4))
def test_the_compiled_passes_find_what_the_slow_ones_find(seed):
    """On 100 records with faults each, at other levels of false alarms, stops and runs, too."""
    rng = np.random.default_rng(seed)
    with np.errstate(all="ignore"):
        for _ in range(100):
            x = spoiled(rng)
            options = {
                "full_scale": rng.choice([None, None, 0.6]),
                "longest_run": rng.choice([None, None, 5]),
                "false_alarm": rng.choice([1e-9, 1e-3]),
            }
            expected = slow_validity.valid_samples(x, **options)
            np.testing.assert_array_equal(valid_samples(x, **options), expected)


def test_the_middle_network_finds_the_middle_of_any_values():
    rng = np.random.default_rng(8)
    for n in range(2, 40):
        values = rng.integers(n, size=(n, 500)).astype(float)
        expected = np.sort(values, axis=0)[n // 2]
        for i, j in middle_network(n):
            values[[i, j]] = np.minimum(values[i], values[j]), np.maximum(values[i], values[j])
        np.testing.assert_array_equal(values[n // 2], expected)
