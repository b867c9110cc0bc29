"""General filters are the linear, the compiled and the textbook's, also sample by sample."""

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import least_squares

from dopplerlib import (
    RadarArray,
    coordinated_turn,
    coordinated_turn_jacobian,
    doppler_jacobian,
    doppler_shift,
    ekf,
    ekf_records,
    kf,
    ukf,
)
from dopplerlib.estimation.extended_kalman import gate_bounds
from dopplerlib.model.motion import constant_velocity
from dopplerlib.model.polar_radar import polar_radar_h, polar_radar_jacobian

PEERS = json.loads(Path(__file__).with_name("ukf_peers.json").read_text(encoding="utf-8"))
RNG = np.random.default_rng(41)
K, n, m, runs = 12, 4, 2, 5
F = np.eye(n) + 0.2 * RNG.standard_normal((n, n))
H = RNG.standard_normal((m, n))
ROOT = RNG.standard_normal((2, n, n))
Q, P0 = ROOT @ ROOT.mT
R = np.array([[0.5, 0.2], [0.2, 0.9]])
x0 = RNG.standard_normal(n)
z = RNG.standard_normal((runs, K, m))
HOLES = z.copy()
HOLES[0, 2] = HOLES[1, 3:6, 0] = HOLES[:, 8, 1] = np.nan

MODEL = {"f": lambda x: x @ F.T, "h": lambda x: x @ H.T, "Q": Q, "R": R, "x0": x0, "P0": P0}
SLOPES = {"F": lambda x: F, "H": lambda x: H}
AGAIN = {"iterations": 3}
FILTERS = {
    "ekf": lambda z, **settings: ekf_records(z, **SLOPES | MODEL | settings),
    "cubature": lambda z, **settings: ukf(z, **MODEL | settings),
    "unscented": lambda z, **settings: ukf(z, points="unscented", alpha=0.5, **MODEL | settings),
    "negative middle": lambda z, **settings: ukf(z, points="unscented", **MODEL | settings),
    "iterated ekf": lambda z, **settings: ekf_records(z, **SLOPES | MODEL | AGAIN | settings),
    "iterated cubature": lambda z, **settings: ukf(z, **MODEL | AGAIN | settings),
}
every_filter = pytest.mark.parametrize("name", FILTERS)


def assert_close(track, other, rtol=1e-9):
    for field in ("x", "P", "innovation", "S", "nis"):
        got, want = getattr(track, field), getattr(other, field)
        np.testing.assert_allclose(got, want, rtol=rtol, atol=rtol * np.nanmax(np.abs(want)))
    np.testing.assert_array_equal(track.updated, other.updated)


@every_filter
@pytest.mark.parametrize("measured", [z, HOLES, z[0], np.full((K, m), np.nan)])
def test_with_a_linear_model_it_is_the_linear_filter(name, measured):
    # Points 1e-3 deviations apart lose six digits of a mean, 1e-16 of which is left.
    rtol = 1e-7 if name == "negative middle" else 1e-9
    if np.isnan(measured).all():
        track = FILTERS[name](measured)
        want = kf(measured, F, Q, H, R, x0, P0)
        np.testing.assert_allclose(track.P, want.P, rtol=rtol, atol=rtol * want.P.max())
        assert not track.updated.any() and np.isnan(track.nis).all()
    else:
        assert_close(FILTERS[name](measured), kf(measured, F, Q, H, R, x0, P0), rtol)


@pytest.mark.parametrize("which", ["ekf", "cubature"])
def test_matrices_of_each_sample_are_functions_of_each_sample(which):
    scale = 1 + 0.1 * np.arange(K)[:, None, None]
    want = kf(HOLES, F * scale / 2, Q * scale, H * scale, R / scale, x0, P0)
    move, see = (
        [lambda x, A=A: x @ A.T for A in matrices] for matrices in (F * scale / 2, H * scale)
    )
    each = {"f": move, "Q": Q * scale, "h": see, "R": R / scale}
    if which == "ekf":
        each |= {"F": [lambda x, A=A: A for A in F * scale / 2]}
        each |= {"H": [lambda x, A=A: A for A in H * scale]}
    assert_close(FILTERS[which](HOLES, **each), want)


