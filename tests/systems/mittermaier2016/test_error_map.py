"""Fig 3: what is read off it, our maps beside their bound, and the symmetries of both."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from dopplerlib import RadarArray, crlb
from dopplerlib.systems import mittermaier2016 as paper

DRAWS = 6
PLANE = np.array([True, True, False, True, True, False])


@pytest.fixture(scope="module")
def published():
    return paper.reported().figure3


@pytest.fixture(scope="module")
def one():
    """Return our map from one sample."""
    return paper.error_map(DRAWS, rng=np.random.default_rng(31))


@pytest.fixture(scope="module")
def ten():
    """Return our map from ten samples of a target that moves, and is assumed to."""
    return paper.error_map(
        DRAWS, rng=np.random.default_rng(32), samples=10, likelihood="constant_velocity"
    )


def places(published, sensors):
    """Return the grid index of every sensor."""
    return [
        (int(np.abs(published.x - s[0]).argmin()), int(np.abs(published.y - s[1]).argmin()))
        for s in sensors
    ]


# What the paper draws


def test_the_maps_have_a_value_every_five_centimeters(published):
    for axis in (published.x, published.y):
        assert_allclose(axis, np.linspace(-0.95, 0.95, 39), atol=1e-12)
    assert published.error.shape == published.below.shape == (len(published.samples), 39, 39)
    assert published.samples == (1, 10)


def test_a_value_is_known_or_below_the_lowest_contour_but_for_the_nine_under_symbols(published):
    known = ~np.isnan(published.error)
    assert not (known & published.below).any()
    hidden = ~known & ~published.below
    assert hidden.sum(axis=(1, 2)).tolist() == [9, 9]
    for place in places(published, published.array.positions):
        assert hidden[:, *place].all()
    # Read off a place next to a contour, a value may be a little below it: 2 mm.
    assert published.error[known].min() > published.lowest - 0.002


def test_the_target_moves_at_two_meters_per_second(published):
    assert np.linalg.norm(published.velocity) == pytest.approx(2, rel=1e-15)
    assert published.velocity[0] == -published.velocity[1] < 0


def test_on_the_line_of_the_drawn_sensors_the_drawn_errors_are_small_and_across_it_some_are_huge(
    published,
):
    """It should be the other way round: a line sees nothing of what lies on its own line."""
    middle = len(published.x) // 2
    for panel in range(2):
        along, across = published.error[panel, middle], published.error[panel, :, middle]
        assert np.nanmax(along) < 0.3
        assert np.nanmax(across) > 10
    near = np.abs(np.abs(published.y) - 0.4) < 0.13  # beyond the drawn ends
    assert published.below[:, middle, near].all()


# Our maps


def test_only_the_places_of_the_sensors_have_no_estimate(one, ten, published):
    empty = np.zeros((39, 39), bool)
    for place in places(published, published.array.positions):
        empty[place] = True
    assert empty.sum() == len(published.array)
    for result in (one, ten):
        for error in (result.position, result.velocity, result.state):
            assert_array_equal(np.isnan(error), np.repeat(empty[..., None], DRAWS, axis=-1))


@pytest.mark.parametrize(("samples", "likelihood"), [(1, "stationary"), (10, "constant_velocity")])
def test_where_errors_are_small_they_have_the_size_of_the_bound(one, ten, samples, likelihood):
    """Mean square over bound squared, averaged over hundreds of places with 6 draws each.

    Its standard deviation is 3 % (two components or fewer a draw); second-order terms add as much.
    """
    bound = paper.error_map_bound(samples=samples, likelihood=likelihood)
    error = (one if samples == 1 else ten).position
    fine = bound < 0.01
    assert fine.sum() > 250
    assert np.mean((error[fine] / bound[fine, None]) ** 2) == pytest.approx(1, abs=0.12)


def test_the_error_of_the_state_adds_position_and_velocity(one):
    known = ~np.isnan(one.position)
    assert_allclose((one.state**2)[known], (one.position**2 + one.velocity**2)[known], rtol=1e-12)


def test_the_bound_is_that_of_the_array_and_four_unknowns(published):
    i, j = 30, 7
    x = [published.x[i], published.y[j], 0, *published.velocity]
    P = crlb(x, RadarArray.linear(5, 0.4), 0.1, 10, 0.001, "constant_velocity", free=PLANE)
    bound = paper.error_map_bound(samples=10, likelihood="constant_velocity")
    assert bound[i, j] == pytest.approx(np.sqrt(P[0, 0] + P[1, 1]), rel=1e-12)


def test_opposite_v_x_turns_the_map_upside_down(one, published):
    """Reflected at the line of the sensors, nothing changes but rounding."""
    reflected = published.velocity * [-1, 1, 1]
    for likelihood, samples in (("stationary", 1), ("constant_velocity", 10)):
        settings = {"samples": samples, "likelihood": likelihood}
        bound = paper.error_map_bound(**settings)
        mirrored = paper.error_map_bound(**settings, velocity=reflected)[::-1]
        off_line = np.abs(published.x) > 1e-9
        # Some matrices are nearly singular: their inverse keeps five digits.
        assert_allclose(mirrored[off_line], bound[off_line], rtol=1e-4)
    other = paper.error_map(DRAWS, rng=np.random.default_rng(33), velocity=reflected)
    shares = [
        np.nanmean(error > 0.1)
        for error in (one.position[20:], other.position[:19], other.position[20:])
    ]
    # Upper half against mirrored lower half: 741 places x 6 draws, so 0.9 % standard error.
    assert shares[0] == pytest.approx(shares[1], abs=0.04)


def test_ten_samples_of_a_constant_are_worth_the_root_of_ten():
    one, ten = (paper.error_map_bound(samples=k, likelihood="stationary") for k in (1, 10))
    finite = np.isfinite(one)
    # Some matrices are nearly singular: their inverse keeps five digits.
    assert_allclose(ten[finite], one[finite] / np.sqrt(10), rtol=1e-4)


def test_nothing_is_seen_of_the_distance_along_the_line_of_the_sensors():
    """On it all lines of sight are parallel. Off it, the bound is finite."""
    bound = paper.error_map_bound()
    line, rest = bound[39 // 2], np.delete(bound, 39 // 2, axis=0)
    assert np.isinf(line[~np.isnan(line)]).all()
    assert np.isfinite(rest).all()


def test_moving_samples_help_everywhere():
    one, ten = (
        paper.error_map_bound(),
        paper.error_map_bound(samples=10, likelihood="constant_velocity"),
    )
    finite = np.isfinite(one)
    assert (ten[finite] < one[finite]).all()


def test_estimates_stay_in_the_room():
    small = paper.error_map(1, rng=np.random.default_rng(34), room=1.0)
    assert np.nanmax(small.position) < np.hypot(1, 2)  # from one end of the half square to another


def test_a_share_is_counted_over_the_places_that_count():
    error = np.array([[0.1, 0.3], [np.nan, 9.0]])
    where = np.array([[True, True], [True, False]])
    assert_allclose(paper.fraction_above(error, [0.05, 0.2, 1], where), [2 / 3, 1 / 3, 0])


def test_places_can_be_compared_unless_hidden_or_on_a_sensor_either_way(published):
    for panel in range(2):
        where = paper.comparable(published, panel)
        hidden = np.isnan(published.error[panel]) & ~published.below[panel]
        for i, j in places(published, published.array.positions):
            hidden[i, j] = hidden[j, i] = True
        assert_array_equal(where, ~hidden)
        assert_array_equal(published.shown[panel][where & published.below[panel]], 0.025)
        assert not np.isnan(published.shown[panel][where]).any()


def test_a_draw_does_not_depend_on_how_many_follow_it(one):
    first = paper.error_map(2, rng=np.random.default_rng(31))
    assert_array_equal(first.position, one.position[..., :2])


@pytest.mark.parametrize(
    ("argument", "value", "match"),
    [
        ("draws", 0, "draws must be a whole number"),
        ("samples", 0, "samples must be a whole number"),
        ("room", -1.0, "room must be positive"),
        ("velocity", [1, 1, 1], "velocity must be one vector in the plane"),
        ("velocity", [1, 1], "velocity must have shape"),
        ("likelihood", "both", "likelihood must be one of"),
        ("rng", 1, "rng must be a numpy.random.Generator"),
    ],
)
def test_what_makes_no_map_is_refused(argument, value, match):
    arguments = {"draws": 1, "rng": np.random.default_rng(1)} | {argument: value}
    with pytest.raises(ValueError, match=match):
        paper.error_map(**arguments)
