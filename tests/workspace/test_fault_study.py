"""Results of the study of faults come out again, and the tables hold what the runs do."""

import pytest

from dopplerlib._data import read_json, results
from dopplerlib.workspace.fault_study import (
    LABELS,
    decision_table,
    lost_map,
    size_table,
    tracker_table,
)
from dopplerlib.workspace.faults import FAULTS
from studies import faults as study

ROWS = {
    (row["fault"], row["tracker"]): row for row in read_json("faults.json", folder=results)["rows"]
}


@pytest.mark.parametrize(
    ("fault", "tracker"),
    [
        ("none", "gate_each"), ("one noisier", "gated_start_ukf"), ("turn 1 rad/s", "paper"),
        ("outliers, 10 %", "gated_bank"), ("acceleration 3 m/s²", "moving_bank"),
        ("sensors off by 5 mm", "bank"), ("each late by up to 12.5 ms", "gate_upper"),
        ("deviation taken as half", "huber"),
    ],
)  # fmt: skip
def test_errors_come_out_again(fault, tracker):
    """Those of the first runs; a target that is lost multiplies rounding."""
    stored = ROWS[fault, tracker]["first"]
    again = study.errors_in(fault, tracker, study.FIRST).position[:, study.place(0.2)]
    assert again.tolist() == pytest.approx(stored, rel=0.01)


def test_a_decision_comes_out_again(monkeypatch):
    """Of few courses, which are the first of the many."""
    monkeypatch.setitem(study.PARAMETERS, "courses", 2)
    found = study.decisions_of("outliers, 1 %", "gated_bank")
    assert (found["collisions"], found["passing"]) == (2, 2)
    whole = ROWS["outliers, 1 %", "gated_bank"]["decisions"]
    assert found["late"] <= whole["late"]
    assert found["false"] <= whole["false"]


def test_every_fault_and_tracker_has_its_runs():
    assert {*ROWS} == {(fault, name) for fault in FAULTS for name in LABELS}
    assert {*LABELS} == {*study.COMPILED, *study.SLOW}
    for (_, name), row in ROWS.items():
        assert len(row["at"]) == len(study.times_of(name))
        assert all(one["lost"] >= one["given up"] for one in row["at"])
        assert ("decisions" in row) == (name in study.DECIDING)


def test_tables_and_map_hold_what_is_stored():
    one = ROWS["one noisier", "huber"]["at"][0]
    assert lost_map("0.2 s")["one noisier"]["EKF, Huber"] == one["lost"] / one["runs"]
    assert "EKF, Huber" not in lost_map("0.5 s")["one noisier"]
    assert tracker_table("one noisier").rows["EKF, Huber"][1].value == pytest.approx(
        1e3 * one["rms error"][0]
    )
    table = size_table("median NEES", ("gated_bank",), "0.5 s")
    assert table.rows["none"][0].value == ROWS["none", "gated_bank"]["at"][1]["median NEES"][0]
    late = decision_table("late").rows["two exchanged"][0]
    found = ROWS["two exchanged", "bank"]["decisions"]
    assert late.value == found["late"] / found["collisions"]
