"""Evidence on the error maps of Fig 3: statements of the text beside the drawn maps and ours."""

from collections.abc import Callable

import numpy as np

from ....evaluation.intervals import (
    ConfidenceInterval,
    mean_interval,
    proportion_interval,
    quantile_interval,
)
from ....model.doppler import doppler_shift
from ....replication.choices import Choice
from ....replication.evidence import Draws, sweep
from ..error_maps import comparable, error_map, error_map_bound, fraction_above
from ..published import reported
from ..readings.maps import ORIENTATIONS, map_score
from ._made_once import made_once

_DRAWS = 6  # of each of the 1521 places
_REDRAWN = 500
_RECORDS = {
    "one sample": (1, "stationary"),
    "ten, constant state": (10, "stationary"),
    "ten, constant velocity": (10, "constant_velocity"),
}
_TEN = {likelihood: name for name, (samples, likelihood) in _RECORDS.items() if samples == 10}
_AXES = {"y": "as published", "x": "array turned"}


def map_evidence(
    choice: Callable[..., tuple[Choice, ...]], rng: np.random.Generator
) -> dict[str, object]:
    """Return evidence by the id of the claim, see `evidence`; choices are asked for by name."""
    drawing, longer, shares = rng.spawn(3)
    maps = made_once(choice("figure3-room", "figure3-record"), _map, drawing)
    return (
        _drawn(choice)
        | _symmetries(choice)
        | _corners_and_shifts(choice, maps)
        | _readings_of_the_drawing(choice, maps)
        | _shares(choice, maps, shares)
        | _longer_records(choice, maps, longer)
    )


def _map(rng, room, record):
    samples, likelihood = _RECORDS[record]
    return error_map(_DRAWS, rng=rng, samples=samples, likelihood=likelihood, room=room)


def _drawn(choice):
    """Return evidence of the drawn maps on statements of the text."""
    p = reported().figure3
    error = np.where(p.below, 0.0, p.error)

    def variance(panel, statistic):
        """Return that of one axis: two share the error of a place in a plane."""
        squared = error[("left", "right").index(panel)] ** 2 / 2
        return float({"mean": np.nanmean, "median": np.nanmedian}[statistic](squared))

    both = comparable(p, 0) & comparable(p, 1) & ~p.below.all(axis=0)
    return {
        "figure3-areas-drawn": _contrast(p.shown[0][..., None]),
        "figure3-improves-drawn": float((p.shown[1] < p.shown[0])[both].mean()),
        "covariance-from-figure3": sweep(
            choice("covariance-panel", "covariance-statistic"), variance
        ),
    }


def _symmetries(choice):
    def of_record(record):
        bound, flipped = _bound(record), _bound(record, [-1, 1, 1])
        return {
            "figure3-symmetric": _apart(bound[::-1, ::-1], bound),
            "figure3-mirrored": _apart(bound[::-1], flipped),
        }

    return sweep(choice("figure3-record"), of_record)


def _bound(record, signs=(1, 1, 1)):
    """Return the bound on the position by place, NaN on the line of sensors, who do not see it."""
    p, (samples, likelihood) = reported().figure3, _RECORDS[record]
    bound = error_map_bound(
        samples=samples, likelihood=likelihood, velocity=p.velocity * np.array(signs)
    )
    return np.where(np.abs(p.x)[:, None] > 1e-9, bound, np.nan)


def _apart(one, other):
    """Return the median relative difference of two maps."""
    return float(np.nanmedian(np.abs(one / other - 1)))


def _contrast(error):
    """Return the mean ratio of errors top right and bottom left to those at mirrored places."""
    p = reported().figure3
    x, y = np.meshgrid(p.x, p.y, indexing="ij")
    upper = (x > 1e-9) & (np.abs(y) > 1e-9)
    here = np.where((y > 0)[..., None], error, error[::-1])
    there = np.where((y > 0)[..., None], error[::-1], error)
    return _mean_ratio(here[upper], there[upper])


def _mean_ratio(some, others):
    """Return the geometric mean of the ratios of errors at pairs of places."""
    logarithm = np.log(some / others)
    mean = mean_interval(logarithm[~np.isnan(logarithm)].ravel())
    return ConfidenceInterval(*(float(np.exp(v)) for v in (mean.value, mean.low, mean.high)))


def _corners_and_shifts(choice, maps):
    def area(axis, norm, room):
        return _contrast(ORIENTATIONS[_AXES[axis]](getattr(maps(room, "one sample"), norm)))

    def observed(compare, record, measure, room, *rest):
        if measure == "errors":
            return compare(maps(room, record).position, *rest)
        return compare(_bound(record)[..., None], *rest).value  # nothing in it is random

    def direction(*at):
        ratio = observed(_contrast, *at)
        if isinstance(ratio, float):
            return max(ratio, 1 / ratio) - 1
        ends = [max(end, 1 / end) - 1 for end in (ratio.low, ratio.high)]
        low = 0.0 if ratio.low < 1 < ratio.high else min(ends)
        return ConfidenceInterval(max(ratio.value, 1 / ratio.value) - 1, low, max(ends))

    def similar(record, measure, room, places):
        ratio = observed(_more_similar, record, measure, room, places)
        return round(ratio, 6) if isinstance(ratio, float) else ratio  # one, but for rounding

    axes = "figure3-record", "figure3-measure", "figure3-room"
    return {
        "figure3-areas": sweep(choice("figure3-axis", "norm", "figure3-room"), area),
        "figure3-velocity": sweep(choice(*axes), direction),
        "figure3-similar": sweep(choice(*axes, "similar-places"), similar),
    }


