"""What one function returns the next one takes: covariances of all scales, planes, gaps, batches.

The ratio of the first variance to that of a measurement goes from 1 to 1e12 and far beyond, where
nothing is left of the accuracy of a float. Only the form of the covariances is asked for:
symmetric, no variance below zero, and taken by every function that takes a covariance.
"""

import numpy as np
import pytest

from dopplerlib import (
    ImmModel,
    RadarArray,
    constant_velocity,
    doppler_shift,
    ekf,
    ekf_update,
    imm,
    kf,
    kf_predict,
    kf_update,
    ml_initialize,
    rts_smooth,
    steady_state_gain,
)
from dopplerlib.estimation.radial_velocity import radial_velocity_terms, radial_velocity_update
from dopplerlib.model.motion import (
    cwna_process_noise,
    cwnj_process_noise,
    nca_transition,
    ncv_transition,
)
from dopplerlib.tracking.fusion import covariance_intersection, fuse_state_vectors
from dopplerlib.tracking.management import TrackManager
from dopplerlib.tracking.multi_target import track_scans
from dopplerlib.tracking.pda import pda_update

RATIOS = 10.0 ** np.array([0, 2, 4, 6, 8, 10, 12, 15, 18, 24, 30])
# Intervals far from one second make the variances of a state differ by many orders.
MODELS = {
    f"{name}, {T} s": (transition(T, dim=1), noise(T, 1e-6, dim=1))
    for T in (0.001, 1.0, 30.0)
    for name, transition, noise in (
        ("constant velocity", ncv_transition, cwna_process_noise),
        ("constant acceleration", nca_transition, cwnj_process_noise),
    )
}


def assert_covariance(P):
    """Exactly symmetric, no variance below zero, no correlation beyond one but for rounding."""
    np.testing.assert_array_equal(P, np.swapaxes(P, -1, -2))
    variance = np.diagonal(P, axis1=-2, axis2=-1)
    assert (variance >= 0).all()
    deviation = np.sqrt(np.where(variance > 0, variance, 1))
    correlation = P / deviation[..., :, None] / deviation[..., None, :]
    # n^2 roundings of 1.1e-16 are 1e-14 at most for the six components here.
    assert np.linalg.eigvalsh(correlation)[..., 0].min() > -1e-14


def everything_takes(x, P, F, Q, H, R):
    """Hand an estimate to all that take one, and return the covariances that come out."""
    n, m = len(x), len(H)
    z = H @ x + 0.5 * np.sqrt(np.diag(R))
    nonlinear = lambda x: x @ H.T, lambda x: H
    yield kf_predict(x, P, F, Q)[1]
    yield kf_update(x, P, z, H, R)[1]
    yield kf_update(x, P, z, H, R)[3]
    yield ekf_update(x, P, z, *nonlinear, R)[1]
    yield kf([z] * 3, F, Q, H, R, x, P).P
    models = [ImmModel(F, noise, H, R) for noise in (Q, 9 * Q)]
    yield imm([z] * 3, models, [[0.9, 0.1], [0.1, 0.9]], x, P).P
    yield pda_update(x, P, [z, z + 1], H, R, detection=0.9, density=0.1).P
    yield rts_smooth([x] * 3, [P] * 3, F, Q)[1]
    yield fuse_state_vectors(x, P, x, P + np.diag(np.diag(P)))[1]
    yield fuse_state_vectors(x, P, x, P + np.diag(np.diag(P)), P / 2)[1]
    yield covariance_intersection(x, P, x, P + np.diag(np.diag(P)))[1]
    yield covariance_intersection(x, P, x, P, 0.3)[1]
    if n % 2 == 0:
        yield radial_velocity_update(x + 10, P, 0.1, 0.1)[1]
        assert (radial_velocity_terms(x + 10, P, 0.1).R > 0).all()
    tracks = track_scans(
        [[z], [z], [z]], F, Q, *nonlinear, R, lambda z: ([x] * len(z), [P] * len(z)),
        TrackManager(1, 2, 2),
    )  # fmt: skip
    yield from (track.P for track in tracks)
    assert m == len(z)


@pytest.mark.parametrize("model", MODELS)
def test_covariances_that_come_out_may_go_in_at_any_ratio(model):
    F, Q = MODELS[model]
    H, R = np.eye(1, len(F)), np.array([[1.0]])
    rng = np.random.default_rng(1)
    for ratio in RATIOS:
        z = rng.standard_normal((8, 1))
        z[4] = np.nan
        track = kf(z, F, Q, H, R, np.zeros(len(F)), ratio * np.eye(len(F)))
        assert_covariance(track.P)
        assert_covariance(track.S)
        assert_covariance(rts_smooth(track.x, track.P, F, Q)[1])
        for k in (0, 1, 2, 4, 7):
            for P in everything_takes(track.x[k], track.P[k], F, Q, H, R):
                assert_covariance(P)


