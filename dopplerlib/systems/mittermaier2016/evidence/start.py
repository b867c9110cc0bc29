"""Evidence on the start: the error maps of Fig 3, and the estimate of Table 2."""

import numpy as np

from ...._hints import checked
from ....evaluation.intervals import (
    ConfidenceInterval,
    mean_interval,
    proportion_interval,
    quantile_interval,
)
from ....replication.evidence import Draws, Readings
from ..error_maps import error_map, error_map_bound, fraction_above
from ..published import reported
from ..readings.maps import map_readings
from ..start import table2_starts

_DRAWS = 3  # of each of the 1521 places of Fig 3
_REDRAWN = 500
_STARTS = 2000
_LIKELIHOODS = {
    "stationary likelihood": "stationary",
    "constant-velocity likelihood": "constant_velocity",
}


@checked
def start_evidence(rng: np.random.Generator) -> dict[str, object]:
    """Return evidence by the id of the claim, see `evidence`."""
    maps, starts = rng.spawn(2)
    return _maps(maps) | _bounds() | _starts(starts)


def _maps(rng):
    p = reported().figure3
    children = rng.spawn(6)
    one = error_map(_DRAWS, rng=children[0])
    ten, twenty = (
        {
            name: error_map(draws, rng=child, samples=samples, likelihood=likelihood)
            for (name, likelihood), child in zip(_LIKELIHOODS.items(), pair, strict=True)
        }
        for draws, samples, pair in ((_DRAWS, 10, children[1:3]), (1, 20, children[3:5]))
    )
    readings = {
        r.orientation: r
        for r in map_readings({"one sample": one}, p, 0)
        if r.quantity == "position"
    }
    behind, error = (float(getattr(readings["as printed"], k)) for k in ("behind", "deviation"))
    return {
        "figure3-as-printed": ConfidenceInterval(behind, behind - error, behind + error),
        "figure3-areas": _corners(one.position, p),
        "figure3-left-share": _share(one, p, 0, children[5]),
        "figure3-right-share": Readings(
            {name: _share(m, p, 1, children[5]) for name, m in ten.items()}
        ),
        "figure3-improves": Readings({name: _improved(one, m) for name, m in ten.items()}),
        "figure3-better": Readings({name: _ratio(m, one) for name, m in ten.items()}),
        "figure3-longer": Readings({name: _ratio(twenty[name], ten[name]) for name in ten}),
    }


def _corners(error, p):
    """Return the ratio of errors top right and bottom left to those at the reflected places."""
    x, y = np.meshgrid(p.x, p.y, indexing="ij")
    corner = (x > 0.3) & (np.abs(y) > 0.3)
    here = np.where((y > 0)[..., None], error, error[::-1])
    there = np.where((y > 0)[..., None], error[::-1], error)
    ratio = mean_interval(np.log(here / there)[corner].ravel())
    return ConfidenceInterval(*(float(np.exp(v)) for v in (ratio.value, ratio.low, ratio.high)))


def _share(error_map, p, panel, rng):
    """Return the fraction of places above 0.1 m, in maps combined from our draws of each place."""
    known = ~np.isnan(p.error[panel]) | p.below[panel]
    published = float(fraction_above(p.error[panel], [0.1], known)[0])
    above = error_map.position[known] > 0.1
    choice = rng.integers(above.shape[1], size=(_REDRAWN, 1, len(above)))
    drawn = np.take_along_axis(above.T[None], choice, axis=1)[:, 0].mean(axis=1)
    return Draws(100 * drawn, 100 * published)


def _improved(few, many):
    """Return the fraction of places at which the median error of our draws is smaller."""
    few, many = (np.median(m.position, axis=-1) for m in (few, many))
    there = ~np.isnan(few)
    return proportion_interval((many < few)[there])


def _ratio(longer, shorter):
    """Return the median over the places of the error of a longer record over that of a shorter."""
    longer, shorter = (np.median(m.position, axis=-1) for m in (longer, shorter))
    ratio = longer / shorter
    return quantile_interval(ratio[~np.isnan(ratio)])


def _bounds():
    p = reported().figure3
    off_line = np.abs(p.x) > 1e-9  # on it the sensors cannot see the distance
    kinds = {
        "one sample": (1, "stationary"),
        "ten samples, stationary likelihood": (10, "stationary"),
        "ten samples, constant-velocity likelihood": (10, "constant_velocity"),
    }
    maps = {}
    for name, (samples, likelihood) in kinds.items():
        maps[name] = [
            error_map_bound(samples=samples, likelihood=likelihood, velocity=v)[off_line]
            for v in (p.velocity, p.velocity * [-1, 1, 1])
        ]
    bound, flipped = maps["one sample"]
    correlations = {
        name: float(np.corrcoef(*(np.log(m).ravel() for m in pair))[0, 1])
        for name, pair in maps.items()
    }
    return {
        "figure3-symmetric": float(np.max(np.abs(bound[::-1, ::-1] / bound - 1))),
        "figure3-mirrored": float(np.max(np.abs(bound[::-1] / flipped - 1))),
        "figure3-velocity": Readings(correlations),
    }


def _starts(rng):
    found = {
        name: table2_starts(_STARTS, rng=child, likelihood=likelihood)
        for (name, likelihood), child in zip(_LIKELIHOODS.items(), rng.spawn(2), strict=True)
    }
    second = [
        np.linalg.norm((s.start.second_x - s.start.x)[:, :3], axis=-1) > 0.05
        for s in found.values()
    ]
    return {
        "start-position": Readings({n: Draws(s.position) for n, s in found.items()}),
        "start-velocity": Readings({n: Draws(s.velocity) for n, s in found.items()}),
        "start-reliable": Readings(
            {n: proportion_interval(s.position < 0.1) for n, s in found.items()}
        ),
        "start-not-convex": Readings(
            {name: proportion_interval(hits) for name, hits in zip(found, second, strict=True)}
        ),
    }
