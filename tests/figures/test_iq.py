"""Figures of the signal chain show what they are given."""

import numpy as np

from dopplerlib.evaluation.frequency_benchmark import FrequencyBenchmark
from dopplerlib.evaluation.intervals import ConfidenceInterval
from dopplerlib.figures import iq
from tests.drawn import lines

RATIO = [ConfidenceInterval(2.0, 1.0, 3.0)] * 3
SHARE = [
    ConfidenceInterval(0.5, 0.3, 0.7),
    ConfidenceInterval(0.1, 0.01, 0.2),
    ConfidenceInterval(0.0, 0.0, 0.1),
]
NAMES = [
    "highest bin", "parabola, padded", "Jacobsen", "Quinn 2",
    "Aboutanios-Mulgrew", "maximum likelihood", "Kay", "pulse pair",
]  # fmt: skip
RACE = FrequencyBenchmark(
    np.arange(3), np.array([10.0, 2.0, 1.0]), 100, dict.fromkeys(NAMES, RATIO),
    dict.fromkeys(NAMES, SHARE),
)  # fmt: skip


def bars(ax):
    """Return the ends (B, 2) of the error bars that are drawn."""
    return [path[:, 1] for group in ax.collections for path in group.get_segments()]


def test_the_chain_names_every_stage_and_what_it_gives():
    figure = iq.chain(["a", "b", "c"], ["1", "2", "3"], per_sensor=2)
    texts = [text.get_text() for text in figure.axes[0].texts]
    assert {"a", "b", "c", "1", "2", "3"} <= set(texts)


def test_the_circle_has_the_samples_of_one_turn_and_both_parts():
    time = np.arange(40) / 1000
    x = np.exp(2j * np.pi * 50 * time)
    plane, trace = iq.circle(time, x, turn=20).axes
    np.testing.assert_array_equal(
        plane.collections[0].get_offsets(), np.stack([x.real, x.imag], axis=-1)[:20]
    )
    np.testing.assert_array_equal(lines(trace)["Q"].get_ydata(), x.imag)
    np.testing.assert_array_equal(lines(trace)["I"].get_xdata(), 1e3 * time)


def test_the_parabola_goes_through_the_highest_bin_and_its_neighbors():
    bins = np.arange(10.0)
    power = np.array([0, 0, 1, 2, 5, 4, 1, 0, 0, 0.0])
    figure = iq.peak(bins, power, bins, power, vertex=4.25, truth=4.3)
    curve = lines(figure.axes[1])["parabola through three"]
    np.testing.assert_allclose(np.interp([3, 4, 5], *curve.get_data()), [2, 5, 4], atol=0.01)
    assert lines(figure.axes[1])["truth"].get_xdata()[0] == 4.3


def test_powers_are_drawn_in_decibels():
    f = np.linspace(-200, 200, 5)
    figure = iq.impairments(f, {"raw": np.full(5, 100.0), "better": np.ones(5)}, truth=100.0)
    drawn = lines(figure.axes[0])
    np.testing.assert_allclose(drawn["raw"].get_ydata(), 20)
    np.testing.assert_allclose(drawn["better"].get_ydata(), 0)


def test_estimates_stand_at_their_tags():
    time = np.linspace(0, 1, 11)
    windows = np.array([[0.1, 0.3], [0.5, 0.7]])
    left, right = iq.tags(time, 100 * time, windows, np.zeros(2), np.array([-10.0, -10])).axes
    drawn = lines(left)
    np.testing.assert_allclose(drawn["estimate, at the center"].get_xdata(), [0.2, 0.6])
    np.testing.assert_allclose(drawn["the same, at the end"].get_xdata(), [0.3, 0.7])
    np.testing.assert_allclose(drawn["the same, at the end"].get_ydata(), [20, 60])
    np.testing.assert_allclose(lines(right)["end"].get_ydata(), -10)


def test_every_estimate_is_counted():
    figure = iq.outliers({"a": np.array([1.0, 2, 2]), "b": np.array([-4.0, 0, 4])}, 2.0)
    for ax in figure.axes:
        assert sum(bar.get_height() for bar in ax.patches) == 3


def test_every_estimator_has_a_look_of_its_own():
    drawn = lines(iq.threshold(RACE, list(RACE.ratio), RACE.bound, RACE.bound).axes[0])
    assert {*RACE.ratio, "bound", "bound with outliers"} == set(drawn)
    looks = {
        (drawn[n].get_color(), drawn[n].get_linestyle(), drawn[n].get_marker()) for n in RACE.ratio
    }
    assert len(looks) == len(RACE.ratio)
    biased = lines(iq.bias(np.arange(3), {n: np.ones(3) for n in NAMES[:3]}).axes[0])
    assert all(biased[n].get_color() == drawn[n].get_color() for n in NAMES[:3])


def test_errors_are_drawn_in_hertz_with_their_intervals():
    top, low = iq.threshold(RACE, ["Kay"], RACE.bound, RACE.bound).axes
    np.testing.assert_allclose(lines(top)["Kay"].get_ydata(), [20, 4, 2])
    np.testing.assert_allclose(bars(top), [[10, 30], [2, 6], [1, 3]])
    # No outlier was seen at the last level.
    np.testing.assert_allclose(bars(low), [[0.3, 0.7], [0.01, 0.2]])


def test_a_bias_of_zero_is_left_out():
    figure = iq.bias(np.arange(3), {"Kay": np.array([1e-3, 0.0, 1e-3])})
    np.testing.assert_array_equal(lines(figure.axes[0])["Kay"].get_ydata(), [1e-3, np.nan, 1e-3])


def test_the_best_window_lies_on_its_law():
    T = np.array([0.01, 0.02, 0.04])
    laws = {tag: (T, np.array([3.0, 1.0, 3.0]) * k, 0.02) for k, tag in ((1, "end"), (2, "center"))}
    figure = iq.best_window(T, dict.fromkeys(laws, RATIO), laws, 0.4)
    stars = [line for line in figure.axes[0].lines if line.get_marker() == "*"]
    assert [tuple(star.get_data()) for star in stars] == [([20.0], [1.0]), ([20.0], [2.0])]


def test_the_correlation_is_drawn_as_measured_and_as_derived():
    tau = np.linspace(0, 1, 5)
    (ax,) = iq.overlap(tau, tau**2, tau[:3], SHARE).axes
    np.testing.assert_array_equal(lines(ax)["measured"].get_xdata(), tau[:3])
    np.testing.assert_array_equal(lines(ax)["measured"].get_ydata(), [0.5, 0.1, 0])
    np.testing.assert_array_equal(bars(ax)[0], [0.3, 0.7])


def test_each_filter_shows_its_nis_and_nees():
    belief = {"a": (ConfidenceInterval(1.0, 0.9, 1.1), ConfidenceInterval(7.0, 6.0, 8.0))}
    left, right = iq.colored(np.arange(3), {"a": RATIO}, belief).axes
    assert "a" in lines(left)
    heights = [line.get_ydata()[0] for line in right.lines if len(line.get_ydata()) == 1]
    assert heights == [1.0, 7.0]
    np.testing.assert_array_equal(bars(right), [[0.9, 1.1], [6, 8]])
