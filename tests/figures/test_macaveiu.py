"""The figures of the automotive radar draw what they are given."""

import numpy as np
import pytest

from dopplerlib.figures import macaveiu as draw
from dopplerlib.systems.macaveiu2013 import SLOPES

TIME = np.arange(6.0)


def test_sketches_have_a_panel_for_each_waveform():
    axes = draw.sketches().axes
    assert [ax.get_title("left") for ax in axes] == [
        "pulses", "chirps (LFM)", "two tones (FSK)", "several slopes", "MFSK", "rapid chirps",
    ]  # fmt: skip
    assert all(ax.lines for ax in axes)
    heights = np.array([line.get_ydata()[0] for line in axes[4].lines]).reshape(-1, 2)
    steps = np.diff(heights[:, 0])
    assert heights[:, 1] - heights[:, 0] == pytest.approx(-steps[0] / 2)  # B half a step below A
    assert steps == pytest.approx(steps[0])
    assert np.diff(axes[3].lines[0].get_ydata()) == pytest.approx(SLOPES)


def test_pulses_show_the_amplitude_and_every_spectrum():
    spectrum = np.array([-40.0, 0.0, -40.0])
    left, right = draw.pulses(
        TIME, 1j * TIME, np.array([-1.0, 0.0, 1.0]), {"a": spectrum, "b": spectrum}
    ).axes
    assert left.lines[0].get_ydata() == pytest.approx(TIME)
    assert len(right.lines) == 2 and right.get_xlabel().endswith("(m/s)")


def test_a_line_of_a_tone_passes_through_its_target():
    relations = np.array([[2.0, 1.0], [-2.0, 1.0]])
    target = np.array([[10.0, 3.0]])
    tones = [relations[0] @ target.T, relations[1] @ target.T]
    (ax,) = draw.ghosts({"one": (relations, tones, target, target)}, (0.0, 20.0)).axes
    for line in ax.lines[:2]:
        assert np.interp(10.0, *line.get_data()) == pytest.approx(3.0)


def test_solutions_and_targets_stand_in_their_panel():
    found = {"a": np.array([[[1.0, 2.0]], [[1.1, 2.0]], [[9.0, 2.0]]]), "b": np.zeros((2, 1, 2))}
    figure = draw.solved(found, {"a": np.array([[1.0, 2.0]]), "b": np.array([[3.0, 4.0]])})
    first, second = figure.axes
    assert len(first.lines[0].get_xdata()) == 3 and len(second.lines[0].get_xdata()) == 2
    assert second.lines[1].get_xydata().tolist() == [[3.0, 4.0]]
    assert [ax.texts[0].get_text() for ax in figure.axes] == ["1 of 3 outside", "2 of 2 outside"]


def test_a_map_has_its_axes_and_its_labels():
    r, v = np.arange(4.0), np.arange(-2.0, 2.0)
    figure = draw.maps({"one": (r, v, -np.ones((4, 4)), {"here": (1.0, -1.0)})})
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
    figure = draw.scene({"all": groups, "again": groups}, np.zeros((6, 4)))
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == ["track", "object", "truth"]
    with pytest.raises(KeyError):
        draw.scene({"all": {"something": np.ones((3, 2))}}, np.zeros((6, 4)))
