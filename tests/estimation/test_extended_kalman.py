"""The EKF: where it is exact, what it equals, what cannot change it, and what it refuses."""

from decimal import Decimal, localcontext
from fractions import Fraction

import numpy as np
import pytest
from scipy.stats import binomtest

from dopplerlib import (
    RadarArray,
    chi2_interval,
    constant_velocity,
    doppler_jacobian,
    doppler_shift,
    ekf,
    ekf_update,
    gate_bounds,
    kf,
    kf_predict,
    nis,
)

T, SIGMA_P, SIGMA_F = 1e-3, 0.4, 0.4
RING = RadarArray.ring(6, 0.2)
START = np.array([0.8, 0.1, 0.09, -0.75, -0.12, -0.02])
P0 = np.diag([0.01, 0.01, 0.01, 0.04, 0.04, 0.04])
FIELDS = ("x", "P", "innovation", "S", "nis", "updated")


def straight_path(samples, start=START):
    """Return the states at `samples` times, the first of them one interval after `start`."""
    path = np.tile(start, (samples, 1))
    path[:, :3] += (T * np.arange(1, samples + 1))[:, None] * start[3:]
    return path


def records(runs, samples, seed, array=RING):
    """Return noisy Doppler shifts (*runs, samples, N) of the straight path."""
    noise = np.random.default_rng(seed).standard_normal((*np.atleast_1d(runs), samples, len(array)))
    return doppler_shift(straight_path(samples), array) + SIGMA_F * noise


def filtered(z, array=RING, x0=START, P0=P0, T=T, sigma_f=SIGMA_F, noise="per_axis", **more):
    return ekf(z, array, x0, P0, T, SIGMA_P, sigma_f, noise, **more)


def assert_same_bits(track, other):
    for name in FIELDS:
        got, want = getattr(track, name), getattr(other, name)
        assert got.tobytes() == want.tobytes(), name


# ------------------------------------------------------------------- where the EKF is exact


def one_axis():
    """Return an array, states and Doppler shifts for which H is constant: all on the x axis."""
    array = RadarArray([[-1, 0, 0], [-1.5, 0, 0], [4, 0, 0]])
    H = np.zeros((3, 6))
    H[:, 3] = array.doppler_per_speed * np.array([-1, -1, 1])  # towards which side the sensor is
    x0 = np.array([1.0, 0, 0, 0.3, 0, 0])
    return array, H, x0


