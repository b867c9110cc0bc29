"""Kalman filters of velocity and acceleration behind one or two sensors, compiled."""

import numpy as np

from ..._compile import cached_njit, inner_njit

FIXED, OWN, FUSED, STATE = 0, 1, 2, 3


@inner_njit
def _place(nodes, value):
    """Return the interval of the nodes that holds a value, and the relative position in it."""
    last = len(nodes) - 1
    if value <= nodes[0]:
        return 0, 0.0
    if value >= nodes[last]:
        return last - 1, 1.0
    i = 0
    while value > nodes[i + 1]:
        i += 1
    return i, (value - nodes[i]) / (nodes[i + 1] - nodes[i])


@inner_njit
def _put(x, P, from_x, from_P):
    """Copy a state; numba takes seconds to compile what NumPy writes in one line."""
    for i in range(2):
        x[i] = from_x[i]
        for j in range(2):
            P[i, j] = from_P[i, j]


@cached_njit
def choose(a, snr_db, a_nodes, snr_nodes, log_table, log_windows):
    """Return the number of the window that is nearest to the interpolated table, in logarithms."""
    i, u = _place(a_nodes, abs(a))
    j, t = _place(snr_nodes, snr_db)
    wanted = (1 - u) * ((1 - t) * log_table[i, j] + t * log_table[i, j + 1]) + u * (
        (1 - t) * log_table[i + 1, j] + t * log_table[i + 1, j + 1]
    )
    best = 0
    for w in range(1, len(log_windows)):
        if abs(log_windows[w] - wanted) < abs(log_windows[best] - wanted):
            best = w
    return best


