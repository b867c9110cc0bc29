"""From IQ to a position: what each switch of the chain does, derived and then seen.

Seeds were written down once and are not chosen.
"""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.stats import binom, chi2

from dopplerlib import crlb, doppler_shift
from dopplerlib.systems import mittermaier2016 as paper
from dopplerlib.systems.mittermaier2016._hypotheses import quarters

S = paper.scenario()
SPEED = np.linalg.norm(S.x0[3:])
RUNS = 60


def states(time):
    x = np.tile(S.x0, (len(time), 1))
    x[:, :3] += time[:, None] * S.x0[3:]
    return x


@pytest.fixture(scope="module")
def iq():
    return paper.received(RUNS, rng=np.random.default_rng(71))


@pytest.fixture(scope="module")
def clean():
    return paper.received(1, rng=np.random.default_rng(72), snr_db=None, faults=False)


@pytest.fixture(scope="module")
def found(iq):
    return paper.track_iq(iq)


def test_a_run_is_the_same_in_any_number_of_runs(iq):
    few = paper.received(2, rng=np.random.default_rng(71))
    assert_array_equal(few.x, iq.x[:2])


def test_a_track_is_the_same_in_any_number_of_runs(iq, found):
    """Peaks are found to a micro-Hertz, which depends on the largest sample: 1e-7 m is rounding."""
    few = paper.track_iq(replace(iq, x=iq.x[3:5]))
    for name in ("shift", "shift_std", "x", "P", "nis", "score"):
        a, b = getattr(few, name), getattr(found, name)[3:5]
        assert_allclose(a, b, rtol=1e-5, atol=1e-7, err_msg=name)


def test_the_samples_begin_when_the_filter_is_full_and_show_the_delayed_echo(clean):
    """Without noise and faults a sample is the echo of a moment one group delay before."""
    t = clean.first + np.arange(clean.x.shape[-1]) / clean.fs
    assert clean.first == pytest.approx(2 * clean.delay)
    path = S.x0[:3] + (t - clean.delay)[:, None] * S.x0[3:]
    r = np.linalg.norm(path[:, None] - S.array.positions, axis=-1)
    wave = np.exp(-4j * np.pi * r.T / S.array.wavelength)
    product = clean.x[0] * wave.conj()
    # The phase at the start is free; the passband is flat to 1 %, and 5 ms of the filter blur the
    # chirp of 300 Hz/s by far less.
    off = product / product.mean(axis=-1, keepdims=True) - 1
    assert np.abs(off).max() < 0.02
    late = np.exp(-4j * np.pi * r.T[:, :-10] / S.array.wavelength) * clean.x[0][:, 10:].conj()
    assert np.abs(late / late.mean(axis=-1, keepdims=True) - 1).max() > 0.5


@pytest.mark.parametrize("window", [0.01, 0.025, 0.05])
def test_without_noise_the_shifts_are_those_of_the_state_at_the_stated_time(clean, window):
    """But for the curvature of the shift, f'' T^2 / 40, and what the low-pass leaves of 1 %."""
    f = paper.track_iq(clean, window=window, remove_dc=False, balance=False, start=0.4)
    expected = doppler_shift(states(f.time), S.array)
    dense = np.arange(0, 1.0005, 1e-3)
    bend = np.gradient(
        np.gradient(doppler_shift(states(dense), S.array), dense, axis=0), 1e-3, axis=0
    )
    bound = 1.05 * np.abs(bend).max() * window**2 / 40 + 0.002
    assert np.abs(f.shift[0] - expected).max() < bound


@pytest.mark.parametrize(
    ("settings", "late"),
    [
        ({"tag": "end"}, lambda iq, n: (n - 1) / 2 / iq.fs),
        ({"subtract_delay": False}, lambda iq, n: iq.delay),
        ({"tag": "end", "subtract_delay": False}, lambda iq, n: (n - 1) / 2 / iq.fs + iq.delay),
    ],
    ids=["end", "delay", "both"],
)
def test_a_wrong_time_moves_the_position_back_by_the_way_of_that_time(iq, found, settings, late):
    """A path of constant velocity, moved in time, is another one: only the labels are wrong."""
    wrong = paper.track_iq(iq, **settings)
    lag = late(iq, round(0.025 * iq.fs))
    assert_allclose(wrong.time - found.time, lag)
    here, there = (f.at(0.9)[0] for f in (found, wrong))
    assert_allclose(there[:, 3:], here[:, 3:], atol=1e-12)
    assert_allclose(there[:, :3] - here[:, :3], -lag * here[:, 3:], atol=1e-12)


