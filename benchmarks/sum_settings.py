"""How far do the errors of the Gaussian sum depend on what we chose: blocks, uniting, weights?

``python benchmarks/sum_settings.py [runs]``; Markdown to standard output. Each setting at half and
at twice its value, on the same records of the workspace, with random acceleration and straight.
"""

import sys

import numpy as np

from dopplerlib.estimation.gaussian_sum import gaussian_sum
from dopplerlib.workspace.errors import error_summary, track_errors
from dopplerlib.workspace.targets import (
    ARRAY,
    INTERVAL,
    PRIOR_COVARIANCE,
    PRIOR_MEAN,
    SIGMA_A,
    SIGMA_F,
    draw_records,
    draw_targets,
)  # fmt: skip

SEED, EVERY = 8803, 20
SHOWN = 4, 9, 24  # 0.1, 0.2, 0.5 s
SETTINGS = (
    {}, {"block": 2}, {"block": 10}, {"loss": 5e-4}, {"loss": 2e-3}, {"lightest": 5e-9},
    {"lightest": 2e-8},
)  # fmt: skip


def main(runs):
    print(f"Mean NEES (standard error) and position error over bound, {runs} runs.\n")
    times = [f"{(i + 1) * EVERY * INTERVAL:g} s" for i in SHOWN]
    heads = [f"{what}, {t}" for what in ("NEES", "over bound") for t in times]
    print("| | " + " | ".join(heads) + " |")
    print("|---" * (len(heads) + 1) + "|")
    for name, sigma_a in {"random acceleration": SIGMA_A, "straight": 0.0}.items():
        truths, noise = np.random.default_rng([SEED, sigma_a > 0]).spawn(2)
        paths = draw_targets(runs, rng=truths, sigma_a=sigma_a, samples=500)
        z = draw_records(paths, rng=noise)
        ended = np.isnan(paths[:, EVERY - 1 :: EVERY])
        for setting in SETTINGS:
            model = PRIOR_MEAN, PRIOR_COVARIANCE, INTERVAL, sigma_a, SIGMA_F
            found = gaussian_sum(z, ARRAY, *model, every=EVERY, **setting)
            x = np.where(ended, np.nan, found.x)
            one = error_summary(track_errors(paths, x, found.P, sigma_a=sigma_a, every=EVERY))
            cells = [f"{one.nees[i]:.2f} ({one.nees_error[i]:.2f})" for i in SHOWN]
            cells += [f"{one.position[i] / one.position_bound[i]:.2f}" for i in SHOWN]
            what = ", ".join(f"{key} {value:g}" for key, value in setting.items()) or "as it is"
            print(f"| {name}, {what} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 400)
