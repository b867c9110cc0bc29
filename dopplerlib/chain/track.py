"""From IQ samples to tracks: Doppler shifts, initial hypotheses, one filter for each."""

import warnings
from collections.abc import Callable
from typing import Annotated, Any, Literal

import numpy as np

from .. import _checks
from .._hints import Positive, Real, checked
from .._records import record
from .._typing import ArrayLike, BoolArray, FloatArray, IntArray
from ..estimation.initial_estimate import LARGEST_SCALE, ImplausibleStart
from ..estimation.track import Track
from ..model.motion import constant_velocity
from ..signal.frequency import ml_frequency
from ..signal.impairments import correct_iq_imbalance, remove_mean
from ..signal.laws import overlap_correlation_discrete
from ..signal.lines import near_lines, remove_lines
from ..signal.real_tone import ml_frequency_real, ml_frequency_real_dc
from ..signal.sliding import sliding_doppler
from ..signal.straight_signs import straight_signs
from ._box import bounds
from ._hypotheses import filters, hypotheses, parts, without_wrong
from .baseband import Baseband


@record
class IqTrack:
    """Tracks from IQ samples, one for each hypothesis about the initial state.

    Leading axes are those of the samples.

    Attributes
    ----------
    time : ndarray, shape (K,)
        Time in s to which each Doppler shift is taken to belong.
    available_at : ndarray, shape (K,)
        Time on the clock at which it can be known: the end of its window.
    shift, shift_std : ndarray, shape (..., K, N)
        Doppler shifts in Hz and the deviations with which they were used. NaN and infinite where a
        window is too weak to be used.
    used : int
        Samples that went into the start; the filter runs on those that follow.
    x : ndarray, shape (..., H, 1 + K - used, 6)
        States of H hypotheses, at the last sample of the start and after each update; NaN if
        there is no such hypothesis.
    P : ndarray, shape (..., H, 1 + K - used, 6, 6)
        Their covariances.
    innovation : ndarray, shape (..., H, K - used, N)
        Shift less predicted shift in Hz; NaN where the shift is missing.
    S : ndarray, shape (..., H, K - used, N, N)
        Innovation covariances.
    nis : ndarray, shape (..., H, K - used)
        Normalized innovation squared.
    lag1_autocorrelation : ndarray, shape (...)
        Autocorrelation of the normalized innovations from one sample to the next, averaged over the
        sensors, for the hypothesis that is the likeliest in the end; NaN if a sensor is missing in
        any sample.
    score : ndarray, shape (..., H, 1 + K - used)
        Minus twice the log likelihood of all samples so far, up to a constant; infinite if there is
        no such hypothesis. The first one is the chi-square of the start.
    degrees : ndarray, shape (...)
        Degrees of freedom of this chi-square: shifts that are there less unknowns.
    velocity_random_walk : float
        Standard deviation in m/s of the random walk of each velocity in a second, see `track_iq`.
    noise : {"shared", "per_axis", "horizontal"}
        Which velocities wander, see `track_iq`.

    Raises
    ------
    ValueError
        If a field is not of the kind described.

    Examples
    --------
    A track of one sample after a start of one, and where it is a tenth of a second later:

    >>> x, P = [[[1, 2, 3, 1, 0, 0]] * 2], [[np.eye(6)] * 2]
    >>> z, score, nu, S = [[5.0], [6.0]], [[0.0, 1.0]], [[[1.0]]], [[[[2.0]]]]
    >>> one = IqTrack([0.1, 0.2], [0.1, 0.2], z, z, 1, x, P, nu, S, [[0.5]], 0.0, score, 0, 0.1)
    >>> bool(one.plausible), one.final_nis.tolist(), one.samples_at(0.15)
    (True, [0.5], 0)
    >>> one.at(0.3)[0].round(3).tolist()
    [1.1, 2.0, 3.0, 1.0, 0.0, 0.0]
    """

    time: np.ndarray
    available_at: np.ndarray
    shift: np.ndarray
    shift_std: np.ndarray
    used: int
    x: np.ndarray
    P: np.ndarray
    innovation: np.ndarray
    S: np.ndarray
    nis: np.ndarray
    lag1_autocorrelation: np.ndarray
    score: np.ndarray
    degrees: np.ndarray
    velocity_random_walk: float
    noise: str = "shared"

    def __post_init__(self):
        """Check the fields."""
        shift = _checks.measured("shift", self.shift, (None, None))
        leading, (K, N) = shift.shape[:-2], shift.shape[-2:]
        used = _checks.count("used", self.used, K)
        x = _checks.measured("x", self.x, (None, 1 + K - used, 6))
        each = *leading, x.shape[len(leading)], 1 + K - used
        shapes = {
            "time": (K,), "available_at": (K,), "shift": shift.shape, "shift_std": shift.shape,
            "x": (*each, 6), "P": (*each, 6, 6), "innovation": (*each[:-1], K - used, N),
            "S": (*each[:-1], K - used, N, N), "nis": (*each[:-1], K - used),
            "lag1_autocorrelation": leading, "score": each, "degrees": leading,
        }  # fmt: skip
        fields = {"used": used}
        for name, shape in shapes.items():
            values = _checks.exact_shape(name, _checks.real(name, getattr(self, name)), shape)
            if name in ("time", "available_at", "degrees"):
                _checks.moderate(name, values)
            elif name not in ("shift_std", "score"):
                _checks.measured(name, values, ())
            fields[name] = values
        walk = _checks.moderate_number("velocity_random_walk", self.velocity_random_walk)
        _checks.one_of("noise", self.noise, ("shared", "per_axis", "horizontal"))
        return {**fields, "velocity_random_walk": walk}

    @property
    @_checks.quiet
    def plausible(self) -> BoolArray:
        """Whether chi-square of the initial estimate is at most 100 times its degrees of freedom.

        Shape (...). The deviations are those of the bound for a steady tone, so real ones may be
        larger, up to ten times as in `InitialEstimate.plausible`. If not, no straight flight in
        the box explains the shifts, or there was no start; for the usual reasons see there.
        """
        return self.score[..., 0].min(axis=-1) <= LARGEST_SCALE**2 * np.maximum(self.degrees, 1)

    @property
    def final_nis(self) -> FloatArray:
        """NIS of the hypothesis with the highest final likelihood, shape (..., K - used).

        NaN if there is none.
        """
        return self.final_track.nis

    @property
    def final_track(self) -> Track:
        """Track of the hypothesis with the highest final likelihood, (..., K - used) samples.

        It begins with the first sample after the start. NaN if there is none.
        """
        best = np.argmin(self.score[..., -1], axis=-1)
        fields = self.x[..., 1:, :], self.P[..., 1:, :, :], self.innovation, self.S, self.nis
        x, P, innovation, S, nis = (_of_each(field, best) for field in fields)
        return Track(x, P, innovation, S, nis, np.isfinite(innovation).any(axis=-1))

    @property
    @_checks.quiet
    def live(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """States as they were known sample by sample, of the hypothesis that led by then.

        Times on the clock (1 + K - used,) from which they are known, and states (..., 1 + K - used,
        6) and covariances predicted to these times. NaN if there was no start.
        """
        known = self.available_at[self.used - 1 :]
        best = np.argmin(self.score, axis=-2)[..., None, :, None]
        x = np.take_along_axis(self.x, best, axis=-3).squeeze(axis=-3)
        P = np.take_along_axis(self.P, best[..., None], axis=-4).squeeze(axis=-4)
        ahead = known[0] - self.time[self.used - 1]
        return known, *self._ahead(x, P, ahead)

    @checked
    def samples_at(self, time: Real) -> int:
        """Return the number of filtered samples that are available at a time.

        Parameters
        ----------
        time : float
            Time on the clock in s.

        Returns
        -------
        int

        Raises
        ------
        ValueError
            If `time` is before the start is known.
        """
        k = int(np.sum(self.available_at <= time + 1e-9)) - self.used
        if k < 0:
            raise ValueError(
                f"time must not be before {self.available_at[self.used - 1]:.4g} s, got {time}"
            )
        return k

    @checked
    @_checks.quiet
    def at(self, time: Real, carry: bool = True) -> tuple[FloatArray, FloatArray, IntArray]:
        """Return state and covariance at a time, from the samples available by then.

        Parameters
        ----------
        time : float
            Time on the clock in s, not before the start is known.
        carry : bool
            Whether all hypotheses are carried on: then whichever is the likeliest so far counts,
            else the one that was the likeliest at the start.

        Returns
        -------
        x : ndarray, shape (..., 6)
            State, predicted from the last sample that is known; NaN if there was no start.
        P : ndarray, shape (..., 6, 6)
            Its covariance.
        chosen : ndarray of int, shape (...)
            Which hypothesis it is.

        Raises
        ------
        ValueError
            If `time` is before the start is known.
        """
        k = self.samples_at(time)
        chosen = np.argmin(self.score[..., k if carry else 0], axis=-1)
        x, P = _of_each(self.x[..., k, :], chosen), _of_each(self.P[..., k, :, :], chosen)
        ahead = time - self.time[self.used + k - 1]
        return *self._ahead(x, P, ahead), chosen

    def _ahead(self, x, P, seconds):
        """Return states and covariances predicted by some seconds, if it is any time at all."""
        if seconds <= 1e-9:
            return x, P
        sigma_a = self.velocity_random_walk / np.sqrt(seconds)
        F, Q = constant_velocity(seconds, sigma_a, self.noise)
        return x @ F.T, F @ P @ F.T + Q


@checked
def track_iq(
    iq: Baseband,
    box: Annotated[tuple[ArrayLike, ArrayLike], bounds],
    *,
    speed_limit: Positive,
    velocity_random_walk: Positive,
    window: float,
    start: float,
    hop: float | None = None,
    remove_dc: bool = True,
    dc_until: float | None = None,
    balance: bool = True,
    lines: ArrayLike = (),
    line_width: Positive = 4.0,
    estimator: Callable[..., Any] = ml_frequency,
    signs: str | ArrayLike | None = None,
    variance_inflation: Positive = 1.0,
    least_snr: Positive = 20.0,
    search: Literal["parts", "whole"] = "parts",
    start_windows: Literal["side by side", "all"] = "side by side",
    start_loss: Literal["least_squares", "bisquare"] = "least_squares",
    rng: np.random.Generator | None = None,
    noise: Literal["shared", "per_axis", "horizontal"] = "shared",
) -> IqTrack:
    """Detect and track a target in the IQ samples of an array.

    Parameters
    ----------
    iq : Baseband
        Samples of N sensors; leading axes are runs.
    box : pair of array_like, shape (3,) or (6,)
        Lower and upper bounds of the position in m at the first window, or of the state in m and
        m/s; if of the position, each velocity lies within `speed_limit`. Equal bounds fix a
        component at the start, and with a coordinate its velocity at 0.
    speed_limit : float
        Largest speed in m/s. Doppler shifts are searched for up to that of it.
    velocity_random_walk : float
        Standard deviation in m/s by which each velocity wanders in a second, and by sqrt(t) times
        as much in t seconds, whatever the hop. With a deviation of the acceleration as
        `constant_velocity` takes it for an interval T, it is that times sqrt(T).
    window : float
        Length of the windows in s. In it the target should fly straight, and turn little about any
        sensor: its Doppler shift should change by less than ``1 / window``.
    start : float
        Time on the clock in s until which shifts go into the maximum-likelihood start.
    hop : float, optional
        From one window to the next in s; `window` if None. Both are rounded to whole samples.
    remove_dc : bool
        Whether a constant is removed.
    dc_until : float, optional
        Time on the clock in s until which the mean of the samples is taken for the constant; the
        whole record if None. An echo that grows or stands still has a mean too: best is a time
        before there is any.
    balance : bool
        Whether the branches are made equal, see `correct_iq_imbalance`.
    lines : array_like, shape (L,)
        Frequencies of lines in Hz that are removed before: the hum of mains and its harmonics, 0
        for a constant that drifts; see `remove_lines`. They are found in the whole record, so that
        `available_at` is not that of a system that runs.
    line_width : float
        Shifts nearer than that to a line are missing, in Hz.
    estimator : callable
        Frequency estimator of a window, see `sliding_doppler`. For modules without Q it has to be
        `ml_frequency_real` or `ml_frequency_real_dc`.
    signs : {"straight"} or array_like of int, broadcast to (K, N), optional
        Signs of Doppler shifts that such modules do not tell: 1 where the target approaches, -1
        where it recedes, 0 for a shift that is to be missing; or "straight", which takes them from
        the whole record, as with `lines`, by the law of straight flight, see `straight_signs`.
    variance_inflation : float
        Factor on the variances of the shifts.
    least_snr : float
        Least measured signal-to-noise ratio of a whole window for its shift to be used.
    search : {"parts", "whole"}
        Where hypotheses about the start come from. "parts": the likeliest state in each part of
        the box between the planes through the middle of the array. "whole": the likeliest and the
        second one that `ml_initialize` finds in the whole box; so it is also if there is one part
        only.
    start_windows : {"side by side", "all"}
        Windows of the start where they overlap. "side by side": as many as share no samples.
        "all": all, with the correlation of their errors by `overlap_correlation_discrete`. With a
        hop of a quarter of a window the errors of the start are a quarter, of a target that flies
        straight meanwhile; a target that does not, or an extended one, is off by more than is
        claimed.
    start_loss : {"least_squares", "bisquare"}
        "bisquare": windows of the start in which something else was measured, up to nearly half of
        them, are found by a robust start and left out; see `ml_initialize`. It takes a second or so
        a run.
    rng : numpy.random.Generator, optional
        Source of the subsets of that; needed for it.
    noise : {"shared", "per_axis", "horizontal"}
        Whether the velocities wander together, as in the paper's Eq 17, each by itself, as those of
        a target do that may turn, or those along x and y only, as those of a target do whose height
        stays: see `constant_velocity`.

    Returns
    -------
    IqTrack

    Raises
    ------
    ValueError
        If the samples of `iq` are not sound, `start` is beyond them, has less than two windows or
        too few for the unknowns, `speed_limit` is beyond half the sampling rate, a number is not
        positive, `dc_until` is not within the record, or an argument is refused by
        `sliding_doppler`.

    Warns
    -----
    ImplausibleStart
        If chi-square of the likeliest start is more than a hundred times its degrees of freedom:
        I and Q are exchanged, sensors are in another order, or no target is in the box.

    Notes
    -----
    The start gives all of its windows the same weight. Hypotheses much less likely than the best
    are dropped there and then. There is a plane at right angles to each axis along which the
    sensors lie apart: a ring, which confuses states left and right, and above and below, has two
    of them.

    The deviations are those of the bound at the *measured* signal-to-noise ratio of each window and
    sensor.

    A sensor that is too weak in a window, or has a sample there that is no measurement, is missing,
    and the others go on. What is no measurement is decided on the samples before anything else, see
    `Baseband.samples`. In mere noise, a window of n samples reaches `least_snr` with a probability
    of about ``(1 + B T sqrt(pi s / 3)) (1 + s / (n - 2.5))^(1 - n)``, where s is 1.5 more, B the
    searched band of ``4 speed_limit / wavelength`` and T the length of the window: Rice's formula
    for the crossings of a level, and the law of a share of the energy. With 20 it is less than one
    in a hundred thousand, unless windows are shorter than 25 samples or so.

    Examples
    --------
    Five sensors on the walls of a room, and a target that crosses it at a known height:

    >>> from dopplerlib import RadarArray, iq_from_geometry
    >>> places = [[0, 0, 2], [6, 0, 2.2], [6, 5, 2], [0, 5, 2.2], [3, 0, 1.8]]
    >>> array = RadarArray(places, wavelength=0.0285)
    >>> path = [1.5, 2.5, 1] + np.arange(2000)[:, None] / 1e3 * [1, 0.3, 0]
    >>> iq = Baseband(iq_from_geometry(path, array, 20, rng=np.random.default_rng(1)), 1e3, array)
    >>> box = [0, 0, 1], [6, 5, 1]
    >>> found = track_iq(iq, box, speed_limit=2, velocity_random_walk=0.1, window=0.05, start=0.5)
    >>> bool(found.plausible), found.at(1.999)[0].round(1).tolist()
    (True, [3.5, 3.1, 1.0, 1.0, 0.3, 0.0])
    """
    top = speed_limit * iq.array.doppler_per_speed
    if top > iq.fs / 2:
        raise ValueError(
            f"speed_limit must be at most {iq.fs / 2 / iq.array.doppler_per_speed:g} m/s, of which "
            f"half the sampling rate is the Doppler shift, got {speed_limit}"
        )
    lower, upper = map(np.asarray, box)  # arrays they are: a type checker does not know
    if len(lower) == 3:
        v = np.where(lower < upper, speed_limit, 0.0)
        lower, upper = np.concatenate([lower, -v]), np.concatenate([upper, v])
    x, valid = iq.samples()
    n = _length("window", window, iq)
    step = n if hop is None else max(1, _length("hop", hop, iq))
    if remove_dc:
        x = _without_constant(x, valid, iq, dc_until)
    lines = _checks.finite("lines", lines)
    if lines.size:
        x = remove_lines(x, iq.fs, lines, n, width=line_width, band=(-top, top), valid=valid)
    if balance:
        x = correct_iq_imbalance(x, valid)
    leading = x.shape[:-2]
    x, valid = (v.reshape(-1, *v.shape[-2:]) for v in (x, valid))
    real = _without_q(iq, estimator, signs)
    band = (0.0 if real else -top, top)
    d = sliding_doppler(x, iq.fs, n, step, estimator, band=band, valid=valid)
    time = iq.first + d.time - iq.delay
    available_at = iq.first + (np.arange(len(d.time)) * step + n - 1) / iq.fs
    seen = (n * d.snr >= least_snr) & ~near_lines(d.frequency, lines, line_width)
    z = np.where(seen, d.frequency, np.nan)
    if real:
        z = _signed(z, d.frequency_std, signs)
        seen = ~np.isnan(z)
    std = np.where(seen, d.frequency_std * np.sqrt(variance_inflation / iq.noise_gain), np.inf)
    end = iq.first + x.shape[-1] / iq.fs
    if _checks.positive_number("start", start) > end + 1e-9:
        raise ValueError(f"start must be at most {end:g} s, the end of the record, got {start:g}")
    used = int(np.sum(available_at <= start + 1e-9))
    if used < 2:
        raise ValueError(f"start must hold at least two windows, got {used} in {start} s")
    T = step / iq.fs
    apart, correlation = -(-n // step), None
    if start_windows == "all":
        apart, correlation = 1, overlap_correlation_discrete(n, np.arange(0, n, step))
    free = lower < upper
    if -(-used // apart) * len(iq.array) < free.sum():
        raise ValueError(
            f"start must hold windows side by side for {free.sum()} unknowns, got {start} s"
        )
    whole = search == "whole"
    boxes = [(lower, upper)] if whole else parts((lower, upper), iq.array)
    first, first_std = z[:, :used], std[:, :used]
    if start_loss == "bisquare":
        draws = _checks.generator("rng", rng)
        first, first_std = without_wrong(first, first_std, iq.array, T, (lower, upper), draws)
    states, costs, weights = hypotheses(first, first_std, iq.array, T, apart, boxes, correlation)
    degrees = np.isfinite(weights).sum(axis=(1, 2)) - free.sum()
    _warn_unless_plausible(costs, degrees)
    fixed = iq.array, T, used, apart, velocity_random_walk / np.sqrt(T), free
    try:
        each = [
            filters(z, s, early, *fixed, *starts, noise=noise, correlation=correlation)
            for z, s, early, *starts in zip(z, std, weights, states, costs, strict=True)
        ]
    except np.linalg.LinAlgError:
        raise ValueError(
            "velocity_random_walk must leave something of the noise of shifts to be seen, "
            f"got {velocity_random_walk:g}"
        ) from None
    fields = z, std, *map(np.array, zip(*each, strict=True)), degrees
    z, std, *rest = (field.reshape((*leading, *field.shape[1:])) for field in fields)
    return IqTrack(
        time,
        available_at,
        z,
        std,
        used,
        *rest,
        velocity_random_walk=velocity_random_walk,
        noise=noise,
    )


def _of_each(values, chosen):
    """Return those of one hypothesis for each run; the axis of hypotheses follows the runs'."""
    place = np.expand_dims(chosen, tuple(range(chosen.ndim, values.ndim)))
    return np.take_along_axis(values, place, axis=chosen.ndim).squeeze(axis=chosen.ndim)


def _warn_unless_plausible(costs, degrees):
    cost = np.fmin.reduce(costs, axis=1)
    wrong = np.flatnonzero(cost > LARGEST_SCALE**2 * np.maximum(degrees, 1))
    if len(wrong):
        i = wrong[0]
        warnings.warn(
            f"no start explains the Doppler shifts of run {i}: chi-square {cost[i]:.0f} for "
            f"{degrees[i]} degrees of freedom. Are I and Q exchanged, or sensors in another order?",
            ImplausibleStart,
            stacklevel=4,
        )


def _without_q(iq, estimator, signs):
    """Return whether an estimator is for modules without Q, and raise unless signs suit it."""
    real = estimator in (ml_frequency_real, ml_frequency_real_dc)
    if iq.without_q and not real:
        raise ValueError(
            "estimator must be ml_frequency_real or ml_frequency_real_dc for modules without Q, "
            f"got {getattr(estimator, '__name__', estimator)}"
        )
    if real and signs is None:
        raise ValueError(
            "signs must be given with an estimator for modules without Q, which do not tell them: "
            "'straight', or 1 and -1 for each sensor, got None"
        )
    if not real and signs is not None:
        raise ValueError(f"signs must be None, since this estimator finds them, got {signs!r:.80}")
    return real


def _signed(z, std, signs):
    """Return absolute values of shifts (R, K, N) with their signs; NaN where there is none."""
    if isinstance(signs, str):
        _checks.one_of("signs", signs, ("straight",))
        signs = straight_signs(z, np.where(np.isfinite(std), std, 1.0))
    else:
        signs = _checks.finite("signs", signs)
        if not np.isin(signs, (-1, 0, 1)).all():
            raise ValueError(f"signs must be 1, -1 or 0, got {signs.tolist()!r:.80}")
        signs = _checks.each_run("signs", signs, z.shape, ())
    return np.where(signs == 0, np.nan, signs * z)


def _length(name, seconds, iq):
    """Return a time in samples."""
    seconds, most = _checks.moderate_number(name, seconds), iq.x.shape[-1] / iq.fs
    if not seconds <= most:
        raise ValueError(f"{name} must be at most the {most:g} s of the record, got {seconds:g}")
    return round(seconds * iq.fs)


def _without_constant(x, valid, iq, until):
    """Return samples less their mean, or that of as many valid ones as there are `until` then."""
    if until is None:
        return remove_mean(x, valid)
    samples = round((_checks.one_number("dc_until", until, _checks.moderate) - iq.first) * iq.fs)
    if not 1 <= samples <= x.shape[-1]:
        raise ValueError(f"dc_until must be within the record, got {until}")
    early = valid & (np.cumsum(valid, axis=-1) <= samples)
    constant = np.where(early, x, 0.0).sum(axis=-1, keepdims=True)
    constant /= np.maximum(early.sum(axis=-1, keepdims=True), 1)
    return np.where(valid, x - constant, 0.0)
