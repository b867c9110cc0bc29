"""Judged numbers by another route: a program of its own, closed forms, other linearizations.

`Program` below is written from the thesis and not from the library: its own noise, filter, gate
and position. Both are simulations; a difference of 5 standard deviations has chance 6e-7, and the
seed is fixed.
"""

import numpy as np
import pytest
from scipy.stats import chi2

from dopplerlib.replication.judgments import read_judgments
from dopplerlib.systems import asheim2015 as thesis
from dopplerlib.systems.asheim2015.evidence._steps import h, jacobian

T, BOX = 0.1, np.sqrt([4 * 0.2, 4 * 0.1])
Q = {"code": 0.1 * np.array([[T**2 / 3, T / 2], [T / 2, 1]]), "text": np.diag([0.04, 0.01])}
R = {"code": np.array([0.2, 0.01]), "text": np.array([0.04, 0.01])}
RMS = "root mean square over all runs"


@pytest.fixture(scope="module")
def judged():
    """Return a function: our number on record for a claim, at some values of its choices."""
    known = {one.claim.id: one for one in read_judgments("asheim2015")}

    def number(id, **at):
        found = [one.ours for one in known[id].points if at.items() <= one.at.items()]
        assert found and all(one == found[0] for one in found[1:])  # a limit changes no number
        return found[0]

    return number


def sigma(d):
    """Return the deviations of range and rate at a range: Eqs 5.1 to 5.6 in figures."""
    resolution = np.array([0.15, 3e8 / 7e9 / 2])
    return resolution / np.sqrt(2 * 10 ** ((52 - 12 * d[..., None]) / 10))


def kalman(z, Q, R, T=T, gated=True, doppler=True, box=BOX, start=None):
    """Filter detections (runs, K, M, 2); return ranges (runs, K), and which scans are used."""
    F, m = np.array([[1, T], [0, 1]]), 2 if doppler else 1
    x, P = z[:, 0, 0].copy() if start is None else np.tile(start, (len(z), 1)), None
    P = np.tile(0.01 * np.eye(2), (len(z), 1, 1))
    ranges, used = [x[:, 0]], [np.ones(len(z), bool)]
    for k in range(1, z.shape[1]):
        x, P = x @ F.T, F @ P @ F.T + Q
        S = P + np.diag(R)
        nu = z[:, k] - x[:, None]
        distance = np.einsum("rmi,rij,rmj->rm", nu, np.linalg.inv(S), nu)
        inside = (np.abs(nu) <= box).all(axis=-1) if gated else np.isfinite(distance)
        nearest = np.argmin(np.where(inside, distance, np.inf), axis=1)
        some = inside.any(axis=1)
        K = P[:, :, :m] @ np.linalg.inv(S[:, :m, :m])
        step = np.where(some[:, None], nu[np.arange(len(z)), nearest], 0)[:, :m]
        x = x + (K @ step[..., None])[..., 0]
        P = np.where(some[:, None, None], P - K @ P[:, :m], P)
        ranges.append(x[:, 0])
        used.append(some)
    return np.stack(ranges, axis=1), np.stack(used, axis=1)


def meet(d1, d2, b=1.0):
    """Return where circles about (-b/2, 0) and (b/2, 0) meet, y = 0 where they do not."""
    x = (d1**2 - d2**2) / (2 * b)
    return np.stack([x, np.sqrt(np.maximum(d1**2 - (x + b / 2) ** 2, 0))], axis=-1)


