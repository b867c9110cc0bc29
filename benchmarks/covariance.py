"""Does the covariance stay symmetric and positive definite, over a million steps?

``python benchmarks/covariance.py [steps]``; Markdown to standard output, progress to standard
error. Several forms of the update run over the same measurements; a form stops where its
covariance first fails. Every covariance is checked.

The process noise of Eq 17 has rank one: it drives the target along (1, 1, 1) and nowhere else.
What it never drives becomes known better and better, and P comes close to singular, which is the
hard part. The path keeps to that direction, so that the model holds and all that can go wrong is
rounding: back and forth before the ring with the acceleration that the tracker expects.
"""

import sys
import time

import numpy as np
import peers
from measuring import SCENARIO

from dopplerlib import Scenario, constant_velocity, doppler_shift, ekf

CHUNK = 20_000
CENTER, AMPLITUDE = np.array([0.6, 0.0, 0.0]), 0.2  # m

FORMS = {
    "P - K H P": lambda P, K, H, S, R: P - K @ H @ P,
    "P - K H P with K' = solve(S, H P)": lambda P, K, H, S, R: (
        P - np.linalg.solve(S, H @ P).T @ H @ P
    ),
    "P - K S K'": lambda P, K, H, S, R: P - K @ S @ K.T,
    "Joseph: (I - K H) P (I - K H)' + K R K'": lambda P, K, H, S, R: (
        (np.eye(6) - K @ H) @ P @ (np.eye(6) - K @ H).T + K @ R @ K.T
    ),
}


def main(steps):
    scenario = Scenario.from_toml(SCENARIO)
    print(f"{steps} steps; a million of them last 1000 s of the target's time.\n")
    print("| update | not positive definite at step | largest asymmetry | least eigenvalue of P |")
    print("|---|---|---|---|")
    runs = {"dopplerlib: U D U', sensor by sensor": of_the_library(scenario)}
    runs |= {name: plain(scenario, form) for name, form in FORMS.items()}
    for name, run in runs.items():
        print(f"| {name} | {watch(name, run, scenario, steps)} |", flush=True)


def path(scenario, first, samples):
    """Return true states: harmonic motion along (1, 1, 1), sigma_a its largest acceleration."""
    w = np.sqrt(scenario.sigma_a / AMPLITUDE)
    t = scenario.T * np.arange(first, first + samples)
    position = CENTER + AMPLITUDE * np.sin(w * t)[:, None] * np.ones(3)
    velocity = AMPLITUDE * w * np.cos(w * t)[:, None] * np.ones(3)
    return np.hstack([position, velocity])


def watch(name, run, scenario, steps):
    """Filter in chunks, each from where the last one ended; return the row of the table."""
    rng = np.random.default_rng(1_000_000)  # the same measurements for every form
    x = path(scenario, -1, 1)[0] + rng.multivariate_normal(np.zeros(6), scenario.P0 / 100)
    P = scenario.P0
    asymmetry, least = 0.0, np.inf
    start = time.perf_counter()
    for first in range(0, steps, CHUNK):
        truth = path(scenario, first, min(CHUNK, steps - first))
        z = doppler_shift(truth, scenario.array)
        z += scenario.sigma_f * rng.standard_normal(z.shape)
        xs, Ps = run(z, x, P)
        broken = first_broken(Ps)
        whole = Ps[:broken]  # all of it if `broken` is None
        if len(whole):
            scale = scaling(whole)
            asymmetry = max(asymmetry, np.abs((whole - whole.swapaxes(1, 2)) * scale).max())
            least = min(least, np.linalg.eigvalsh(whole)[:, 0].min())
        done = first + len(z) if broken is None else first + broken + 1
        error = np.linalg.norm(xs[-1, :3] - truth[-1, :3])
        print(f"{name}: step {done}, {time.perf_counter() - start:.0f} s, position error "
              f"{error:.1e} m", file=sys.stderr, flush=True)  # fmt: skip
        if broken is not None:
            return f"{done} | {asymmetry:.0e} | {least:.0e}"
        x, P = xs[-1], Ps[-1]
    return f"never | {asymmetry:.0e} | {least:.0e}"


def scaling(Ps):
    """Return 1 / sqrt(P_ii P_jj), which makes every diagonal entry one."""
    deviation = np.sqrt(np.diagonal(Ps, axis1=1, axis2=2))
    return 1 / (deviation[:, :, None] * deviation[:, None, :])


def first_broken(Ps):
    """Return the index of the first matrix that is not positive definite, or None.

    Cholesky's factorization decides, after scaling to a unit diagonal: otherwise meters against
    meters per second would decide.
    """
    bad = ~(np.diagonal(Ps, axis1=1, axis2=2) > 0).all(axis=1)
    good = int(np.argmax(bad)) if bad.any() else len(Ps)
    scaled = Ps[:good] * scaling(Ps[:good])
    try:
        np.linalg.cholesky(scaled)
    except np.linalg.LinAlgError:
        for i, matrix in enumerate(scaled):
            try:
                np.linalg.cholesky(matrix)
            except np.linalg.LinAlgError:
                return i
    return good if good < len(Ps) else None


def of_the_library(scenario):
    """Return dopplerlib's filter as a function of measurements, state and covariance."""

    def run(z, x, P):
        track = ekf(z, scenario.array, x, P, scenario.T, scenario.sigma_a, scenario.sigma_f,
                    keep=("P",))  # fmt: skip
        return track.x, track.P

    return run


def plain(scenario, form):
    """Return an EKF in NumPy whose covariance is updated by `form`."""
    array = scenario.array
    F, Q = constant_velocity(scenario.T, scenario.sigma_a)
    R = scenario.sigma_f**2 * np.eye(len(array))
    return lambda z, x, P: peers.textbook(array, x, P, F, Q, R, form)(z)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000)
