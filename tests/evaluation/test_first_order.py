"""Is chi-square as quadratic about a start as its covariance presumes?"""

import numpy as np
import pytest

from dopplerlib import DopplerLinks, RadarArray, doppler_shift, ml_initialize
from dopplerlib.evaluation.first_order import chi_square_rise


def test_a_curved_valley_is_told_from_a_straight_one():
    """Radars in the front of a car, a target that stands still 25 m ahead.

    If its velocity is known all is quadratic; if not, the likely states lie on an arc.
    """
    front = RadarArray([[0, -0.8, 0.5], [0, -0.3, 0.7], [0, 0.3, 0.5], [0, 0.8, 0.7]])
    links = DopplerLinks.on_platform(front, [0, 0, 0, 12, 0, 0]).sampled(60, 0.02)
    x = np.array([25, 4, 0.6, 0, 0, 0])
    noise = np.random.default_rng(6).standard_normal((2, 60, 4))
    z = doppler_shift(np.tile(x, (60, 1)), links) + noise
    for free, curved in ((3, True), (0, False)):
        box = [5, -10, 0.6, -free, -free, 0], [60, 10, 0.6, free, free, 0]
        start = ml_initialize(z, links, 1.0, 0.02, box)
        rise = chi_square_rise(start, z, links, 1.0, 0.02)
        assert rise.shape == (2, 2)
        assert (rise.max(axis=1) > 3).all() if curved else np.allclose(rise, 1, atol=0.2)


def test_where_there_is_no_covariance_there_is_no_rise():
    array = RadarArray.linear(5, 0.4)
    z = np.tile(doppler_shift([0.5, 0.2, 0, -1, 0.5, 0], array), (2, 1, 1))
    z[1] = np.nan
    box = [0.1, -1, 0, -2, -2, 0], [2, 1, 0, 2, 2, 0]
    start = ml_initialize(z, array, 0.01, 0.001, box)
    rise = chi_square_rise(start, z, array, 0.01, 0.001)
    np.testing.assert_allclose(rise[0], 1, atol=0.01)
    assert np.isnan(rise[1]).all()


def test_a_start_of_others_and_clocks_of_an_epoch_are_refused():
    array = RadarArray.linear(5, 0.4)
    z = doppler_shift([0.5, 0.2, 0, -1, 0.5, 0], array)[None]
    box = [0.1, -1, 0, -2, -2, 0], [2, 1, 0, 2, 2, 0]
    start = ml_initialize(z, array, 0.01, 0.001, box)
    with pytest.raises(ValueError, match=r"start must be that of z with shape \(2, 5\)"):
        chi_square_rise(start, np.tile(z, (2, 1)), array, 0.01, 0.001)
    links = DopplerLinks.one_way(array.positions, 0.2, clocks="common", clock_model="epoch")
    with pytest.raises(ValueError, match="array must have clocks that stay or drift"):
        chi_square_rise(start, z, links, 0.01, 0.001)
