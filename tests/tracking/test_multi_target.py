"""The loop over scans, against a filter that is told which detection is whose."""

import numpy as np
import pytest

from dopplerlib import TrackManager, kf
from dopplerlib.model.motion import cwna_process_noise, ncv_transition
from dopplerlib.model.polar_radar import polar_radar_h, polar_radar_jacobian
from dopplerlib.tracking.association import greedy_assign
from dopplerlib.tracking.multi_target import track_scans
from tests.gate_edges import beside_the_gate

T, K = 0.5, 20
F, Q = ncv_transition(T, dim=1), cwna_process_noise(T, 0.1, dim=1)
H, R = np.array([[1.0, 0.0]]), np.array([[0.04]])
MANAGER = TrackManager(hits=2, window=3, delete_after=3)


def start(z):
    x = np.stack([z[..., 0], np.zeros(z.shape[:-1])], axis=-1)
    return x, np.broadcast_to(np.diag([0.04, 4.0]), (*z.shape[:-1], 2, 2))


def run(scans, manager=MANAGER, **settings):
    return track_scans(scans, F, Q, lambda x: x @ H.T, lambda x: H, R, start, manager, **settings)


def positions(rng, begin, speed):
    return begin + speed * T * np.arange(K) + 0.2 * rng.standard_normal(K)


def test_a_single_target_is_filtered_as_by_the_kalman_filter():
    z = positions(np.random.default_rng(31), 0.0, 1.0)
    (track,) = run([[[one]] for one in z], gate_probability=0.999999)
    x0, P0 = start(z[:1])
    alone = kf(z[1:, None], F, Q, H, R, x0, P0)
    np.testing.assert_allclose(track.x[1:], alone.x, rtol=1e-10, atol=1e-12)
    np.testing.assert_allclose(track.P[1:], alone.P, rtol=1e-10, atol=1e-12)
    assert track.scan.tolist() == list(range(K)) and (track.detection == 0).all()
    assert track.confirmed.tolist() == [False] + [True] * (K - 1)


@pytest.mark.parametrize("m", [1, 2])
@pytest.mark.parametrize("probability", [0.9, 0.999])
def test_the_gate_ends_at_the_quantile_for_the_components_of_a_detection(m, probability):
    """Two states, one or two components; with twice the state's covariance R matters as well."""
    H, R = np.eye(2)[:m], np.diag([0.04, 0.09])[:m, :m]
    x0, P0 = np.array([1.0, 0.5]), np.array([[0.04, 0.01], [0.01, 0.09]])
    for nu, inside in beside_the_gate(H @ (F @ P0 @ F.T + Q) @ H.T + R, probability):
        scans = [[H @ x0], [H @ F @ x0 + nu]]
        begin = lambda z: (np.tile(x0, (len(z), 1)), np.tile(P0, (len(z), 1, 1)))  # noqa: E731
        first, *others = track_scans(
            scans, F, Q, lambda x: x @ H.T, lambda x: H, R, begin, MANAGER,
            gate_probability=probability,
        )  # fmt: skip
        assert (first.detection[1] == 0) == inside
        assert len(others) == (not inside)  # what is outside starts a track of its own


@pytest.mark.parametrize("assign", [None, greedy_assign])
def test_two_targets_far_apart_are_each_followed_alone_in_any_order_of_detections(assign):
    rng = np.random.default_rng(32)
    z = np.stack([positions(rng, 0.0, 1.0), positions(rng, 100.0, -1.0)], axis=-1)
    orders = [rng.permutation(2) for _ in range(K)]
    settings = {} if assign is None else {"assign": assign}
    tracks = run([z[k][order][:, None] for k, order in enumerate(orders)], **settings)
    assert len(tracks) == 2
    for track in tracks:
        mine = int(track.x[0, 0] > 50)
        (alone,) = run([[[one]] for one in z[:, mine]], gate_probability=0.999)
        np.testing.assert_allclose(track.x, alone.x, rtol=1e-12)
        taken = [orders[k][track.detection[k]] for k in range(K)]
        assert taken == [mine] * K


def test_a_target_that_disappears_is_predicted_and_then_deleted():
    z = positions(np.random.default_rng(33), 0.0, 1.0)
    scans = [np.array([[one]]) for one in z[:10]] + [np.empty((0, 1))] * 10
    (track,) = run(scans, gate_probability=0.999999)
    assert track.scan[-1] == 11  # coasts at 10 and 11; the third miss deletes it
    assert track.detection[-2:].tolist() == [-1, -1]
    np.testing.assert_allclose(track.x[-1], F @ F @ track.x[9])
    assert (np.diff(track.P[9:, 0, 0]) > 0).all()


