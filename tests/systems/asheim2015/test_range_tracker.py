"""Gate, nearest neighbor and filter of one radar do what text or code say."""

from dataclasses import replace

import numpy as np
import pytest

from dopplerlib import kf
from dopplerlib.estimation.radial_velocity import radial_velocity_update
from dopplerlib.systems import asheim2015 as thesis
from dopplerlib.systems.asheim2015.evidence._formulas import gate_growth
from tests.gate_edges import beside_the_gate

F = np.array([[1, 0.1], [0, 1]])


@pytest.fixture(scope="module")
def z():
    return thesis.simulate_radars(3, rng=np.random.default_rng(1), duration=20).z[:, 0, :, None, :]


def test_without_a_gate_it_is_the_linear_filter(z):
    own = thesis.filter_settings("code", gate=None)
    track = thesis.track_ranges(z, own)
    # Every cycle of kf predicts first, so it gets all but the first scan.
    expected = kf(z[:, 1:, 0], F, own.Q, np.eye(2), np.diag(own.R(1.0)), z[:, 0, 0], own.P0)
    np.testing.assert_allclose(track.x[:, 1:], expected.x, rtol=1e-12)
    np.testing.assert_allclose(track.P[:, 1:], expected.P, rtol=1e-12)
    np.testing.assert_allclose(track.nis[:, 1:], expected.nis, rtol=1e-9)
    np.testing.assert_array_equal(track.x[:, 0], z[:, 0, 0])
    assert track.updated.all()


def test_range_then_velocity_is_the_linear_filter_of_both(z):
    """The pseudo-measurement of Table 3.3 after a range update, against both at once."""
    own = thesis.filter_settings("code", gate=None)
    track = thesis.track_ranges(z, own)
    (sr, sv) = np.sqrt(own.R(1.0))
    x, P = z[0, 0, 0], own.P0
    for k in range(1, 50):
        x, P = F @ x, F @ P @ F.T + own.Q
        K = P[:, 0] / (P[0, 0] + sr**2)
        x, P = x + K * (z[0, k, 0, 0] - x[0]), P - np.outer(K, P[0])
        x, P, _, _ = radial_velocity_update(x, (P + P.T) / 2, z[0, k, 0, 1], sv)
    np.testing.assert_allclose(track.x[0, 49], x, rtol=1e-10)
    np.testing.assert_allclose(track.P[0, 49], P, rtol=1e-9)


@pytest.mark.parametrize("doppler", [True, False])
@pytest.mark.parametrize("probability", [0.9, 0.999])
def test_the_gate_on_nis_ends_at_the_quantile_for_what_updates(doppler, probability):
    """Range and range rate, or the range alone."""
    own = replace(thesis.filter_settings("modern", 0.1), gate_probability=probability)
    m, start = 1 + doppler, np.array([3.0, 0.2])
    S = F @ own.P0 @ F.T + own.Q + np.diag(own.R((F @ start)[0]))
    for nu, inside in beside_the_gate(S[:m, :m], probability):
        z = np.array([start, F @ start])
        z[1, :m] += nu
        assert thesis.track_ranges(z[:, None], own, doppler=doppler).updated[1] == inside


def test_a_consistent_filter_loses_as_many_scans_as_the_gate_says():
    """Detections of a target that moves and is measured as the filter has it.

    One in a hundred of 20 000 scans: 200, with a standard deviation of 14; five of them, by chance
    1e-6. With one degree of freedom it would be 720.
    """
    own = replace(thesis.filter_settings("modern", 0.1), gate_probability=0.99)
    rng, runs, scans = np.random.default_rng(3), 100, 200
    x = np.array([2.0, 0.0]) + 0.1 * rng.standard_normal((runs, 2))  # P0 is 0.1 squared
    z = [np.broadcast_to([2.0, 0.0], (runs, 2))]
    for _ in range(scans):
        x = x @ F.T + rng.multivariate_normal([0, 0], own.Q, runs)
        z.append(x + np.sqrt(own.R(x[:, 0])) * rng.standard_normal((runs, 2)))
    track = thesis.track_ranges(np.stack(z, axis=1)[:, :, None], own)
    assert (~track.updated).sum() == pytest.approx(200, abs=70)


def test_the_printed_gate_is_a_box_whatever_the_covariance():
    """An innovation just inside or outside the box, at covariances that differ by 1e6."""
    own = thesis.filter_settings("text")
    for P0 in (1e-3, 1e3):
        wide = replace(own, P0=P0 * np.eye(2))
        for scale, inside in ((0.999, True), (1.001, False)):
            for i in range(2):
                off = scale * own.box[i] * np.eye(2)[i]
                detections = np.array([[[2.0, 0.0]], [[2.0 + off[0], off[1]]]])
                assert thesis.track_ranges(detections, wide).updated[1] == inside
    assert gate_growth(own) == 1


def test_a_gate_on_nis_opens_while_the_filter_coasts():
    own = thesis.filter_settings("modern")
    detections = np.full((60, 1, 2), np.nan)
    detections[0] = [2.0, 0.1]
    for k, used in ((1, False), (50, True)):
        trial = detections.copy()
        trial[k] = [2.0 + 0.01 * k + 0.5, 0.1]
        assert thesis.track_ranges(trial, own).updated[k] == used


