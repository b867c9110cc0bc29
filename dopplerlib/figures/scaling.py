"""Figure of the chapter on scaling a study: what more runs give, and what they cost."""

from collections.abc import Sequence

from matplotlib.figure import Figure

from .._hints import Array, Positive
from .style import OURS, TRUTH, VARIANTS, drawing

_FROM, _TO = 10, 1e7  # runs


@drawing(7.0, 3.2)
def gain_and_cost(
    figure: Figure,
    runs: Array,
    half_width: Array,
    timed_runs: Array,
    seconds: Array,
    each: Positive,
    processors: Sequence[int],
) -> None:
    """Draw the half-width of an interval and the processor time of a study by its number of runs.

    runs, half_width (M,): Numbers of runs, and half-widths in mm of the interval of a mean.
    timed_runs, seconds (L,): Numbers of runs, and processor time in s that was measured.
    each: Processor time of a run in s, from which lines are extrapolated.
    processors: For how many there is a line.
    """
    gain, cost = figure.subplots(1, 2)
    scatter = half_width[-1] * runs[-1] ** 0.5
    ends = [_FROM, _TO]
    gain.plot(ends, [scatter * n**-0.5 for n in ends], "--", color=TRUTH, label="one over the root")
    gain.plot(runs, half_width, "o", color=OURS, label="computed")
    gain.set(ylabel="half-width (mm)")
    for count, (color, line) in zip(processors, VARIANTS, strict=False):
        label = f"{count} processor{'s' * (count > 1)}"
        part = [max(_FROM, count), _TO]  # fewer runs than processors are not divided
        cost.plot(part, [each * n / count for n in part], line, color=color, label=label)
    cost.plot(timed_runs, seconds, "o", color=TRUTH, label="measured, one")
    cost.set(ylabel="time (s)")
    for ax in (gain, cost):
        ax.set(xlabel="number of runs", xscale="log", yscale="log")
        ax.legend()
