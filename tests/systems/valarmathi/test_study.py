"""The saved study: that it is complete, that a cell comes out again, and what follows from it.

Where a test is about random numbers, its limits leave room for all but one seed in a million; the
file is fixed, and only a new one could fail by chance.
"""

import numpy as np
import pytest
from scipy.stats import norm

from dopplerlib._data import read_lines, results
from dopplerlib.evaluation.intervals import ConfidenceInterval, mean_interval, proportion_interval
from dopplerlib.systems import valarmathi as system
from dopplerlib.systems.valarmathi import fusion_study as made
from dopplerlib.systems.valarmathi.velocity_paths import PATHS
from studies import velocity_fusion as tool

OWN = system.reported().chosen
FALSE_ALARM = 1e-6
Z = norm.isf(FALSE_ALARM / 2)
HALF = (OWN.fixed_window - 1) / 2 * system.reported().stated.T
BOTH = ("path 1", "path 2")


@pytest.fixture(scope="module")
def study():
    return system.saved_study()


@pytest.fixture(scope="module")
def table():
    return system.study_table()


def lines(name, cell):
    """Return the rows of one cell in a file, as text without path and ratio."""
    head = ",".join(cell) + ","
    rows = read_lines(f"velocity_fusion.{name}.csv", folder=results)[1:]
    return [row.removeprefix(head).split(",") for row in rows if row.startswith(head)]


def test_the_study_covers_every_path_ratio_and_algorithm_with_enough_runs(study):
    assert study.paths == PATHS
    np.testing.assert_array_equal(study.snrs_db, made.SNRS_DB)
    assert (study.snrs_db[0], study.snrs_db[-1], np.ptp(np.diff(study.snrs_db))) == (-10, 40, 0)
    rows = np.loadtxt(
        read_lines("velocity_fusion.errors.csv", folder=results), delimiter=",", skiprows=1
    )
    keys, counts = np.unique(rows[:, :3], axis=0, return_counts=True)
    assert len(keys) == len(PATHS) * len(made.SNRS_DB) * len(system.ALGORITHMS)
    assert set(counts) == {made.RUNS} and made.RUNS >= 100
    np.testing.assert_array_equal(study.of("delay", "path 2", 4)[2], rows[
        (rows[:, :3] == [2, 0, 4]).all(axis=-1), 7
    ])  # fmt: skip
    shares = system.saved_failures()
    assert set(shares) == {(path, a) for path in PATHS for a in system.ALGORITHMS}
    for snrs_db, _ in shares.values():
        np.testing.assert_array_equal(snrs_db, made.CLIFF_SNRS_DB)


@pytest.mark.parametrize("cell", [("1", "5"), ("3", "-10")])
def test_a_cell_comes_out_again_alone(table, cell):
    """Eight of its runs; the first are the same however many follow.

    Sums of single precision may come out in another order on another processor: rarely another
    window is chosen then, which changes the runs of algorithms 2, 4 and 5.
    """
    runs = 8
    again = system.study_cell(PATHS[int(cell[0]) - 1], float(cell[1]), table, runs)
    rows = np.array(tool.error_rows(system.cell_measures(again))).reshape(6, runs, -1)
    saved = np.array(lines("errors", cell)).reshape(6, made.RUNS, -1)[:, :runs]
    assert (rows == saved).mean() > 0.9
    fixed = [0, 2, 5]
    np.testing.assert_allclose(rows[fixed].astype(float), saved[fixed].astype(float), rtol=2e-3)
    summary = system.saved_study().summary(PATHS[int(cell[0]) - 1], float(cell[1]))
    for name, columns in again.summary().items():
        if name[0] in "136":
            for title, values in columns.items():
                np.testing.assert_allclose(summary[name][title][:runs], values, rtol=2e-3)


