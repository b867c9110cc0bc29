"""Lines go, echoes that cross them stay, and deviations remain right."""

import numpy as np
import pytest
from scipy import signal
from scipy.stats import chi2

from dopplerlib.signal.lines import near_lines, remove_lines
from dopplerlib.signal.real_tone import ml_frequency_real
from dopplerlib.signal.sliding import sliding_doppler
from dopplerlib.signal.synthesis import complex_noise

FS, WINDOW, RUNS = 2000.0, 50, 4
LINES = [50, 100, 150]
T = np.arange(4000) / FS
CHIRP = 140 - 40 * T  # crosses 100 Hz after a second
ECHO = np.exp(2j * np.pi * np.cumsum(CHIRP) / FS)


def noise(seed):
    """Return noise 27 dB below the echo."""
    return complex_noise((RUNS, len(T)), 0.002, rng=np.random.default_rng(seed))


def hum(amplitude, seed, f=50.0):
    """Return three harmonics with any phases and any amplitudes in I and Q."""
    rng = np.random.default_rng(seed)
    turn = np.exp(2j * np.pi * rng.uniform(size=(3, 2, RUNS, 1)))
    return amplitude * sum(
        (a * np.exp(2j * np.pi * k * f * T)).real * b for k, (a, b) in enumerate(turn, start=1)
    )


def nis(x, valid=None, **settings):
    """Return mean and number of the squared relative errors of shifts away from the lines."""
    d = sliding_doppler(x, FS, WINDOW, WINDOW, valid=valid, **{"band": (-400, 400)} | settings)
    truth = np.interp(d.time, T, CHIRP)[:, None]
    square = ((d.frequency - truth) / d.frequency_std) ** 2
    square = square[~near_lines(np.broadcast_to(truth, square.shape), LINES, 4.0)]
    return np.nanmean(square), np.isfinite(square).sum()


def is_right(mean, number):
    """Return whether a mean of chi-squares is one that comes in all but one of 1e5 tests."""
    low, high = chi2.ppf([5e-6, 1 - 5e-6], number) / number
    return low < mean < high


@pytest.mark.parametrize("mains", [50.0, 50.2])
def test_shifts_are_as_if_there_had_been_no_hum(mains):
    x = ECHO + noise(1) + hum(0.3, 2, mains)
    assert is_right(*nis(ECHO + noise(1)))
    assert nis(x)[0] > 3
    y = remove_lines(x, FS, LINES, WINDOW, band=(-400, 400))
    assert is_right(*nis(y))


def test_a_notch_filter_is_no_remedy():
    """The reason why there is none here: forwards and backwards, 2 Hz wide, it rings for long."""
    x = ECHO + noise(1) + hum(0.3, 2)
    for f in LINES:
        b, a = signal.iirnotch(f, f / 2, fs=FS)
        x = signal.filtfilt(b, a, x.real) + 1j * signal.filtfilt(b, a, x.imag)
    assert nis(x)[0] > 10


def test_it_does_not_matter_how_strong_the_hum_is():
    """To a fifth of the noise: the frequency of a line is found in steps."""
    weak, strong = (
        remove_lines(ECHO + noise(3) + hum(a, 4), FS, LINES, WINDOW, band=(-400, 400))
        for a in (0.1, 1.0)
    )
    assert np.sqrt(np.mean(np.abs(weak - strong) ** 2)) < 0.2 * np.sqrt(0.002)


def test_gaps_and_modules_without_q():
    valid = np.ones((RUNS, len(T)), dtype=bool)
    valid[:, 1300:2000] = False
    x = np.where(valid, ECHO + noise(5) + hum(0.3, 6), np.nan)
    y = remove_lines(x, FS, LINES, WINDOW, band=(-400, 400), valid=valid)
    assert (y[~valid] == 0).all()
    assert is_right(*nis(y, valid))
    real = signal.hilbert((ECHO + noise(7) + hum(0.3, 8)).real)
    y = remove_lines(real, FS, LINES, WINDOW, band=(5, 400))
    assert is_right(*nis(y, estimator=ml_frequency_real, band=(5, 400)))


@pytest.mark.parametrize("lines", [[0], [0, *LINES]])
def test_a_constant_that_drifts_goes_and_noise_stays(lines):
    """Of noise alone the lines take what so many unknowns do: 0 and both signs, at three knots.

    Its energy is chi-square distributed, with two degrees of freedom for each in each record.
    """
    disturbance = np.linspace(0.5, 1.5, len(T)) + 0.2j + (len(lines) > 1) * hum(1.0, 10)
    y = remove_lines(disturbance + noise(9), FS, lines, WINDOW)
    taken = 2 * np.sum(np.abs(noise(9) - y) ** 2) / 0.002
    assert 1e-5 < chi2.cdf(taken, 2 * 3 * (2 * len(lines) - 1) * RUNS) < 1 - 1e-5


@pytest.mark.parametrize("mains, left", [(49.7, 0.01), (50.5, 1.0)])
def test_a_hum_without_an_echo(mains, left):
    """It goes if its harmonics are off by less than a quarter of the width, 1 Hz, or stays."""
    x = noise(11) + hum(1.0, 12, mains)
    y = remove_lines(x, FS, LINES, WINDOW)
    assert np.mean(np.abs(y) ** 2) < left * np.mean(np.abs(x) ** 2)


def test_nothing_is_removed_without_lines_or_samples():
    np.testing.assert_array_equal(remove_lines(ECHO, FS, [], WINDOW), ECHO)
    assert remove_lines(np.empty((0, 100)), FS, [50], WINDOW).shape == (0, 100)
    assert (remove_lines(ECHO, FS, [50], WINDOW, valid=False) == 0).all()


def test_near_is_either_side_of_either_sign():
    f = [48.1, 51.9, -50.0, 47.9, 52.1, 0.0, np.nan]
    assert near_lines(f, [50], 2.0).tolist() == [True] * 3 + [False] * 4
    assert near_lines(f, [-50, 0], 2.0).tolist() == [True] * 3 + [False] * 2 + [True, False]
    assert not near_lines(f, [], 2.0).any()


@pytest.mark.parametrize(
    "change, message",
    [
        ({"lines": [1000]}, "lines must be below fs / 2 = 1000, got 1000"),
        ({"lines": [np.nan]}, "lines must be finite"),
        ({"lines": [50, 53]}, "lines must be 4 Hz apart or more, .* got 3 Hz"),
        ({"lines": [1]}, "lines must be 4 Hz apart or more, also from their negatives, got 2 Hz"),
        ({"window": 5000}, "window must be at most the 4000 samples of the record, got 5000"),
        ({"window": 0}, "window must be a whole number of at least 3, got 0"),
        ({"width": 0}, "width must be positive, got 0"),
        ({"x": ECHO * np.nan}, "x must be finite"),
    ],
)
def test_what_makes_no_sense_is_refused_by_name(change, message):
    with pytest.raises(ValueError, match=f"^{message}"):
        remove_lines(**{"x": ECHO, "fs": FS, "lines": [50], "window": WINDOW} | change)
