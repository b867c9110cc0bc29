"""Exact solutions: the number of sensors decides."""

import numpy as np

from dopplerlib import doppler_shift
from dopplerlib.workspace._solutions import same_shifts
from dopplerlib.workspace.layouts import named_layouts
from dopplerlib.workspace.targets import TABLE_2

SIX = named_layouts()["five and the center"]


def test_six_sensors_see_the_same_twice_in_a_snapshot_and_once_in_a_path():
    rng = np.random.default_rng(1)
    found = same_shifts(TABLE_2, SIX, [0.0], rng=rng, starts=30)
    assert len(found) == 2
    np.testing.assert_allclose(doppler_shift(found, SIX)[1], doppler_shift(TABLE_2, SIX), atol=1e-6)
    assert np.linalg.norm(found[1, :3] - found[0, :3]) > 0.3
    found = same_shifts(TABLE_2, SIX, [0.0, 0.2], rng=rng, starts=10)
    np.testing.assert_array_equal(found, TABLE_2[None])
