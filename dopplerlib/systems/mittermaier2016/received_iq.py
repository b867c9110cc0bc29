"""What six modules record of the target of Table 2: IQ samples with the faults of cheap ones."""

from dataclasses import replace

import numpy as np

from ... import _checks
from ...chain.baseband import Baseband
from ...signal.impairments import add_dc, add_iq_imbalance
from ...signal.synthesis import iq_from_geometry
from .published import scenario

# The module's faults, in amplitudes of the echo, dB and degrees. Ours: the paper states none.
FAULTS = {"dc": 0.5 + 0.3j, "gain_db": 1.0, "phase_deg": 5.0}


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
    # An amplitude r^-2 is 1 at a meter; ours is 1 at the first position.
    unit = 1.0 if amplitude == "constant" else np.linalg.norm(path[0]) ** 2
    level = None if snr_db is None else snr_db + 20 * np.log10(unit)
    records = []
    for child in rng.spawn(runs):
        x = unit * iq_from_geometry(path, s.array, level, rng=child, amplitude=amplitude)
        if faults:
            x = add_iq_imbalance(add_dc(x, FAULTS["dc"]), FAULTS["gain_db"], FAULTS["phase_deg"])
        records.append(Baseband.from_samples(x, fs, s.array, factor=factor))
    return replace(records[0], x=np.stack([one.x for one in records]))
