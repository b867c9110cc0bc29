"""The rebuilt system against other implementations, closed forms, and what it must not depend on.

Where a test is about random numbers, it holds for all but the stated share of seeds. The seeds were
written down once and are not chosen.
"""

import numba
import numpy as np
import pytest
from scipy.stats import norm

from dopplerlib import kf_predict, kf_update
from dopplerlib.evaluation.intervals import mean_interval
from dopplerlib.signal.interpolation import parabolic, parabolic_three_highest
from dopplerlib.signal.laws import overlap_correlation_discrete
from dopplerlib.signal.synthesis import iq_from_velocity, tone
from dopplerlib.systems import valarmathi as system
from dopplerlib.systems.valarmathi import _pair_kernel, _sliding_kernel
from dopplerlib.systems.valarmathi._pair_kernel import choose
from dopplerlib.tracking.fusion import cross_covariance_step, fuse_state_vectors

T, OWN = system.reported().stated.T, system.reported().chosen
FALSE_ALARM = 1e-6
Z = norm.isf(FALSE_ALARM / 2)
TABLE = system.WindowTable(
    np.array([0.0, 10.0, 40.0]),
    np.array([0.0, 20.0, 40.0]),
    np.array([8, 12, 20, 32, 48, 64, 96]),
    # The best: 96, 48 and 20 samples at 0 dB, 96, 32 and 12 at 20 dB, 96, 12 and 8 at 40 dB.
    -np.eye(7)[[[6, 6, 6], [4, 3, 1], [2, 1, 0]]],
)


@pytest.fixture(scope="module")
def runs():
    return system.run_algorithms("path 2", 15.0, 3, TABLE, rng=np.random.default_rng(1))


def test_the_numbers_of_the_document_agree_but_for_its_acceleration():
    said = system.reported().stated
    assert said.T * said.samples == pytest.approx(said.duration)
    rate = (said.v_before - said.v_after) / said.maneuver
    assert abs(rate - said.acceleration) > 0.05  # it prints two digits after the point


def test_the_paths_go_down_and_up_again_on_one_timeline():
    fast, gentle = system.velocity_path("path 2"), system.velocity_path("path 1")
    said = system.reported().stated
    assert fast.v.min() == pytest.approx(said.v_after)
    assert fast.v[[0, -1]] == pytest.approx([said.v_before] * 2)
    np.testing.assert_array_equal(fast.maneuver, gentle.maneuver)
    assert not (fast.constant & fast.maneuver).any()
    assert (fast.steady <= fast.maneuver).all()
    assert fast.a[fast.constant].any() == False  # noqa: E712
    # 2.4 s of constant velocity, less 0.4 s after the maneuver.
    between = fast.constant & (fast.time > 6) & (fast.time < 9)
    assert between.sum() * T == pytest.approx(2.0, abs=2 * T)


def test_every_velocity_is_unambiguous_with_the_wavelength_chosen():
    most = OWN.wavelength / (2 * T)
    for name in ("path 1", "path 2", "fighter"):
        v = system.velocity_path(name).v
        assert 0 < v.min() and v.max() < most


def rounding(window):
    """Return what single precision may do to a velocity, in m/s: of bin or noise a small part."""
    bin_width = OWN.wavelength / (2 * OWN.nfft * T)
    noise = np.sqrt(system.measurement_variance(window, 15.0))
    return np.maximum(0.02 * bin_width, 0.05 * noise)


def test_the_doppler_filter_is_a_padded_transform_with_a_parabola_at_its_peak():
    """Single precision: some hundredths of a bin, or of the noise of a window of a few samples."""
    path = system.velocity_path("path 2")
    x = iq_from_velocity(path.v[:900], T, OWN.wavelength, 15.0, rng=np.random.default_rng(2))
    found = system.doppler_filter(x)
    tolerance = rounding(found.windows)
    for w, window in enumerate(found.windows):
        windows = np.lib.stride_tricks.sliding_window_view(x, window)[OWN.first - window + 1 :]
        for estimator in (parabolic, parabolic_three_highest):
            f = estimator(windows, 1 / T, (0, 1 / T), OWN.nfft)
            expected = f * OWN.wavelength / 2
            # The two best of many lobes of a short window can be equal to seven digits.
            off = np.abs(found.v[w] - expected) > tolerance[w]
            assert off.mean() < 0.002, estimator.__name__


