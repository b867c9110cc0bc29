"""What a document reports is read with its place, and refused by the file's name."""

import copy
import pickle

import numpy as np
import pytest

from dopplerlib.replication.published import Published, read_published

TEXT = """
where = "Section 4"
T = 0.1
samples = 500
drawn = true
title = "a walk"
[filter]
P0_diagonal = [1, 2.5]
[filter.ours]
where = "ours: the text gives no value"
windows = [8, 12]
boxes = [[0.0, -1.0], [2.0, 1.0]]
ragged = [[1.0], [1.0, 2.0]]
mixed = ["center", 0.5]
none = []
[[path]]
start = [0.0, 5.0]
law = { name = "linear", first = -5 }
"""


def read(tmp_path, text=TEXT):
    path = tmp_path / "scenario.toml"
    path.write_text(text, encoding="utf-8")
    return read_published(path)


def test_entries_are_attributes_with_the_types_of_the_file(tmp_path):
    found = read(tmp_path)
    assert (found.T, found.samples, found.drawn, found.title) == (0.1, 500, True, "a walk")
    assert isinstance(found.samples, int)
    assert found.path[0].law.first == -5
    assert found.filter.table.keys() == {"P0_diagonal", "ours"}


def test_lists_of_numbers_are_arrays_that_cannot_be_written_to(tmp_path):
    found = read(tmp_path).filter
    np.testing.assert_array_equal(found.P0_diagonal, [1.0, 2.5])
    assert found.ours.windows.dtype.kind == "i"
    assert found.ours.boxes.shape == (2, 2)
    with pytest.raises(ValueError, match="read-only"):
        found.P0_diagonal[0] = 3.0
    assert [one.size for one in found.ours.ragged] == [1, 2]
    assert found.ours.mixed == ("center", 0.5)
    assert found.ours.none == ()


def test_a_table_has_the_place_of_the_one_around_it_unless_it_has_its_own(tmp_path):
    found = read(tmp_path)
    assert {found.where, found.filter.where, found.path[0].law.where} == {"Section 4"}
    assert found.filter.ours.where.startswith("ours: ")
    assert repr(found.filter) == "scenario.toml [filter], Section 4: P0_diagonal, ours"


def test_what_is_not_there_is_refused_by_the_file_and_the_table(tmp_path):
    found = read(tmp_path)
    with pytest.raises(AttributeError, match=r"scenario.toml \[filter\] has no 'Q', only P0_diag"):
        _ = found.filter.Q
    assert not hasattr(found, "filer")


def test_two_readings_are_equal_and_survive_a_copy_and_a_pickle(tmp_path):
    found = read(tmp_path)
    for other in (read(tmp_path), copy.deepcopy(found), pickle.loads(pickle.dumps(found))):
        assert other == found
        assert hash(other) == hash(found)
    assert found != read(tmp_path, TEXT.replace("2.5", "2.6"))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('where = "Section 4"', "", "where of the file must be a text .*, got None"),
        ('where = "ours: the text gives no value"', "where = 3", r"where of \[filter.ours\] must"),
        ("T = 0.1", "T = nan", "T must be finite, got nan"),
        ("T = 0.1", "T = 2020-01-01", "T must be "),
        ("T = 0.1", "table = 0.1", "name of an entry must not be file, where, table, got 'table'"),
        ("[8, 12]", "[8, inf]", "filter.ours.windows must be finite, got inf"),
        ("T = 0.1", "T = ", "Invalid value"),
    ],
)
def test_a_wrong_file_is_refused_by_its_name(tmp_path, old, new, message):
    assert TEXT.count(old) == 1
    with pytest.raises(ValueError, match=rf"scenario.toml: .*{message}"):
        read(tmp_path, TEXT.replace(old, new))


def test_fields_are_checked():
    with pytest.raises(ValueError, match="where must be a text"):
        Published("a.toml", "", {})
    with pytest.raises(ValueError, match="table must be a dict"):
        Published("a.toml", "Sec 1", [])
