"""Deviations are read as they stand, and shown with the cell where they matter."""

import pytest

from dopplerlib.replication.deviations import read_deviations

TABLE = """
[[deviation]]
id = "box"
where = "Section 3"
kind = "gap"
document = "The box $|x|$ is not told."
choice = "Two meters."
page = "start"
cell = "boxes"
claims = ["start-reliable"]
"""


def read(tmp_path, text):
    path = tmp_path / "deviations.toml"
    path.write_text(text, encoding="utf-8")
    return read_deviations(path)


def test_a_row_shows_both_sides_and_the_way_to_the_cell(tmp_path):
    deviations = read(tmp_path, TABLE)
    assert repr(deviations) == "1 deviations: 1 gap"
    assert deviations.entries[0].claims == ("start-reliable",)
    row = deviations._repr_markdown_().splitlines()[2]
    assert 'deviation-gap">gap<' in row
    assert r"The box $\|x\|$ is not told." in row
    assert '<a href="start.html#cell-boxes">computation</a>' in row


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "must hold a list"),
        (TABLE + TABLE, "unique, got 'box' twice"),
        (TABLE.replace('"gap"', '"hole"'), "kind of deviation 'box' must be one of 'gap'"),
        (TABLE + "place = 1", "must have nothing but id, .*, got place"),
        (TABLE.replace('cell = "boxes"', ""), "deviation 'box' must have cell, got only"),
    ],
)
def test_what_is_no_list_of_deviations_is_refused(tmp_path, text, message):
    with pytest.raises(ValueError, match=message):
        read(tmp_path, text)
