"""Table 2: where its errors lie among ours, and whether its estimate can be one."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.stats import norm

from dopplerlib import RadarArray, crlb, doppler_shift, simulate
from dopplerlib.systems import mittermaier2016 as paper

RUNS = 400
LIKELIHOODS = ("stationary", "constant_velocity")


@pytest.fixture(scope="module", params=(51, 52))
def starts(request):
    return {
        name: paper.table2_starts(RUNS, rng=np.random.default_rng(request.param), likelihood=name)
        for name in LIKELIHOODS
    }


def chi_square(z, path):
    s = paper.reported().scenario
    return np.sum((z - doppler_shift(path, s.array)) ** 2, axis=(-2, -1)) / s.sigma_f**2


def test_a_record_is_ten_samples_of_the_example(starts):
    s = paper.reported().scenario
    _, z = simulate(s, 3, rng=np.random.default_rng(51))
    own = paper.table2_starts(3, rng=np.random.default_rng(51))
    path = np.repeat(own.start.x[:, None], 10, axis=1)
    path[..., :3] += s.time[:10, None] * path[..., 3:]
    # simulate draws a record sample by sample, so the first ten of a long one are a short one.
    assert_allclose(own.start.cost, chi_square(z[:, :10], path), rtol=1e-9)


@pytest.mark.parametrize("likelihood", LIKELIHOODS)
def test_the_errors_are_those_of_the_estimates(starts, likelihood):
    found = starts[likelihood]
    error = found.start.x - paper.reported().table2.x0
    assert_allclose(found.position**2 + found.velocity**2, np.sum(error**2, axis=1), rtol=1e-12)


def test_the_estimates_explain_the_record_better_than_the_truth_does():
    """The truth lies in the box, so the most likely state is at least as likely."""
    s = paper.reported().scenario
    found = paper.table2_starts(100, rng=np.random.default_rng(53))
    _, z = simulate(s, 100, rng=np.random.default_rng(53))
    gained = chi_square(z[:, :10], s.truth[:10]) - found.start.cost
    assert (gained > 0).all()
    # Six parameters; the box takes some freedom away, the second valley gives some.
    assert 4 < gained.mean() < 8


def test_the_printed_errors_are_smaller_than_nearly_all_of_ours(starts):
    """Of 10 000 starts 0.6 % are as good: 13 or more of 400 have a chance of 1e-6."""
    quoted = paper.reported().quoted
    share = np.mean(starts["constant_velocity"].position <= quoted.position_error_norm_m)
    assert share < 0.03


def test_for_a_constant_state_the_box_decides(starts):
    """No start is identifiable, and a smaller room leaves none with so small an error."""
    printed = paper.reported().quoted.position_error_norm_m
    assert not starts["stationary"].start.identifiable.any()
    assert np.mean(starts["stationary"].position <= printed) > 0.01
    other = paper.table2_starts(
        RUNS, rng=np.random.default_rng(51), likelihood="stationary", box=paper.start_box(1.0, 0.5)
    )
    assert np.mean(other.position <= printed) < 0.005
    assert np.median(other.position) > 1.2 * np.median(starts["stationary"].position)


# Can the published estimate be one?


@pytest.mark.parametrize("likelihood", LIKELIHOODS)
def test_the_truth_is_no_distance_away_from_itself(likelihood):
    assert paper.start_misfit(paper.reported().table2.x0, likelihood=likelihood) == 0


def test_the_distance_is_that_of_the_shifts():
    s, table = paper.reported().scenario, paper.reported().table2
    apart = doppler_shift(table.x_ml, s.array) - doppler_shift(table.x0, s.array)
    assert np.sqrt(np.mean(apart**2)) > 1  # Hz
    expected = np.sqrt(10 * np.sum(apart**2)) / s.sigma_f
    assert paper.start_misfit(table.x_ml, likelihood="stationary") == pytest.approx(
        expected, rel=1e-12
    )


def test_the_chance_to_beat_the_truth_is_that_of_half_the_distance():
    """Twenty thousand draws against the formula: four standard errors."""
    s, other = paper.reported().scenario, paper.reported().figure6.start
    distance = paper.start_misfit(other)
    path = np.repeat(other[None], 10, axis=0)
    path[:, :3] += s.time[:10, None] * other[3:]
    noise = s.sigma_f * np.random.default_rng(54).standard_normal((20_000, 10, 6))
    z = doppler_shift(s.truth[:10], s.array) + noise
    share = np.mean(chi_square(z, path) < chi_square(z, s.truth[:10]))
    chance = norm.cdf(-distance / 2)
    assert share == pytest.approx(chance, abs=4 * np.sqrt(chance * (1 - chance) / 20_000))


def test_rounding_is_made_the_most_of():
    table = paper.reported().table2
    least = paper.start_misfit(table.x_ml, likelihood="stationary", rounding=0.0005)
    rng = np.random.default_rng(55)
    corners = table.x_ml + 0.0005 * rng.choice([-1, 1], (500, 6))
    moved = [paper.start_misfit(x, likelihood="stationary") for x in corners[:100]]
    assert least < min(moved) < paper.start_misfit(table.x_ml, likelihood="stationary")


@pytest.mark.parametrize("likelihood", LIKELIHOODS)
def test_the_printed_estimate_cannot_be_the_most_likely_state_and_the_drawn_one_can(likelihood):
    printed = paper.start_misfit(
        paper.reported().table2.x_ml, likelihood=likelihood, rounding=0.0005
    )
    drawn = paper.start_misfit(paper.reported().figure6.start, likelihood=likelihood)
    assert norm.cdf(-printed / 2) < 1e-15
    assert norm.cdf(-drawn / 2) > 0.1


@pytest.mark.parametrize("place", ["ring", "with a center"])
def test_the_record_that_is_needed_is_the_shortest_one(place):
    s, printed = paper.reported().scenario, paper.reported().quoted.position_error_norm_m
    extra = [[0, 0, 0]] if place == "with a center" else np.empty((0, 3))
    array = RadarArray(np.vstack([s.array.positions, extra]))
    needed = paper.samples_needed(array=array)
    bounds = [
        np.sqrt(np.trace(crlb(s.x0, array, s.sigma_f, k, s.T, "constant_velocity")[:3, :3]))
        for k in (needed - 1, needed)
    ]
    assert bounds[1] <= printed < bounds[0]


def test_the_same_seed_gives_the_same_bits(starts):
    again = paper.table2_starts(RUNS, rng=np.random.default_rng(51))
    some = paper.table2_starts(20, rng=np.random.default_rng(51))
    assert_array_equal(again.position[:20], some.position)


@pytest.mark.parametrize(
    ("call", "match"),
    [
        (lambda: paper.start_box(reach=0.05), "near must be below reach"),
        (lambda: paper.start_box(side=0.0), "side must be positive"),
        (lambda: paper.table2_starts(0, rng=np.random.default_rng(1)), "runs must be a whole"),
        (lambda: paper.table2_starts(1, rng=np.random.default_rng(1), array=3), "array must be"),
        (lambda: paper.start_misfit([1.0, 2]), "x must have shape"),
        (lambda: paper.start_misfit(np.ones((2, 6))), "x must have 1 axes"),
        (lambda: paper.start_misfit(np.ones(6), likelihood="no"), "likelihood must be one of"),
        (lambda: paper.start_misfit(np.ones(6), rounding=-1.0), "rounding must be from 0 to 1"),
        (lambda: paper.samples_needed(0.0), "error must be positive"),
        (lambda: paper.samples_needed(1e-9), "error must be within reach"),
    ],
)
def test_what_makes_no_start_is_refused(call, match):
    with pytest.raises(ValueError, match=match):
        call()