def test_the_number_of_failed_runs_comes_out_again(table):
    again = system.cell_measures(system.study_cell("path 2", -8.0, table, 8))
    for (a, runs, failed), saved in zip(
        tool.failure_rows(again), lines("threshold", ("2", "-8")), strict=True
    ):
        share = int(saved[2]) / int(saved[1])
        assert [str(a), runs] == [saved[0], 8]
        # The first eight of two hundred, of which almost all failed.
        assert share > 0.95 and failed >= 6
    # Of the runs with which both files begin, the same ones fail.
    both = system.cell_measures(system.study_cell("path 2", -5.0, table, 8))[3, "whole"]
    np.testing.assert_allclose(
        both, system.saved_study().of("whole", "path 2", 3)[1, :8], rtol=2e-3
    )


def test_another_seed_agrees_within_what_chance_allows(study, table):
    again = system.cell_measures(system.study_cell("path 2", 10.0, table, 10, seed=77))
    j = int(np.flatnonzero(study.snrs_db == 10)[0])
    for (algorithm, measure), values in again.items():
        saved = np.log(np.abs(study.of(measure, "path 2", algorithm)[j]))
        values = np.log(np.abs(values))
        scatter = np.hypot(saved.std() / np.sqrt(saved.size), saved.std() / np.sqrt(values.size))
        if measure == "delay" and algorithm == 6:
            continue  # it is zero but for noise
        assert abs(values.mean() - saved.mean()) < Z * scatter, (algorithm, measure)


def test_either_file_has_its_cells_in_the_order_of_paths_and_ratios(monkeypatch):
    """Made of what a cell was made with: number of the path, ratio and runs."""
    monkeypatch.setattr(tool.made, "study_table", lambda: None)
    monkeypatch.setattr(tool.made, "study_cell", lambda name, snr_db, table, runs: runs)
    monkeypatch.setattr(tool.made, "cell_measures", lambda runs: runs)
    monkeypatch.setattr(tool, "error_rows", lambda runs: [["errors", runs]])
    monkeypatch.setattr(tool, "failure_rows", lambda runs: [["failures", runs]])
    monkeypatch.setattr(tool.swept, "PATHS", {"path 2": ("path 2", None)})
    monkeypatch.setattr(tool.swept, "SNRS_DB", (10,))
    monkeypatch.setattr(tool.swept, "sweep_cell", lambda name, snr_db, table, runs: (name, runs))
    monkeypatch.setattr(tool, "sweep_rows", lambda name, snr_db, cell: [f"{cell}"])
    parameters = {"snrs_db": [0.0, 5.0], "threshold_snrs_db": [-1.5]}
    monkeypatch.setattr(tool, "PARAMETERS", tool.PARAMETERS | parameters)
    errors, failures, swept = tool.contents(
        [tool.compute(settings, 1, range(runs)) for settings, runs, _ in tool.parts()]
    )
    assert errors.splitlines() == [
        tool.HEADS[0],
        *(f"{path},{snr_db},errors,{made.RUNS}" for path in (1, 2, 3) for snr_db in (0, 5)),
    ]
    assert failures.splitlines() == [
        tool.HEADS[1],
        *(f"{path},-1.5,failures,{made.CLIFF_RUNS}" for path in (1, 2, 3)),
    ]
    assert swept.splitlines() == [tool.HEADS[2], f"('path 2', {tool.swept.RUNS})"]


def test_the_sweep_has_every_cell_and_one_comes_out_again_alone(table):
    """One run of it; a window may be chosen otherwise on another processor, as above."""
    sweep = system.saved_sweep()
    assert {len(runs) for runs in sweep.cells.values()} == {tool.swept.RUNS}
    cells = {(path, snr_db) for path in tool.swept.PATHS for snr_db in tool.swept.SNRS_DB}
    assert {key[:2] for key in sweep.cells} == cells
    again = tool.swept.sweep_cell("path 1, 5 m/s²", 10, table, runs=1)
    assert {key[2:] for key in sweep.cells if key[:2] == ("path 1, 5 m/s²", 10)} == set(again)
    saved = np.array([sweep.cells["path 1, 5 m/s²", 10, *key][0] for key in again])
    found = np.array([float(f"{values[0]:.4g}") for values in again.values()])
    assert (np.abs(found / saved - 1) < 2e-3).mean() > 0.9
    lines = tool.sweep_rows("path 1, 5 m/s²", 10, again)
    written = read_lines("velocity_fusion.sweep.csv", folder=results)
    assert written[0] == tool.HEADS[2]
    heads = {line.rpartition(",")[0].rsplit(",", 5)[0] for line in lines}
    assert heads == {
        line.rpartition(",")[0].rsplit(",", 5)[0] for line in written if line.startswith("1,10,")
    }
    with pytest.raises(ValueError, match="must be a cell of the sweep"):
        sweep.of("cee", "1", 7, path="path 2", snr_db=0, q=30)


