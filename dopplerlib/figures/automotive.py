"""An automotive target: its scheme, its tracks, and how far they can be trusted."""

import numpy as np

from .style import BOUND, ORANGE, OURS, PUBLISHED, SENSOR, TRUTH, VARIANTS, styled

KMH = 3.6  # km/h for each m/s
SETTINGS = {
    "sigma_p": r"position noise $\sigma_p$ in m",
    "sigma_v": r"velocity noise $\sigma_v$ in m/s",
    "w": "velocity step $w$ of the filter in m/s",
}


def scheme(blocks):
    """Draw a processing scheme as boxes in a row, with what goes in and out of each.

    Parameters
    ----------
    blocks : sequence of tuple (name, what comes out)
        From the first to the last; an empty name gives the input.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with styled(7.0, 2.6) as figure:
        ax = figure.subplots()
        columns = 3
        for i, (name, out) in enumerate(blocks):
            row, column = divmod(i, columns)
            way = 1 if row % 2 == 0 else -1  # every other row runs back
            x, y = 1.1 * (column if way > 0 else columns - 1 - column), -row
            ax.text(
                x, y, name, ha="center", va="center", fontsize=9.5,
                bbox={"boxstyle": "round,pad=0.5", "fc": "#E8F1F8", "ec": OURS},
            )  # fmt: skip
            ax.text(x, y - 0.33, out, ha="center", va="center", fontsize=8.5, color="#555555")
            if i + 1 < len(blocks):
                ends = ((x + 0.42 * way, y), (x + 0.68 * way, y))
                if column == columns - 1:
                    ends = ((x, y - 0.43), (x, y - 0.75))
                ax.annotate("", ends[1], ends[0], arrowprops={"arrowstyle": "->", "color": BOUND})
        ax.set(xlim=(-0.55, 2.75), ylim=(-1.45, 0.3))
        ax.axis("off")
        return figure


def scene(stages, truth):
    """Draw detections and tracks from above, one panel for each stage.

    Parameters
    ----------
    stages : dict of str to dict of str to ndarray, shape (..., 2)
        For each title and each label, positions [x, y] in m. Labels that begin with "track" are
        drawn as lines, and named once.
    truth : ndarray, shape (K, 4)
        True states of the target.

    Returns
    -------
    matplotlib.figure.Figure
    """
    dots = {"target": OURS, "stands still": BOUND, "false alarm": ORANGE, "object": SENSOR}
    with styled(7.0, 3.8) as figure:
        axes = figure.subplots(1, len(stages), sharex=True, sharey=True, squeeze=False)[0]
        for ax, (title, groups) in zip(axes, stages.items(), strict=True):
            named = False
            for label, xy in groups.items():
                if label.startswith("track"):
                    ax.plot(*xy.T, color=PUBLISHED, lw=1.6, label=None if named else "track")
                    named = True
                else:
                    ax.plot(*xy.T, ".", ms=2, color=dots[label], alpha=0.5, label=label)
            ax.plot(truth[:, 0], truth[:, 2], color=TRUTH, ls="--", lw=1, label="truth")
            ax.plot(0, 0, "^", color=TRUTH, ms=7)
            ax.set(title=title, xlabel="x in m")
            ax.legend(loc="upper left", fontsize=8, markerscale=3, framealpha=0.9, frameon=True)
        axes[0].set(ylabel="y in m", ylim=(-2, 85))
        return figure


def three_panels(time, runs, run=0):
    """Draw position and both speeds as in Figs 7 to 11: measurements, truth, estimate.

    Parameters
    ----------
    time : ndarray, shape (K,)
        Time in s.
    runs : Runs
        From `track`; one of the runs is drawn, and the range of all for the speeds.
    run : int
        Which run.

    Returns
    -------
    matplotlib.figure.Figure
    """
    truth, z, x = runs.path.truth, runs.z[run], runs.x[run]
    with styled(7.0, 2.7) as figure:
        axes = figure.subplots(1, 3)
        for ax, part in zip(axes, ((0, 2), (1,), (3,)), strict=True):
            if len(part) == 2:
                lines = [(one[:, 0], one[:, 2]) for one in (z, truth, x)]
                ax.set(xlabel="x in m", ylabel="y in m", title="a")
                ax.margins(x=0.25)
            else:
                (i,) = part
                lines = [(time, KMH * one[:, i]) for one in (z, truth, x)]
                band = KMH * np.quantile(runs.x[:, 1:, i], [0.025, 0.975], axis=0)
                ax.fill_between(time[1:], *band, color=OURS, alpha=0.25, lw=0)
                name = {1: "$v_x$", 3: "$v_y$"}[i]
                ax.set(xlabel="time in s", ylabel=f"{name} in km/h", title={1: "b", 3: "c"}[i])
                middle = (KMH * truth[:, i].max() + KMH * truth[:, i].min()) / 2
                half = max(5, 0.8 * KMH * np.ptp(truth[:, i]))
                ax.set_ylim(middle - half, middle + half)
            ax.plot(*lines[0], "x", color=BOUND, ms=2.5, mew=0.5, alpha=0.6, label="measured")
            ax.plot(*lines[2], color=OURS, lw=1.4, label="estimate")
            ax.plot(*lines[1], color=TRUTH, ls="--", lw=1.2, label="truth")
        axes[1].legend(loc="upper left", fontsize=8, framealpha=0.9, frameon=True)
        return figure


def claim_map(rows, columns, shares, settings):
    """Draw in how many runs claims hold, over two settings.

    Parameters
    ----------
    rows, columns : tuple (str, sequence of float)
        Name and values of a setting, as `regions.claim_map` takes them.
    shares : dict of str to ndarray, shape (rows, columns)
        Share of the runs for each claim.
    settings : Settings
        Our choice, to be marked.

    Returns
    -------
    matplotlib.figure.Figure
    """
    (row, heights), (column, widths) = rows, columns
    x, y = widths.index(getattr(settings, column)), heights.index(getattr(settings, row))
    with styled(7.0, 5.2) as figure:
        axes = figure.subplots(2, 2, sharex=True, sharey=True)
        for ax, (title, share) in zip(axes.ravel(), shares.items(), strict=True):
            ax.imshow(share, origin="lower", aspect="auto", cmap="cividis", vmin=0, vmax=1)
            for (i, j), value in np.ndenumerate(share):
                color = "black" if value > 0.6 else "white"
                ax.text(j, i, f"{100 * value:.0f}", ha="center", va="center", color=color, size=8)
            ax.plot(x, y, "s", mfc="none", mec=PUBLISHED, ms=20, mew=2)
            ax.grid(False)
            ax.set_xticks(range(len(widths)), [f"{one:g}" for one in widths])
            ax.set_yticks(range(len(heights)), [f"{one:g}" for one in heights])
            ax.set_title(title)
        for ax in axes[-1]:
            ax.set_xlabel(SETTINGS[column])
        for ax in axes[:, 0]:
            ax.set_ylabel(SETTINGS[row])
        return figure


def lags(w, predicted, noise, measured):
    """Draw what is left of an acceleration and of the noise, over the agility of the filter.

    Parameters
    ----------
    w : ndarray, shape (M,)
        Velocity steps of the filter in m/s.
    predicted : ndarray, shape (M, 2)
        Predicted lag of position in m and speed in m/s.
    noise : ndarray, shape (M, 2)
        Predicted deviation by noise.
    measured : dict of float to tuple of two Estimate
        For some w, the mean error of position and speed in many runs.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with styled(7.0, 3.2) as figure:
        for i, ax in enumerate(figure.subplots(1, 2)):
            ax.plot(w, predicted[:, i], color=OURS, label="lag, predicted")
            ax.plot(w, noise[:, i], color=ORANGE, ls="--", label="noise, predicted")
            both = np.hypot(predicted, noise)[:, i]
            ax.plot(w, both, color=BOUND, ls=":", label="both")
            points = [pair[i] for pair in measured.values()]
            middle = np.array([one.value for one in points])
            ends = np.array([[one.value - one.low, one.high - one.value] for one in points]).T
            ax.errorbar(
                list(measured), middle, yerr=ends, fmt="o", color=PUBLISHED, ms=4, capsize=3,
                label="mean error of the runs",
            )  # fmt: skip
            ax.set(xscale="log", yscale="log", xlabel="velocity step $w$ in m/s")
            ax.set_ylabel(("position in m", "speed in m/s")[i])
            ax.set_ylim(0.004, None)
        ax.legend(loc="lower left", fontsize=8.5)
        return figure


