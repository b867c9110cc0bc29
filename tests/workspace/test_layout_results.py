"""Parts of the saved studies of layouts come out again, and say what the chapter says."""

import numpy as np
import pytest

from dopplerlib._data import read_json, results
from dopplerlib.workspace import _layout_search
from dopplerlib.workspace.layout_results import (
    saved_arrays,
    saved_errors,
    saved_places,
    saved_rows,
    saved_searches,
)
from dopplerlib.workspace.layouts import named_layouts
from studies import layout_tracks, layouts

SEARCHES = saved_searches()


def test_the_bound_of_each_search_is_that_of_its_layout():
    """But for sensors rounded to a millimeter, which moves the bound by a percent."""
    targets = {"bound": layouts.targets("bound_targets"), "front": layouts.targets("targets")}
    for row in SEARCHES:
        static = row.get("static", False)
        positions = np.array(row["sensors"]) / 1000
        found = _layout_search._log_bound(
            positions, targets[row["kind"]], 10 if static else 100, static
        )
        np.testing.assert_allclose(np.exp(found), row["bound"], rtol=0.02)


def test_no_layout_near_a_smallest_bound_is_better():
    """Sensors moved at random by 5 mm, inside the disc; 20 trials of each room of six."""
    targets, rng = layouts.targets("bound_targets"), np.random.default_rng(1)
    for row in SEARCHES:
        if row["kind"] == "bound" and row["n"] == 6 and not row["static"]:
            best = np.array(row["sensors"]) / 1000
            reached = _layout_search._log_bound(best, targets, 100, False)
            for _ in range(20):
                moved = best + 0.005 * rng.standard_normal(best.shape)
                moved[:, 0] = np.clip(moved[:, 0], -row["depth"], 0)
                radius = np.linalg.norm(moved[:, 1:], axis=-1, keepdims=True)
                moved[:, 1:] *= np.minimum(1, 0.2 / radius)
                assert _layout_search._log_bound(moved, targets, 100, False) > reached - 1e-3


def test_the_search_for_few_twins_keeps_its_limit():
    x = layouts.targets("targets")[:20]
    rng = np.random.default_rng(1)
    start = named_layouts()["five and the center"]
    limit = 1.1 * np.exp(_layout_search._log_bound(start.positions, x, 100, False))
    found = _layout_search.fewest_twins(start, x, limit, rng=rng, generations=2)
    assert found.bound <= limit
    assert found.probability <= _layout_search._chances(start.positions, x).mean()


@pytest.mark.parametrize("kind", ["track", "quality"])
def test_numbers_of_the_comparison_come_out_again(kind):
    item = {
        "track": ("track", "five and the center", None, "T", 0),
        "quality": ("quality", "five and the center", 5),
    }[kind]
    place = [each for each in layout_tracks.items() if each[0] == kind].index(item)
    expected = read_json("layout_tracks.json", folder=results)[kind][place]
    row = layout_tracks.row(*item)
    assert row.keys() == expected.keys()
    for key, value in row.items():
        if isinstance(value, list):
            np.testing.assert_allclose(value, expected[key], rtol=1e-3)


def test_errors_are_those_of_the_sums():
    found = saved_errors("five and the center", "T")
    assert found.position[1].low < found.position[1].value < found.position[1].high
    assert saved_errors("five and the center", "A", lost=0).bound[1] > found.bound[2]
    with pytest.raises(ValueError, match="layout must be one that was tracked, got 'square'"):
        saved_errors("square", "A")


def test_every_layout_has_its_rows():
    whole = [row["layout"] for row in saved_rows("quality") if "without" not in row]
    assert whole == list(saved_arrays())
    x, y = saved_places()
    for row in saved_rows("map"):
        assert np.shape(row["bound"]) == np.shape(row["early"]) == (len(y), len(x))
