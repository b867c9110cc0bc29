"""Results of the study of symptoms come out again, and the tables hold what the runs do."""

import numpy as np
import pytest

from dopplerlib._data import read_json, results
from dopplerlib.evaluation.symptom_study import LOOKS, cause_table, confusions, symptom_table
from studies import symptoms as study

ROWS = read_json("symptoms.json", folder=results)["rows"]


@pytest.mark.parametrize("item", [("nothing", 3), ("one sensor late by 30 to 100 ms", 7)])
def test_a_run_comes_out_again(item):
    """To the digits that are stored, but for p-values, which magnify rounding."""
    (stored,) = (row for row in ROWS if (row["mistake"], row["run"]) == item)
    again = study.row(*item)
    assert again.keys() == stored.keys()
    for key, value in again.items():
        if isinstance(value, float):
            assert value == pytest.approx(stored[key], rel=0.02), key
        else:
            assert value == stored[key], key


def test_every_mistake_has_its_runs_and_its_look():
    assert list(LOOKS) == list(study.MISTAKES) == list(symptom_table().rows)
    for mistake in LOOKS:
        runs = [row["run"] for row in ROWS if row["mistake"] == mistake]
        assert runs == list(range(study.PARAMETERS["runs"]))


def test_the_tables_count_runs():
    nis = [row["NIS"] for row in ROWS if row["mistake"] == "hum"]
    assert symptom_table().rows["hum"][1].value == pytest.approx(np.median(nis))
    named = [row["cause"] for row in ROWS if row["mistake"] == "sampling rate 1 % too low"]
    cause, fraction, *_ = cause_table().rows["sampling rate 1 % too low"]
    assert cause == "none found"
    assert fraction.value == pytest.approx(named.count(cause) / len(named))
    mixed = confusions()
    assert mixed.rows["sampling rate 1 % too low"][mixed.columns.index(cause)] == named.count(cause)
    assert "hum" not in mixed.rows


def test_the_cause_that_should_be_named_mostly_is():
    """The study states beforehand which mistakes show nothing, and which cause is right."""
    table = cause_table().rows
    right = [name for name, (_, cause) in study.MISTAKES.items() if table[name][0] == cause]
    assert table["two sensors exchanged"][2].value > 0.9
    assert set(study.MISTAKES) - set(right) == {
        "one sensor late by 30 to 100 ms", "carrier 1 % too low", "50 ms of samples lost",
    }  # fmt: skip
