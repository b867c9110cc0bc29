"""The picture on the first page shows the runs that it is given."""

import numpy as np
from matplotlib.collections import LineCollection
from numpy.testing import assert_allclose

from dopplerlib import doppler_shift
from dopplerlib.figures.index import hero
from dopplerlib.figures.style import project
from dopplerlib.systems import mittermaier2016 as paper


def test_the_first_picture_draws_every_run_from_the_start_to_its_end():
    scenario = paper.reported().scenario
    result = paper.run_example(3, rng=np.random.default_rng(5), keep=())
    start, z = paper.reported().table2.x_ml, doppler_shift(scenario.truth, scenario.array)
    scene, curves, errors = hero(scenario, z, result.track.x, start, -50, 10).axes
    fan = next(c for c in scene.collections if isinstance(c, LineCollection)).get_segments()
    expected = [[start[:3], run[-1, :3]] for run in result.track.x]
    assert_allclose([line[[0, -1]] for line in fan], project(expected, -50, 10))
    assert np.array_equal([line.get_ydata() for line in curves.lines], z.T)
    # The median of three runs is the middle one.
    middle = np.sort(np.linalg.norm(result.error, axis=-1), axis=0)[1]
    assert_allclose(errors.lines[0].get_ydata(), 100 * middle)
