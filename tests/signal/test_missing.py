"""Where nothing is to be measured, every estimator says so; one loud moment costs itself.

The estimators are found by their arguments: whatever takes ``x, fs, band`` is one.
"""

import inspect
import itertools

import numpy as np
import pytest

from dopplerlib import RadarArray, ekf, sliding_doppler
from dopplerlib.evaluation.frequency_benchmark import ESTIMATORS
from dopplerlib.signal import frequency, interpolation, phase
from dopplerlib.signal.synthesis import tone
from tests.together import each

FS, N = 1000.0, 64


def takes_samples(value):
    return inspect.isfunction(value) and list(inspect.signature(value).parameters)[:3] == [
        "x", "fs", "band",
    ]  # fmt: skip


PLAIN = {
    name: value
    for module in (frequency, interpolation, phase)
    for name, value in vars(module).items()
    if takes_samples(value) and not name.startswith("_") and value.__module__ == module.__name__
}
ALL = PLAIN | ESTIMATORS
every = pytest.mark.parametrize("estimator", ALL.values(), ids=ALL)


def test_all_of_them_are_found():
    assert len(PLAIN) == 12
    assert len(ESTIMATORS) == 16
    assert {getattr(e, "func", e) for e in ESTIMATORS.values()} == set(PLAIN.values())


@every
def test_a_window_that_never_moves_has_no_frequency(estimator):
    def check(value, band):
        alone = np.full(N, value, dtype=complex)
        x = np.stack([np.exp(0.5j * np.arange(N)), alone])
        with np.errstate(all="raise"):
            f = estimator(x, FS, band)
            assert np.isnan(estimator(alone, FS, band))
        assert np.isnan(f[1])
        assert abs(f[0] - 0.5 * FS / (2 * np.pi)) < FS / N

    values = [0.0, 1.0, 0.1 - 0.7j, 1e-3j / 3, -1e200, 1e-200]
    each(itertools.product(values, [None, (0.0, FS), (-250.0, 250.0)]), check)


@every
def test_a_window_that_tells_nothing_is_no_error(estimator):
    """Single samples have a flat spectrum, and no phase turns: any frequency, or none, is right."""
    x = np.zeros((4, N), dtype=complex)
    x[0, 0] = x[1, 30] = x[2, -1] = 1.0
    x[3, :2] = 1.0, 1j
    with np.errstate(all="raise"):
        f = estimator(x, FS)
    assert f.shape == (4,)


@every
def test_the_size_of_the_samples_does_not_matter(estimator):
    """Powers of two change no bit, others round: a millionth of a bin is what a search leaves."""
    x = tone([100.0, -37.0], FS, N, 20.0, rng=np.random.default_rng(1))
    expected = estimator(x, FS)

    def check(gain):
        with np.errstate(all="raise"):
            f = estimator(gain * x, FS)
            both = estimator(np.stack([gain * x[0], x[1]]), FS)
        np.testing.assert_allclose(f, expected, atol=1e-5 * FS / N)
        np.testing.assert_allclose(both, f, atol=1e-5 * FS / N)

    each([(1e-300,), (1e-160,), (1e155,), (1e300,)], check)


@every
def test_one_loud_moment_costs_its_windows_only(estimator):
    x = tone([100.0, -37.0], FS, 10 * N, 20.0, rng=np.random.default_rng(2))
    clean = sliding_doppler(x, FS, N, N, estimator)
    others = np.ones((10, 2), dtype=bool)
    others[2, 1] = False

    def check(loud):
        x[1, 2 * N + 5] = loud
        with np.errstate(all="raise"):
            d = sliding_doppler(x, FS, N, N, estimator)
        for name in ("frequency", "amp2", "noise_variance", "frequency_std"):
            one, two = getattr(d, name), getattr(clean, name)
            np.testing.assert_allclose(one[others], two[others], rtol=1e-6, atol=1e-6)

    each([(1e4,), (1e8,), (1e30,), (1e100,)], check)


