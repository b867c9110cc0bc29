"""The judged numbers by other routes: closed forms, filters written anew, the files read anew.

Where a test is about random numbers, its limits leave room for all but one seed in a million.
"""

import csv
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.linalg import solve_discrete_are, solve_discrete_lyapunov
from scipy.stats import foldnorm, norm

from dopplerlib import kf_predict, kf_update
from dopplerlib._data import read_lines, results
from dopplerlib.signal.laws import overlap_correlation_discrete
from dopplerlib.systems import valarmathi as system
from dopplerlib.systems.valarmathi import fusion_sweep
from dopplerlib.systems.valarmathi.error_measures import run_measures
from dopplerlib.systems.valarmathi.evidence import _comparisons, _front_end, _limits, _windows
from dopplerlib.tracking.fusion import fuse_state_vectors

SAID, OWN = system.reported().stated, system.reported().chosen
T = SAID.T
Z = norm.isf(0.5e-6)
EQUAL, ONE, EACH = fusion_sweep.SENSORS


@pytest.fixture(scope="module")
def compared():
    return _comparisons.comparisons()


@pytest.fixture(scope="module")
def limited():
    return _limits.limits()


@pytest.fixture(scope="module")
def fronts():
    return _front_end.front_end(np.random.default_rng(41))


class Asked(dict):
    """Evidence by the values of choices, each computed when a test looks at it."""

    def __init__(self, function):
        self.function = function

    def __missing__(self, at):
        return self.setdefault(at, self.function(*at))


@pytest.fixture(scope="module")
def windowed():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(_windows, "swept", lambda names, f: SimpleNamespace(points=Asked(f)))
        return _windows.windows(np.random.default_rng(42))


@cache
def rows():
    """Return the rows of each cell of the sweep, by the first six columns of its file, as text."""
    found = {}
    for row in csv.reader(read_lines("velocity_fusion.sweep.csv", folder=results)[1:]):
        found.setdefault(tuple(row[:6]), []).append([float(one) for one in row[6:]])
    return {key: np.array(values) for key, values in found.items()}


def saved(path, snr_db, q, sensors, algorithm, setting, measure):
    """Return the runs of one cell of the file."""
    key = (
        {"path 1, 5 m/s²": "1", "path 2": "3", "fighter": "4"}[path], f"{snr_db}", f"{q}",
        {EQUAL: "1", ONE: "2", EACH: "3"}[sensors], {"5 state": "7"}.get(algorithm, algorithm),
        {"4 to 96": "4", "8 to 64": "8"}.get(setting, f"{setting}"),
    )  # fmt: skip
    columns = ("whole", "maneuver", "constant", "cee", "delay", "late")
    return rows()[key][:, columns.index(measure)]


def steady_state(R, q=OWN.q):
    """Return F, Q, H, the predicted covariance and the gain of a filter that has settled."""
    F, H = np.array([[1, T], [0, 1]]), np.array([[1.0, 0.0]])
    Q = q * np.array([[T**3 / 3, T**2 / 2], [T**2 / 2, T]])
    P = solve_discrete_are(F.T, H.T, Q, [[R]])
    return F, Q, H, P, P @ H.T / (H @ P @ H.T + R)


def filtered(v, R, q):
    """Return states and covariances of filters, each behind given measurements of one sensor."""
    F, Q, H, _, _ = steady_state(R[0], q)  # the first three are the same for all
    R, P = R[:, None, None], np.zeros((len(v), 2, 2))
    x = np.stack([v[:, 0], np.zeros(len(v))], axis=-1)
    P[:, 0, 0], P[:, 1, 1] = R[:, 0, 0], OWN.acceleration_std**2
    states, covariances = [x], [P]
    for z in v.T[1:]:
        x, P = kf_predict(x, P, F, Q)
        x, P, _, _ = kf_update(x, P, z[:, None], H, R)
        states.append(x)
        covariances.append(P)
    return np.stack(states, axis=1), np.stack(covariances, axis=1)


