"""Of the theme's icons, those stay that pages show, by whichever name."""

import importlib.util
from importlib.metadata import files
from pathlib import Path

import pytest

SOURCE = Path(__file__).resolve().parents[2] / "book" / "_ext" / "icons.py"
spec = importlib.util.spec_from_file_location("icons", SOURCE)
icons = importlib.util.module_from_spec(spec)
spec.loader.exec_module(icons)


@pytest.fixture(scope="module")
def whole():
    """Return the theme's file."""
    (file,) = (f for f in files("pydata-sphinx-theme") if f.match("static/scripts/fontawesome.js"))
    return file.read_text(encoding="utf8")


def test_what_is_left_out_are_icons_only(whole):
    """With all names the file stays as it is; without any, two thousand entries have gone."""
    entries = list(icons.ENTRY.finditer(whole))
    assert len(entries) > 2000
    assert icons.leave_out(whole, {entry[1] for entry in entries}) == whole
    none = icons.leave_out(whole, set())
    assert len(none) == len(whole) - sum(len(entry[0]) for entry in entries) < 100_000
    for text in (whole, none):
        assert [text.count(a) - text.count(b) for a, b in ("{}", "()")] == [0, 0]


def test_an_icon_stays_by_its_name_or_by_another_one(whole):
    for name in ("magnifying-glass", "search"):
        kept = icons.leave_out(whole, {name})
        assert [entry[1] for entry in icons.ENTRY.finditer(kept)] == ["magnifying-glass"]