@pytest.mark.parametrize("ratio", RATIOS)
def test_a_chain_of_all_functions_stays_a_covariance(ratio):
    """Each takes what the one before returned, over and over, in two dimensions."""
    F, Q = ncv_transition(1.0), cwna_process_noise(1.0, 1e-3)
    swap = np.array([0, 2, 1, 3])  # [x, v_x, y, v_y] and [x, y, v_x, v_y]
    H, R = np.eye(4)[[0, 2]], np.array([[1.0, 0.5], [0.5, 1.0]])
    x, P = np.array([10.0, 1.0, 20.0, -1.0]), ratio * np.eye(4)
    for z in np.random.default_rng(2).standard_normal((5, 2)) + x[[0, 2]]:
        x, P = kf_predict(x, P, F, Q)
        x, P, _, S = kf_update(x, P, [z[0], np.nan], H, R)
        x, P, _, _ = ekf_update(x, P, z, lambda x: x[..., [0, 2]], lambda x: H, R)
        x, P, _, _ = radial_velocity_update(x[swap], P[swap][:, swap], 0.1, 0.1)
        x, P = x[swap], P[swap][:, swap]
        step = pda_update(x, P, [z, z + 0.1], H, R, detection=0.9, density=1e-3)
        models = [ImmModel(F, noise, H, R) for noise in (Q, 9 * Q)]
        modes = imm([z], models, [[0.9, 0.1], [0.1, 0.9]], step.x, step.P)
        x, P = fuse_state_vectors(modes.x[-1], modes.P[-1], x, P)
        x, P = covariance_intersection(x, P, step.x, step.P)
        x, P = (v[0] for v in rts_smooth([x, step.x], [P, step.P], F, Q))
        for one in (P, S, step.P):
            assert_covariance(one)


def test_covariances_of_the_doppler_filter_may_go_in_at_any_ratio():
    """The ratio is that of a variance in m^2 to one in Hz^2, with 160 Hz for a meter per second."""
    array, T = RadarArray.ring(6, 0.2), 0.001
    path = [0.8, 0.1, 0.1, -0.7, 0, 0] + np.arange(1, 41)[:, None] * T * np.r_[-0.7, np.zeros(5)]
    F, Q = constant_velocity(T, 0.4)
    H, R = np.eye(1, 6), np.eye(1)
    z = doppler_shift(path, array)
    for ratio in RATIOS:
        track = ekf(
            doppler_shift(path, array), array, path[0], 1e-4 * ratio * np.eye(6), T, 0.4, 0.01
        )
        for k in (0, 5, 39):
            assert_covariance(track.P[k])
            for P in everything_takes(track.x[k], track.P[k], F, Q, H, R):
                assert_covariance(P)
        assert_covariance(rts_smooth(track.x, track.P, F, Q)[1])
        again = ekf(z, array, track.x[5], track.P[5], T, 0.4, 0.01)
        assert_covariance(again.P)


# ------------------------------------------------------------------------------ a plane

PLANE = np.diag([1.0, 0.5, 0.0, 0.0])  # z and v_z are known exactly


def tilted(angle=0.3):
    """Return a rotation that takes the plane out of the axes: only rounding says it is one."""
    turn = np.eye(4)
    turn[::2, ::2] = turn[1::2, 1::2] = [
        [np.cos(angle), -np.sin(angle)],
        [np.sin(angle), np.cos(angle)],
    ]
    return turn


