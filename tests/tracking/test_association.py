"""Associations, against every assignment there is."""

from itertools import permutations

import numpy as np
import pytest

from dopplerlib.tracking.association import gnn_assign, greedy_assign, nearest_neighbor

GATE = 3.0


def cheapest(cost):
    """Return the least cost over all assignments, tried one by one; alone costs the gate."""
    tracks, detections = cost.shape
    choices = [*range(detections), *[None] * tracks]
    return min(
        sum(
            GATE if j is None else (cost[i, j] if cost[i, j] <= GATE else np.inf)
            for i, j in enumerate(choice)
        )
        for choice in set(permutations(choices, tracks))
    )


def price(cost, assigned):
    return sum(GATE if j < 0 else cost[i, j] for i, j in enumerate(assigned))


@pytest.mark.parametrize("shape", [(3, 3), (2, 4), (4, 2), (1, 3), (3, 1)])
def test_the_global_assignment_is_the_cheapest_of_all(shape):
    rng = np.random.default_rng(21)
    for _ in range(20):
        cost = rng.uniform(0, 5, size=shape)
        assigned = gnn_assign(cost, GATE)
        used = assigned[assigned >= 0]
        assert len(set(used)) == len(used)
        assert all(cost[i, j] <= GATE for i, j in enumerate(assigned) if j >= 0)
        assert price(cost, assigned) == pytest.approx(cheapest(cost))


def test_greed_is_never_cheaper_and_sometimes_dearer():
    rng = np.random.default_rng(22)
    extra = []
    for _ in range(200):
        cost = rng.uniform(0, 5, size=(3, 3))
        extra.append(price(cost, greedy_assign(cost, GATE)) - price(cost, gnn_assign(cost, GATE)))
    assert min(extra) > -1e-9 and max(extra) > 0.1


def test_two_crossing_targets_by_hand():
    cost = np.array([[1.0, 2.0], [2.0, 8.0]])
    assert gnn_assign(cost, 5.0).tolist() == [1, 0]  # 4, against 1 + 5 for greed
    assert greedy_assign(cost, 5.0).tolist() == [0, -1]
    assert nearest_neighbor(cost, cost <= 5.0).tolist() == [0, 0]  # both want the same one


@pytest.mark.parametrize("assign", [gnn_assign, greedy_assign])
def test_pairs_outside_the_gate_are_never_made(assign):
    assert assign([[np.inf, np.nan], [4.0, 9.0]], GATE).tolist() == [-1, -1]
    assert assign([[-np.inf, 1.0], [2.0, -np.inf]], GATE).tolist() == [1, 0]
    assert assign(np.empty((2, 0)), GATE).tolist() == [-1, -1]
    assert assign(np.empty((0, 2)), GATE).tolist() == []


@pytest.mark.parametrize("assign", [gnn_assign, greedy_assign])
def test_renumbering_tracks_and_detections_renumbers_the_assignment(assign):
    rng = np.random.default_rng(23)
    cost = rng.uniform(0, 5, size=(4, 5))
    tracks, detections = rng.permutation(4), rng.permutation(5)
    moved = assign(cost[np.ix_(tracks, detections)], GATE)
    original = assign(cost, GATE)[tracks]
    assert [detections[j] if j >= 0 else -1 for j in moved] == original.tolist()


def test_the_nearest_of_nothing_is_none():
    assert nearest_neighbor(np.empty((3, 0))).tolist() == [-1, -1, -1]
    assert nearest_neighbor([np.nan, 2.0, np.inf]) == 1
    assert nearest_neighbor([np.nan, np.inf]) == -1
    assert nearest_neighbor([-np.inf, 2.0]) == 1


@pytest.mark.parametrize(
    ("function", "arguments", "name"),
    [
        (nearest_neighbor, (1.0,), "distance"),
        (nearest_neighbor, ([1.0], [1]), "accept"),
        (nearest_neighbor, ([1.0], [True, True]), "accept"),
        (gnn_assign, ([1.0], 2.0), "cost"),
        (gnn_assign, ([[1.0]], np.inf), "gate"),
        (greedy_assign, ([["a"]], 1.0), "cost"),
    ],
)
def test_bad_input_is_named(function, arguments, name):
    with pytest.raises(ValueError, match=rf"^{name} must "):
        function(*arguments)


def test_with_nis_alone_a_coasting_track_outbids_one_that_is_sure_and_a_determinant_mends_that():
    """One detection, 0.2 from a track with S = 0.02 and 0.3 from one that coasts with S = 4."""
    S = np.array([0.02, 4.0])
    nis = np.array([[0.2**2], [0.3**2]]) / S[:, None]
    density = np.exp(-nis[:, 0] / 2) / np.sqrt(S)
    assert density[0] > density[1]
    assert gnn_assign(nis, 9.0).tolist() == [-1, 0]
    assert gnn_assign(nis + np.log(S)[:, None], 9.0 + np.log(S).max()).tolist() == [0, -1]
