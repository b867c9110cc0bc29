"""The figures of the stand-in show the data they are given, and say that it is simulated."""

import numpy as np
import pytest

from dopplerlib.figures import asheim_real as draw
from dopplerlib.tracking.multi_target import ManagedTrack
from tests.drawn import lines

MADE_UP = {"coasting"}

TIME = np.arange(50.0)
SENSORS = np.array([[-0.5, 0.0], [0.5, 0.0]])
GAP = (25.0, 42.0)


@pytest.fixture(scope="module")
def figures():
    d, p = np.ones((50, 3)), np.ones((50, 2))
    state = np.ones((3, 2)), np.ones((3, 2, 2))
    track = ManagedTrack(np.arange(3), *state, np.zeros(3, int), np.ones(3, bool))
    one = {"detections": d, "chosen": TIME, "filtered": TIME, "truth": TIME}
    return {
        "records": draw.records(TIME, {"a": one, "b": {"detections": d}}, (1.5, 4.5), GAP),
        "positions": draw.positions(p, p, p, SENSORS),
        "coasting": draw.coasting(TIME, [TIME] * 2, [np.ones((4, 50))] * 2, GAP, ("a", "b")),
        "managed": draw.managed(TIME, d, [track, track], TIME, GAP, TIME),
    }


def test_every_panel_says_that_it_is_simulated(figures):
    for figure in figures.values():
        assert all(ax.get_title(loc="left").startswith("SIMULATED") for ax in figure.axes)


def test_a_record_shows_what_it_has(figures):
    first, second = (lines(ax) for ax in figures["records"].axes)
    assert set(first) == {"detections", "chosen", "filtered", "true"}
    assert set(second) == {"detections"}
    assert len(second["detections"].get_xdata()) == 150


def test_managed_tracks_stand_at_their_scans_and_each_has_its_mark(figures):
    left, _ = figures["managed"].axes
    tracks = [lines(left)[f"track {i}"] for i in (1, 2)]
    assert tracks[0].get_xydata().tolist() == [[0, 1], [1, 1], [2, 1]]
    assert tracks[0].get_marker() != tracks[1].get_marker()
    assert len(left.lines) == 4