def test_confirmed_tracks_choose_before_tentative_ones():
    """A newcomer is nearer to the detection, and does not get it."""
    manager = TrackManager(hits=2, window=4, delete_after=5)
    scans = [[[0.0]], [[0.0]], [[1.5]], [[0.9]]]
    old, *rest = run([np.array(scan) for scan in scans], manager, gate_probability=0.99)
    assert old.confirmed[2] and old.detection.tolist() == [0, 0, -1, 0]
    assert all(track.detection[-1] == -1 for track in rest)


def test_what_may_not_start_a_track_may_still_belong_to_a_confirmed_one():
    z = positions(np.random.default_rng(34), 0.0, 0.0)
    scans = [np.array([[one], [50.0]]) for one in z]
    tracks = run(scans, new=lambda z: z[:, 0] < 20)
    assert len(tracks) == 1 and tracks[0].x[-1, 0] < 20
    far = run(scans, new=lambda z: np.arange(len(z)) < 0)
    assert far == []


def test_false_alarms_are_confirmed_as_often_as_the_binomial_says():
    """A false alarm in every scan with probability p, always at the same place.

    Two of three: the share of starts that are confirmed is 1 - (1 - p)^2 = 0.36. Of about 1000
    starts, the share is off by five deviations with probability 6e-7.
    """
    p, manager = 0.2, TrackManager(hits=2, window=3, delete_after=1)
    rng = np.random.default_rng(35)
    scans = [np.zeros((int(hit), 1)) for hit in rng.random(6_000) < p]
    tracks = run(scans, manager)
    confirmed = np.array([track.confirmed.any() for track in tracks[:-1]])
    assert abs(confirmed.mean() - 0.36) < 5 * np.sqrt(0.36 * 0.64 / len(confirmed))


def test_a_target_that_passes_behind_the_radar_keeps_its_track():
    """Its azimuth jumps between -pi and pi, with the noise also back and forth.

    Turned to the front, all signs of the track turn.
    """
    F2, Q2 = ncv_transition(T, dim=2), cwna_process_noise(T, 0.1, dim=2)
    deviations = np.array([0.1, 0.01, 0.1])
    truth = np.array([-0.05, 0.01, 5.0, 0.0]) * np.ones((K, 1))
    truth[:, 0] += 0.01 * T * np.arange(K)
    front = polar_radar_h(truth) + deviations * np.random.default_rng(36).standard_normal((K, 3))
    behind = front.copy()
    behind[:, 1] = (front[:, 1] + 2 * np.pi) % (2 * np.pi) - np.pi  # half a turn further
    assert np.sum(np.abs(np.diff(behind[:, 1])) > 6) >= 5

    def begin(z):
        x, y = z[..., 0] * np.sin(z[..., 1]), z[..., 0] * np.cos(z[..., 1])
        states = np.stack([x, 0 * x, y, 0 * y], axis=-1)
        return states, np.broadcast_to(np.diag([0.1, 1.0, 0.1, 1.0]), (*x.shape, 4, 4))

    tracks = [
        track_scans(
            z[:, None], F2, Q2, polar_radar_h, polar_radar_jacobian, np.diag(deviations**2),
            begin, MANAGER, gate_probability=0.999999, wrap=(1,),
        )
        for z in (front, behind)
    ]  # fmt: skip
    (seen,), (turned,) = tracks
    assert turned.scan.tolist() == list(range(K)) and (turned.detection == 0).all()
    np.testing.assert_allclose(turned.x, -seen.x, rtol=1e-9, atol=1e-9)


def test_crowded_scans_give_the_tracks_of_a_gate_over_all_pairs():
    """Component 0 as an angle that never wraps: then all pairs are gated, and no search picks any.

    Both components have turned to the other place in a third look, which searches along the other.
    """
    rng, side = np.random.default_rng(38), 3.0  # rad: no difference comes near pi
    F2, Q2 = ncv_transition(T, dim=2, order="derivative"), np.eye(4) / 500
    scans = [rng.uniform(0, side, (40, 2)) for _ in range(5)]
    covariance = np.diag([0.01, 0.01, 0.04, 0.04])

    def tracks(order, wrap=()):
        pick = np.eye(4)[order]
        found = track_scans(
            [z[:, order] for z in scans], F2, Q2, lambda x: x @ pick.T, lambda x: pick,
            np.diag([0.01, 0.02])[order][:, order],
            lambda z: (np.hstack([z[:, order], 0 * z]), np.tile(covariance, (len(z), 1, 1))),
            MANAGER, wrap=wrap,
        )  # fmt: skip
        return [track.detection.tolist() for track in found]

    searched = tracks([0, 1])
    assert searched == tracks([0, 1], wrap=(0,)) == tracks([1, 0])
    assert sum(len(detections) > 2 for detections in searched) > 20  # it is crowded


