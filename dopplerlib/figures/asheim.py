"""Figures of the chapter on one radar: scene and noise, filtered ranges, gates, departures."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse, FancyArrowPatch, FancyBboxPatch, Rectangle

from .._hints import Array, Booleans
from .style import BOUND, MEASURED, ORANGE, OURS, PUBLISHED, SENSOR, TRUTH, VARIANTS, drawing

# A filter of one radar has one look in all figures.
_WITH_RATE = {"range only": (ORANGE, "--"), "range and rate": (OURS, "-")}


@drawing(7.0, 4.0)
def geometry(figure: Figure, target: Array, sensors: Array) -> None:
    """Draw two radars, a target, and what each radar measures (Fig 2.1).

    target (4,): State [x, y, v_x, v_y].
    sensors (2, 2): Positions of the radars in m.
    """
    ax = figure.subplots()
    angle = np.linspace(0, np.pi, 200)
    for n, (sensor, ls) in enumerate(zip(sensors, ("-", "--"), strict=True), 1):
        line = target[:2] - sensor
        d = np.hypot(*line)
        circle = sensor + d * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        ax.plot(*circle.T, color=SENSOR, ls=ls, lw=1.0)
        ax.plot(*np.stack([sensor, target[:2]]).T, color=SENSOR, ls=ls)
        side = 2 * n - 3
        middle = sensor + 0.55 * line + np.array([0.22 * side, 0.0])
        ax.text(middle[0], middle[1], f"$d_{n}$", color=SENSOR, ha="center", fontsize=13)
        ax.plot(*sensor, "o", color=SENSOR, ms=9)
        ax.annotate(f"$R_{n}$", sensor, (0, -20), textcoords="offset points", ha="center")
    tip = target[:2] + 6 * target[2:]
    ax.add_patch(_arrow(target[:2], tip, 14))
    ax.plot(*target[:2], "s", color=TRUTH, ms=9)
    ax.annotate("target", target[:2], (12, -4), textcoords="offset points")
    ax.axhline(0, color=BOUND, lw=0.8)
    ax.set(xlabel="x (m)", ylabel="y (m)", xlim=(-4.2, 4.4), ylim=(-0.6, 3.9), aspect="equal")


@drawing(7.0, 2.2)
def system_path(figure: Figure) -> None:
    """Draw the path from detections to a position (Figs 4.1 and 5.4)."""
    ax = figure.subplots()
    ax.axis("off")
    ax.set(xlim=(0, 12.2), ylim=(0, 3.2))
    for n, y in ((1, 2.2), (2, 0.2)):
        ax.text(0.1, y + 0.4, f"$d_{n}, v_{n}$", va="center", color=SENSOR, fontsize=12)
        for x, text in ((1.3, "gate"), (3.8, "nearest\nneighbor"), (6.3, "Kalman\nfilter")):
            _block(ax, x, y, text)
        for left, right in ((0.95, 1.25), (3.27, 3.75), (5.77, 6.25)):
            ax.add_patch(_arrow((left, y + 0.4), (right, y + 0.4)))
        ax.add_patch(_arrow((8.3, y + 0.4), (8.95, 1.75 if n == 1 else 1.45)))
    _block(ax, 9.0, 1.2, "circles\nmeet")
    ax.add_patch(_arrow((11.0, 1.6), (11.45, 1.6)))
    ax.text(11.5, 1.6, r"$\hat x, \hat y$", va="center", fontsize=12)


def _block(ax, x, y, text, width=1.9, height=0.8):
    ax.add_patch(
        FancyBboxPatch(
            (x, y), width, height, boxstyle="round,pad=0.05", fc="white", ec=OURS, lw=1.3
        )
    )
    ax.text(x + width / 2, y + height / 2, text, ha="center", va="center", color=TRUTH)


def _arrow(start, end, scale=10):
    return FancyArrowPatch(start, end, arrowstyle="-|>", mutation_scale=scale, color=TRUTH)


@drawing(7.0, 3.4)
def tracks(
    figure: Figure,
    truths: Sequence[Array],
    titles: Sequence[str],
    sensors: Array,
    noisy: Sequence[Array] = (),
) -> None:
    """Draw tracks side by side, with noisy positions if there are any (Figs 5.1 and 5.3).

    truths (K, 2): True positions in m.
    titles: One for each.
    sensors (2, 2): Positions of the radars in m.
    noisy (K, 2): Measured positions in m, one for each track or none.
    """
    axes = figure.subplots(1, len(truths), squeeze=False)[0]
    for ax, positions in zip(axes, noisy, strict=False):
        ax.plot(*positions.T, "+", color=OURS, ms=5, mew=0.9, label="with noise")
    for ax, truth, title in zip(axes, truths, titles, strict=True):
        ax.plot(*truth.T, color=TRUTH, label="true")
        ax.plot(*sensors.T, "o", color=SENSOR, label="radars")
        ax.plot(*truth[-1], "s", color=TRUTH, ms=5)
        ax.set(xlabel="x (m)", ylabel="y (m)", title=title)
        ax.set_aspect("equal", adjustable="datalim")  # panels of one height
    axes[-1].legend(loc="lower left")


@drawing(7.0, 2.9)
def noise_law(
    figure: Figure,
    d: Array,
    laws: dict[str, Array],
    deviation: dict[str, Array],
    detection: dict[str, Array],
) -> None:
    """Draw the SNR (Fig 5.2), the standard deviation and the probability of detection.

    d (M,): Range in m.
    laws (M,): Signal-to-noise ratios in dB by label.
    deviation (M,): Standard deviations of the range in m, by the same labels.
    detection (M,): Probabilities of detection, by the same labels.
    """
    left, middle, right = figure.subplots(1, 3)
    for (label, snr), (color, ls) in zip(laws.items(), VARIANTS, strict=False):
        left.plot(d, snr, color=color, ls=ls, label=label)
        middle.plot(d, deviation[label], color=color, ls=ls)
        right.plot(d, detection[label], color=color, ls=ls)
    left.axhline(10, color=BOUND, ls=":", lw=1.2)
    left.text(d[0], 11, "10 dB", color=BOUND, fontsize=9)
    left.legend(loc="upper right", fontsize=8)
    left.set(ylabel="SNR (dB)", ylim=(-40, 75))
    middle.set(ylabel="standard deviation of $d$ (m)", yscale="log")
    right.set(ylabel="probability of detection", ylim=(-0.02, 1.05))
    for ax in (left, middle, right):
        ax.set_xlabel("range (m)")


@drawing(7.0, 3.3)
def one_range(
    figure: Figure,
    time: Array,
    truth: Array,
    measured: Array,
    estimates: dict[str, Array],
    zoom: tuple[float, float],
) -> None:
    """Draw the range of one radar, measured and filtered, and a part of it (Figs 3.4 and 3.6).

    time (K,): Time in s.
    truth, measured (K,): Ranges in m.
    estimates (K,): Filtered ranges by label.
    zoom: Time interval of the right panel in s.
    """
    whole, part = figure.subplots(1, 2)
    near = (time >= zoom[0]) & (time <= zoom[1])
    for ax, at in ((whole, slice(None)), (part, near)):
        ax.plot(time[at], measured[at], color=MEASURED, lw=0.9, label="measured")
        ax.plot(time[at], truth[at], color=TRUTH, label="true")
        for label, d in estimates.items():
            color, ls = _WITH_RATE.get(label, VARIANTS[0])
            ax.plot(time[at], d[at], color=color, ls=ls, label=label)
        ax.set(xlabel="time (s)", ylabel="range (m)")
    whole.axvspan(*zoom, color=BOUND, alpha=0.25, lw=0)
    whole.legend()


@drawing(7.0, 3.3)
def with_without(figure: Figure, time: Array, errors: dict[str, dict[str, Array]]) -> None:
    """Draw absolute range errors of a single run, and the RMS of all runs (Fig 5.6).

    time (K,): Time in s.
    errors (runs, K): For each panel by title, range errors in m by label.
    """
    axes = figure.subplots(1, len(errors), sharey=True, squeeze=False)[0]
    for ax, (title, series) in zip(axes, errors.items(), strict=True):
        for label, error in series.items():
            color, ls = _WITH_RATE[label]
            ax.plot(time[::5], np.abs(error[0, ::5]), color=color, lw=0.6)
            rms = np.sqrt(np.nanmean(error**2, axis=0))
            ax.plot(time, rms, color=color, ls=ls, lw=2, label=f"{label}, {len(error)} runs")
        ax.set(title=title, xlabel="time (s)", yscale="log", ylim=(1e-4, 20))
        ax.legend(loc="upper left", fontsize=8.5)
    axes[0].set_ylabel("absolute range error (m)")


@drawing(7.0, 3.3)
def gates(
    figure: Figure,
    predictions: dict[str, tuple[Array, Array]],
    box: tuple[float, float],
    factor: float,
) -> None:
    """Draw the fixed box and the ellipse of a gate on NIS at several times (Figs 4.2 and 4.3).

    predictions: By title: the innovation covariance, and the detections relative to the prediction.
    box: Half-widths in m and m/s.
    factor: Bound on NIS.
    """
    axes = figure.subplots(1, len(predictions), sharex=True, sharey=True)
    w, h = box
    for ax, (title, (S, d)) in zip(axes, predictions.items(), strict=True):
        edge = {"fill": False, "lw": 1.6}
        label = "box of the thesis"
        ax.add_patch(Rectangle((-w, -h), 2 * w, 2 * h, ec=ORANGE, ls="--", label=label, **edge))
        values, vectors = np.linalg.eigh(S)
        angle = np.degrees(np.arctan2(vectors[1, 1], vectors[0, 1]))
        size = 2 * np.sqrt(factor * values[::-1])
        ax.add_patch(Ellipse((0, 0), *size, angle=angle, ec=OURS, label="NIS gate", **edge))
        nis = np.sum(d * np.linalg.solve(S, d.T).T, axis=-1)
        inside = nis <= factor
        ax.plot(*d[inside].T, "o", color=SENSOR, ms=5, label="inside the ellipse")
        ax.plot(*d[~inside].T, "x", color=BOUND, ms=6, mew=1.6, label="outside")
        if inside.any():
            nearest = d[inside][np.argmin(nis[inside])]
            ax.plot(*nearest, "o", mfc="none", mec=TRUTH, ms=11, label="nearest")
        ax.plot(0, 0, "+", color=TRUTH, ms=10, mew=1.6, label="prediction")
        ax.set(title=title, xlabel="range innovation (m)")
        ax.set(xlim=(-1.7, 1.7), ylim=(-1.2, 1.2))
    axes[0].set_ylabel("range-rate innovation (m/s)")
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3)


@drawing(7.0, 2.9)
def radar_record(
    figure: Figure,
    time: Array,
    truth: Array,
    measured: Array,
    estimate: Array,
    updated: Booleans,
    zooms: Sequence[tuple[float, float]],
) -> None:
    """Draw the measured and the filtered range of one radar in three scales (Figs 5.7, 5.8).

    time (K,): Time in s.
    truth, measured, estimate (K,): Ranges in m.
    updated (K,): Whether the measurement was used.
    zooms: Time intervals of the second and the third panel in s.
    """
    axes = figure.subplots(1, 3)
    for ax, zoom in zip(axes, [(time[0], time[-1]), *zooms], strict=True):
        at = (time >= zoom[0]) & (time <= zoom[1])
        ax.plot(time[at], measured[at], color=MEASURED, lw=0.7, label="measured")
        out = at & ~updated
        ax.plot(time[out], measured[out], "x", color=ORANGE, ms=3.5, label="outside the gate")
        ax.plot(time[at], truth[at], color=TRUTH, ls="--", label="true")
        ax.plot(time[at], estimate[at], color=OURS, label="filtered")
        ax.set(xlabel="time (s)", title=f"{zoom[0]:.0f} to {zoom[1]:.0f} s")
    axes[0].set_ylabel("range (m)")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=4)


@drawing(7.0, 2.8)
def departures(
    figure: Figure, times: Array, published: Sequence[float], titles: Sequence[str]
) -> None:
    """Draw the times at which many runs leave the track, beside the published ones.

    times (runs, 2): Times of departure in s; infinite where there is none.
    published: Published times in s.
    titles: One for each radar.
    """
    axes = figure.subplots(1, 2, sharex=True, sharey=True)
    finite = times[np.isfinite(times)]
    bins = np.arange(np.floor(finite.min()), np.ceil(finite.max()) + 0.5, 0.5)
    for ax, own, told, title in zip(axes, times.T, published, titles, strict=True):
        ax.hist(own[np.isfinite(own)], bins, color=OURS, label=f"{len(times)} runs")
        ax.axvline(told, color=PUBLISHED, ls="--", label="the thesis")
        ax.set(title=title, xlabel="time of departure (s)")
        ax.legend()
    axes[0].set_ylabel("runs")


@drawing(7.0, 3.3)
def gate_on_off(
    figure: Figure,
    time: Array,
    truth: Array,
    measured: Array,
    gated: Array,
    free: Array,
    titles: Sequence[str],
) -> None:
    """Draw filtered ranges with and without a gate, one panel for each radar (Fig 5.9).

    time (K,): Time in s.
    truth, measured, gated, free (N, K): Ranges in m.
    titles: One for each radar.
    """
    axes = figure.subplots(1, len(truth), sharey=True)
    for n, (ax, title) in enumerate(zip(axes, titles, strict=True)):
        ax.plot(time, measured[n], color=MEASURED, lw=0.7, label="measured")
        ax.plot(time, truth[n], color=TRUTH, ls="--", label="true")
        ax.plot(time, gated[n], color=ORANGE, ls="-.", label="with the gate")
        ax.plot(time, free[n], color=OURS, label="without")
        ax.set(title=title, xlabel="time (s)", ylim=(truth.min() - 1, truth.max() + 4))
    axes[0].set_ylabel("range (m)")
    axes[0].legend(loc="upper left")