def test_one_loud_sample_costs_its_windows_and_a_dead_sensor_is_missing():
    """The sums begin anew: their rounding moves a velocity by a hundredth of a bin at most."""
    path = system.velocity_path("path 1")
    x = iq_from_velocity(
        path.v[:900], T, OWN.wavelength, 15.0, rng=np.random.default_rng(5), size=2
    )
    clean = system.doppler_filter(x)
    x[0, 400], x[1, 300:700] = 1e30, 0.1
    with np.errstate(all="raise"):
        found = system.doppler_filter(x)
    last = OWN.first + np.arange(found.v.shape[-1])
    for w, window in enumerate(found.windows):
        loud = (last >= 400) & (last - window < 400)
        dead = (last < 700) & (last - window >= 299)
        np.testing.assert_array_equal(np.isnan(found.v[w]), [loud, dead])
        assert (found.snr_db[w, 0, loud] == -30).all()
        off = found.v[w, 0, ~loud] - clean.v[w, 0, ~loud]
        assert (np.abs(off) > rounding(window)).mean() < 0.002
    pair = system.filter_velocity(system.doppler_filter(x[None]), 15.0)
    assert np.isfinite(pair.x).all()


def test_a_measurement_belongs_to_the_middle_of_its_window():
    """Without noise; the parabola errs by some thousandths of a bin of 1.3 m/s."""
    t = T * np.arange(600)
    v = 200 - 20 * t
    x = iq_from_velocity(v, T, OWN.wavelength, None, rng=np.random.default_rng(3))
    found = system.doppler_filter(x)
    for w, delay in enumerate(found.delays):
        np.testing.assert_allclose(found.v[w], v[OWN.first :] + 20 * delay, atol=0.05)


def test_the_velocities_scatter_as_the_cramer_rao_bound_says():
    """300 independent windows: their variance is off by this much once in a million seeds."""
    runs, snr_db = 300, 15.0
    x = tone(100.0, 1 / T, 141, snr_db, rng=np.random.default_rng(4))
    x = np.stack([x] + [
        tone(100.0, 1 / T, 141, snr_db, rng=child)
        for child in np.random.default_rng(5).spawn(runs - 1)
    ])  # fmt: skip
    found = system.doppler_filter(x, [32, 64])
    bound = system.measurement_variance(found.windows, snr_db)
    ratio = found.v[..., 0].var(axis=-1, ddof=1) / bound
    assert (np.abs(ratio - 1) < Z * np.sqrt(2 / runs) + 0.02).all()


def test_the_ratio_of_the_spectrum_is_too_large_by_its_degrees_of_freedom_only():
    """8000 windows of a tone at 15 dB: the mean of n = 8 scatters by 0.02 dB.

    A mean of 1 / chi-square is too large by (n - 1.5) / (n - 2.5), and 1.5 / n is taken away.
    """
    n, runs, rng = 8, 8000, np.random.default_rng(13)
    noise = (rng.standard_normal((runs, n, 2)) @ [1, 1j]) * np.sqrt(10**-1.5 / 2)
    x = np.exp(2j * np.pi * (0.2 * np.arange(n) + rng.random((runs, 1)))) + noise
    found = 10 ** (system.doppler_filter(x, [n], n - 1).snr_db[0, :, 0] / 10)
    expected = (10**1.5 + 1.5 / n) * (n - 1.5) / (n - 2.5) - 1.5 / n
    assert 10 * np.log10(found.mean() / expected) == pytest.approx(0, abs=0.1)


def test_the_noise_of_both_sensors_is_independent(runs):
    """Errors of windows that do not overlap: no correlation within four standard errors."""
    w = int(np.flatnonzero(runs.doppler.windows == 12)[0])
    still = np.flatnonzero(runs.path.constant[OWN.first :])[::12]
    error = runs.doppler.v[w][..., still] - runs.path.v[OWN.first :][still]
    one, two = np.moveaxis(error, 1, 0).reshape(2, -1)
    assert abs(np.corrcoef(one, two)[0, 1]) < Z / np.sqrt(one.size)
    assert one.std() == pytest.approx(two.std(), rel=0.2)