def test_errors_at_constant_velocity_fall_with_the_amplitude_of_the_noise(study):
    """By a factor of ten in 20 dB, where the window and not the filter averages the noise.

    At lower ratios the filter trusts its measurements less and averages longer: in between, the
    error falls by the power 3/4 of that.
    """
    at = {snr: int(np.flatnonzero(study.snrs_db == snr)[0]) for snr in (0, 5, 20, 40)}
    for path in BOTH:
        for algorithm in (1, 3):
            logs = np.log(study.of("constant", path, algorithm))
            for a, b, power in ((20, 40, 1.0), (0, 5, 0.75)):
                fall = logs[at[a]].mean() - logs[at[b]].mean()
                scatter = np.sqrt((logs[at[a]].var() + logs[at[b]].var()) / logs.shape[1])
                expected = power * (b - a) / 20 * np.log(10)
                assert abs(fall - expected) < Z * scatter + 0.02, (path, algorithm, a)


def test_two_fixed_filters_have_half_of_the_variance_of_one_at_constant_velocity(study):
    """The noise of two sensors is independent."""
    for path in PATHS:
        for j in np.flatnonzero(study.snrs_db >= 5):
            ratio = study.of("constant", path, 3)[j] / study.of("constant", path, 1)[j]
            found = mean_interval(ratio**2, 1 - FALSE_ALARM)
            # The ratio of two scattered numbers is too large in the mean, by its variance; and a
            # fighter that has just maneuvered is followed late by both.
            assert found.low - 0.05 < 0.5 < found.high + 0.05


def test_a_filter_that_is_late_errs_by_acceleration_times_delay_and_does_not_fail(study):
    high = study.snrs_db >= 20
    for path in PATHS:
        a = system.velocity_path(path).a
        expected = np.sqrt(np.mean(a[a != 0] ** 2)) * HALF
        for algorithm in (1, 3):  # two late filters are together just as late
            rmse = study.of("maneuver", path, algorithm)[high]
            # A little less, since the delay needs half a window to build up after each jump.
            np.testing.assert_allclose(rmse, expected, rtol=0.04)
            delay = study.of("delay", path, algorithm)[high]
            np.testing.assert_allclose(delay, 1e3 * HALF, rtol=0.02)
        assert np.quantile(study.of("whole", path, 1)[high], 0.95) < OWN.failed_rmse


def test_an_adaptive_window_is_less_late_in_the_fast_maneuver_and_not_always_in_a_gentle_one(study):
    good = study.snrs_db >= 0
    for algorithm in (2, 4, 5):
        delay = np.median(study.of("delay", "path 2", algorithm)[good], axis=-1)
        assert (delay < 0.6e3 * HALF).all() and delay[-1] < 0.15e3 * HALF
        assert (np.diff(delay) < 1.0).all()  # windows become shorter with less noise, in ms
    for algorithm in (2, 4):
        rmse = study.of("maneuver", "path 2", algorithm)[good]
        assert (
            np.median(rmse, axis=-1) < 0.7 * np.median(study.of("maneuver", "path 2", 1)[good])
        ).all()
    # At 0 dB the best window of the gentle path is longer than the fixed one.
    gentle = study.of("delay", "path 1", 4)[study.snrs_db == 0]
    assert np.median(gentle) > 1.2e3 * HALF


def test_fusing_adaptive_filters_changes_the_error_of_the_fast_maneuver_by_little(study):
    good = study.snrs_db >= 0
    for what, low, high in (("maneuver", 0.95, 1.05), ("cee", 0.96, 1.0)):
        one, two = (study.of(what, "path 2", a)[good] for a in (2, 4))
        ratio = np.mean(two / one, axis=-1)
        assert ((low < ratio) & (ratio < high)).all()


