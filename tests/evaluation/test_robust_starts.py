"""Starts with wrong windows, saved by a study: made again in parts, and what they show."""

import numpy as np
import pytest

from dopplerlib.evaluation.robust_starts import RobustStarts, saved_starts
from studies import robust_start as study

PARAMETERS = study.PARAMETERS


@pytest.fixture(scope="module")
def saved():
    return saved_starts()


def test_a_part_of_the_study_comes_out_again(saved):
    settings, runs = {"scene": "road", "kind": "target", "fraction": 0.2}, range(28, 36)
    again = study.compute(settings, PARAMETERS["seed"], runs)["outcome"]
    there = saved.runs(*settings.values())
    error, converged = saved.error[there][runs], saved.converged[there][runs]
    # Four digits are saved; fits end within 1e-5 of a deviation of a centimeter.
    np.testing.assert_allclose(again[:, :3], error, rtol=1e-3, atol=1e-6)
    assert (again[:, 3:] == converged).all()


def test_all_runs_are_there(saved):
    for scene in study.SCENES:
        for kind in study.KINDS:
            for fraction in PARAMETERS["fractions"]:
                runs = PARAMETERS["chunks"] * PARAMETERS[f"{scene}_runs"]
                assert saved.runs(scene, kind, fraction).sum() == runs


def test_wrong_windows_cost_a_robust_start_less_than_a_factor_of_two(saved):
    for scene in study.SCENES:
        for kind in study.KINDS:
            robust, plain = saved.ratios(scene, kind, rng=np.random.default_rng(1))
            assert robust[:, 0].tolist() == PARAMETERS["fractions"]
            assert (robust[:4, 1] < 2).all(), (scene, kind, robust)
            assert plain[0, 1] == 1 and (plain[1:, 1] > 2).all(), (scene, kind, plain)


def test_a_ratio_is_that_of_root_mean_squares():
    error = np.array([[1.0, 2, 4], [1, 2, 4], [3, 3, 3]])
    starts = RobustStarts(
        np.array(["road"] * 3), np.array(["scattered"] * 3), np.array([0.1, 0.1, 0]), error,
        np.array([[True, False]] * 3),
    )  # fmt: skip
    found = starts.ratios("road", "scattered", rng=np.random.default_rng(1))
    assert found[:, 0, :2].tolist() == [[0, 1], [0, 1]]
    assert found[:, 1].tolist() == [[0.1, 2, 2, 2], [0.1, 4, 4, 4]]
    assert starts.counts("road").tolist() == [[1, 1, 0], [2, 2, 0]]