def test_unequal_sensors_choose_by_the_mean_of_their_ratios_if_fused(runs):
    """One at 35 dB, one at 0 dB: either ratio alone would choose another window."""
    path = system.velocity_path("path 2")
    x = np.stack([
        iq_from_velocity(path.v[:1200], T, OWN.wavelength, snr_db, rng=np.random.default_rng(k))
        for k, snr_db in enumerate((35.0, 0.0))
    ])  # fmt: skip
    doppler = system.doppler_filter(x[None], TABLE.windows)
    track = system.filter_velocity(doppler, [35.0, 0.0], table=TABLE, feedback="fused")
    R = system.measurement_variance(doppler.windows, 35.0)
    assert track.S[0, 0, 1] < track.S[0, 1, 1]  # each has its own R
    assert track.P[0, 0, 0, 0, 0] == pytest.approx(R[doppler.windows == OWN.fixed_window][0])
    for k in range(0, 900, 7):
        used = [np.flatnonzero(doppler.windows == one)[0] for one in track.window[0, :, k]]
        snr = np.mean([doppler.snr_db[w, 0, s, k] for s, w in enumerate(used)])
        expected = chosen_window(TABLE, track.fused_x[0, k, 1], snr)
        assert (track.window[0, :, k + 1] == expected).all()
    with pytest.raises(ValueError, match="snr_db must be one number"):
        system.filter_velocity(doppler, [35.0, 0.0, 1.0])


def test_errors_count_from_the_first_scored_sample_on(runs):
    time = runs.path.time
    np.testing.assert_array_equal(runs.path.scored, time >= OWN.scored * T - 1e-9)
    error = runs.velocity(1) - runs.truth
    counted = runs.time >= OWN.scored * T - 1e-9
    expected = np.sqrt(np.mean(error[:, counted] ** 2, axis=-1))
    np.testing.assert_allclose(runs.measures(1)["whole"], expected)
    relative = np.abs(error / runs.truth)[:, counted]
    np.testing.assert_allclose(runs.measures(1)["cee"], 100 * relative.mean(axis=-1))
    np.testing.assert_allclose(runs.measures(1)["cee"], 100 * runs.cee(1)[:, -1])


@pytest.mark.parametrize("delayed", [False, True])
def test_the_filters_and_their_fusion_are_those_of_the_library(runs, delayed):
    doppler = runs.doppler
    track = system.filter_velocity(doppler, 15.0, delayed=delayed, table=TABLE, feedback="own")
    R = system.measurement_variance(doppler.windows, 15.0)
    F = np.array([[1, T], [0, 1]])
    Q = OWN.q * np.array([[T**3 / 3, T**2 / 2], [T**2 / 2, T]])
    x, P = track.x[0, :, 0].copy(), track.P[0, :, 0].copy()
    P12 = np.diag([0, OWN.acceleration_std**2])
    for k in range(1, 300):
        K, H = [], []
        for s in range(2):
            w = np.flatnonzero(doppler.windows == track.window[0, s, k])[0]
            h = np.array([[1.0, -doppler.delays[w] * delayed]])
            xs, Ps = kf_predict(x[s], P[s], F, Q)
            K.append(Ps @ h.T / (h @ Ps @ h.T + R[w]))
            H.append(h)
            x[s], P[s], nu, S = kf_update(xs, Ps, doppler.v[w, 0, s, k : k + 1], h, [[R[w]]])
            assert track.innovation[0, s, k] == pytest.approx(nu[0], rel=1e-7, abs=1e-8)
            assert track.S[0, s, k] == pytest.approx(S[0, 0], rel=1e-7)
        P12 = cross_covariance_step(P12, F, Q, K[0], H[0], K[1], H[1])
        if k <= 5:  # what they have in common at the start is soon forgotten
            np.testing.assert_allclose(track.P12[0, k], P12, rtol=1e-6, atol=1e-9)
    # Two ways to sum the same products 300 times; the velocities are some hundred m/s.
    np.testing.assert_allclose(track.x[0, :, 299], x, rtol=1e-7, atol=1e-7)
    np.testing.assert_allclose(track.P[0, :, 299], P, rtol=1e-7)
    np.testing.assert_allclose(track.P12[0, 299], P12, rtol=1e-6, atol=1e-9)
    fused = fuse_state_vectors(x[0], P[0], x[1], P[1])
    np.testing.assert_allclose(track.fused_x[0, 299], fused[0], rtol=1e-7)
    np.testing.assert_allclose(track.fused_P[0, 299], fused[1], rtol=1e-6)


def chosen_window(table, acceleration, snr_db):
    """Return what the compiled filter would choose: windows of the shape of the arguments."""
    lookup = table.accelerations, table.snrs_db, np.log(table.best), np.log(table.windows)
    choices = np.vectorize(lambda a, snr: choose(a, snr, *lookup))(acceleration, snr_db)
    return table.windows[choices]


