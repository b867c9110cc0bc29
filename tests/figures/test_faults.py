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
    """By WCAG 2.1, which asks for a contrast of 4.5; black or white always has it."""
    share = iter(np.linspace(0, 1, 100))
    shares = {str(row): {str(column): next(share) for column in range(10)} for row in range(10)}
    ax, _ = draw.fault_map(shares, "lost targets").axes
    (image,) = ax.images
    for text in ax.texts:
        column, row = text.xy
        srgb = np.array(image.cmap(image.norm(image.get_array()[row, column]))[:3])
        linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
        bright = linear @ [0.2126, 0.7152, 0.0722]
        contrast = (bright + 0.05) / 0.05 if text.get_color() == "black" else 1.05 / (bright + 0.05)
        assert contrast >= 4.5
