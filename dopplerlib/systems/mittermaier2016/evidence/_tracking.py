"""Evidence on the simulation example: the same record again and again, with other noise."""

import numpy as np

from ...._hints import checked
from ....evaluation.consistency import chi2_interval
from ....evaluation.intervals import proportion_interval, quantile_interval
from ....replication.evidence import Draws, sweep
from ..published import reported
from ._runs import choices, example_runs

# More for the gate with which Fig 6 was drawn: percentiles near one in forty have to be told.
_RUNS = {"none": 2000, "upper": 2000, "two-sided": 6000}
_KNOWN = 24  # sample from which on all drawn errors are known
_RUN = ("gate", "start", "raised-noise")


@checked
def tracking_evidence(rng: np.random.Generator) -> dict[str, object]:
    """Return evidence by the id of the claim, see `evidence`."""
    runs = example_runs(rng, _RUN, _RUNS, _described, ("innovation",))
    # What is drawn was drawn with the gate that the figure itself shows.
    drawn = _RUN[1:]
    return (
        sweep(choices(*_RUN), lambda *run: _of_any_run(runs(*run)))
        | sweep(choices(*_RUN, "left-out"), lambda *run: _innovations(runs(*run[:3]), run[3]))
        | sweep(choices(*_RUN, "mean-error"), lambda *run: _components(runs(*run[:3]), run[3]))
        | sweep(choices(*_RUN, "whole-or-end"), lambda *run: _speed(runs(*run[:3]), run[3]))
        | sweep(
            choices(*_RUN, "blocks"), lambda *run: _decrease(runs(*run[:3])[f"{run[3]} blocks"])
        )
        | sweep(choices(*drawn), lambda *run: _of_the_drawn_run(runs("two-sided", *run)))
        | sweep(
            choices(*drawn, "mean-error"),
            lambda *run: _drawn_errors(runs("two-sided", *run[:2]), run[2]),
        )
    )


def _described(result):
    """Return quantities of each run: arrays by their names, shape (runs, ...)."""
    nis, innovation = result.track.nis, result.track.innovation
    error = np.abs(result.track.x - result.truth)
    lower, upper = chi2_interval(6)
    skipped = ~result.track.updated
    (left_out,) = choices("left-out")
    found = {
        "nis": nis.mean(axis=1),
        "inside": 100 * ((lower <= nis) & (nis <= upper)).mean(axis=1),
        "first ten": nis[:, :10].mean(axis=1),
        "low": (skipped & (nis < 6)).sum(axis=1),
        "high": (skipped & (nis > 6)).sum(axis=1),
        "mean": error.mean(axis=1),
        "root mean square": np.sqrt((error**2).mean(axis=1)),
        "end": error[:, -1],
        "mean, known": error[:, _KNOWN:].mean(axis=1),
        "root mean square, known": np.sqrt((error[:, _KNOWN:] ** 2).mean(axis=1)),
    }
    for number in left_out.values + left_out.beyond:
        found[f"without {number}"] = innovation[:, number:].mean(axis=1)
    (blocks,) = choices("blocks")
    for number in blocks.values + blocks.beyond:
        found[f"{number} blocks"] = block_errors(result.error, number)
    return found


def block_errors(error, number):
    """Return root mean square position errors, shape (..., number), but for the first sample.

    What is NaN of the drawn errors lies above the axis, in the first block.
    """
    squared = np.sum(error[..., 1:, :] ** 2, axis=-1)
    parts = np.array_split(squared, number, axis=-1)
    return np.stack([np.sqrt(np.nanmean(part, axis=-1)) for part in parts], axis=-1)


def _of_any_run(run):
    low, high = chi2_interval(6, runs=reported().scenario.samples)
    return {
        "nis-average": Draws(run["nis"]),
        "nis-inside": Draws(run["inside"]),
        "nis-matches-runs": proportion_interval((low <= run["nis"]) & (run["nis"] <= high)),
        "final-quoted": Draws(100 * np.linalg.norm(run["end"][:, :3], axis=-1)),
        "range-median": quantile_interval(100 * run["end"][:, 0]),
        "range-most": proportion_interval(run["end"][:, 0] < 0.01),
    }


def _innovations(run, left_out):
    mean = run[f"without {left_out}"]
    return {"innovation-low": Draws(mean.min(axis=1)), "innovation-high": Draws(mean.max(axis=1))}


def _components(run, average):
    error = run[average]
    return {
        "z-worst": proportion_interval(error[:, :3].argmax(axis=1) == 2),
        "vx-best": proportion_interval(error[:, 3:].argmin(axis=1) == 0),
        "vy-before-vz": proportion_interval(error[:, 4] < error[:, 5]),
    }


def _speed(run, when):
    error = run["end" if when == "at the end" else "mean"]
    return {"vx-accurate": quantile_interval(error[:, 3])}


def _decrease(errors):
    """Return the median ratio of the error to that in the block before, at its worst."""
    ratios = errors[:, 1:] / errors[:, :-1]
    return {"decreasing": quantile_interval(ratios[:, np.median(ratios, axis=0).argmax()])}


def _of_the_drawn_run(run):
    """Return the quantities that the curves of Fig 6 show: those of our runs and the drawn ones."""
    drawn = reported().figure6
    end = 100 * float(np.linalg.norm(drawn.error[-1]))
    low, high = ((drawn.skipped & beyond).sum() for beyond in (drawn.nis < 6, drawn.nis > 6))
    return {
        "nis-first-ten": Draws(run["first ten"], float(drawn.nis[:10].mean())),
        "skipped-low": Draws(run["low"], float(low)),
        "skipped-high": Draws(run["high"], float(high)),
        "final-drawn": Draws(100 * np.linalg.norm(run["end"][:, :3], axis=-1), end),
    }


def _drawn_errors(run, average):
    """Return the average error of each coordinate, from the 25th sample on."""
    drawn = reported().figure6.error[_KNOWN:]
    theirs = drawn.mean(axis=0) if average == "mean" else np.sqrt((drawn**2).mean(axis=0))
    ours = run[f"{average}, known"]
    return {
        f"error-{axis}": Draws(100 * ours[:, place], 100 * float(theirs[place]))
        for place, axis in enumerate("xyz")
    }