def _more_similar(error, places):
    """Return the mean ratio of errors, places of more similar shifts over those of less."""
    p = reported().figure3
    x = np.zeros((len(p.x), len(p.y), 6))
    x[..., 0], x[..., 1], x[..., 3:] = p.x[:, None], p.y, p.velocity
    clear = np.abs(p.x) > 1e-9
    spread = np.full(x.shape[:2], np.nan)
    spread[clear] = doppler_shift(x[clear], p.array).std(axis=-1)
    if places == "between mirrored places":
        more = spread < spread[::-1] - 1e-9  # Hz; at y = 0 both are the same
        return _mean_ratio(error[more], error[::-1][more])
    more = spread < np.nanmedian(spread)
    some, others = (np.log(error[part & clear[:, None]]).ravel() for part in (more, ~more))
    one, two = (mean_interval(part[np.isfinite(part)]) for part in (some, others))
    reach = np.hypot(one.high - one.value, two.high - two.value)
    middle = one.value - two.value
    return ConfidenceInterval(*(float(np.exp(middle + r)) for r in (0, -reach, reach)))


def _readings_of_the_drawing(choice, maps):
    """Return losses of log-likelihood of the published orientation and of the norm of the state."""
    p, scores = reported().figure3, {}

    def likelihoods(room, record, norm, width):
        key = room, record, norm, width
        if key not in scores:
            error, panel = getattr(maps(room, record), norm), int(_RECORDS[record][0] > 1)
            turned = {name: turn(error) for name, turn in ORIENTATIONS.items()}
            scores[key] = {
                name: map_score(one, p, panel, width=width) for name, one in turned.items()
            }
        return scores[key]

    def orientation(record, norm, width, room):
        found = likelihoods(room, record, norm, width)
        return _behind(max(found.values(), key=np.nansum), found["as published"])

    def quantity(record, width, room):
        best = {
            norm: max(likelihoods(room, record, norm, width).values(), key=np.nansum)
            for norm in ("position", "state")
        }
        return _behind(best["position"], best["state"])

    axes = choice("figure3-record", "norm", "figure3-kernel", "figure3-room")
    return {
        "figure3-as-published": sweep(axes, orientation),
        "figure3-quantity": sweep([axes[0], *axes[2:]], quantity),
    }


def _behind(best, other):
    """Return the loss of a log-likelihood, with an interval from place to place."""
    loss = (best - other)[~np.isnan(best)]
    total, reach = float(loss.sum()), float(1.96 * np.sqrt(loss.size) * loss.std())
    return ConfidenceInterval(total, total - reach, total + reach)


def _shares(choice, maps, rng):
    """Return fractions of the area above a level, in maps combined from our draws of each place."""

    def left(child, level, norm, room):
        return _share(maps(room, "one sample"), 0, level, norm, child)

    def right(child, likelihood, level, norm, room):
        return _share(maps(room, _TEN[likelihood]), 1, level, norm, child)

    def gain(likelihood, norm, room):
        one, ten = maps(room, "one sample"), maps(room, _TEN[likelihood])
        few, many = (np.median(getattr(m, norm), axis=-1) for m in (one, ten))
        there = ~np.isnan(few)
        return {
            "figure3-improves": proportion_interval((many < few)[there]),
            "figure3-better": quantile_interval((many / few)[there]),
        }

    def near(likelihood, room, error):
        position = maps(room, _TEN[likelihood]).position
        return proportion_interval((position < error)[~np.isnan(position)])

    axes = choice("likelihood", "figure3-level", "norm", "figure3-room")
    return {
        "start-reliable-line": sweep(choice("likelihood", "figure3-room", "accuracy"), near),
        "figure3-left-share": sweep(axes[1:], left, rng.spawn(1)[0]),
        "figure3-right-share": sweep(axes, right, rng.spawn(1)[0]),
    } | sweep([axes[0], *axes[2:]], gain)


def _share(error_map, panel, level, norm, rng):
    p = reported().figure3
    known = ~np.isnan(p.error[panel]) | p.below[panel]
    published = float(fraction_above(p.error[panel], [level], known)[0])
    above = getattr(error_map, norm)[known] > level
    choice = rng.integers(above.shape[1], size=(_REDRAWN, 1, len(above)))
    drawn = np.take_along_axis(above.T[None], choice, axis=1)[:, 0].mean(axis=1)
    return Draws(100 * drawn, 100 * published)


def _longer_records(choice, maps, rng):
    def found(child, likelihood, room, samples):
        return error_map(1, rng=child, samples=int(samples), likelihood=likelihood, room=room)

    axes = choice("likelihood", "figure3-room", "figure3-longer", "norm")
    longer = made_once(axes[:3], found, rng)

    def ratio(likelihood, room, samples, norm):
        pair = maps(room, _TEN[likelihood]), longer(likelihood, room, samples)
        few, many = (np.median(getattr(m, norm), axis=-1) for m in pair)
        return quantile_interval((many / few)[~np.isnan(few)])

    return {"figure3-longer": sweep(axes, ratio)}