def errors(velocity, path):
    """Return the measures of one run, each from its definition."""
    error = velocity - path.v[-len(velocity) :]
    time, a = path.time[-len(velocity) :], path.a[-len(velocity) :]
    counted = time >= OWN.scored * T - 1e-9
    moving = a != 0
    return {
        "whole": np.sqrt(np.mean(error[counted] ** 2)),
        "maneuver": np.sqrt(np.mean(error[moving] ** 2)),
        "cee": 100 * np.mean(np.abs(error[counted] / path.v[-len(velocity) :][counted])),
    }


def test_the_others_have_every_operation_of_the_first_algorithm_and_more():
    one = system.operations(1)
    assert one < system.operations(2) < 1.01 * one  # the choice of a window is a look-up
    for algorithm in (3, 4, 5):
        assert system.operations(algorithm) > 2 * one
    # A transform of radix two: log2 N stages of N/2 butterflies of 10 operations.
    assert one > np.log2(OWN.nfft) * OWN.nfft / 2 * 10


def test_one_run_of_the_sweep_has_the_errors_of_a_filter_written_anew():
    """Path 2 at 20 dB, and the second sensor 10 dB below the first, as the file has it."""
    path, q, window = system.velocity_path("path 2"), 30, 64
    table = system.WindowTable([0, 10], [0, 20], [8, window], np.eye(2) + np.ones((2, 2, 2)))
    cell = fusion_sweep.sweep_cell("path 2", 20, table, runs=1)  # looked at without a choice
    rng = np.random.default_rng([3, 1, 2, 20])
    x, levels = fusion_sweep._records(path, 20, rng.spawn(1))
    np.testing.assert_array_equal(levels, [20, 20, 10])
    v = system.doppler_filter(x, [window]).v[0, 0]
    R = system.measurement_variance(window, levels)
    believed = np.array([*R, *[np.mean(R[[0, 2]])] * 2])
    *alone, first, third = zip(*filtered(v[[0, 1, 2, 0, 2]], believed, q), strict=True)
    pairs = {EQUAL: (alone[0], alone[1]), EACH: (alone[0], alone[2]), ONE: (first, third)}
    expected = {(EQUAL, "1"): alone[0][0][:, 0]}
    for sensors, ((x1, P1), (x2, P2)) in pairs.items():
        expected[sensors, "3"] = fuse_state_vectors(x1, P1, x2, P2)[0][:, 0]
    for (sensors, algorithm), velocity in expected.items():
        for measure, value in errors(velocity, path).items():
            key = sensors, algorithm, f"{window}", measure
            # Two ways to sum the same products; the file has four digits.
            assert cell[(q, *key)][0] == pytest.approx(value, rel=1e-4)
            assert saved("path 2", 20, q, *key)[0] == pytest.approx(value, rel=3e-3)


def test_the_fused_state_fed_back_is_that_of_one_filter_fed_with_it():
    """Both filters go on from the fused state and covariance: as one, with naive fusion inside."""
    path = system.velocity_path("path 2")
    x, _ = fusion_sweep._records(path, 20, np.random.default_rng(5).spawn(1))
    doppler = system.doppler_filter(x[:, :2], [64])
    table = system.WindowTable([0, 10], [0, 20], [64], np.ones((2, 2, 1)))
    track = system.filter_velocity(doppler, 20.0, table=table, feedback="state", q=30)
    R = float(system.measurement_variance(64, 20.0))
    F, Q, H, _, _ = steady_state(R, 30)
    v = doppler.v[0, 0]
    both = [(np.array([z, 0.0]), np.diag([R, OWN.acceleration_std**2])) for z in v[:, 0]]
    for k in range(200):
        if k:
            state, P = kf_predict(*fused, F, Q)  # noqa: F821
            both = [kf_update(state, P, v[s, k : k + 1], H, [[R]])[:2] for s in (0, 1)]
        fused = fuse_state_vectors(*both[0], *both[1])
    np.testing.assert_allclose(track.fused_x[0, 199], fused[0], rtol=1e-6)
    np.testing.assert_allclose(track.fused_P[0, 199], fused[1], rtol=1e-6)


