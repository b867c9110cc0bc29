"""Tests of consistency of records with gaps: they count what is there, and only that.

Where a test is about random numbers, it holds for all but the stated share of seeds. The seeds were
written down once and are not chosen.
"""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import binom, chi2, kstest

from dopplerlib import Track, innovation_mean, innovation_whiteness, kf, nees, nis
from dopplerlib.evaluation.alarms import first_alarm, innovation_alarms
from dopplerlib.evaluation.averages import nees_samples
from dopplerlib.evaluation.power import TESTS, rejections

FALSE_ALARM = 1e-6
RUNS, SAMPLES = 400, 120
F, Q = np.array([[1, 0.1], [0, 1]]), np.array([[1e-3, 1e-3], [1e-3, 2e-3]])
H = np.array([[1.0, 0.0], [1.0, 0.5], [0.2, 1.0]])
R = np.array([[0.25, 0.1, 0], [0.1, 0.3, 0], [0, 0, 0.2]])
P0 = np.diag([1.0, 0.5])


def gaps(rng):
    """Return where nothing was measured: bursts, single samples, one sensor out for half a run."""
    lost = rng.uniform(size=(RUNS, SAMPLES, 3)) < 0.2
    lost[:, 40:50] = True
    lost[: RUNS // 2, 60:, 1] = True
    lost[::4, :, 2] = True  # this sensor was never there
    return lost


@pytest.fixture(scope="module")
def world():
    """Return truth and the track of a right linear filter whose record has gaps."""
    rng = np.random.default_rng(41)
    x = rng.multivariate_normal([0, 0], P0, RUNS)
    truth = np.empty((RUNS, SAMPLES, 2))
    for k in range(SAMPLES):
        x = x @ F.T + rng.multivariate_normal([0, 0], Q, RUNS)
        truth[:, k] = x
    z = truth @ H.T + rng.multivariate_normal(np.zeros(3), R, (RUNS, SAMPLES))
    z[gaps(rng)] = np.nan
    return truth, kf(z, F, Q, H, R, [0, 0], P0)


def fair(count, trials, probability):
    """Return whether a number of events has at least the probability FALSE_ALARM, on each side."""
    law = binom(trials, probability)
    return law.ppf(FALSE_ALARM / 2) <= count <= law.isf(FALSE_ALARM / 2)


def test_nis_of_what_is_there_is_chi_square_with_as_many_degrees_of_freedom(world):
    track = world[1]
    value, there = nis(track.innovation, track.S), ~np.isnan(track.innovation)
    count = there.sum(axis=-1)
    np.testing.assert_array_equal(np.isnan(value), count == 0)
    np.testing.assert_allclose(value, track.nis, rtol=1e-9)
    assert kstest(chi2.cdf(value[count > 0], count[count > 0]), "uniform").pvalue > FALSE_ALARM


def test_the_mean_over_what_is_there_spreads_as_its_standard_error_says(world):
    track = world[1]
    mean, error = innovation_mean(track.innovation, track.S)
    never = np.isnan(track.innovation).all(axis=-2)
    np.testing.assert_array_equal(np.isnan(mean), never)
    np.testing.assert_array_equal(np.isnan(error), never)
    np.testing.assert_allclose(mean, _mean(track.innovation), rtol=1e-12)
    for component in range(3):
        known = ~never[:, component]
        score = (mean / error)[known, component]
        assert kstest(score, "norm").pvalue > FALSE_ALARM


def _mean(innovation):
    there = ~np.isnan(innovation)
    with np.errstate(invalid="ignore"):
        return np.nansum(innovation, axis=-2) / there.sum(axis=-2)


@pytest.mark.parametrize("lags", [1, 5])
def test_p_values_of_a_white_record_with_gaps_are_uniform(world, lags):
    track = world[1]
    result = innovation_whiteness(track.innovation, track.S, lags)
    assert result.dof.tolist() == [(2 if run % 4 == 0 else 3) * lags for run in range(RUNS)]
    assert kstest(result.p_value, "uniform").pvalue > FALSE_ALARM


def test_memory_is_found_through_gaps():
    """Neighbors correlated by 0.5: 60 pairs of 120 raise the statistic by about 15 from 1."""
    rng = np.random.default_rng(42)
    x = rng.standard_normal((300, 121, 1))
    x = (x[:, 1:] + x[:, :-1]) / np.sqrt(2)
    x[rng.uniform(size=x.shape) < 0.3] = np.nan
    result = innovation_whiteness(x, np.ones((120, 1, 1)), lags=1)
    assert (result.p_value < 0.01).mean() > 0.8
    # The estimate is that of the pairs there; its bias is some 1/60.
    assert result.autocorrelation.mean() == pytest.approx(0.5, abs=0.04)


def test_products_are_those_of_pairs_that_are_there():
    """Recomputed term by term from the definition."""
    x = np.array([0.5, np.nan, -1.0, 2.0, 0.3, np.nan, np.nan, 0.7, -0.4, 1.1])
    result = innovation_whiteness(x[:, None], np.ones((10, 1, 1)), lags=3)
    there = [value for value in x if value == value]
    n, mean = len(there), sum(there) / len(there)
    square = sum((value - mean) ** 2 for value in there)
    statistic, dof = 0.0, 0
    for lag in (1, 2, 3):
        pairs = [
            (a - mean) * (b - mean) for a, b in zip(x, x[lag:], strict=False) if a * b == a * b
        ]
        r = sum(pairs) / square
        statistic += n * (n + 2) * r**2 / len(pairs)
        dof += 1
        expected = sum(pairs) / len(pairs) / (square / n) * (10 - lag) / 10
        assert result.autocorrelation[lag - 1, 0] == pytest.approx(expected, rel=1e-12)
    assert result.statistic == pytest.approx(statistic, rel=1e-12)
    assert result.dof == dof


def test_a_sensor_that_is_never_there_might_as_well_not_exist(world):
    track = world[1]
    three, S = track.innovation[::4], track.S[::4]
    two, S2 = three[..., :2], S[..., :2, :2]
    spoiled = np.array(S)
    spoiled[..., 2, :] = spoiled[..., :, 2] = np.nan  # it does not matter what S says of it
    for got in (S, spoiled):
        np.testing.assert_allclose(nis(three, got), nis(two, S2), rtol=1e-12)
        a, b = innovation_whiteness(three, got, 5), innovation_whiteness(two, S2, 5)
        np.testing.assert_allclose(a.statistic, b.statistic, rtol=1e-12)
        assert (a.dof == b.dof).all()
        for one, other in zip(innovation_mean(three, got), innovation_mean(two, S2), strict=True):
            np.testing.assert_allclose(one[..., :2], other, rtol=1e-12)
        looks = [20, 60, 120]
        a = innovation_alarms(replace(track, innovation=three, S=got), looks, 0.2)
        b = innovation_alarms(replace(track, innovation=two, S=S2), looks, 0.2)
        assert all((a[name] == b[name]).all() for name in a)


@pytest.mark.parametrize("look", [30, 55, 120])
def test_a_right_filter_raises_as_many_alarms_as_promised(world, look):
    for name, alarms in innovation_alarms(world[1], [look], probability=0.1, lags=2).items():
        if name != "whiteness" or look > 30:
            assert fair(alarms.sum(), RUNS, 0.1), name


def test_before_the_first_measurement_there_is_no_alarm_and_then_there_is():
    innovation = np.full((50, 2), np.nan)
    innovation[20:, 0] = 30.0 + np.arange(30)
    S = np.tile(np.eye(2), (50, 1, 1))
    track = Track(None, None, innovation, S, None, None)
    alarms = innovation_alarms(track, (look for look in (10, 20, 21, 50)))
    assert alarms["NIS average"].tolist() == [False, False, True, True]
    assert first_alarm(alarms["NIS average"], iter((10, 20, 21, 50))) == 21


def test_one_record_is_a_batch_of_one(world):
    track = world[1]
    one = Track(None, None, track.innovation[3], track.S[3], None, None)
    for name, alarms in innovation_alarms(track, [60, 120]).items():
        np.testing.assert_array_equal(innovation_alarms(one, [60, 120])[name], alarms[3])


def test_each_test_refuses_a_right_filter_as_often_as_it_says(world):
    truth, track = world
    results = rejections(track, truth, F, Q, confidence=0.9, lags=5, group=2)
    for name in TESTS:
        # The test of the mean is a little cautious: components of a sample are correlated.
        refused = results[name]
        assert refused.shape == ((RUNS // 2,) if name == TESTS[-1] else (RUNS,))
        if name == "innovation mean":
            assert refused.sum() <= binom(RUNS, 0.1).isf(FALSE_ALARM)
        else:
            assert fair(refused.sum(), len(refused), 0.1), name


def test_a_single_record_is_refused_as_in_its_batch(world):
    truth, track = world
    many = rejections(track, truth, F, Q, lags=5, group=1)
    fields = {name: getattr(track, name)[7] for name in ("x", "P", "innovation", "S", "nis")}
    one = rejections(Track(**fields, updated=None), truth[7], F, Q, lags=5, group=1)
    for name in TESTS:
        assert one[name].size == 1
        assert one[name].ravel()[0] == many[name][7]


@pytest.mark.parametrize("function", [innovation_alarms, rejections])
def test_a_record_without_any_measurement_is_refused(world, function):
    truth, track = world
    innovation = np.array(track.innovation)
    innovation[5] = np.nan
    nothing = replace(track, innovation=innovation)
    arguments = ([120],) if function is innovation_alarms else (truth, F, Q)
    with pytest.raises(ValueError, match=r"track\.innovation must hold a value in each record"):
        function(nothing, *arguments)


def plane(world):
    """Return a track with a component more that is known, and its truth."""
    truth, track = world
    x, true = (np.concatenate([v, 0.3 + 0 * v[..., :1]], axis=-1) for v in (track.x, truth))
    P = np.zeros((*track.P.shape[:2], 3, 3))
    P[..., :2, :2] = track.P
    return replace(track, x=x, P=P), true


def test_a_component_that_is_known_takes_no_part_in_nees(world):
    estimate, true = plane(world)
    np.testing.assert_allclose(nees(estimate, true), nees(world[1], world[0]), rtol=1e-10)
    F3, Q3 = np.eye(3), np.zeros((3, 3))
    F3[:2, :2], Q3[:2, :2] = F, Q
    worth = nees_samples(estimate.P[0], F3, Q3)
    assert worth == pytest.approx(nees_samples(world[1].P[0], F, Q), rel=1e-12)
    few = slice(0, 20)
    fields = {n: getattr(estimate, n)[few] for n in ("x", "P", "innovation", "S", "nis")}
    with_plane = rejections(Track(**fields, updated=None), true[few], F3, Q3, lags=5, group=2)
    fields = {n: getattr(world[1], n)[few] for n in ("x", "P", "innovation", "S", "nis")}
    without = rejections(Track(**fields, updated=None), world[0][few], F, Q, lags=5, group=2)
    for name in TESTS:
        np.testing.assert_array_equal(with_plane[name], without[name])


def test_nees_of_a_direction_without_spread_is_that_of_the_others():
    """Two components that move together only: one degree of freedom, whatever the units."""
    P = np.array([[[4.0, 2e-6], [2e-6, 1e-12]]])
    estimate = Track(np.array([[2.0, 1e-6]]), P, None, None, None, None)
    assert nees(estimate, np.zeros((1, 2))) == pytest.approx([1.0], rel=1e-9)
    with pytest.raises(ValueError, match=r"track\.P must be positive definite, or the estimate"):
        nees(replace(estimate, x=np.array([[2.0, 1.1e-6]])), np.zeros((1, 2)))


def test_a_wrong_value_of_a_known_component_is_refused(world):
    estimate, true = plane(world)
    with pytest.raises(ValueError, match=r"track\.P must .*singular matrix and errors of up to"):
        nees(estimate, true + np.array([0, 0, 1e-3]))


def test_steps_of_each_sample_serve_uneven_times(world):
    P = world[1].P[1]
    same = nees_samples(P, np.tile(F, (SAMPLES, 1, 1)), np.tile(Q, (SAMPLES, 1, 1)))
    assert same == pytest.approx(nees_samples(P, F, Q), rel=1e-12)
    # A gap is a longer step: without the samples of the burst, the others are worth the same.
    value = nees_samples(*_filtered(np.arange(30)))
    assert value == pytest.approx(_by_covariance(*_filtered(np.arange(30))), rel=1e-9)
    kept = np.r_[0:10, 20:30]
    assert nees_samples(*_filtered(kept)) == pytest.approx(
        _by_covariance(*_filtered(kept)), rel=1e-9
    )


def _filtered(k):
    """Return P, F, Q of a filter that measures at the samples `k` only."""
    steps = np.diff(k, prepend=k[0] - 1)
    Fs = np.stack([np.linalg.matrix_power(F, n) for n in steps])
    Qs = np.stack(
        [sum(np.linalg.matrix_power(F, i) @ Q @ np.linalg.matrix_power(F, i).T for i in range(n))
         for n in steps]
    )  # fmt: skip
    P, out = P0, []
    for F1, Q1 in zip(Fs, Qs, strict=True):
        P = F1 @ P @ F1.T + Q1
        P = np.linalg.inv(np.linalg.inv(P) + H.T @ np.linalg.inv(R) @ H)
        out.append((P + P.T) / 2)
    return np.array(out), Fs, Qs


def _by_covariance(P, Fs, Qs):
    """Return 2 n over the variance of the average of NEES, from the joint covariance of errors."""
    K, n = P.shape[:2]
    total = 0.0
    for j in range(K):
        cross = P[j]  # covariance of the errors at k and j
        total += 2 * n
        for k in range(j + 1, K):
            gain = P[k] @ np.linalg.inv(Fs[k] @ P[k - 1] @ Fs[k].T + Qs[k])
            cross = gain @ Fs[k] @ cross
            form = np.linalg.inv(P[k]) @ cross @ np.linalg.inv(P[j]) @ cross.T
            total += 2 * 2 * np.trace(form)
    return 2 * n * K**2 / total