def test_a_miss_is_a_prediction():
    own = thesis.filter_settings("code")
    detections = np.full((4, 2, 2), np.nan)
    detections[0, 0] = [2.0, 0.1]
    track = thesis.track_ranges(detections, own)
    np.testing.assert_allclose(track.x[:, 0], [2.0, 2.01, 2.02, 2.03])
    np.testing.assert_allclose(track.P[1], F @ own.P0 @ F.T + own.Q)
    assert track.updated.tolist() == [True, False, False, False]
    assert np.isnan(track.chosen[1:]).all()


def test_text_and_code_pick_different_detections():
    """Nearest in range but too fast, against a bit farther and fitting."""
    own = thesis.filter_settings("code")
    detections = np.array([[[2.0, 0.0], [np.nan] * 2], [[2.01, 3.0], [2.2, 0.1]]])
    text = thesis.track_ranges(detections, own)
    code = thesis.track_ranges(detections, own, association="nearest-first")
    assert text.updated[1] and not code.updated[1]
    np.testing.assert_array_equal(text.chosen[1], [2.2, 0.1])


def test_using_the_first_measurement_twice_moves_the_start(z):
    """The prediction carries it on by v T, and the update hardly corrects this."""
    own = thesis.filter_settings("code")
    once, twice = (thesis.track_ranges(z, own, reuse_first=r).x[:, 0] for r in (False, True))
    moved = twice - once
    expected = 0.1 * z[:, 0, 0, 1]
    np.testing.assert_allclose(moved[:, 0], expected, rtol=0.1)


@pytest.mark.parametrize("gate", ["box", "nis", None])
def test_the_nearest_is_that_of_least_nis(gate):
    """By hand, with S = F P0 F' + Q + R.

    Of three detections inside the gate the first is nearest in range and the second in velocity,
    but the third has the least NIS.
    """
    own = thesis.filter_settings("code", gate=gate)
    S = F @ own.P0 @ F.T + own.Q + np.diag(own.R(1.0))
    nu = np.array([[0.1, 0.5], [0.8, 0.0], [0.3, 0.05]])
    nis = np.sum(nu * np.linalg.solve(S, nu.T).T, axis=-1)
    assert [np.argmin(abs(nu[:, 0])), np.argmin(abs(nu[:, 1])), np.argmin(nis)] == [0, 1, 2]
    detections = np.full((2, 3, 2), np.nan)
    detections[0, 0] = [2.0, 0.1]
    detections[1] = np.array([2.01, 0.1]) + nu
    track = thesis.track_ranges(detections, own)
    np.testing.assert_allclose(track.chosen[1], detections[1, 2])
    assert track.nis[1] == pytest.approx(nis.min())


def test_the_noise_law_is_taken_at_the_predicted_range():
    """By hand: a detection two meters farther, where R is a hundred times larger."""
    own = thesis.filter_settings("modern", gate=None)
    z = np.array([[[2.0, 0.1]], [[4.0, 0.0]]])
    P = F @ own.P0 @ F.T + own.Q
    x = F @ z[0, 0]
    K = P @ np.linalg.inv(P + np.diag(own.R(x[0])))
    track = thesis.track_ranges(z, own)
    np.testing.assert_allclose(track.x[1], x + K @ (z[1, 0] - x), rtol=1e-10)


def test_a_gate_on_nis_looks_at_the_rate_only_if_the_filter_uses_it():
    own = thesis.filter_settings("modern")
    detections = np.array([[[2.0, 0.1]], [[2.01, 9.0]]])
    for doppler in (True, False):
        assert thesis.track_ranges(detections, own, doppler=doppler).updated[1] == (not doppler)


def test_the_gate_on_ranges_alone_has_one_degree_of_freedom():
    """A thousandth is beyond a squared normal number of 10.83, for two it would be 13.82."""
    own = thesis.filter_settings("modern")
    S = (F @ own.P0 @ F.T + own.Q)[0, 0] + own.R(2.01)[0]
    for nis, inside in ((10.7, True), (10.9, False)):
        detections = np.array([[[2.0, 0.1]], [[2.01 + np.sqrt(nis * S), 0.1]]])
        assert thesis.track_ranges(detections, own, doppler=False).updated[1] == inside


def test_the_first_detection_of_the_first_scan_starts_the_track_wherever_it_stands():
    detections = np.full((2, 3, 2), np.nan)
    detections[0, 1:] = [[2.0, 0.1], [3.0, 0.2]]
    track = thesis.track_ranges(detections, thesis.filter_settings("code"))
    assert track.x[0].tolist() == track.chosen[0].tolist() == [2.0, 0.1]
    assert track.updated.tolist() == [True, False]


@pytest.mark.parametrize("reuse_first", [False, True])
def test_an_empty_first_scan_needs_a_start_and_that_is_no_detection(reuse_first):
    detections = np.full((3, 1, 2), np.nan)
    own, options = thesis.filter_settings("code"), {"reuse_first": reuse_first}
    with pytest.raises(ValueError, match="x0 must be given where the first scan is empty"):
        thesis.track_ranges(detections, own, **options)
    track = thesis.track_ranges(detections, own, x0=[1.9, 0.0], **options)
    assert track.x[0].tolist() == [1.9, 0.0]
    assert np.isnan(track.chosen).all() and not track.updated.any()


@pytest.mark.parametrize("shape", [(0, 1, 2), (3, 0, 2)])
def test_a_record_without_room_for_a_detection_is_refused(shape):
    with pytest.raises(ValueError, match="detections must have scans and detections in each"):
        thesis.track_ranges(np.empty(shape), thesis.filter_settings("code"), x0=[1.9, 0.1])
