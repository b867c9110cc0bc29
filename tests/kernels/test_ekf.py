"""The printed EKF cycle, one scalar update after another, is the matrix EKF of Table 1.

Twice: with fifty digits, where the same text must agree to forty of them whatever the condition of
the matrices, and with doubles, where only rounding may differ.
"""

import types
from dataclasses import replace

import mpmath
import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from dopplerlib.kernels import ekf as kernel

SEEDS = st.integers(0, 2**32 - 1)
SENSORS = st.integers(1, 12)
UPPER = np.triu_indices(6)
KERNELS = (
    kernel.predict, kernel.add_noise, kernel.linearize, kernel.project, kernel.update,
    kernel.covariance,
)  # fmt: skip


def run(cycle, work, kernels=KERNELS, number=lambda x: x):
    """Run one cycle on `work`; return it and the rows of each sensor before the update."""
    predict, add_noise, linearize, project, update, covariance = kernels
    predict(work, 1, 0, number(cycle.T))
    for g in cycle.G.T:
        add_noise(work, 1, 0, *map(number, g))
    sensors = []
    for n, position in enumerate(cycle.sensors):
        sensor = [number(np.zeros(len(cycle.x))) for _ in range(kernel.SENSOR_ROWS)]
        sensor[kernel.MEASUREMENT] = number(cycle.measured(n))
        linearize(work, sensor, 1, 0, *map(number, position), number(cycle.g))
        project(work, sensor, 1, 0)
        sensors.append(sensor)
    for n, sensor in enumerate(sensors):
        entered = list(sensor)
        cycle.leave_out_missing(n, entered, number)
        update(work, entered, 1, 0)
    covariance(work, 1, 0)
    return work, sensors


def innovations(sensors):
    """Return the innovations, (N, runs)."""
    return np.array([sensor[kernel.INNOVATION] for sensor in sensors])


def of_sensors(cycle, which):
    """Return the cycle of some of the sensors, in this order."""
    return replace(
        cycle, z=cycle.z[:, which], sensors=cycle.sensors[which], variance=cycle.variance[which]
    )


def unpacked(upper):
    """Return (..., 6, 6) symmetric matrices from their upper triangles, (21, ...)."""
    upper = np.moveaxis(np.asarray(upper), 0, -1)
    matrix = np.empty((*upper.shape[:-1], 6, 6), upper.dtype)
    matrix[..., UPPER[0], UPPER[1]] = matrix[..., UPPER[1], UPPER[0]] = upper
    return matrix


def transition(T):
    F = np.eye(6)
    F[:3, 3:] = T * np.eye(3)
    return F


def table_1(cycle, row, nu=None):
    """Return correction, covariances before and after, NIS, S and innovation of one run.

    Correction and NIS are those of the innovation `nu`, or of the one that is returned.
    """
    F = transition(cycle.T)
    x, P = F @ cycle.x[row], F @ cycle.P[row] @ F.T + cycle.Q
    seen = ~np.isnan(cycle.z[row])
    to_sensor = cycle.sensors[seen] - x[:3]
    rho = np.linalg.norm(to_sensor, axis=1, keepdims=True)
    u = to_sensor / rho
    radial = (u @ x[3:])[:, None]
    H = cycle.g * np.concatenate([(radial * u - x[3:]) / rho, u], axis=1)
    innovation = cycle.z[row][seen] - cycle.g * radial[:, 0]
    nu = innovation if nu is None else nu
    S = H @ P @ H.T + np.diag(cycle.variance[seen])
    K = np.linalg.solve(S, H @ P).T
    return K @ nu, P, P - K @ S @ K.T, nu @ np.linalg.solve(S, nu), S, innovation


@settings(max_examples=100, derandomize=True, deadline=None)
@given(SEEDS, SENSORS, st.sampled_from([0.0, 0.3]))
def test_with_doubles_the_cycle_is_table_1(random_cycle, seed, n, missing):
    # 100 examples of 20 runs: 2000 cycles of 1 to 12 sensors. Matrices are compared on the scale of
    # the predicted standard deviations: |P_ij| <= s_i s_j, and a correction is at most
    # s_i sqrt(NIS). Solving with S multiplies rounding by the condition of S, at most; a dozen
    # sensors and six states add up some hundred roundings of 1.1e-16. The innovation is compared
    # by itself, because it is a difference: it is right to some hundred roundings of z and g |v|,
    # since a target close by sees the rounding of its own position enlarged.
    cycle = random_cycle(np.random.default_rng(seed), n, 20, missing)
    work, sensors = run(cycle, cycle.work())
    P_new = unpacked(work[kernel.COVARIANCE : kernel.COVARIANCE + 21])
    for row in range(len(cycle.x)):
        seen = ~np.isnan(cycle.z[row])
        nu = innovations(sensors)[seen, row]
        z = cycle.z[row][seen]
        correction, P, P_expected, nis, S, nu_expected = table_1(cycle, row, nu)
        speed = np.linalg.norm(cycle.x[row, 3:])
        assert (np.abs(nu - nu_expected) <= 1e-13 * (np.abs(z) + cycle.g * speed)).all()
        s = np.sqrt(np.diag(P))
        tolerance = 1e-14 * (np.linalg.cond(S) if len(nu) else 1.0)
        got = work[kernel.CORRECTION : kernel.CORRECTION + 6, row]
        assert (np.abs(P_new[row] - P_expected) <= tolerance * np.outer(s, s)).all()
        assert (np.abs(got - correction) <= tolerance * s * np.sqrt(nis)).all()
        assert abs(work[kernel.NIS, row] - nis) <= tolerance * nis