def test_the_next_window_is_that_of_the_table_for_what_the_filter_knows(runs):
    windows = runs.doppler.windows
    for track, fused in ((runs.own, False), (runs.shared, True)):
        for k in range(0, 4000, 97):
            used = [np.flatnonzero(windows == one)[0] for one in track.window[0, :, k]]
            snr = np.array([runs.doppler.snr_db[w, 0, s, k] for s, w in enumerate(used)])
            a = track.x[0, :, k, 1]
            if fused:
                a, snr = np.full(2, track.fused_x[0, k, 1]), np.full(2, snr.mean())
            chosen = chosen_window(TABLE, a, snr)
            np.testing.assert_array_equal(track.window[0, :, k + 1], chosen)


def test_a_table_is_met_at_its_nodes_and_at_its_edges_beyond():
    a, snr = np.meshgrid(TABLE.accelerations, TABLE.snrs_db, indexing="ij")
    np.testing.assert_array_equal(chosen_window(TABLE, -a, snr), TABLE.best)
    assert chosen_window(TABLE, 1e3, 1e3) == TABLE.best[-1, -1]
    assert chosen_window(TABLE, 0.0, -1e3) == TABLE.best[0, 0]


def test_what_one_run_gives_does_not_depend_on_the_others():
    doppler = system.run_algorithms("path 1", 15.0, 2, TABLE, rng=np.random.default_rng(6)).doppler
    alone = system.FilteredDoppler(
        doppler.windows, doppler.first, doppler.v[:, 1:], doppler.snr_db[:, 1:]
    )
    both = system.filter_velocity(doppler, 15.0, table=TABLE, feedback="fused")
    one = system.filter_velocity(alone, 15.0, table=TABLE, feedback="fused")
    np.testing.assert_array_equal(both.fused_x[1], one.fused_x[0])


def test_the_plain_filter_is_late_by_half_a_window_and_the_one_that_knows_it_is_not(runs):
    """The filter itself has no lag on a constant acceleration; the noise is some 0.1 ms."""
    half = (OWN.fixed_window - 1) / 2 * T
    for algorithm in (1, 3):
        np.testing.assert_allclose(runs.measures(algorithm)["delay"], 1e3 * half, atol=1)
    np.testing.assert_allclose(runs.measures(6)["delay"], 0, atol=1)


def test_fusion_does_not_take_away_any_delay(runs):
    late = (runs.measures(a)["delay"] for a in (1, 3))
    np.testing.assert_allclose(*late, atol=1)


def test_the_best_window_of_the_law_has_the_least_error():
    for a, snr_db in ((5.0, 10.0), (37.0, 20.0)):
        n = np.linspace(5, 100, 20001)
        best = n[np.argmin(system.law_rmse(n, a, snr_db))]
        # The law takes n^3 for n (n^2 - 1) and n for n - 1.
        assert system.best_window(a, snr_db) == pytest.approx(best, rel=0.1)


def test_the_best_window_of_a_simulation_follows_the_law():
    """10 runs of 400 windows each: the exponents scatter by about 0.01 from seed to seed."""
    table = system.window_table(
        [5, 10, 20, 40], [10, 20, 30], rng=np.random.default_rng(7), runs=10,
        windows=[4, 5, 6, 8, 10, 12, 16, 20, 24, 32, 40, 48, 64],
    )  # fmt: skip
    a, snr = system.law_exponents(table)
    assert a == pytest.approx(-2 / 5, abs=0.05)
    assert snr == pytest.approx(-1 / 5, abs=0.025)


def test_linear_interpolation_costs_something_between_the_corners_and_nothing_at_them():
    cost = system.linear_cost((10.0, 80.0), (10.0, 40.0))
    np.testing.assert_allclose(cost[[0, 0, -1, -1], [0, -1, 0, -1]], 1.0, rtol=1e-12)
    assert cost.max() > 1.1
    finer = system.linear_cost((10.0, 20.0, 40.0, 80.0), (10.0, 20.0, 30.0, 40.0), points=43)
    np.testing.assert_allclose(finer[::42, ::14], 1.0, rtol=1e-12)
    assert finer.max() < 1.01