def test_nis_does_not_see_a_wrong_time_and_nees_does(iq, found):
    wrong = paper.track_iq(iq, tag="end", subtract_delay=False)
    assert_array_equal(wrong.nis, found.nis)
    assert_array_equal(wrong.score, found.score)
    right, late = paper.judged(found), paper.judged(wrong)
    assert np.median(late.nees[1]) > 100 * np.median(right.nees[1])
    assert_allclose(np.median(late.error[1]), SPEED * (iq.delay + 0.01225), rtol=0.03)


def test_the_deviations_are_those_of_the_bound_at_the_noise_that_was_simulated(found):
    """20 dB at 10 kHz: 60 dB above the noise in one hertz, and sigma = sqrt(6 / (cn0 T^3)) / 2 pi.

    Early, where the shift hardly changes in a window. The mean of 720 variances with 97 degrees of
    freedom is off by 0.5 %, what is left of the faults and 0.04 % of n^2 - 1 come on top.
    """
    T = 0.025
    sigma = np.sqrt(6 / (1e6 * T**3)) / (2 * np.pi)
    measured = np.sqrt(np.mean(found.shift_std[:, :4] ** 2))
    assert measured == pytest.approx(sigma, rel=0.03)


def test_the_errors_of_the_shifts_have_these_deviations(found):
    """Chi-square of 60 runs, 4 windows and 6 modules; two-sided, false alarm 1e-6.

    Faults, measured deviations and the filter's edge may change the variance by 6 %.
    """
    error = found.shift - doppler_shift(states(found.time), S.array)
    score = np.sum((error[:, :4] / found.shift_std[:, :4]) ** 2)
    count = error[:, :4].size
    assert chi2.ppf(5e-7, count) * 0.94 < score < chi2.isf(5e-7, count) * 1.06


def test_the_noise_of_the_low_pass_is_what_its_gain_says():
    """White noise of variance 1 becomes the gain over the factor; 1.5 % is 6 deviations."""
    quiet = paper.received(30, rng=np.random.default_rng(73), snr_db=0.0, faults=False)
    loud = paper.received(30, rng=np.random.default_rng(73), snr_db=None, faults=False)
    # The same generators give the same phases, so that the difference is the noise.
    noise = np.mean(np.abs(quiet.x - loud.x) ** 2)
    assert noise == pytest.approx(quiet.noise_gain / 5, rel=0.015)
    assert 0.9 < quiet.noise_gain < 1


def test_the_covariance_of_a_start_is_the_inverse_information(found, iq):
    """The bound at the first sample, moved to the last one, from another routine."""
    T, K = 0.025, found.used
    x = found.x[0, np.argmin(found.score[0, :, 0]), 0].copy()
    sigma = np.sqrt(np.mean(found.shift_std[0, :K] ** 2))
    F = np.eye(6)
    F[:3, 3:] = (K - 1) * T * np.eye(3)
    first = np.linalg.solve(F, x)
    expected = F @ crlb(first, iq.array, sigma, K, T, "moving") @ F.T
    P = found.P[0, np.argmin(found.score[0, :, 0]), 0]
    assert_allclose(P, expected, rtol=1e-4, atol=1e-6 * np.abs(expected).max())


def test_a_whole_record_is_found_and_kept(found):
    """Each error is below 5 cm: an outright failure in 1 of 60 would show."""
    assert (paper.judged(found).error < 0.05).all()


def test_nees_of_windows_side_by_side_is_that_of_a_consistent_filter(found):
    """Half a second after the start, 60 runs: most lie below the 99 % quantile.

    If each exceeds it with probability 1 % (3 % allowed: the deviations are measured, and the
    filter is linearized), 12 of 60 do so in one set of seeds in a million.
    """
    over = np.sum(paper.judged(found).nees[0] > chi2.isf(0.01, 6))
    assert over < 12
    assert binom.sf(11, RUNS, 0.03) < 1e-6


