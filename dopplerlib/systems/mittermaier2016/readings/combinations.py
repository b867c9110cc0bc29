"""Every combination of four causes of overconfidence, on the same records.

``make study NAME=combinations`` computes them; what it found is in ``results`` and read here.
"""

from itertools import product
from typing import Literal

import numpy as np

from ...._data import read_json, results
from ...._hints import Runs, checked
from ...._typing import FloatArray
from ..published import reported
from .ablation import Consistency, Noise, consistency_runs, matched_P0

MOMENTS = (0, 1, 3, 10, 20, 50, 100, 200, 300, 500, 700, 999)  # samples
SWITCHES = {
    "P0": ("published", "matched"),
    "noise": ("shared", "per_axis"),
    "start": ("fixed", "drawn"),
    "world": ("curved", "straight"),
}


@checked
def combination_runs(
    runs: Runs,
    P0: Literal["published", "matched"],
    noise: Noise,
    start: Literal["fixed", "drawn"],
    world: Literal["curved", "straight"],
    *,
    rng: np.random.Generator,
) -> Consistency:
    """Run the simulation example with each of four causes as published, or removed.

    runs: Number of independent records.
    P0: That of the paper, 0.1 I, or `matched_P0`.
    noise: See `constant_velocity`.
    start: The estimate of Table 2, or the truth with an error that is drawn from `matched_P0`.
    world: Whether the Doppler shift bends away from its tangent, see `ablated_ekf`.
    rng: Source of randomness: run 3 has the same noise in any combination.
    Returns: At the samples `MOMENTS`.

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> combination_runs(2, "published", "shared", "fixed", "curved", rng=rng).nees.shape
    (2, 12)
    """
    errors, measurements = rng.spawn(2)
    straight = {"tangent_at": "path", "curvature": 0.0} if world == "straight" else {}
    matched, s = matched_P0(), reported().scenario
    drawn = errors.multivariate_normal(s.x0, matched, size=runs)
    return consistency_runs(
        runs,
        rng=measurements,
        keep=MOMENTS,
        start=drawn if start == "drawn" else None,
        P0=matched if P0 == "matched" else None,
        noise=noise,
        **straight,
    )


def saved_combinations() -> dict[tuple[str, ...], dict[str, FloatArray]]:
    """Return medians of NEES and NIS of a thousand runs of each combination, as they were saved.

    Returns (12, 3): Median, and both ends of its interval of 95 %, by "nees" and "nis", by the
        combination: a value of each of the `SWITCHES`.

    Examples
    --------
    >>> published = saved_combinations()["published", "shared", "fixed", "curved"]
    >>> bool(published["nees"][6, 0] > 100)
    True
    """
    rows = read_json("combinations.json", folder=results)["rows"]
    names = product(*SWITCHES.values())
    return {
        key: {name: np.array(row[name]) for name in ("nees", "nis")}
        for key, row in zip(names, rows, strict=True)
    }
