"""Evidence on the start of Table 2: what ten samples at the ring tell, and our starts from them."""

from collections.abc import Callable

import numpy as np

from ....evaluation.bounds import crlb
from ....evaluation.intervals import proportion_interval
from ....model.doppler import doppler_jacobian, doppler_shift
from ....model.twin import planar_twin
from ....replication.choices import Choice
from ....replication.evidence import Draws, sweep
from ..published import reported
from ..start import samples_needed, start_box, start_misfit, table2_starts
from . import _runs
from ._made_once import made_once

_STARTS = 1500
_TEN = 10  # samples


def start_evidence(
    choice: Callable[..., tuple[Choice, ...]], rng: np.random.Generator
) -> dict[str, object]:
    """Return evidence by the id of the claim, see `evidence`; choices are asked for by name."""
    return _observed(choice) | _constant() | _starts(choice, rng)


def _observed(choice):
    """Return evidence on the ring from bounds, without random numbers."""
    s = reported().scenario
    P = crlb(s.x0, s.array, s.sigma_f, _TEN, s.T, "constant_velocity")
    return {
        "state-from-constant": float(np.linalg.matrix_rank(doppler_jacobian(s.x0, s.array))),
        "poor-observability": float(np.sqrt(np.trace(P[:3, :3]))),
        "symmetries-reduced": sweep(choice("ring-room"), _excluded),
        "start-likely": sweep(
            choice("start", "likelihood"),
            # The two chi-squares differ by distance^2 - 2 distance n, with n standard normal.
            lambda start, likelihood: (
                start_misfit(_runs.starts()[start], likelihood=likelihood, rounding=0.0005) / 2
            ),
        ),
    } | sweep(choice("accuracy"), _long_enough)


def _long_enough(error):
    """Return the number of samples that an error needs, and the drift of their shifts."""
    s, samples = reported().scenario, samples_needed(error)
    return {
        "many-measurements": float(samples),
        "integration-long": float(_drift(s.x0[None], s, samples)[0]),
    }


def _excluded(side):
    """Return the number of those two states with (nearly) the same shifts that a room excludes."""
    x = reported().scenario.x0
    low, high = _room(side)
    mirror, twin = x * np.array([-1, 1, 1, -1, 1, 1]), planar_twin(x)
    return float(sum(bool(((one < low) | (one > high)).any()) for one in (mirror, twin)))


def _room(side):
    """Return a room as deep as wide and high."""
    return start_box(side, side / 2)


def _constant():
    """Return the way of the mean of ten samples from the first, in standard errors of the mean."""
    s, p = reported().scenario, reported().figure3
    states = np.zeros((len(p.x), len(p.y), 6))
    states[..., 0], states[..., 1] = p.x[:, None], p.y
    states[..., 3:] = p.velocity
    apart = np.linalg.norm(states[..., None, :3] - p.array.positions, axis=-1).min(axis=-1)
    return {
        "constant-table2": float(_drift(s.x0[None], s, _TEN)[0]),
        "constant-figure3": float(np.median(_drift(states[apart > 1e-9], p, _TEN))),
    }


def _drift(x, scene, samples):
    path = np.repeat(x[:, None], samples, axis=1)
    path[..., :3] += scene.T * np.arange(samples)[:, None] * path[..., 3:]
    h = doppler_shift(path, scene.array)
    return np.abs(h.mean(axis=1) - h[:, 0]).max(axis=-1) / (scene.sigma_f / samples**0.5)


def _starts(choice, rng):
    """Return evidence from estimates of the start of Table 2."""
    axes = choice("likelihood", "ring-room")

    def found(child, likelihood, side):
        return table2_starts(_STARTS, rng=child, likelihood=likelihood, box=_room(side))

    by_room = made_once(axes, found, rng)

    def near(likelihood, side, error):
        starts = by_room(likelihood, side)
        second = np.linalg.norm((starts.start.second_x - starts.start.x)[:, :3], axis=-1)
        return {
            "start-reliable": proportion_interval(starts.position < error),
            "start-not-convex": proportion_interval(second > error),
        }

    def errors(*at):
        starts = by_room(*at)
        return {"start-position": Draws(starts.position), "start-velocity": Draws(starts.velocity)}

    return sweep(axes, errors) | sweep(choice("likelihood", "ring-room", "accuracy"), near)
