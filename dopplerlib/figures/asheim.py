"""Figures of the chapter on two radars and a person, after those of the thesis."""

import numpy as np
from matplotlib.patches import Ellipse, FancyArrowPatch, FancyBboxPatch, Rectangle

from .style import BOUND, ORANGE, OURS, PINK, PUBLISHED, SENSOR, TRUTH, styled

# What a radar says in the thesis's figures; ours have one more color than the book's meanings.
MEASURED = "#999999"


def geometry(target, sensors):
    """Draw two radars, a target, and what each of them measures (Fig 2.1).

    Parameters
    ----------
    target : ndarray, shape (4,)
        State [x, y, v_x, v_y].
    sensors : ndarray, shape (2, 2)
        Positions of the radars in m.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with styled(5.2, 4.4) as figure:
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
            ax.text(*middle, f"$d_{n}$", color=SENSOR, ha="center", fontsize=13)
            ax.plot(*sensor, "o", color=SENSOR, ms=9)
            ax.annotate(f"$R_{n}$", sensor, (0, -20), textcoords="offset points", ha="center")
        tip = target[:2] + 6 * target[2:]
        ax.add_patch(
            FancyArrowPatch(target[:2], tip, arrowstyle="-|>", mutation_scale=14, color=TRUTH)
        )
        ax.plot(*target[:2], "s", color=TRUTH, ms=9)
        ax.annotate("target", target[:2], (12, -4), textcoords="offset points")
        ax.axhline(0, color=BOUND, lw=0.8)
        ax.set(xlabel="x in m", ylabel="y in m", xlim=(-2.6, 3.4), ylim=(-0.6, 3.9), aspect="equal")
        return figure


def system_path():
    """Draw the path from detections to a position (Figs 4.1 and 5.4).

    Returns
    -------
    matplotlib.figure.Figure
    """
    with styled(7.0, 2.2) as figure:
        ax = figure.subplots()
        ax.axis("off")
        ax.set(xlim=(0, 12.2), ylim=(0, 3.2))

        def box(x, y, text, width=1.9, height=0.8):
            ax.add_patch(FancyBboxPatch((x, y), width, height, boxstyle="round,pad=0.05",
                                        fc="white", ec=OURS, lw=1.3))  # fmt: skip
            ax.text(x + width / 2, y + height / 2, text, ha="center", va="center", color=TRUTH)

        def arrow(start, end):
            ax.add_patch(
                FancyArrowPatch(start, end, arrowstyle="-|>", mutation_scale=10, color=TRUTH)
            )

        for n, y in ((1, 2.2), (2, 0.2)):
            ax.text(0.1, y + 0.4, f"$d_{n}, v_{n}$", va="center", color=SENSOR, fontsize=12)
            for x, text in ((1.3, "gate"), (3.8, "nearest\nneighbor"), (6.3, "Kalman\nfilter")):
                box(x, y, text)
            for left in (0.85, 3.3, 5.8):
                arrow((left, y + 0.4), (left + 0.42, y + 0.4))
            arrow((8.3, y + 0.4), (8.95, 1.75 if n == 1 else 1.45))
        box(9.0, 1.2, "circles\nmeet")
        arrow((11.0, 1.6), (11.45, 1.6))
        ax.text(11.5, 1.6, r"$\hat x, \hat y$", va="center", fontsize=12)
        return figure


def tracks(truths, titles, sensors, noisy=None):
    """Draw tracks side by side, with noisy positions if there are any (Figs 5.1 and 5.3).

    Parameters
    ----------
    truths : sequence of ndarray, shape (K, 2)
        True positions in m.
    titles : sequence of str
        One for each.
    sensors : ndarray, shape (2, 2)
        Positions of the radars in m.
    noisy : sequence of ndarray, shape (K, 2), optional
        Measured positions in m.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with styled(7.0, 3.4) as figure:
        axes = figure.subplots(1, len(truths), squeeze=False)[0]
        for i, (ax, truth, title) in enumerate(zip(axes, truths, titles, strict=True)):
            if noisy is not None:
                ax.plot(*noisy[i].T, "+", color=OURS, ms=5, mew=0.9, label="with noise")
            ax.plot(*truth.T, color=TRUTH, label="true")
            ax.plot(*sensors.T, "o", color=SENSOR, label="radars")
            ax.plot(*truth[-1], "s", color=TRUTH, ms=5)
            ax.set(xlabel="x in m", ylabel="y in m", title=title, aspect="equal")
        axes[-1].legend(loc="lower left")
        return figure


