"""The map of faults shows the shares that it is given."""

import numpy as np

from dopplerlib.figures import faults as draw

SHARES = {"none": {"one": 0.0, "other": 0.254}, "some": {"one": 1.0}}


def test_a_share_is_a_color_and_a_number():
    ax, bar = draw.fault_map(SHARES, "lost targets").axes
    (image,) = ax.images
    np.testing.assert_array_equal(image.get_array().filled(np.nan), [[0, 25.4], [100, np.nan]])
    assert image.get_clim() == (0, 100)
    numbers = {text.xy: text.get_text() for text in ax.texts}
    assert numbers == {(0, 0): "0", (1, 0): "25", (0, 1): "100"}  # (column, row)
    assert [label.get_text() for label in ax.get_xticklabels()] == ["one", "other"]
    assert [label.get_text() for label in ax.get_yticklabels()] == ["none", "some"]
    assert bar.get_ylabel() == "lost targets (%)"


def test_numbers_can_be_read_on_their_color():
    ax, _ = draw.fault_map(SHARES, "lost targets").axes
    (image,) = ax.images
    for text in ax.texts:
        column, row = text.xy
        red, green, blue, _ = image.cmap(image.norm(image.get_array()[row, column]))
        bright = 0.2126 * red + 0.7152 * green + 0.0722 * blue
        assert (bright > 0.4) == (text.get_color() == "black")
