"""Trackers on the same records: consistency, errors over the bound, lost targets, wrong settings.

Some forty minutes on one processor. Four cases of truths, the same runs for all trackers.
"""

import json
from dataclasses import asdict

import numpy as np

from dopplerlib.workspace.comparison import OF_BANK, tracker_study
from dopplerlib.workspace.errors import TrackErrors, error_summary

FILES = (".json",)
# In which cases each tracker is tried, and in how many runs: the demands are on the bank.
RUNS = {
    "bank": ("ABCD", 4000),
    "paper": ("ABCD", 4000),
    "ekf": ("ABCD", 4000),
    "ring_iekf": ("ABCD", 500),
    "ukf": ("ABCD", 1000),
    "learning_bank": ("AB", 2000),
    "own_covariance": ("A", 4000),
    "ekf_bayes": ("A", 4000),
    "iekf": ("A", 1000),
    "iekf_bayes": ("A", 1000),
    "ring_iekf_bayes": ("A", 500),
    "ring_ukf": ("A", 250),
    "iplf": ("A", 250),
    "ring_iplf": ("A", 250),
    "batch": ("B", 200),
    "particles": ("A", 100),
}
# Wrong settings of the bank, and the case that they are tried in.
WRONG = {
    "sigma_f 0.32 Hz": "A",
    "sigma_f 0.5 Hz": "A",
    "sigma_a 0.2 m/s^2": "A",
    "sigma_a 0.8 m/s^2": "A",
    "broad prior": "A",
    "sigma_a 0.4 m/s^2": "B",
}
# No run of this seed was looked at while the Gaussian sum was made.
PARAMETERS = {
    "seed": 3527,
    "runs": [[name, *tried] for name, tried in RUNS.items()],
    "wrong": [list(pair) for pair in WRONG.items()],
    "wrong_runs": 2000,
    "piece": 250,
}
# Digits that are saved, three of what is not named.
DIGITS = {"runs": 4, "nees": 4, "position": 4} | dict.fromkeys(
    ("nees_error", "position_error", "velocity_error", "lost"), 2
)
FIRST = [0, 1], [4, 9]  # runs and times of which NEES stands one by one, for a test


def parts():
    """Return case, tracker and what it assumes, and the runs; slow ones in smaller chunks."""
    right = [(each, name, "right", n) for name, (cases, n) in RUNS.items() for each in cases]
    wrong = [(each, "bank", name, PARAMETERS["wrong_runs"]) for name, each in WRONG.items()]
    return [
        ({"case": case, "tracker": tracker, "assumed": assumed}, runs, _chunk(runs))
        for case, tracker, assumed, runs in right + wrong
    ]


compute = tracker_study


def row(settings, found):
    """Return the statistics of all runs of a part."""
    summary = asdict(error_summary(TrackErrors(**found)))
    if (settings["tracker"], settings["assumed"]) != ("bank", "right"):
        summary = {name: value for name, value in summary.items() if name not in OF_BANK}
    kept = {name: _rounded(values, DIGITS.get(name, 3)) for name, values in summary.items()}
    return settings | {"first": _rounded(found["nees"][np.ix_(*FIRST)], 4)} | kept


def contents(found):
    """Return the statistics of all parts, a line for each."""
    rows = [row(settings, one) for (settings, *_), one in zip(parts(), found, strict=True)]
    head = [f'  "{name}": {json.dumps(value)}' for name, value in PARAMETERS.items()]
    lines = ",\n".join("    " + json.dumps(row, separators=(",", ":")) for row in rows)
    head.append(f'  "rows": [\n{lines}\n  ]')
    return ["{\n" + ",\n".join(head) + "\n}\n"]


def _chunk(runs):
    return min(PARAMETERS["piece"], max(1, runs // 10))


def _rounded(values, digits):
    """Return lists of numbers of a few digits; None is infinite, or of no run."""
    if values.ndim > 1:
        return [_rounded(each, digits) for each in values]
    short = [float(f"{value:.{digits}g}") for value in values]
    return [None if not np.isfinite(v) else int(v) if v == int(v) else v for v in short]
