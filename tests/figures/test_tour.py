"""The figures of the tour show the numbers that they are given."""

import numpy as np

from dopplerlib.figures import tour

TIME = np.array([0.0, 0.25, 0.5])


def approaching(impact):
    """Return states at TIME of targets at 1 m/s that reach the plane x = 0 at each time."""
    x = np.zeros((len(impact), len(TIME), 6))
    x[..., 0] = np.subtract.outer(impact, TIME)
    x[..., 3] = -1
    return x


def test_the_band_of_impact_holds_the_central_95_percent_of_the_runs():
    # Of 201 runs the quantiles 0.025 and 0.975 are runs 6 and 196, 5 ms and 195 ms later.
    impact = np.random.default_rng(3).permutation(1 + np.arange(201) / 1000)
    truth = approaching([1.1])[0]
    left, right = tour.approach(TIME, truth, approaching(impact), run=7).axes
    band = right.collections[0].get_paths()[0].vertices[:, 1]
    assert np.allclose([band.min(), band.max()], [1.005, 1.195])
    lines = {line.get_label(): line.get_ydata() for line in right.get_lines()}
    assert np.allclose(lines["one run"], impact[7])
    assert np.allclose(lines["truth"], 1.1)
    assert np.allclose(left.get_lines()[1].get_ydata(), impact[7] - TIME)


def test_the_record_shows_the_true_shifts_and_the_first_fifty_measurements():
    time = np.arange(80) / 1000
    shift = np.stack([100 - time, 110 - 2 * time], axis=-1)
    z = shift + np.random.default_rng(4).standard_normal(shift.shape)
    whole, first = tour.record(time, z, shift).axes
    assert np.array_equal([line.get_ydata() for line in whole.get_lines()], shift.T)
    measured = [line for line in first.get_lines() if line.get_marker() == "."]
    assert np.array_equal([line.get_ydata() for line in measured], z[:50].T)
    assert np.allclose(measured[0].get_xdata(), np.arange(50))
    assert (whole.get_xlabel(), first.get_xlabel()) == ("time (s)", "time (ms)")