def test_the_noise_of_all_sensors_is_independent():
    """Correlation of their errors in windows that do not overlap: zero within four errors."""
    path = system.velocity_path("path 2")
    x, _ = fusion_sweep._records(path, 20, np.random.default_rng(6).spawn(8))
    doppler = system.doppler_filter(x, [16])
    still = np.flatnonzero(path.constant[doppler.first :])[::16]
    error = doppler.v[0][..., still] - path.v[doppler.first :][still]
    error = np.moveaxis(error, 1, 0).reshape(3, -1)
    assert np.abs(np.corrcoef(error)[np.triu_indices(3, 1)]).max() < Z / np.sqrt(error.shape[1])


def by_hand():
    """Yield a claim, a point of it, and its number from the file, by the words of the claim."""
    p1, p2 = "path 1, 5 m/s²", "path 2"
    rms, cee = "root mean square in the maneuver", "cee of the record"

    def over(measure, a, b):
        return np.mean(saved(*a, measure) / saved(*b, measure))

    for q in (7, 380):
        one, two = (p2, 20, q, EQUAL, "1", 32), (p2, 20, q, EQUAL, "2", "8 to 64")
        three, five = (p2, 20, q, ONE, "3", 32), (p2, 20, q, ONE, "5", "8 to 64")
        four = (p2, 20, q, ONE, "4", "8 to 64")
        yield "adaptive-maneuver", (32, "8 to 64", 20, q, rms), over("maneuver", two, one)
        yield "fusion-maneuver", (32, ONE, 20, q, cee), over("cee", three, one)
        yield "fusion-fast", ("5", "8 to 64", ONE, 20, q, cee), over("cee", five, two)
        yield "fusion-every-snr", ("4", p2, "8 to 64", ONE, 20, q), over("maneuver", four, two)
        yield "constant", ("4", p2, "8 to 64", ONE, 20, q), over("constant", two, four)
        rivals = [over("constant", three, other) for other in (one, two, four, five)]
        yield "smoothing", (32, "8 to 64", ONE, 20, q), max(rivals)
        yield "kalman-delay", (32, 20, q, p2), np.mean(saved(*one, "late"))
    one, three = (p2, 0, 30, EQUAL, "1", 96), (p2, 0, 30, EACH, "3", 96)
    four = (p2, 0, 30, EACH, "4", "4 to 96")
    yield "fusion-delay", ("3", 96, EACH, 0, p2), over("delay", three, one)
    yield "fusion-delay", ("4", 96, EACH, 0, p2), over("delay", four, one)
    three, five = (p1, 40, 30, EQUAL, "3", 8), (p1, 40, 30, EQUAL, "5", "4 to 96")
    yield "adaptive-delay", ("5", 8, "4 to 96", 40, p1), over("delay", five, three)
    four, state = (p2, 20, 30, EQUAL, "4", "4 to 96"), (p2, 20, 30, EQUAL, "5 state", "4 to 96")
    yield (
        "same", (p2, EQUAL, 20, 30, "cee", "the fused state"), abs(over("cee", state, four) - 1)
    )  # fmt: skip
    five, rms = (p2, 20, 30, EQUAL, "5", "4 to 96"), "root mean square"
    yield (
        "same", (p2, EQUAL, 20, 30, rms, "acceleration and ratio"),
        abs(over("whole", five, four) - 1),
    )  # fmt: skip
    low = [(p1, 10, 30, EQUAL, *one) for one in (("4", "4 to 96"), ("2", "4 to 96"), ("3", 16))]
    yield "low-snr", ("4", "2", 10, p1, 16, "cee"), over("cee", low[0], low[1])
    yield "low-snr", ("4", "3", 10, p1, 16, rms), over("whole", low[0], low[2])


def test_comparisons_are_mean_ratios_of_the_runs_in_the_file(compared):
    for claim, at, expected in by_hand():
        found = compared[claim].points[at]
        assert found.value == pytest.approx(expected, rel=1e-9), (claim, at)
        assert found.low < found.value < found.high or found.high - found.low < 1e-6


