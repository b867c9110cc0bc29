"""The whole chain on the track of Table 2: from IQ samples to a position, every stage a switch."""

import warnings
from functools import cache

import numpy as np

from ... import _checks
from ..._records import record
from ...estimation.maximum_likelihood import IMPLAUSIBLE, ImplausibleStart
from ...model.motion import constant_velocity
from ...signal.frequency import ml_frequency
from ...signal.impairments import correct_iq_imbalance, remove_mean
from ...signal.sliding import sliding_doppler
from ._hypotheses import filters, hypotheses, quarters
from .published import scenario, signal_chain
from .received_iq import Baseband
from .start import start_box

# What the signal-to-noise ratio of a whole window must be: in mere noise the highest peak reaches
# 10 or 15, and 20 in less than one window of a hundred thousand.
SEEN = 20.0


@record
class EndToEnd:
    """Tracks from IQ samples, one for each hypothesis about the start.

    Attributes
    ----------
    time : ndarray, shape (K,)
        Time in s to which each Doppler shift is taken to belong.
    known : ndarray, shape (K,)
        Time on the clock at which it can be known: the end of its window.
    shift, shift_std : ndarray, shape (runs, K, N)
        Doppler shifts in Hz and the deviations with which they were used. NaN and infinite where a
        window is too weak to be used.
    used : int
        Samples that went into the start; the filter runs on those that follow.
    x : ndarray, shape (runs, H, 1 + K - used, 6)
        States of H hypotheses, at the last sample of the start and after each update; NaN if
        there is no such hypothesis.
    P : ndarray, shape (runs, H, 1 + K - used, 6, 6)
        Their covariances.
    nis : ndarray, shape (runs, H, K - used)
        Normalized innovation squared.
    memory : ndarray, shape (runs,)
        Autocorrelation of the normalized innovations from one sample to the next, averaged over the
        modules, for the hypothesis that is the likeliest in the end; NaN if a module is missing in
        any sample.
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
    memory: np.ndarray
    score: np.ndarray
    sigma_p: float

    @property
    def final_nis(self):
        """NIS of the hypothesis that is the likeliest in the end, shape (runs, K - used)."""
        chosen = np.argmin(self.score[:, :, -1], axis=1)
        return self.nis[np.arange(len(chosen)), chosen]

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


def track_iq(
    iq,
    *,
    window=0.025,
    hop=None,
    tag="center",
    subtract_delay=True,
    start=0.3,
    remove_dc=True,
    dc_until=None,
    balance=True,
    estimator=ml_frequency,
    inflate=1.0,
    sigma_p=None,
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
    dc_until : float, optional
        Time on the clock in s until which the mean of the samples is taken for the constant; the
        whole record if None. An echo that grows has a mean too, most of it from its end.
    estimator : callable
        What finds the frequency of a window, see `sliding_doppler`.
    inflate : float
        Factor on the variances of the shifts.
    sigma_p : float, optional
        Standard deviation of the acceleration in m/s^2, for one millisecond; that of the scenario
        if None.
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
        If the samples of `iq` are not sound, there are less than two windows in `start`, `inflate`
        or `sigma_p` is not positive, `dc_until` is not within the record, or an argument is refused
        by `sliding_doppler`.

    Warns
    -----
    ImplausibleStart
        If chi-square of the likeliest start is more than a hundred times its degrees of freedom:
        I and Q are exchanged, sensors are in another order, or no target is in the box.

    Notes
    -----
    The start sees windows side by side only, even if there are more that overlap, and gives all of
    them the same weight. Hypotheses much less likely than the best are dropped there and then.

    The deviations are those of the bound at the *measured* signal-to-noise ratio of each window and
    module. The box of the start is `start_box`.

    A module that is too weak in a window, or has a sample there that is no measurement, is missing,
    and the others go on: its measured signal-to-noise ratio in the whole window has to be 20 at
    least. What is no measurement is decided on the samples before anything else, see
    `Baseband.samples`.

    The acceleration is that of one millisecond. For another hop it is scaled, so that the velocity
    wanders as far in a second.
    """
    _checks.instance("iq", iq, Baseband)
    inflate = _checks.positive_number("inflate", inflate)
    _checks.one_of("tag", tag, ("center", "end"))
    s = scenario()
    sigma_p = _checks.positive_number("sigma_p", s.sigma_p if sigma_p is None else sigma_p)
    n = round(_checks.positive_number("window", window) * iq.fs)
    step = n if hop is None else max(1, round(_checks.positive_number("hop", hop) * iq.fs))
    x, valid = iq.samples()
    x = _without_constant(x, valid, iq, dc_until) if remove_dc else x
    x = correct_iq_imbalance(x, valid) if balance else x
    top = signal_chain()["speed_limit_m_s"] * iq.array.doppler_per_speed
    d = sliding_doppler(x, iq.fs, n, step, estimator, band=(-top, top), tag=tag, valid=valid)
    time = iq.first + d.time - (iq.delay if subtract_delay else 0.0)
    known = iq.first + _ends(d)
    seen = n * d.snr >= SEEN
    z = np.where(seen, d.frequency, np.nan)
    std = np.where(seen, d.frequency_std * np.sqrt(inflate / iq.noise_gain), np.inf)
    used = int(np.sum(known <= _checks.positive_number("start", start) + 1e-9))
    if used < 2:
        raise ValueError(f"start must hold at least two windows, got {used} in {start} s")
    T = step / iq.fs
    sigma_p = sigma_p * np.sqrt(s.T)
    boxes = [_room()]
    if _checks.one_of("search", search, ("quarters", "room")) == "quarters":
        boxes = quarters(*boxes[0])
    apart = -(-n // step)
    states, costs, weights = hypotheses(z[:, :used], std[:, :used], iq.array, T, apart, boxes)
    _warn_unless_plausible(costs, weights)
    each = [
        filters(z, s, early, iq.array, T, used, apart, sigma_p / np.sqrt(T), *starts)
        for z, s, early, *starts in zip(z, std, weights, states, costs, strict=True)
    ]
    fields = (np.array(field) for field in zip(*each, strict=True))
    return EndToEnd(time, known, z, std, used, *fields, sigma_p)


def _warn_unless_plausible(costs, weights):
    cost, degrees = np.fmin.reduce(costs, axis=1), np.isfinite(weights).sum(axis=(1, 2)) - 6
    wrong = np.flatnonzero(cost > IMPLAUSIBLE * np.maximum(degrees, 1))
    if len(wrong):
        i = wrong[0]
        warnings.warn(
            f"no start explains the Doppler shifts of run {i}: chi-square {cost[i]:.0f} for "
            f"{degrees[i]} degrees of freedom. Are I and Q exchanged, or sensors in another order?",
            ImplausibleStart,
            stacklevel=3,
        )


@cache
def _room():
    """Return the box of the start, which takes longer to read than a record to track."""
    return start_box()


def _without_constant(x, valid, iq, until):
    """Return samples less their mean, or that of as many valid ones as there are `until` then."""
    if until is None:
        return remove_mean(x, valid)
    samples = round((_checks.one_number("dc_until", until) - iq.first) * iq.fs)
    if not 1 <= samples <= x.shape[-1]:
        raise ValueError(f"dc_until must be within the record, got {until}")
    early = valid & (np.cumsum(valid, axis=-1) <= samples)
    constant = np.where(early, x, 0.0).sum(axis=-1, keepdims=True)
    constant /= np.maximum(early.sum(axis=-1, keepdims=True), 1)
    return np.where(valid, x - constant, 0.0)


def _ends(doppler):
    """Return when the last sample of each window is taken, whatever the tag is."""
    return (np.arange(len(doppler.time)) * doppler.hop + doppler.window - 1) / doppler.fs