@pytest.mark.parametrize("name", ["ekf", "cubature"])
def test_a_singular_start_and_no_process_noise_are_taken(name):
    """One component is known exactly, and stays so where nothing moves."""
    exact = np.diag([1.0, 1.0, 0.0, 1.0])
    still = {"f": lambda x: x, "Q": 0 * Q, "P0": exact} | (
        {"F": lambda x: np.eye(n)} if name == "ekf" else {}
    )
    track = FILTERS[name](z, **still)
    assert_close(track, kf(z, np.eye(n), 0 * Q, H, R, x0, exact))
    assert not track.P[..., 2, :].any()


@every_filter
@pytest.mark.parametrize("gate", [None, "upper", "two-sided", "soft"])
def test_sample_by_sample_it_is_the_whole_record(name, gate):
    whole = FILTERS[name](HOLES, gate=gate, gate_probability=0.6)
    state = {"x0": x0, "P0": P0}
    for k in range(K):
        track = FILTERS[name](HOLES[:, k : k + 1], gate=gate, gate_probability=0.6, **state)
        state = {"x0": track.x[:, -1], "P0": track.P[:, -1]}
        np.testing.assert_array_equal(track.x[:, 0], whole.x[:, k])
        np.testing.assert_array_equal(track.P[:, 0], whole.P[:, k])
        np.testing.assert_array_equal(track.nis[:, 0], whole.nis[:, k])
        np.testing.assert_array_equal(track.updated[:, 0], whole.updated[:, k])


@every_filter
@pytest.mark.parametrize("gate", ["upper", "two-sided"])
def test_what_is_refused_leaves_the_state_as_if_it_were_missing(name, gate):
    track = FILTERS[name](HOLES, gate=gate, gate_probability=0.6)
    count = np.sum(~np.isnan(HOLES), axis=-1)
    lower, upper = gate_bounds(gate, m, 0.6)
    passed = (count > 0) & (lower[count] <= track.nis) & (track.nis <= upper[count])
    np.testing.assert_array_equal(track.updated, passed)
    assert 0.3 < passed.mean() < 0.9  # both happen
    left = FILTERS[name](np.where(passed[..., None], HOLES, np.nan))
    np.testing.assert_array_equal(track.x, left.x)
    np.testing.assert_array_equal(track.P, left.P)


@every_filter
def test_behind_a_soft_gate_noise_is_as_large_as_brings_nis_to_the_bound(name):
    """One component: S is larger by NIS over the bound, if R is larger by the rest (Chang 2014)."""
    one = {"h": lambda x: x @ H[:1].T, "R": R[:1, :1]}
    if name.endswith("ekf"):
        one |= {"H": lambda x: H[:1]}
    track = FILTERS[name](HOLES[..., :1], **one, gate="soft", gate_probability=0.6)
    there = ~np.isnan(track.nis)
    np.testing.assert_array_equal(track.updated, there)
    bound = gate_bounds("upper", 1, 0.6)[1][1]
    more = np.where(there, np.maximum(track.nis / bound, 1) - 1, 0)
    assert 0.1 < (more[there] > 0).mean() < 0.9  # both happen
    for run in range(runs):
        noise = R[:1, :1] + (more * track.S[..., 0, 0])[run, :, None, None]
        want = kf(HOLES[run, :, :1], F, Q, H[:1], noise, x0, P0)
        np.testing.assert_allclose(track.x[run], want.x, rtol=1e-7, atol=1e-7)
        np.testing.assert_allclose(track.P[run], want.P, rtol=1e-7, atol=1e-7)


def test_behind_a_soft_gate_a_filter_that_is_lost_comes_back():
    """A start that is off by 20 deviations: a gate that refuses does not open again."""
    seen, one = np.random.default_rng(1).standard_normal((200, 1)), np.eye(1)
    still = {"f": lambda x: x, "F": lambda x: one, "h": lambda x: x, "H": lambda x: one}
    still |= {"Q": 1e-4 * one, "R": one, "x0": [20.0], "P0": one, "gate_probability": 0.99}
    soft, hard = (ekf_records(seen, gate=gate, **still) for gate in ("soft", "upper"))
    assert not hard.updated.any()
    assert np.abs(soft.x[100:, 0]).max() < 1