class Program:
    """The simulation of the thesis, for so many runs."""

    def __init__(self, runs=150, seconds=60.0):
        self.t = np.arange(round(seconds / T) + 1) * T
        self.p = 0.1 * np.stack([self.t, self.t], axis=-1)
        rng, self.d, self.z, self.known = np.random.default_rng(5), [], [], {}
        for radar in (-0.5, 0.5):
            d = np.hypot(self.p[:, 0] - radar, self.p[:, 1])
            rate = np.append(np.diff(d), d[-1] - d[-2]) / T
            true = np.stack([d, rate], axis=-1)
            self.d.append(d)
            self.z.append(true + sigma(d) * rng.standard_normal((runs, len(d), 2)))

    def ranges(self, settings, radar, **options):
        """Return filtered ranges and used scans."""
        key = settings, radar, *options.items()
        if key not in self.known:
            z = self.z[radar][:, :, None]
            self.known[key] = kalman(z, Q[settings], R[settings], **options)
        return self.known[key]

    def range_error(self, settings, radar, **options):
        if settings == "measured":
            return self.z[radar][..., 0] - self.d[radar]
        return self.ranges(settings, radar, **options)[0] - self.d[radar]

    def error(self, settings, **options):
        """Return errors of position."""
        if settings == "measured":
            both = [z[..., 0] for z in self.z]
        else:
            both = [self.ranges(settings, n, **options)[0] for n in (0, 1)]
        return np.hypot(*np.moveaxis(meet(*both) - self.p, -1, 0))

    def ratio(self, a, b, low, high):
        """Return the ratio of root mean squares between two times, and its deviation."""
        at = (self.t >= low - 1e-9) & (self.t <= high + 1e-9)
        a, b = (np.nanmean(e[:, at] ** 2, axis=1) for e in (a, b))
        pick = np.random.default_rng(6).integers(len(a), size=(200, len(a)))
        spread = np.sqrt(a[pick].mean(axis=1) / b[pick].mean(axis=1)).std()
        return np.sqrt(a.mean() / b.mean()), spread


@pytest.fixture(scope="module")
def program():
    return Program()


def same(ours, other, spread):
    """Compare an estimate on record, with its interval of 95 %, with another and its deviation."""
    own = (ours.high - ours.low) / (2 * 1.96)
    assert abs(ours.value - other) < 5 * np.hypot(own, spread) + 1e-3, (ours, other, spread)


def rates(radar):
    """Return errors of one radar with the rate and without, no gate."""
    return lambda p, s: [
        p.range_error(s, radar, gated=False, doppler=doppler) for doppler in (True, False)
    ]


def gates(radar):
    return lambda p, s: [p.range_error(s, radar, gated=gated) for gated in (False, True)]


BY_ANOTHER_PROGRAM = {
    "kf-improves": (
        lambda p, s: [rates(0)(p, s)[1], p.range_error("measured", 0)],
        (10, 25), {"gate": "none", "part": "10 to 25 s"},
    ),
    "doppler-R1": (rates(0), (10, 25), {"gate": "none", "part": "10 to 25 s"}),
    "doppler-R2": (rates(1), (4, 12), {"gate": "none", "part": "4 to 12 s"}),
    "doppler-position": (
        lambda p, s: [p.error(s, gated=False, doppler=doppler) for doppler in (True, False)],
        (25, 40), {"gate": "none", "part": "25 to 40 s"},
    ),
    "good-snr-R1": (
        lambda p, s: [p.range_error(s, 0), p.range_error("measured", 0)],
        (0, 5), {"zoom": "0 to 5 s"},
    ),
    "good-snr-R2": (
        lambda p, s: [p.range_error(s, 1), p.range_error("measured", 1)],
        (5, 10), {"zoom": "5 to 10 s"},
    ),
    "follows-R1": (gates(0), (48, 50), {"end": "48 to 50 s"}),
    "follows-R2": (gates(1), (48, 50), {"end": "48 to 50 s"}),
    "gate-both": (
        lambda p, s: [p.range_error(s, 0), p.range_error(s, 0, box=(BOX[0], 1e6))],
        (46, 48), {"end": "46 to 48 s"},
    ),
    "gate-triangulation": (
        lambda p, s: [p.error(s, gated=gated) for gated in (False, True)],
        (46, 48), {"end": "46 to 48 s"},
    ),
    "gate-measurements": (
        lambda p, s: [
            p.error("measured"),
            np.where(p.ranges(s, 0)[1] & p.ranges(s, 1)[1], p.error("measured"), np.nan),
        ],
        (44, 46), {"end": "44 to 46 s"},
    ),
}  # fmt: skip


@pytest.mark.parametrize("settings", ["code", "text"])
@pytest.mark.parametrize("id", BY_ANOTHER_PROGRAM)
def test_another_program_finds_the_same(judged, program, id, settings):
    errors, window, at = BY_ANOTHER_PROGRAM[id]
    found = errors(program, settings)
    if id == "gate-measurements":  # runs weigh by their scans, so all at once
        inside = (program.t >= window[0] - 1e-9) & (program.t <= window[1] + 1e-9)
        a, b = (np.sqrt(np.nanmean(e[:, inside] ** 2)) for e in found)
        ratio, spread = a / b, 0.05 * a / b
    else:
        ratio, spread = program.ratio(*found, *window)
    same(judged(id, settings=settings, metric=RMS, **at), ratio, spread)