@settings(max_examples=100, derandomize=True, deadline=None)
@given(SEEDS)
def test_with_doubles_the_time_update_is_f_p_f_plus_q(random_cycle, seed):
    # A dozen roundings of each entry, on the scale of the deviations.
    cycle = random_cycle(np.random.default_rng(seed), 1, 20)
    work = cycle.work()
    kernel.predict(work, 1, 0, cycle.T)
    for g in cycle.G.T:
        kernel.add_noise(work, 1, 0, *g)
    kernel.covariance(work, 1, 0)
    F = transition(cycle.T)
    P = F @ cycle.P @ F.T + cycle.Q
    s = np.sqrt(np.diagonal(P, axis1=1, axis2=2))
    got = unpacked(work[kernel.COVARIANCE : kernel.COVARIANCE + 21])
    assert (np.abs(got - P) <= 1e-14 * s[:, :, None] * s[:, None, :]).all()
    moved = cycle.x @ F.T
    got = work[kernel.PREDICTED : kernel.PREDICTED + 6].T
    assert (np.abs(got - moved) <= 1e-15 * np.abs(cycle.x) @ np.abs(F.T)).all()


@settings(max_examples=100, derandomize=True, deadline=None)
@given(SEEDS, SENSORS, st.data())
def test_a_missing_sensor_is_no_sensor(random_cycle, seed, n, data):
    # To the last bit.
    rng = np.random.default_rng(seed)
    cycle = random_cycle(rng, n, 20)
    gone = data.draw(st.sets(st.integers(0, n - 1), min_size=1))
    z = cycle.z.copy()
    z[:, sorted(gone)] = np.nan
    left = [i for i in range(n) if i not in gone]
    full = replace(cycle, z=z)
    small = of_sensors(full, left)
    work, expected = full.work(), small.work()
    run(full, work)
    run(small, expected)
    assert np.array_equal(work, expected)


# --- the same text with fifty digits ---------------------------------------------------------


def precise(function):
    """Return `function` with a square root of fifty digits: the rest is + - * / anyway."""
    return types.FunctionType(function.__code__, {"sqrt": mpmath.sqrt})


def precise_table_1(cycle):
    """Return correction, P after the update, predicted P, NIS, innovation: batch, fifty digits."""
    F = mpmath.matrix(transition(0).tolist())
    for i in range(3):
        F[i, i + 3] = mpmath.mpf(cycle.T)
    x = F * mpmath.matrix(cycle.x[0].tolist())
    FU, G = F * mpmath.matrix(cycle.U[0].tolist()), mpmath.matrix(cycle.G.tolist())
    P = FU * mpmath.diag(cycle.D[0].tolist()) * FU.T + G * G.T
    seen = [n for n in range(len(cycle.sensors)) if not np.isnan(cycle.z[0, n])]
    H, nu = mpmath.zeros(len(seen), 6), mpmath.zeros(len(seen), 1)
    for row, n in enumerate(seen):
        # h(x) and its Jacobian as derivatives of the norm: rho' = -u, and h = -g d rho / dt.
        d = [mpmath.mpf(cycle.sensors[n, i]) - x[i] for i in range(3)]
        rho = mpmath.norm(d)
        u = [d_i / rho for d_i in d]
        radial = mpmath.fdot(u, x[3:])
        for i in range(3):
            H[row, i] = cycle.g * (radial * u[i] - x[3 + i]) / rho
            H[row, 3 + i] = cycle.g * u[i]
        nu[row] = mpmath.mpf(cycle.z[0, n]) - cycle.g * radial
    S = H * P * H.T + mpmath.diag([mpmath.mpf(cycle.variance[n]) for n in seen])
    K = P * H.T * S**-1
    return K * nu, P - K * H * P, P, (nu.T * S**-1 * nu)[0], nu


