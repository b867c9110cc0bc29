"""The figures of the chapter on filtering draw what they are given."""

import numpy as np
import pytest

from dopplerlib.figures import ekf as draw

MADE_UP = {"covariance_health"}


def test_bands_reach_two_deviations():
    time = np.arange(5.0)
    x = np.stack([time, -time], axis=-1)
    figure = draw.bands(time, x + 1, x, np.full((5, 2), 0.25), measured=x[:, 1])
    for i, ax in enumerate(figure.axes):
        corners = ax.collections[0].get_paths()[0].vertices
        at_2 = corners[corners[:, 0] == 2, 1]
        assert {at_2.min(), at_2.max()} == {x[2, i] - 0.5, x[2, i] + 0.5}


def test_consistency_has_a_column_for_each_target_and_a_row_for_each_statistic():
    time = np.arange(4.0)
    averages = [{"a": (time + 1, time + 2), "b": (time + 3, time + 4)} for _ in range(3)]
    figure = draw.consistency(time, averages, ((5, 7), (5, 7)), ["x", "y", "z"])
    assert [ax.get_title("left") for ax in figure.axes] == ["x", "y", "z", "", "", ""]
    last = [line.get_ydata()[-1] for ax in figure.axes[::3] for line in ax.lines]
    assert last == [4, 6, 5, 7]


def test_covariance_health_draws_asymmetry_and_marks_a_series_that_ends_early():
    step = np.array([100, 200, 300])
    good = np.tile(np.eye(6), (3, 1, 1))
    skew = good[:2].copy()
    skew[:, 0, 1] += [1e-3, 2e-3]
    figure = draw.covariance_health(step, {"float64": {"good": good, "skew": skew}})
    top, bottom = figure.axes
    symmetric, asymmetric, cross = top.lines
    assert np.isnan(symmetric.get_ydata()).all()  # zero has no place on a logarithmic axis
    assert asymmetric.get_ydata() == pytest.approx([1e-3, 2e-3])
    assert cross.get_xdata()[0] == 0.2 and cross.get_marker() == "x"
    assert bottom.lines[0].get_ydata() == pytest.approx([1, 1, 1])
    # [[1, e/2], [e/2, 1]] has the eigenvalues 1 ± e/2
    assert bottom.lines[1].get_ydata() == pytest.approx([1 - 5e-4, 1 - 1e-3])


def test_tangent_and_second_order_and_gap_keep_their_scales():
    step = np.linspace(-1, 1, 5)
    _, right = draw.tangent(step, step**2 - 4 * step, -4 * step, 0.4).axes
    assert right.lines[0].get_ydata() == pytest.approx(step**2)
    ax = draw.second_order(step + 2, {"a": step + 2}, "ratio to the noise").axes[0]
    assert ax.lines[0].get_ydata() == pytest.approx(step + 2)
    axes = draw.gap(step, {"a": np.full((5, 6), 0.01)}, [(-0.5, 0.5)]).axes
    assert all(ax.lines[0].get_ydata() == pytest.approx(10) for ax in axes)  # 0.01 m in mm
