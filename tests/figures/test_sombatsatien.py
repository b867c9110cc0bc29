"""The figures of the post-mortem show the numbers that they are given."""

import numpy as np

from dopplerlib.figures import sombatsatien as draw
from dopplerlib.systems import sombatsatien as student


def test_symptoms_show_the_runs_the_truth_and_the_end_of_the_report():
    result = student.post_mortem(16, rng=np.random.default_rng(1), jacobian="derived")
    told = student.reported().run
    distance, speed, error = draw.symptoms(result, told, run=3).axes
    lines = {line.get_label(): line for line in distance.get_lines()}
    np.testing.assert_array_equal(lines["one run"].get_ydata(), result.track.x[3, :, 0])
    np.testing.assert_array_equal(lines["truth"].get_ydata(), result.truth[:, 0])
    assert lines["report, at the end"].get_ydata() == told.final_x
    assert "truth" not in [line.get_label() for line in error.get_lines()]
    assert error.get_lines()[-1].get_ydata() == told.final_position_error
    assert speed.get_lines()[-1].get_ydata() == np.linalg.norm(told.final_velocity)


def test_a_repair_stands_at_the_median_and_the_central_95_percent_of_its_runs():
    # Of 201 runs the quantiles 0.025 and 0.975 are the 6th and the 196th.
    values = np.random.default_rng(2).permutation(np.arange(1, 202.0))
    figure = draw.repair_ranges(
        {"none": {"error (m)": values}, "all": {"error (m)": values / 10}},
        {"error (m)": ("report", 50.0)},
    )
    (ax,) = figure.axes
    ranges, middles = ax.get_lines()[:4:2], ax.get_lines()[1:4:2]
    np.testing.assert_allclose([one.get_xdata() for one in ranges], [[6, 196], [0.6, 19.6]])
    np.testing.assert_allclose([one.get_xdata()[0] for one in middles], [101, 10.1])
    assert [tick.get_text() for tick in ax.get_yticklabels()] == ["none", "all"]
    assert ax.get_lines()[-1].get_xdata() == [50, 50]


def test_an_alarm_that_was_raised_is_not_forgotten():
    hits = np.array([[True, False, False], [False, False, True]])
    (ax,) = draw.alarm_shares((1, 10, 100), {"filter": {"NIS average": hits}}).axes
    np.testing.assert_array_equal(ax.get_lines()[0].get_ydata(), [0.5, 0.5, 1.0])
    assert ax.get_xlabel() == "samples"
