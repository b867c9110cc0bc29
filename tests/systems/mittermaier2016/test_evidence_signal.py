"""Numbers of the signal chain that are judged, by another route: closed forms, ramps, loops."""

import numpy as np
import pytest
from scipy.stats import kstest, norm

from dopplerlib.systems import mittermaier2016 as paper
from dopplerlib.systems.mittermaier2016.evidence import _signal as evidence
from dopplerlib.systems.mittermaier2016.evidence._chain import chain_evidence
from tests.sweeps import narrowed

S = paper.reported().scenario
BINS = "between the bins", "highest bin"
ALL = {
    "snr": (0, 20),
    "sampling_rate": (10e3, 1e6),
    "window": (0.001, 0.1),
    "window_samples": (10, 100),
    "peak": BINS,
    "dependence": ("signal-to-noise ratio", "length"),
    "echo_law": (2, 4),
    "echo": ("0.4 Hz in 1 ms", "60 dB in 1 Hz"),
    "processing": ("shifts every millisecond", "two windows", "the samples"),
    "accuracy": (0.078,),
    "echo_tracked": ("60 dB in 1 Hz",),
}


@pytest.fixture(scope="module")
def found():
    choice = narrowed("mittermaier2016", **ALL)
    return evidence.signal_evidence(choice, np.random.default_rng(1)) | chain_evidence(
        choice, np.random.default_rng(2)
    )


def variance(snr_db, n, fs):
    """Return the bound of a frequency, whose amplitude and phase are unknown, too."""
    return 6 * fs**2 / (4 * np.pi**2 * 10 ** (snr_db / 10) * n * (n**2 - 1))


def test_bounds_of_a_frequency_are_those_of_three_unknowns(found):
    for (snr, rate, window), ours in found["signal-variance"].points.items():
        assert ours == pytest.approx(variance(snr, round(rate * window), rate), rel=1e-9)
    for (snr, rate), ours in found["signal-short"].points.items():
        assert ours == pytest.approx(variance(snr, round(rate / 1000), rate) ** 0.5, rel=1e-9)


def test_a_peak_between_the_bins_attains_the_bound_and_a_bin_has_the_error_of_its_width(found):
    """A hundred samples at 0 dB; mean squares of 4000 are good to 2.2 %, the limits are four."""
    ours = found["signal-bound"].points
    assert ours[100, BINS[0]].value == pytest.approx(1, abs=0.09)
    width = 10e3 / 100  # of a bin; errors are uniform in it, but for noise
    expected = width**2 / 12 / variance(0, 100, 10e3)
    assert ours[100, BINS[1]].value == pytest.approx(expected, rel=0.05)
    assert ours[10, BINS[0]].value > 5


def test_errors_of_a_bin_are_uniform(found):
    """Distance of a uniform law and the normal one of its deviation; 2000 errors add a little."""
    u = np.linspace(-0.5, 0.5, 10_001)
    distance = np.abs(u + 0.5 - norm.cdf(u * 12**0.5)).max()
    ours = found["signal-normal"].points
    assert ours[20, 100, BINS[1]].value == pytest.approx(distance, abs=0.015)
    assert ours[20, 100, BINS[0]].value < 0.03  # exceeded by a normal law once in twenty
    outside = ours[0, 10, BINS[0]]
    assert outside.value > 0.2  # many peaks are of noise
    assert outside.high - outside.value == pytest.approx(0.0304, abs=1e-4)


def test_the_distance_from_a_normal_law_is_that_of_kolmogorov_and_smirnov(monkeypatch):
    """Of errors that are skewed: they differ more on one side than on the other."""
    for sign in (1, -1):
        errors = sign * np.random.default_rng(4).exponential(size=500)
        monkeypatch.setattr(evidence, "_errors", lambda *_, errors=errors: errors)
        ours = evidence._from_normal(np.random.default_rng(5), 0, 10, BINS[0])
        scaled = (errors - errors.mean()) / errors.std()
        assert ours.value == pytest.approx(kstest(scaled, "norm").statistic, rel=1e-9)


def test_twice_the_power_halves_the_variance_and_twice_the_length_leaves_an_eighth(found):
    ours = found["signal-depends"].points
    for what, expected in (("signal-to-noise ratio", 0.5), ("length", 1 / 8)):
        spread = ours[what,].high - ours[what,].low
        assert ours[what,].value == pytest.approx(expected, abs=1.2 * spread)
        assert spread < 0.15 * expected


