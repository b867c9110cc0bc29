"""The numbers judged for Section II, by another route: phasors, lines and sums by hand."""

from itertools import product

import numpy as np
import pytest

from dopplerlib.systems import macaveiu2013 as paper
from dopplerlib.systems.macaveiu2013.evidence import _filter as linear
from dopplerlib.systems.macaveiu2013.evidence import _waveforms as found

C, F0, B, T = 299_792_458.0, 24e9, 150e6, 0.038
LAMBDA = C / F0
CELL_V = LAMBDA / (2 * T)


def butterflies(n):
    """Return the multiplications of a radix-2 transform, counted as it halves."""
    return 0 if n == 1 else 2 * butterflies(n // 2) + n // 2


@pytest.mark.parametrize(("cells", "chirps"), [(128, 2048), (512, 512), (256, 1024)])
def test_pulses_take_more_samples_and_fewer_operations(cells, chirps):
    """Samples in 38 ms, and the transforms of both counted one by one."""
    samples = found.pulse_work("samples a second", cells, chirps)
    assert samples == pytest.approx(5.7e6 / (cells * chirps)) and samples > 1
    pulses = cells * butterflies(chirps)
    both = pulses + chirps * butterflies(cells)
    operations = found.pulse_work("operations of Fourier transforms", cells, chirps)
    assert operations == pytest.approx(pulses / both) and operations < 1


def test_two_targets_can_have_one_beat():
    """Along one line in the plane of range and range rate the beat does not change."""
    ((per_meter, per_speed),) = found.relations((1,))
    assert 30 * per_meter - 5 * per_speed == pytest.approx(
        40 * per_meter + (-5 - 10 * per_meter / per_speed) * per_speed
    )
    assert per_meter == pytest.approx(2 * B / T / C) and per_speed == pytest.approx(2 * F0 / C)


def lines(slopes):
    """Return [Hz per m, Hz per m/s] of the chirps, by hand."""
    return [(2 * a * B / T / C, 2 * F0 / C) for a in (1, -1, 0.6, -0.3)[:slopes]]


def meetings(targets, slopes):
    """Return where lines of the first two chirps meet that every other chirp has a tone for."""
    (a, b), (c, _) = lines(2)
    left = []
    for one, other in product(targets, repeat=2):
        up, down = a * one[0] + b * one[1], c * other[0] + b * other[1]
        r = (up - down) / (a - c)
        v = (up - a * r) / b
        tones = [[x * q + y * w for q, w in targets] for x, y in lines(slopes)[2:]]
        here = [x * r + y * v for x, y in lines(slopes)[2:]]
        if all(min(abs(t - h) for t in ts) < 0.5 / T for ts, h in zip(tones, here, strict=True)):
            left.append((r, v))
    return left


def test_two_lines_of_each_slope_meet_four_times():
    points = meetings(found.TARGETS.tolist(), 2)
    assert len(points) == 4 and len(found.intersections(found.TARGETS, 2)[0]) == 4
    own = [p for p in points if np.abs(np.subtract(p, found.TARGETS)).max(axis=1).min() < 1e-6]
    assert len(own) == 2


def test_ghosts_of_several_slopes_counted_line_by_line():
    """The same scenes, counted by loops; two slopes leave ghosts of two targets, three do not."""
    for slopes, targets in ((3, 2), (3, 5), (4, 5)):
        rng = np.random.default_rng(5)
        scenes = [rng.uniform(*ends, (found.RUNS, targets)) for ends in (found.FAR, found.FAST)]
        scenes = np.stack(scenes, axis=-1).tolist()
        share = np.mean([len(meetings(scene, slopes)) == targets for scene in scenes])
        one = found.resolved(np.random.default_rng(5), slopes, targets)
        assert share == pytest.approx(one.value) and one.low <= share <= one.high
    needed = next(n for n in (2, 3, 4) if len(meetings(found.TARGETS.tolist(), n)) == 2)
    assert found.slopes_needed() == needed == 3


@pytest.mark.parametrize(("snr", "step"), [(10, 1e6), (20, 0.6e6), (0, 2e6)])
def test_fsk_errors_are_those_of_phase_noise(snr, step):
    """A Hann window loses 1.5 of 512 samples; the mean of |x| is 0.8 of a normal deviation.

    The speed is off by up to half of a sixteenth of a cell and by its noise. Means of 100 have
    deviations of 8 %: the bounds are 4 of them away, 1e-4, with a bias of a few centimeters.
    """
    one = found.fsk_errors(np.random.default_rng(6), snr, step)
    phase = np.sqrt(1.5 / (2 * 512 * 10 ** (snr / 10)))  # rad, of each tone
    expected = np.sqrt(2 / np.pi) * np.sqrt(2) * phase * C / (4 * np.pi * step)
    assert one["fsk-range"].value == pytest.approx(expected, rel=0.33, abs=0.08)
    noise = 0.39 * 1.5 / np.sqrt(512 * 10 ** (snr / 10))  # cells; a window widens the bound
    speed = np.hypot(1 / 64, noise * np.sqrt(2 / np.pi))
    assert one["fsk-speed"].value == pytest.approx(speed, rel=0.35)


@pytest.mark.parametrize(
    ("apart", "phase", "step"), [(25, 0.25, 1e6), (10, 0.0, 0.6e6), (5, 0.625, 2e6)]
)
def test_fsk_finds_the_phase_of_the_sum_of_two_echoes(apart, phase, step):
    """Two phasors at each frequency; while it is measured a mover adds some centimeters."""
    ranges = np.array([30.0, 30.0 + apart + phase * LAMBDA / 2])
    one = found.fsk_confusion(apart, phase, step)
    sums = [np.exp(4j * np.pi * f * ranges / C).sum() for f in (F0, F0 + step)]
    turns = np.angle(sums[1] / sums[0]) / (2 * np.pi) % 1
    at_rest = np.abs(turns * C / (2 * step) - ranges).min()
    assert one["fsk-at-rest"] == pytest.approx(at_rest, rel=1e-3)
    moved = np.abs(turns * C / (2 * step) - 5 * T / 2 - ranges).min()
    assert one["fsk-resolution"] == pytest.approx(moved, abs=0.6)
    assert one["fsk-resolution"] != pytest.approx(one["fsk-at-rest"], abs=1e-3)


@pytest.mark.parametrize("beats", ["a shared beat", "beats of their own"])
@pytest.mark.parametrize("phase", [0.25, 0.5, 0.875])
def test_mfsk_solves_for_the_phase_of_the_sum_of_two_echoes(beats, phase):
    """Phasors of each tone at a sixteenth of a cell, and the two equations by hand.

    Where the echoes nearly cancel (phase 0) the solution is farther off still, and hangs on the
    bin.
    """
    up, dwell = B / 511, T / 1024
    A = 2 / C * np.array([[up / (2 * dwell), F0], [-up / 2, F0 * dwell]])
    first = np.array([30.0, -5.0])
    r = (44 if beats == "a shared beat" else 40) + phase * LAMBDA / 2
    v = (A[0] @ first - A[0, 0] * r) / A[0, 1] if beats == "a shared beat" else 4.0
    both, n = (first, np.array([r, v])), np.arange(512)

    def sample(f, t):
        return sum(np.exp(4j * np.pi * f * (q + w * t) / C) for q, w in both)

    a, b = (
        sample(F0 + up * n, (2 * n + 1) * dwell),
        sample(F0 + up * (n - 0.5), (2 * n + 2) * dwell),
    )
    off = []
    for target in both[:1] if beats == "a shared beat" else both:
        near = (np.round(A[0] @ target * 16 * T) + np.arange(-5, 6)) / (16 * T)
        tones = np.exp(-4j * np.pi * np.outer(near, dwell * n)) * np.hanning(512)
        best = np.argmax(np.abs(tones @ a))
        beat, turns = near[best], np.angle((tones @ b)[best] / (tones @ a)[best]) / (2 * np.pi)
        solved = np.linalg.solve(A, [beat, turns])[0]
        off.append(min(abs(solved - 30), abs(solved - r)))
    assert found.mfsk_error(beats, phase) == pytest.approx(max(off), rel=0.02)
    assert (max(off) > 1) == (beats == "a shared beat")


@pytest.mark.parametrize("phase", [0.0, 0.375])
@pytest.mark.parametrize("apart", [3, 12])
def test_two_tones_in_a_gate_by_direct_sums(apart, phase):
    """Tones over the chirps, summed at a fine grid: both are within half a cell."""
    true = 1 + np.array([0.0, apart * CELL_V])
    t = (np.arange(512) + 0.5) * T / 512
    phases = 4 * np.pi / LAMBDA * (np.add.outer(t, [0, 0]) * true + [0, phase * LAMBDA / 2])
    signal = np.exp(1j * phases).sum(axis=1) * np.hanning(512)
    v = np.arange(-1, 5, CELL_V / 4)
    power = np.abs(np.exp(-4j * np.pi / LAMBDA * np.outer(v, t)) @ signal)
    peaks = np.flatnonzero((power[1:-1] > power[:-2]) & (power[1:-1] > power[2:])) + 1
    two = np.sort(v[peaks[np.argsort(power[peaks])[-2:]]])
    assert np.abs(two - true).max() < CELL_V
    # The map's grid is four times as coarse; both are wrong by less than a cell.
    assert found.gate_error(apart, phase) == pytest.approx(np.abs(two - true).max() / CELL_V, abs=1)
    nearest = np.abs(np.round(true / CELL_V) - true / CELL_V).max()
    assert found.gate_error(apart, phase) == pytest.approx(nearest, abs=0.02)


@pytest.mark.parametrize(("chirps", "speed"), list(product((341, 512, 1024), (13.9, 55.6, 83.4))))
def test_a_fast_car_is_folded_by_the_rate_of_the_chirps(chirps, speed):
    """The Doppler tone is sampled once a chirp: a shift beyond half of that rate turns over."""
    shift, rate = 2 * speed / LAMBDA, chirps / T
    turned = np.round(shift / rate)  # whole turns of the phase between two chirps
    assert found.folds(chirps, speed) == turned


@pytest.mark.parametrize(("body", "level"), [(1.25, 6), (0.8, 15)])
def test_shapes_by_direct_sums(body, level):
    """Maps as sums over reflection points of range and Doppler responses of the window.

    At these levels no cell is within a rounding of the edge, so that the counts are equal.
    """
    n, m = np.arange(256), np.arange(512)
    cars = [(20 + (r - 20) * body, 10 / 3.6) for r in np.linspace(18, 22, 5)]
    walkers = [(12.0, v * body) for v in (-1.5, -0.7, 0.2, 0.8, 1.5)]
    counts = []
    for case in (cars, walkers):
        total = 0
        for r, v in case:
            tones = [np.hanning(256) * np.exp(2j * np.pi * 2 * B / C * r * n / 256),
                     np.hanning(512) * np.exp(4j * np.pi / LAMBDA * v * T / 512 * m)]  # fmt: skip
            fast, slow = (
                np.exp(-2j * np.pi * np.outer(k, i) / len(i)) @ one
                for k, i, one in ((np.arange(30), n, tones[0]), (np.arange(-40, 41), m, tones[1]))
            )
            total = total + np.exp(4j * np.pi * F0 / C * r) * np.outer(slow, fast)
        strong = np.abs(total) >= np.abs(total).max() * 10 ** (-level / 20)
        counts.append(strong.any(axis=0).sum() / strong.any(axis=1).sum())
    one = found.shapes(body, level)
    assert one["profile-car"] == pytest.approx(counts[0])
    assert one["profile-pedestrian"] == pytest.approx(counts[1])


def test_resolutions_compared_by_hand():
    """0.164 m/s beside 1 m; in km/h; and 5.9 % of 10 km/h beside 1 m of the range."""
    assert linear.accuracies("m/s with m", 5) == pytest.approx(CELL_V)
    assert linear.accuracies("km/h with m", 5) == pytest.approx(3.6 * CELL_V)
    for far in (5, 20, 58):
        by_hand = (CELL_V / (10 / 3.6)) * far
        assert linear.accuracies("relative to speed and range", far) == pytest.approx(by_hand)
    assert paper.reported().scenario.polar.v_min == pytest.approx(CELL_V, rel=3e-3)