@pytest.mark.parametrize("gate", [None, "upper", "two-sided"])
@pytest.mark.parametrize("noise", ["shared", "per_axis"])
def test_the_general_filter_with_doppler_shifts_is_the_compiled_one(gate, noise):
    array = RadarArray.ring(6, 0.2)
    rng = np.random.default_rng(42)
    samples, T = 60, 0.01 * (1 + np.arange(60) % 3)
    transition, Q = constant_velocity(T, 2.0, noise)
    x = np.array([0.8, 0.1, 0.3, -0.7, 0.2, 0.1])
    path = [x := step @ x for step in transition]
    z = doppler_shift(path, array) + 0.4 * rng.standard_normal((3, samples, 6))
    z[0, 10:20, 2] = z[1, 30] = np.nan
    start = path[0] - [0.05, 0.02, -0.03, 0, 0, 0.1]
    P0 = np.diag([0.01] * 3 + [0.1] * 3)
    want = ekf(z, array, start, P0, T, 2.0, 0.4, noise, gate, gate_probability=0.9)
    assert want.updated.mean() > 0.5
    track = ekf_records(
        z, [lambda x, F=F: x @ F.T for F in transition], [lambda x, F=F: F for F in transition], Q,
        lambda x: doppler_shift(x, array), lambda x: doppler_jacobian(x, array), 0.4**2 * np.eye(6),
        start, P0, gate=gate, gate_probability=0.9,
    )  # fmt: skip
    assert_close(
        track, want, rtol=1e-7
    )  # after 60 updates, whose errors of 1e-14 a filter amplifies


def textbook_ukf(z, f, Q, h, R, x, P, alpha, beta, kappa):
    """Return x and P of Table 1 of Wan and van der Merwe (2000), as it stands there."""
    L = len(x)
    lam = alpha**2 * (L + kappa) - L
    Wm = np.full(2 * L + 1, 1 / (2 * (L + lam)))
    Wc = Wm.copy()
    Wm[0], Wc[0] = lam / (L + lam), lam / (L + lam) + 1 - alpha**2 + beta

    def points(x, P):
        root = np.linalg.cholesky((L + lam) * P)
        return np.array([x, *(x + root.T), *(x - root.T)])

    xs, Ps = [], []
    for measured in z:
        X = np.array([f(p) for p in points(x, P)])
        x = Wm @ X
        P = Q + sum(w * np.outer(p - x, p - x) for w, p in zip(Wc, X, strict=True))
        X = points(x, P)
        Z = np.array([h(p) for p in X])
        mean = Wm @ Z
        S = R + sum(w * np.outer(p - mean, p - mean) for w, p in zip(Wc, Z, strict=True))
        C = sum(w * np.outer(p - x, y - mean) for w, p, y in zip(Wc, X, Z, strict=True))
        gain = C @ np.linalg.inv(S)
        x, P = x + gain @ (measured - mean), P - gain @ S @ gain.T
        xs.append(x)
        Ps.append(P)
    return np.array(xs), np.array(Ps)


def bend(x):
    """Return a motion whose velocity turns with the place."""
    a = 0.3 + 0.05 * x[..., 0]
    c, s = np.cos(a), np.sin(a)
    vx, vy = x[..., 1] * c - x[..., 3] * s, x[..., 1] * s + x[..., 3] * c
    return np.stack([x[..., 0] + 0.5 * vx, vx, x[..., 2] + 0.5 * vy, vy], axis=-1)


def far(x):
    """Return range and angle of a place, seen from a point that it does not walk around."""
    a, b = x[..., 0] + 8.0, x[..., 2] - 2.0
    return np.stack([np.hypot(a, b), np.arctan2(b, a)], axis=-1)


NONLINEAR = {
    "f": bend, "Q": np.diag([0.01, 0.05, 0.01, 0.05]), "h": far, "R": np.diag([0.04, 0.01]),
    "x0": np.array([0.0, 1.0, 0.0, 0.5]), "P0": np.diag([1.0, 0.5, 1.0, 0.5]),
}  # fmt: skip
RECORD = far(np.array(PEERS["path"])) + np.array(PEERS["noise"])
SETTINGS = {
    "cubature": {"alpha": 1.0, "beta": 0.0, "kappa": 0.0},
    "negative": {"alpha": 0.5, "beta": 2.0, "kappa": -1.0},
    "usual": {"alpha": 0.1, "beta": 2.0, "kappa": 0.0},
}


