"""Readings of Fig 3: the comparison finds what is put in, and says the same for other seeds."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from dopplerlib import RadarArray, crlb
from dopplerlib.systems import mittermaier2016 as paper

DRAWS = 16
PLANE = np.array([True, True, False, True, True, False])


@pytest.fixture(scope="module")
def published():
    return paper.reported().figure3


@pytest.fixture(scope="module", params=(41, 42))
def left(request):
    return {"one sample": paper.error_map(DRAWS, rng=np.random.default_rng(request.param))}


@pytest.fixture(scope="module")
def drawn():
    """Return a map of one draw, as a paper has it."""
    return paper.error_map(1, rng=np.random.default_rng(45))


@pytest.fixture(scope="module")
def right():
    rng = np.random.default_rng(43)
    return {
        name: paper.error_map(6, rng=rng, samples=10, likelihood=name)
        for name in ("stationary", "constant_velocity")
    }


@pytest.mark.parametrize(
    ("orientation", "axis", "velocity"),
    [
        ("as published", "y", (-1, 1)),
        ("v_x reversed", "y", (1, 1)),
        ("array turned", "x", (-1, 1)),
        ("all turned", "x", (1, 1)),
    ],
)
def test_an_orientation_is_the_map_of_that_array_and_velocity(
    published, orientation, axis, velocity
):
    """Computed anew for an array along x, where the library turns the map of one along y."""
    bound = paper.error_map_bound(
        samples=10, likelihood="constant_velocity"
    )  # that of one is symmetric
    seen = paper.ORIENTATIONS[orientation](bound)
    array = RadarArray.linear(5, 0.4, axis=axis)
    off_axes = [i for i in range(39) if i != 19]
    for i, j in np.random.default_rng(44).choice(off_axes, (40, 2)):
        x = [published.x[i], published.y[j], 0, *np.multiply(np.sqrt(2), velocity), 0]
        P = crlb(x, array, published.sigma_f, 10, published.T, "constant_velocity", free=PLANE)
        # The inverse of a nearly singular matrix has lost half of the digits.
        assert seen[i, j] == pytest.approx(np.sqrt(P[0, 0] + P[1, 1]), rel=1e-6)


def test_a_score_is_the_logarithm_of_a_distribution(published):
    """The chance to be below the lowest contour and the density above it add up to one."""
    error = np.full((39, 39, 5), np.geomspace(0.01, 0.3, 5))
    place, step = (3, 5), 0.004
    total, values = 0.0, 10 ** np.arange(np.log10(0.025) + step / 2, np.log10(25), step)
    density = []
    for value in (None, *values):
        maps, below = np.full((2, 39, 39), 1.0), np.zeros((2, 39, 39), bool)
        maps[0][place], below[0][place] = (np.nan, True) if value is None else (value, False)
        score = paper.map_score(error, replace(published, error=maps, below=below), 0)[place]
        density.append(np.exp(score))
    total = density[0] + step * np.sum(density[1:])
    # Sums at the middle of steps much smaller than the kernel.
    assert total == pytest.approx(1, abs=1e-3)


def test_the_lines_on_which_sensors_may_stand_are_left_out(published, left):
    (ours,) = left.values()
    score = paper.map_score(ours.position, published, 0)
    hidden = np.isnan(published.error[0]) & ~published.below[0]
    hidden[19] = hidden[:, 19] = True
    assert_array_equal(np.isnan(score), hidden)


@pytest.mark.parametrize("quantity", ["position", "state"])
@pytest.mark.parametrize("orientation", list(paper.ORIENTATIONS))
def test_a_map_that_we_draw_ourselves_is_recognized(published, left, drawn, orientation, quantity):
    """By five deviations. State and velocity are told apart less well: mostly they are one."""
    error = paper.ORIENTATIONS[orientation](getattr(drawn, quantity))[..., 0]
    below = error < published.lowest
    known = np.where(below, np.nan, error)
    own = replace(published, error=np.stack([known] * 2), below=np.stack([below] * 2))
    best, *others = paper.map_readings(left, own, 0)
    assert best.orientation == orientation
    assert best.behind == best.deviation == 0
    assert (best.quantity == "position") == (quantity == "position")
    for other in others:
        if other.orientation != orientation:
            assert other.behind > 5 * other.deviation


@pytest.mark.parametrize("width", [0.1, 0.15, 0.25])
def test_the_left_map_is_one_of_position_errors_turned_by_a_quarter(published, left, width):
    """For two seeds and three kernels: every other reading is over two deviations worse."""
    best, *others = paper.map_readings(left, published, 0, width=width)
    assert (best.orientation, best.quantity) == ("all turned", "position")
    assert all(other.behind > 2 * other.deviation > 0 for other in others)
    published = next(
        o for o in others if (o.orientation, o.quantity) == ("as published", "position")
    )
    assert published.behind > 4 * published.deviation


@pytest.mark.parametrize("width", [0.1, 0.15, 0.25])
def test_the_right_map_is_turned_too_and_its_estimator_knew_that_the_target_moves(
    published, right, width
):
    readings = paper.map_readings(right, published, 1, width=width)
    best = readings[0]
    assert (best.orientation, best.label) == ("all turned", "constant_velocity")
    for other in readings:
        if other.label == "stationary" or other.orientation in ("as published", "array turned"):
            assert other.behind > 5 * other.deviation


def test_the_bad_corners_are_those_of_the_turned_velocity(published, left):
    """The text says top right and bottom left; the published velocity makes them the other two."""
    (ours,) = left.values()
    x, y = published.x[:, None], published.y
    far = (np.abs(x) > 0.3) & (np.abs(y) > 0.3) & paper.comparable(published, 0)

    def excess(error):
        """Share of errors above 0.2 m at the top right and bottom left, less the others."""
        there, elsewhere = (
            paper.fraction_above(error, [0.2], far & (sign * x * y > 0)).mean() for sign in (1, -1)
        )
        return there - elsewhere

    # 676 places in either pair of corners: a standard error of 2 % for one draw of each.
    assert excess(published.error[0][..., None]) > 0.06
    for name, turn in paper.ORIENTATIONS.items():
        expected = -1 if name in ("as published", "array turned") else 1
        assert expected * excess(turn(ours.position)) > 0.06


def test_neither_position_nor_state_gives_the_shares_of_the_right_map(published, right):
    """One is too small at 5 cm, the other too large at 20 cm, by more than all of our draws."""
    turn = paper.ORIENTATIONS["all turned"]
    position, state = (
        turn(right["constant_velocity"].position),
        turn(right["constant_velocity"].state),
    )
    known = paper.comparable(published, 1)
    assert not np.isnan(position[known]).any()
    theirs = paper.fraction_above(published.error[1], [0.05, 0.2], known)
    assert paper.fraction_above(position, [0.05], known).max() < theirs[0]
    assert paper.fraction_above(state, [0.2], known).min() > theirs[1]


def test_what_cannot_be_compared_is_refused(published, left, drawn):
    (ours,) = left.values()
    with pytest.raises(ValueError, match="maps must have the same number of draws"):
        paper.map_readings({"a": ours, "b": drawn}, published, 0)
    with pytest.raises(ValueError, match="error must have shape"):
        paper.map_score(ours.position[1:], published, 0)


def test_turning_twice_is_half_a_turn():
    values = np.arange(9).reshape(3, 3)
    turn = paper.ORIENTATIONS["all turned"]
    assert_allclose(turn(turn(values)), values[::-1, ::-1])
