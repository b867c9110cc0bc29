"""Adaptive windows and fused filters in pictures: the figures of the document, and its limits."""

import numpy as np

from .style import BOUND, OURS, TRUTH, VARIANTS, styled

# The color of algorithms 1 to 6, and a line and a mark for print in gray.
_STYLES = {
    1: ("#777777", "-", "o"),
    2: ("#E69F00", "--", "s"),
    3: ("#222222", ":", "v"),
    4: ("#CC79A7", "-.", "D"),
    5: ("#009E73", "--", "^"),
    6: ("#0072B2", "-", "X"),
}


def paths(several):
    """Draw courses of velocity.

    Parameters
    ----------
    several : sequence of VelocityPath
        To draw, each with its name.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with styled(7.0, 2.8) as figure:
        ax = figure.subplots()
        for path, (color, line) in zip(several, VARIANTS, strict=False):
            ax.plot(path.time, path.v, color=color, ls=line, label=path.name)
        ax.set(xlabel="time (s)", ylabel="velocity (m/s)", ylim=(0, None))
        ax.legend()
        return figure


def window_error(table, snr_db):
    """Draw the cumulative error over the window, a line for each acceleration: Fig 3.

    Parameters
    ----------
    table : WindowTable
        Of a simulation.
    snr_db : float
        One of its signal-to-noise ratios.

    Returns
    -------
    matplotlib.figure.Figure
    """
    j = int(np.flatnonzero(table.snrs_db == snr_db)[0])
    shades = np.linspace(0.75, 0.0, len(table.accelerations))
    with styled(7.0, 3.4) as figure:
        ax = figure.subplots()
        for a, cee, shade in zip(table.accelerations, table.cee[:, j], shades, strict=True):
            color = (shade * 0.8, 0.3 + 0.5 * shade, 0.55 + 0.35 * shade)
            ax.plot(table.windows, cee, color=color)
            best = int(np.argmin(cee))
            ax.plot(table.windows[best], cee[best], "o", color=color, ms=6, mec="white")
            ax.annotate(
                f"{a:g} m/s²", (table.windows[-1], cee[-1]), xytext=(5, 0), va="center",
                textcoords="offset points", fontsize=9, annotation_clip=False,
            )  # fmt: skip
        ax.set(xscale="log", yscale="log", xlabel="window (samples)", ylabel="cee")
        ax.set_xticks(table.windows, [str(window) for window in table.windows])
        ax.minorticks_off()
        return figure


def velocities(results, run=0):
    """Draw velocities of sensor 1, sensor 2 and both, fixed window: Figs 7 to 9 and 11 to 13.

    Parameters
    ----------
    results : sequence of AlgorithmRuns
        A row for each.
    run : int
        Which run to draw.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with styled(7.0, 2.5 * len(results) + 0.5) as figure:
        rows = figure.subplots(len(results), 3, sharex=True, sharey="row", squeeze=False)
        for result, axes in zip(results, rows, strict=True):
            panels = (
                ("sensor 1", result.velocity(1, sensor=1)),
                ("sensor 2", result.velocity(1, sensor=2)),
                ("fused", result.velocity(3)),
            )
            window = (result.time > 5.7) & (result.time < 7.0)
            for ax, (name, v) in zip(axes, panels, strict=True):
                ax.plot(result.time, result.truth, color=TRUTH, ls="--", lw=1.2, label="truth")
                ax.plot(result.time, v[run], color=OURS, lw=1.2, label="estimate")
                ax.set_title(f"{result.path.name}, {name}")
                inset = ax.inset_axes([0.3, 0.56, 0.68, 0.42])
                inset.plot(result.time[window], result.truth[window], color=TRUTH, ls="--", lw=1)
                inset.plot(result.time[window], v[run, window], color=OURS, lw=1)
                inset.set(xticks=[], yticks=[])
                inset.grid(False)
            low, high = result.truth.min(), result.truth.max()
            space = 0.05 * (high - low)
            axes[0].set_ylim(low - space, high + 1.4 * (high - low))  # room for the insets
            axes[0].set_yticks(
                np.linspace(low, high, 3), [f"{v:.0f}" for v in np.linspace(low, high, 3)]
            )
            axes[0].set_ylabel("velocity (m/s)")
        for ax in rows[-1]:
            ax.set(xlabel="time (s)", xticks=range(0, 16, 5))
        figure.legend(*rows[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=2)
        return figure


def cumulative_errors(results, lines, ncols=2):
    """Draw the running error of some algorithms, mean over the runs: Figs 10, 14, 15 and 16.

    Parameters
    ----------
    results : sequence of AlgorithmRuns
        A panel for each.
    lines : sequence of sequence of tuple (int, int)
        For each panel, which algorithms, and the filter of which sensor.
    ncols : int
        Panels beside one another.

    Returns
    -------
    matplotlib.figure.Figure
    """
    nrows = -(-len(results) // ncols)
    with styled(7.0, 2.5 * nrows + 0.5) as figure:
        axes = figure.subplots(nrows, ncols, sharex=True, squeeze=False).flat
        for ax, result, shown in zip(axes, results, lines, strict=True):
            time = result.time[result.during("all")]
            for algorithm, sensor in shown:
                color, line, _ = _STYLES[algorithm]
                single = algorithm in (1, 2, 6)
                ax.plot(
                    time, 100 * result.cee(algorithm, sensor).mean(axis=0), color=color, ls=line,
                    alpha=0.55 if sensor == 2 else 1.0,
                    label=f"algorithm {algorithm}" + (f", sensor {sensor}" if single else ""),
                )  # fmt: skip
            ax.set_title(result.path.name)
            ax.set(ylabel="cee (%)", ylim=(0, None), xticks=range(0, 16, 5))
            ax.legend(fontsize=8.5)
        for ax in figure.axes[-ncols:]:
            ax.set_xlabel("time (s)")
        return figure


def sweep(snrs_db, errors, names, failed):
    """Draw errors over the signal-to-noise ratio: of the whole record, in maneuvers, and at rest.

    Parameters
    ----------
    snrs_db : sequence of float
        Signal-to-noise ratios in dB.
    errors : dict of str to dict of (int, str) to ndarray, shape (ratios, runs)
        For each path, what `snr_sweep` returns. Drawn is the root mean square over the runs.
    names : dict of int to str
        Names of the algorithms.
    failed : float
        Error in m/s from which a run has failed.

    Returns
    -------
    matplotlib.figure.Figure
    """
    phases = {"maneuver": "in a maneuver", "constant": "constant velocity"}
    with styled(7.0, 2.7 * len(errors) + 0.7) as figure:
        rows = figure.subplots(len(errors), 2, sharex=True, sharey=True, squeeze=False)
        for (path, found), axes in zip(errors.items(), rows, strict=True):
            for ax, (phase, title) in zip(axes, phases.items(), strict=True):
                for algorithm, name in names.items():
                    color, line, mark = _STYLES[algorithm]
                    rmse = np.sqrt(np.mean(found[algorithm, phase] ** 2, axis=-1))
                    ax.plot(snrs_db, rmse, color=color, ls=line, marker=mark, ms=3.5, label=name)
                ax.axhline(failed, color=BOUND, lw=0.8)
                ax.set_title(f"{path}, {title}")
                ax.set(yscale="log")
            axes[0].set_ylabel("RMSE (m/s)")
        for ax in rows[-1]:
            ax.set_xlabel("signal-to-noise ratio (dB)")
        figure.legend(*rows[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=3)
        return figure


def correlation(measured, law):
    """Draw the autocorrelation of measurement errors beside its closed form.

    Parameters
    ----------
    measured, law : ndarray, shape (lags + 1,)
        From lag 0 on, in samples.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with styled(7.0, 2.8) as figure:
        ax = figure.subplots()
        ax.plot(measured, color=OURS, label="simulation")
        ax.plot(law, color=TRUTH, ls="--", lw=1.2, label="closed form")
        ax.axhline(0, color=BOUND, lw=0.8)
        ax.set(xlabel="lag (samples)", ylabel="autocorrelation", ylim=(-0.6, 1))
        ax.legend()
        return figure