def nis_and_nees(time, averages, intervals):
    """Draw the average NIS and NEES of several paths.

    Parameters
    ----------
    time : ndarray, shape (K,)
        Time in s.
    averages : dict of str to tuple of two ndarray, shape (K,)
        For each path, averages over the runs of NIS and NEES.
    intervals : tuple of two pairs of float
        Where the averages of a consistent filter lie.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with styled(7.0, 3.2) as figure:
        axes = figure.subplots(1, 2, sharey=True)
        for i, (ax, name) in enumerate(zip(axes, ("NIS", "NEES"), strict=True)):
            ax.axhspan(*intervals[i], color=BOUND, alpha=0.4, lw=0, label="consistent")
            for (label, pair), (color, ls) in zip(averages.items(), VARIANTS, strict=False):
                ax.plot(time, pair[i], color=color, ls=ls, lw=1.1, label=label)
            ax.set(xlabel="time in s", ylabel=f"average {name}", yscale="log")
        axes[0].legend(loc="upper right")
        return figure


def side_by_side(time, truth, tracks, limits=None):
    """Draw the path and the speed along x, as several filters see them.

    Parameters
    ----------
    time : ndarray, shape (K,)
        Time in s.
    truth : ndarray, shape (K, 4)
        True states.
    tracks : dict of str to ndarray, shape (runs, K, 4)
        Estimates of each filter; some runs are drawn.
    limits : tuple of float, optional
        Limits of the y axis of the path in m.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with styled(7.0, 3.2) as figure:
        left, right = figure.subplots(1, 2)
        for (label, x), color in zip(tracks.items(), (OURS, PUBLISHED, ORANGE), strict=False):
            for i, one in enumerate(x[:10]):
                name = label if i == 0 else None
                left.plot(one[:, 0], one[:, 2], color=color, lw=0.7, alpha=0.7, label=name)
                right.plot(time, KMH * one[:, 1], color=color, lw=0.7, alpha=0.7, label=name)
        left.plot(truth[:, 0], truth[:, 2], color=TRUTH, ls="--", label="truth")
        right.plot(time, KMH * truth[:, 1], color=TRUTH, ls="--", label="truth")
        left.set(xlabel="x in m", ylabel="y in m")
        if limits is not None:
            left.set_ylim(*limits)
        right.set(xlabel="time in s", ylabel="$v_x$ in km/h")
        left.legend(loc="best")
        return figure