def test_a_trade_off_is_one_ratio_above_and_one_below(compared):
    p2 = "path 2"
    for fixed, grid in ((8, "4 to 96"), (96, "8 to 64")):
        four, three = (p2, 20, 30, EQUAL, "4", grid), (p2, 20, 30, EQUAL, "3", fixed)
        delay, noise = (
            np.mean(saved(*four, measure) / saved(*three, measure))
            for measure in ("delay", "constant")
        )
        found = compared["trade-off"].points["4", fixed, grid, 20, 30].value
        assert found == pytest.approx(min(max(delay, noise), 1 / min(delay, noise)), rel=1e-9)
        assert (found > 1) == ((delay - 1) * (noise - 1) < 0)


def test_a_fused_delay_is_the_weighted_mean_of_both_delays(compared):
    """Of two filters with one window: that of either, whatever their noise."""
    for sensors in (EQUAL, EACH):
        found = compared["fusion-delay"].points["3", 64, sensors, 40, "path 2"]
        assert found.value == pytest.approx(1, abs=3e-3)
    half = 1e3 * (64 - 1) / 2 * T
    assert np.mean(saved("path 2", 40, 30, EQUAL, "1", 64, "delay")) == pytest.approx(
        half, rel=0.01
    )
    adaptive = np.mean(saved("path 2", 40, 30, EQUAL, "4", "4 to 96", "delay"))
    found = compared["adaptive-delay"].points["4", 64, "4 to 96", 40, "path 2"]
    assert found.value == pytest.approx(adaptive / half, rel=0.02)


def test_fusion_takes_a_smaller_part_of_an_error_that_is_delay(compared):
    """At rest it takes about 0.3 of an error; what is delay stays."""
    point = 5, 64, EQUAL, 20
    parts, amounts = (
        compared["paths"].points[(*point, gain)].value
        for gain in ("fraction of the error", "amount of the error")
    )
    cee = {
        (path, a): saved(path, 20, 30, EQUAL, a, 64, "cee")
        for path in ("path 1, 5 m/s²", "path 2")
        for a in ("1", "3")
    }
    one, two = (cee[path, "1"] - cee[path, "3"] for path in ("path 1, 5 m/s²", "path 2"))
    assert amounts == pytest.approx(np.mean(two) - np.mean(one), rel=1e-6, abs=1e-9)
    expected = np.mean(two / cee["path 2", "1"]) - np.mean(one / cee["path 1, 5 m/s²", "1"])
    assert parts == pytest.approx(100 * expected, rel=1e-6) and parts < 0


def test_what_is_late_by_half_a_window_and_noisy_has_the_share_of_its_delay(compared):
    path, rng = system.velocity_path("path 2"), np.random.default_rng(1)
    late, sigma = 0.05, 1.0
    velocity = path.v - late * path.a + sigma * rng.standard_normal((20, len(path.v)))
    found = run_measures(path, velocity)
    power = np.mean((late * path.a[path.steady]) ** 2)
    assert found["late"].mean() == pytest.approx(power / (power + sigma**2), abs=0.01)
    assert found["delay"].mean() == pytest.approx(1e3 * late, rel=0.02)
    # Half of 64 samples at 37 m/s² is 3.5 m/s, and noise a twentieth of a m/s.
    assert compared["kalman-delay"].points[64, 20, 30, "path 2"].value > 0.998


