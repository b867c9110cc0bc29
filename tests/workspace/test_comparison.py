"""Errors of trackers in the four cases, their statistics, and a few runs of the saved study."""

import numpy as np
import pytest
from scipy.stats import chi2, norm

from dopplerlib import doppler_shift
from dopplerlib._data import read_json, results
from dopplerlib.workspace.comparison import case_errors, saved_comparison
from dopplerlib.workspace.errors import AXIS_95, EVERY, NEES_95, TrackErrors, error_summary
from dopplerlib.workspace.targets import ARRAY
from studies import consistent_tracker as study


def test_constants_are_the_quantiles():
    assert NEES_95 == pytest.approx(chi2.ppf(0.95, 6), rel=1e-12)
    assert AXIS_95 == pytest.approx(norm.ppf(0.975), rel=1e-12)


@pytest.mark.parametrize("case", "AD")
def test_a_study_may_be_made_in_pieces(case):
    whole = case_errors(case, "ekf", 0, 3, seed=1)
    piece = case_errors(case, "ekf", 1, 2, seed=1)
    for name in ("nees", "axes", "position", "velocity_bound"):
        np.testing.assert_allclose(getattr(piece, name), getattr(whole, name)[1:], rtol=1e-6)
    np.testing.assert_allclose(np.sum(whole.axes**2, axis=-1), whole.nees, rtol=1e-4)


def test_trackers_get_the_same_records_and_what_they_assume():
    one, other = (case_errors("A", name, 0, 2, seed=1) for name in ("ekf", "bank"))
    np.testing.assert_array_equal(one.position_bound, other.position_bound)
    assert (one.position != other.position).any()
    wrong = [
        case_errors("A", "bank", 0, 2, seed=1, **assumed)
        for assumed in ({"sigma_f": 0.5}, {"sigma_a": 0.2}, {"prior": "broad"})
    ]
    for errors in wrong:
        np.testing.assert_array_equal(errors.position_bound, other.position_bound)
        assert (errors.position != other.position).any()


def test_statistics_are_those_of_the_runs_that_have_not_ended():
    rng = np.random.default_rng(1)
    axes = rng.standard_normal((40, 2, 6))
    axes[:10, 1] = np.nan
    there = ~np.isnan(axes[..., 0])
    position = np.where(there, 0.01, np.nan)
    position[10, 1] = 0.2  # lost: more than 5 cm and 4 bounds
    position[11, 1] = 0.06  # not lost: that is 3 bounds
    errors = TrackErrors(
        np.sum(axes**2, axis=-1), axes, position, 2 * position,
        np.where(there, 0.02, np.nan), np.where(there, 0.1, np.nan),
    )  # fmt: skip
    found = error_summary(errors)
    assert found.runs.tolist() == [40, 30]
    late = np.sum(axes[10:, 1] ** 2, axis=-1)
    assert found.nees[1] == pytest.approx(late.mean())
    assert found.nees_error[1] == pytest.approx(late.std(ddof=1) / np.sqrt(30))
    assert found.nees_median[1] == pytest.approx(np.median(late))
    assert found.inside[1] == pytest.approx(np.mean(late < chi2.ppf(0.95, 6)))
    np.testing.assert_allclose(found.axes[1], np.mean(np.abs(axes[10:, 1]) < 1.96, axis=0))
    square = (28 * 1e-4 + 0.04 + 0.0036) / 30
    assert found.position[1] == pytest.approx(np.sqrt(square))

    scatter = np.std([1e-4] * 28 + [0.04, 0.0036], ddof=1) / np.sqrt(30)
    assert found.position_error[1] == pytest.approx(scatter / square / 2)
    assert found.velocity[0] == pytest.approx(0.02)
    assert (found.position_bound[1], found.velocity_bound[1]) == pytest.approx((0.02, 0.1))
    assert found.lost.tolist() == pytest.approx([0, 1 / 30])
    np.testing.assert_allclose(found.nees_worst[1], sorted(late)[:-4:-1])
    np.testing.assert_allclose(found.position_worst[1], [0.2, 0.06, 0.01])
    np.testing.assert_allclose(found.time, [EVERY * 1e-3, 2 * EVERY * 1e-3])


def test_the_errors_are_those_of_the_tracker(monkeypatch):
    """A tracker that is off by one claimed deviation in each component has NEES six."""
    from dopplerlib.workspace import comparison

    def off(z, tracker, *, every, **_):
        paths.append(z)
        x = np.full((len(z), z.shape[1] // every, 6), np.nan)
        truth = drawn[0][:, every - 1 :: every]
        x[:] = truth + np.array([0.3, 0.4, 0, 0, 0, 0.1])
        x[0, 7] = np.nan
        return x, np.broadcast_to(np.diag([0.3, 0.4, 1, 1, 1, 0.1]) ** 2, (*x.shape, 6))

    paths, drawn, draw = [], [], comparison.draw_targets
    monkeypatch.setattr(
        comparison, "draw_targets", lambda *a, **k: drawn.append(draw(*a, **k)) or drawn[0]
    )
    monkeypatch.setattr(comparison, "track_targets", off)
    errors = case_errors("D", "ekf", 0, 2, seed=1)
    expected = np.full((2, 50), 3.0)
    expected[0, 7] = np.inf
    np.testing.assert_allclose(errors.nees, expected)
    np.testing.assert_allclose(errors.position[1], 0.5)
    np.testing.assert_allclose(errors.velocity[1], 0.1)
    noise = (paths[0] - doppler_shift(drawn[0], ARRAY)) / 0.4
    assert abs(noise.std() - 1) < 0.05


@pytest.mark.parametrize(
    "name", [("A", "bank"), ("B", "bank"), ("C", "bank"), ("D", "bank"), ("A", "paper")]
)
def test_the_first_runs_of_the_saved_study_come_out_again(name):
    saved = read_json("consistent_tracker.json", folder=results)
    rows = {(row["case"], row["tracker"], row["assumed"]): row for row in saved["rows"]}
    runs, times = study.FIRST
    found = case_errors(*name, 0, len(runs), seed=saved["seed"]).nees[:, times]
    # Four digits are saved. A filter that is lost amplifies rounding.
    np.testing.assert_allclose(
        found, rows[*name, "right"]["first"], rtol=1e-3 if name[1] == "bank" else 0.02
    )


def test_the_saved_study_holds_all_that_was_tried():
    saved = saved_comparison()
    tried = {tuple(settings.values()): runs for settings, runs, _ in study.parts()}
    assert {name: one.runs[0] for name, one in saved.items()} == tried
