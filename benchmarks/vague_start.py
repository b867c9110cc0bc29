"""How many digits of the covariance does each form of the update leave, after a vague start?

``python benchmarks/vague_start.py``; Markdown to standard output. After a start that knows next to
nothing, good measurements make variances fall by many powers of ten within a few samples. Most
forms get there by a difference of large numbers. The reference is P - K H P with sixty digits.
Every form gets the same matrices; the Jacobians are those of the true path.
"""

from decimal import Decimal, localcontext

import numpy as np

from dopplerlib import RadarArray, doppler_jacobian
from dopplerlib.kernels import ekf as kernel
from dopplerlib.model.motion import constant_velocity, dwna_gain

SCENES, SAMPLES = 20, 40
T, SIGMA_P, SIGMA_F = 0.001, 0.4, 0.4
RATIOS = 10.0 ** np.arange(0, 25, 4)
UPPER = np.triu_indices(6)


def main():
    print(f"Largest error of P beside the true deviations, |dP_ij| / (s_i s_j), over {SAMPLES}")
    print(f"samples of {SCENES} random scenes; in brackets the share of the scenes in which a")
    print("variance became negative or S singular.\n")
    print(f"| P0 / R, m² / Hz² | {' | '.join(f'{ratio:.0e}' for ratio in RATIOS)} |")
    print("|---|" + "---|" * len(RATIOS))
    rows = {name: [] for name in FORMS}
    for ratio in RATIOS:
        rng = np.random.default_rng(2016)
        scenes = [scene(rng, ratio) for _ in range(SCENES)]
        exact = [reference(*each) for each in scenes]
        for name, form in FORMS.items():
            results = [worst_error(form, each, P) for each, P in zip(scenes, exact, strict=True)]
            errors, broken = zip(*results, strict=True)
            share = f" ({np.mean(broken):.0%})" if any(broken) else ""
            rows[name].append(f"{np.nanmax(errors):.0e}{share}")
    for name, cells in rows.items():
        print(f"| {name} | {' | '.join(cells)} |")


def scene(rng, ratio):
    """Return P0, the Jacobians (K, N, 6), R, F and G sigma_a of a random scene."""
    sensors = rng.integers(3, 9)
    array = RadarArray(0.3 * rng.standard_normal((sensors, 3)) * [0.1, 1, 1])
    start = rng.uniform([0.5, -0.3, -0.3, -1, -1, -1], [1.5, 0.3, 0.3, 0, 1, 1])
    path = np.tile(start, (SAMPLES, 1))
    path[:, :3] += T * np.arange(SAMPLES)[:, None] * start[3:]
    noise = rng.choice(["shared", "per_axis"])
    G = SIGMA_P * dwna_gain(np.array(T), noise)
    P0 = ratio * SIGMA_F**2 * np.eye(6)
    R = np.full(sensors, SIGMA_F**2)
    return P0, doppler_jacobian(path, array), R, constant_velocity(T, SIGMA_P)[0], G


def worst_error(form, arguments, exact):
    """Return the largest scaled error, and whether a variance was negative or S singular."""
    try:
        P = np.array(list(form(*arguments)))
    except np.linalg.LinAlgError:
        return np.nan, True
    s = np.sqrt(np.diagonal(exact, axis1=1, axis2=2))
    error = np.abs(P - exact) / (s[:, :, None] * s[:, None, :])
    return error.max(), not (np.diagonal(P, axis1=1, axis2=2) >= 0).all()


def reference(*arguments):
    """Return the covariances, (K, 6, 6), with sixty digits inside."""
    with localcontext() as context:
        context.prec = 60
        exact = [np.vectorize(Decimal, otypes=[object])(value) for value in arguments]
        return np.array(list(subtractive(*exact)), float)


def predicted(P, F, G):
    return F @ P @ F.T + G @ G.T


