"""Symptoms of a mistake in a recording or its setup, and the cause that they speak for."""

import warnings
from typing import Annotated

import numpy as np

from .. import _checks
from .._hints import Number, checked, exactly
from .._records import record
from .._typing import FloatArray
from ..chain.alternatives import explain
from ..chain.setup import Setup
from ..estimation.initial_estimate import ImplausibleStart
from ..signal.recording import Recording
from .checklist import Check
from .track_checks import LIMIT, SensorChecks, sensor_checks, track_checks

MAINS = (50.0, 60.0)  # Hz, of which there are harmonics
_HARMONICS = 3
_AROUND = 20  # bins on each side of a line that tell the noise there
_SLOW, _NEAR = 2.0, 10.0  # Hz: where no echo of a moving target stays, and where noise is alike
_DRIFT = 10.0  # 10 dB: a constant that drifts falls by 12 dB an octave, flicker noise by three
_PRESENT = 0.1  # fraction of the windows: with less in every sensor there is no target to track


@checked
@record
class Symptoms:
    """Symptoms of one recording.

    Attributes
    ----------
    present : ndarray, shape (N,)
        Fraction of the windows of each sensor with a measurement.
    line : float
        Frequency in Hz of a harmonic of the mains that stands in the spectrum; NaN for none.
    drift : float
        Power density within 2 Hz of 0 Hz, without the mean, over that from 2 to 10 Hz on the
        stronger side; of the median sensor.
    chirp : float
        Change of the Doppler shift within a window times its length, in the median window of the
        sensor in which it is largest; it should be below 1. NaN without a track, as the next three.
    start : float
        Chi-square of the start over its degrees of freedom, expected 1.
    nis : float
        Sum of NIS over the number of measurements, expected 1. Far below it the stated standard
        deviations are larger than needed, which is no mistake.
    lag1 : float
        Autocorrelation of the normalized innovations at a lag of one sample, expected 0.
    overlap : float
        Fraction of a window that it shares with the next one.
    checks : tuple of Check
        See `track_checks`; empty without a track.
    sensors : SensorChecks, optional
        See `sensor_checks`; None without a track.
    explanation : str, optional
        See `explain`.
    """

    present: Annotated[FloatArray, exactly(None, check=_checks.bounded)]
    line: Number
    drift: Number
    chirp: Number = np.nan
    start: Number = np.nan
    nis: Number = np.nan
    lag1: Number = np.nan
    overlap: Number = 0.0
    checks: tuple[Check, ...] = ()
    sensors: SensorChecks | None = None
    explanation: str | None = None

    @property
    def cause(self) -> str:
        """Cause that the symptoms speak for, by the first of the looks that has an answer."""
        weak = np.flatnonzero(self.present < 0.5 * np.median(self.present))
        failed = [check.name for check in self.checks if not check.passed]
        looks = (
            (not self.checks, "no target"),
            (len(weak), f"sensor {', '.join(str(i + 1) for i in weak)} dead or blind"),
            (np.isfinite(self.line), f"hum at {self.line:g} Hz"),
            (self.drift > _DRIFT, "DC offset drifts"),
            (self.chirp > 1, "window too long"),
            ("whiteness" in failed and self.overlap > 0, "windows overlap"),
            (self.explanation, self.explanation),
            (failed, "unexplained"),
        )
        return next((str(cause) for found, cause in looks if found), "none found")