def filter_pair(
    v, snr_db, R, delay, T, q, a_std, feedback, fixed,
    a_nodes, snr_nodes, log_table, log_windows,
    x, P, P12, fused_x, fused_P, choice, innovation, S,
):  # fmt: skip
    """Write the states of all filters, and of their fusion, at all times.

    `v`, `snr_db` (W, runs, sensors, K) are measurements with each of W windows, `R` (W, sensors)
    their variances, `delay` (W,) the ages that the filters take them to have. The results are `x`
    (runs, sensors, K, 2), `P` (runs, sensors, K, 2, 2), `P12` (runs, K, 2, 2), `fused_x`,
    `fused_P`, the number of the window `choice` (runs, sensors, K), and `innovation` and `S`, whose
    first entries are NaN: the first measurement is the start.

    The state is velocity and acceleration, F = [[1, T], [0, 1]], with white jerk of density q:
    Q = q [[T^3/3, T^2/2], [T^2/2, T]]. A measurement that is `delay` old has H = [1, -delay]. All
    is written out in components: a study takes millions of steps of two by two.
    """
    runs, sensors, count = v.shape[1:]
    q00, q01, q11 = q * T**3 / 3, q * T**2 / 2, q * T
    A = np.zeros((2, 2, 2))  # I - K H of each sensor
    for r in range(runs):
        for s in range(sensors):
            choice[r, s, 0] = fixed
            x[r, s, 0, 0], x[r, s, 0, 1] = v[fixed, r, s, 0], 0.0
            P[r, s, 0, 0, 0], P[r, s, 0, 1, 1] = R[fixed, s], a_std**2
            P[r, s, 0, 0, 1], P[r, s, 0, 1, 0] = 0.0, 0.0
            innovation[r, s, 0], S[r, s, 0] = np.nan, np.nan
        # Both take the acceleration to be zero at first, and err by the same.
        P12[r, 0] = 0.0
        P12[r, 0, 1, 1] = a_std**2
        for k in range(count):
            for s in range(sensors):
                if k == 0:
                    continue
                w = choice[r, s, k]
                p00, p01, p11 = P[r, s, k - 1, 0, 0], P[r, s, k - 1, 0, 1], P[r, s, k - 1, 1, 1]
                velocity = x[r, s, k - 1, 0] + T * x[r, s, k - 1, 1]
                acceleration = x[r, s, k - 1, 1]
                p00 += 2 * T * p01 + T * T * p11 + q00
                p01 += T * p11 + q01
                p11 += q11
                h = -delay[w]
                c0, c1 = p00 + h * p01, p01 + h * p11  # P H'
                variance = c0 + h * c1 + R[w, s]
                nu = v[w, r, s, k] - velocity - h * acceleration
                k0, k1 = c0 / variance, c1 / variance
                innovation[r, s, k], S[r, s, k] = nu, variance
                if np.isnan(nu):  # missing: the prediction stays
                    k0, k1, nu = 0.0, 0.0, 0.0
                x[r, s, k, 0], x[r, s, k, 1] = velocity + k0 * nu, acceleration + k1 * nu
                a, b, c, d = 1 - k0, -k0 * h, -k1, 1 - k1 * h
                A[s, 0, 0], A[s, 0, 1], A[s, 1, 0], A[s, 1, 1] = a, b, c, d
                # In the form of Joseph.
                m0, m1 = a * p00 + b * p01, a * p01 + b * p11
                n0, n1 = c * p00 + d * p01, c * p01 + d * p11
                P[r, s, k, 0, 0] = m0 * a + m1 * b + k0 * k0 * R[w, s]
                P[r, s, k, 0, 1] = m0 * c + m1 * d + k0 * k1 * R[w, s]
                P[r, s, k, 1, 0] = P[r, s, k, 0, 1]
                P[r, s, k, 1, 1] = n0 * c + n1 * d + k1 * k1 * R[w, s]
            if sensors == 1:
                _put(fused_x[r, k], fused_P[r, k], x[r, 0, k], P[r, 0, k])
            else:
                if k > 0:
                    # Cross covariance of the two errors (Bar-Shalom and Campo), which share the
                    # process noise: P12 = (I - K1 H1) (F P12 F' + Q) (I - K2 H2)'.
                    C, M = P12[r, k - 1], P12[r, k]
                    e00 = C[0, 0] + T * (C[0, 1] + C[1, 0]) + T * T * C[1, 1] + q00
                    e01, e10 = C[0, 1] + T * C[1, 1] + q01, C[1, 0] + T * C[1, 1] + q01
                    e11 = C[1, 1] + q11
                    for i in range(2):
                        f0 = A[0, i, 0] * e00 + A[0, i, 1] * e10
                        f1 = A[0, i, 0] * e01 + A[0, i, 1] * e11
                        for j in range(2):
                            M[i, j] = f0 * A[1, j, 0] + f1 * A[1, j, 1]
                # Eqs 15 to 17, with the inverse of the sum written out: W = P1 (P1 + P2)^-1,
                # x = x1 + W (x2 - x1), P = P1 - W P1.
                B, D = P[r, 0, k], P[r, 1, k]
                g00, g01, g11 = B[0, 0] + D[0, 0], B[0, 1] + D[0, 1], B[1, 1] + D[1, 1]
                det = g00 * g11 - g01 * g01
                y0, y1 = x[r, 1, k, 0] - x[r, 0, k, 0], x[r, 1, k, 1] - x[r, 0, k, 1]
                for i in range(2):
                    w0 = (B[i, 0] * g11 - B[i, 1] * g01) / det
                    w1 = (B[i, 1] * g00 - B[i, 0] * g01) / det
                    fused_x[r, k, i] = x[r, 0, k, i] + w0 * y0 + w1 * y1
                    for j in range(2):
                        fused_P[r, k, i, j] = B[i, j] - w0 * B[0, j] - w1 * B[1, j]
            if feedback == STATE:
                for s in range(sensors):
                    _put(x[r, s, k], P[r, s, k], fused_x[r, k], fused_P[r, k])
            if k == count - 1:
                continue
            for s in range(sensors):
                choice[r, s, k + 1] = fixed
                if feedback == OWN:
                    seen = snr_db[choice[r, s, k], r, s, k]
                    choice[r, s, k + 1] = choose(
                        x[r, s, k, 1], seen, a_nodes, snr_nodes, log_table, log_windows
                    )
                elif feedback == FUSED or feedback == STATE:
                    seen = 0.0
                    for other in range(sensors):
                        seen += snr_db[choice[r, other, k], r, other, k] / sensors
                    choice[r, s, k + 1] = choose(
                        fused_x[r, k, 1], seen, a_nodes, snr_nodes, log_table, log_windows
                    )


compiled = cached_njit(filter_pair)
