"""What six modules record of the target of Table 2: IQ samples with the faults of cheap ones."""

import numpy as np

from ... import _checks
from ..._records import record
from ...model.radar_array import RadarArray
from ...signal.front_end import lowpass, lowpass_decimate
from ...signal.impairments import add_dc, add_iq_imbalance, branches_differ, remove_mean
from ...signal.synthesis import iq_from_geometry
from ...signal.validity import known_samples, valid_samples
from .published import scenario

# The module's faults, in amplitudes of the echo, dB and degrees. Ours: the paper states none.
FAULTS = {"dc": 0.5 + 0.3j, "gain_db": 1.0, "phase_deg": 5.0}


@record
class Baseband:
    """IQ samples of an array after the low-pass.

    Attributes
    ----------
    x : ndarray of complex, shape (..., N, n)
        Samples of N sensors, from a filter that is full.
    fs : float
        Sampling rate in Hz.
    array : RadarArray
        The N sensors.
    delay : float
        Group delay of the low-pass in s.
    first : float
        Time on the clock at which the first sample comes out, in s. It shows what happened at
        ``first - delay``.
    noise_gain : float
        Variance of white noise after the low-pass over what its density in the passband amounts
        to at the new rate. Below 1: the skirts of the filter lose a little of it.
    valid : ndarray of bool, shape (..., N, n), optional
        Which samples are measurements, as decided before the low-pass: see `valid_samples` and
        `lowpass_decimate`. If None, `x` is what the modules gave, and its samples tell it.
    """

    x: np.ndarray
    fs: float
    array: RadarArray
    delay: float = 0.0
    first: float = 0.0
    noise_gain: float = 1.0
    valid: np.ndarray | None = None

    def samples(self):
        """Return the samples, with zeros where there is no measurement, and which are one.

        Returns
        -------
        x : ndarray of complex, shape (..., N, n)
        valid : ndarray of bool, shape (..., N, n)
            False throughout for a module whose I and Q are proportional: they tell no direction.

        Raises
        ------
        ValueError
            If `x` does not consist of numbers, is not finite where `valid` is True, or has not N
            sensors; or if `valid` does not fit.
        """
        shape = (len(self.array.positions), None)
        valid = valid_samples(self.x) if self.valid is None else self.valid
        x, valid = known_samples("iq.x", self.x, valid, shape)
        known = valid & branches_differ(remove_mean(x, valid), valid)[..., None]
        return np.where(known, x, 0.0), known


def received(runs, *, rng, fs=10e3, snr_db=20.0, factor=5, faults=True, amplitude="constant"):
    """Simulate what the six modules record of the target of Table 2, up to the low-pass.

    Parameters
    ----------
    runs : int
        Number of independent records of the same track.
    rng : numpy.random.Generator
        Source of start phases and noise. Run 3 is the same in any number of runs.
    fs : float
        Sampling rate of the converter in Hz.
    snr_db : float or None
        Power of an echo over the variance of a complex sample at that rate, in dB; None for no
        noise. With ``amplitude="r^-2"`` that of an echo from the first position, at the center of
        the ring.
    factor : int
        Every how many samples one is kept after the low-pass.
    faults : bool
        Whether the modules have a constant and unequal branches, see `FAULTS`.
    amplitude : {"constant", "r^-2"}
        How an echo depends on the range: not at all, or as that of a small target does.

    Returns
    -------
    Baseband
        The modules' faults are still in it. Leading axis ``runs``.

    Raises
    ------
    ValueError
        If an argument is refused by `iq_from_geometry` or `lowpass_decimate`.

    Notes
    -----
    The low-pass has real coefficients, so it treats I and Q alike, and what the branches need may
    be done after it, on fewer samples.
    """
    runs = _checks.whole_number("runs", runs)
    _checks.generator("rng", rng)
    fs = _checks.positive_number("fs", fs)
    factor = _checks.whole_number("factor", factor)
    s = scenario()
    t = np.arange(round(s.time[-1] * fs) + 1) / fs
    path = s.x0[:3] + t[:, None] * s.x0[3:]
    impulse = np.zeros(40 * factor + 1)
    impulse[0] = 1.0
    b = lowpass(impulse, fs, fs / (2 * factor), 20 * factor + 1)[0].real if factor > 1 else impulse
    # An amplitude r^-2 is 1 at a meter; ours is 1 at the first position.
    unit = 1.0 if amplitude == "constant" else np.linalg.norm(path[0]) ** 2
    level = None if snr_db is None else snr_db + 20 * np.log10(unit)
    records = []
    for child in rng.spawn(runs):
        x = unit * iq_from_geometry(path, s.array, level, rng=child, amplitude=amplitude)
        if faults:
            x = add_iq_imbalance(add_dc(x, FAULTS["dc"]), FAULTS["gain_db"], FAULTS["phase_deg"])
        y, fs_out, delay = lowpass_decimate(x, fs, factor)
        filling = int(np.ceil(2 * delay * fs_out - 1e-9))
        records.append(y[:, filling:])
    gain = factor * float(np.sum(b**2))
    return Baseband(np.stack(records), fs_out, s.array, delay, filling / fs_out, gain)
