"""Numbers of Fig 3 that are judged, by another route: loops over places, other derivatives."""

import csv
from statistics import NormalDist, geometric_mean, median

import numpy as np
import pytest
from scipy.stats import norm as normal

from dopplerlib import doppler_shift
from dopplerlib._data import data
from dopplerlib.systems import mittermaier2016 as paper
from dopplerlib.systems.mittermaier2016.evidence import _maps as evidence
from tests.sweeps import narrowed

RECORDS = "one sample", "ten, constant state", "ten, constant velocity"
BOTH = ("stationary", "constant_velocity")
ALL = {
    "figure3_record": RECORDS,
    "likelihood": BOTH,
    "norm": ("position", "state"),
    "figure3_axis": ("y", "x"),
    "figure3_room": (2.0,),
    "figure3_kernel": (0.15,),
    "figure3_level": (0.1,),
    "figure3_longer": (20,),
    "figure3_measure": ("bound", "errors"),
    "similar_places": ("over the plane", "between mirrored places"),
    "covariance_panel": ("left", "right"),
    "covariance_statistic": ("mean", "median"),
    "accuracy": (0.078,),
}


@pytest.fixture(scope="module")
def both():
    """Return the evidence, and the maps from which it was taken."""
    maps, make = {}, evidence._map

    def kept(rng, room, record):
        maps[record] = make(rng, room, record)
        return maps[record]

    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(evidence, "_map", kept)
        patched.setattr(evidence, "_DRAWS", 3)
        choice = narrowed("mittermaier2016", **ALL)
        return evidence.map_evidence(choice, np.random.default_rng(5)), maps


@pytest.fixture(scope="module")
def found(both):
    return both[0]


@pytest.fixture(scope="module")
def maps(both):
    return both[1]


@pytest.fixture(scope="module")
def drawn():
    """Return the two drawn maps, by place in steps of 5 cm: the error and its flag."""
    panels = []
    for side in ("left", "right"):
        with data("mittermaier2016", f"fig3_{side}.csv").open(encoding="utf-8") as file:
            rows = [row for row in csv.DictReader(file)]
        panels.append(
            {
                (round(20 * float(r["x_m"])), round(20 * float(r["y_m"]))): (
                    float(r["error_m"]),
                    int(r["flag"]),
                )
                for r in rows
            }
        )
    return panels


def numbers(pieces):
    return {at: getattr(one, "value", one) for at, one in pieces.points.items()}


PLACES = [(a, b) for a in range(-19, 20) for b in range(-19, 20)]


def at(values, place):
    return values[place[0] + 19, place[1] + 19]


def bounds(samples, moving, signs=(1, 1)):
    """Return bounds on the position by place, by differences of the shifts of four unknowns."""
    p = paper.reported().figure3
    state = np.zeros((len(PLACES), 6))
    state[:, :2] = np.array(PLACES) / 20 + 1e-12
    state[:, 3:5] = p.velocity[:2] * signs
    clear = state[:, 0] ** 2 > 1e-6
    slopes = []
    for i in (0, 1, 3, 4):
        pair = []
        for step in (1e-5, -1e-5):
            x = state[clear] + step * np.eye(6)[i]
            path = np.repeat(x[:, None], samples, axis=1)
            if moving:
                path[..., :3] += p.T * np.arange(samples)[:, None] * path[..., 3:]
            pair.append(doppler_shift(path, p.array).reshape(len(x), -1))
        slopes.append((pair[0] - pair[1]) / 2e-5)
    _, r = np.linalg.qr(np.stack(slopes, axis=-1))
    inverse = np.linalg.inv(r)
    bound = np.full(len(PLACES), np.nan)
    bound[clear] = p.sigma_f * np.sqrt(np.sum(inverse[:, :2] ** 2, axis=(1, 2)))
    return dict(zip(PLACES, bound, strict=True))


@pytest.fixture(scope="module")
def moving():
    return bounds(10, True)


@pytest.fixture(scope="module")
def single():
    return bounds(1, False)


def test_a_covariance_from_a_map_is_that_of_few_places(found, drawn):
    ours = numbers(found["covariance-from-figure3"])
    for name, panel in zip(("left", "right"), drawn, strict=True):
        squares = [0.0 if flag == 2 else e**2 / 2 for e, flag in panel.values() if flag != 3]
        assert ours[name, "mean"] == pytest.approx(sum(squares) / len(squares), rel=1e-9)
        assert ours[name, "median"] == pytest.approx(median(squares), rel=1e-9, abs=1e-15)
        assert sum(sorted(squares)[-15:]) > 0.5 * sum(squares)  # a hundredth of the places


