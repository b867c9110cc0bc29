"""The saved study of the scheme of Fig 6: it can be made again, and it counts what it says."""

from dataclasses import astuple

import numpy as np
import pytest

from dopplerlib.evaluation.intervals import proportion_interval
from dopplerlib.systems import macaveiu2013 as paper
from studies import vehicle_tracking as tool

PATHS = paper.vehicle_paths()
K = paper.automotive_settings().samples


@pytest.mark.parametrize(
    ("figure", "run", "variant"),
    [
        (8, 3, "pedestrian as in Fig 6"),
        (9, 151, "8 hits of 10"),
        (11, 77, "rule for new tracks only"),
    ],
)
def test_a_record_of_the_study_comes_out_again(figure, run, variant):
    """Exactly, to the digits written: counts, and errors to 0.1 mm."""
    scans = paper.study_record(figure, run, variant)
    found = paper.study_outcome(scans, PATHS[figure].truth, variant)
    on_file = [values[run] for values in paper.saved_outcomes()[figure, variant].values()]
    assert [float(tool.text(value)) for value in astuple(found)] == on_file
    if not variant.startswith("pedestrian"):
        counted = [values[run] for values in paper.saved_detections()[figure].values()]
        assert list(astuple(paper.count_detections(scans))) == counted


def test_the_study_covers_every_path_and_every_variant():
    found = paper.saved_outcomes()
    assert set(found) == {(i, name) for i in PATHS for name in paper.study_variants(i)}
    for values in found.values():
        assert all(len(one) == paper.processing_study.RUNS for one in values.values())
        assert (values["held"] + values["first"] <= K).all() and (values["begun"] > 0).all()
        assert (values["begun"] >= values["tracks"] + values["false"]).all()
    assert set(paper.saved_detections()) == set(PATHS)


def test_both_files_are_sorted_by_path_and_record(monkeypatch):
    """Made of what a record was made with."""
    monkeypatch.setattr(
        tool, "lines", lambda figure, run: ([f"{figure},1,{run}"], [f"{figure},{run}"])
    )
    found = [
        tool.compute(settings, tool.PARAMETERS["seed"], range(runs))
        for settings, runs, _ in tool.parts()
    ]
    expected = [(figure, run) for figure in sorted(PATHS) for run in range(tool.PARAMETERS["runs"])]
    for text, columns in zip(tool.contents(found), ((0, 2), (0, 1)), strict=True):
        head, *lines = text.splitlines()
        assert head.startswith("figure,")
        keys = [tuple(int(line.split(",")[column]) for column in columns) for line in lines]
        assert keys == expected


def scan(z, source):
    return paper.VehicleScan(np.reshape(np.array(z, float), (-1, 3)), np.array(source, int))


def test_an_outcome_counts_tracks_breaks_and_false_ones():
    """By hand: a target that recedes, hidden from scan 20 to 39; a ghost in scans 5 to 12.

    Tracks need 4 hits and end at 13 misses. The target is held from scan 3 to the 12th scan without
    it, 31, and again from the fourth hit, 43. The ghost counts from its fourth hit, 8, to 24.
    """
    path = PATHS[7].truth[:60]
    z = np.stack([path[:, 2], np.zeros(60), path[:, 3]], axis=-1)
    scans = []
    for k in range(60):
        seen = [(z[k], paper.TARGET)] if not 20 <= k < 40 else []
        seen += [((40.0 + 2 * 0.038 * k, 0.3, 2.0), paper.processing.FALSE)] if 5 <= k < 13 else []
        scans.append(scan([one for one, _ in seen], [source for _, source in seen]))
    found = paper.study_outcome(scans, path)
    assert (found.first, found.breaks, found.tracks) == (3, 1, 2)
    assert found.held == (32 - 3) + (60 - 43)
    assert (found.false, found.false_scans, found.begun) == (1, 25 - 8, 3)
    assert found.error < 0.2
    counted = paper.count_detections(scans)
    assert astuple(counted) == (40, 0, 0, 0)
    with pytest.raises(ValueError, match="variant must be one of"):
        paper.study_outcome(scans, path, "as in Fig 5")


def test_a_record_without_a_target_has_no_error():
    found = paper.study_outcome([scan([], [])] * 5, PATHS[7].truth[:5])
    assert found.held == 0 and found.first == 5 and np.isnan(found.error)


def test_the_clutter_rule_deletes_the_predicted_shares():
    """Means of 200 records, within 5 of their deviations: chance 6e-7 each."""
    for figure, path in PATHS.items():
        one = paper.saved_detections()[figure]
        for kind, predicted in (
            ("clutter", paper.deleted_fraction()),
            ("target", paper.deleted_fraction(path.truth)),
        ):
            share = one[f"{kind}_deleted"] / one[kind]
            off = abs(share.mean() - predicted)
            assert off <= 5 * share.std() / np.sqrt(len(share)) + 1e-9, (figure, kind)
    nearly_all = paper.deleted_fraction(limit=3 * paper.reported().scenario.polar.sigma_rate)
    assert nearly_all == pytest.approx(0.9973, abs=1e-4)  # three deviations of a normal variable


def test_more_hits_leave_fewer_false_tracks_and_start_later():
    few, many = (paper.saved_outcomes()[9, name] for name in ("as in Fig 6", "8 hits of 10"))
    assert proportion_interval(few["false"] > 0).low > 0.5
    assert proportion_interval(many["false"] > 0).high < 0.05
    assert (many["first"] > few["first"]).all()


def test_the_clutter_rule_breaks_the_track_of_a_crossing_pedestrian_and_not_that_of_a_car():
    found = paper.saved_outcomes()
    for figure in (8, 11):
        car, walker = (found[figure, f"{who}as in Fig 6"] for who in ("", "pedestrian "))
        assert proportion_interval(car["breaks"] > 0).high < 0.1
        assert proportion_interval(walker["breaks"] > 0).low > 0.6
        kept = found[figure, "pedestrian with rule for new tracks only"]
        assert (
            proportion_interval(kept["breaks"] > 0).high
            < proportion_interval(walker["breaks"] > 0).low
        )


def test_with_one_target_the_hungarian_rule_changes_next_to_nothing():
    for figure in PATHS:
        plain, other = (
            paper.saved_outcomes()[figure, name] for name in ("as in Fig 6", "Hungarian")
        )
        assert proportion_interval(plain["held"] != other["held"]).high < 0.05


def test_a_pedestrian_is_one_point_and_a_car_a_row_of_them():
    truth = PATHS[8].truth[:2]
    np.testing.assert_array_equal(paper.reflection_points(truth, 1)[:, 0], truth)
    car = paper.reflection_points(truth)
    np.testing.assert_allclose(np.ptp(car[..., 0], axis=1), paper.processing.LENGTH)
    np.testing.assert_allclose(car.mean(axis=1), truth)
