"""From IQ to a position: what each switch of the chain does, derived and then seen.

Seeds were written down once and are not chosen.
"""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.stats import chi2

from dopplerlib import crlb, doppler_shift
from dopplerlib.chain.simulation import simulate_baseband
from dopplerlib.estimation.initial_estimate import ImplausibleStart
from dopplerlib.signal.frequency import ml_frequency_dc
from dopplerlib.signal.laws import overlap_correlation
from dopplerlib.systems import mittermaier2016 as paper

S = paper.reported().scenario
SPEED = np.linalg.norm(S.x0[3:])
RUNS = 60


def states(time):
    x = np.tile(S.x0, (len(time), 1))
    x[:, :3] += time[:, None] * S.x0[3:]
    return x


@pytest.fixture(scope="module")
def iq():
    return simulate_baseband(paper.reported().scenario, RUNS, rng=np.random.default_rng(71))


@pytest.fixture
def few(iq):
    return replace(iq, x=iq.x[:4])


@pytest.fixture(scope="module")
def clean():
    return simulate_baseband(
        paper.reported().scenario, 1, rng=np.random.default_rng(72), snr_db=None, faults=False
    )


@pytest.fixture(scope="module")
def found(iq):
    return paper.track_iq(iq)


def test_a_track_is_the_same_in_any_number_of_runs(iq, found):
    """Peaks are found to a micro-Hertz, which depends on the largest sample: 1e-7 m is rounding."""
    few = paper.track_iq(replace(iq, x=iq.x[3:5]))
    for name in ("shift", "shift_std", "x", "P", "nis", "score"):
        a, b = getattr(few, name), getattr(found, name)[3:5]
        assert_allclose(a, b, rtol=1e-5, atol=1e-7, err_msg=name)


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
        ({"timestamp": "end"}, lambda iq, n: (n - 1) / 2 / iq.fs),
        ({"subtract_delay": False}, lambda iq, n: iq.delay),
        (
            {"timestamp": "end", "subtract_delay": False},
            lambda iq, n: (n - 1) / 2 / iq.fs + iq.delay,
        ),
    ],
    ids=["end", "delay", "both"],
)
def test_a_wrong_time_moves_the_position_back_by_the_way_of_that_time(few, settings, late):
    """A path of constant velocity, moved in time, is another one: only the labels are wrong."""
    right, wrong = paper.track_iq(few), paper.track_iq(few, **settings)
    lag = late(few, round(0.025 * few.fs))
    assert_allclose(wrong.time - right.time, lag)
    here, there = (f.at(0.9)[0] for f in (right, wrong))
    assert_allclose(there[:, 3:], here[:, 3:], atol=1e-12)
    assert_allclose(there[:, :3] - here[:, :3], -lag * here[:, 3:], atol=1e-12)


def test_nis_does_not_see_a_wrong_time_and_nees_does(iq, found):
    wrong = paper.track_iq(iq, timestamp="end", subtract_delay=False)
    assert_array_equal(wrong.nis, found.nis)
    assert_array_equal(wrong.score, found.score)
    right, late = paper.track_errors(found), paper.track_errors(wrong)
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


def test_the_covariance_of_a_start_is_the_inverse_information(found, iq):
    """The bound at the first sample, moved to the last one, from another routine."""
    T, K = 0.025, found.used
    x = found.x[0, np.argmin(found.score[0, :, 0]), 0].copy()
    sigma = np.sqrt(np.mean(found.shift_std[0, :K] ** 2))
    F = np.eye(6)
    F[:3, 3:] = (K - 1) * T * np.eye(3)
    first = np.linalg.solve(F, x)
    expected = F @ crlb(first, iq.array, sigma, K, T, "constant_velocity") @ F.T
    P = found.P[0, np.argmin(found.score[0, :, 0]), 0]
    assert_allclose(P, expected, rtol=1e-4, atol=1e-6 * np.abs(expected).max())