def test_the_drawn_maps_improve_at_seven_of_eight_places(found, drawn):
    sensors = {(a, b) for a in (-4, -2, 0, 2, 4) for b in (0,)}
    sensors |= {(b, a) for a, b in sensors}
    improved = []
    for place in PLACES:
        pairs = [panel[place] for panel in drawn]
        if place in sensors or 3 in (flag for _, flag in pairs) or all(f == 2 for _, f in pairs):
            continue
        left, right = (0.025 if flag == 2 else e for e, flag in pairs)
        improved.append(right < left)
    assert found["figure3-improves-drawn"] == pytest.approx(np.mean(improved), rel=1e-9)


def contrast(error):
    """Return the mean ratio of errors at places with x y > 0 to those with -x."""
    ratios = [
        error(a, b) / error(-a, b)
        for a, b in PLACES
        if a * b > 0 and np.isfinite(error(a, b)) and np.isfinite(error(-a, b))
    ]
    return geometric_mean(ratios)


def test_the_drawn_corners_are_worse_place_by_place(found, drawn):
    def shown(a, b):
        error, flag = drawn[0][a, b]
        return 0.025 if flag == 2 else error

    assert found["figure3-areas-drawn"].value == pytest.approx(contrast(shown), rel=1e-9)


@pytest.mark.parametrize("norm", ["position", "state"])
@pytest.mark.parametrize("axis", ["y", "x"])
def test_corners_are_compared_place_by_place(found, maps, axis, norm):
    """Sensors along x, with the same velocity: reflected at the diagonal along which it points."""
    error = getattr(maps["one sample"], norm)
    expected = [
        contrast(lambda a, b, i=i: at(error, (a, b) if axis == "y" else (-b, -a))[i])
        for i in range(3)
    ]
    ours = numbers(found["figure3-areas"])[axis, norm, 2.0]
    assert ours == pytest.approx(geometric_mean(expected), rel=1e-6)


def test_opposite_places_have_the_same_bound_but_for_the_way_of_the_target(found, moving):
    symmetric, mirrored = (numbers(found[f"figure3-{k}"]) for k in ("symmetric", "mirrored"))
    for name in RECORDS[:2]:
        assert symmetric[name,] < 1e-4
    apart = [abs(moving[-a, -b] / moving[a, b] - 1) for a, b in PLACES if a]
    assert symmetric["ten, constant velocity",] == pytest.approx(median(apart), rel=1e-3)
    assert max(mirrored.values()) < 1e-4


def test_another_direction_moves_the_bad_regions_of_moving_targets_only(found, moving, single):
    ours = numbers(found["figure3-velocity"])
    there = contrast(lambda a, b: moving[a, b])
    expected = max(there, 1 / there) - 1
    assert ours["ten, constant velocity", "bound", 2.0] == pytest.approx(expected, rel=1e-3)
    assert ours["one sample", "bound", 2.0] < 1e-4
    flat = contrast(lambda a, b: single[a, b])
    assert flat == pytest.approx(1, abs=1e-3)


def test_similar_shifts_go_with_distance(found, moving, single):
    ours = numbers(found["figure3-similar"])
    p = paper.reported().figure3
    spread = {}
    for a, b in PLACES:
        if a:
            h = doppler_shift(np.r_[a / 20, b / 20, 0, p.velocity], p.array)
            spread[a, b] = np.sqrt(np.mean((h - h.mean()) ** 2))
    middle = median(spread.values())
    for record, bound in (("one sample", single), ("ten, constant velocity", moving)):
        some = geometric_mean([bound[k] for k, s in spread.items() if s < middle])
        others = geometric_mean([bound[k] for k, s in spread.items() if s >= middle])
        assert ours[record, "bound", 2.0, "over the plane"] == pytest.approx(
            some / others, rel=1e-3
        )
        pairs = [
            bound[a, b] / bound[-a, b] for a, b in spread if spread[a, b] < spread[-a, b] - 1e-9
        ]
        assert ours[record, "bound", 2.0, "between mirrored places"] == pytest.approx(
            geometric_mean(pairs), rel=1e-3
        )


def log_likelihood(error, panel, place):
    """Return that of a drawn value under three draws, smoothed by 0.15 powers of ten."""
    value, flag = panel[place]
    draws = np.log10(error)
    if flag == 2:
        kernel = NormalDist(0, 0.15)
        chance = np.mean([kernel.cdf(np.log10(0.025) - d) for d in draws])
        return np.log(0.98 * chance + 0.01)
    density = normal.pdf(np.log10(value), draws, 0.15).mean()
    return np.log(0.98 * density + 0.02 / 6)