def subtractive(P, H, R, F, G):
    """Sensor by sensor: P - k u'."""
    for H_k in H:
        P = predicted(P, F, G)
        for h, r in zip(H_k, R, strict=True):
            u = P @ h
            P = P - u[:, None] / (h @ u + r) * u  # not symmetric to the last bit
            P = np.where(np.tri(6, k=-1) > 0, P.T, P)
        yield P


def scalar_joseph(P, H, R, F, G):
    """Sensor by sensor: (I - k h') P (I - k h')' + r k k'."""
    for H_k in H:
        P = predicted(P, F, G)
        for h, r in zip(H_k, R, strict=True):
            u = P @ h
            k = u / (h @ u + r)
            A = np.eye(6) - np.outer(k, h)
            P = A @ P @ A.T + r * np.outer(k, k)
            P = (P + P.T) / 2
        yield P


def joseph(P, H, R, F, G):
    """All sensors at once: (I - K H) P (I - K H)' + K R K'."""
    for H_k in H:
        P = predicted(P, F, G)
        S = H_k @ P @ H_k.T + np.diag(R)
        K = np.linalg.solve(S, H_k @ P).T
        A = np.eye(6) - K @ H_k
        P = A @ P @ A.T + K * R @ K.T
        P = (P + P.T) / 2
        yield P


def potter(P, H, R, F, G):
    """P = L L', sensor by sensor (Potter); the prediction by an orthogonal factorization."""
    L = np.sqrt(P)  # diagonal
    for H_k in H:
        L = np.linalg.qr(np.hstack([F @ L, G]).T, mode="r").T
        for h, r in zip(H_k, R, strict=True):
            f = L.T @ h
            s = f @ f + r
            L = L - np.outer(L @ f / (s + np.sqrt(r * s)), f)
        yield L @ L.T


def udu_once(P, H, R, F, G):
    """U D U' factored from the predicted P of each sample, multiplied out after its update."""
    for H_k in H:
        work = factored(predicted(P, F, G))
        P = updated(work, H_k, R)
        yield P


def udu_carried(P, H, R, F, G):
    """U D U' from start to end: the library's kernels."""
    work = factored(P)
    for H_k in H:
        kernel.predict(work, 1, 0, T)
        for g in G.T:
            kernel.add_noise(work, 1, 0, *g)
        yield updated(work, H_k, R)


def factored(P):
    """Return a work array of the kernels with the factors of `P`, as good as they come."""
    work, row = np.zeros(kernel.ROWS), kernel.FACTORS
    U, D = np.eye(6), np.zeros(6)
    for j in reversed(range(6)):
        D[j] = P[j, j] - np.sum(U[j, j + 1 :] ** 2 * D[j + 1 :])
        U[:j, j] = (P[:j, j] - U[:j, j + 1 :] @ (D[j + 1 :] * U[j, j + 1 :])) / D[j]
    work[row : row + 21] = (U - np.eye(6) + np.diag(D))[UPPER]
    return work


def updated(work, H, R):
    """Run the kernels' update on `work`; return P."""
    for h, r in zip(H, R, strict=True):
        sensor = np.zeros(kernel.SENSOR_ROWS)
        sensor[kernel.GRADIENT : kernel.GRADIENT + 6], sensor[kernel.VARIANCE] = h, r
        kernel.update(work, sensor, 1, 0)
    kernel.covariance(work, 1, 0)
    P = np.zeros((6, 6))
    P[UPPER] = work[kernel.COVARIANCE : kernel.COVARIANCE + 21]
    return P + np.triu(P, 1).T


FORMS = {
    "P - k s k', sensor by sensor": subtractive,
    "Joseph, sensor by sensor": scalar_joseph,
    "Joseph, all sensors at once": joseph,
    "U D U', factored anew for each sample": udu_once,
    "Potter's square root, carried": potter,
    "U D U', carried: dopplerlib": udu_carried,
}

if __name__ == "__main__":
    main()
