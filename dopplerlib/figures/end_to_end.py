"""Figures of the chapter on the whole chain: time stamps, error budget, length of the start."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from .._hints import Array
from ..evaluation.intervals import ConfidenceInterval
from .style import BOUND, ORANGE, OURS, PINK, SENSOR, TRUTH, drawing


@drawing(7.0, 2.6)
def when(figure: Figure, delay: float, window: float) -> None:
    """Draw the time to which a window of samples belongs, and the delay since.

    delay: Group delay of the low-pass in s.
    window: Length of the window in s.
    """
    ax = figure.subplots()
    d, w = 1e3 * delay, 1e3 * window
    for y, left, color, text in (
        (2.0, -w - d, TRUTH, "what the target did"),
        (1.0, -w, OURS, "samples after the low-pass"),
    ):
        ax.barh(y, w, left=left, height=0.5, color=color, alpha=0.25, ec=color)
        ax.text(left - 0.4, y, text, ha="right", va="center", color=color)
    ax.plot([-w / 2 - d] * 2, [0.15, 2.25], color=SENSOR, lw=1.6)
    ax.plot([0, 0], [0.15, 2.25], color=TRUTH, lw=1.6, ls="--")
    ax.text(-w / 2 - d, 2.36, "the shift belongs here", ha="center", color=SENSOR)
    ax.text(0.3, 2.36, "now: it is known", ha="center", color=TRUTH)
    for left, right, y, text in (
        (-w / 2, 0, 0.25, "half a window"),
        (-w / 2 - d, -w / 2, 0.25, "delay"),
    ):
        ax.annotate("", (right, y), (left, y), arrowprops={"arrowstyle": "<->", "color": BOUND})
        ax.text((left + right) / 2, y - 0.12, text, ha="center", va="top", fontsize=8.5)
    ax.plot([-w / 2] * 2, [0.15, 1.25], color=BOUND, lw=0.8, ls=":")
    ax.set(xlabel="time before now (ms)", ylim=(-0.35, 2.75), yticks=[])
    ax.set_xlim(-1.85 * w - d, 0.22 * w)
    ticks = np.arange(0, w + d + 1, 10)
    ax.set_xticks(-ticks, [f"{tick:.0f}" for tick in ticks])
    for side in ("left", "right", "top"):
        ax.spines[side].set_visible(False)


@drawing()
def budget(
    figure: Figure,
    rows: Sequence[tuple[str, Sequence[ConfidenceInterval], Sequence[float]]],
    moments: Sequence[float],
) -> None:
    """Draw position errors of many settings, one row each.

    rows: Name, the median with its interval in m for each moment, and the quantile of 90 % there.
        An empty name leaves a gap.
    moments: The moments in s.
    """
    figure.set_size_inches(7.0, 0.5 + 0.27 * len(rows))
    axes = figure.subplots(1, len(moments), sharey=True, sharex=True)
    y = np.arange(len(rows))
    named = [i for i in y if rows[i][0]]
    for j, (ax, moment) in enumerate(zip(axes, moments, strict=True)):
        for i in named:
            _, medians, worse = rows[i]
            m = medians[j]
            ax.plot([1e3 * m.low, 1e3 * m.high], [i, i], color=OURS, lw=4, alpha=0.45)
            ax.plot(1e3 * m.value, i, "o", color=OURS, ms=4.5)
            ax.plot(1e3 * worse[j], i, "|", color=TRUTH, ms=9, mew=1.4)
        reference = 1e3 * rows[named[0]][1][j].value
        ax.axvline(reference, color=BOUND, lw=0.8, ls=":")
        ax.set(xscale="log", xlabel="position error (mm)", title=f"at {moment:g} s")
        ax.grid(axis="y", visible=False)
    axes[0].set_yticks(named, [rows[i][0] for i in named])
    axes[0].set_ylim(len(rows) - 0.4, -0.6)
    axes[0].xaxis.set_major_formatter(lambda value, _: f"{value:g}")


@drawing(7.0, 3.2)
def wrong_time(
    figure: Figure,
    time: Array,
    nis: Sequence[Sequence[ConfidenceInterval]],
    nees: Sequence[Sequence[ConfidenceInterval]],
    labels: Sequence[str],
) -> None:
    """Draw averages of NIS and of NEES over time, with their intervals, for right and wrong times.

    time (K,): Time in s.
    nis, nees: Averages over runs, one list of K for each label.
    labels: What the times are.
    """
    styles = ((OURS, "-", 3.2), (ORANGE, "--", 1.5), (PINK, ":", 1.8))
    left, right = figure.subplots(1, 2)
    for ax, values, name in ((left, nis, "NIS"), (right, nees, "NEES")):
        for i, (label, each) in enumerate(zip(labels, values, strict=True)):
            color, ls, lw = styles[i]
            ax.plot(time, [e.value for e in each], color=color, ls=ls, lw=lw, label=label)
            if each not in values[:i]:  # equal bands on top of each other would mix colors
                ends = [e.low for e in each], [e.high for e in each]
                ax.fill_between(time, *ends, color=color, alpha=0.2, lw=0)
        ax.axhline(6, color=BOUND, lw=0.9)
        ax.set(xlabel="time (s)", ylabel=f"mean {name}")
    left.set_ylim(0, 12)
    right.set_yscale("log")
    left.text(time[-1], 6.2, "expected: 6", color=BOUND, ha="right", fontsize=8.5)
    handles, names = left.get_legend_handles_labels()
    figure.legend(handles, names, loc="outside upper center", ncols=len(names))


@drawing(7.0, 3.3)
def starts(
    figure: Figure,
    lengths: Sequence[float],
    errors: dict[str, Sequence[Array]],
    shares: dict[str, Sequence[ConfidenceInterval]],
    limit: float,
) -> None:
    """Draw errors after starts of different length, and the fraction that fails.

    lengths: Time until the start in s.
    errors (runs,): Position errors in m, for each length.
    shares: Shares of runs whose error is above `limit`.
    limit: In m.
    """
    left, right = figure.subplots(1, 2)
    shift = {name: 1.05 ** (2 * i - 1) for i, name in enumerate(errors)}
    for (name, groups), color, marker in zip(
        errors.items(), (ORANGE, OURS), ("s", "o"), strict=False
    ):
        for length, group in zip(lengths, groups, strict=True):
            x = 1e3 * length * shift[name]
            low, middle, high = 1e3 * np.quantile(group, [0.1, 0.5, 0.9])
            left.plot([x, x], [low, high], color=color, lw=1.5)
            left.plot(x, middle, marker, color=color, ms=5)
        left.plot([], [], marker + "-", color=color, ms=5, label=name)
        x = 1e3 * np.array(lengths) * shift[name]
        for place, share in zip(x, shares[name], strict=True):
            right.plot([place, place], [100 * share.low, 100 * share.high], color=color, lw=1.5)
            right.plot(place, 100 * share.value, marker, color=color, ms=5)
    for ax in (left, right):
        ax.set(xscale="log", xlabel="record of the start (ms)")
        ax.set_xticks([1e3 * length for length in lengths], labels=_ms(lengths))
        ax.minorticks_off()
    left.axhline(1e3 * limit, color=BOUND, lw=0.9, ls=":")
    left.set(yscale="log", ylabel="position error (mm)")
    left.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    right.set(ylabel=f"runs off by more than {100 * limit:g} cm (%)", ylim=(-3, 103))
    figure.legend(loc="outside upper center", ncols=2)


@drawing(7.0, 3.0)
def achievable(
    figure: Figure,
    levels: Sequence[float],
    medians: Sequence[ConfidenceInterval],
    bounds: dict[str, Sequence[float]],
) -> None:
    """Draw position errors over the strength of the echo.

    levels: Power of the echo over the noise in 1 Hz, in dB.
    medians: Median errors in m with their intervals, for each level.
    bounds: Medians in m that each bound would allow, for each level; two bounds at most.
    """
    ax = figure.subplots()
    styles = ((BOUND, "--"), (BOUND, ":"))
    for (name, bound), (color, ls) in zip(bounds.items(), styles, strict=False):
        ax.plot(levels, 1e3 * np.asarray(bound), color=color, ls=ls, lw=1.5, label=name)
    for x, m in zip(levels, medians, strict=True):
        ax.plot([x, x], [1e3 * m.low, 1e3 * m.high], color=OURS, lw=1.8)
    values = [1e3 * m.value for m in medians]
    ax.plot(levels, values, "o", color=OURS, ms=5, label="from IQ samples")
    ax.set(yscale="log", xlabel=r"echo over noise, $C/N_0$ (dB Hz)", xticks=levels)
    ax.set(ylabel="median position error (mm)")
    ax.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    figure.legend(loc="outside upper center", ncols=3)


def _ms(lengths):
    return [f"{1e3 * length:.0f}" for length in lengths]
