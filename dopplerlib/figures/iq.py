"""From IQ samples to a Doppler shift: the chain, the circle, the peak, the receiver's faults."""

import numpy as np
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch

from .style import BOUND, ORANGE, OURS, PINK, PUBLISHED, SENSOR, TRUTH, styled


def chain(stages, rates, per_sensor):
    """Draw the signal chain as boxes, and what goes from one to the next.

    Parameters
    ----------
    stages : sequence of str
        Names of the boxes.
    rates : sequence of str
        What each box gives; the last one is the result.
    per_sensor : int
        How many of the boxes exist once for every sensor.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with styled(7.0, 2.3) as figure:
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
        return figure


def circle(time, x, turn):
    """Draw IQ samples as they run around a circle, and both parts over time.

    Parameters
    ----------
    time : ndarray, shape (n,)
        Time in s.
    x : ndarray of complex, shape (n,)
        IQ samples.
    turn : int
        How many samples are drawn in the plane, about one turn.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with styled(7.0, 3.0) as figure:
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
        plane.set(xlabel="I", ylabel="Q", aspect="equal", xlim=(-1.6, 1.6), ylim=(-1.6, 1.6))
        trace.plot(1e3 * time, x.real, color=OURS, label="I")
        trace.plot(1e3 * time, x.imag, color=ORANGE, ls="--", label="Q")
        trace.set(xlabel="time in ms", ylabel="in amplitudes of the echo", ylim=(-1.6, 2.3))
        trace.legend(ncols=2, loc="upper right")
        return figure


def peak(f, power, bins, bin_power, vertex, truth):
    """Draw a spectrum, and its peak with the parabola through three bins.

    Parameters
    ----------
    f, power : ndarray, shape (M,)
        Frequencies in Hz and magnitudes of a finely padded transform.
    bins, bin_power : ndarray, shape (n,)
        The same of the unpadded one.
    vertex : float
        Frequency of the parabola's top in Hz.
    truth : float
        True frequency in Hz.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with styled(7.0, 3.1) as figure:
        wide, near = figure.subplots(1, 2)
        top = np.argmax(bin_power)
        three = slice(top - 1, top + 2)
        parabola = np.polynomial.Polynomial.fit(bins[three], bin_power[three], 2)
        width = bins[1] - bins[0]
        for ax in (wide, near):
            ax.plot(f, power, color=BOUND, lw=1.2, label="at any frequency")
            ax.plot(bins, bin_power, "o", color=OURS, ms=4, label="bins of the transform")
            ax.set(xlabel="frequency in Hz")
        wide.set(ylabel="magnitude of the spectrum", xlim=(f[0], f[-1]))
        g = np.linspace(bins[top] - 1.3 * width, bins[top] + 1.3 * width, 200)
        near.plot(g, parabola(g), color=ORANGE, ls="--", label="parabola through three")
        near.axvline(truth, color=TRUTH, lw=1, ls=":", label="truth")
        near.plot(vertex, parabola(vertex), "v", color=ORANGE, ms=7)
        near.set(xlim=(g[0] - 0.6 * width, g[-1] + 0.6 * width), ylim=(0, 1.12 * power.max()))
        handles, labels = near.get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper center", ncols=4, columnspacing=1.2)
        return figure


def impairments(f, spectra, truth):
    """Draw spectra of the same record with faults of the receiver and without.

    Parameters
    ----------
    f : ndarray, shape (M,)
        Frequencies in Hz.
    spectra : dict of str to ndarray, shape (M,)
        Powers by label, relative to the echo.
    truth : float
        True frequency in Hz.

    Returns
    -------
    matplotlib.figure.Figure
    """
    styles = ((PUBLISHED, "-"), (ORANGE, "--"), (OURS, "-"))
    with styled(7.0, 3.3) as figure:
        ax = figure.subplots()
        for (label, power), (color, ls) in zip(spectra.items(), styles, strict=False):
            ax.plot(f, 10 * np.log10(power), color=color, ls=ls, lw=1.2, label=label)
        low, high = -62, 10 * np.log10(max(power.max() for power in spectra.values()))
        for place, text in ((0, "constant"), (truth, "echo"), (-truth, "image")):
            ax.text(place, high + 3, text, ha="center", color=TRUTH)
            ax.axvline(place, color=BOUND, lw=0.8, ls=":", ymax=0.94)
        ax.set(xlabel="frequency in Hz", ylabel="power in dB of the echo", ylim=(low, high + 9))
        figure.legend(loc="outside upper center", ncols=3)
        return figure


def tags(time, shift, windows, center, end):
    """Draw a changing Doppler shift, and estimates tagged with the center and end of windows.

    Parameters
    ----------
    time, shift : ndarray, shape (M,)
        Time in s and true shift in Hz.
    windows : ndarray, shape (K, 2)
        Start and end of each window in s.
    center, end : ndarray, shape (K,)
        Errors in Hz if an estimate is read as the shift at the center, and at the end.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with styled(7.0, 3.1) as figure:
        left, right = figure.subplots(1, 2)
        left.plot(time, shift, color=TRUTH, label="true shift")
        middle = windows.mean(axis=1)
        estimate = np.interp(middle, time, shift) + center
        for (a, b), f in zip(windows, estimate, strict=True):
            left.plot([a, b], [f, f], color=BOUND, lw=1)
        left.plot(middle, estimate, "o", color=OURS, ms=4, label="estimate, at the center")
        left.plot(windows[:, 1], estimate, "s", color=PINK, ms=4, label="the same, at the end")
        left.set(xlabel="time in s", ylabel="Doppler shift in Hz")
        left.legend()
        right.axhline(0, color=BOUND, lw=0.8)
        right.plot(middle, center, "o-", color=OURS, ms=4, label="center")
        right.plot(windows[:, 1], end, "s--", color=PINK, ms=4, label="end")
        right.set(xlabel="time in s", ylabel="error in Hz")
        right.legend(title="tagged with the")
        return figure