def test_at_constant_velocity_two_adaptive_filters_are_better_than_any_other(study):
    for path in BOTH:
        error = {a: np.median(study.of("constant", path, a), axis=-1) for a in system.ALGORITHMS}
        for other in (1, 2, 3, 6):
            assert (error[4] < error[other]).all(), (path, other)
    # And at once less late in the fast maneuver than those with a fixed window.
    for a in (1, 3):
        good = study.snrs_db >= 0
        late = np.median(study.of("maneuver", "path 2", a)[good], axis=-1)
        assert (np.median(study.of("maneuver", "path 2", 4)[good], axis=-1) < late).all()


def test_both_orders_of_adapting_and_fusing_agree_on_the_fast_path_only(study):
    good = (study.snrs_db >= 0) & (study.snrs_db <= 30)
    fast, gentle = (
        np.mean(study.of("whole", path, 5)[good] / study.of("whole", path, 4)[good], axis=-1)
        for path in ("path 2", "path 1")
    )
    assert np.abs(fast - 1).max() < 0.06
    # The shared window follows a gentle acceleration better, since it is known with less noise.
    assert (gentle < 0.95).all() and gentle.min() < 0.85


def test_fusion_takes_away_the_part_of_the_error_that_is_noise(study):
    """That part is smaller where the delay costs more, and where there is less noise."""
    good = study.snrs_db >= 0
    taken = {
        path: 1 - np.mean(study.of("cee", path, 3)[good] / study.of("cee", path, 1)[good], axis=-1)
        for path in PATHS
    }
    assert (taken["path 1"] > 1.5 * taken["path 2"]).all()
    assert (np.diff(taken["path 1"]) < 0).all()
    assert (taken["fighter"] > 0).all()


def test_at_low_ratios_adaptation_helps_on_the_fast_path_only(study):
    low = (study.snrs_db >= 0) & (study.snrs_db <= 5)
    for a in (4, 5):
        fast, gentle = (
            np.mean(study.of("whole", path, a)[low] / study.of("whole", path, 1)[low], axis=-1)
            for path in ("path 2", "path 1")
        )
        assert (fast < 0.7).all() and (gentle > 0.85).all()


def test_no_algorithm_fails_from_0_dB_on(study):
    shares = system.saved_failures()
    for path in PATHS:
        for a in system.ALGORITHMS:
            whole = study.of("whole", path, a)
            assert (whole[study.snrs_db >= 0] < OWN.failed_rmse).all()
            assert (whole[study.snrs_db == -10] > OWN.failed_rmse).mean() > 0.9
            limit = system.failure_limit(*shares[path, a])
            assert -8 < limit.low < limit.value < limit.high < -2
            # What the coarse study has at -5 dB fits to the fine one, with another 100 runs.
            coarse = proportion_interval(whole[1] > OWN.failed_rmse, 1 - FALSE_ALARM)
            fine = shares[path, a][1][int(np.flatnonzero(shares[path, a][0] == -5)[0])]
            assert coarse.low <= fine.high and fine.low <= coarse.high


def test_one_sensor_fails_where_two_fail():
    """Noise that makes higher peaks than the tone does so at both sensors."""
    shares = system.saved_failures()
    for path in PATHS:
        one, two = (system.failure_limit(*shares[path, a]).value for a in (2, 4))
        assert abs(one - two) < 3


def test_a_limit_lies_where_the_share_passes_it_for_the_last_time():
    def shares(*values):
        return [ConfidenceInterval(v, max(v - 0.02, 0.0), min(v + 0.02, 1.0)) for v in values]

    found = system.failure_limit([0, 1, 2, 3], shares(0.9, 0.04, 0.09, 0.0), 0.05)
    assert found.value == pytest.approx(2 + 4 / 9)
    assert found.low == pytest.approx(2 + 2 / 7)
    assert found.high == pytest.approx(2 + 6 / 9)
    with pytest.raises(ValueError, match="shares must pass"):
        system.failure_limit([0, 1], shares(0.9, 0.8), 0.05)
