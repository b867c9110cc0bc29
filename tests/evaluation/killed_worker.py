"""A study whose worker is killed: alone here, so that workers load no more than they need."""

import os
import signal
import time
from pathlib import Path

import numpy as np

from dopplerlib.evaluation.monte_carlo import run_rngs


def draws(settings, seed, runs):
    """Return three normal values of each run."""
    rngs = run_rngs(seed, runs)
    return {"x": np.array([settings["mean"] + rng.normal(size=3) for rng in rngs])}


def killed(settings, seed, runs):
    """Kill the worker that computes run 12, once, when the others have had time for theirs."""
    if 12 in runs and not os.path.exists(settings["once"]):
        time.sleep(0.3)
        Path(settings["once"]).touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return draws(settings, seed, runs)
