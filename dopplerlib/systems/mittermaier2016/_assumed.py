"""Measurement noise that the filter of the example assumes, raised at the start or not."""

import numpy as np

from .published import reported

RAISED = {"not raised": 0, "R x 10, 10 samples": 10, "R x 10, 100 samples": 100}


def assumed_deviation(raised):
    """Return the standard deviation by sample, shape (1001, 1), for a key of `RAISED`."""
    s = reported().scenario
    deviation = np.full((s.samples, 1), s.sigma_f)
    deviation[: RAISED[raised]] *= np.sqrt(10)
    return deviation