@pytest.mark.parametrize("name", PLAIN)
@pytest.mark.parametrize("filling", [0.0, np.nan, np.inf, 1e300, 3.0])
def test_a_window_that_touches_an_invalid_sample_is_missing_and_no_other(name, filling):
    hop, window = 20, N
    x = tone([[100.0, -37.0]], FS, 10 * N, 20.0, rng=np.random.default_rng(3))
    clean = sliding_doppler(x, FS, window, hop, PLAIN[name])
    valid = np.ones(x.shape, dtype=bool)
    valid[0, 1, 100:110] = valid[0, 0, -1] = False
    x[~valid] = filling
    with np.errstate(all="raise"):
        d = sliding_doppler(x, FS, window, hop, PLAIN[name], valid=valid)
        z, std = d.measurements()
    firsts = np.arange(d.frequency.shape[1]) * hop
    gone = np.stack([firsts + window == 10 * N, (firsts < 110) & (firsts + window > 100)], axis=-1)
    for value, wanted in ((d.frequency, np.nan), (d.amp2, 0.0), (d.snr, 0.0),
                          (d.frequency_std, np.inf), (z, np.nan), (std, FS)):  # fmt: skip
        np.testing.assert_array_equal(value[0, gone], wanted)
    for value in ("frequency", "amp2", "noise_variance", "frequency_std"):
        one, two = getattr(d, value)[0, ~gone], getattr(clean, value)[0, ~gone]
        np.testing.assert_allclose(one, two, rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("name", PLAIN)
def test_a_filter_takes_whatever_the_measurements_are(name):
    """Zeros, constants, single samples, no noise, loud and faint samples, and rounding noise."""
    rng = np.random.default_rng(4)
    array = RadarArray.ring(6, 0.2)
    x = tone(np.linspace(-100, 100, 6), FS, 8 * N, 10.0, rng=rng)
    x[0] = tone(50.0, FS, 8 * N, None, rng=rng)
    x[1, : 2 * N], x[1, 2 * N : 4 * N], x[1, 5 * N] = 0.0, 0.3 - 0.1j, 1e100
    x[2], x[3] = 0.5 + 1e-16 * x[2], 1e-120 * x[3]
    with np.errstate(all="raise"):
        z, std = sliding_doppler(x, FS, N, N // 2, PLAIN[name]).measurements()
    assert (std > 0).all()
    assert (std[np.isfinite(z)] < FS).all()
    track = ekf(z, array, [0, 0, 3, 0, 1, -1], np.eye(6), 0.5 * N / FS, 1.0, std)
    assert track.x.shape == (len(z), 6)


def test_a_mask_of_one_module_or_of_one_moment_is_spread():
    x = tone([100.0, -37.0], FS, 4 * N, 20.0, rng=np.random.default_rng(5))
    for valid in ([[True], [False]], np.arange(4 * N) >= N, True):
        d = sliding_doppler(x, FS, N, N, valid=valid)
        same = sliding_doppler(x, FS, N, N, valid=np.broadcast_to(valid, x.shape).copy())
        assert d == same
    for wrong, message in (
        (np.ones((3, 4 * N), dtype=bool), r"valid must have a shape that broadcasts to \(2, 256\)"),
        (np.ones(4 * N), "valid must be an array of booleans, got"),
    ):
        with pytest.raises(ValueError, match=message):
            sliding_doppler(x, FS, N, N, valid=wrong)
    x[0, 7] = np.nan
    with pytest.raises(ValueError, match=r"x must be finite, got .*nan.* at index \(0, 7\)"):
        sliding_doppler(x, FS, N, N)
    with pytest.raises(ValueError, match=r"x must be finite, got .*nan.* at index \(0, 7\)"):
        sliding_doppler(x, FS, N, N, valid=np.arange(4 * N) > 100 * (np.arange(2) == 1)[:, None])
    x[0, 7] = 1e150
    with pytest.raises(ValueError, match=r"x must not exceed 1e\+140, .* got 1e\+150"):
        sliding_doppler(x, FS, N, N)


def test_energies_are_those_of_each_window_whatever_the_hop():
    x = tone([100.0], FS, 5 * N, 3.0, rng=np.random.default_rng(6))
    for window, hop in itertools.product((3, 17, N), (1, 5, 100, 10 * N)):
        d = sliding_doppler(x, FS, window, hop)
        firsts = np.arange(0, 5 * N - window + 1, hop)
        energy = [np.sum(np.abs(x[0, a : a + window]) ** 2) for a in firsts]
        left = d.noise_variance[:, 0] * (window - 1.5) + window * d.amp2[:, 0]
        np.testing.assert_allclose(left, energy, rtol=1e-12)