def test_a_whole_record_is_found_and_kept(found):
    """Each error is below 5 cm: an outright failure in 1 of 60 would show."""
    assert (paper.track_errors(found).error < 0.05).all()


def test_the_final_range_is_known_to_less_than_a_centimeter(found):
    """In every run, and by the median twenty times better."""
    x = np.abs(found.at(1.0)[0][:, 0] - (S.x0[0] + S.x0[3]))
    assert (x < 0.01).all()
    assert np.median(x) < 0.0005


def test_nees_of_windows_side_by_side_is_that_of_a_consistent_filter(found):
    """Neither half nor twice of six, half a second after the start.

    The mean of 60 chi-squares with 6 degrees of freedom has a deviation of 0.45; the deviations are
    measured and the filter is linearized, so twice the tail is allowed: a false alarm of 1e-5.
    """
    assert 4 < paper.track_errors(found).nees[0].mean() < 10


def test_nis_is_low_for_two_reasons(iq, found):
    """An acceleration that never comes takes about one of six; wide bars at the end take the rest.

    Before 0.7 s the bars are right: squares of the true errors over them average six. The mean over
    60 runs of 16 windows has a deviation of 0.11, and the two are paired.
    """
    calm = paper.track_iq(iq, sigma_a=S.sigma_a / 100)
    squared = (found.shift - doppler_shift(states(found.time), S.array)) / found.shift_std
    squared = np.sum(squared**2, axis=-1)[:, found.used :]
    early = found.time[found.used :] < 0.7
    parts = (squared, found.final_nis, calm.final_nis)
    real, nis, without = (values[:, early].mean() for values in parts)
    assert real == pytest.approx(6, abs=0.6)
    assert nis < real - 0.5
    assert without == pytest.approx(real, abs=0.5)
    assert squared[:, ~early].mean() < real - 0.5


def test_carrying_hypotheses_saves_short_starts(iq):
    """100 ms decide between the twins like a coin; later shifts decide well."""
    short = paper.track_iq(iq, start=0.1)
    carried, first = (paper.track_errors(short, carry=carry).error[1] for carry in (True, False))
    # A third of the runs is saved; that this happens in none of 60 has a probability of 1e-11.
    assert np.mean(carried < 0.01) > np.mean(first < 0.01)


def test_a_constant_left_in_spoils_the_position(iq, found):
    left = paper.track_iq(iq, remove_dc=False, balance=False)
    assert np.median(paper.track_errors(left).error[0]) > 5 * np.median(
        paper.track_errors(found).error[0]
    )


def test_inflating_changes_the_belief_and_hardly_the_estimate(iq):
    few = replace(iq, x=iq.x[:30])
    plain, wide = (paper.track_iq(few, hop=0.0125, variance_inflation=c) for c in (1.0, 2.0))
    assert_allclose(wide.shift_std, np.sqrt(2) * plain.shift_std)
    a, b = paper.track_errors(plain), paper.track_errors(wide)
    # Q is small, so the gain hardly notices and P doubles nearly.
    assert np.median(a.nees[0]) == pytest.approx(2 * np.median(b.nees[0]), rel=0.2)


def test_tracks_are_not_better_than_the_bound(found):
    """A hundredth of the runs may be; mean squares of 60 runs with about 2 dominant directions.

    The sum of squares over the bound is at least chi-square of 60 in one direction.
    """
    P = paper.position_bound(0.5, 0.025, 1e6, first=0.005)
    ratio = np.mean(paper.track_errors(found).error[0] ** 2) / np.trace(P)
    assert ratio > chi2.ppf(1e-6, RUNS) / RUNS