def test_the_best_window_is_a_plane_in_logarithms_and_not_otherwise():
    """No plane is near to a law that falls by a factor of nine over the region."""
    a, snr_db = np.linspace(10.0, 88.2, 40), np.linspace(10.0, 40.0, 40)
    best = system.best_window(a[:, None], snr_db)
    error = system.linear_error((10.0, 88.2), (10.0, 40.0))
    assert np.abs(error).max() > 0.5
    # Least squares: what is left over is orthogonal to what the plane is made of.
    rest = error * best
    for part in (np.ones_like(best), best * 0 + a[:, None], best * 0 + snr_db):
        assert abs(np.sum(rest * part)) < 1e-9 * np.sum(best * part)
    logs = np.log(best)
    np.testing.assert_allclose(np.diff(logs, 2, axis=1), 0, atol=1e-12)
    slopes = np.diff(logs, axis=0) / np.diff(np.log(a))[:, None]
    np.testing.assert_allclose(slopes, -2 / 5, rtol=1e-9)


def test_long_windows_are_late_and_short_ones_noisy():
    """10 records each; the errors differ by factors."""
    windows = [8, 12, 48, 96]
    table = system.window_table(
        [5.0, 40.0], [0.0, 20.0], rng=np.random.default_rng(12), runs=10, windows=windows
    )
    late, noisy = table.cee[1, 1], table.cee[0, 0]
    assert late[3] > 4 * late[1]
    # Half of a window of 96 samples at 40 m/s^2 costs 5.7 of some 230 m/s.
    assert late[3] == pytest.approx(40 * 95 / 2 * T / 226, rel=0.1)
    assert noisy[0] > 4 * noisy[2]


def test_the_limits_of_the_fighter_are_its_multiples_of_g_but_for_a_sign():
    said, fighter = system.reported().stated, system.velocity_path("fighter")
    assert fighter.a.min() == pytest.approx(-said.g_positive_si, rel=1e-3)
    assert fighter.a.max() == pytest.approx(said.g_negative_si, rel=1e-3)
    assert said.g_negative < 0 < said.g_negative_si


def test_a_right_filter_reveals_the_noise_by_its_residuals_only_with_the_other_sign():
    """White measurements: the mean of 200 runs lies within its limits but once in a million."""
    _, doppler = system.matched_model(200, 700, 15.0, rng=np.random.default_rng(8))
    track = system.filter_velocity(doppler, 15.0)
    R = float(system.measurement_variance(OWN.fixed_window, 15.0))
    residual, HPH = system.updated_residual(track.innovation[:, 0, 200:], track.S[:, 0, 200:], R)
    np.testing.assert_allclose(HPH, track.P[:, 0, 200:, 0, 0], rtol=1e-6)
    share = HPH[0, -1] / R
    for sign, expected in ((-1, 1 - 2 * share), (1, 1.0)):
        ratio = system.residual_variance(residual, HPH[:, -1], sign) / R
        found = mean_interval(ratio, 1 - FALSE_ALARM)
        # The median of 500 correlated residuals is biased by a few thousandths.
        assert found.low - 0.01 < expected < found.high + 0.01


def test_only_fusion_that_knows_what_is_common_believes_what_is_true():
    """NEES of 300 independent records; a million seeds give one outside of these limits."""
    truth, doppler = system.matched_model(300, 400, 15.0, rng=np.random.default_rng(9))
    ways = system.fuse_all(doppler, 15.0, delayed=False)
    found = {
        name: mean_interval(one["NEES"], 1 - FALSE_ALARM)
        for name, one in system.fusion_summary(ways, truth).items()
    }
    for name in ("one sensor", "Bar-Shalom and Campo", "measurement fusion"):
        assert found[name].low < 2 < found[name].high, name
    assert found["naive"].low > 2.2
    assert found["covariance intersection"].high < 1.8


def test_a_filter_fed_with_overlapping_windows_claims_too_much_and_its_innovations_tell():
    """20 runs with errors that differ from the claims by factors: no seed changes the order."""
    v = np.full((20, 1, 3000), 200.0)
    x = iq_from_velocity(v, T, OWN.wavelength, 15.0, rng=np.random.default_rng(11))
    doppler = system.doppler_filter(x, [64])
    often, seldom = (system.filter_velocity(doppler, 15.0, hop=hop) for hop in (1, 64))
    for track, low, high in ((often, 2.0, 4.0), (seldom, 0.8, 1.1)):
        told = system.calibration(track, 200.0, 640)
        ratio = told["error (m/s)"].mean() / told["claimed (m/s)"].mean()
        assert low < ratio < high
        told = told["innovations, lag 1"].mean()
        assert (told > 0.5) == (track is often)
    # Some 20 x 45 independent windows: the correlation scatters by 0.03 or less.
    found = system.error_correlation(doppler, 200.0, 80)
    law = overlap_correlation_discrete(64, np.arange(81))
    np.testing.assert_allclose(found, law, atol=Z * 0.03)


