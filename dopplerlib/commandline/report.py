"""Texts and tables about a track: summary, shifts and states."""

import csv
import io
from collections.abc import Iterable

import numpy as np

from .._hints import checked
from ..chain.alarm import StopAlarm
from ..chain.setup import Setup
from ..chain.track import IqTrack
from ..evaluation.symptoms import Symptoms
from ..signal.recording import Recording

_AXES = "x", "y", "z"
_ABOUT = {
    "start": "a straight path explains the first shifts",
    "NIS": "innovations are no larger than stated",
    "sensors": "no sensor disagrees",
    "mean": "innovations have the mean zero",
    "whiteness": "innovations are independent in time",
}


@checked
def shifts_csv(found: IqTrack) -> str:
    """Return the Doppler shifts of a track of one record as CSV.

    Parameters
    ----------
    found : IqTrack
        Track of N sensors.

    Returns
    -------
    str
        A line for each window; empty where a shift is missing.
    """
    names = ["time (s)", "available at (s)"]
    columns = [found.time, found.available_at]
    for i in range(found.shift.shape[-1]):
        names += [f"shift of sensor {i + 1} (Hz)", f"standard deviation of sensor {i + 1} (Hz)"]
        columns += [found.shift[:, i], found.shift_std[:, i]]
    return _csv(names, columns)


@checked
def track_csv(found: IqTrack, alarm: StopAlarm | None = None) -> str:
    """Return the states of a track of one record as CSV.

    Parameters
    ----------
    found : IqTrack
        Track.
    alarm : StopAlarm, optional
        Its alarm.

    Returns
    -------
    str
        A line for each sample from the start on: time from which a state is known, the state then,
        its standard deviations, NIS and the number of measurements; empty where there is none.
    """
    time, x, P = found.live
    std = np.sqrt(np.diagonal(P, axis1=-2, axis2=-1))
    units = [*(f"{a} (m)" for a in _AXES), *(f"v{a} (m/s)" for a in _AXES)]
    names = ["time (s)", *units, *(f"standard deviation of {unit}" for unit in units)]
    columns = [time, *x.T, *std.T]
    track = found.final_track
    names += ["NIS (1)", "measurements (1)"]
    columns += [np.r_[np.nan, track.nis], np.r_[np.nan, np.isfinite(track.innovation).sum(axis=-1)]]
    if alarm is not None:
        names += ["distance (m)", "standard deviation of distance (m)", "alarm (1)"]
        columns += [alarm.distance, alarm.distance_std, alarm.alarm]
    return _csv(names, columns)


@checked
def summary(
    recording: Recording,
    setup: Setup,
    found: IqTrack | None,
    seen: Symptoms,
    alarm: StopAlarm | None = None,
) -> str:
    """Return a summary of a recording and its track, with the verdict of each check.

    Parameters
    ----------
    recording : Recording
        Recording.
    setup : Setup
        Settings with which it was tracked.
    found : IqTrack or None
        Track; None if there is no target.
    seen : Symptoms
        Symptoms of the recording.
    alarm : StopAlarm, optional
        Alarm of the track.

    Returns
    -------
    str
    """
    sensors, n = recording.x.shape
    lines = [
        f"recording   {sensors} sensors, {n / recording.fs:g} s at {recording.fs:g} Hz, "
        f"carrier {recording.carrier / 1e9:.6g} GHz",
        f"            {_percent(~recording.valid.all(axis=0))} of the samples invalid in a sensor",
        "shifts      present in "
        + ", ".join(f"{100 * one:.0f}" for one in seen.present)
        + " % of the windows",
    ]
    for check in seen.checks:
        verdict = "passed" if check.passed else "FAILED"
        lines.append(f"{check.name:11} {verdict}: {_ABOUT[check.name]} (p = {check.value:.2g})")
    if seen.checks:
        lines.append(f"            NIS is {seen.nis:.2g} times what is expected")
    lines.append(f"cause       {seen.cause}")
    if found is not None:
        lines += _last(found)
    if alarm is not None:
        when = "never" if np.isinf(alarm.first) else f"at {float(alarm.first):.4g} s"
        where = ", ".join(f"{one:g}" for one in setup.point)
        lines.append(f"alarm       {when}: nearer than {setup.distance:g} m to ({where}) m")
    return "\n".join(lines) + "\n"


def _last(found):
    time, x, P = found.live
    std = np.sqrt(np.diagonal(P[-1]))
    parts = [
        f"{name} = {value:.4g} ± {dev:.2g} {unit}"
        for name, value, dev, unit in zip(
            ("x", "y", "z", "vx", "vy", "vz"), x[-1], std, ["m"] * 3 + ["m/s"] * 3, strict=True
        )
    ]
    rows = ", ".join(parts[:3]), ", ".join(parts[3:])
    return [f"track       at {time[-1]:.4g} s", *(f"            {row}" for row in rows)]


def _percent(wrong):
    return f"{100 * np.mean(wrong):.3g} %"


def _csv(names: Iterable[str], columns: Iterable[np.ndarray]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(names)
    for row in zip(*columns, strict=True):
        writer.writerow([f"{value:.10g}" if np.isfinite(value) else "" for value in row])
    return text.getvalue()
