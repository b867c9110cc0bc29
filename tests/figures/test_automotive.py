"""The figures of the automotive chapters draw what they are given."""

from types import SimpleNamespace

import numpy as np
import pytest

from dopplerlib.evaluation.intervals import ConfidenceInterval
from dopplerlib.figures import automotive as draw
from dopplerlib.figures import automotive_beyond as draw_beyond
from dopplerlib.figures import automotive_filter as draw_filter
from dopplerlib.figures import automotive_waveforms as waves

TIME = np.arange(6.0)


def test_sketches_have_a_panel_for_each_waveform():
    axes = waves.sketches().axes
    assert [ax.get_title("left") for ax in axes] == [
        "pulses", "chirps (LFM)", "two tones (FSK)", "several slopes", "MFSK", "rapid chirps",
    ]  # fmt: skip
    assert all(ax.lines for ax in axes)


def test_pulses_show_the_amplitude_and_every_spectrum():
    spectrum = np.array([-40.0, 0.0, -40.0])
    left, right = waves.pulses(
        TIME, 1j * TIME, np.array([-1.0, 0.0, 1.0]), {"a": spectrum, "b": spectrum}
    ).axes
    assert left.lines[0].get_ydata() == pytest.approx(TIME)
    assert len(right.lines) == 2 and right.get_xlabel().endswith("m/s")


def test_a_line_of_a_tone_passes_through_its_target():
    relations = np.array([[2.0, 1.0], [-2.0, 1.0]])
    target = np.array([[10.0, 3.0]])
    tones = [relations[0] @ target.T, relations[1] @ target.T]
    (ax,) = waves.ghosts({"one": (relations, tones, target, target)}, (0.0, 20.0)).axes
    for line in ax.lines[:2]:
        assert np.interp(10.0, *line.get_data()) == pytest.approx(3.0)


def test_solutions_and_targets_stand_in_their_panel():
    found = {"a": np.ones((3, 1, 2)), "b": np.zeros((2, 1, 2))}
    figure = waves.solved(found, {"a": np.array([[1.0, 2.0]]), "b": np.array([[3.0, 4.0]])})
    first, second = figure.axes
    assert len(first.lines[0].get_xdata()) == 3 and len(second.lines[0].get_xdata()) == 2
    assert second.lines[1].get_xydata().tolist() == [[3.0, 4.0]]


def test_a_map_has_its_axes_and_its_labels():
    r, v = np.arange(4.0), np.arange(-2.0, 2.0)
    figure = waves.maps({"one": (r, v, -np.ones((4, 4)), {"here": (1.0, -1.0)})})
    ax = figure.axes[0]
    assert ax.images[0].get_extent() == [0, 3, -2, 1]
    assert [text.get_text() for text in ax.texts] == ["here"]


def test_a_scheme_has_an_arrow_between_any_two_blocks():
    blocks = [(f"block {i}", f"out {i}") for i in range(6)]
    (ax,) = draw.scheme(blocks).axes
    arrows = [text for text in ax.texts if getattr(text, "arrow_patch", None) is not None]
    written = [text.get_text() for text in ax.texts if text.get_text()]
    assert len(arrows) == 5 and written == [part for block in blocks for part in block]


def test_a_scene_names_its_tracks_once():
    groups = {"track 0": np.zeros((3, 2)), "track 1": np.ones((3, 2)), "object": np.ones((3, 2))}
    (ax,) = draw.scene({"all": groups}, np.zeros((6, 4))).axes
    labels = [text.get_text() for text in ax.get_legend().get_texts()]
    assert labels == ["track", "object", "truth"]
    with pytest.raises(KeyError):
        draw.scene({"all": {"something": np.ones((3, 2))}}, np.zeros((6, 4)))


def test_three_panels_are_in_kilometers_per_hour():
    truth = np.tile([1.0, 10.0, 2.0, -5.0], (6, 1))
    runs = SimpleNamespace(
        path=SimpleNamespace(truth=truth), z=truth[None] + 1, x=np.stack([truth, truth + 2])
    )
    position, v_x, v_y = draw_filter.three_panels(TIME, runs).axes
    assert position.lines[2].get_xydata()[0].tolist() == [1.0, 2.0]
    assert v_x.lines[2].get_ydata() == pytest.approx(np.full(6, 36.0))
    assert v_y.lines[0].get_ydata() == pytest.approx(np.full(6, -4 * 3.6))
    corners = v_x.collections[0].get_paths()[0].vertices[:, 1]
    assert corners.max() == pytest.approx(3.6 * (10 + 0.975 * 2))


