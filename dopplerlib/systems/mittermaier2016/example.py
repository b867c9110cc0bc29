"""The simulation example of Section 4, in any number of runs (Fig 6)."""

from collections.abc import Iterable
from typing import Annotated, Literal

import numpy as np

from ..._hints import Covariance, Reals, Runs, States, checked, exactly
from ..._records import record
from ..._typing import FloatArray
from ...estimation.extended_kalman import ekf
from ...model.motion import constant_velocity
from ...model.simulation import simulate
from .._tracks import Tracks
from .published import reported


@checked
@record
class ExampleRuns:
    """Our runs of the simulation example.

    time (K,): Time of each sample in s.
    truth (K, 6): True states.
    track: Estimates, leading axis ``runs``.
    error (runs, K, 3): Absolute position errors in m.
    """

    time: Annotated[FloatArray, exactly(None)]
    truth: Annotated[FloatArray, exactly(None, 6)]
    track: Tracks
    error: Annotated[FloatArray, exactly(None, None, 3)]


@checked
def run_example(
    runs: Runs,
    *,
    rng: np.random.Generator,
    gate: Literal["upper", "two-sided"] | None = None,
    start: States | None = None,
    P0: Covariance | None = None,
    sigma_f: Reals | None = None,
    keep: Iterable[str] = ("P",),
) -> ExampleRuns:
    """Run the simulation example of Fig 6.

    runs: Number of independent measurement records.
    rng: Source of the measurement noise, see `simulate`.
    gate: See `ekf`.
    start (6,) or (runs, 6): Estimate of the state at the first sample; the one that Table 2 prints
        if None.
    P0 (6, 6): Its covariance; that of the scenario, 0.1 I, if None.
    sigma_f (K, N): Standard deviation that the filter assumes, in Hz, broadcast; that of the
        scenario if None.
    keep: Fields of the track that are wanted, see `ekf`.
    Raises ValueError if an argument is refused by `simulate` or `ekf`.

    Notes
    -----
    `ekf` predicts before it updates. So that the prediction for the first sample is `start`, it
    is moved back by one sampling interval (0.75 mm).

    Examples
    --------
    >>> run_example(1, rng=np.random.default_rng(1)).error.shape
    (1, 1001, 3)
    """
    s = reported().scenario
    start = reported().table2.x_ml if start is None else start
    F, _ = constant_velocity(s.T, s.sigma_a)
    before = np.linalg.solve(F, start[..., None])[..., 0]
    truth, z = simulate(s, runs, rng=rng)
    track = ekf(
        z,
        s.array,
        before,
        s.P0 if P0 is None else P0,
        s.T,
        s.sigma_a,
        s.sigma_f if sigma_f is None else sigma_f,
        gate=gate,
        keep=keep,
    )
    return ExampleRuns(s.time, truth, track, np.abs(track.x - truth)[..., :3])