def test_the_innovations_of_overlapping_windows_remember_and_nis_does_not_notice(iq, found):
    """The errors of the shifts do, and innovations are little else. 0.1 is five deviations."""
    few = replace(iq, x=iq.x[:20])
    overlap = paper.track_iq(few, hop=0.0025)
    half = paper.track_iq(few, hop=0.0125)
    apart, close, middle = (
        paper.track_errors(t).lag1_autocorrelation.mean() for t in (found, overlap, half)
    )
    # The law of overlap says 0.70 at a tenth of the window and -0.25 at half of it.
    assert abs(apart) < 0.1
    assert close == pytest.approx(overlap_correlation(0.1), abs=0.1)
    assert middle == pytest.approx(overlap_correlation(0.5), abs=0.1)
    nis = [paper.track_errors(t).nis.mean() for t in (found, overlap)]
    assert nis[1] == pytest.approx(nis[0], rel=0.1)


def test_a_weaker_passband_means_wider_deviations(iq, found):
    """Half the noise at the new rate for the same density: the true density is twice as high."""
    few = replace(iq, x=iq.x[:2])
    half = paper.track_iq(replace(few, noise_gain=iq.noise_gain / 2))
    assert_allclose(half.shift_std, np.sqrt(2) * found.shift_std[:2], rtol=1e-5)


@pytest.fixture(scope="module")
def undisturbed():
    return simulate_baseband(
        paper.reported().scenario, 6, rng=np.random.default_rng(76), faults=False
    )


RAW = {"remove_dc": False, "balance": False}


def test_what_is_known_at_a_moment_does_not_depend_on_what_comes_later(undisturbed):
    """The records go on as those of other targets; with short starts the choice then changes."""
    iq = undisturbed
    k = round((0.5 - iq.first) * iq.fs) + 1
    later = np.concatenate([iq.x[..., :k], iq.x[:, ::-1, k:].conj()], axis=-1)
    real, other = (paper.track_iq(replace(iq, x=x), start=0.1, **RAW) for x in (iq.x, later))
    for one, two in zip(real.at(0.5), other.at(0.5), strict=True):
        assert_allclose(one, two, rtol=1e-6, atol=1e-9)
    last = len(real.time) - real.used
    assert not np.allclose(real.x[:, :, last], other.x[:, :, last], equal_nan=True)


def test_a_target_that_is_no_longer_heard_is_lost_as_fast_whatever_the_hop(undisturbed):
    """The acceleration lets each velocity wander by sigma_a sqrt(T t), T a millisecond."""
    x = undisturbed.x.copy()
    x[..., round((0.4 - undisturbed.first) * undisturbed.fs) :] = 0
    for hop in (0.025, 0.001):
        f = paper.track_iq(replace(undisturbed, x=x), hop=hop, **RAW)
        gone = np.isnan(f.shift).all(axis=(0, 2))[f.used :]
        k = int(np.argmax(gone))
        assert gone[k:].all()
        best = np.argmin(f.score[:, :, 0], axis=1)
        P = f.P[np.arange(len(best)), best, k:]
        grown = np.diagonal(P[:, -1] - P[:, 0], axis1=-2, axis2=-1)[:, 3:]
        time = f.time[-1] - f.time[f.used + k - 1]
        assert_allclose(grown, S.sigma_a**2 * S.T * time, rtol=1e-6)


@pytest.mark.parametrize("fault", ["silent", "constant", "noise"])
def test_five_good_modules_and_a_dead_one_still_track(iq, fault):
    """Five of six shifts: the bound on the position grows by less than a half."""
    x = iq.x[:10].copy()
    noise = np.random.default_rng(77).standard_normal((2, *x[:, 0].shape))
    x[:, 2] = {"silent": 0.0, "constant": 0.3 + 0.1j, "noise": noise[0] + 1j * noise[1]}[fault]
    f = paper.track_iq(replace(iq, x=x))
    assert np.isnan(f.shift[:, :, 2]).all()
    assert np.isfinite(np.delete(f.shift, 2, axis=2)).all()
    # All 10 below 3 cm: the full array has a median of 7 mm there.
    assert (paper.track_errors(f).error[0] < 0.03).all()