def noise_law(d, laws, deviation, detection):
    """Draw the signal-to-noise ratio (Fig 5.2), the error that follows, and the chance to detect.

    Parameters
    ----------
    d : ndarray, shape (M,)
        Range in m.
    laws : dict of str to ndarray, shape (M,)
        Signal-to-noise ratios in dB by label.
    deviation : dict of str to ndarray, shape (M,)
        Standard deviations of the range in m, by the same labels.
    detection : dict of str to ndarray, shape (M,)
        Chance to detect, by the same labels.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with styled(7.0, 2.9) as figure:
        left, middle, right = figure.subplots(1, 3)
        for (label, snr), color, ls in zip(laws.items(), (OURS, ORANGE), ("-", "--"), strict=False):
            left.plot(d, snr, color=color, ls=ls, label=label)
            middle.plot(d, deviation[label], color=color, ls=ls)
            right.plot(d, detection[label], color=color, ls=ls)
        left.axhline(10, color=BOUND, ls=":", lw=1.2)
        left.text(d[0], 11, "10 dB", color=BOUND, fontsize=9)
        left.legend(loc="upper right", fontsize=8)
        left.set(ylabel="signal-to-noise ratio in dB", ylim=(-40, 75))
        middle.set(ylabel="standard deviation of $d$ in m", yscale="log")
        right.set(ylabel="chance to detect", ylim=(-0.02, 1.05))
        for ax in (left, middle, right):
            ax.set_xlabel("range in m")
        return figure


def one_range(time, truth, measured, estimates, zoom):
    """Draw the range of one radar, measured and filtered, and a part of it (Figs 3.4 and 3.6).

    Parameters
    ----------
    time : ndarray, shape (K,)
        Time in s.
    truth, measured : ndarray, shape (K,)
        Ranges in m.
    estimates : dict of str to ndarray, shape (K,)
        Filtered ranges by label.
    zoom : tuple of float
        Time interval of the right panel in s.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with styled(7.0, 3.3) as figure:
        whole, part = figure.subplots(1, 2)
        near = (time >= zoom[0]) & (time <= zoom[1])
        for ax, at in ((whole, slice(None)), (part, near)):
            ax.plot(time[at], measured[at], color=MEASURED, lw=0.9, label="measured")
            ax.plot(time[at], truth[at], color=TRUTH, label="true")
            for (label, d), color, ls in zip(
                estimates.items(), (OURS, ORANGE), ("-", "--"), strict=False
            ):
                ax.plot(time[at], d[at], color=color, ls=ls, label=label)
            ax.set(xlabel="time in s", ylabel="range in m")
        whole.axvspan(*zoom, color=BOUND, alpha=0.15, lw=0)
        whole.legend()
        return figure