@pytest.mark.parametrize("settings", ["code", "text"])
def test_another_program_coasts_as_far(judged, program, settings):
    off = program.range_error(settings, 0)
    late, early = (
        np.mean(off[:, (program.t >= low - 1e-9) & (program.t <= low + 1 + 1e-9)] ** 2, axis=1)
        for low in (49, 47)
    )
    ratio = np.sqrt(late.mean() / early.mean())
    same(judged("coasting-grows", settings=settings, metric=RMS), ratio, 0.03 * ratio)


def drawn(ours, values):
    """Compare 95 % of our draws, and their median, with the quantiles of other ones."""
    spread = (ours.high - ours.low) / 4
    assert np.median(values) == pytest.approx(ours.value, abs=max(0.6 * spread, 1e-3))
    assert np.quantile(values, 0.025) == pytest.approx(ours.low, abs=max(1.2 * spread, 1e-3))


@pytest.mark.parametrize("misses", [3, 10, 30])
@pytest.mark.parametrize("length", [50.0, 60.0])
def test_another_program_leaves_at_the_same_times(judged, program, misses, length):
    """Medians of 150 runs have a tenth of the deviation of one, ends of 95 % four times it."""
    at = {"settings": "code", "misses": misses, "record": length}
    times = []
    for radar in (0, 1):
        used = program.ranges("code", radar)[1][:, program.t <= length + 1e-9]
        gone = ~np.lib.stride_tricks.sliding_window_view(used, misses, axis=1).any(axis=-1)
        times.append(np.where(gone.any(axis=1), gone.argmax(axis=1) * T, length))
        drawn(judged(f"R{radar + 1}-departs", **at), times[-1])
    later = (times[1] - times[0])[np.minimum(*times) < length]
    same(judged("R2-longer", **at), np.median(later), 1.25 * later.std() / np.sqrt(len(later)))


