"""What does the Gaussian sum cost: its start, a step, a sample that comes alone?

``python benchmarks/gaussian_sum.py [rounds]``; Markdown to standard output. Records of a second in
the workspace and from the paper's Table 2, six sensors, one thread, in processor time; the EKF of
the library takes the same records in the same rounds.
"""

import sys
import time

import numpy as np

from dopplerlib import ekf
from dopplerlib.estimation.gaussian_sum import gaussian_sum, gaussian_sum_online
from dopplerlib.workspace.targets import (
    ARRAY,
    INTERVAL,
    PRIOR_COVARIANCE,
    PRIOR_MEAN,
    SIGMA_A,
    SIGMA_F,
    TABLE_2,
    draw_records,
    draw_targets,
)  # fmt: skip

RUNS, LENGTHS = 40, (5, 100, 1000)
PRIOR = ARRAY, PRIOR_MEAN, PRIOR_COVARIANCE, INTERVAL
CASES = {
    "workspace, random acceleration": (None, SIGMA_A),
    "workspace, straight": (None, 0.0),
    "Table 2, random acceleration": (TABLE_2, SIGMA_A),
    "Table 2, straight": (TABLE_2, 0.0),
}


def main(rounds):
    print(f"Microseconds a run, median (least to most) of {rounds} rounds over {RUNS} runs.\n")
    heads = [f"first {K} samples" for K in LENGTHS]
    print(f"| | {' | '.join(heads)} | EKF, {LENGTHS[-1]} samples | ÷ EKF |")
    print("|---|" + "---|" * (len(LENGTHS) + 2))
    for name, (x0, sigma_a) in CASES.items():
        z = whole_records(x0, sigma_a)
        rows = [one_round(z, sigma_a) for _ in range(rounds + 1)][1:]
        *times, plain = np.transpose(rows)
        cells = [spread(values * 1e6) for values in (*times, plain, times[-1] / plain * 1e-6)]
        print(f"| {name} | {' | '.join(cells)} |", flush=True)
    print(
        "\nMicroseconds from a sample to its estimate, samples one by one, the mixture included.\n"
    )
    print("| | first estimate | median to 0.1 s | most, 0.01 s to 0.1 s | median after 0.5 s |")
    print("|---|---|---|---|---|")
    for name, (x0, sigma_a) in CASES.items():
        taken = np.min([one_by_one(whole_records(x0, sigma_a)[0], sigma_a) for _ in range(3)], 0)
        early, late = taken[10:100], taken[500:]
        values = taken[4], np.median(early), early.max(), np.median(late)
        print(f"| {name} | {' | '.join(short(value * 1e6) for value in values)} |", flush=True)


def whole_records(x0, sigma_a):
    """Return measurements of targets that are there for the whole second."""
    truths, noise = np.random.default_rng(2016).spawn(2)
    paths = draw_targets(4 * RUNS, rng=truths, sigma_a=sigma_a, x0=x0)
    z = draw_records(paths, rng=noise)
    return z[np.isfinite(z[:, -1, 0])][:RUNS]


def one_round(z, sigma_a):
    """Return the seconds a run for each length, and those of the EKF."""
    rest = sigma_a, SIGMA_F
    found = [
        for_each_run(lambda z, K=K: gaussian_sum(z, *PRIOR, *rest, every=K, workers=1), z[:, :K])
        for K in LENGTHS
    ]
    plain = for_each_run(lambda z: ekf(z, *PRIOR, SIGMA_A, SIGMA_F, keep=("P",), workers=1), z)
    return *found, plain


def for_each_run(function, z):
    """Return the processor time of one more run, without what is done once a call."""
    taken = []
    for runs in (z[:1], z):
        start = time.process_time()
        function(runs)
        taken.append(time.process_time() - start)
    return (taken[1] - taken[0]) / (len(z) - 1)


def one_by_one(z, sigma_a):
    """Return the seconds that each sample of one record takes."""
    update = gaussian_sum_online(*PRIOR, sigma_a, SIGMA_F, mixture=16)
    taken = np.empty(len(z))
    for k, sample in enumerate(z):
        start = time.thread_time()
        update(sample)
        taken[k] = time.thread_time() - start
    return taken


def spread(values):
    return f"{short(np.median(values))} ({short(values.min())} to {short(values.max())})"


def short(value):
    return f"{value:.0f}" if value >= 100 else f"{value:.3g}"


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 7)