ROTATIONS = {  # places of our map whose errors stand at (a, b) in the reading
    "as published": lambda a, b: (a, b),
    "v_x reversed": lambda a, b: (-a, b),
    "array turned": lambda a, b: (-b, -a),
    "all turned": lambda a, b: (-b, a),
}


def test_a_map_of_ours_is_recognized_by_its_quantity(found, maps, drawn):
    """Sums over places of the drawn values' likelihood, for both maps."""
    quantity, published = (numbers(found[f"figure3-{k}"]) for k in ("quantity", "as-published"))
    for record, panel in (("one sample", drawn[0]), ("ten, constant velocity", drawn[1])):
        places = [k for k in PLACES if k[0] and k[1] and panel[k][1] != 3]
        best, loss = {}, {}
        for norm in ("position", "state"):
            error = getattr(maps[record], norm)
            scores = {
                name: [log_likelihood(at(error, turn(*k)), panel, k) for k in places]
                for name, turn in ROTATIONS.items()
            }
            best[norm] = max(scores.values(), key=sum)
            loss[norm] = sum(best[norm]) - sum(scores["as published"])
            assert published[record, norm, 0.15, 2.0] == pytest.approx(loss[norm], rel=1e-6)
        behind = np.subtract(best["position"], best["state"])
        ours = found["figure3-quantity"].points[record, 0.15, 2.0]
        assert quantity[record, 0.15, 2.0] == pytest.approx(behind.sum(), rel=1e-6)
        reach = 1.96 * np.sqrt(len(places) * np.var(behind))
        assert ours.high - ours.value == pytest.approx(reach, rel=1e-6)


@pytest.mark.parametrize("norm", ["position", "state"])
def test_shares_are_those_of_single_maps(found, maps, drawn, norm):
    """A map combined from draws has the mean share of single ones; 500 are good to 0.2 %."""
    cases = [("left", drawn[0], "one sample", (0.1, norm, 2.0))]
    cases += [
        ("right", drawn[1], f"ten, constant {k}", (likelihood, 0.1, norm, 2.0))
        for likelihood, k in zip(BOTH, ("state", "velocity"), strict=True)
    ]
    for side, panel, record, where in cases:
        known = [k for k in PLACES if panel[k][1] != 3]
        piece = found[f"figure3-{side}-share"].points[where]
        assert piece.published == pytest.approx(
            100 * np.mean([panel[k][1] != 2 and panel[k][0] > 0.1 for k in known])
        )
        above = [np.mean(at(getattr(maps[record], norm), k) > 0.1) for k in known]
        assert np.mean(piece.values) == pytest.approx(100 * np.mean(above), abs=0.2)


def test_improved_places_are_those_of_smaller_medians(found, maps):
    for likelihood, k in zip(BOTH, ("state", "velocity"), strict=True):
        ten = maps[f"ten, constant {k}"]
        for norm in ("position", "state"):
            pairs = [
                (
                    median(at(getattr(ten, norm), q)),
                    median(at(getattr(maps["one sample"], norm), q)),
                )
                for q in PLACES
                if np.isfinite(at(ten.position, q)).all()
            ]
            where = likelihood, norm, 2.0
            improved = sum(many < few for many, few in pairs) / len(pairs)
            assert numbers(found["figure3-improves"])[where] == pytest.approx(improved)
            ratio = median(many / few for many, few in pairs)
            assert numbers(found["figure3-better"])[where] == pytest.approx(ratio, rel=0.01)
        position = [e for q in PLACES for e in at(ten.position, q) if np.isfinite(e)]
        near = sum(e < 0.078 for e in position) / len(position)
        assert numbers(found["start-reliable-line"])[likelihood, 2.0, 0.078] == pytest.approx(near)


def test_longer_records_help_as_the_bound_says(found, moving):
    """Of moving targets; errors of one draw scatter by a factor of three, a median of 1500 less."""
    longer = bounds(20, True)
    expected = median(longer[k] / moving[k] for k in PLACES if k[0])
    ours = numbers(found["figure3-longer"])
    for norm in ("position", "state"):
        assert ours["constant_velocity", 2.0, 20, norm] == pytest.approx(expected, rel=0.25)
        assert ours["stationary", 2.0, 20, norm] > 1
