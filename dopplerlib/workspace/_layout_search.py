"""Search for layouts of sensors in a disc, or in a cylinder on it, by global optimization."""

import numpy as np

from .._records import record
from ..model.radar_array import RadarArray
from ._layout_valleys import LEAST, blocks, prior, starts
from .layouts import named_layouts
from .targets import ARRAY, INTERVAL, PRIOR_MEAN

_POPULATION, _GENERATIONS = 8, 60  # of differential evolution; the first is by parameter
_FARTHEST = 0.3  # by which the first layouts are moved, of parameters between 0 and 1
_COARSE = 25  # samples that a search takes together: its bounds are 1 % too large
_TURNS = np.pi * np.array([0.5, 1, 1.5])
_EVER = 1e-3  # chance of a second valley, under some layout, that makes a target a hard one
_FLOOR = 1e-4  # added to a chance before its logarithm: one target of the search is more
_TRIED = 8  # layouts that tell which targets are hard
_CLOSE = 1e-3  # logarithm of a bound: so near to the best a start has reached it


@record
class BestLayout:
    """A layout with the smallest bound that a search has found.

    Attributes
    ----------
    array : RadarArray
        The sensors.
    bound : float
        Geometric mean over the targets of the bound of the position, in m.
    global_rate, local_rate : float
        Share of the global searches, and of the local ones from random starts, that have come
        within 0.1 % of it.
    """

    array: RadarArray
    bound: float
    global_rate: float
    local_rate: float


def smallest_bound(
    n, x, samples=100, *, rng, static=False, radius=0.2, depth=0.0, searches=2, starts=10
):
    """Search for the layout of the smallest bound.

    Parameters
    ----------
    n : int
        Number of sensors.
    x : array_like, shape (R, 6)
        Targets at time zero, in m and m/s; 100 to 200 are enough.
    samples : int
        Number of samples.
    rng : numpy.random.Generator
        Source of the starts.
    static : bool
        Whether all samples see the target where it is at time zero.
    radius : float
        Radius in m of the disc.
    depth : float
        How far in m a sensor may stand behind the plane x = 0.
    searches : int
        Global searches, by differential evolution with a local one at its end.
    starts : int
        Local searches (L-BFGS-B) from random layouts.

    Returns
    -------
    BestLayout

    Notes
    -----
    Storn and Price (1997); both searches are SciPy's.
    """
    from scipy.optimize import Bounds, differential_evolution, minimize

    x = np.ascontiguousarray(x)

    def value(parameters):
        return _log_bound(_positions(parameters, n, radius, depth), x, samples, static)

    size = n * (3 if depth else 2)
    box = Bounds(np.zeros(size), np.ones(size))
    found = [
        differential_evolution(
            value, box, rng=child, popsize=_POPULATION, maxiter=_GENERATIONS, init="sobol", tol=0
        )
        for child in rng.spawn(searches)
    ]
    found += [
        minimize(value, child.random(size), bounds=box, method="L-BFGS-B")
        for child in rng.spawn(starts)
    ]
    best = min(found, key=lambda each: each.fun)
    reached = [bool(each.fun < best.fun + _CLOSE) for each in found]
    return BestLayout(
        RadarArray(_positions(best.x, n, radius, depth)),
        float(np.exp(best.fun)),
        float(np.mean(reached[:searches])),
        float(np.mean(reached[searches:])),
    )


@record
class Compromise:
    """A layout with few second valleys, whose bound keeps below a limit.

    Attributes
    ----------
    array : RadarArray
        The sensors.
    bound : float
        Geometric mean over the targets of the bound of the position after 100 samples, in m.
    probability : float
        Mean probability of a second valley after 50 samples, over the targets.
    """

    array: RadarArray
    bound: float
    probability: float


def fewest_twins(start, x, limit, *, rng, radius=0.2, depth=0.0, generations=80):
    """Search for the layout with the fewest second valleys among those of a small bound.

    Parameters
    ----------
    start : RadarArray
        A layout within the limit, from which the search begins.
    x : array_like, shape (R, 6)
        Targets at time zero. Those that have no second valley under any of a few layouts are
        counted, but not looked at again.
    limit : float
        Largest bound in m: geometric mean over the targets, of the position after 100 samples.
    rng : numpy.random.Generator
        Source of randomness.
    radius, depth : float
        Room of the sensors in m, see `smallest_bound`.
    generations : int
        Generations of differential evolution.

    Returns
    -------
    Compromise
    """
    from scipy.optimize import Bounds, differential_evolution

    x, n = np.ascontiguousarray(x), len(start)
    size = n * (3 if depth else 2)
    tried = [start, *named_layouts().values()]
    tried += [RadarArray(_positions(rng.random(size), n, radius, depth)) for _ in range(_TRIED)]
    hard = x[np.max([_chances(a.positions, x) for a in tried], axis=0) > _EVER]
    limit = np.log(limit)

    def value(parameters):
        positions = _positions(parameters, n, radius, depth)
        over = _log_bound(positions, x, 100, False) - limit
        if over > 0:  # not to be compared with the logarithm of a chance, which is negative
            return over + 1.0
        return float(np.log(_FLOOR + _chances(positions, hard).sum() / len(x)))

    # Few random layouts keep below the limit: the first ones are moved from the start, ever more.
    moved = np.linspace(0, _FARTHEST, _POPULATION * size)[:, None] * rng.standard_normal(
        (_POPULATION * size, size)
    )
    first = _parameters(start.positions, radius, depth) + moved
    found = differential_evolution(
        value, Bounds(np.zeros(size), np.ones(size)), rng=rng, maxiter=generations,
        init=1 - np.abs(1 - np.abs(first) % 2), tol=0, polish=False,
    )  # fmt: skip
    positions = _positions(found.x, n, radius, depth)
    bound = np.exp(_log_bound(positions, x, 100, False))
    return Compromise(RadarArray(positions), float(bound), float(_chances(positions, x).mean()))


def _positions(parameters, n, radius, depth):
    """Return sensors (N, 3) from numbers between 0 and 1: area, angle and depth."""
    parts = np.reshape(parameters, (-1, n))
    r, angle = radius * np.sqrt(parts[0]), 2 * np.pi * parts[1]
    x = -depth * parts[2] if depth else np.zeros(n)
    return np.stack([x, r * np.cos(angle), r * np.sin(angle)], axis=-1)


def _parameters(positions, radius, depth):
    x, y, z = positions.T
    parts = [(y**2 + z**2) / radius**2, np.arctan2(z, y) / (2 * np.pi) % 1]
    if depth:
        parts.append(-x / depth)
    return np.clip(np.concatenate(parts), 0, 1)


def _log_bound(positions, x, samples, static):
    from . import _layout_loop

    seen, weights = blocks(samples, len(positions), _COARSE)
    bounds = np.empty((len(x), 6, 6))
    end = 0.0 if static else samples * INTERVAL
    _layout_loop.covariances(
        x, positions, ARRAY.doppler_per_speed, 0 * seen if static else seen, weights,
        prior(), end, bounds,
    )  # fmt: skip
    return float(np.mean(np.log(np.trace(bounds[:, :3, :3], axis1=1, axis2=2)))) / 2


def _chances(positions, x):
    from . import _layout_loop

    array = RadarArray(positions)
    seen, weights = blocks(50, len(positions), _COARSE)
    chance, other = np.empty(len(x)), np.empty((len(x), 6))
    _layout_loop.chances(
        x, starts(x, array, 25 * INTERVAL, _TURNS), positions, array.doppler_per_speed,
        seen, weights, PRIOR_MEAN, prior(), LEAST, chance, other,
    )  # fmt: skip
    return chance