def test_a_detection_with_a_nan_is_not_there_and_the_others_keep_their_numbers():
    rng = np.random.default_rng(37)
    z = positions(rng, 0.0, 1.0)
    padded = run([[[np.nan], [one], [np.nan]] for one in z], gate_probability=0.999999)
    plain = run([[[one]] for one in z], gate_probability=0.999999)
    assert len(padded) == len(plain) == 1
    np.testing.assert_array_equal(padded[0].x, plain[0].x)
    assert (padded[0].detection == 1).all()
    assert run([[[np.nan]]] * 3) == []


def test_an_assignment_that_cannot_be_is_refused():
    scans = [np.array([[0.0], [50.0]])] * 2
    for value in ([99, -1], [0, 0], [0.0, 1.0], [0], "01", [[0, 1]], [-2, 0]):
        with pytest.raises(
            ValueError, match=r"^assign\(cost, gate\) must be whole numbers .* got "
        ):
            run(scans, assign=lambda cost, gate, value=value: value)
    for pair in (3, np.zeros((2, 2))[:1], [1, 2, 3]):
        with pytest.raises(ValueError, match=r"^start\(z\) must be a pair"):
            track_scans(scans, F, Q, lambda x: x @ H.T, lambda x: H, R, lambda z: pair, MANAGER)  # noqa: B023
    with pytest.raises(ValueError, match=r"^manager must be a TrackManager, got 'x'"):
        run(scans, manager="x")


def test_a_scan_of_another_kind_is_refused():
    with pytest.raises(ValueError, match=r"scans\[1\] must have shape"):
        run([np.zeros((1, 1)), np.zeros((1, 2))])
    with pytest.raises(ValueError, match=r"scans\[1\] must be one matrix"):
        run([np.zeros((1, 1)), np.zeros((2, 3, 1))])


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("F", np.ones((2, 3))),
        ("F", np.ones((3, 2, 2))),
        ("Q", np.eye(3)),
        ("Q", -np.eye(2)),
        ("start(z)[0]", lambda z: (z, start(z)[1])),
        ("start(z)[1]", lambda z: (start(z)[0], np.eye(2))),
        ("start(z)[1]", lambda z: (start(z)[0], -start(z)[1])),
        ("new(z)", lambda z: np.array([0])),
        ("new(z)", lambda z: [True]),
        ("wrap", (1,)),
    ],
)
def test_bad_input_is_named(name, value):
    arguments = {"F": F, "Q": Q, "R": R, "start": start, "manager": MANAGER}
    arguments |= {name.partition("(")[0]: value}
    with pytest.raises(ValueError) as raised:
        track_scans([np.zeros((2, 1))] * 2, h=lambda x: x @ H.T, H=lambda x: H, **arguments)
    assert str(raised.value).startswith(f"{name} must ")


def test_noise_that_depends_on_the_state_is_that_of_each_track():
    """Two targets, of which the far one has four times the noise: as if each were tracked alone."""
    rng = np.random.default_rng(41)
    z = np.stack([positions(rng, 0.0, 1.0), positions(rng, 100.0, -1.0)], axis=-1)

    def noise(x):
        return np.where(x[..., :1, None] > 50, 16.0, 1.0) * R

    scans = [row[:, None] for row in z]
    tracks = track_scans(scans, F, Q, lambda x: x @ H.T, lambda x: H, noise, start, MANAGER)
    for track, factor, one in zip(tracks, (1.0, 16.0), z.T, strict=True):
        (alone,) = track_scans(
            [[[value]] for value in one], F, Q, lambda x: x @ H.T, lambda x: H, factor * R, start,
            MANAGER,
        )  # fmt: skip
        np.testing.assert_allclose(track.x, alone.x, rtol=1e-12)


def test_exclusive_starts_leave_one_track_for_the_echoes_of_a_body():
    """Two echoes half a meter apart, where a new track is known to 0.2 m and speeds to 2 m/s."""
    z = positions(np.random.default_rng(42), 0.0, 1.0)
    scans = [[[one], [one + 0.5], [one + 50.0]] for one in z]
    assert len(run(scans)) > 2
    assert [len(track.scan) for track in run(scans, exclusive=True)] == [K, K]
