"""The EKF with links that move, and clocks: other filters, least squares, and many runs."""

import numpy as np
import pytest
from scipy.optimize import least_squares

from dopplerlib import (
    DopplerLinks,
    RadarArray,
    chi2_interval,
    doppler_jacobian,
    doppler_shift,
    ekf,
    ekf_records,
    nees,
)

RNG = np.random.default_rng(1)
K, RUNS = 40, 200
T = 0.02 * (1 + np.arange(K) % 3)  # uneven
TIMES = np.cumsum(T) - T[0]
TARGET = np.array([25.0, 6.0, 0.5, -1.0, 3.0, 0.2])
SENSORS = np.c_[RNG.uniform(-1, 1, (6, 3)) * [3, 3, 1], RNG.uniform(-2, 2, (6, 3))]
SENDER = [-2.0, 5.0, 1.0, 1.0, 0.0, 0.5]
LINKS = {
    "car": DopplerLinks.on_platform(
        RadarArray(SENSORS[:, :3]), [0, 0, 0, 8, 0, 0], [0, 0, 0.2], times=TIMES
    ),
    "bistatic": DopplerLinks(SENSORS, SENDER, wavelength=np.linspace(0.01, 0.02, 6)),
    "one way, drift": DopplerLinks.one_way(SENSORS, 0.01, clocks="common", clock_model="drift"),
}
CLOCKS = {"sigma_clock": 1.0, "sigma_drift": 0.5}


def settings(links):
    """Return start, its covariance, and process noise of the clocks."""
    n = links.n
    x0 = np.r_[TARGET, [20.0, -5.0][: n - 6]]
    x0[:3] -= T[0] * x0[3:6]
    P0 = np.diag([*[0.01] * 3, *[0.01] * 3, 100.0, 25.0][:n])
    return x0, P0, CLOCKS if n > 6 else {}


def world(links, runs, sigma_f, scale=1.0, sigma_a=1.0, rng=RNG):
    """Return paths, measurements and starts that err as the filter believes, some missing."""
    x0, P0, clocks = settings(links)
    F, Q = links.motion(T, sigma_a, "per_axis", **{k: scale * v for k, v in clocks.items()})
    x = x0 + scale * rng.multivariate_normal(np.zeros(links.n), P0, runs)
    path = np.empty((runs, K, links.n))
    for k in range(K):
        x = x @ F[k].T + rng.multivariate_normal(np.zeros(links.n), Q[k], runs)
        path[:, k] = x
    z = doppler_shift(path, links.sampled(K, T)) + sigma_f * rng.standard_normal((runs, K, 6))
    z[rng.random(z.shape) < 0.1] = np.nan
    z[:, 7] = np.nan
    return path, z


