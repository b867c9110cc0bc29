"""Figures of the chapter on an automotive radar: waveforms, maps, the processing scheme."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from .._hints import Array
from .style import BOUND, ORANGE, OURS, PINK, SENSOR, TRUTH, VARIANTS, drawing


@drawing(7.0, 4.4)
def sketches(figure: Figure) -> None:
    """Draw frequency over time for the six waveforms, not to scale."""
    axes = figure.subplots(2, 3, sharex=True, sharey=True)
    pulse, lfm, fsk, slopes, mfsk, rapid = axes.ravel()
    for start in np.arange(0.02, 1, 0.25):
        pulse.plot([start, start + 0.04], [0.5, 0.5], color=OURS, lw=5, solid_capstyle="butt")
    lfm.plot([0, 0.5, 1], [0, 1, 0], color=OURS)
    lfm.plot([0.06, 0.56, 1.06], [0.06, 1.06, 0.06], color=BOUND, ls="--")
    for n in range(10):
        ends = [n / 10, (n + 1) / 10]
        fsk.plot(ends, [0.35 + 0.3 * (n % 2)] * 2, color=(OURS, ORANGE)[n % 2], lw=2.5)
    slopes.plot([0, 0.25, 0.5, 0.75, 1], [0, 1, 0, 0.6, 0.3], color=OURS)
    for n in range(20):
        ends = [n / 20, (n + 1) / 20]
        height = (n // 2 - 0.5 * (n % 2)) / 11  # B half a step below A
        mfsk.plot(ends, [height] * 2, color=(OURS, ORANGE)[n % 2], lw=2.5)
    for n in range(8):
        rapid.plot([n / 8, (n + 1) / 8], [0, 1], color=OURS)
    titles = (
        "pulses", "chirps (LFM)", "two tones (FSK)",
        "several slopes", "MFSK", "rapid chirps",
    )  # fmt: skip
    for ax, title in zip(axes.ravel(), titles, strict=True):
        ax.set(title=title, xlim=(0, 1), ylim=(-0.08, 1.15), xticks=[], yticks=[])
    figure.supxlabel("time (not to scale)")
    figure.supylabel("frequency (not to scale)")


@drawing(7.0, 2.8)
def pulses(
    figure: Figure, distance: Array, signal: Array, v: Array, doppler: dict[str, Array]
) -> None:
    """Draw the echoes of one pulse, and the Doppler spectrum of the samples at each echo.

    distance (samples,): Range in m.
    signal (samples,): Echoes of one pulse.
    v (pulses,): Range rates in m/s, in rising order.
    doppler (pulses,): For each label the power in dB.
    """
    left, right = figure.subplots(1, 2)
    left.plot(distance, np.abs(signal), color=OURS, lw=1)
    left.set(xlabel="range from the delay (m)", ylabel="amplitude of one pulse")
    styles = VARIANTS
    for (label, power), (color, ls) in zip(doppler.items(), styles, strict=False):
        right.plot(v, power, color=color, ls=ls, label=label)
    right.set(xlabel="range rate (m/s)", ylabel="relative power (dB)", ylim=(-60, 22))
    right.legend(loc="upper center", ncols=2)


@drawing(7.0, 4.0)
def ghosts(
    figure: Figure,
    cases: dict[str, tuple[Array, Sequence[Array], Array, Array]],
    reach: tuple[float, float],
) -> None:
    """Draw the lines of the chirps' beat frequencies in the plane of range and range rate.

    cases: For each title: rows of `chirp_relation`, tones of each chirp in Hz, and (pairs, 2) found
        and (targets, 2) true ranges in m and range rates in m/s.
    reach: Limits of the range axis in m.
    """
    axes = figure.subplots(1, len(cases), sharey=True, squeeze=False)[0]
    colors = ((OURS, "-"), (ORANGE, "--"), (PINK, "-."), (BOUND, ":"))
    for ax, (title, case) in zip(axes, cases.items(), strict=True):
        relations, frequencies, found, targets = case
        r = np.array(reach)
        for (a, b), tones, (color, ls) in zip(relations, frequencies, colors, strict=False):
            for i, tone in enumerate(tones):
                name = f"chirp of {a * 149_896_229.0 / 1e9:+.1f} GHz/s" if i == 0 else None
                ax.plot(r, (tone - a * r) / b, color=color, ls=ls, lw=1.1, label=name)
        ax.plot(*np.transpose(targets), "o", mfc="none", mec=TRUTH, ms=11, label="target")
        ax.plot(*np.transpose(found), "x", color=TRUTH, mew=2, label="accepted")
        ax.set(title=title, xlabel="range (m)", xlim=reach, ylim=(-16, 16))
    axes[0].set_ylabel("range rate (m/s)")
    handles, labels = axes[-1].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3)


@drawing(7.0, 3.0)
def solved(figure: Figure, cases: dict[str, Array], targets: dict[str, Array]) -> None:
    """Draw solutions of the MFSK system for many records near the targets; count the others.

    cases (..., 2): Ranges in m and range rates in m/s for each title.
    targets (targets, 2): The true ones.
    """
    axes = figure.subplots(1, len(cases), squeeze=False)[0]
    for ax, (title, found) in zip(axes, cases.items(), strict=True):
        found, true = found.reshape(-1, 2), targets[title]
        space = np.maximum(np.ptp(true, axis=0), 1) / 2
        low, high = true.min(axis=0) - space, true.max(axis=0) + space
        outside = int(np.sum(np.any((found < low) | (found > high), axis=1)))
        ax.plot(*found.T, ".", color=OURS, ms=3, alpha=0.6, label="solved")
        ax.plot(*true.T, "o", mfc="none", mec=TRUTH, ms=11, label="target")
        ax.set(title=title, xlabel="range (m)", xlim=(low[0], high[0]), ylim=(low[1], high[1]))
        note = f"{outside} of {len(found)} outside"
        ax.text(0.03, 0.04, note, transform=ax.transAxes, va="bottom", fontsize=9)
    axes[0].set_ylabel("range rate (m/s)")
    figure.legend(*ax.get_legend_handles_labels(), loc="outside upper center", ncols=2)


@drawing(7.0, 3.6)
def maps(
    figure: Figure,
    cases: dict[str, tuple[Array, Array, Array, dict[str, tuple[float, float]]]],
    floor: float = -45.0,
) -> None:
    """Draw range-Doppler maps.

    cases: For each title what `range_doppler_map` returns, and {text: (r, v)} to be written into
        it.
    floor: Lowest power of the colors in dB.
    """
    axes = figure.subplots(1, len(cases), squeeze=False)[0]
    for ax, (title, (r, v, power, labels)) in zip(axes, cases.items(), strict=True):
        edges = r[0], r[-1], v[0], v[-1]
        image = ax.imshow(
            power, origin="lower", aspect="auto", extent=edges,
            cmap="viridis", vmin=floor, vmax=0, interpolation="nearest",
        )  # fmt: skip
        for text, (x, y) in labels.items():
            ax.annotate(
                text, (x, y), xytext=(0, 14 if y > 0 else -22), textcoords="offset points",
                color="white", ha="center", fontsize=9,
                arrowprops={"arrowstyle": "-", "color": "white", "lw": 0.8},
            )  # fmt: skip
        ax.grid(False)
        ax.set(title=title, xlabel="range (m)")
    axes[0].set_ylabel("range rate (m/s)")
    figure.colorbar(image, ax=axes, label="relative power (dB)")


@drawing(7.0, 2.6)
def scheme(figure: Figure, blocks: Sequence[tuple[str, str]]) -> None:
    """Draw a processing scheme as boxes in a row, with the output of each.

    blocks: From the first to the last; an empty name gives the input.
    """
    ax = figure.subplots()
    columns, before = 3, None
    for i, (name, out) in enumerate(blocks):
        row, column = divmod(i, columns)
        way = 1 if row % 2 == 0 else -1  # every other row runs back
        x, y = 1.1 * (column if way > 0 else columns - 1 - column), -row
        box = ax.text(
            x, y, name, ha="center", va="center", fontsize=9.5,
            bbox={"boxstyle": "round,pad=0.5", "fc": "#E8F1F8", "ec": OURS},
        )  # fmt: skip
        ax.text(x, y - 0.33, out, ha="center", va="center", fontsize=9, color=TRUTH)
        if before is not None:
            look = {"arrowstyle": "-|>", "color": BOUND, "shrinkA": 2, "shrinkB": 2}
            look |= {"patchA": before.get_bbox_patch(), "patchB": box.get_bbox_patch()}
            start = before.get_position()
            if column == 0:  # down to the next row, from below what comes out
                start, look["patchA"] = (x, y + 0.57), None
            ax.annotate("", (x, y), start, arrowprops=look)
        before = box
    ax.set(xlim=(-0.55, 2.75), ylim=(-1.45, 0.3))
    ax.axis("off")


@drawing(7.0, 3.8)
def scene(figure: Figure, stages: dict[str, dict[str, Array]], truth: Array) -> None:
    """Draw detections and tracks from above, one panel for each stage.

    stages (..., 2): For each title and each label, positions [x, y] in m. Labels that begin with
        "track" are drawn as lines, and named once.
    truth (K, 4): True states of the target.
    """
    dots = {"target": OURS, "stands still": BOUND, "false alarm": ORANGE, "object": SENSOR}
    axes = figure.subplots(1, len(stages), sharex=True, sharey=True, squeeze=False)[0]
    for ax, (title, groups) in zip(axes, stages.items(), strict=True):
        named = False
        for label, xy in groups.items():
            if label.startswith("track"):
                ax.plot(*xy.T, color=PINK, lw=1.6, label=None if named else "track")
                named = True
            else:
                ax.plot(*xy.T, ".", ms=2, color=dots[label], alpha=0.5, label=label)
        ax.plot(truth[:, 0], truth[:, 2], color=TRUTH, ls="--", lw=1, label="truth")
        ax.plot(0, 0, "^", color=TRUTH, ms=7)
        ax.set(title=title, xlabel="x (m)")
    handles = {
        label: handle
        for ax in axes
        for handle, label in zip(*ax.get_legend_handles_labels(), strict=True)
    }
    place = "outside lower center"
    figure.legend(handles.values(), handles, loc=place, ncols=len(handles), markerscale=3)
    axes[0].set(ylabel="y (m)", ylim=(-2, 85))