def hole(time, rates, v_min, deviations):
    """Draw the range rates that a clutter rule looks at, and what its hole does to a track.

    Parameters
    ----------
    time : ndarray, shape (K,)
        Time in s.
    rates : dict of str to ndarray, shape (K,)
        Range rate of each path in m/s.
    v_min : float
        Range rate below which a detection is deleted, in m/s.
    deviations : dict of str to ndarray, shape (K,)
        For each way to use the rule, the root mean square position error in m.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with styled(7.0, 3.2) as figure:
        left, right = figure.subplots(1, 2)
        left.axhspan(-v_min, v_min, color=BOUND, alpha=0.3, lw=0, label="deleted")
        for (label, rate), (color, ls) in zip(rates.items(), VARIANTS, strict=False):
            left.plot(time, rate, color=color, ls=ls, label=label)
        left.set(xlabel="time in s", ylabel="range rate in m/s")
        left.legend(loc="best")
        for (label, error), (color, ls) in zip(deviations.items(), VARIANTS, strict=False):
            right.plot(time[1:], error[1:], color=color, ls=ls, label=label)
        right.set(xlabel="time in s", ylabel="position error in m, rms", yscale="log")
        right.legend(loc="best")
        return figure


def over_time(time, errors, shaded, ylabel, mode=None):
    """Draw the root mean square error of several estimators over time.

    Parameters
    ----------
    time : ndarray, shape (K,)
        Time in s.
    errors : dict of str to ndarray, shape (K,)
        Error of each estimator.
    shaded : ndarray of bool, shape (K,)
        When the target turns.
    ylabel : str
        Name and unit of the error.
    mode : ndarray, shape (K,), optional
        Probability of the agile model, drawn below.

    Returns
    -------
    matplotlib.figure.Figure
    """
    rows = 1 if mode is None else 2
    ratios = [1] if mode is None else [3, 1]
    with styled(7.0, 3.0 + 1.2 * (rows - 1)) as figure:
        axes = figure.subplots(rows, 1, sharex=True, squeeze=False, height_ratios=ratios)[:, 0]
        for ax in axes:
            if shaded.any():
                ax.axvspan(*time[shaded][[0, -1]], color=BOUND, alpha=0.2, lw=0)
        for (label, error), (color, ls) in zip(errors.items(), VARIANTS, strict=False):
            axes[0].plot(time, error, color=color, ls=ls, label=label)
        axes[0].set(ylabel=ylabel, yscale="log")
        axes[0].legend(loc="upper left", ncols=2, fontsize=8.5)
        if mode is not None:
            axes[1].plot(time, mode, color=OURS)
            axes[1].set(ylabel="agile model", ylim=(0, 1))
        axes[-1].set_xlabel("time in s")
        return figure


def crossings(truth, estimates, shares, angles):
    """Draw two who cross, and how often their tracks come out wrong.

    Parameters
    ----------
    truth : ndarray, shape (2, K, 4)
        True states.
    estimates : ndarray, shape (2, K, 4)
        Estimates of one run.
    shares : dict of str to list of Estimate
        For each label, the share of the runs at each angle.
    angles : sequence of float
        In degrees.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with styled(7.0, 3.2) as figure:
        left, right = figure.subplots(1, 2)
        for one, color in zip(estimates, (OURS, PUBLISHED), strict=True):
            left.plot(one[:, 0], one[:, 2], color=color, lw=1.3)
        for one in truth:
            left.plot(one[:, 0], one[:, 2], color=TRUTH, ls="--", lw=1)
        left.set(xlabel="x in m", ylabel="y in m", title="one run, Hungarian")
        for (label, share), (color, ls) in zip(shares.items(), VARIANTS, strict=False):
            middle = np.array([one.value for one in share])
            ends = np.array([[one.value - one.low, one.high - one.value] for one in share]).T
            right.errorbar(
                angles, middle, yerr=ends, color=color, ls=ls, marker="o", ms=3.5, capsize=3,
                label=label,
            )  # fmt: skip
        right.set(xlabel="angle between the paths in degrees", ylabel="share of the runs")
        right.set_ylim(-0.03, 1.03)
        right.legend(loc="upper right")
        return figure