@pytest.mark.parametrize("name", LINKS)
def test_nees_is_that_of_a_consistent_filter(name):
    """At three samples; each interval misses for one seed in a thousand."""
    links = LINKS[name]
    x0, P0, clocks = settings(links)
    path, z = world(links, RUNS, 0.5)
    track = ekf(z, links, x0, P0, T, 1.0, 0.5, "per_axis", **clocks)
    low, high = chi2_interval(links.n, RUNS, 0.999)
    average = nees(track, path).mean(axis=0)
    for k in (0, K // 2, K - 1):
        assert low < average[k] < high
    assert np.isnan(track.nis[:, 7]).all() and not track.updated[:, 7].any()
    there = ~np.isnan(track.innovation)
    low, high = chi2_interval(1, int(there.sum()), 0.999)
    assert low < np.nansum(track.nis) / there.sum() < high


def paths(x, t, end):
    """Return distances of targets (n,) at times (K,) from ends (N, 6), which go straight."""
    p = x[:3] + t[:, None] * x[3:6]
    return np.linalg.norm(p[:, None] - end[:, :3] - t[:, None, None] * end[:, 3:], axis=-1)


def test_it_is_least_squares_when_errors_are_small():
    """Bistatic, two clocks that drift, no process noise; shifts by differences of path lengths.

    Errors are so small that the curvature is 1e-4 of them. Differences over 2e-4 s leave 1e-6 Hz.
    """
    e = 1e-4
    sender = np.broadcast_to(SENDER, (6, 6))
    links = DopplerLinks(
        SENSORS, SENDER, 0.01, bias=7.0, clocks=[0, 0, 0, 1, 1, 1], clock_model="drift"
    )
    x0 = np.r_[TARGET, 20.0, -30.0, 5.0, 2.0]
    x0[:3] -= T[0] * x0[3:6]
    x0[6:8] -= T[0] * x0[8:]
    P0 = e**2 * np.diag([0.01] * 6 + [100.0, 100.0, 25.0, 25.0])
    rng = np.random.default_rng(2)
    z = shifts_by_paths(x0, sender) + e * 0.5 * rng.standard_normal((K, 6))
    z[rng.random(z.shape) < 0.2] = np.nan
    start = x0 + rng.multivariate_normal(np.zeros(10), P0)
    there = ~np.isnan(z)

    def residual(v):
        predicted = shifts_by_paths(start + np.sqrt(np.diag(P0)) * v, sender)
        return np.r_[v, ((z - predicted) / (e * 0.5))[there]]

    def slope(v):
        return np.stack([residual(v + one) - residual(v - one) for one in np.eye(10)], -1) / 2

    fit = least_squares(residual, np.zeros(10), slope)
    F = links.transition(TIMES[-1] + T[0])
    root = np.sqrt(np.diag(P0))
    x = F @ (start + root * fit.x)
    P = F @ (np.linalg.inv(fit.jac.T @ fit.jac) * np.outer(root, root)) @ F.T
    track = ekf(z, links, start, P0, T, 1e-9, e * 0.5, "per_axis")
    scale = np.sqrt(np.diag(P))
    np.testing.assert_allclose((track.x[-1] - x) / scale, 0, atol=0.02)
    np.testing.assert_allclose(
        track.P[-1] / np.outer(scale, scale), P / np.outer(scale, scale), atol=0.01
    )


def shifts_by_paths(before, sender):
    x = before.copy()
    x[:3] += T[0] * x[3:6]
    x[6:8] += T[0] * x[8:]
    h = 1e-4
    later, earlier = (
        paths(x, TIMES + dt, SENSORS) + paths(x, TIMES + dt, sender) for dt in (h, -h)
    )
    offsets = x[6:8] + TIMES[:, None] * x[8:]
    return -(later - earlier) / (2 * h) / 0.01 + 7.0 + np.repeat(offsets, 3, axis=1)


@pytest.mark.parametrize("gate", [None, "upper", "two-sided"])
def test_links_that_stand_still_are_the_compiled_filter(gate):
    array = RadarArray(SENSORS[:, :3])
    links = DopplerLinks.two_way(array.positions, array.wavelength)
    x0, P0, _ = settings(links)
    _, z = world(links, 3, 0.5)
    options = {"noise": "shared", "gate": gate, "gate_probability": 0.9}
    want, got = (ekf(z, which, x0, P0, T, 1.0, 0.5, **options) for which in (array, links))
    for name in ("x", "P", "innovation", "S", "nis"):
        a, b = getattr(want, name), getattr(got, name)
        np.testing.assert_allclose(b, a, rtol=1e-7, atol=1e-8 * np.nanmax(np.abs(a)))
    np.testing.assert_array_equal(got.updated, want.updated)
    alone = ekf(z[1], links, x0, P0, T, 1.0, 0.5, **options, keep=())
    np.testing.assert_allclose(alone.x, got.x[1], rtol=1e-12)
    assert alone.P is None and alone.S is None and alone.innovation is None


def test_a_soft_gate_does_what_it_does_in_ekf_records():
    array = RadarArray(SENSORS[:, :3])
    links = DopplerLinks.two_way(array.positions, array.wavelength)
    x0, P0, _ = settings(links)
    _, z = world(links, 3, 0.5)
    z[1, 20, 2] += 100.0
    F, Q = links.motion(T, 1.0)
    want = ekf_records(
        z, [lambda x, F=F_k: x @ F.T for F_k in F], [lambda x, F=F_k: F for F_k in F], Q,
        lambda x: doppler_shift(x, array), lambda x: doppler_jacobian(x, array),
        0.25 * np.eye(6), x0, P0, gate="soft", gate_probability=0.999,
    )  # fmt: skip
    for which in (array, links):
        got = ekf(z, which, x0, P0, T, 1.0, 0.5, gate="soft", gate_probability=0.999)
        np.testing.assert_allclose(got.x, want.x, rtol=1e-9)
        np.testing.assert_allclose(got.P, want.P, rtol=1e-9, atol=1e-12)


def test_an_offset_that_is_new_at_each_sample_is_that_of_differences():
    """Eliminated: differences to the first link, whose errors are correlated by one half.

    Against the prior of 3e4 Hz the start is known to 20 Hz: 5e-7 of what it says is left.
    """
    links = DopplerLinks.one_way(SENSORS, 0.01, clocks="common", clock_model="epoch")
    rng = np.random.default_rng(3)
    truth = np.c_[TARGET[:3] + TIMES[:, None] * TARGET[3:], np.tile(TARGET[3:], (K, 1)),
                  100 * rng.standard_normal(K)]  # fmt: skip
    z = doppler_shift(truth, links.sampled(K, T)) + 0.5 * rng.standard_normal((K, 6))
    x0 = np.r_[TARGET + 0.05, 0.0]
    P0 = 0.01 * np.eye(7)
    got = ekf(z, links, x0, P0, T, 1.0, 0.5, "per_axis", sigma_clock=3e4)
    plain = DopplerLinks.one_way(SENSORS, 0.01).sampled(K, T)
    F, Q = plain.motion(T, 1.0, "per_axis")
    D = np.c_[-np.ones(5), np.eye(5)]
    at = [plain.at_sample(k) for k in range(K)]
    want = ekf_records(
        z @ D.T, [lambda x, F=F_k: x @ F.T for F_k in F], [lambda x, F=F_k: F for F_k in F], Q,
        [lambda x, a=a: doppler_shift(x, a) @ D.T for a in at],
        [lambda x, a=a: D @ doppler_jacobian(x, a) for a in at],
        0.25 * D @ D.T, x0[:6], P0[:6, :6],
    )  # fmt: skip
    np.testing.assert_allclose(got.x[:, :6], want.x, atol=1e-5)
    np.testing.assert_allclose(got.P[:, :6, :6], want.P, rtol=1e-4, atol=1e-8)
    assert np.abs(got.x[:, 6] - truth[:, 6]).max() < 5 * np.sqrt(got.P[:, 6, 6].max())


CAR, DRIFT = LINKS["car"], LINKS["one way, drift"]


@pytest.mark.parametrize(
    ("links", "changed", "message"),
    [
        (DRIFT, {"x0": TARGET}, r"x0 must have shape \(..., 8\)"),
        (DRIFT, {"P0": np.eye(6)}, r"P0 must have shape \(..., 8, 8\)"),
        (DRIFT, {"sigma_clock": -1.0}, "sigma_clock must be from 0 to"),
        (CAR, {"sigma_drift": 1.0}, "sigma_drift must be from 0 to 0, got 1.0"),
        (CAR, {"T": 2 * T}, "T must have the intervals of the times of the links"),
        (CAR, {"z": np.zeros((K + 1, 6)), "T": 0.1}, "K must be the number of times of the links"),
        (CAR, {"z": np.zeros((K, 5))}, r"z must have shape \(..., any, 6\)"),
    ],
)
def test_wrong_arguments_are_named(links, changed, message):
    x0, P0, _ = settings(links)
    given = {"z": np.zeros((K, 6)), "x0": x0, "P0": P0, "T": T, "sigma_a": 1.0, "sigma_f": 0.5}
    with pytest.raises(ValueError, match=message):
        ekf(array=links, **given | changed)


def test_clocks_of_each_epoch_need_a_deviation_and_sensors_a_distance():
    links = DopplerLinks.one_way(SENSORS, 0.01, clocks="common", clock_model="epoch")
    x0 = np.r_[TARGET, 0.0]
    with pytest.raises(ValueError, match="sigma_clock must be positive for clocks"):
        ekf(np.zeros((K, 6)), links, x0, np.eye(7), T, 1.0, 0.5)
    with pytest.raises(ValueError, match="sigma_f must be large enough against P0 and sigma_clock"):
        ekf(np.zeros((K, 6)), links, x0, np.eye(7), T, 1.0, 0.5, sigma_clock=5e9)
    on = np.r_[SENSORS[0, :3] - T[0] * TARGET[3:], TARGET[3:], 0.0]
    with pytest.raises(ValueError, match="F x0 must not lie on a sensor"):
        ekf(np.zeros((K, 6)), links, on, np.eye(7), T, 1.0, 0.5, sigma_clock=1.0)