def test_the_error_of_a_late_filter_is_acceleration_times_delay(limited):
    """Root mean square over the record; a little less, as the delay builds up after each jump."""
    for claim, name, at in (
        ("kalman-fails", "path 2", (20, 30, "path 2")),
        ("fighter", "fighter", ("4 to 96", 30)),
    ):
        path = system.velocity_path(name)
        rms = np.sqrt(np.mean(path.a[path.scored] ** 2))
        for window in (64, 96):
            found = limited[claim].points[window, *at].value
            assert found == pytest.approx(rms * (window - 1) / 2 * T, rel=0.05)
    # With a short window the worst of two noises: at 20 dB, not at 40.
    found = limited["fighter"].points[8, "8 to 64", 380].value
    worst = max(
        np.mean(saved("fighter", snr_db, 380, EQUAL, a, setting, "whole"))
        for snr_db in (20, 40)
        for a, setting in (("1", 8), ("2", "8 to 64"), ("3", 8), ("4", "8 to 64"), ("5", "8 to 64"))
    )
    assert found == pytest.approx(worst, rel=1e-9)
    better = np.mean(saved("fighter", 40, 380, EQUAL, "1", 8, "whole"))
    assert found > 1.05 * better


def test_the_limits_are_counted_from_the_file(limited):
    lines = read_lines("velocity_fusion.errors.csv", folder=results)
    table = np.array([line.split(",")[:4] for line in lines[1:]], dtype=float)

    def exceeded(path, algorithm, snr_db, share):
        cell = (table[:, :3] == [path, snr_db, algorithm]).all(axis=-1)
        runs = np.sort(table[cell, 3])
        return runs[-1 - int(share * len(runs))], runs[-2 - int(share * len(runs))]

    for path, name in ((1, "path 1, 5 m/s²"), (2, "path 2")):
        for share in (0.05, 0.5):
            for claim, levels in (("limit-fused", range(15, 41, 5)), ("limit-fused-below", [0])):
                ends = [exceeded(path, 5, level, share) for level in levels]
                found = limited[claim].points["5", share, name].value
                high, low = (max(end) for end in zip(*ends, strict=True))
                assert low * 0.999 <= found <= high * 1.001  # the file has four digits
            high, low = exceeded(path, 1, 30, share)
            found = limited["limit-single"].points["1", 30, share, name].value
            assert low * 0.999 <= found <= high * 1.001
    # Where two curves of errors pass a limit, by linear interpolation of their logarithms.
    crossings = []
    for algorithm in (2, 4):
        levels = np.arange(-10, 41, 5)
        curve = np.array([np.mean(exceeded(2, algorithm, level, 0.5)) for level in levels])
        last = np.flatnonzero(curve > 2.5)[-1]
        pair = slice(last, last + 2)
        crossings.append(np.interp(-np.log(2.5), -np.log(curve[pair]), levels[pair]))
    found = limited["limits-apart"].points[0.5, "path 2", 2.5]
    assert found.value == pytest.approx(crossings[0] - crossings[1], abs=0.02)
    assert found.low <= found.value <= found.high


def test_a_limit_is_where_errors_fall_below_it_for_the_last_time():
    assert _limits._crossing(np.array([0, 5, 10, 15]), [9.0, 1.0, 4.0, 1.0], 2.0) == pytest.approx(
        12.5
    )
    assert _limits._crossing(np.array([0, 5]), [1.0, 1.0], 2.0) == 0
    assert _limits._crossing(np.array([0, 5]), [3.0, 3.0], 2.0) == 5


def test_the_best_windows_of_the_evidence_are_those_of_the_law(windowed):
    """Powers of -2/5 and -1/5; the law takes n^3 for n (n^2 - 1), and short windows are longer."""
    found = windowed["window-acceleration"].points["of the Doppler filter", 30]
    assert found.value == pytest.approx(8**0.4, rel=0.1)
    found = windowed["window-snr"].points["of the Doppler filter", 30]
    assert found.value == pytest.approx(100**0.2, rel=0.1)


def test_an_optimum_at_an_end_of_the_windows_tried_is_none():
    cee = np.array([[[1.0, 2.0, 3.0], [3.0, 1.0, 2.0]], [[3.0, 2.0, 1.0], [2.0, 1.0, 2.0]]])
    table = system.WindowTable([5, 40], [0, 20], [8, 16, 32], cee)
    np.testing.assert_array_equal(table.inside, [[False, True], [False, True]])
    assert table.labels() == {5.0: ["≤ 8", "16"], 40.0: ["≥ 32", "16"]}
    lengths = system.best_lengths(table)
    np.testing.assert_array_equal(np.isnan(lengths), ~table.inside)
    assert lengths[1, 1] == pytest.approx(16)  # a parabola with equal neighbors


