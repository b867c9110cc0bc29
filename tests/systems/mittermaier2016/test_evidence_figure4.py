"""Numbers of Fig 4 that are judged, by another route: the file of dots, simulated starts."""

import csv
from statistics import fmean, geometric_mean

import numpy as np
import pytest

from dopplerlib._data import data
from dopplerlib.systems import mittermaier2016 as paper
from dopplerlib.systems.mittermaier2016.evidence._figure4 import figure4_evidence
from tests.sweeps import narrowed

SHARED = "one for all places", "one for each place"
LIKELIHOODS = "stationary", "constant_velocity"
KIND = "direction 0.75"
ALL = {
    "dot": ("each dot", "mean of a level"),
    "sweep_velocity": (KIND,),
    "sweep_shared": SHARED[:1],
    "likelihood": LIKELIHOODS,
    "sweep_box": ("wide", "region"),
    "small_noise": (0.1,),
}


@pytest.fixture(scope="module")
def found():
    return figure4_evidence(narrowed("mittermaier2016", **ALL), np.random.default_rng(3))


@pytest.fixture(scope="module")
def dots():
    """Return the drawn errors by part and variance."""
    parts = {}
    for part in ("position", "velocity"):
        levels = parts.setdefault(part, {})
        with data("mittermaier2016", f"fig4_{part}.csv").open(encoding="utf-8") as file:
            for row in csv.DictReader(file):
                levels.setdefault(float(row["variance_hz2"]), []).append(float(row["error"]))
    return parts


def test_what_the_dots_say(found, dots):
    for part, levels in dots.items():
        assert {len(errors) for errors in levels.values()} == {found["figure4-dots"]}
        ours = found[f"figure4-{part}"].points
        assert ours["each dot",] == max(max(errors) for errors in levels.values())
        assert ours["mean of a level",] == pytest.approx(max(map(fmean, levels.values())))
    ends = [min(levels) ** 0.5, max(levels) ** 0.5]
    np.testing.assert_allclose(found["figure4-noise"], ends)


@pytest.mark.parametrize("likelihood", LIKELIHOODS)
def test_small_noise_leaves_the_mean_of_the_bound(found, dots, likelihood):
    """Starts that are simulated at 0.03 Hz; means of twelve are good to 2 and 4 percent."""
    speed = 0.75, 0.75
    reading = paper.SweepReading("direction", speed, likelihood=likelihood)
    rng = np.random.default_rng(4)
    ours = paper.run_noise_sweep([8], 12, rng=rng, reading=reading, bound=False)
    for part, within in (("velocity", 0.05), ("position", 0.12)):
        expected = geometric_mean(getattr(ours, part)[0]) / ours.variance[0] ** 0.5
        piece = found[f"figure4-slope-{part}"].points[KIND, SHARED[0], likelihood, 0.1]
        assert np.median(piece.values) == pytest.approx(expected, rel=within)
        small = [
            error / variance**0.5
            for variance, errors in dots[part].items()
            if variance < 0.0101
            for error in errors
        ]
        assert piece.published == pytest.approx(geometric_mean(small), rel=1e-9)
    if likelihood == "stationary":
        constant = found["figure4-constant-state"].points[KIND, SHARED[0], 0.1]
        slope = piece_of(found, "velocity", likelihood)
        assert np.median(constant.values) == pytest.approx(np.median(slope), rel=0.01)


def piece_of(found, part, likelihood):
    return found[f"figure4-slope-{part}"].points[KIND, SHARED[0], likelihood, 0.1].values


def test_twenty_sequences_scatter_as_their_velocities_do(found):
    """Means of twenty; deviations of 40 sequences are good to 11 %, and dots add a little."""
    reading = paper.SweepReading("direction", (0.75, 0.75))
    position, _ = paper.sweep_bounds(60, rng=np.random.default_rng(6), reading=reading)
    alone = np.log(position).std() / 20**0.5
    values = np.log(piece_of(found, "position", "constant_velocity"))
    assert values.std() == pytest.approx(alone, rel=0.4)
    own = paper.SweepReading("direction", (0.75, 0.75), shared=False)
    each, _ = paper.sweep_bounds(20, rng=np.random.default_rng(6), reading=own)
    assert np.log(each).std() / 20**0.5 < 0.2 * alone


@pytest.mark.parametrize("box", ["wide", "region"])
@pytest.mark.parametrize("likelihood", LIKELIHOODS)
def test_large_noise_meets_the_walls(found, dots, likelihood, box):
    """From other random numbers; ten dots each, and 4.5 standard errors of their difference."""
    reading = paper.SweepReading("direction", (0.75, 0.75), likelihood=likelihood, box=box)
    ours = paper.run_noise_sweep([30], 6, rng=np.random.default_rng(7), reading=reading)
    for part in ("position", "velocity"):
        errors = getattr(ours, part)[0]
        where = KIND, SHARED[0], likelihood, box
        piece = found[f"figure4-limit-{part}"].points[where]
        error = np.hypot((piece.high - piece.value) / 2, errors.std(ddof=1) / 6**0.5)
        assert abs(piece.value - errors.mean()) < 4.5 * error
        bend = found[f"figure4-bend-{part}"].points[where]
        slope = np.median(piece_of(found, part, likelihood))
        assert np.median(bend.values) == pytest.approx(piece.value / slope, rel=0.15)
        low, high = dots[part][min(dots[part], key=lambda v: abs(v - 1))], []
        for variance, errors in dots[part].items():
            high += [e / variance**0.5 for e in errors] if variance < 0.0101 else []
        assert bend.published == pytest.approx(geometric_mean(low) / geometric_mean(high))
