"""Figures of what is given: two radars, the tracks, the noise, and the way to a position."""

import numpy as np
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch

from .style import BOUND, ORANGE, OURS, SENSOR, TRUTH, styled


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