def test_errors_of_long_and_short_windows_are_those_of_the_law(windowed):
    """Mean of the absolute value of a normal error: half a window of delay, and the noise."""

    def expected(window, a, snr_db):
        sigma = np.sqrt(system.measurement_variance(window, snr_db))
        return foldnorm.mean(a * (window - 1) / 2 * T / sigma, scale=sigma)

    for pair, (long, short) in (("96 and 12", (96, 12)), ("64 and 16", (64, 16))):
        found = windowed["window-short"].points[pair, "of the Doppler filter", 30]
        ratio = expected(long, 40.0, 20.0) / expected(short, 40.0, 20.0)
        assert found.value == pytest.approx(ratio, rel=0.1)
    # At 0 dB short windows fail more often than they are noisy: the other way round at least.
    found = windowed["window-long"].points["64 and 16", "of the Doppler filter", 30]
    assert found.value > expected(16, 5.0, 0.0) / expected(64, 5.0, 0.0) > 1


@pytest.mark.parametrize("top", [40, 88.2])
def test_a_power_is_as_far_from_its_best_line_as_calculus_says(windowed, top):
    """Least squares over an interval by polynomials that are orthogonal there."""
    a = np.linspace(10.0, top, 40)
    law = a**-0.4
    line = np.polynomial.Polynomial.fit(a, law, 1)(a) / law - 1
    expected = {"largest": np.abs(line).max(), "root mean square": np.sqrt(np.mean(line**2))}
    for distance, value in expected.items():
        found = windowed["window-linear"].points["acceleration", top, 20, distance]
        assert found == pytest.approx(value, rel=1e-6)
    db = np.linspace(10.0, 40.0, 40)
    law = 10 ** (-db / 50)
    line = np.polynomial.Polynomial.fit(db, law, 1)(db) / law - 1
    point = "signal-to-noise ratio in dB", top, 40, "largest"
    assert windowed["window-linear"].points[point] == pytest.approx(np.abs(line).max(), rel=1e-6)


def test_interpolation_between_corners_costs_what_the_law_says(windowed):
    """At the worst place, with the bilinear interpolation written out."""
    a, s = np.linspace(10.0, 88.2, 40), np.linspace(10.0, 40.0, 40)
    u, t = (a[:, None] - 10) / 78.2, (s - 10) / 30
    corner = {(i, j): system.best_window(x, y) for i, x in enumerate((10.0, 88.2))
              for j, y in enumerate((10.0, 40.0))}  # fmt: skip
    n = (1 - u) * ((1 - t) * corner[0, 0] + t * corner[0, 1]) + u * (
        (1 - t) * corner[1, 0] + t * corner[1, 1]
    )
    best = system.best_window(a[:, None], s)
    cost = system.law_rmse(n, a[:, None], s) / system.law_rmse(best, a[:, None], s)
    found = windowed["window-interpolation"].points
    assert found["corners of the region", 88.2, 40] == pytest.approx(cost.max() - 1, rel=1e-9)
    assert 0 <= found["doublings and tens of dB", 88.2, 40] < 0.01


def test_residuals_have_the_variances_of_the_filter(fronts):
    """R - H P H' after the update, R + H P H' before it; the median is off by a few thousandths."""
    R = float(system.measurement_variance(OWN.fixed_window, 15.0))
    _, _, H, P, K = steady_state(R)
    after = float((H @ (P - K @ H @ P) @ H.T)[0, 0]) / R
    for indices, expected in (
        ("before the update", 1.0),
        ("after the update, as published", 1 - 2 * after),
    ):
        found = fronts["eq-14"].points[(indices,)]
        assert abs(found.value - expected) < Z / 2 * (found.high - found.low) / 2 + 0.01