def plane(truth, sets, sensors, limits, titles=None):
    """Draw positions in the plane, one panel for each set of labeled positions.

    Parameters
    ----------
    truth : ndarray, shape (K, 2)
        True positions in m.
    sets : sequence of dict of str to ndarray, shape (K, 2)
        For each panel, positions by label; the last label of a panel is the estimate.
    sensors : ndarray, shape (2, 2)
        Positions of the radars in m.
    limits : tuple of two tuple of float
        Limits of x and of y.
    titles : sequence of str, optional
        Of the panels.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with styled(7.0, 3.6) as figure:
        axes = figure.subplots(1, len(sets), squeeze=False, sharey=True)[0]
        for i, (ax, positions) in enumerate(zip(axes, sets, strict=True)):
            labels = list(positions)
            for label in labels[:-1]:
                ax.plot(*positions[label].T, ".", color=MEASURED, ms=3, label=label)
            ax.plot(*positions[labels[-1]].T, color=OURS, label=labels[-1])
            ax.plot(*truth.T, color=TRUTH, ls="--", label="true")
            ax.plot(*sensors.T, "o", color=SENSOR)
            ax.set(xlabel="x in m", xlim=limits[0], ylim=limits[1])
            if titles:
                ax.set_title(titles[i])
            ax.legend(loc="upper left")
        axes[0].set_ylabel("y in m")
        return figure


def gates(predictions, box, factor):
    """Draw the fixed box and the ellipse of a gate on NIS at several moments (Figs 4.2 and 4.3).

    Parameters
    ----------
    predictions : sequence of dict
        For each moment its `title`, the innovation covariances `S` (2, 2) of the settings whose
        gate is drawn, and `detections` (M, 2) relative to the prediction.
    box : tuple of float
        Half-widths in m and m/s.
    factor : float
        Bound on NIS.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with styled(7.0, 2.9) as figure:
        axes = figure.subplots(1, len(predictions), sharex=True, sharey=True)
        for ax, moment in zip(axes, predictions, strict=True):
            w, h = box
            ax.add_patch(Rectangle((-w, -h), 2 * w, 2 * h, fill=False, ec=ORANGE, ls="--", lw=1.6,
                                   label="box of the thesis"))  # fmt: skip
            values, vectors = np.linalg.eigh(moment["S"])
            angle = np.degrees(np.arctan2(vectors[1, 1], vectors[0, 1]))
            size = 2 * np.sqrt(factor * values[::-1])
            ax.add_patch(Ellipse((0, 0), *size, angle=angle, fill=False, ec=OURS, lw=1.6,
                                 label="NIS gate"))  # fmt: skip
            d = moment["detections"]
            nis = np.sum(d * np.linalg.solve(moment["S"], d.T).T, axis=-1)
            inside = nis <= factor
            ax.plot(*d[inside].T, "o", color=SENSOR, ms=5, label="inside the ellipse")
            ax.plot(*d[~inside].T, "x", color=BOUND, ms=6, mew=1.6, label="outside")
            if inside.any():
                nearest = d[inside][np.argmin(nis[inside])]
                ax.plot(*nearest, "o", mfc="none", mec=TRUTH, ms=11, label="nearest")
            ax.plot(0, 0, "+", color=TRUTH, ms=10, mew=1.6)
            ax.set(title=moment["title"], xlabel="range − prediction in m")
            ax.set(xlim=(-1.7, 1.7), ylim=(-1.2, 1.2))
        axes[0].set_ylabel("velocity − prediction in m/s")
        handles, labels = axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=5, fontsize=8.5)
        return figure


def error_areas(p, sensors, rings, areas, titles):
    """Draw rings about both radars and the area that they share (Fig 5.5).

    Parameters
    ----------
    p : ndarray, shape (2,)
        True position in m.
    sensors : ndarray, shape (2, 2)
        Positions of the radars in m.
    rings : sequence of ndarray, shape (2,)
        For each pair of panels, half-widths of the rings of both radars in m.
    areas : sequence of ndarray, shape (M, 2)
        Outline of the area for each.
    titles : sequence of str
        Of the panels: the first rings in whole, then each in detail.

    Returns
    -------
    matplotlib.figure.Figure
    """
    angle = np.linspace(0, np.pi, 2000)
    unit = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    with styled(7.0, 3.1) as figure:
        axes = figure.subplots(1, 1 + len(rings))
        for ax, (half, corners), title in zip(
            axes, [(rings[0], areas[0]), *zip(rings, areas, strict=True)], titles, strict=True
        ):
            for n, (color, ls) in enumerate(((OURS, "-"), (ORANGE, "--"))):
                d = np.hypot(*(p - sensors[n]))
                for sign in (-1, 1):
                    ax.plot(
                        *(sensors[n] + (d + sign * half[n]) * unit).T, color=color, ls=ls, lw=1.2
                    )
            ax.fill(*corners.T, color=SENSOR, alpha=0.35, lw=0)
            ax.plot(*p, "*", color=TRUTH, ms=9)
            ax.set(title=title, xlabel="x in m")
        axes[0].plot(*sensors.T, "o", color=SENSOR)
        axes[0].set(ylabel="y in m", xlim=(-5, 5), ylim=(0, 5.4), aspect="equal")
        reach = 1.25 * np.abs(areas[-1] - p).max(axis=0)
        for ax in axes[1:]:
            ax.set(
                xlim=p[0] + reach[0] * np.array([-1, 1]), ylim=p[1] + reach[1] * np.array([-1, 1])
            )
        return figure