def test_windows_that_overlap_remember(found):
    """The estimate weights phases by a ramp: correlation of two ramps, one shifted."""
    for (snr, rate), ours in found["signal-white"].points.items():
        density = 10 ** (snr / 10) * rate
        window = (6 / (4 * np.pi**2 * density * S.sigma_f**2)) ** (1 / 3)
        n = 20_000
        ramp = np.arange(n) - (n - 1) / 2
        lags = [round(k * S.T / window * n) for k in range(1, round(window / S.T) + 1)]
        shared = [abs(ramp[lag:] @ ramp[: n - lag]) / (ramp @ ramp) for lag in lags if lag < n]
        assert ours == pytest.approx(max(shared, default=0), abs=0.002)


def test_an_echo_grows_with_the_range(found):
    growth = []
    for sensor in S.array.positions.tolist():
        ranges = [
            np.sqrt(sum((a - b) ** 2 for a, b in zip(p, sensor, strict=True)))
            for p in S.truth[:, :3].tolist()
        ]
        growth.append(ranges[0] / min(ranges))
    for law, ours in found["signal-constant-r"].points.items():
        assert ours == pytest.approx(min(growth) ** law[0], rel=1e-9)


def error(times, deviation, end):
    """Return the root mean square position error at the end, from shifts at some times."""

    def shifts(x):
        path = x + np.multiply.outer(times - end, np.r_[x[3:], 0, 0, 0])
        away = S.array.positions - path[:, None, :3]
        speed = np.sum(away * path[:, None, 3:], axis=-1) / np.linalg.norm(away, axis=-1)
        return 160 * speed.ravel() / deviation

    x = S.x0 + end * np.r_[S.x0[3:], 0, 0, 0]
    slopes = [(shifts(x + d) - shifts(x - d)) / 2e-5 for d in 1e-5 * np.eye(6)]
    _, r = np.linalg.qr(np.stack(slopes, axis=-1))
    return np.linalg.norm(np.linalg.inv(r)[:3])


def error_of_samples(length, cn0, n=400):
    """The same from the phases of samples, each sensor's first phase unknown."""
    times = length * (np.arange(n) + 0.5) / n

    def phases(x):
        path = x + np.multiply.outer(times - length, np.r_[x[3:], 0, 0, 0])
        r = np.linalg.norm(S.array.positions - path[:, None, :3], axis=-1)
        return (4 * np.pi / 0.0125 * (r - r.mean(axis=0))).ravel() * np.sqrt(2 * cn0 * length / n)

    x = S.x0 + length * np.r_[S.x0[3:], 0, 0, 0]
    slopes = [(phases(x + d) - phases(x - d)) / 2e-6 for d in 1e-6 * np.eye(6)]
    _, r = np.linalg.qr(np.stack(slopes, axis=-1))
    return np.linalg.norm(np.linalg.inv(r)[:3])


STRONG = 6 / (4 * np.pi**2 * S.T**3 * S.sigma_f**2)  # power over noise in 1 Hz


@pytest.mark.parametrize(("echo", "cn0"), [("0.4 Hz in 1 ms", STRONG), ("60 dB in 1 Hz", 1e6)])
def test_ten_milliseconds_hold_what_shifts_and_phases_hold(found, echo, cn0):
    ours = found["table2-from-iq"].points
    for name, windows in (("shifts every millisecond", 10), ("two windows", 2)):
        length = 0.01 / windows
        deviation = np.sqrt(6 / (4 * np.pi**2 * cn0 * length**3))
        expected = error(length * (np.arange(windows) + 0.5), deviation, 0.01)
        assert ours[echo, name] == pytest.approx(expected, rel=0.01)
    assert ours[echo, "the samples"] == pytest.approx(error_of_samples(0.01, cn0), rel=0.01)
    length = found["start-rapid"].points[0.078, echo] / 1e3
    assert error_of_samples(length, cn0) == pytest.approx(0.078, rel=0.01)


def test_the_final_range_is_about_as_good_as_its_windows_allow(found):
    """Median of 30, good to 25 %; the filter's process noise costs less than a factor of three."""
    ours = found["range-from-iq"].points["60 dB in 1 Hz",]
    P = paper.position_bound(1.0, 0.025, 1e6)
    least = 100 * norm.ppf(0.75) * P[0, 0] ** 0.5
    assert 0.7 * least < ours.value < 4 * least
