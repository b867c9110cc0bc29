"""The best window for each acceleration and noise, by simulation."""

from typing import Literal

import numpy as np

from ..._hints import Count, Positive, checked
from ...signal.synthesis import iq_from_velocity, velocity_profile
from .published import reported
from .velocity_filter import filter_velocity
from .window_choice import Lengths, Rising, WindowTable, cumulative_error
from .window_transform import doppler_filter


@checked
def window_table(
    accelerations: Rising | None = None,
    snrs_db: Rising | None = None,
    *,
    rng: np.random.Generator,
    runs: Count = 20,
    windows: Lengths | None = None,
    judge: Literal["measurement", "filter"] = "measurement",
    duration: Positive = 1.2,
    q: Positive | None = None,
) -> WindowTable:
    """Find the best window for every acceleration and signal-to-noise ratio by simulation.

    accelerations, snrs_db (A,) and (B,): Rising, at least two of each, in m/s^2 and dB; those of
        `chosen` if None.
    rng: Source of randomness.
    runs: Records of one sensor in each cell.
    windows (W,): Lengths to try; those of `chosen` if None.
    judge: Whose velocities the error is computed of: those of the Doppler filter, or those of the
        Kalman filter behind it. The document does not say.
    duration: How long the target decelerates in s, after a while without.
    q: See `filter_velocity`, of which the second judge needs it.
    Raises ValueError if an argument is not of the kind described, a record is longer than the
        document's, or the target would turn back.

    Notes
    -----
    Sec 3.2 of the document: the window with the least cumulative error is the best.

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> table = window_table([5.0, 40.0], [0.0, 20.0], rng=rng, runs=1, windows=[12, 64])
    >>> table.best.tolist()
    [[64, 64], [64, 12]]
    """
    own, said = reported().chosen, reported().stated
    accelerations = own.table_accelerations if accelerations is None else accelerations
    snrs_db = own.table_snrs_db if snrs_db is None else snrs_db
    windows = own.windows if windows is None else windows
    if duration > said.duration or duration * np.abs(accelerations).max() >= said.v_before:
        raise ValueError(
            f"duration must be at most {said.duration} s and leave a velocity, got {duration}"
        )
    begin = own.scored * said.T
    t = said.T * np.arange(own.scored + round(duration / said.T))
    cee = np.empty((len(accelerations), len(snrs_db), len(windows)))
    for i, a in enumerate(accelerations):
        v, _ = velocity_profile(t, said.v_before, [(begin, begin + duration, -a)])
        for j, snr_db in enumerate(snrs_db):
            x = iq_from_velocity(v, said.T, own.wavelength, snr_db, rng=rng, size=runs)
            doppler = doppler_filter(x[:, None], windows)
            for w, window in enumerate(windows):
                found = doppler.v[w, :, 0]
                if judge == "filter":
                    track = filter_velocity(doppler, snr_db, window=int(window), q=q)
                    found = track.x[:, 0, :, 0]
                error = cumulative_error(v[own.scored :], found[:, own.scored - own.first :])
                cee[i, j, w] = error[:, -1].mean()
    return WindowTable(accelerations, snrs_db, windows, cee)