def test_without_any_echo_nothing_is_claimed(undisturbed):
    f = paper.track_iq(replace(undisturbed, x=0 * undisturbed.x), **RAW)
    assert np.isnan(f.shift).all()
    assert np.isinf(f.score).all()
    assert np.isnan(f.at(0.5)[0]).all()


def test_the_joint_estimator_does_what_the_removal_of_a_known_constant_does(iq, found):
    """A constant left in beside an image: with it the median is that of the image alone."""
    few = replace(iq, x=iq.x[:20])
    joint = paper.track_iq(few, estimator=ml_frequency_dc, **RAW)
    image = paper.track_iq(few, balance=False)
    spoiled = paper.track_iq(few, **RAW)
    joint, image, spoiled = (
        np.median(paper.track_errors(f).error[0]) for f in (joint, image, spoiled)
    )
    assert joint < spoiled / 5
    assert joint < 3 * image


def test_the_mean_of_an_echo_that_grows_is_not_the_constant():
    """Its end is a thousand times as strong in power; until 0.3 s it hardly grows."""
    iq = simulate_baseband(
        paper.reported().scenario, 15, rng=np.random.default_rng(78), amplitude="r^-2"
    )
    whole, early = (
        np.median(paper.track_errors(paper.track_iq(iq, dc_until=until)).error[0])
        for until in (None, 0.3)
    )
    assert early < whole / 2


def test_the_shifts_of_an_echo_that_grows_become_better():
    """True errors and measured deviations of short windows fall as the fourth power of the range.

    15 runs, 6 modules and 10 windows: a ratio of two variances is good to 7 %. Later on the echo
    grows inside a window, so that the shift is that of a later moment than its middle.
    """
    settings = {"amplitude": "r^-2", "faults": False}
    iq = simulate_baseband(paper.reported().scenario, 15, rng=np.random.default_rng(79), **settings)
    f = paper.track_iq(iq, window=0.01, **RAW)
    error = f.shift - doppler_shift(states(f.time), S.array)
    r = np.linalg.norm(states(f.time)[:, None, :3] - S.array.positions, axis=-1)
    early, later = f.time < 0.11, (f.time > 0.35) & (f.time < 0.45)
    expected = np.mean(r[early] ** 4) / np.mean(r[later] ** 4)
    assert expected > 2 * 2  # a constant R would have 1, and the claim asks for less than 2
    for of_one in (error, f.shift_std):
        variances = [np.mean(of_one[:, part] ** 2) for part in (early, later)]
        assert variances[0] / variances[1] == pytest.approx(expected, rel=0.35)


def test_what_makes_no_sense_is_refused_by_name(iq, found):
    for settings, message in [
        ({"timestamp": "start"}, "timestamp must be one of"),
        ({"start": 0.03}, "start must hold at least two windows"),
        ({"variance_inflation": 0}, "variance_inflation must be positive"),
        ({"search": "half"}, "search must be one of"),
        ({"window": -1}, "window must be positive"),
        ({"sigma_a": 0}, "sigma_a must be positive"),
        ({"dc_until": 2.0}, "dc_until must be within the record"),
    ]:
        with pytest.raises(ValueError, match=message):
            paper.track_iq(iq, **settings)
    with pytest.raises(ValueError, match="time must not be before"):
        found.at(0.1)
    with pytest.raises(ValueError, match="iq must be a Baseband"):
        paper.track_iq(iq.x)


@pytest.mark.parametrize("wrong", ["I and Q", "sensors"])
def test_exchanged_branches_or_sensors_are_warned_of(wrong):
    iq = simulate_baseband(
        paper.reported().scenario, 2, rng=np.random.default_rng(5), fs=2000.0, snr_db=30.0, factor=1
    )
    x = iq.x.imag + 1j * iq.x.real if wrong == "I and Q" else iq.x[:, [3, 1, 2, 0, 4, 5]]
    with pytest.warns(ImplausibleStart, match=r"of run 0: chi-square \d+ for \d+ degrees"):
        paper.track_iq(replace(iq, x=x))
