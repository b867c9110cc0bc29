"""The figure of the chapter on scaling shows the numbers that it is given."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from dopplerlib.figures import scaling as draw

RUNS, WIDTH = np.array([10, 40, 160]), np.array([3.1, 1.4, 0.8])
TIMED, SECONDS = np.array([100, 1000]), np.array([0.4, 3.1])


@pytest.fixture(scope="module")
def figures():
    found = draw.gain_and_cost(RUNS, WIDTH, TIMED, SECONDS, 0.003, (1, 100, 1000))
    return {"gain_and_cost": found}


def test_numbers_are_where_they_belong_and_lines_go_on_from_them(figures):
    gain, cost = figures["gain_and_cost"].axes
    root, computed = (line.get_xydata() for line in gain.lines)
    assert_allclose(computed, np.stack([RUNS, WIDTH], axis=-1))
    assert_allclose(root[:, 1] * np.sqrt(root[:, 0]), 0.8 * np.sqrt(160))
    one, hundred, thousand, measured = (line.get_xydata() for line in cost.lines)
    assert_allclose(measured, np.stack([TIMED, SECONDS], axis=-1))
    for line, count in ((one, 1), (hundred, 100), (thousand, 1000)):
        assert_allclose(line[:, 1] / line[:, 0], 0.003 / count)
        assert line[0, 0] >= count
