"""Figures of a recording and its track: spectrogram, shifts, residuals, views of the track."""

import numpy as np
from matplotlib.figure import Figure

from .._hints import Array, Positive
from ..chain.alarm import StopAlarm
from ..chain.setup import Setup
from ..chain.track import IqTrack
from ..evaluation.consistency import chi2_interval
from ..model.doppler import doppler_shift
from ..signal.spectrogram import Spectrogram
from .style import BOUND, MEASURED, ORANGE, OURS, SENSOR, TRUTH, drawing, sensor_colors

_SPAN = 60  # dB, at most: what is fainter beside the loudest line is dark


@drawing(7.0, 3.6)
def spectrogram(
    figure: Figure,
    seen: Spectrogram,
    wavelength: Positive | None = None,
    band: tuple[float, float] | None = None,
) -> None:
    """Draw a spectrogram, one panel for each sensor.

    seen: Of one sensor (F, M), or of S of them (S, F, M).
    wavelength: In m; if given, a second axis shows radial velocities of a radar.
    band: Lowest and highest frequency in Hz to be shown.
    """
    f, t = seen.frequency, seen.time
    shown = np.ones(len(f), bool) if band is None else (f >= band[0]) & (f <= band[1])
    if not shown.any():
        raise ValueError(f"band must hold a frequency of the spectrogram, got {band}")
    level = seen.db.reshape(-1, len(f), len(t))[:, shown]
    known = level[np.isfinite(level)]
    if not known.size:
        raise ValueError("seen must hold power at a time and a frequency that is shown, got none")
    high = float(known.max())
    low = max(float(np.median(known)), high - _SPAN)
    ends = [_edges(t), _edges(f[shown])]
    rows = -(-len(level) // 2)
    if len(level) > 1:
        figure.set_size_inches(7.0, 1.2 + 1.7 * rows)
    axes = figure.subplots(rows, min(len(level), 2), squeeze=False, sharex=True, sharey=True)
    for i, (ax, one) in enumerate(zip(axes.ravel(), level, strict=False)):
        image = ax.imshow(
            one, extent=(*ends[0], *ends[1]), origin="lower", aspect="auto", cmap="cividis",
            vmin=low, vmax=max(high, low + 1), interpolation="nearest",
        )  # fmt: skip
        ax.set_facecolor("#DDDDDD")  # where there is no measurement
        ax.grid(False)
        if len(level) > 1:
            ax.set_title(f"sensor {i + 1}")
        if i % 2 == 0:
            ax.set_ylabel("frequency (Hz)")
        if i >= len(level) - 2:
            ax.set_xlabel("time (s)")
            ax.xaxis.set_tick_params(labelbottom=True)
        if wavelength is not None and (i % 2 or i == len(level) - 1):
            speed = ax.secondary_yaxis(
                "right", functions=(lambda f: f * wavelength / 2, lambda v: 2 * v / wavelength)
            )
            speed.set_ylabel("velocity (m/s)")
    for ax in axes.ravel()[len(level) :]:
        ax.set_axis_off()
    figure.colorbar(image, ax=axes).set_label("power density (dB)")


@drawing(7.0, 3.4)
def shifts(figure: Figure, found: IqTrack, setup: Setup) -> None:
    """Draw the Doppler shifts of each sensor, and those that the track predicts.

    found: Track of one record.
    setup: Its array.
    """
    ax = figure.subplots()
    track = found.final_track
    colors = sensor_colors(found.shift.shape[-1])
    time = found.time[found.used :]
    for i, color in enumerate(colors):
        ax.errorbar(
            found.time, found.shift[:, i], 2 * np.where(np.isnan(found.shift[:, i]), 0,
            found.shift_std[:, i]), fmt=".", color=color, ms=4, lw=0.8, label=f"sensor {i + 1}",
        )  # fmt: skip
    if np.isfinite(track.x).all() and len(time):
        for curve, color in zip(doppler_shift(track.x, setup.array).T, colors, strict=True):
            ax.plot(time, curve, color=color, lw=1.0)
    ax.axvspan(found.time[0], found.time[found.used - 1], color=BOUND, alpha=0.12, lw=0)
    ax.text(found.time[0], 1.01, " start", transform=ax.get_xaxis_transform(), color=BOUND)
    ax.set(xlabel="time (s)", ylabel="Doppler shift (Hz)")
    figure.legend(loc="outside right upper")


@drawing(7.0, 4.2)
def residuals(figure: Figure, found: IqTrack) -> None:
    """Draw the innovations over their standard deviations, and NIS with its interval of 95 %.

    found: Track of one record.
    """
    upper, lower = figure.subplots(2, 1, sharex=True)
    track, time = found.final_track, found.time[found.used :]
    std = np.sqrt(np.diagonal(track.S, axis1=-2, axis2=-1))
    colors = sensor_colors(std.shape[-1])
    for i, (color, one) in enumerate(zip(colors, (track.innovation / std).T, strict=True)):
        upper.plot(time, one, ".-", color=color, lw=0.6, ms=4, label=f"sensor {i + 1}")
    upper.axhspan(-2, 2, color=BOUND, alpha=0.15, lw=0)
    upper.set_ylabel("innovation (σ)")
    lower.plot(time, track.nis, ".", color=OURS, ms=5)
    counts = np.isfinite(track.innovation).sum(axis=-1)
    if counts.max(initial=0):
        low, high = chi2_interval(int(counts.max()))
        lower.axhspan(low, high, color=BOUND, alpha=0.15, lw=0)
        mean = float(np.nanmean(track.nis))
        lower.axhline(mean, color=OURS, lw=1)
        lower.text(1.0, 1.01, f"mean {mean:.3g}, expected {counts.mean():.3g}", ha="right",
                   transform=lower.transAxes, color=OURS)  # fmt: skip
        if np.nanmax(track.nis) > 10 * high:
            lower.set_yscale("log")
    lower.set(xlabel="time (s)", ylabel="NIS (1)")
    figure.legend(*upper.get_legend_handles_labels(), loc="outside right upper")


@drawing(7.0, 3.4)
def views(
    figure: Figure,
    found: IqTrack,
    setup: Setup,
    truth: Array | None = None,
    alarm: StopAlarm | None = None,
) -> None:
    """Draw a track from above and from the side, with the sensors and the box.

    found: Track of one record.
    setup: Sensors, box, and the point that must not be reached.
    truth (K, 3): Positions in m, if they are known.
    alarm: Where the target is at the first alarm is marked.
    """
    _, x, P = found.live
    lower, upper = (np.asarray(bound)[:3] for bound in setup.box)
    for ax, (a, b), name in zip(
        figure.subplots(1, 2), ((0, 1), (0, 2)), ("from above", "from the side"), strict=True
    ):
        ax.add_patch(_box(lower[[a, b]], upper[[a, b]]))
        ax.plot(*setup.array.positions[:, [a, b]].T, "^", color=SENSOR, label="sensors")
        if truth is not None:
            ax.plot(*truth[:, [a, b]].T, color=TRUTH, lw=2.5, alpha=0.35, label="truth")
        ax.plot(x[:, a], x[:, b], color=OURS, lw=1.2, label="track")
        ax.errorbar(
            x[-1, a], x[-1, b], 2 * np.sqrt(P[-1, b, b]), 2 * np.sqrt(P[-1, a, a]),
            fmt="o", color=OURS, ms=4,
        )  # fmt: skip
        if alarm is not None and np.isfinite(alarm.first):
            at = x[int(np.argmax(alarm.alarm))]
            ax.plot(at[a], at[b], "X", color=ORANGE, mec=TRUTH, ms=9, label="alarm")
        ax.set(xlabel="x (m)", ylabel=f"{'xyz'[b]} (m)", title=name)
        ax.set_aspect("equal", "datalim")
    figure.legend(*ax.get_legend_handles_labels(), loc="outside upper center", ncols=4)


def _box(lower, upper):
    from matplotlib.patches import Rectangle

    return Rectangle(lower, *(upper - lower), fill=False, ec=MEASURED, ls=":", lw=1.2)


def _edges(centers):
    """Return the outer edges of cells with these centers."""
    half = (centers[1] - centers[0]) / 2 if len(centers) > 1 else 0.5
    return centers[0] - half, centers[-1] + half