def reach(error, t, limit, average):
    """Return where the error, averaged over scans around, first is above a limit, after 5 s."""
    n = round(average / T)
    kernel = np.ones(n)
    behind = n - 1 - n // 2
    padded = np.pad(error, (n // 2, behind))
    mean = np.convolve(padded, kernel, "valid") / np.convolve(
        np.pad(np.ones_like(error), (n // 2, behind)), kernel, "valid"
    )
    above = np.flatnonzero((mean > limit) & (t >= 5.0))
    return 0.1 * np.sqrt(2) * (t[above[0]] if len(above) else t[-1])


@pytest.mark.parametrize("accuracy", [0.5, 2.0])
@pytest.mark.parametrize("settings", ["code", "text"])
def test_another_program_is_useful_as_far(judged, program, settings, accuracy):
    """Ratios of distances to 3 %: a quarter of a second of the thirty that they take."""
    at = {"settings": settings, "accuracy": accuracy, "average": 1.0}
    fifty = program.t <= 50 + 1e-9
    t, estimated = program.t[fifty], program.error(settings)[:, fifty]
    drawn(judged("useful-range", **at), [reach(e, t, accuracy, 1.0) for e in estimated])
    single = program.range_error(settings, 0)[:, fifty]
    far = [
        reach(np.sqrt(np.mean(e**2, axis=0)), t, accuracy, 1.0)
        for e in (program.error("measured")[:, fifty], estimated, single)
    ]
    assert judged("raw-range", **at).value == pytest.approx(far[0] / far[1], rel=0.03)
    assert judged("fusion-shortens", **at).value == pytest.approx(far[1] / far[2], rel=0.03)


@pytest.mark.parametrize("how", ["root mean square", "largest"])
def test_another_program_measures_positions_as_far_off(judged, program, how):
    """Medians and lower ends of 150 runs."""
    d = np.hypot(*program.p.T)
    measured, estimated = program.error("measured"), program.error("code")
    x = np.abs(meet(*(z[..., 0] for z in program.z))[..., 0] - program.p[:, 0])

    def off(error, at):
        some = error[:, at]
        return np.sqrt(np.mean(some**2, axis=1)) if how != "largest" else some.max(axis=1)

    at = {"read-off": how}
    drawn(judged("raw-near-simulated", **at), off(measured, (d >= 2) & (d <= 3)))
    near = np.hypot(*(program.p - 2.8).T) <= 0.1 + 1e-9
    drawn(judged("raw-at-four", **at, **{"at-four": 0.1}), off(x, near))
    for path, error in (("measured", measured), ("estimated", estimated)):
        drawn(
            judged("error-at-four-simulated", **at, path=path, **{"at-four": 0.25}),
            off(error, np.abs(d - 4) <= 0.25),
        )
        drawn(
            judged("raw-beyond-four", **at, path=path, **{"beyond-four": "4.5 to 5.0 m"}),
            off(error, (d >= 4.5) & (d <= 5)),
        )


@pytest.mark.parametrize("settings", ["code", "text"])
def test_another_program_filters_positions_as_badly(judged, program, settings):
    """A linear filter of positions (Table 3.1) against one of ranges with rates, no gates."""
    p = meet(*(z[..., 0] for z in program.z))
    F, big = np.kron([[1, T], [0, 1]], np.eye(2)), np.kron(Q[settings], np.eye(2))
    x, P = np.tile([0, 0.1, 0, 0], (len(p), 1)), 0.01 * np.eye(4)
    track = [x[:, :2]]
    for k in range(1, len(program.t)):
        x, P = x @ F.T, F @ P @ F.T + big
        K = P[:, :2] @ np.linalg.inv(P[:2, :2] + 0.04 * np.eye(2))
        x, P = x + (p[:, k] - x[:, :2]) @ K.T, P - K @ P[:2]
        track.append(x[:, :2])
    later = np.hypot(*np.moveaxis(np.stack(track, axis=1) - program.p, -1, 0))
    ratio, spread = program.ratio(program.error(settings, gated=False), later, 25, 40)
    values = {"rate": "ranges and rates", "first-step": "linear filter of Table 3.1"}
    found = judged("filter-first", settings=settings, metric=RMS, part="25 to 40 s", **values,
                   **{"angle-noise": 0.1})  # fmt: skip
    same(found, ratio, spread)


def test_errors_of_a_scan_are_those_of_the_closed_form_in_front(judged):
    """On the axis of symmetry: var x = 2 (d s / b)^2 and var y = 2 (d s / 2 y)^2."""

    def error(y, b, s=None):
        d = np.hypot(y, b / 2)
        s = sigma(np.array(d))[0] if s is None else s
        return np.sqrt(2) * d * s * np.sqrt(1 / b**2 + 1 / (4 * y**2))

    for y in (0.5, 1.0, 2.0):
        expected = error(y, 10.0) / error(y, 1.0)
        assert judged("radars-far-apart", **{"in-front": y}).value == pytest.approx(expected)
    for b in (0.1, 0.2, 0.3):
        expected = error(4.0, b) / error(4.0, 1.0)
        assert judged("radars-too-close", **{"too-close": b}).value == pytest.approx(expected)
    for decibels in (10.0, 5.0, 0.0):
        s, d = 0.15 / np.sqrt(2 * 10 ** (decibels / 10)), (52 - decibels) / 12
        for value, one in (("range", s), ("position", error(np.sqrt(d**2 - 0.25), 1.0, s))):
            for spread in (1.0, 3.0):
                found = judged("below-ten-db", value=value, below=decibels, spread=spread)
                assert found.value == pytest.approx(spread * one)
    found = judged("baseline", **{"baseline-error": "bound of one scan, position"})
    assert found.value == pytest.approx(error(4.0, 0.6) / error(4.0, 1.0))


def test_a_late_radar_moves_x_by_the_way_walked_meanwhile(judged):
    """The difference of two squares: (2 y w + w^2) / 2 b for the way w."""
    for delay in (0.5, 1.0):
        for seconds in (15.0, 20.0, 25.0):
            way = delay * 2.4 / seconds
            found = judged("offset-at-four", delay=delay, **{"walk-time": seconds})
            assert found == pytest.approx((8 * way + way**2) / 1.2)


def test_two_small_filters_take_fewer_products_than_a_large_one(judged):
    """Products of two square matrices, counted."""

    def products(n):
        return sum(1 for _ in np.ndindex(n, n, n))

    assert judged("filter-first-simpler").value == 2 * products(2) / products(4)


def test_an_elliptical_gate_of_these_settings_is_wider_in_range_than_the_box(judged):
    """And neither drops a detection of a target that creeps, nor takes a false one before it."""
    for settings in ("code", "text"):
        F, P = np.array([[1, T], [0, 1]]), np.eye(2)
        for _ in range(500):
            S = F @ P @ F.T + Q[settings] + np.diag(R[settings])
            P = np.linalg.inv(np.linalg.inv(S - np.diag(R[settings])) + np.diag(1 / R[settings]))
        assert np.sqrt(chi2.ppf(0.99, 2) * S[0, 0]) > BOX[0]
        found = judged("elliptical-gate", settings=settings, metric=RMS,
                       detections="the target's", **{"gate-level": 0.99})  # fmt: skip
        assert found.value == 1


@pytest.mark.parametrize("track", ["straight", "maneuver"])
def test_the_sequential_filter_has_the_errors_of_fixed_gains_along_the_track(judged, track):
    """To first order: gains and errors are those of a linear filter, with derivatives by steps.

    The target is not driven by Q, so that the covariance of the errors is not that of the filter.
    Both sides of the ratio are simulated on 75 runs; the sequential filter is the ideal one to a
    few percent.
    """
    states = {"straight": thesis.straight_track, "maneuver": thesis.maneuver_track}[track]
    truth, F = states(np.arange(100, 251) * T), np.kron([[1, T], [0, 1]], np.eye(2))
    noise, big, errors = np.diag([0.2, 0.1, 0.03]) ** 2, np.kron(Q["code"], np.eye(2)), {}
    for m in (2, 3):
        P = C = 0.01 * np.eye(4)
        total = 0.0
        for k in range(1, len(truth)):
            steps = 1e-6 * np.eye(4)
            H = ((h(truth[k] + steps) - h(truth[k] - steps)) / 2e-6).T[:m]
            np.testing.assert_allclose(H, jacobian(truth[k])[:m], atol=1e-6)
            P, C = F @ P @ F.T + big, F @ C @ F.T
            K = P @ H.T @ np.linalg.inv(H @ P @ H.T + noise[:m, :m])
            keep = np.eye(4) - K @ H
            P, C = keep @ P, keep @ C @ keep.T + K @ noise[:m, :m] @ K.T
            # The true target keeps its velocity but where it turns; the bias is next to nothing.
            total += np.trace(C[:2, :2])
        errors[m] = np.sqrt(total)
    at = {"track": track, "settings": "code", "rate-noise": 0.03, "angle-noise": 0.1, "metric": RMS}
    ideal = judged("sequential-ideal", **at).value
    found = judged("sequential-superior", **at, tracker="without the rate").value
    assert found / ideal == pytest.approx(errors[3] / errors[2], rel=0.05)
    at_once = judged("sequential-superior", **at, tracker="with the rate, all at once").value
    assert at_once / ideal == pytest.approx(1, abs=0.05)


@pytest.mark.parametrize("variant", ["turns outside", "stops at the edge"])
def test_a_walk_has_a_tenth_of_the_scans_and_less_of_a_baseline(judged, program, variant):
    """The same detections through the other program; 200 walks, to 15 %."""
    w = thesis.simulate_walk(200, rng=np.random.default_rng(7), variant=variant)
    Q1 = 0.1 * np.array([[1 / 3, 1 / 2], [1 / 2, 1]])
    start = w.ranges[:, 0].mean(axis=0)
    own = [kalman(w.detections[:, n], Q1, R["code"], T=1.0, start=start)[0] for n in (0, 1)]
    before, y = w.time < 25, w.truth[:, 1]
    follows = np.all([np.abs(d - w.ranges[n, :, 0])[:, before].max(axis=1) < BOX[0]
                      for n, d in enumerate(own)], axis=0)  # fmt: skip
    error = np.hypot(*np.moveaxis(meet(*own, 0.6) - w.truth[:, :2], -1, 0))[follows]
    real = np.sqrt(np.mean(error[:, before & (y > 4)] ** 2))
    d = np.hypot(*program.p.T)
    simulated = np.sqrt(np.mean(program.error("code")[:, (d > 4) & (d <= 4.5)] ** 2))
    assert judged("real-worse", variant=variant).value == pytest.approx(real / simulated, rel=0.2)
