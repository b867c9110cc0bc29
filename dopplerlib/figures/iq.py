"""Figures of the chapter on IQ samples: the chain, spectra, errors of frequency estimators."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch

from .._hints import Array
from .._typing import ComplexArray
from ..evaluation.frequency_benchmark import FrequencyBenchmark
from ..evaluation.intervals import ConfidenceInterval
from .style import BOUND, MEASURED, ORANGE, OURS, PINK, SENSOR, SKY, TRUTH, drawing

_STYLES = (
    (OURS, "-", "o"),
    (ORANGE, "--", "s"),
    (PINK, "-.", "^"),
    (SENSOR, ":", "D"),
    (SKY, "-", "v"),
    (TRUTH, "--", "x"),
    ("#8C6D1F", "-.", "+"),
    ("#7A3E9D", ":", "*"),
)
# An estimator has one look in all figures; two with the same are never in one.
_ESTIMATORS = {
    "highest bin": _STYLES[0],
    "parabola, padded": _STYLES[1],
    "Jacobsen": _STYLES[2],
    "Quinn 2": _STYLES[3],
    "parabola": _STYLES[3],
    "Aboutanios-Mulgrew": _STYLES[4],
    "maximum likelihood": _STYLES[5],
    "log parabola": _STYLES[5],
    "Kay": _STYLES[6],
    "log parabola, padded": _STYLES[6],
    "pulse pair": _STYLES[7],
    "Candan": _STYLES[7],
}


@drawing(7.0, 2.3)
def chain(figure: Figure, stages: Sequence[str], rates: Sequence[str], per_sensor: int) -> None:
    """Draw the signal chain as boxes, with the rate between them.

    stages: Names of the boxes.
    rates: What each box gives; the last one is the result.
    per_sensor: How many of the boxes exist once for every sensor.
    """
    ax = figure.subplots()
    ax.axis("off")
    ax.set(xlim=(-0.62, len(stages) + 0.05), ylim=(-0.95, 1.1))
    gap = 0.25  # between what is there for each sensor and what is there once
    for depth in (2, 1):  # sheets behind the first boxes: one chain for each sensor
        ax.add_patch(
            FancyBboxPatch(
                (-0.48 + 0.05 * depth, -0.42 + 0.1 * depth), per_sensor - 0.04, 0.9,
                boxstyle="round,pad=0.05", fc="white", ec=SENSOR, lw=1, alpha=0.7,
            )
        )  # fmt: skip
    ax.add_patch(
        FancyBboxPatch(
            (-0.48, -0.42), per_sensor - 0.04, 0.9,
            boxstyle="round,pad=0.05", fc="#EDF7F3", ec=SENSOR, lw=1.2,
        )
    )  # fmt: skip
    ax.text(-0.48, 0.9, "one for each sensor", color=SENSOR, va="bottom")
    for number, (name, rate) in enumerate(zip(stages, rates, strict=True)):
        once = number >= per_sensor
        color, i = (OURS, number + gap) if once else (TRUTH, number)
        step = 1 + gap * (number == per_sensor - 1)
        ax.add_patch(
            FancyBboxPatch(
                (i - 0.36, -0.25), 0.72, 0.55,
                boxstyle="round,pad=0.03", fc="white", ec=color, lw=1.4,
            )
        )  # fmt: skip
        ax.text(i, 0.025, name, ha="center", va="center", fontsize=8.6, color=color)
        ax.add_patch(
            FancyArrowPatch((i + 0.4, 0.02), (i + step - 0.39, 0.02), arrowstyle="-|>",
                            mutation_scale=11, color=BOUND, lw=1.2)
        )  # fmt: skip
        middle = i + step / 2
        ax.plot([middle, middle], [-0.05, -0.6], color=BOUND, lw=0.8, ls=":")
        ax.text(middle, -0.64, rate, ha="center", va="top", fontsize=8.2)


@drawing(7.0, 3.0)
def circle(figure: Figure, time: Array, x: ComplexArray, turn: int) -> None:
    """Draw IQ samples as they run around a circle, and both parts over time.

    time (n,): Time in s.
    x (n,): IQ samples.
    turn: How many samples are drawn in the plane, about one turn.
    """
    plane, trace = figure.subplots(1, 2, width_ratios=(1, 1.5))
    angle = np.linspace(0, 2 * np.pi, 200)
    plane.plot(np.cos(angle), np.sin(angle), color=BOUND, lw=0.8)
    shade = np.linspace(0.15, 1, turn)
    plane.scatter(x[:turn].real, x[:turn].imag, s=14, c=OURS, alpha=shade, zorder=3)
    middle = np.angle(x[turn // 3]) + np.array([0.0, 0.7])
    start, end = (1.32 * np.array([np.cos(a), np.sin(a)]) for a in middle)
    plane.add_patch(
        FancyArrowPatch(start, end, connectionstyle="arc3,rad=0.18", arrowstyle="-|>",
                        mutation_scale=13, color=TRUTH)
    )  # fmt: skip
    plane.set(
        xlabel="I (amplitudes)",
        ylabel="Q (amplitudes)",
        aspect="equal",
        xlim=(-1.6, 1.6),
        ylim=(-1.6, 1.6),
    )
    trace.plot(1e3 * time, x.real, color=OURS, label="I")
    trace.plot(1e3 * time, x.imag, color=ORANGE, ls="--", label="Q")
    trace.set(xlabel="time (ms)", ylabel="I, Q (amplitudes of the echo)", ylim=(-1.6, 2.3))
    trace.legend(ncols=2, loc="upper right")


@drawing(7.0, 3.1)
def peak(
    figure: Figure,
    f: Array,
    power: Array,
    bins: Array,
    bin_power: Array,
    vertex: float,
    truth: float,
) -> None:
    """Draw a spectrum, and its peak with the parabola through three bins.

    f, power (M,): Frequencies in Hz and magnitudes of a finely padded transform.
    bins, bin_power (n,): The same of the unpadded one.
    vertex: Frequency of the parabola's top in Hz.
    truth: True frequency in Hz.
    """
    wide, near = figure.subplots(1, 2)
    top = np.argmax(bin_power)
    three = slice(top - 1, top + 2)
    parabola = np.polynomial.Polynomial.fit(bins[three], bin_power[three], 2)
    width = bins[1] - bins[0]
    for ax in (wide, near):
        ax.plot(f, power, color=BOUND, lw=1.2, label="at any frequency")
        ax.plot(bins, bin_power, "o", color=OURS, ms=4, label="bins of the transform")
        ax.set(xlabel="frequency (Hz)")
    wide.set(ylabel="magnitude (amplitudes)", xlim=(f[0], f[-1]))
    g = np.linspace(bins[top] - 1.3 * width, bins[top] + 1.3 * width, 200)
    near.plot(g, parabola(g), color=ORANGE, ls="--", label="parabola through three")
    near.axvline(truth, color=TRUTH, lw=1, ls=":", label="truth")
    near.plot(vertex, parabola(vertex), "v", color=ORANGE, ms=7)
    near.set(xlim=(g[0] - 0.6 * width, g[-1] + 0.6 * width), ylim=(0, 1.12 * power.max()))
    handles, labels = near.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=4, columnspacing=1.2)


@drawing(7.0, 3.3)
def impairments(figure: Figure, f: Array, spectra: dict[str, Array], truth: float) -> None:
    """Draw spectra of the same record with faults of the receiver and without.

    f (M,): Frequencies in Hz.
    spectra (M,): Powers by label, relative to the echo.
    truth: True frequency in Hz.
    """
    styles = ((MEASURED, "-"), (ORANGE, "--"), (OURS, "-"))
    ax = figure.subplots()
    for (label, power), (color, ls) in zip(spectra.items(), styles, strict=False):
        ax.plot(f, 10 * np.log10(power), color=color, ls=ls, lw=1.2, label=label)
    low, high = -62, 10 * np.log10(max(power.max() for power in spectra.values()))
    for place, text in ((0, "DC offset"), (truth, "echo"), (-truth, "image")):
        ax.text(place, high + 3, text, ha="center", color=TRUTH)
        ax.plot([place, place], [low, high + 2], color=BOUND, lw=0.8, ls=":")
    ax.set(xlabel="frequency (Hz)", ylabel="power (dB relative to the echo)", ylim=(low, high + 9))
    figure.legend(loc="outside upper center", ncols=3)


@drawing(7.0, 3.1)
def tags(
    figure: Figure, time: Array, shift: Array, windows: Array, center: Array, end: Array
) -> None:
    """Draw a changing Doppler shift, and estimates tagged with the center and end of windows.

    time, shift (M,): Time in s and true shift in Hz.
    windows (K, 2): Start and end of each window in s.
    center, end (K,): Errors in Hz if an estimate is read as the shift at the center, and at the
        end.
    """
    left, right = figure.subplots(1, 2)
    left.plot(time, shift, color=TRUTH, label="true shift")
    middle = windows.mean(axis=1)
    estimate = np.interp(middle, time, shift) + center
    for (a, b), f in zip(windows, estimate, strict=True):
        left.plot([a, b], [f, f], color=BOUND, lw=1)
    left.plot(middle, estimate, "o", color=OURS, ms=4, label="estimate, at the center")
    left.plot(windows[:, 1], estimate, "s", color=PINK, ms=4, label="the same, at the end")
    left.set(xlabel="time (s)", ylabel="Doppler shift (Hz)")
    left.legend()
    right.axhline(0, color=BOUND, lw=0.8)
    right.plot(middle, center, "o-", color=OURS, ms=4, label="center")
    right.plot(windows[:, 1], end, "s--", color=PINK, ms=4, label="end")
    right.set(xlabel="time (s)", ylabel="error (Hz)")
    right.legend(title="time stamp at the")


@drawing(7.0, 2.8)
def outliers(figure: Figure, estimates: dict[str, Array], truth: float) -> None:
    """Draw histograms of estimates, on a logarithmic axis, for several signal-to-noise ratios.

    estimates (runs,): Frequencies in Hz, by label.
    truth: True frequency in Hz.
    """
    axes = figure.subplots(1, len(estimates), sharex=True, sharey=True)
    largest = max(np.abs(f).max() for f in estimates.values())
    edges = np.linspace(-largest, largest, 62) / 1e3
    for ax, (label, f) in zip(axes, estimates.items(), strict=True):
        ax.hist(f / 1e3, bins=edges, color=OURS, log=True)
        ax.plot(truth / 1e3, 1.5 * len(f), "v", color=TRUTH, ms=5)
        ax.set(title=label, xlabel="estimate (kHz)")
    axes[0].set_ylabel("number of windows")


@drawing(7.0, 6.2)
def threshold(
    figure: Figure,
    benchmark: FrequencyBenchmark,
    names: Sequence[str],
    predicted: Array,
    law: Array,
) -> None:
    """Draw errors and outliers against the signal-to-noise ratio, with bound and law.

    benchmark: From `saved_benchmark`.
    names: Estimators that are drawn.
    predicted (L,): Root-mean-square error in Hz that bound and outliers give together.
    law (L,): Predicted fraction of outliers.
    """
    top, low = figure.subplots(2, 1, sharex=True, height_ratios=(1.5, 1))
    top.plot(benchmark.snr_db, benchmark.bound, color=BOUND, lw=5, alpha=0.35, label="bound")
    top.plot(benchmark.snr_db, predicted, color=BOUND, lw=1.2, ls=":", label="bound with outliers")
    low.plot(benchmark.snr_db, law, color=BOUND, lw=1.2, ls=":")
    for name in names:
        color, ls, marker = _ESTIMATORS[name]
        look = {"color": color, "ls": ls, "marker": marker, "ms": 3.5, "lw": 1.2}
        _bars(top, benchmark.snr_db, benchmark.ratio[name], benchmark.bound, label=name, **look)
        seen = [k for k, e in enumerate(benchmark.outliers[name]) if e.value > 0]
        _bars(low, benchmark.snr_db[seen], [benchmark.outliers[name][k] for k in seen], **look)
    low.axhline(0.01, color=TRUTH, lw=0.8)
    low.text(benchmark.snr_db[-1], 0.012, "1 %", color=TRUTH, ha="right")
    top.set(yscale="log", ylabel="RMS error (Hz)")
    low.set(
        yscale="log", ylim=(0.5 / benchmark.windows, 1.5), ylabel="fraction of outliers",
        xlabel="SNR of a sample (dB)",
    )  # fmt: skip
    top.legend(ncols=2)


@drawing(7.0, 3.4)
def bias(figure: Figure, fraction: Array, biases: dict[str, Array]) -> None:
    """Draw the bias of estimators over where the tone lies between two bins.

    fraction (M,): Distance from the nearest bin, in bins.
    biases (M,): Absolute errors without noise, in bins, by label.
    """
    ax = figure.subplots()
    for label, error in biases.items():
        color, ls, marker = _ESTIMATORS[label]
        ax.plot(fraction, np.where(error > 1e-12, error, np.nan), color=color, ls=ls,
                marker=marker, ms=3.5, markevery=8, lw=1.2, label=label)  # fmt: skip
    ax.set(
        yscale="log", xlabel="distance from the nearest bin (bins)",
        ylabel="bias (bins)",
    )  # fmt: skip
    ax.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))


@drawing(7.0, 3.6)
def best_window(
    figure: Figure,
    T: Array,
    errors: dict[str, Sequence[ConfidenceInterval]],
    laws: dict[str, tuple[Array, Array, float]],
    limit: float,
) -> None:
    """Draw errors against the length of the window, measured and predicted, for both tags.

    T (M,): Lengths in s.
    errors (M,): Measured root-mean-square errors in Hz, by tag.
    laws (L,): For each tag lengths in s, predicted errors in Hz, and the best length in s.
    limit: Standard deviation in Hz that is wanted.
    """
    ax = figure.subplots()
    looks = zip(errors.items(), laws.values(), (PINK, OURS), ("s", "o"), ("--", "-"),
                strict=True)  # fmt: skip
    for (tag, error), (length, law, best), color, marker, ls in looks:
        ax.plot(1e3 * length, law, color=color, ls=ls, label=f"time stamp at the {tag}, law")
        _bars(ax, 1e3 * T, error, color=color, ls="", marker=marker, ms=4, label="measured")
        ax.plot(1e3 * best, np.interp(best, length, law), "*", color=color, ms=15, mec="white",
                label="best window")  # fmt: skip
    ax.axhline(limit, color=TRUTH, lw=1, ls=":")
    ax.text(1e3 * T[0], 1.05 * limit, f"{limit:g} Hz", va="bottom")
    ax.set(
        xscale="log", yscale="log", xlabel="length of the window (ms)",
        ylabel="RMS error (Hz)",
    )  # fmt: skip
    ax.set_xticks([2, 5, 10, 20, 50], ["2", "5", "10", "20", "50"])
    ax.tick_params(axis="x", which="minor", labelbottom=False)
    figure.legend(loc="outside upper center", ncols=2)


@drawing(7.0, 3.0)
def overlap(
    figure: Figure, tau: Array, law: Array, lag: Array, measured: Sequence[ConfidenceInterval]
) -> None:
    """Draw the correlation of the errors of overlapping windows.

    tau, law (M,): Distance of the windows over their length, and the closed form.
    lag (L,): Distances at which it was measured.
    measured (L,): The results.
    """
    ax = figure.subplots()
    ax.axhline(0, color=BOUND, lw=0.8)
    ax.plot(tau, law, color=BOUND, lw=4, alpha=0.5, label=r"$1 - 3\tau + 2\tau^3$")
    _bars(ax, lag, measured, color=OURS, ls="", marker="o", ms=4, label="measured")
    ax.set(
        xlabel=r"relative distance of the windows $\tau$",
        ylabel="correlation of the errors",
    )  # fmt: skip
    ax.legend()


@drawing(7.0, 3.2)
def colored(
    figure: Figure,
    lag: Array,
    autocorrelation: dict[str, Sequence[ConfidenceInterval]],
    belief: dict[str, tuple[ConfidenceInterval, ConfidenceInterval]],
) -> None:
    """Draw the autocorrelation of innovations, and mean NIS and NEES.

    lag (L,): Lags in steps.
    autocorrelation (L,): Of the innovations, by label.
    belief: For the same labels, mean NIS and mean NEES.
    """
    left, right = figure.subplots(1, 2, width_ratios=(1.4, 1))
    left.axhline(0, color=BOUND, lw=0.8)
    for (label, value), (color, ls, marker) in zip(autocorrelation.items(), _STYLES, strict=False):
        look = {"color": color, "ls": ls, "marker": marker, "ms": 3.5, "lw": 1.2}
        _bars(left, lag, value, label=label, **look)
    left.set(xlabel="lag (steps)", ylabel="autocorrelation of the innovations")
    left.legend()
    right.axhline(1, color=BOUND, lw=4, alpha=0.4)
    for i, ((nis, nees), (color, _, _)) in enumerate(zip(belief.values(), _STYLES, strict=False)):
        _bars(right, [i - 0.15], [nis], color=color, marker="o", ms=7, mfc="white", mew=2)
        _bars(right, [i + 0.15], [nees], color=color, marker="D", ms=5)
    right.plot([], [], "o", color=TRUTH, mfc="white", mew=2, label="mean NIS")
    right.plot([], [], "D", color=TRUTH, label="mean NEES")
    right.set(yscale="log", xticks=range(len(belief)), xlim=(-0.6, len(belief) - 0.4))
    right.set_ylabel("relative mean: 1 is consistent")
    names = ["\n".join(label.split(" ", 1)) for label in belief]
    right.set_xticklabels(names, fontsize=8)
    right.legend(loc="upper left")
    values = [estimate.value for pair in belief.values() for estimate in pair]
    right.set_ylim(0.6 * min(values), 2.5 * max(values))


def _bars(ax, x, estimates, scale=1.0, **look):
    """Draw estimates and their intervals."""
    value, low, high = (
        np.array([getattr(e, end) for e in estimates]) * scale for end in ("value", "low", "high")
    )
    (line,) = ax.plot(x, value, **look)
    ax.vlines(x, low, high, color=line.get_color(), lw=1.2)
