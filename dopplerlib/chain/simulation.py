"""IQ samples of a scenario as modules of an array record them, with the faults of cheap ones."""

from dataclasses import replace
from typing import Annotated, Literal

import numpy as np

from .._hints import AboveZero, Count, Runs, between, checked, exactly
from .._typing import FloatArray
from ..model.radar_array import RadarArray
from ..model.scenario import Scenario
from ..signal.impairments import add_dc, add_iq_imbalance
from ..signal.recording import Recording
from ..signal.synthesis import iq_from_geometry
from .baseband import Baseband

# A module's faults, in amplitudes of the echo, dB and degrees.
MODULE_FAULTS = {"dc": 0.5 + 0.3j, "gain_db": 1.0, "phase_deg": 5.0}
_MOST = 2e7  # samples of all runs


@checked
def simulate_baseband(
    scenario: Scenario,
    runs: Runs,
    *,
    rng: np.random.Generator,
    fs: Annotated[float, between(1, 1e9)] = 10e3,
    snr_db: Annotated[float, between(-200, 200)] | None = 20.0,
    factor: Count = 5,
    faults: bool = True,
    amplitude: Literal["constant", "r^-2"] = "constant",
) -> Baseband:
    """Simulate the IQ samples of the modules of an array, up to the low-pass filter.

    Parameters
    ----------
    scenario : Scenario
        The sensors, and the target's path and its duration.
    runs : int
        Number of independent records of the same path.
    rng : numpy.random.Generator
        Source of start phases and noise. Run 3 is the same in any number of runs.
    fs : float
        Sampling rate of the converter in Hz.
    snr_db : float or None
        Power of an echo over the variance of a complex sample at that rate, in dB; None for no
        noise. With ``amplitude="r^-2"`` that of an echo from the first position, at the origin.
    factor : int
        Every how many samples one is kept after the low-pass.
    faults : bool
        Whether the modules have a constant and unequal branches, see `MODULE_FAULTS`.
    amplitude : {"constant", "r^-2"}
        How an echo depends on the range: not at all, or as that of a small target does.

    Returns
    -------
    Baseband
        The modules' faults are still in it. Leading axis ``runs``.

    Raises
    ------
    ValueError
        If an argument is refused by `iq_from_geometry` or `lowpass_decimate`, or there would be
        too many samples for any memory.

    Notes
    -----
    The low-pass has real coefficients, so it treats I and Q alike, and what the branches need may
    be done after it, on fewer samples.

    Examples
    --------
    >>> from dopplerlib import RadarArray, Scenario
    >>> ring, x0 = RadarArray.ring(6, 0.2), [0.8, 0, 0, -0.7, 0, 0]
    >>> scenario = Scenario(ring, x0, 0.001, 51, 0.4, 0.4, np.eye(6))
    >>> simulate_baseband(scenario, 1, rng=np.random.default_rng(1)).x.shape
    (1, 6, 81)
    """
    s = scenario
    duration = (s.samples - 1) * s.T
    if runs * len(s.array) * duration * fs > _MOST:
        raise ValueError(f"fs must give at most {_MOST:g} samples in all, got {fs}")
    t = np.arange(round(s.time[-1] * fs) + 1) / fs
    path = s.x0[:3] + t[:, None] * s.x0[3:]
    # An amplitude r^-2 is 1 at a meter; ours is 1 at the first position.
    unit = 1.0 if amplitude == "constant" else np.linalg.norm(path[0]) ** 2
    level = None if snr_db is None else snr_db + 20 * np.log10(unit)
    records = []
    for child in rng.spawn(runs):
        x = unit * iq_from_geometry(path, s.array, level, rng=child, amplitude=amplitude)
        if faults:
            x = add_dc(x, MODULE_FAULTS["dc"])
            x = add_iq_imbalance(x, MODULE_FAULTS["gain_db"], MODULE_FAULTS["phase_deg"])
        records.append(Baseband.from_samples(x, fs, s.array, factor=factor))
    return replace(records[0], x=np.stack([one.x for one in records]))


@checked
def simulate_recording(
    path: Annotated[FloatArray, exactly(None, 3)],
    array: RadarArray,
    fs: AboveZero,
    *,
    rng: np.random.Generator,
    snr_db: Annotated[float, between(-200, 200)] = 24.0,
    scale: AboveZero = 0.3,
) -> Recording:
    """Simulate a recording that cheap modules make of a target on a path.

    Parameters
    ----------
    path : array_like, shape (n, 3)
        Position of the target in m at each sample.
    array : RadarArray
        The N sensors.
    fs : float
        Sampling rate in Hz.
    rng : numpy.random.Generator
        Source of start phases and noise.
    snr_db : float
        Power of an echo over the variance of a complex sample, in dB.
    scale : float
        Amplitude of an echo in the recording, in which 1 is full scale.

    Returns
    -------
    Recording
        With the constant and the unequal branches of `MODULE_FAULTS`.

    Examples
    --------
    >>> from dopplerlib import RadarArray
    >>> path = [2, 1, 0] + np.arange(100)[:, None] / 1e3 * [-1, 0, 0]
    >>> recording = simulate_recording(
    ...     path, RadarArray([[0, 0, 0], [0, 1, 0]]), 1e3, rng=np.random.default_rng(1)
    ... )
    >>> recording.x.shape, round(recording.carrier / 1e9, 2)
    ((2, 100), 23.98)
    """
    from scipy.constants import speed_of_light

    x = iq_from_geometry(path, array, snr_db, rng=rng)
    x = add_iq_imbalance(
        add_dc(x, MODULE_FAULTS["dc"]), MODULE_FAULTS["gain_db"], MODULE_FAULTS["phase_deg"]
    )
    return Recording(scale * x, fs, speed_of_light / array.wavelength)