def test_summaries_hold_the_errors_of_each_run(runs):
    summary = runs.summary()[system.ALGORITHMS[3]]
    np.testing.assert_array_equal(summary["whole record (m/s)"], runs.measures(3)["whole"])
    ways = system.fuse_all(runs.doppler, 15.0, delayed=False)
    errors = system.fusion_errors(ways, runs.path)
    for name, number in (("one sensor", 1), ("naive", 3)):
        expected = runs.measures(number)["maneuver"]
        np.testing.assert_allclose(errors[name]["maneuver (m/s)"], expected, rtol=1e-6)


def test_a_gain_is_that_of_the_same_run_and_knowing_the_delay_gains_most_in_a_maneuver(runs):
    rows = system.ablation(runs.doppler, 15.0, runs.path)
    start = rows["one sensor, fixed window"]
    np.testing.assert_allclose(start["maneuver (m/s)"], runs.measures(1)["maneuver"], rtol=1e-6)
    np.testing.assert_allclose(start["gain, maneuver"], 1.0)
    delay, fused = rows["delay in H"], rows["measurement fusion"]
    np.testing.assert_allclose(delay["maneuver (m/s)"], runs.measures(6)["maneuver"], rtol=1e-6)
    np.testing.assert_allclose(
        delay["gain, maneuver"], start["maneuver (m/s)"] / delay["maneuver (m/s)"]
    )
    assert (delay["gain, maneuver"] > 5).all() and (fused["gain, maneuver"] < 1.1).all()
    # With every measurement all ways of fusing, with one a window the best one and none.
    assert len(rows) == 2 * (5 + 2)


def test_estimates_are_compared_with_the_truth_at_their_own_time(runs):
    ways = system.fuse_all(runs.doppler, 15.0, delayed=True, hop=64)
    track = system.filter_velocity(runs.doppler, 15.0, delayed=True, hop=64)
    times = OWN.first + 64 * np.arange(track.x.shape[2])
    one = ways["one sensor"]
    np.testing.assert_array_equal(one.sample, times[times >= OWN.scored])
    np.testing.assert_array_equal(one.x, track.x[:, 0, times >= OWN.scored])
    part = runs.path.maneuver[one.sample]
    error = (one.x[..., 0] - runs.path.v[one.sample])[:, part]
    found = system.fusion_errors(ways, runs.path)["one sensor"]["maneuver (m/s)"]
    np.testing.assert_allclose(found, np.sqrt(np.mean(error**2, axis=-1)))


def test_two_sensors_together_measure_with_half_of_the_variance():
    _, doppler = system.matched_model(50, 200, 15.0, rng=np.random.default_rng(10))
    merged, ratio = system.merged_doppler(doppler, 15.0)
    assert ratio == pytest.approx(0.5)
    np.testing.assert_allclose(merged.v[:, :, 0], doppler.v.mean(axis=2), rtol=1e-12)


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled")
def test_one_run_and_several_are_of_the_same_types_to_the_compiler(runs):
    """Else it compiles, which takes longer than most of what is computed."""
    x = np.exp(1j * np.arange(1000.0))
    for one in (x[None, None, :300], np.stack([[x, x]] * 3)):
        doppler = system.doppler_filter(one, tuple(TABLE.windows))
        system.filter_velocity(doppler, 15.0, hop=one.shape[1])
        system.filter_velocity(doppler, 15.0, table=TABLE, feedback="own")
    for compiled in (_pair_kernel.compiled, _sliding_kernel.compiled):
        assert len(compiled.signatures) == 1


def test_what_does_not_fit_is_refused(runs):
    with pytest.raises(ValueError, match="windows must be from 3"):
        system.doppler_filter(np.ones(500), [3, 200])
    with pytest.raises(ValueError, match="table must be given"):
        system.filter_velocity(runs.doppler, 15.0, feedback="own")
    with pytest.raises(ValueError, match="window must be one of"):
        system.filter_velocity(runs.doppler, 15.0, window=63)
    with pytest.raises(ValueError, match="v must not be zero"):
        system.cumulative_error([1.0, 0.0], [1.0, 1.0])
    with pytest.raises(ValueError, match="accelerations must rise"):
        system.window_table([1, 0], [0, 1], rng=np.random.default_rng(1))
    with pytest.raises(ValueError, match="snrs_db must rise"):
        system.linear_cost([1, 2], [1, 1])
    with pytest.raises(ValueError, match="name must be one of"):
        system.velocity_path("path 3")
