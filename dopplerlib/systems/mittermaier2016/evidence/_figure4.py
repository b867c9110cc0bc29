"""Evidence on Fig 4: the dots against the text, and our errors against the dots."""

from collections.abc import Callable

import numpy as np

from ....evaluation.intervals import mean_interval
from ....replication.choices import Choice
from ....replication.evidence import Draws, sweep
from ..noise_sweep import SweepReading, run_noise_sweep, sweep_bounds
from ..published import reported
from ..readings.noise_sweep import dots_structure
from ._made_once import made_once

_SEQUENCES = 40  # of our bounds
_DOTS = 10  # of ours at the largest noise
_REDRAWN = 2000
_SMALL = 0.1  # Hz, the middle of the axis
_VELOCITIES = {
    "center 0.5 to 1.5": ("center", (0.5, 1.5)),
    "direction 0.75": ("direction", (0.75, 0.75)),
    "disc 2": ("disc", (0.0, 2.0)),
    "square 1": ("square", (0.0, 1.0)),
}
_PARTS = "position", "velocity"


def figure4_evidence(
    choice: Callable[..., tuple[Choice, ...]], rng: np.random.Generator
) -> dict[str, object]:
    """Return evidence by the id of the claim, see `evidence`; choices are asked for by name."""
    slopes, top = rng.spawn(2)
    return _drawn(choice) | _slopes(choice, slopes) | _top(choice, top)


def _drawn(choice):
    drawn = reported().figure4

    def largest(dot):
        means = dot == "mean of a level"
        return {
            f"figure4-{part}": float(
                (getattr(drawn, part).mean(axis=1) if means else getattr(drawn, part)).max()
            )
            for part in _PARTS
        }

    return {
        "figure4-dots": float(drawn.position.shape[1]),
        "figure4-noise": np.sqrt(drawn.variance[[0, -1]]),
    } | sweep(choice("dot"), largest)


def _reading(velocity, shared, likelihood, box="wide"):
    kind, speed = _VELOCITIES[velocity]
    return SweepReading(kind, speed, shared == "one for all places", likelihood, box=box)


def _slopes(choice, rng):
    """Return means of twenty sequences of errors over the noise, where no wall is near."""
    axes = choice("sweep-velocity", "sweep-shared", "likelihood", "small-noise")

    bounds, drawing, again = rng.spawn(3)

    def found(child, *at):
        return np.log(np.stack(sweep_bounds(_SEQUENCES, rng=child, reading=_reading(*at)), axis=-1))

    by_reading = made_once(axes[:3], found, bounds)

    def slopes(child, *at):
        ours = by_reading(*at[:3])
        drawn, noise = _drawn_slopes(at[3])
        some = ours[child.integers(len(ours), size=(_REDRAWN, drawn.shape[0]))].mean(axis=1)
        # Ours is the mean of a dot; the drawn ones scatter about theirs.
        values = np.exp(some + noise * child.standard_normal((_REDRAWN, 2)))
        means = np.exp(drawn.mean(axis=0))
        return {
            f"figure4-slope-{part}": Draws(values[:, i], float(means[i]))
            for i, part in enumerate(_PARTS)
        }

    def constant(child, kind, shared, noise):
        return slopes(child, kind, shared, "stationary", noise)["figure4-slope-velocity"]

    still = choice("sweep-velocity", "sweep-shared", "small-noise")
    return sweep(axes, slopes, drawing) | {"figure4-constant-state": sweep(still, constant, again)}


def _drawn_slopes(largest):
    """Return log errors over the noise by sequence, and the standard error of their mean.

    Of the dots up to a largest noise in Hz; shapes (20, 2) and (2,).
    """
    drawn = reported().figure4
    small = np.sqrt(drawn.variance) <= largest * (1 + 1e-9)
    dots = drawn.position[small], drawn.velocity[small]
    errors = np.log(np.stack(dots, axis=-1) / np.sqrt(drawn.variance[small])[:, None, None])
    within = np.diag(dots_structure(*dots).within)
    return errors.mean(axis=0), np.sqrt(within / errors[..., 0].size)


def _top(choice, rng):
    """Return errors at the largest noise, beside the limits of the text and the drawn ones."""
    drawn = reported().figure4
    slope, _ = _drawn_slopes(_SMALL)
    theirs = np.stack([drawn.position[-1], drawn.velocity[-1]], axis=-1)
    bend = np.exp(np.log(theirs).mean(axis=0) - slope.mean(axis=0)) / drawn.variance[-1] ** 0.5

    def top(child, *at):
        runs, again = child.spawn(2)
        ours = run_noise_sweep([len(drawn.variance) - 1], _DOTS, rng=runs, reading=_reading(*at))
        found = {}
        for i, part in enumerate(_PARTS):
            errors, bound = getattr(ours, part)[0], getattr(ours, f"bound_{part}")[0]
            ratio = np.log(errors / bound)
            some = ratio[again.integers(_DOTS, size=(_REDRAWN, theirs.shape[0]))].mean(axis=1)
            # The mean of ours is itself that of a few dots.
            some += ratio.std(ddof=1) / _DOTS**0.5 * again.standard_normal(_REDRAWN)
            found[f"figure4-bend-{part}"] = Draws(np.exp(some), float(bend[i]))
            found[f"figure4-limit-{part}"] = mean_interval(errors)
        return found

    return sweep(choice("sweep-velocity", "sweep-shared", "likelihood", "sweep-box"), top, rng)