@pytest.mark.parametrize("turn", [np.eye(4), tilted()], ids=["along the axes", "tilted"])
def test_a_start_in_the_plane_is_followed_as_in_fewer_dimensions(turn):
    """Filter, IMM, smoother, PDA and fusion of four components against those of the two unknown."""
    rng = np.random.default_rng(3)
    F2, Q2, H2, R = (
        ncv_transition(0.5, dim=1),
        cwna_process_noise(0.5, 0.1, dim=1),
        np.eye(1, 2),
        [[0.2]],
    )
    F, Q, P0 = np.kron(np.eye(2), F2), np.zeros((4, 4)), turn @ PLANE @ turn.T
    Q[:2, :2] = Q2
    F, Q = turn @ F @ turn.T, turn @ Q @ turn.T
    H = np.eye(1, 4) @ turn.T
    x0, z = turn @ [0.3, -0.1, 7.0, 0.0], rng.standard_normal((9, 1))
    Q, P0 = (Q + Q.T) / 2, (P0 + P0.T) / 2

    def flat(x):
        return (x @ turn)[..., :2]

    track, small = kf(z, F, Q, H, R, x0, P0), kf(z, F2, Q2, H2, R, [0.3, -0.1], np.diag([1.0, 0.5]))
    np.testing.assert_allclose(flat(track.x), small.x, rtol=0, atol=1e-12)
    np.testing.assert_allclose((track.x @ turn)[..., 2:], [[7.0, 0.0]] * 9, rtol=0, atol=1e-12)
    smooth, covariance = rts_smooth(track.x, track.P, F, Q)
    want, want_P = rts_smooth(small.x, small.P, F2, Q2)
    np.testing.assert_allclose(flat(smooth), want, rtol=0, atol=1e-10)
    np.testing.assert_allclose((turn.T @ covariance @ turn)[:, :2, :2], want_P, rtol=0, atol=1e-10)
    models = [ImmModel(F, noise, H, R) for noise in (Q, 9 * Q)]
    modes = imm(z, models, [[0.9, 0.1], [0.1, 0.9]], x0, P0)
    models = [ImmModel(F2, noise, H2, R) for noise in (Q2, 9 * Q2)]
    fewer = imm(z, models, [[0.9, 0.1], [0.1, 0.9]], [0.3, -0.1], np.diag([1, 0.5]))
    np.testing.assert_allclose(flat(modes.x), fewer.x, rtol=0, atol=1e-11)
    settings = {"detection": 0.9, "density": 0.1}
    step = pda_update(x0, P0, z[:3], H, R, **settings)
    less = pda_update([0.3, -0.1], np.diag([1, 0.5]), z[:3], H2, R, **settings)
    np.testing.assert_allclose(flat(step.x), less.x, rtol=0, atol=1e-12)
    for fuse in (fuse_state_vectors, covariance_intersection):
        one = fuse(track.x[3], track.P[3], track.x[3] + turn @ [0.1, 0.2, 0, 0], track.P[1])
        two = fuse(small.x[3], small.P[3], small.x[3] + [0.1, 0.2], small.P[1])
        # The best weight of an intersection is where a slope is zero: half of the digits.
        np.testing.assert_allclose(flat(one[0]), two[0], rtol=0, atol=1e-7)
        np.testing.assert_allclose((turn.T @ one[1] @ turn)[:2, :2], two[1], rtol=0, atol=1e-7)
    for P in (track.P, covariance, modes.P, step.P):
        assert_covariance(P)
        assert np.abs((turn.T @ P @ turn)[..., 2:, 2:]).max() < 1e-14


@pytest.mark.parametrize("noise", ["shared", "per_axis"])
def test_a_start_from_the_likelihood_in_a_plane_is_followed_for_one_record_and_for_many(noise):
    array, T = RadarArray.linear(5, 0.4), 0.001
    path = [0.5, 0.2, 0, -1, 0.5, 0] + np.arange(40)[:, None] * T * np.array([-1, 0.5, 0, 0, 0, 0])
    z = doppler_shift(path, array) + 0.1 * np.random.default_rng(1).standard_normal((3, 40, 5))
    begin = ml_initialize(
        z[:, :30], array, 0.1, T, ([0.1, -1, 0, -2, -2, 0], [2, 1, 0, 2, 2, 0]), at="last"
    )
    together = ekf(z[:, 30:], array, begin.x, begin.P, T, 1e-3, 0.1, noise)
    for run in range(3):
        alone = ekf(z[run, 30:], array, begin.x[run], begin.P[run], T, 1e-3, 0.1, noise)
        np.testing.assert_array_equal(together.x[run], alone.x)
    assert_covariance(together.P)
    again = ekf(z[:, 35:], array, together.x[:, 4], together.P[:, 4], T, 1e-3, 0.1, noise)
    np.testing.assert_allclose(again.x, together.x[:, 5:], rtol=0, atol=1e-12)
    if noise == "per_axis":
        # Noise across the plane is none of its own: the errors across stay below what it allows.
        assert (np.abs(together.x[..., 2]) < 1e-6).all()


def test_the_gain_of_a_settled_filter_is_that_of_its_covariance():
    F, Q = ncv_transition(1.0, dim=1), cwna_process_noise(1.0, 0.1, dim=1)
    H, R = np.eye(1, 2), np.array([[2.0]])
    K, P = steady_state_gain(F, Q, H, R)
    assert_covariance(P)
    _, again, _, _ = kf_update([0.0, 0.0], kf_predict([0.0, 0.0], P, F, Q)[1], [0.0], H, R)
    np.testing.assert_allclose(again, P, rtol=0, atol=1e-12)
    np.testing.assert_allclose(K, P @ H.T / R, rtol=0, atol=1e-12)