@settings(max_examples=100, derandomize=True, deadline=None)
@given(SEEDS, SENSORS, st.sampled_from([0.0, 0.3]), st.sampled_from([1.0, 1e-12]))
def test_with_fifty_digits_the_cycle_is_table_1(random_cycle, seed, n, missing, quiet):
    # `quiet` makes R so small that S, of N > 6 sensors, has a condition of 1e16 or more: hopeless
    # with doubles in matrix form, but of fifty digits more than thirty remain.
    cycle = random_cycle(np.random.default_rng(seed), n, 1, missing)
    cycle = replace(cycle, variance=cycle.variance * quiet)
    if np.isnan(cycle.z).all():
        return
    with mpmath.workdps(50):
        work = [mpmath.mpf(value) for value in cycle.work()[:, 0].tolist()]
        run(cycle, work, [precise(function) for function in KERNELS], _mpf)
        correction, P_new, P, nis, _ = precise_table_1(cycle)
        s = [mpmath.sqrt(P[i, i]) for i in range(6)]
        tolerance = mpmath.mpf(10) ** -30
        for row, (i, j) in enumerate(zip(*UPPER, strict=True)):
            i, j = int(i), int(j)
            assert abs(work[kernel.COVARIANCE + row] - P_new[i, j]) < tolerance * s[i] * s[j]
        for i in range(6):
            error = abs(work[kernel.CORRECTION + i] - correction[i])
            assert error < tolerance * s[i] * mpmath.sqrt(nis)
        assert abs(work[kernel.NIS] - nis) < tolerance * nis


def _mpf(value):
    return mpmath.mpf(float(np.asarray(value).item()))


# --- what follows from the algebra -----------------------------------------------------------


@settings(max_examples=50, derandomize=True, deadline=None)
@given(SEEDS, st.integers(2, 12))
def test_the_order_of_the_sensors_does_not_matter(random_cycle, seed, n):
    # The sum of the same information in another order: rounding only, times the condition.
    rng = np.random.default_rng(seed)
    cycle = random_cycle(rng, n, 1)
    order = rng.permutation(n)
    other = of_sensors(cycle, order)
    work, sensors = run(cycle, cycle.work())
    shuffled, sensors_shuffled = run(other, other.work())
    nu = innovations(sensors)
    # The innovation belongs to the predicted state, so it does not know of the sensors before.
    assert np.array_equal(nu[order], innovations(sensors_shuffled))
    _, P, _, _, S, _ = table_1(cycle, 0)
    s, tolerance = np.sqrt(np.diag(P)), 1e-14 * np.linalg.cond(S)
    P_new, P_shuffled = (
        unpacked(w[kernel.COVARIANCE : kernel.COVARIANCE + 21]) for w in (work, shuffled)
    )
    assert (np.abs(P_new - P_shuffled) <= tolerance * np.outer(s, s)).all()
    _, _, _, nis, _, _ = table_1(cycle, 0, nu[:, 0])
    assert abs(work[kernel.NIS, 0] - shuffled[kernel.NIS, 0]) <= tolerance * nis


@settings(max_examples=50, derandomize=True, deadline=None)
@given(SEEDS, SENSORS)
def test_the_rows_of_the_sensors_give_the_innovation_covariance(random_cycle, seed, n):
    # f_n of one sensor times b_m of another is entry (n, m) of H P H'. The scale of an
    # entry is the product of the standard deviations on the diagonal.
    cycle = random_cycle(np.random.default_rng(seed), n, 1)
    _, sensors = run(cycle, cycle.work())
    rows = np.array(sensors)[..., 0]
    f = rows[:, kernel.PROJECTION : kernel.PROJECTION + 6]
    b = rows[:, kernel.WEIGHTED : kernel.WEIGHTED + 6]
    _, _, _, _, S, _ = table_1(cycle, 0)
    s = np.sqrt(np.diag(S))
    assert (np.abs(f @ b.T + np.diag(cycle.variance) - S) <= 1e-13 * np.outer(s, s)).all()


def test_the_rows_of_the_arrays_do_not_overlap():
    def rows(**sizes):
        return sorted(
            getattr(kernel, name) + i for name, size in sizes.items() for i in range(size)
        )

    work = rows(PREDICTED=6, FACTORS=21, CORRECTION=6, NIS=1, COVARIANCE=21)
    assert work == list(range(kernel.ROWS))
    sensor = rows(MEASUREMENT=1, VARIANCE=1, INNOVATION=1, GRADIENT=6, PROJECTION=6, WEIGHTED=6)
    assert sensor == list(range(kernel.SENSOR_ROWS))
