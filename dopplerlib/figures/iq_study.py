"""How well a frequency can be estimated: thresholds, bias, windows, overlap."""

import numpy as np

from .style import BOUND, ORANGE, OURS, PINK, SENSOR, TRUTH, styled

_STYLES = (
    (OURS, "-", "o"),
    (ORANGE, "--", "s"),
    (PINK, "-.", "^"),
    (SENSOR, ":", "D"),
    ("#56B4E9", "-", "v"),
    (TRUTH, "--", "x"),
    ("#8C6D1F", "-.", "+"),
    ("#7A3E9D", ":", "*"),
)


def _bars(ax, x, estimates, scale=1.0, **look):
    """Draw estimates and their intervals."""
    value, low, high = (
        np.array([getattr(e, end) for e in estimates]) * scale for end in ("value", "low", "high")
    )
    (line,) = ax.plot(x, value, **look)
    ax.vlines(x, low, high, color=line.get_color(), lw=1.2)


def outliers(estimates, truth):
    """Draw where estimates fall, on a logarithmic axis, for several ratios of signal to noise.

    Parameters
    ----------
    estimates : dict of str to ndarray, shape (runs,)
        Frequencies in Hz, by label.
    truth : float
        True frequency in Hz.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with styled(7.0, 2.8) as figure:
        axes = figure.subplots(1, len(estimates), sharex=True, sharey=True)
        largest = max(np.abs(f).max() for f in estimates.values())
        edges = np.linspace(-largest, largest, 62) / 1e3
        for ax, (label, f) in zip(axes, estimates.items(), strict=True):
            ax.hist(f / 1e3, bins=edges, color=OURS, log=True)
            ax.plot(truth / 1e3, 1.5 * len(f), "v", color=TRUTH, ms=5)
            ax.set(title=label, xlabel="estimate in kHz")
        axes[0].set_ylabel("number of windows")
        return figure


def threshold(race, names, predicted, law):
    """Draw errors and outliers against the signal-to-noise ratio, with bound and law.

    Parameters
    ----------
    race : Race
        From `saved_race` of ``systems.mittermaier2016``.
    names : sequence of str
        Estimators that are drawn.
    predicted : ndarray, shape (L,)
        Root-mean-square error in Hz that bound and outliers give together.
    law : ndarray, shape (L,)
        Predicted share of outliers.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with styled(7.0, 6.2) as figure:
        top, low = figure.subplots(2, 1, sharex=True, height_ratios=(1.5, 1))
        top.plot(race.snr_db, race.bound, color=BOUND, lw=5, alpha=0.35, label="bound")
        top.plot(race.snr_db, predicted, color=BOUND, lw=1.2, ls=":", label="bound with outliers")
        low.plot(race.snr_db, law, color=BOUND, lw=1.2, ls=":")
        for name, (color, ls, marker) in zip(names, _STYLES, strict=False):
            look = {"color": color, "ls": ls, "marker": marker, "ms": 3.5, "lw": 1.2}
            _bars(top, race.snr_db, race.ratio[name], race.bound, label=name, **look)
            seen = [k for k, e in enumerate(race.outliers[name]) if e.value > 0]
            _bars(low, race.snr_db[seen], [race.outliers[name][k] for k in seen], **look)
        low.axhline(0.01, color=TRUTH, lw=0.8)
        low.text(race.snr_db[-1], 0.012, "1 %", color=TRUTH, ha="right")
        top.set(yscale="log", ylabel="root-mean-square error in Hz")
        low.set(
            yscale="log", ylim=(0.5 / race.windows, 1.5), ylabel="share of outliers",
            xlabel="signal-to-noise ratio of a sample in dB",
        )  # fmt: skip
        top.legend(ncols=2)
        return figure