@checked
@_checks.quiet
def symptoms(recording: Recording, setup: Setup) -> Symptoms:
    """Measure the symptoms of a mistake in a recording or in its setup.

    Parameters
    ----------
    recording : Recording
        Of one target, by the array of `setup`.
    setup : Setup
        Settings with which it is tracked.

    Returns
    -------
    Symptoms

    Notes
    -----
    A line of the mains stands at plus and minus 50 or 60 Hz or a multiple, in one bin, while an
    echo sweeps over many: both bins exceed the noise of their neighbors by a factor that noise
    reaches with a probability of 0.001 in the whole recording. Near the shifts of the echo, and of
    its image, no line is looked for. The limits of `drift` and `chirp` are rules of thumb.

    Examples
    --------
    >>> from dopplerlib import RadarArray
    >>> array, noise = RadarArray([[0, 0, 1], [0, 2, 1]], 0.0285), np.random.default_rng(1)
    >>> setup = Setup(array, ([1, 0, 1], [6, 5, 1]), 2, 0.1, window=0.05, start=0.3)
    >>> x = noise.standard_normal((2, 500, 2)) @ [1, 1j]
    >>> symptoms(Recording(x, 500.0, setup.carrier), setup).cause
    'no target'
    """
    iq = setup.baseband(recording)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ImplausibleStart)
        found = setup.track(iq)
    present = np.isfinite(found.shift).mean(axis=0)
    line, drift = _spectrum(recording, found.shift)
    if present.max() < _PRESENT or not np.isfinite(found.score[:, -1]).any():
        return Symptoms(present, line, drift)
    track = found.final_track
    count = int(np.isfinite(track.innovation).sum())
    square = float(np.nansum(track.nis))
    hop = setup.window if setup.hop is None else setup.hop
    slope = np.abs(np.diff(found.shift, axis=0)) / hop
    known = np.isfinite(slope).any(axis=0)
    chirp = np.nanmedian(slope[:, known], axis=0).max(initial=0.0) * setup.window**2
    return Symptoms(
        present,
        line,
        drift,
        float(chirp),
        float(found.score[:, 0].min() / max(int(found.degrees), 1)),
        square / max(count, 1),
        float(found.lag1_autocorrelation),
        max(0.0, round(1 - hop / setup.window, 3)),
        track_checks(found),
        sensor_checks(track),
        explain(iq, setup).best,
    )


def _spectrum(recording, shift):
    """Return the frequency of a line of the mains or NaN, and the power near 0 Hz over the noise.

    shift (K, N): Doppler shifts of the echo, near which no line is looked for.
    """
    good = recording.valid.all(axis=0)
    x = recording.x[:, good]
    n = x.shape[1]
    if n < 8 * _AROUND:
        return np.nan, np.nan
    x = x / np.abs(x).max()
    x = x - x.mean(axis=1, keepdims=True)
    power = np.abs(np.fft.fft(x * np.hanning(n + 2)[1:-1])) ** 2
    f = np.fft.fftfreq(n, 1 / recording.fs)
    slow = (np.abs(f) < _SLOW) & (f != 0)
    sides = [(sign * f >= _SLOW) & (sign * f < _NEAR) for sign in (1, -1)]
    if not (slow.any() and all(side.any() for side in sides)):
        return _line(power, recording.fs, n, shift), np.nan
    beside = np.max([power[:, side].mean(axis=1) for side in sides], axis=0)
    drift = np.median(power[:, slow].mean(axis=1) / beside)
    return _line(power, recording.fs, n, shift), float(drift)


def _line(power, fs, n, shift):
    """Return the lowest harmonic of the mains with a line in any sensor, or NaN."""
    lines = sorted({k * mains for mains in MAINS for k in range(1, _HARMONICS + 1)})
    beside = np.r_[-_AROUND:-2, 3 : _AROUND + 1]
    limit = np.log(3) - np.log(LIMIT / (len(lines) * len(power))) / 2
    margin = 2 * _AROUND * fs / n
    for f in lines:
        bins = round(f / fs * n), round(-f / fs * n)
        if not _AROUND < bins[0] < n // 2 - _AROUND:
            continue
        # An echo that passes, or its image, is no line.
        free = ~(np.abs(np.abs(shift) - f) < margin).any(axis=0)
        peak = [power[:, b + np.arange(-1, 2)].max(axis=1) for b in bins]
        noise = [np.median(power[:, b + beside], axis=1) / np.log(2) for b in bins]
        ratio = np.min(np.divide(peak, noise), axis=0)
        if (free & (ratio > limit)).any():
            return f
    return np.nan