def with_without(time, errors, ylabel="|range error| in m"):
    """Draw absolute errors of a single run, and the root mean square of all (Fig 5.6).

    Parameters
    ----------
    time : ndarray, shape (K,)
        Time in s.
    errors : dict of str to dict of str to ndarray, shape (runs, K)
        For each panel by title, errors by label.
    ylabel : str
        Label of the vertical axis.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with styled(7.0, 3.3) as figure:
        axes = figure.subplots(1, len(errors), sharey=True, squeeze=False)[0]
        for ax, (title, series) in zip(axes, errors.items(), strict=True):
            for (label, error), color, ls in zip(
                series.items(), (ORANGE, OURS, SENSOR), ("--", "-", "-."), strict=False
            ):
                ax.plot(time[::5], np.abs(error[0, ::5]), color=color, lw=0.6)
                rms = np.sqrt(np.nanmean(error**2, axis=0))
                ax.plot(time, rms, color=color, ls=ls, lw=2, label=f"{label}, {len(error)} runs")
            ax.set(title=title, xlabel="time in s", yscale="log", ylim=(1e-4, 20))
            ax.legend(loc="upper left", fontsize=8.5)
        axes[0].set_ylabel(ylabel)
        return figure


def radar_record(time, truth, measured, estimate, updated, zooms):
    """Draw what one radar measures and its filter makes of it, in three scales (Figs 5.7, 5.8).

    Parameters
    ----------
    time : ndarray, shape (K,)
        Time in s.
    truth, measured, estimate : ndarray, shape (K,)
        Ranges in m.
    updated : ndarray of bool, shape (K,)
        Whether the measurement was used.
    zooms : sequence of two tuple (start, end)
        Time intervals of the second and the third panel in s.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with styled(7.0, 2.9) as figure:
        axes = figure.subplots(1, 3)
        titles = "whole record", "closer", "closer still"
        for ax, zoom, title in zip(axes, [(time[0], time[-1]), *zooms], titles, strict=True):
            at = (time >= zoom[0]) & (time <= zoom[1])
            ax.plot(time[at], measured[at], color=MEASURED, lw=0.7, label="measured")
            out = at & ~updated
            ax.plot(time[out], measured[out], "x", color=ORANGE, ms=3.5, label="outside the gate")
            ax.plot(time[at], truth[at], color=TRUTH, ls="--", label="true")
            ax.plot(time[at], estimate[at], color=OURS, label="filtered")
            ax.set(xlabel="time in s", title=title)
        axes[0].set_ylabel("range in m")
        figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
        return figure


