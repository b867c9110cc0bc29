"""What moves on a page answers to sliders, keys and the pointer, with the library's numbers."""

import numpy as np
from numpy.testing import assert_allclose

from dopplerlib import RadarArray, doppler_shift

# Keeps what is written on every canvas, until it is cleared.
RECORD = """(() => {
  const pen = CanvasRenderingContext2D.prototype, { clearRect, fillText } = pen;
  pen.clearRect = function (...box) { this.canvas.words = []; return clearRect.apply(this, box); };
  pen.fillText = function (text, ...at) {
    (this.canvas.words ??= []).push(text);
    return fillText.call(this, text, ...at);
  };
})()"""


def test_the_demonstration_answers_with_the_shifts_of_the_library(tab):
    root = "#doppler-demonstration"
    tab.open("geometry.html")
    tab.run(RECORD)
    for name, value in {"x": 0.5, "y": 0.1, "speed": 1.2, "direction": -150}.items():
        tab.set(f"{root} input[name={name}]", value)
    tab.press("ArrowRight", f"{root} input[name=x]")
    assert tab.text(f"{root} output") == "0.51 m"
    words = tab.on(f"{root} canvas.bars", "e.words")
    shown = [float(word.removesuffix(" Hz")) for word in words if word.endswith(" Hz")]
    angle = np.deg2rad(-150)
    state = [0.51, 0.1, 0, 1.2 * np.cos(angle), 1.2 * np.sin(angle), 0]
    column = RadarArray([[0, y, 0] for y in np.arange(-0.25, 0.3, 0.1)], 2 / 160)
    assert_allclose(shown, doppler_shift(state, column), atol=0.051)  # one digit is shown
    tab.drag(f"{root} canvas.scene", (0.3, 0.5), (0.6, 0.4))
    # 1000 by 720 points, 750 for a meter; the sensors stand at 120, the x-axis in the middle.
    x, y = (1000 * 0.6 - 120) / 750, 720 * 0.1 / 750
    assert [tab.text(f"{root} label:nth-of-type({n}) output") for n in (1, 2)] == [
        f"{x:.2f} m",
        f"{y:.2f} m",
    ]
    assert tab.complaints == []