def test_what_was_dropped_is_much_less_likely(found):
    least = found.score.min(axis=1, keepdims=True)[:, :, :1]
    kept = np.isfinite(found.score[:, :, :1])
    assert kept.any(axis=1).all()
    assert (found.score[:, :, :1][kept] - np.broadcast_to(least, kept.shape)[kept] < 30).all()


def test_carrying_hypotheses_saves_short_starts(iq):
    """100 ms decide between the twins like a coin; later shifts decide well."""
    short = paper.track_iq(iq, start=0.1)
    carried, first = (paper.judged(short, carry=carry).error[1] for carry in (True, False))
    # A third of the runs is saved; that this happens in none of 60 has a probability of 1e-11.
    assert np.mean(carried < 0.01) > np.mean(first < 0.01)


def test_a_constant_left_in_spoils_the_position(iq, found):
    left = paper.track_iq(iq, remove_dc=False, balance=False)
    assert np.median(paper.judged(left).error[0]) > 5 * np.median(paper.judged(found).error[0])


def test_inflating_changes_the_belief_and_hardly_the_estimate(iq):
    plain, wide = (paper.track_iq(iq, hop=0.0125, inflate=c) for c in (1.0, 2.0))
    assert_allclose(wide.shift_std, np.sqrt(2) * plain.shift_std)
    a, b = paper.judged(plain), paper.judged(wide)
    # Q is small, so the gain hardly notices and P doubles nearly.
    assert np.median(a.nees[0]) == pytest.approx(2 * np.median(b.nees[0]), rel=0.2)


def test_the_bound_falls_with_the_root_of_the_power_and_the_length_of_windows():
    """Deviations go with 1 / sqrt(cn0); two windows of half the length are worse than one."""
    one, ten = (paper.position_bound(0.5, 0.05, cn0) for cn0 in (1e6, 1e7))
    assert_allclose(ten, one / 10, rtol=1e-9)
    assert np.trace(paper.position_bound(0.5, 0.025, 1e6)) > np.trace(one)


def test_the_paper_s_own_shifts_leave_a_meter_after_ten_milliseconds():
    """0.4 Hz from a window of 1 ms; the bound of ten such samples is 0.96 m, by another program."""
    cn0 = 6 / ((2 * np.pi) ** 2 * S.sigma_f**2 * S.T**3)
    P = paper.position_bound(0.01, S.T, cn0)
    assert np.sqrt(np.trace(P)) == pytest.approx(0.96, rel=0.02)


def test_tracks_are_not_better_than_the_bound(found):
    """A hundredth of the runs may be; mean squares of 60 runs with about 2 dominant directions.

    The sum of squares over the bound is at least chi-square of 60 in one direction.
    """
    P = paper.position_bound(0.5, 0.025, 1e6, first=0.005)
    ratio = np.mean(paper.judged(found).error[0] ** 2) / np.trace(P)
    assert ratio > chi2.ppf(1e-6, RUNS) / RUNS


def test_the_search_of_quarters_covers_the_room():
    lower, upper = paper.start_box()
    boxes = quarters(lower, upper)
    volume = sum(np.prod(high - low) for low, high in boxes)
    assert volume == pytest.approx(np.prod(upper - lower))
    assert len({(low[1] == 0, low[2] == 0) for low, _ in boxes}) == 4


def test_what_makes_no_sense_is_refused_by_name(iq, found):
    for settings, message in [
        ({"tag": "start"}, "tag must be one of"),
        ({"start": 0.03}, "start must hold at least two windows"),
        ({"inflate": 0}, "inflate must be positive"),
        ({"search": "half"}, "search must be one of"),
        ({"window": -1}, "window must be positive"),
    ]:
        with pytest.raises(ValueError, match=message):
            paper.track_iq(iq, **settings)
    with pytest.raises(ValueError, match="moment must not be before"):
        found.at(0.1)
    with pytest.raises(ValueError, match="iq must be a Baseband"):
        paper.track_iq(iq.x)
