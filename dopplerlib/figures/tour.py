"""Figures of the tour: one record of measurements, and the approach of the target."""

import numpy as np
from matplotlib.figure import Figure

from .._hints import Array
from .style import OURS, TRUTH, drawing, sensor_colors, spread


@drawing(7.0, 3.8)
def record(figure: Figure, time: Array, z: Array, shift: Array) -> None:
    """Draw one record of Doppler measurements and the true shifts behind it.

    time (K,): Time in s.
    z (K, N): Measurements in Hz.
    shift (K, N): True Doppler shifts in Hz.
    """
    ax, zoom = figure.subplots(1, 2, width_ratios=(3, 2))
    ends = spread(shift[-1], 0.05 * np.ptp(shift))
    for n, color in enumerate(sensor_colors(shift.shape[1])):
        ax.plot(time, shift[:, n], color=color)
        ax.annotate(
            f"{n + 1}", (time[-1], shift[-1, n]), (1.04 * time[-1], ends[n]), color=TRUTH,
            va="center", arrowprops={"arrowstyle": "-", "color": color, "lw": 0.8},
        )  # fmt: skip
        zoom.plot(1e3 * time[:50], z[:50, n], ".", color=color, ms=4)
        zoom.plot(1e3 * time[:50], shift[:50, n], color=color)
    ax.set(xlabel="time (s)", ylabel="Doppler shift (Hz)", title="whole record, without noise")
    zoom.set(xlabel="time (ms)", ylabel="Doppler shift (Hz)", title="first 50 samples")


@drawing(7.0, 3.8)
def approach(figure: Figure, time: Array, truth: Array, x: Array, run: int = 0) -> None:
    """Draw the estimated distance of one run, and the predicted time of impact of all runs.

    time (K,): Time in s.
    truth (K, 6): True states.
    x (runs, K, 6): Estimated states.
    run: Which run to draw.
    """
    impact = time - x[..., 0] / x[..., 3]
    true_impact = time[0] - truth[0, 0] / truth[0, 3]
    band = np.percentile(impact, [2.5, 50, 97.5], axis=0)
    left, right = figure.subplots(1, 2)
    left.plot(time, truth[:, 0], color=TRUTH, ls="--", label="truth")
    left.plot(time, x[run, :, 0], color=OURS, label="one run")
    left.set(xlabel="time (s)", ylabel="distance x (m)", ylim=(0, None))
    right.fill_between(
        time, band[0], band[2], color=OURS, alpha=0.25, lw=0, label=f"95 % of {len(x)} runs"
    )
    right.plot(time, impact[run], color=OURS, label="one run")
    right.axhline(true_impact, color=TRUTH, ls="--", label="truth")
    right.set(xlabel="time (s)", ylabel="predicted time of impact (s)")
    right.set(ylim=(true_impact - 0.4, true_impact + 0.4))
    figure.legend(*right.get_legend_handles_labels(), loc="outside upper center", ncols=3)