def test_a_claim_map_tells_what_is_sure_and_what_is_not():
    share = np.array([[0.0, 0.5], [1.0, 0.9]])
    shares = np.stack([share, [[0.0, 0.4], [0.98, 0.85]], [[0.02, 0.6], [1.0, 0.94]]])
    rows, columns = ("sigma_p", (0.5, 1.0)), ("w", (0.01, 0.1))
    ours = SimpleNamespace(sigma_p=0.5, w=0.1)
    figure = draw_filter.claim_map(rows, columns, {str(i): shares for i in range(4)}, ours)
    ax = figure.axes[0]
    texts = [text.get_text() for text in ax.texts]
    assert texts[::2] == ["0", "50", "100", "90"]
    assert [text.split("\N{EN DASH}") for text in texts[1::2]] == [
        ["0", "2"], ["40", "60"], ["98", "100"], ["85", "94"],
    ]  # fmt: skip
    (hatched,) = ax.patches
    assert hatched.get_xy() == (0.5, 0.5) and hatched.get_hatch()
    *border, choice = ax.lines
    assert choice.get_xydata().tolist() == [[1.0, 0.0]]
    ends = [line.get_xydata() for line in border]  # four sides of the one place that is sure
    assert len(ends) == 4
    assert {tuple(end) for line in ends for end in line} == {
        (-0.5, 0.5), (0.5, 0.5), (-0.5, 1.5), (0.5, 1.5),
    }  # fmt: skip
    assert figure.axes[2].get_xlabel() == "velocity step $w$ of the filter in m/s"
    assert ax.get_ylabel().endswith("in m")


def test_lags_carry_their_intervals():
    w = np.array([0.01, 0.1])
    measured = {0.01: (ConfidenceInterval(0.5, 0.4, 0.6), ConfidenceInterval(0.2, 0.1, 0.3))}
    figure = draw_filter.lags(w, np.ones((2, 2)), np.ones((2, 2)), measured)
    for ax, value in zip(figure.axes, (0.5, 0.2), strict=True):
        (points,) = ax.containers
        assert points.lines[0].get_ydata().tolist() == [value]
        assert ax.lines[2].get_ydata() == pytest.approx([2**0.5, 2**0.5])


def test_statistics_tracks_holes_and_models_keep_labels_and_units():
    pair = (TIME + 1, TIME + 2)
    nis, nees = draw_filter.nis_and_nees(TIME, {"a": pair}, ((3, 5), (2, 6))).axes
    assert nis.lines[0].get_ydata()[0] == 1 and nees.lines[0].get_ydata()[0] == 2
    truth = np.ones((6, 4))
    left, right = draw_beyond.side_by_side(TIME, truth, {"a": np.ones((12, 6, 4))}, (0, 3)).axes
    assert len(left.lines) == 11 and left.get_ylim() == (0, 3)
    assert right.lines[0].get_ydata() == pytest.approx(np.full(6, 3.6))
    left, right = draw_beyond.hole(TIME, {"a": TIME}, 0.2, {"b": TIME + 1}).axes
    assert right.lines[0].get_xdata()[0] == 1  # the start is not an estimate
    turn = TIME > 3
    assert len(draw_beyond.over_time(TIME, {"a": TIME + 1}, turn, "m").axes) == 1
    top, below = draw_beyond.over_time(TIME, {"a": TIME + 1}, turn, "m", TIME / 6).axes
    assert top.get_ylabel() == "m" and below.get_ylim() == (0, 1)


def test_crossings_show_a_share_with_its_interval_at_every_angle():
    shares = {"a": [ConfidenceInterval(0.5, 0.4, 0.6), ConfidenceInterval(0.1, 0.0, 0.2)]}
    truth = np.zeros((2, 6, 4))
    left, right = draw_beyond.crossings(truth, truth + 1, shares, (10, 20)).axes
    assert len(left.lines) == 4
    assert right.containers[0].lines[0].get_xydata().tolist() == [[10, 0.5], [20, 0.1]]