def gate_on_off(time, truth, measured, gated, free, titles):
    """Draw filtered ranges with and without a gate, one panel for each radar (Fig 5.9).

    Parameters
    ----------
    time : ndarray, shape (K,)
        Time in s.
    truth, measured, gated, free : ndarray, shape (N, K)
        Ranges in m.
    titles : sequence of str
        One for each radar.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with styled(7.0, 3.3) as figure:
        axes = figure.subplots(1, len(truth), sharey=True)
        for n, (ax, title) in enumerate(zip(axes, titles, strict=True)):
            ax.plot(time, measured[n], color=MEASURED, lw=0.7, label="measured")
            ax.plot(time, truth[n], color=TRUTH, ls="--", label="true")
            ax.plot(time, gated[n], color=ORANGE, ls="-.", label="with the gate")
            ax.plot(time, free[n], color=OURS, label="without")
            ax.set(title=title, xlabel="time in s", ylim=(truth.min() - 1, truth.max() + 4))
        axes[0].set_ylabel("range in m")
        axes[0].legend(loc="upper left")
        return figure


def departures(times, published, titles):
    """Draw when many runs leave the track, and when the published ones did.

    Parameters
    ----------
    times : ndarray, shape (runs, 2)
        Times of departure in s; infinite where there is none.
    published : sequence of float
        Published times in s.
    titles : sequence of str
        One for each radar.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with styled(7.0, 2.8) as figure:
        axes = figure.subplots(1, 2, sharex=True, sharey=True)
        finite = times[np.isfinite(times)]
        bins = np.arange(np.floor(finite.min()), np.ceil(finite.max()) + 0.5, 0.5)
        for n, (ax, title) in enumerate(zip(axes, titles, strict=True)):
            ax.hist(
                times[np.isfinite(times[:, n]), n], bins, color=OURS, label=f"{len(times)} runs"
            )
            ax.axvline(published[n], color=PUBLISHED, ls="--", label="the thesis")
            ax.set(title=title, xlabel="time of departure in s")
            ax.legend()
        axes[0].set_ylabel("runs")
        return figure


def triangulated(time, truth, raw, estimate, sensors, limits):
    """Draw x and y over time and both in the plane (Fig 5.10).

    Parameters
    ----------
    time : ndarray, shape (K,)
        Time in s.
    truth, raw, estimate : ndarray, shape (K, 2)
        Positions in m.
    sensors : ndarray, shape (2, 2)
        Positions of the radars in m.
    limits : tuple of two tuple of float
        Limits of x and of y.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with styled(7.0, 3.0) as figure:
        axes = figure.subplots(1, 3)
        for i, name in enumerate("xy"):
            axes[i].plot(time, raw[:, i], color=MEASURED, lw=0.7, label="measured, inside the gate")
            axes[i].plot(time, truth[:, i], color=TRUTH, ls="--", label="true")
            axes[i].plot(time, estimate[:, i], color=OURS, label="filtered")
            axes[i].set(xlabel="time in s", ylabel=f"{name} in m", ylim=limits[i])
        axes[2].plot(*raw.T, ".", color=MEASURED, ms=3)
        axes[2].plot(*truth.T, color=TRUTH, ls="--")
        axes[2].plot(*estimate.T, color=OURS)
        axes[2].plot(*sensors.T, "o", color=SENSOR)
        axes[2].set(xlabel="x in m", ylabel="y in m", xlim=limits[0], ylim=limits[1])
        figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
        return figure


def error_over_distance(distance, errors, limit=1.0, published=None):
    """Draw the root mean square error of many runs over the distance from the origin.

    Parameters
    ----------
    distance : ndarray, shape (K,)
        True distance in m.
    errors : dict of str to ndarray, shape (runs, K)
        Position errors in m by label; NaN where there is no estimate.
    limit : float
        Error above which a position is called useless.
    published : float, optional
        Distance up to which the thesis calls its estimates useful.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with styled(7.0, 3.6) as figure:
        ax = figure.subplots()
        styles = [(MEASURED, "-"), (OURS, "-"), (ORANGE, "--"), (SENSOR, "-."), (PINK, ":"),
                  (TRUTH, (0, (6, 2)))]  # fmt: skip
        for (label, error), (color, ls) in zip(errors.items(), styles, strict=False):
            rms = np.sqrt(np.nanmean(np.square(error), axis=0))
            ax.plot(distance, rms, color=color, ls=ls, label=label)
        ax.axhline(limit, color=BOUND, lw=1.0)
        if published is not None:
            ax.axvline(published, color=PUBLISHED, ls=":", label="useful to here, says the thesis")
        ax.set(xlabel="distance from the origin in m", ylabel="RMS position error in m")
        ax.set(yscale="log", ylim=(1e-3, 100))
        ax.legend(loc="upper left", fontsize=9)
        return figure
