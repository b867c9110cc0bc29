"""The whole chain on the track of Table 2: from IQ samples to a position, every stage a switch."""

from dataclasses import dataclass

import numpy as np

from ... import _checks
from ...model.motion import constant_velocity
from ...model.radar_array import RadarArray
from ...signal.front_end import lowpass, lowpass_decimate
from ...signal.impairments import add_dc, add_iq_imbalance, correct_iq_imbalance, remove_mean
from ...signal.sliding import sliding_doppler
from ...signal.synthesis import iq_from_geometry
from ._hypotheses import filters, hypotheses, quarters
from .published import scenario, signal_chain
from .start import start_box

# The module's faults, in amplitudes of the echo, dB and degrees. Ours: the paper states none.
FAULTS = {"dc": 0.5 + 0.3j, "gain_db": 1.0, "phase_deg": 5.0}


@dataclass(frozen=True)
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
    """

    x: np.ndarray
    fs: float
    array: RadarArray
    delay: float = 0.0
    first: float = 0.0
    noise_gain: float = 1.0


@dataclass(frozen=True)
class EndToEnd:
    """Tracks from IQ samples, one for each hypothesis about the start.

    Attributes
    ----------
    time : ndarray, shape (K,)
        Time in s to which each Doppler shift is taken to belong.
    known : ndarray, shape (K,)
        Time on the clock at which it can be known: the end of its window.
    shift, shift_std : ndarray, shape (runs, K, N)
        Doppler shifts in Hz and the deviations with which they were used.
    used : int
        Samples that went into the start; the filter runs on those that follow.
    x : ndarray, shape (runs, H, 1 + K - used, 6)
        States of H hypotheses, at the last sample of the start and after each update; NaN if
        there is no such hypothesis.
    P : ndarray, shape (runs, H, 1 + K - used, 6, 6)
        Their covariances.
    nis : ndarray, shape (runs, H, K - used)
        Normalized innovation squared.
    score : ndarray, shape (runs, H, 1 + K - used)
        Minus twice the log likelihood of all samples so far, up to a constant; infinite if there is
        no such hypothesis.
    sigma_p : float
        Standard deviation of the acceleration in m/s^2 for one second, see `track_iq`.
    """

    time: np.ndarray
    known: np.ndarray
    shift: np.ndarray
    shift_std: np.ndarray
    used: int
    x: np.ndarray
    P: np.ndarray
    nis: np.ndarray
    score: np.ndarray
    sigma_p: float

    def samples_at(self, moment):
        """Return how many samples of the filter are known at a moment.

        Parameters
        ----------
        moment : float
            Time on the clock in s.

        Returns
        -------
        int

        Raises
        ------
        ValueError
            If `moment` is before the start is known.
        """
        moment = _checks.one_number("moment", moment)
        k = int(np.sum(self.known <= moment + 1e-9)) - self.used
        if k < 0:
            raise ValueError(
                f"moment must not be before {self.known[self.used - 1]:.4g} s, got {moment}"
            )
        return k

    def at(self, moment, carry=True):
        """Return what is known at a moment about the state at that moment.

        Parameters
        ----------
        moment : float
            Time on the clock in s, not before the start is known.
        carry : bool
            Whether all hypotheses are carried on: then whichever is the likeliest so far counts,
            else the one that was the likeliest at the start.

        Returns
        -------
        x : ndarray, shape (runs, 6)
            State, predicted from the last sample that is known; NaN if there was no start.
        P : ndarray, shape (runs, 6, 6)
            Its covariance.
        chosen : ndarray of int, shape (runs,)
            Which hypothesis it is.

        Raises
        ------
        ValueError
            If `moment` is before the start is known.
        """
        moment = _checks.one_number("moment", moment)
        k = self.samples_at(moment)
        chosen = np.argmin(self.score[:, :, k if carry else 0], axis=1)
        rows = np.arange(len(chosen))
        x, P = self.x[rows, chosen, k], self.P[rows, chosen, k]
        ahead = moment - self.time[self.used + k - 1]
        if ahead > 1e-9:
            F, Q = constant_velocity(ahead, self.sigma_p / np.sqrt(ahead))
            x, P = x @ F.T, F @ P @ F.T + Q
        return x, P, chosen


def received(runs, *, rng, fs=10e3, snr_db=20.0, factor=5, faults=True):
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
        noise.
    factor : int
        Every how many samples one is kept after the low-pass.
    faults : bool
        Whether the modules have a constant and unequal branches, see `FAULTS`.

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
    records = []
    for child in rng.spawn(runs):
        x = iq_from_geometry(path, s.array, snr_db, rng=child)
        if faults:
            x = add_iq_imbalance(add_dc(x, FAULTS["dc"]), FAULTS["gain_db"], FAULTS["phase_deg"])
        y, fs_out, delay = lowpass_decimate(x, fs, factor)
        filling = int(np.ceil(2 * delay * fs_out - 1e-9))
        records.append(y[:, filling:])
    gain = factor * float(np.sum(b**2))
    return Baseband(np.stack(records), fs_out, s.array, delay, filling / fs_out, gain)


def track_iq(
    iq,
    *,
    window=0.025,
    hop=None,
    tag="center",
    subtract_delay=True,
    start=0.3,
    remove_dc=True,
    balance=True,
    inflate=1.0,
    search="quarters",
):
    """Find and track a target from IQ samples.

    Parameters
    ----------
    iq : Baseband
        Samples with the leading axis ``runs``.
    window : float
        Length of the windows in s.
    hop : float, optional
        From one window to the next in s; `window` if None. Both are rounded to whole samples.
    tag : {"center", "end"}
        To which moment of its window a Doppler shift is taken to belong.
    subtract_delay : bool
        Whether the group delay of the low-pass is taken off the times.
    start : float
        Time on the clock in s until which shifts go into the maximum-likelihood start.
    remove_dc, balance : bool
        Whether a constant is removed, and whether the branches are made equal.
    inflate : float
        Factor on the variances of the shifts.
    search : {"quarters", "room"}
        Where hypotheses about the start come from. "quarters": the likeliest state in each quarter
        of the room, by the signs of y and z. "room": the likeliest and the second one that
        `ml_start` finds in the whole room.

    Returns
    -------
    EndToEnd

    Raises
    ------
    ValueError
        If there are less than two windows in `start`, `inflate` is not positive, or an argument is
        refused by `sliding_doppler`.

    Notes
    -----
    The start sees windows side by side only, even if there are more that overlap, and gives all of
    them the same weight. Hypotheses much less likely than the best are dropped there and then.

    The deviations are those of the bound at the *measured* signal-to-noise ratio of each window and
    module. The box of the start is `start_box`.

    The acceleration of the scenario is that of one millisecond. For another hop it is scaled, so
    that the velocity wanders as far in a second.
    """
    _checks.instance("iq", iq, Baseband)
    inflate = _checks.positive_number("inflate", inflate)
    _checks.one_of("tag", tag, ("center", "end"))
    s = scenario()
    n = round(_checks.positive_number("window", window) * iq.fs)
    step = n if hop is None else max(1, round(_checks.positive_number("hop", hop) * iq.fs))
    x = remove_mean(iq.x) if remove_dc else iq.x
    x = correct_iq_imbalance(x) if balance else x
    top = signal_chain()["speed_limit_m_s"] * iq.array.doppler_per_speed
    d = sliding_doppler(x, iq.fs, n, step, band=(-top, top), tag=tag)
    time = iq.first + d.time - (iq.delay if subtract_delay else 0.0)
    known = iq.first + _ends(d)
    std = d.frequency_std * np.sqrt(inflate / iq.noise_gain)
    used = int(np.sum(known <= _checks.positive_number("start", start) + 1e-9))
    if used < 2:
        raise ValueError(f"start must hold at least two windows, got {used} in {start} s")
    T = step / iq.fs
    sigma_p = s.sigma_p * np.sqrt(s.T)
    boxes = [start_box()]
    if _checks.one_of("search", search, ("quarters", "room")) == "quarters":
        boxes = quarters(*boxes[0])
    apart = -(-n // step)
    states, costs, deviation = hypotheses(d.frequency[:, :used], std[:, :used], iq, T, apart, boxes)
    early = np.broadcast_to(
        deviation[:, None, None], (len(x), len(range(used)[::apart]), x.shape[1])
    )
    each = [
        filters(z, s, weights, iq.array, T, used, apart, sigma_p / np.sqrt(T), *starts)
        for z, s, weights, *starts in zip(d.frequency, std, early, states, costs, strict=True)
    ]
    fields = (np.array(field) for field in zip(*each, strict=True))
    return EndToEnd(time, known, d.frequency, std, used, *fields, sigma_p)


def _ends(doppler):
    """Return when the last sample of each window is taken, whatever the tag is."""
    return (np.arange(len(doppler.time)) * doppler.hop + doppler.window - 1) / doppler.fs