def test_the_residuals_of_overlapping_windows_are_those_of_a_plain_sum(fronts):
    """Ten records of a still target, through a filter with the settled gain, by a plain loop."""
    v = 250.0
    rng = np.random.default_rng(9)
    R = float(system.measurement_variance(64, 15.0))
    F, _, H, P, K = steady_state(R)
    found = {"before the update": [], "after the update, as published": []}
    for child in rng.spawn(10):
        n = np.arange(2000)
        noise = (child.standard_normal((2000, 2)) @ [1, 1j]) * np.sqrt(10**-1.5 / 2)
        signal = np.exp(2j * np.pi * (2 * v / OWN.wavelength) * n * T + 1j) + noise
        z = system.doppler_filter(signal, [64]).v[0]
        state, before, after = np.array([v, 0.0]), [], []
        for one in z:
            state = F @ state
            before.append(one - state[0])
            state = state + K[:, 0] * before[-1]
            after.append(one - state[0])
        for name, rest, minus in (
            ("before the update", before, P[0, 0]),
            ("after the update, as published", after, (P - K @ H @ P)[0, 0]),
        ):
            rest = np.array(rest[500:])
            mad = np.median(np.abs(rest - np.median(rest))) / 0.6745
            found[name].append((mad**2 - minus) / R)
    for name, values in found.items():
        here = fronts["eq-14-overlap"].points[name, 64]
        spread = np.hypot(np.std(values, ddof=1) / np.sqrt(10), (here.high - here.low) / 4.5)
        assert abs(here.value - np.mean(values)) < 7 * spread  # t with nine degrees of freedom


def test_the_highest_bin_errs_by_a_uniform_part_of_a_bin(fronts):
    """Without noise; with 40 dB it errs by that and the Cramér-Rao bound."""
    window, bins = 64, 512
    f = (10 + np.arange(200) / 200) / window  # in cycles a sample
    spectrum = np.abs(np.fft.fft(np.exp(2j * np.pi * f[:, None] * np.arange(window)), bins))
    k = np.argmax(spectrum, axis=-1)
    left, middle, right = (spectrum[np.arange(200), (k + d) % bins] for d in (-1, 0, 1))
    parabola = k + (left - right) / (2 * (left - 2 * middle + right))
    error = np.sqrt(np.mean((parabola / bins - f) ** 2))
    expected = error / (1 / bins / np.sqrt(12))
    found = fronts["quantization"].points[8, "neighbors of the highest"]
    assert found == pytest.approx(expected, rel=0.02)
    for padding in (2, 8):
        found = fronts["padding"].points[padding, 40]
        bound = np.sqrt(system.measurement_variance(window, 40.0)) * 2 * T / OWN.wavelength
        coarse, fine = (1 / (window * m) / np.sqrt(12) for m in (1, padding))
        assert found.value == pytest.approx(np.hypot(fine, bound) / coarse, rel=0.1)


def test_successive_windows_share_their_noise_as_the_closed_form_says(fronts):
    for window in (16, 64):
        law = overlap_correlation_discrete(window, np.array([1]))[0]
        assert fronts["white-measurements"].points[(window,)] == pytest.approx(law, abs=0.02)


def test_naive_fusion_claims_too_little_by_the_common_part(fronts):
    """In the settled state: the claimed covariance is P/2, the true one (P + P12)/2."""
    R = float(system.measurement_variance(OWN.fixed_window, 15.0))
    F, Q, H, P, K = steady_state(R)
    A = np.eye(2) - K @ H
    after, common = A @ P, solve_discrete_lyapunov(A @ F, A @ Q @ A.T)
    expected = np.trace(np.linalg.solve(after / 2, (after + common) / 2)) / 2
    assert fronts["fused-covariance"] == pytest.approx(expected, rel=1e-3)


def test_a_fusion_that_lost_a_sensor_goes_on_with_the_other_one(fronts):
    """Not noticed, it takes half of the lost one's error, as its covariance is the same."""
    noticed = fronts["redundancy"].points["noticed: no measurements", 32]
    silent = fronts["redundancy"].points["not noticed: noise", 32]
    assert noticed.value < 0.1
    assert silent.value == pytest.approx(0.5, abs=0.05)
