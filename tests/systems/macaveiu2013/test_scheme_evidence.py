"""The numbers judged for Section III, by loops, by hand, and from the saved files line by line."""

import csv
from math import erf, hypot, sqrt

import numpy as np
import pytest

from dopplerlib import gnn_assign
from dopplerlib._data import read_lines, results
from dopplerlib.evaluation.intervals import mean_interval, proportion_interval
from dopplerlib.model.motion import ncv_transition
from dopplerlib.model.polar_radar import polar_radar_h
from dopplerlib.systems import macaveiu2013 as paper
from dopplerlib.systems.macaveiu2013.evidence import _scheme as found
from dopplerlib.tracking.association import greedy_assign

S = paper.automotive_settings()
VARIANTS = dict(enumerate(paper.processing_study.VARIANTS, start=1))


@pytest.fixture(scope="module")
def judged():
    """Return the judged numbers; those that are swept as functions of a place."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(found, "sweep", lambda choices, function: function)
        return found.found(np.random.default_rng(1))


def test_differences_leave_one_direction_open(judged):
    """Differences of range, azimuth and range rate for steps of the four components."""
    x, steps = np.array([5.0, 1.0, 5.0, 1.0]), 1e-5 * np.eye(4)
    J = np.stack([(polar_radar_h(x + d) - polar_radar_h(x - d)) / 2e-5 for d in steps], axis=-1)
    assert np.linalg.matrix_rank(J, tol=1e-6) == 3
    assert judged["all-measured"] == 3


@pytest.mark.parametrize("sigma_phi", [0.009, 0.035])
@pytest.mark.parametrize("figure", [7, 8, 10])
def test_noise_of_range_and_azimuth_turned_into_x_and_y_is_correlated(figure, sigma_phi):
    """40 000 draws at every place where it may be largest: deviation 0.005, 5 of them."""
    rng, largest = np.random.default_rng(2), 0.0
    for x, _, y, _ in paper.vehicle_paths()[figure].truth[::33]:
        r = hypot(x, y) + 0.25 * rng.standard_normal(40_000)
        azimuth = np.arctan2(x, y) + sigma_phi * rng.standard_normal(40_000)
        seen = np.stack([r * np.sin(azimuth), r * np.cos(azimuth)])
        largest = max(largest, abs(np.corrcoef(seen)[0, 1]))
    assert found.correlation(figure, sigma_phi) == pytest.approx(largest, abs=0.03)


@pytest.mark.parametrize(("limit", "sigma"), [(0.164, 0.1), (0.3, 0.164), (0.164, 0.164)])
def test_the_clutter_rule_deletes_the_fraction_that_is_drawn(limit, sigma):
    """The error function, and 20 000 detections of what stands: 5 deviations, chance 6e-7."""
    by_hand = erf(limit / sigma / sqrt(2))
    assert found.removed(limit, sigma) == pytest.approx(by_hand)
    z = np.tile([30.0, 0.0, 0.0], (20_000, 1))
    z[:, 2] += sigma * np.random.default_rng(3).standard_normal(len(z))
    share = 1 - paper.is_moving(z, limit).mean()
    assert share == pytest.approx(by_hand, abs=5 * sqrt(by_hand * (1 - by_hand) / len(z)))


@pytest.mark.parametrize("limit", [0.164, 0.3, 0.5])
def test_the_target_of_figure_8_is_hidden_while_it_is_in_front(limit):
    """|x| / r is below limit / v on a stretch of the line y = 20 m; a scan is 5 cm of it."""
    v = 5 / 3.6
    width = 2 * 20 * (limit / v) / sqrt(1 - (limit / v) ** 2)
    assert found.deleted_scans(limit) == pytest.approx(width / (v * S.T), abs=1)


def test_from_a_moving_car_nothing_in_view_stands_still():
    """10 000 detections within the view; from a car that creeps some are below the limit."""
    rng = np.random.default_rng(4)
    azimuth = rng.uniform(-found.VIEW, found.VIEW, 10_000)
    noise = 0.1 * rng.standard_normal((2, 10_000))
    for speed, limit in ((2.8, 0.5), (0.4, 0.3), (0.2, 0.164)):
        moving = np.mean(np.abs(speed * np.cos(azimuth) + noise[0]) < limit)
        standing = np.mean(np.abs(noise[1]) < limit)
        ratio = found.uncompensated(speed, limit)
        assert ratio == pytest.approx(moving / standing, abs=0.03)  # 5 deviations and a little


def naive_objects(z, box):
    """Return the object of each detection: from near to far, who is free and in the box."""
    member = {}
    for i in sorted(range(len(z)), key=lambda i: z[i][0]):
        if i not in member:
            number = len(set(member.values()))
            for j in range(len(z)):
                if j not in member and all(abs(z[i][c] - z[j][c]) <= box[c] for c in range(3)):
                    member[j] = number
    return member


@pytest.mark.parametrize(("figure", "size"), [(7, 0.67), (9, 1.0), (8, 1.5)])
def test_objects_are_those_of_a_loop_over_detections(figure, size):
    """Other records of the same path; intervals of 95 % twice as wide, chance 1e-7."""
    box, together = [size * one for one in (4.5, 0.25, 0.5)], []
    for rng in np.random.default_rng(5).spawn(3):
        for scan in paper.simulate_scans(paper.vehicle_paths()[figure].truth[::5], rng=rng):
            member = naive_objects(scan.z.tolist(), box)
            own = [member[i] for i, source in enumerate(scan.source) if source == paper.TARGET]
            if len(own) > 1:
                together.append(own.count(own[0]) == len(own))
    one = found.grouping(np.random.default_rng(6))(figure, size)
    other = proportion_interval(together)
    assert abs(one.value - other.value) < one.high - one.low + other.high - other.low
    assert 0.02 < 1 - other.value < 0.98


def lines(**at):
    """Return the lines of the saved tracks for a figure or a variant, as dicts of float."""
    rows = csv.DictReader(read_lines("vehicle_tracking.tracks.csv", folder=results))
    rows = [{key: float(value) for key, value in row.items()} for row in rows]
    for row in rows:
        row["variant"] = VARIANTS[row["variant"]]
    return [row for row in rows if all(row[key] == value for key, value in at.items())]


def test_the_saved_study_read_line_by_line(judged):
    plain = lines(variant="as in Fig 6")
    begun = np.mean([row["begun"] - row["tracks"] for row in plain])
    assert judged["false-candidates"].value == pytest.approx(begun) and len(plain) == 1000
    for rule, variant in (("4 hits of 6", "as in Fig 6"), ("8 hits of 10", "8 hits of 10")):
        share = np.mean([row["false"] >= 1 for row in lines(variant=variant, figure=9)])
        assert judged["false-tracks"](rule).value == pytest.approx(share)
    for place, variant in {
        ("a car", "all"): "as in Fig 6",
        ("a car", "those of new tracks"): "rule for new tracks only",
        ("a pedestrian", "all"): "pedestrian as in Fig 6",
        ("a pedestrian", "those of new tracks"): "pedestrian with rule for new tracks only",
    }.items():
        rows = lines(variant=variant)
        shares = [
            np.mean([row["held"] / 500 for row in rows if row["figure"] == figure])
            for figure in {row["figure"] for row in rows}
        ]
        assert len(shares) == (5 if place[0] == "a car" else 2)
        assert judged["target-tracked"](*place).value == pytest.approx(min(shares))


def crossings(angle, rule, velocity, runs, seed):
    """Return which runs end exchanged, and in which both tracks are on one target, by loops."""
    truth = paper.crossing_paths(np.deg2rad(angle))
    rng = np.random.default_rng(seed)
    F, part = ncv_transition(S.T), slice(None) if velocity else slice(0, None, 2)
    exchanged, lost, gains, P, R = [], [], [], S.E_z, S.E_z
    for _ in range(1, truth.shape[1]):  # does not depend on what is measured
        P = F @ P @ F.T + S.E_x
        K = P @ np.linalg.inv(P + R)
        gains.append((np.linalg.inv((P + R)[part, part]), K.T))
        P = P - K @ P
    for _ in range(runs):
        z = truth + rng.standard_normal(truth.shape) * np.tile([S.sigma_x, S.sigma_v], 2)
        x = z[:, 0].copy()
        for k, (inverse, gain) in enumerate(gains, 1):
            x = x @ F.T
            nu = z[None, :, k] - x[:, None]
            own = nu[..., part]
            taken = rule(np.sum((own @ inverse) * own, axis=-1))
            x = x + nu[range(len(x)), taken] @ gain
        nearest = np.linalg.norm((x[:, None] - truth[:, -1])[..., ::2], axis=-1).argmin(axis=1)
        exchanged.append(nearest.tolist() == [1, 0])
        lost.append(nearest[0] == nearest[1])
    return np.array(exchanged, float), np.array(lost, float)


RULES = {
    "Hungarian": lambda cost: gnn_assign(cost, 1e6),
    "greedy": lambda cost: greedy_assign(cost, 1e6),
    "each its nearest": lambda cost: cost.argmin(axis=1),
}


@pytest.mark.parametrize(
    ("failure", "rule", "angle", "compared"),
    [
        ("tracks exchanged", "greedy", 20, "positions"),
        ("both tracks on one target", "each its nearest", 10, "positions and velocities"),
    ],
)
def test_crossing_targets_by_loops_and_general_assignments(failure, rule, angle, compared):
    """25 records of other noise: differences of 0.5 and -0.8, deviations of 0.1 and 0.09."""
    which, velocity = failure != "tracks exchanged", compared != "positions"
    share = [crossings(angle, RULES[name], velocity, 25, 7)[which] for name in ("Hungarian", rule)]
    other = mean_interval(share[0] - share[1])
    more = found.comparison(np.random.default_rng(8))
    one = more(failure, rule, angle, compared)
    assert abs(one.value - other.value) < one.high - one.low + other.high - other.low
    assert abs(one.value) > 0.25 and one.low * one.high > 0
    without = more(failure, rule, 40, "positions and velocities").value
    assert abs(without) < abs(one.value) - 0.1
