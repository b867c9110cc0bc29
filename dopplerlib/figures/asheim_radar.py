"""Figures of one radar: its ranges, what its filter makes of them, and when the track is left."""

import numpy as np

from .style import BOUND, MEASURED, ORANGE, OURS, PUBLISHED, SENSOR, TRUTH, styled


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
        whole.axvspan(*zoom, color=BOUND, alpha=0.25, lw=0)
        whole.legend()
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