def bias(fraction, biases):
    """Draw the bias of estimators over where the tone lies between two bins.

    Parameters
    ----------
    fraction : ndarray, shape (M,)
        Distance from the nearest bin, in bins.
    biases : dict of str to ndarray, shape (M,)
        Absolute errors without noise, in bins, by label.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with styled(7.0, 3.4) as figure:
        ax = figure.subplots()
        for (label, error), (color, ls, marker) in zip(biases.items(), _STYLES, strict=False):
            ax.plot(fraction, np.where(error > 1e-12, error, np.nan), color=color, ls=ls,
                    marker=marker, ms=3.5, markevery=8, lw=1.2, label=label)  # fmt: skip
        ax.set(
            yscale="log", xlabel="tone's distance from the nearest bin, in bins",
            ylabel="bias in bins",
        )  # fmt: skip
        ax.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
        return figure


def best_window(T, errors, laws, limit):
    """Draw errors against the length of the window, measured and predicted, for both tags.

    Parameters
    ----------
    T : ndarray, shape (M,)
        Lengths in s.
    errors : dict of str to list of ConfidenceInterval, length M
        Measured root-mean-square errors in Hz, by tag.
    laws : dict of str to tuple (ndarray, shape (L,), ndarray, shape (L,), float)
        For each tag lengths in s, predicted errors in Hz, and the best length in s.
    limit : float
        Deviation in Hz that is wanted.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with styled(7.0, 3.6) as figure:
        ax = figure.subplots()
        looks = zip(errors.items(), laws.values(), (PINK, OURS), ("s", "o"), ("--", "-"),
                    strict=True)  # fmt: skip
        for (tag, error), (length, law, best), color, marker, ls in looks:
            ax.plot(1e3 * length, law, color=color, ls=ls, label=f"tag at the {tag}, law")
            _bars(ax, 1e3 * T, error, color=color, ls="", marker=marker, ms=4, label="measured")
            ax.plot(1e3 * best, np.interp(best, length, law), "*", color=color, ms=15, mec="white",
                    label="best window")  # fmt: skip
        ax.axhline(limit, color=TRUTH, lw=1, ls=":", label=f"{limit:g} Hz")
        ax.set(
            xscale="log", yscale="log", xlabel="length of the window in ms",
            ylabel="root-mean-square error in Hz",
        )  # fmt: skip
        ax.set_xticks([2, 5, 10, 20, 50], ["2", "5", "10", "20", "50"])
        ax.tick_params(axis="x", which="minor", labelbottom=False)
        ax.legend(ncols=2)
        return figure


def overlap(tau, law, lag, measured):
    """Draw the correlation of the errors of overlapping windows.

    Parameters
    ----------
    tau, law : ndarray, shape (M,)
        Distance of the windows over their length, and the closed form.
    lag : ndarray, shape (L,)
        Distances at which it was measured.
    measured : list of ConfidenceInterval, length L
        The results.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with styled(7.0, 3.0) as figure:
        ax = figure.subplots()
        ax.axhline(0, color=BOUND, lw=0.8)
        ax.plot(tau, law, color=BOUND, lw=4, alpha=0.5, label=r"$1 - 3\tau + 2\tau^3$")
        _bars(ax, lag, measured, color=OURS, ls="", marker="o", ms=4, label="measured")
        ax.set(
            xlabel=r"distance of the windows over their length, $\tau$",
            ylabel="correlation of the errors",
        )  # fmt: skip
        ax.legend()
        return figure


def colored(lag, autocorrelation, belief):
    """Draw the memory of innovations, and errors against what the filter believes.

    Parameters
    ----------
    lag : ndarray, shape (L,)
        Lags in steps.
    autocorrelation : dict of str to list of ConfidenceInterval, length L
        Of the innovations, by label.
    belief : dict of str to tuple (ConfidenceInterval, ConfidenceInterval)
        For the same labels, mean NIS and mean NEES.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with styled(7.0, 3.2) as figure:
        left, right = figure.subplots(1, 2, width_ratios=(1.4, 1))
        left.axhline(0, color=BOUND, lw=0.8)
        for (label, value), (color, ls, marker) in zip(
            autocorrelation.items(), _STYLES, strict=False
        ):
            look = {"color": color, "ls": ls, "marker": marker, "ms": 3.5, "lw": 1.2}
            _bars(left, lag, value, label=label, **look)
        left.set(xlabel="lag in steps", ylabel="autocorrelation of the innovations")
        left.legend()
        right.axhline(1, color=BOUND, lw=4, alpha=0.4)
        for i, ((nis, nees), (color, _, _)) in enumerate(
            zip(belief.values(), _STYLES, strict=False)
        ):
            _bars(right, [i - 0.15], [nis], color=color, marker="o", ms=7, mfc="white", mew=2)
            _bars(right, [i + 0.15], [nees], color=color, marker="D", ms=5)
        right.plot([], [], "o", color=TRUTH, mfc="white", mew=2, label="mean NIS")
        right.plot([], [], "D", color=TRUTH, label="mean NEES")
        right.set(yscale="log", xticks=range(len(belief)), xlim=(-0.6, len(belief) - 0.4))
        right.set_ylabel("mean, 1 is consistent")
        names = ["\n".join(label.split(" ", 1)) for label in belief]
        right.set_xticklabels(names, fontsize=8)
        right.legend(loc="upper left")
        values = [estimate.value for pair in belief.values() for estimate in pair]
        right.set_ylim(0.6 * min(values), 2.5 * max(values))
        return figure
