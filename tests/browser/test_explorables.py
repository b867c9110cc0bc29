"""Explorables answer to sliders, keys, buttons and the pointer, with the library's numbers.

That their numbers are right for any state is asked of the same files without a browser.
"""

import json

import numpy as np
from numpy.testing import assert_allclose

from dopplerlib import RadarArray, doppler_shift


def awake(tab, name):
    """Scroll to an explorable, which wakes it; return the selector of its element."""
    root = f"[data-explorable={name}]"
    tab.on(root, "e.scrollIntoView({ block: 'center', behavior: 'instant' })")
    tab.wait(f"document.querySelector('{root}').dataset.numbers")
    return root


def shown(tab, root):
    """Return the numbers that an explorable shows, once it has been drawn anew."""
    tab.settle()
    return json.loads(tab.on(root, "e.dataset.numbers"))


def touch(tab, selector, down):
    """Put a finger on the middle of an element, and move it down by some px."""
    box = tab.on(selector, "e.getBoundingClientRect().toJSON()")
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    tab.call("Input.dispatchTouchEvent", type="touchStart", touchPoints=[{"x": x, "y": y}])
    for part in range(1, 7):
        place = {"x": x, "y": y + down * part / 6}
        tab.call("Input.dispatchTouchEvent", type="touchMove", touchPoints=[place])
        tab.settle()
    tab.call("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])


def test_the_plane_scene_answers_with_the_shifts_of_the_library(tab):
    tab.open("geometry.html")
    root = awake(tab, "shifts")
    first = shown(tab, root)
    for name, value in {"x": 0.5, "y": 0.1, "speed": 1.2, "direction": -150}.items():
        tab.set(f"#shifts-{name}", value)
    tab.press("ArrowRight", "#shifts-x")
    assert tab.text(f"{root} .control:has(#shifts-x) .value") == "0.51 m"
    x, y, v_x, v_y = shown(tab, root)["x"]
    angle = np.deg2rad(-150)
    assert_allclose([x, y, v_x, v_y], [0.51, 0.1, 1.2 * np.cos(angle), 1.2 * np.sin(angle)])
    column = RadarArray([[0, y, 0] for y in np.arange(-0.25, 0.3, 0.1)], 2 / 160)
    exact = {"rtol": 1e-12, "atol": 0}
    shifts = shown(tab, root)["shifts"]
    assert_allclose(shifts, doppler_shift([x, y, 0, v_x, v_y, 0], column), **exact)
    said = tab.text(f"{root} .says")
    assert f"{max(shifts) - min(shifts):.1f} Hz" in said

    corner = tab.on(f"{root} svg", "e.getBoundingClientRect().toJSON()")
    grip = tab.on(f"{root} [data-grip=target] .ring", "e.getBoundingClientRect().toJSON()")
    at = [
        (grip[a] + grip[size] / 2 - corner[a]) / corner[size]
        for a, size in (("x", "width"), ("y", "height"))
    ]
    tab.drag(f"{root} svg", at, (at[0] + 0.1, at[1] - 0.1))
    dragged = shown(tab, root)["x"]
    assert dragged[0] > 0.6
    assert dragged[1] > 0.1
    tab.press("ArrowLeft", f"{root} [data-grip=target]")
    assert shown(tab, root)["x"][0] < dragged[0]

    tab.on("#shifts-again", "e.click()")
    assert shown(tab, root) == first
    before = tab.run("scrollY")
    touch(tab, f"{root} [data-grip=target] .ring", down=90)
    assert shown(tab, root)["x"][1] < first["x"][1] - 0.1  # the target follows all the way
    assert tab.run("scrollY") == before
    assert tab.complaints == []


def test_the_first_page_plays_and_shows_a_filter_that_is_too_sure(tab):
    tab.open("index.html")
    root = awake(tab, "hero")
    first = shown(tab, root)
    assert first["error"] < 2 * first["claimed"]
    tab.on("#hero-published", "e.click()")
    assert shown(tab, root)["error"] > 2 * shown(tab, root)["claimed"]
    tab.press("End", "#hero-aside")
    assert shown(tab, root)["stops"] < first["stops"]
    before = shown(tab, root)["time"]
    tab.on(f"{root} .play button", "e.click()")
    tab.wait(f"JSON.parse(document.querySelector('{root}').dataset.numbers).time > {before}")
    assert tab.complaints == []