def test_ekf_equals_kf_when_the_model_is_linear():
    array, H, x0 = one_axis()
    sigma_f = np.array([0.4, 0.7, 0.2])
    z = np.random.default_rng(1).normal(0.3 * H[:, 3], sigma_f, size=(5, 200, 3))
    F, Q = constant_velocity(T, SIGMA_P, "per_axis")
    track = filtered(z, array, x0, sigma_f=sigma_f)
    linear = kf(z, F, Q, H, np.diag(sigma_f**2), x0, P0)
    # The two share no formula (Joseph against sequential); 200 steps of rounding at relative
    # 1e-16, and h_x, exactly zero on the axis, comes out of the kernel as up to 1e-13.
    np.testing.assert_allclose(track.x, linear.x, rtol=1e-10, atol=1e-12)
    np.testing.assert_allclose(track.P, linear.P, rtol=1e-9, atol=1e-13)
    np.testing.assert_allclose(track.innovation, linear.innovation, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(track.S, linear.S, rtol=1e-9)
    np.testing.assert_allclose(track.nis, linear.nis, rtol=1e-8)
    assert track.updated.all()


def test_ekf_equals_table_1_written_with_matrices():
    z = records(3, 150, seed=2)
    x, P = np.tile(START, (3, 1)), np.tile(P0, (3, 1, 1))
    F, Q = constant_velocity(T, SIGMA_P, "shared")
    R = SIGMA_F**2 * np.eye(6)
    track = filtered(z, noise="shared")
    for k in range(z.shape[1]):
        for run in range(3):
            x_k, P_k = F @ x[run], F @ P[run] @ F.T + Q
            H = doppler_jacobian(x_k, RING)
            S = H @ P_k @ H.T + R
            gain = P_k @ H.T @ np.linalg.inv(S)
            innovation = z[run, k] - doppler_shift(x_k, RING)
            x[run], P[run] = x_k + gain @ innovation, (np.eye(6) - gain @ H) @ P_k
            # S has a condition number of 1e5 at the start, and the errors of an inverse are fed
            # back 150 times: 1e-7 relative to the size of the matrix. Observed: 1e-9.
            np.testing.assert_allclose(track.innovation[run, k], innovation, atol=1e-7)
            np.testing.assert_allclose(track.S[run, k], S, rtol=1e-7, atol=1e-7)
            np.testing.assert_allclose(
                track.nis[run, k], innovation @ np.linalg.inv(S) @ innovation, rtol=1e-6
            )
        np.testing.assert_allclose(track.x[:, k], x, atol=1e-8)
        np.testing.assert_allclose(track.P[:, k], P, atol=1e-9)


def test_nis_is_the_quadratic_form_of_the_innovation_it_returns():
    track = filtered(records(4, 50, seed=3))
    # Sequential sum against a solve with S of condition 1e5.
    np.testing.assert_allclose(track.nis, nis(track.innovation, track.S), rtol=1e-8)


# ------------------------------------------------------- many runs are the same runs alone


@pytest.mark.parametrize("workers", [1, 2, 5, None])
@pytest.mark.parametrize("runs", [1, 15, 16, 17, 33])
def test_run_in_a_batch_has_the_bits_of_the_run_alone(runs, workers):
    rng = np.random.default_rng(4)
    z = records(runs, 30, seed=5)
    z[rng.random(z.shape) < 0.1] = np.nan
    z[:, 20] *= 1.1  # outside the gate
    x0 = START + 0.05 * rng.standard_normal((runs, 6))
    scale = rng.uniform(0.5, 2, (runs, 1, 1))
    together = filtered(z, x0=x0, P0=scale * P0, gate="upper", workers=workers)
    assert not together.updated.all()
    for run in range(runs):
        alone = filtered(z[run], x0=x0[run], P0=scale[run] * P0, gate="upper")
        for name in FIELDS:
            got, want = getattr(together, name)[run], getattr(alone, name)
            assert got.tobytes() == want.tobytes(), (name, run)


@pytest.mark.parametrize("batch", [(), (6,), (2, 3), (2, 1, 3)])
def test_leading_axes_are_batch_axes(batch):
    z = records(6, 20, seed=6)[: int(np.prod(batch))]
    flat = filtered(z)
    track = filtered(z.reshape(*batch, 20, 6))
    assert track.x.shape == (*batch, 20, 6)
    assert track.P.shape == (*batch, 20, 6, 6)
    assert track.S.shape == (*batch, 20, 6, 6)
    assert track.innovation.shape == (*batch, 20, 6)
    assert track.nis.shape == track.updated.shape == (*batch, 20)
    assert_same_bits(track, flat)


def test_one_deviation_is_the_same_for_each_sensor_and_sample():
    z = records(1, 20, seed=8)[0]
    sigma_f = 0.8329  # its square by `pow` and by multiplication differ in the last bit
    one = filtered(z, sigma_f=sigma_f)
    for shape in ((6,), (20, 6)):
        assert_same_bits(one, filtered(z, sigma_f=np.full(shape, sigma_f)))


def test_settings_of_the_call_before_do_not_stay():
    z, other = records(1, 20, seed=9)[0], RadarArray(RING.positions, 0.0124)
    settings = [{"T": 2e-3}, {"sigma_f": 0.3}, {"noise": "shared"}, {"gate": "upper"},
                {"gate": "upper", "gate_probability": 0.5}, {"array": other}]  # fmt: skip
    before = filtered(z)
    for changed in settings:
        found = filtered(z, **changed)
        each = changed | {"T": np.full(20, changed.get("T", T))}  # a way without a memory
        assert_same_bits(found, filtered(z, **each))
        assert found.nis.tobytes() != before.nis.tobytes() or not found.updated.all()
    assert_same_bits(before, filtered(z))


def test_starts_broadcast_against_the_runs():
    z = records((2, 3), 20, seed=7)
    x0 = START + 0.01 * np.arange(3)[:, None]
    scale = np.array([1.0, 3.0])[:, None, None, None]
    track = filtered(z, x0=x0, P0=scale * P0)
    for i, j in np.ndindex(2, 3):
        alone = filtered(z[i, j], x0=x0[j], P0=scale[i, 0] * P0)
        assert track.P[i, j].tobytes() == alone.P.tobytes()
        assert track.x[i, j].tobytes() == alone.x.tobytes()


def test_layout_and_type_of_the_input_do_not_matter():
    z = np.round(records(3, 20, seed=8))
    want = filtered(z)
    assert_same_bits(filtered(np.asfortranarray(z)), want)
    assert_same_bits(filtered(z.tolist()), want)
    assert_same_bits(filtered(z.astype(int)), want)
    assert_same_bits(filtered(np.repeat(z, 2, axis=0)[::2]), want)


def test_input_is_left_as_it_was():
    z, x0, P = records(3, 20, seed=9), START.copy(), P0.copy()
    for value in (z, x0, P):
        value.flags.writeable = False
    filtered(z, x0=x0, P0=P)


# ------------------------------------------------------------------------- missing sensors


def test_sensor_missing_throughout_is_the_array_without_it():
    z = records(3, 60, seed=10)
    z[..., 2] = np.nan
    there = [0, 1, 3, 4, 5]
    track = filtered(z, gate="upper")
    fewer = filtered(z[..., there], RadarArray(RING.positions[there]), gate="upper")
    # Adding zero times something changes no number.
    np.testing.assert_array_equal(track.x, fewer.x)
    np.testing.assert_array_equal(track.P, fewer.P)
    np.testing.assert_array_equal(track.nis, fewer.nis)
    np.testing.assert_array_equal(track.updated, fewer.updated)
    np.testing.assert_array_equal(track.innovation[..., there], fewer.innovation)
    np.testing.assert_array_equal(track.S[..., there, :][..., there], fewer.S)
    assert np.isnan(track.innovation[..., 2]).all()
    assert np.isfinite(track.S).all()


@pytest.mark.parametrize("gate", [None, "upper", "two-sided"])
def test_nothing_measured_is_pure_prediction(gate):
    F, Q = constant_velocity(T, SIGMA_P, "shared")
    track = filtered(np.full((40, 6), np.nan), noise="shared", gate=gate)
    x, P = START, P0
    for k in range(40):
        x, P = F @ x, F @ P @ F.T + Q
        # Four operations a step and entry.
        np.testing.assert_allclose(track.x[k], x, rtol=1e-14)
        np.testing.assert_allclose(track.P[k], P, rtol=1e-13)
    assert np.isnan(track.nis).all()
    assert np.isnan(track.innovation).all()
    assert not track.updated.any()


def test_gap_in_the_record_lets_the_uncertainty_grow():
    z = records(1, 300, seed=11)[0]
    z[100:200] = np.nan
    track = filtered(z)
    variance = np.diagonal(track.P, axis1=-2, axis2=-1)
    assert (np.diff(variance[99:200], axis=0)[:, 3:] > 0).all()
    assert (variance[210] < variance[199]).all()
    assert np.array_equal(track.updated, np.isfinite(z).any(axis=-1))


# ----------------------------------------------------------------------- measurement noise


def test_noise_level_for_each_sensor_and_for_each_sample():
    z = records(2, 40, seed=12)
    each_sensor = np.array([0.2, 0.4, 0.6, 0.4, 0.3, 0.5])
    each_sample = np.tile(each_sensor, (40, 1))
    want = filtered(z, sigma_f=each_sensor)
    assert_same_bits(filtered(z, sigma_f=each_sample), want)
    assert_same_bits(filtered(z, sigma_f=np.full((40, 1), 0.4)), filtered(z, sigma_f=0.4))
    # The first half of a record does not know of the second, and starts it.
    each_sample[20:] *= 3
    track = filtered(z, sigma_f=each_sample)
    np.testing.assert_array_equal(track.x[:, :20], want.x[:, :20])
    later = filtered(z[:, 20:], x0=track.x[:, 19], P0=track.P[:, 19], sigma_f=3 * each_sensor)
    # The filter keeps the factors of P. Those of a P that was multiplied out differ by rounding,
    # enlarged by the condition of its correlations, 1e4.
    np.testing.assert_allclose(track.x[:, 20:], later.x, rtol=0, atol=1e-12)
    np.testing.assert_allclose(track.P[:, 20:], later.P, rtol=1e-9, atol=1e-15)
    assert not np.allclose(track.x[:, 20:], want.x[:, 20:], rtol=0, atol=1e-6)


def test_sensor_of_no_precision_is_a_missing_sensor():
    z = records(1, 60, seed=13)[0]
    without = z.copy()
    without[:, 4] = np.nan
    sigma_f = np.full(6, SIGMA_F)
    sigma_f[4] = 1e9
    track, fewer = filtered(z, sigma_f=sigma_f), filtered(without)
    # Its weight is (100 Hz / 1e9 Hz)^2 = 1e-14 of its innovation at the start, less later on.
    np.testing.assert_allclose(track.x, fewer.x, rtol=0, atol=1e-11)
    np.testing.assert_allclose(track.P, fewer.P, rtol=0, atol=1e-12)
    np.testing.assert_allclose(track.nis, fewer.nis, rtol=1e-9)


# ----------------------------------------------------------------- random scenes, vague starts


def random_scene(seed, sensors):
    """Return array, start, uneven intervals, path and shifts with a fifth of them missing."""
    rng = np.random.default_rng(seed)
    array = RadarArray(rng.standard_normal((sensors, 3)) * [0.03, 0.3, 0.3])
    start = rng.uniform([0.5, -0.3, -0.3, -1, -1, -1], [1.5, 0.3, 0.3, 0, 1, 1])
    intervals = T * rng.uniform(0.2, 5, 30)
    path = np.tile(start, (30, 1))
    path[:, :3] += np.cumsum(intervals)[:, None] * start[3:]
    z = doppler_shift(path, array)
    z[rng.random(z.shape) < 0.2] = np.nan
    return array, start, intervals, path, z


@pytest.mark.parametrize("noise", ["shared", "per_axis"])
@pytest.mark.parametrize("sensors", [1, 2, 5, 8])
def test_each_step_is_that_of_the_linear_filter(sensors, noise):
    """`kf_predict` and `ekf_update` with matrices, from where the track was one sample before."""
    array, start, intervals, _, z = random_scene(22 + sensors, sensors)
    z += SIGMA_F * np.random.default_rng(23).standard_normal(z.shape)
    track = ekf(z, array, start, P0, intervals, SIGMA_P, SIGMA_F, noise)
    F, Q = constant_velocity(intervals, SIGMA_P, noise)
    x, P = start, P0
    for k in range(len(z)):
        here = np.isfinite(z[k])
        some = RadarArray(array.positions[here]) if here.any() else array
        x, P = kf_predict(x, P, F[k], Q[k])
        x, P, innovation, S = ekf_update(
            x, P, z[k, here] if here.any() else z[k],
            lambda x, some=some: doppler_shift(x, some),
            lambda x, some=some: doppler_jacobian(x, some),
            SIGMA_F**2 * np.eye(len(some)),
        )  # fmt: skip
        # One step: rounding times the condition of S, 1e6.
        s = np.sqrt(np.diagonal(P))
        assert (np.abs(track.x[k] - x) < 1e-9 * s).all()
        assert (np.abs(track.P[k] - P) < 1e-9 * np.outer(s, s)).all()
        if here.any():
            np.testing.assert_allclose(track.innovation[k, here], innovation, rtol=0, atol=1e-9)
            np.testing.assert_allclose(track.S[k][np.ix_(here, here)], S, rtol=1e-9)
            weighted = np.linalg.solve(S, innovation)
            np.testing.assert_allclose(track.nis[k], innovation @ weighted, rtol=1e-8)
        x, P = track.x[k], track.P[k]


def precise_ekf(z, array, x0, P0, intervals, noise):
    """Return states and covariances of Table 1 with sixty digits inside, P - k s k' by sensors."""
    precise = np.vectorize(lambda value: Decimal(float(value)), otypes=[object])
    axes = np.ones((3, 1), int) if noise == "shared" else np.eye(3, dtype=int)
    with localcontext(prec=60):
        x, P, positions = precise(x0), precise(P0), precise(array.positions)
        g, sigma_a, r = map(Decimal, (array.doppler_per_speed, SIGMA_P, SIGMA_F**2))
        steps = []
        for z_k, interval in zip(z, precise(intervals), strict=True):
            F = np.eye(6, dtype=int) + interval * np.eye(6, k=3, dtype=int)
            G = sigma_a * np.vstack([interval**2 / 2 * axes, interval * axes])
            x, P = F @ x, F @ P @ F.T + G @ G.T
            predicted = x
            for n in np.flatnonzero(np.isfinite(z_k)):
                d = positions[n] - predicted[:3]
                rho, v = (d @ d).sqrt(), predicted[3:]
                u = d / rho
                h = g * np.concatenate([(u @ v * u - v) / rho, u])
                w = P @ h
                k = w / (h @ w + r)
                e = Decimal(z_k[n]) - g * (u @ v) - h @ (x - predicted)
                x, P = x + k * e, P - np.outer(k, w)
            steps.append((x, P))
    x, P = zip(*steps, strict=True)
    return np.array(x, float), np.array(P, float)


@pytest.mark.parametrize("noise", ["shared", "per_axis"])
@pytest.mark.parametrize("ratio", [1e0, 1e8, 1e16, 1e24])
def test_a_vague_start_costs_no_digits(ratio, noise):
    """P0 = ratio R, in m^2 and (m/s)^2 beside Hz^2, and measurements without noise.

    With fewer than six sensors a direction shows only in how the geometry changes from sample to
    sample. That is a difference of Jacobians, which double precision has with few digits.
    """
    for sensors in (6, 7, 8, 9):
        array, start, intervals, _, z = random_scene(30 + sensors, sensors)
        vague = ratio * SIGMA_F**2 * np.eye(6)
        track = ekf(z, array, start, vague, intervals, SIGMA_P, SIGMA_F, noise)
        x, P = precise_ekf(z, array, start, vague, intervals, noise)
        s = np.sqrt(np.diagonal(P, axis1=1, axis2=2))
        scale = s[:, :, None] * s[:, None, :]
        # The Jacobian is right to 1e-15, and its condition may be 1e6 while sensors are missing.
        # Observed in 20 scenes: 1e-9 at most, whatever the ratio. P - k s k' is off by 1e-4 at a
        # ratio of 1e8, and by powers of ten beyond.
        assert (np.abs(track.P - P) < 1e-6 * scale).all()
        assert (np.abs(track.x - x) < 1e-6 * s).all()


@pytest.mark.parametrize("runs", [1, 16])
@pytest.mark.parametrize("noise", ["shared", "per_axis"])
def test_covariances_are_symmetric_and_without_negative_variances(runs, noise):
    """From P0 / R of 1 to 1e30, in doubles of 16 digits, also where all sensors are in a plane."""
    z = np.tile(doppler_shift(straight_path(100), RING), (runs, 1, 1))
    for variance, sigma_f in [(1, 0.4), (1e8, 0.01), (1e4, 1e-5), (1e12, 0.1), (1e20, 1e-5)]:
        track = filtered(z, P0=variance * np.eye(6), sigma_f=sigma_f, noise=noise)
        s = np.sqrt(np.diagonal(track.P, axis1=-2, axis2=-1))
        assert (s > 0).all()
        np.testing.assert_array_equal(track.P, np.swapaxes(track.P, -1, -2))
        np.testing.assert_array_equal(track.S, np.swapaxes(track.S, -1, -2))
        # An entry is a sum of six products, each rounded three times: 1e-15 on this scale.
        scaled = track.P / (s[..., :, None] * s[..., None, :])
        assert np.linalg.eigvalsh(scaled).min() > -1e-14
        assert np.linalg.eigvalsh(track.S).min() > -1e-14 * np.abs(track.S).max()


def test_what_is_known_exactly_stays_so_until_noise_drives_it():
    """A plane start: z and v_z have no variance; the noise along (1, 1, 0) leaves it so."""
    flat = np.array([0.5, 0.2, 0, -1, 0.5, 0])
    array = RadarArray.linear(5, 0.4)
    path = straight_path(30, flat)
    z = doppler_shift(path, array) + 0.1 * np.random.default_rng(24).standard_normal((30, 5))
    for covariance in (np.diag([1e-4, 1e-4, 0, 1e-2, 1e-2, 0]), np.zeros((6, 6))):
        track = ekf(z, array, flat, covariance, T, 1e-3, 0.1, "per_axis")
        # Nothing that is measured here tells of z: only the noise moves it, one axis by itself.
        F, Q = constant_velocity(T, 1e-3, "per_axis")
        P = covariance
        for k in range(30):
            P = F @ P @ F.T + Q
            np.testing.assert_allclose(track.P[k][2::3, 2::3], P[2::3, 2::3], rtol=1e-12)
        assert (track.x[:, 2::3] == 0).all()
        x, P = kf_predict(flat, covariance, F, Q)
        R = 0.01 * np.eye(5)
        x, P, _, _ = ekf_update(
            x, P, z[0], lambda x: doppler_shift(x, array), lambda x: doppler_jacobian(x, array), R
        )
        s = np.sqrt(np.diagonal(P))
        np.testing.assert_allclose(track.x[0], x, rtol=0, atol=1e-10)
        assert (np.abs(track.P[0] - P) < 1e-9 * np.outer(s, s)).all()


def test_a_singular_start_with_correlations_is_that_of_the_linear_filter():
    """All that is uncertain is how far along one direction of state space the target is."""
    direction = np.array([0.1, -0.05, 0.02, 0.2, 0.1, -0.3])
    rank_one = np.outer(direction, direction)
    z = records(1, 1, seed=25)[0]
    track = filtered(z, P0=rank_one)
    F, Q = constant_velocity(T, SIGMA_P, "per_axis")
    x, P = kf_predict(START, rank_one, F, Q)
    x, P, _, _ = ekf_update(
        x, P, z[0], lambda x: doppler_shift(x, RING), lambda x: doppler_jacobian(x, RING),
        SIGMA_F**2 * np.eye(6),
    )  # fmt: skip
    s = np.sqrt(np.diagonal(P))
    np.testing.assert_allclose(track.x[0], x, rtol=0, atol=1e-10)
    assert (np.abs(track.P[0] - P) < 1e-9 * np.outer(s, s)).all()


def test_a_missing_sensor_right_at_the_target_does_no_harm():
    step = 2.0**-10  # exact in binary, so that the third prediction is exactly at the sensor
    array = RadarArray([[0, 0, 0], [0, 1, 0], [0, 0, 1]])
    x0 = [3 * step, 0, 0, -1, 0, 0]
    z = np.zeros((3, 3))
    z[:, 0] = np.nan
    z[:2] = np.nan
    track = ekf(z, array, x0, P0, step, SIGMA_P, SIGMA_F)
    others = ekf(z[:, 1:], RadarArray(array.positions[1:]), x0, P0, step, SIGMA_P, SIGMA_F)
    assert track.updated[2]
    np.testing.assert_array_equal(track.x, others.x)
    np.testing.assert_array_equal(track.P, others.P)


# ----------------------------------------------------------------------------- uneven times


@pytest.mark.parametrize("noise", ["shared", "per_axis"])
def test_the_same_interval_given_for_each_sample_changes_no_bit(noise):
    z = records(2, 20, seed=20)
    assert_same_bits(filtered(z, T=np.full(20, T), noise=noise), filtered(z, noise=noise))


@pytest.mark.parametrize("runs", [1, 17])
def test_a_lost_sample_is_a_longer_interval_up_to_its_noise(runs):
    """Without noise a prediction over two intervals is that over one of twice the length.

    The noise of a long interval is not that of two short ones; 1e-9 m/s^2 is none beside rounding.
    """
    z, kept = records(runs, 40, seed=21), [0, 1, 2, 6, 7, 12, 39]
    missing = np.full(z.shape, np.nan)
    missing[:, kept] = z[:, kept]
    intervals = T * np.diff(kept, prepend=-1)
    track = ekf(z[:, kept], RING, START, P0, intervals, 1e-9, SIGMA_F)
    full = ekf(missing, RING, START, P0, T, 1e-9, SIGMA_F)
    np.testing.assert_allclose(track.x, full.x[:, kept], rtol=0, atol=1e-10)
    np.testing.assert_allclose(track.P, full.P[:, kept], rtol=0, atol=1e-12)
    np.testing.assert_allclose(track.nis, full.nis[:, kept], rtol=1e-8)


# ------------------------------------------------------------------------------------ gate


@pytest.mark.parametrize("gate", ["upper", "two-sided"])
def test_refused_measurement_leaves_the_prediction(gate):
    z = records(3, 60, seed=14)
    z[1, 30] += 50.0  # a hundred standard deviations
    F, Q = constant_velocity(T, SIGMA_P, "per_axis")
    track = filtered(z, gate=gate, gate_probability=0.999)
    lower, upper = gate_bounds(gate, 6, 0.999)
    inside = (lower[6] <= track.nis) & (track.nis <= upper[6])
    np.testing.assert_array_equal(track.updated, inside)
    assert not track.updated[1, 30]
    # As many operations as in a prediction with matrices: rounding only.
    np.testing.assert_allclose(track.x[1, 30], F @ track.x[1, 29], rtol=1e-14)
    np.testing.assert_allclose(track.P[1, 30], F @ track.P[1, 29] @ F.T + Q, rtol=1e-13)
    missing = z.copy()
    missing[1, 30] = np.nan
    np.testing.assert_array_equal(
        track.x[1], filtered(missing, gate=gate, gate_probability=0.999).x[1]
    )
    assert track.nis[1, 30] > upper[6]
    assert np.isfinite(track.innovation[1, 30]).all()


def test_two_sided_gate_refuses_what_fits_too_well():
    z = doppler_shift(straight_path(50), RING)  # no noise at all
    assert filtered(z, gate="upper").updated.all()
    assert not filtered(z, gate="two-sided").updated.any()


def test_gate_counts_the_sensors_that_are_there():
    """An NIS of 9 passes the 95 % gate for 6 measurements (12.6), not for 3 (7.8)."""
    z = doppler_shift(straight_path(1), RING)
    residual = np.array([1.0, 0, 0, 0, 0, 0])
    size = np.sqrt(9 / filtered(z + residual).nis[0])
    six = filtered(z + size * residual, gate="upper")
    assert six.nis[0] == pytest.approx(9, rel=1e-9)
    assert six.updated[0]
    z[:, 3:] = np.nan
    size = np.sqrt(9 / filtered(z + residual).nis[0])
    three = filtered(z + size * residual, gate="upper")
    assert three.nis[0] == pytest.approx(9, rel=1e-9)
    assert not three.updated[0]


def test_gate_bounds_are_printed_chi_square_quantiles():
    lower, upper = gate_bounds("two-sided", 6)
    # Mittermaier et al. (2016), Section 3.5, and the same table for 2 degrees: -2 ln(p).
    assert [round(lower[6], 3), round(upper[6], 3)] == [1.237, 14.449]
    assert [lower[2], upper[2]] == pytest.approx([-2 * np.log(0.975), -2 * np.log(0.025)])
    lower, upper = gate_bounds("upper", 2, 0.9)
    assert upper[2] == pytest.approx(-2 * np.log(0.1))
    assert np.isneginf(lower).all()
    lower, upper = gate_bounds(None, 3)
    assert np.isneginf(lower).all() and np.isposinf(upper).all()
    assert gate_bounds("upper", 0)[1].shape == (1,)


@pytest.mark.parametrize("gate", ["upper", "two-sided"])
def test_gate_refuses_one_in_twenty_of_a_consistent_filter(gate):
    """On one axis the EKF is exact, so NIS of first samples are independent chi-square.

    Exact binomial test: false-alarm probability 1e-6.
    """
    array, H, x0 = one_axis()
    F, Q = constant_velocity(T, SIGMA_P, "per_axis")
    rng = np.random.default_rng(15)
    runs = 20_000
    v_x = x0[3] + np.sqrt((F @ P0 @ F.T + Q)[3, 3]) * rng.standard_normal((runs, 1, 1))
    z = H[:, 3] * v_x + SIGMA_F * rng.standard_normal((runs, 1, 3))
    # Linearized on the axis, the other axes do not enter.
    track = filtered(z, array, x0, gate=gate, keep=())
    refused = int((~track.updated).sum())
    assert binomtest(refused, runs, 0.05).pvalue > 1e-6
    lower, upper = chi2_interval(3, runs, confidence=1 - 1e-6)
    assert lower < track.nis.mean() < upper


# ------------------------------------------------------------------------------ invariance


def test_turning_target_and_ring_together_changes_nothing():
    """A turn by 60 degrees about x takes the ring to itself: sensor n becomes n + 1."""
    z = records(4, 100, seed=16)
    angle = np.pi / 3
    turn = np.array(
        [[1, 0, 0], [0, np.cos(angle), -np.sin(angle)], [0, np.sin(angle), np.cos(angle)]]
    )
    both = np.kron(np.eye(2), turn)
    track = filtered(z)
    turned = filtered(np.roll(z, 1, axis=-1), x0=both @ START, P0=both @ P0 @ both.T)
    # Sensors are processed in another order: rounding of 100 steps with S of condition 1e5.
    np.testing.assert_allclose(turned.x, track.x @ both.T, rtol=0, atol=1e-10)
    np.testing.assert_allclose(turned.P, both @ track.P @ both.T, rtol=0, atol=1e-11)
    np.testing.assert_allclose(turned.nis, track.nis, rtol=1e-7)
    # The common noise points along (1, 1, 1): it does not turn with the rest.
    common = filtered(z, noise="shared").P
    turned = filtered(
        np.roll(z, 1, axis=-1), x0=both @ START, P0=both @ P0 @ both.T, noise="shared"
    ).P
    assert np.abs(turned - both @ common @ both.T).max() > 1e-7


def test_order_of_the_sensors_does_not_matter():
    z = records(4, 100, seed=17)
    order = [3, 1, 5, 0, 4, 2]
    track = filtered(z)
    shuffled = filtered(z[..., order], RadarArray(RING.positions[order]))
    # As above.
    np.testing.assert_allclose(shuffled.x, track.x, rtol=0, atol=1e-10)
    np.testing.assert_allclose(shuffled.P, track.P, rtol=0, atol=1e-11)
    np.testing.assert_allclose(shuffled.nis, track.nis, rtol=1e-7)


def exactly_positive_definite(matrix):
    """Return whether the floating-point matrix is positive definite, in rational arithmetic."""
    a = [[Fraction(value) for value in row] for row in matrix.tolist()]
    for i in range(len(a)):
        if a[i][i] <= 0:
            return False
        for j in range(i + 1, len(a)):
            factor = a[j][i] / a[i][i]
            a[j] = [x - factor * y for x, y in zip(a[j], a[i], strict=True)]
    return True


def test_covariance_stays_symmetric_and_positive_definite_with_rank_one_noise():
    samples = 20_000
    time = T * np.arange(1, samples + 1)
    # To and fro along (1, 1, 1), the only acceleration that this noise knows.
    swing, speed = 0.13 * np.sin(2 * time), 0.26 * np.cos(2 * time)
    truth = np.zeros((samples, 6))
    truth[:, :3] = np.array([0.6, 0.05, -0.05]) + swing[:, None]
    truth[:, 3:] = speed[:, None]
    rng = np.random.default_rng(18)
    z = doppler_shift(truth, RING) + SIGMA_F * rng.standard_normal((samples, 6))
    track = filtered(z, x0=[0.6, 0.05, -0.05, 0.26, 0.26, 0.26], noise="shared")
    np.testing.assert_array_equal(track.P, np.swapaxes(track.P, -1, -2))
    np.linalg.cholesky(track.P)  # would raise
    for P in track.P[::500]:
        assert exactly_positive_definite(P)


# ---------------------------------------------------------------------- what comes, and not


@pytest.mark.parametrize("keep", [(), ("P",), ["S"], {"innovation", "P"}])
def test_keep_leaves_the_rest_out_and_changes_nothing(keep):
    z = records(17, 10, seed=19)
    full = filtered(z, gate="upper")
    track = filtered(z, gate="upper", keep=keep)
    for name in FIELDS:
        if name in ("P", "innovation", "S") and name not in keep:
            assert getattr(track, name) is None
        else:
            assert getattr(track, name).tobytes() == getattr(full, name).tobytes()


def test_prediction_onto_a_sensor_is_not_used():
    """A range of zero has no line of sight: the measurement is skipped, the run goes on."""
    array = RadarArray([[0, 0, 0], [0, 1, 0]])
    step = 2.0**-10  # exact in binary, so that the third prediction is exactly zero
    x0 = [3 * step, 0, 0, -1, 0, 0]
    z = np.full((5, 2), np.nan)
    z[2] = 100.0
    track = ekf(z, array, x0, P0, step, SIGMA_P, SIGMA_F)
    assert np.isnan(track.nis[2]) and not track.updated[2]
    assert np.isfinite(track.x).all() and np.isfinite(track.P).all()
    assert track.x[2, 0] == 0


def test_overflow_is_never_an_update():
    track = filtered(np.full((20, 6), 1e308))
    broken = ~np.isfinite(track.nis)
    assert broken.any()
    assert not track.updated[np.isnan(track.nis)].any()


ASYMMETRIC = P0 + np.eye(6, k=1) * 1e-6
BAD = [
    # argument, value, the value as the message must give it, what was expected
    ("z", np.zeros(6), "(6,)", "shape (..., any, 6)"),
    ("z", np.zeros((4, 5)), "(4, 5)", "shape (..., any, 6)"),
    ("z", 3.0, "()", "shape (..., any, 6)"),
    ("z", np.zeros((0, 6)), "(0, 6)", "at least one run and one sample"),
    ("z", np.zeros((0, 4, 6)), "(0, 4, 6)", "at least one run and one sample"),
    ("z", [], "(0,)", "shape (..., any, 6)"),
    ("z", np.full((4, 6), np.inf), "inf at index (0, 0)", "finite, or NaN"),
    ("z", np.full((4, 6), -np.inf), "-inf", "finite, or NaN"),
    ("z", "text", "'text'", "real numbers"),
    ("z", [["1"] * 6] * 4, "'1'", "real numbers"),
    ("z", np.zeros((4, 6)) + 1j, "j", "real numbers"),
    ("z", [[1.0, 2.0], [3.0]], "[3.0]", "real numbers"),
    ("z", np.zeros((4, 6), bool), "False", "real numbers"),
    ("z", [[None] * 6] * 4, "None", "real numbers"),
    ("z", np.ma.masked_equal(np.zeros((4, 6)), 0), "masked_array", "mask"),
    ("array", None, "None", "RadarArray"),
    ("array", RING.positions, "array", "RadarArray"),
    ("array", "ring", "'ring'", "RadarArray"),
    ("x0", np.zeros(5), "(5,)", "shape (..., 6)"),
    ("x0", np.zeros((6, 1)), "(6, 1)", "shape (..., 6)"),
    ("x0", np.ones((3, 6)), "(3, 6)", "broadcast against the runs (2,)"),
    ("x0", np.ones((0, 6)), "(0, 6)", "broadcast against the runs (2,)"),
    ("x0", START * np.nan, "nan", "finite"),
    ("x0", START + 0j, "0.8", "real numbers"),
    ("x0", "start", "'start'", "real numbers"),
    ("x0", [0, 0.2, 0, 0, 0, 0], "[0.0, 0.2, 0.0]", "not lie on a sensor"),
    ("x0", [-T, 0.2, 0, 1, 0, 0], "[0.0, 0.2, 0.0]", "not lie on a sensor"),
    ("P0", np.eye(5), "(5, 5)", "shape (..., 6, 6)"),
    ("P0", 0.1, "()", "shape (..., 6, 6)"),
    ("P0", np.stack([P0] * 3), "(3, 6, 6)", "broadcast against the runs (2,)"),
    ("P0", ASYMMETRIC, "1e-06", "symmetric"),
    ("P0", -P0, "-0.04", "positive semidefinite"),
    ("P0", np.diag([1.0, 1, 1, 1, 1, -1]), "-1", "positive semidefinite"),
    ("P0", np.diag([np.inf] * 6), "inf", "finite"),
    ("P0", P0 + 0j, "0.01", "real numbers"),
    ("T", 0, "0.0", "positive"),
    ("T", -1e-3, "-0.001", "positive"),
    ("T", np.nan, "nan", "finite"),
    ("T", np.inf, "inf", "finite"),
    ("T", "1 ms", "'1 ms'", "real numbers"),
    ("T", None, "None", "real numbers"),
    ("T", True, "True", "real numbers"),
    ("T", [T, T], "(2,)", "one number or have shape (K,) = (4,)"),
    ("T", [[T] * 4], "(1, 4)", "one number or have shape (K,) = (4,)"),
    ("T", [T, T, 0, T], "0.0 at index (2,)", "positive"),
    ("T", 1e300, "1e+300", "square"),
    ("sigma_a", 0, "0.0", "positive"),
    ("sigma_a", -0.4, "-0.4", "positive"),
    ("sigma_a", np.inf, "inf", "finite"),
    ("sigma_a", 1e200, "1e+200", "square"),
    ("sigma_a", [0.4, 0.4], "(2,)", "one number"),
    ("sigma_f", 0, "0.0", "positive"),
    ("sigma_f", -0.4, "-0.4", "positive"),
    ("sigma_f", [0.4] * 5 + [-1], "-1.0 at index (5,)", "positive"),
    ("sigma_f", np.nan, "nan", "finite"),
    ("sigma_f", [0.4, 0.4], "(2,)", "broadcast to (K, N) = (4, 6)"),
    ("sigma_f", np.ones((2, 4, 6)), "(2, 4, 6)", "broadcast to (K, N) = (4, 6)"),
    ("sigma_f", [], "(0,)", "broadcast to (K, N) = (4, 6)"),
    ("sigma_f", 1e-200, "1e-200", "square"),
    ("sigma_f", 1e200, "1e+200", "square"),
    ("sigma_f", 1j, "1j", "real numbers"),
    ("noise", "white", "'white'", "one of 'shared', 'per_axis'"),
    ("noise", None, "None", "one of 'shared', 'per_axis'"),
    ("noise", np.array(["shared", "shared"]), "array", "one of 'shared', 'per_axis'"),
    ("gate", "lower", "'lower'", "one of None, 'upper', 'two-sided'"),
    ("gate", 0.95, "0.95", "one of None, 'upper', 'two-sided'"),
    ("gate", True, "True", "one of None, 'upper', 'two-sided'"),
    ("gate_probability", 0, "0.0", "between 0 and 1"),
    ("gate_probability", 1, "1.0", "between 0 and 1"),
    ("gate_probability", -0.5, "-0.5", "between 0 and 1"),
    ("gate_probability", 95, "95.0", "between 0 and 1"),
    ("gate_probability", np.nan, "nan", "finite"),
    ("gate_probability", [0.9, 0.95], "(2,)", "one number"),
    ("keep", "P", "'P'", "collection of 'P', 'innovation', 'S'"),
    ("keep", None, "None", "collection of 'P', 'innovation', 'S'"),
    ("keep", ("P", "x"), "'x'", "one of 'P', 'innovation', 'S'"),
    ("workers", 0, "0", "at least 1"),
    ("workers", -2, "-2", "at least 1"),
    ("workers", 1.5, "1.5", "whole number"),
    ("workers", "2", "'2'", "whole number"),
    ("workers", True, "True", "whole number"),
]


@pytest.mark.parametrize(("name", "value", "got", "expected"), BAD)
def test_bad_input_is_named(name, value, got, expected):
    arguments = {
        "z": np.zeros((2, 4, 6)), "array": RING, "x0": START, "P0": P0, "T": T,
        "sigma_a": SIGMA_P, "sigma_f": SIGMA_F,
    }  # fmt: skip
    with pytest.raises(ValueError, match=rf"^(F )?{name} must ") as raised:
        ekf(**arguments | {name: value})
    before, _, after = str(raised.value).partition("got ")
    assert expected in before
    assert got in after


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("lower", 6), "gate must be one of"),
        (("upper", -1), "sensors must be a whole number of at least 0, got -1"),
        (("upper", 2.5), "sensors must be a whole number of at least 0, got 2.5"),
        (("upper", 6, 1.0), "gate_probability must lie between 0 and 1, got 1.0"),
    ],
)
def test_bad_gate_is_named(arguments, message):
    with pytest.raises(ValueError, match="^" + message):
        gate_bounds(*arguments)