@pytest.mark.parametrize("name", SETTINGS)
def test_it_is_the_filter_of_the_textbook(name):
    x, P = textbook_ukf(RECORD, *NONLINEAR.values(), **SETTINGS[name])
    points = {"points": "unscented"} | SETTINGS[name] if name != "cubature" else {}
    track = ukf(RECORD, **NONLINEAR, **points)
    np.testing.assert_allclose(track.x, x, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(track.P, P, rtol=1e-9, atol=1e-9)


def test_the_extended_filter_is_that_of_the_textbook():
    """Both functions bend, so that it matters at which state a Jacobian is taken."""
    rng = np.random.default_rng(44)
    z = polar_radar_h([3.0, 1.0, 6.0, -0.5]) + 0.2 * rng.standard_normal((10, 3))
    Q, R = 0.05 * np.eye(5), np.diag([0.04, 0.01, 0.04])
    x0, P0 = np.array([3.2, 6.3, 0.8, -0.7, 0.3]), np.diag([1.0, 1.0, 0.5, 0.5, 0.2])
    place = [0, 2, 1, 3]  # of [x, v_x, y, v_y] in [x, y, v_x, v_y, omega]

    def H(x):
        out = np.zeros((*x.shape[:-1], 3, 5))
        out[..., place] = polar_radar_jacobian(x[..., place])
        return out

    track = ekf_records(
        z, lambda x: coordinated_turn(x, 0.5), lambda x: coordinated_turn_jacobian(x, 0.5), Q,
        lambda x: polar_radar_h(x[..., place]), H, R, x0, P0, wrap=(1,),
    )  # fmt: skip
    x, P = x0, P0
    for k, measured in enumerate(z):
        F = coordinated_turn_jacobian(x, 0.5)
        x, P = coordinated_turn(x, 0.5), F @ P @ F.T + Q
        S = H(x) @ P @ H(x).T + R
        K_k = P @ H(x).T @ np.linalg.inv(S)
        x, P = x + K_k @ (measured - polar_radar_h(x[place])), P - K_k @ H(x) @ P
        np.testing.assert_allclose(track.x[k], x, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(track.P[k], P, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("peer", PEERS["tracks"])
def test_it_is_the_filter_of_other_libraries(peer):
    """FilterPy and Stone Soup, by `python benchmarks/ukf_peers.py`."""
    stored = PEERS["tracks"][peer]
    points = peer.split(", ")[1]
    settings = {"points": "unscented"} | SETTINGS[points] if points != "cubature" else {}
    track = ukf(RECORD, **NONLINEAR, **settings)
    np.testing.assert_allclose(track.x, stored["x"], rtol=1e-8, atol=1e-8)
    np.testing.assert_allclose(track.P[-1], stored["P"], rtol=1e-8, atol=1e-8)


def test_cubature_of_a_square_by_hand():
    """x ~ N(2, 1): the points 1 and 3 give 1 and 9, so mean 5, H = 4, and no curvature is left."""
    track = ukf([[6.0]], lambda x: x, [[0.0]], lambda x: x**2, [[4.0]], [2.0], [[1.0]])
    assert track.innovation.tolist() == [[1.0]] and track.S.tolist() == [[[20.0]]]
    assert track.x[0, 0] == pytest.approx(2.2) and track.P[0, 0, 0] == pytest.approx(0.2)


def test_posterior_linearization_of_a_square_by_hand():
    """After one step x ~ N(2.2, 0.2). Over that, x^2 has mean 5.04, slope 4.4, nothing is left."""
    track = ukf(
        [[6.0]], lambda x: x, [[0.0]], lambda x: x**2, [[4.0]], [2.0], [[1.0]], iterations=2
    )
    assert track.innovation[0, 0] == pytest.approx(6 - 5.04 + 4.4 * 0.2)
    assert track.S[0, 0, 0] == pytest.approx(4.4**2 + 4)
    assert track.x[0, 0] == pytest.approx(2 + 4.4 / 23.36 * 1.84)
    assert track.P[0, 0, 0] == pytest.approx(4 / 23.36)


def test_posterior_linearization_counts_what_the_line_misses_by_hand():
    """With alpha 1, kappa 2 the moments are exact: the line of x^2 over N(m, P) misses 2 P^2."""
    track = ukf(
        [[6.0]], lambda x: x, [[0.0]], lambda x: x**2, [[4.0]], [2.0], [[1.0]],
        points="unscented", alpha=1.0, beta=0.0, kappa=2.0, iterations=2,
    )  # fmt: skip
    m, P = 2 + 4 / 22, 1 - 16 / 22
    assert track.S[0, 0, 0] == pytest.approx((2 * m) ** 2 + 4 + 2 * P**2)
    assert track.innovation[0, 0] == pytest.approx(6 - m**2 - P - 2 * m * (2 - m))


def posterior_linearization(z, f, Q, h, R, x, P, iterations):
    """Return x and P of García-Fernández et al. (2015), with the sums over points of Section II."""

    def regression(function, x, P):
        root = np.linalg.cholesky(len(x) * P)
        points = np.array([*(x + root.T), *(x - root.T)])
        values = np.array([function(point) for point in points])
        mean = values.mean(axis=0)
        C = (points - x).T @ (values - mean) / len(points)
        A = C.T @ np.linalg.inv(P)
        return A, mean - A @ x, (values - mean).T @ (values - mean) / len(points) - A @ P @ A.T

    found = []
    for measured in z:
        A, b, left = regression(f, x, P)
        ahead, P_ahead = A @ x + b, A @ P @ A.T + left + Q
        x, P = ahead, P_ahead
        for _ in range(iterations):
            A, b, left = regression(h, x, P)
            S = A @ P_ahead @ A.T + left + R
            gain = P_ahead @ A.T @ np.linalg.inv(S)
            x = ahead + gain @ (measured - A @ ahead - b)
            P = P_ahead - gain @ S @ gain.T
        found.append((x, P))
    return map(np.array, zip(*found, strict=True))


@pytest.mark.parametrize("iterations", [1, 2, 5])
def test_posterior_linearization_is_that_of_the_paper(iterations):
    x, P = posterior_linearization(RECORD, *NONLINEAR.values(), iterations)
    track = ukf(RECORD, **NONLINEAR, iterations=iterations)
    np.testing.assert_allclose(track.x, x, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(track.P, P, rtol=1e-9, atol=1e-9)


def test_the_iterated_filter_ends_at_the_mode():
    """SciPy finds the mode of prior times likelihood; the Jacobian there gives P and NIS."""
    still = {"f": lambda x: x, "F": lambda x: np.eye(2), "Q": np.zeros((2, 2))}
    h = {"h": lambda x: x**2 + x[..., ::-1], "H": lambda x: 2 * x[..., None] * np.eye(2) + SWAP}
    seen, start, spread = np.array([4.0, 7.0]), np.array([1.2, 1.9]), np.diag([0.5, 0.8])
    track = ekf_records(seen[None], **still, **h, R=R, x0=start, P0=spread, iterations=40)
    roots = [np.linalg.inv(np.linalg.cholesky(matrix)) for matrix in (spread, R)]
    found = least_squares(
        lambda x: np.concatenate([roots[0] @ (x - start), roots[1] @ (seen - h["h"](x))]),
        start, xtol=1e-15, ftol=1e-15, gtol=1e-15,
    )  # fmt: skip
    np.testing.assert_allclose(track.x[0], found.x, rtol=1e-7)
    np.testing.assert_allclose(track.P[0], np.linalg.inv(found.jac.T @ found.jac), rtol=1e-6)
    assert track.nis[0] == pytest.approx(2 * found.cost, rel=1e-7)


SWAP = np.eye(2)[::-1]


@pytest.mark.parametrize("name", ["ekf", "cubature"])
def test_process_noise_may_depend_on_the_state(name):
    """It is that of the state before the step: a filter with matrices that are read off it."""
    track = FILTERS[name](z[0], Q=lambda x: Q * (1 + x[..., 0, None, None] ** 2))
    before = np.array([x0, *track.x[:-1]])[:, 0]
    want = FILTERS[name](z[0], Q=Q * (1 + before[:, None, None] ** 2))
    assert_close(track, want, rtol=1e-12)


def test_unscented_points_see_what_cubature_misses_of_a_square():
    """With alpha 1, kappa 2 the moments are exact: mean m^2 + P, variance 4 m^2 P + 2 P^2."""
    track = ukf(
        [[6.0]], lambda x: x, [[0.0]], lambda x: x**2, [[4.0]], [2.0], [[1.0]],
        points="unscented", alpha=1.0, beta=0.0, kappa=2.0,
    )  # fmt: skip
    assert track.innovation[0, 0] == pytest.approx(1.0)
    assert track.S[0, 0, 0] == pytest.approx(16 + 2 + 4)


@pytest.mark.parametrize("points", ["cubature", "unscented"])
def test_across_the_cut_at_180_degrees_the_filter_is_the_one_of_the_opposite_side(points):
    def sight(x):
        return np.stack([np.hypot(x[..., 0], x[..., 2]), np.arctan2(x[..., 2], x[..., 0])], axis=-1)

    step = np.kron(np.eye(2), [[1, 0.5], [0, 1]])
    state = np.array([-4.0, 0.0, -1.0, 0.7])
    path = np.array([state := step @ state for _ in range(8)])
    opposite, through_the_cut = (
        ukf(
            sight(side * path), lambda x: x @ step.T, 0.01 * np.eye(4), sight, 0.01 * np.eye(2),
            side * (path[0] + [0.5, 0, 0.4, 0]), np.diag([1.0, 0.1, 1.0, 0.1]),
            points=points, alpha=0.5, wrap=[1],
        )
        for side in (-1, 1)
    )  # fmt: skip
    np.testing.assert_allclose(through_the_cut.x, -opposite.x, rtol=1e-9, atol=1e-11)
    np.testing.assert_allclose(through_the_cut.P, opposite.P, rtol=1e-9, atol=1e-11)


@pytest.mark.parametrize("name", ["ekf", "cubature"])
def test_a_function_may_write_to_its_argument(name):
    def move(x):
        x[..., 0] += x[..., 1]
        return x

    A = np.eye(n)
    A[0, 1] = 1
    slopes = {"F": lambda x: A} if name == "ekf" else {}
    assert_close(FILTERS[name](z, f=move, **slopes), kf(z, A, Q, H, R, x0, P0))


def test_polar_radar_with_angles_far_from_linear_is_tracked_by_both():
    target = np.array([2.0, 1.0, 6.0, -1.0])
    R = np.diag([0.05**2, 0.01**2, 0.05**2])
    seen = polar_radar_h(target) + np.sqrt(np.diag(R)) * np.random.default_rng(3).normal(
        size=(9, 3)
    )
    still = {"f": lambda x: x, "Q": 1e-12 * np.eye(4), "h": polar_radar_h, "R": R}
    start = {"x0": target + 0.3, "P0": 0.1 * np.eye(4), "wrap": (1,)}
    one = ekf_records(seen, F=lambda x: np.eye(4), H=polar_radar_jacobian, **still, **start)
    other = ukf(seen, **still, **start)
    deviation = np.sqrt(np.diagonal(one.P[-1]))
    assert (np.abs(other.x[-1] - one.x[-1]) < deviation).all()


BAD = {
    "z": np.full((K, m), np.inf), "f": 3.0, "Q": -Q, "h": lambda x: x, "R": 0 * R,
    "x0": np.zeros(n + 1), "P0": -P0, "wrap": (m,), "gate": "lower", "gate_probability": 2.0,
}  # fmt: skip


@pytest.mark.parametrize("which", [ekf_records, ukf])
@pytest.mark.parametrize("argument", BAD)
def test_bad_input_is_named(which, argument):
    slopes = SLOPES if which is ekf_records else {}
    blamed = {"x0": "P0", "h": "h(x)"}.get(argument, argument)
    with pytest.raises(ValueError) as raised:
        which(**{"z": z} | MODEL | slopes | {argument: BAD[argument]})
    assert str(raised.value).startswith(f"{blamed} must ") and ", got " in str(raised.value)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"alpha": 0.0}, "alpha must be positive, got 0.0"),
        ({"kappa": -4.0}, "kappa must be above -4 for a state of length 4, got -4.0"),
        ({"beta": -1e-3, "kappa": 2.0, "alpha": 0.01}, "beta must be at least -5e-05 with .* got"),
        ({"iterations": 101}, "iterations must be at most 100, got 101"),
        ({"Q": lambda x: x}, r"Q\(x\) must have shape"),
        ({"points": "Gauss"}, "points must be one of 'cubature', 'unscented', got 'Gauss'"),
        ({"f": [MODEL["f"]] * 3}, "f must be a function, or 12 of them, one .* got 3 objects"),
    ],
)
def test_bad_settings_of_the_points_are_named(settings, message):
    with pytest.raises(ValueError, match=f"^{message}"):
        ukf(z, **MODEL | settings)
