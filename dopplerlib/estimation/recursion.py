"""The recursion of all filters: one cycle, and the loop over a record; unchecked.

A filter is a motion model, a measurement model and a rule that linearizes them. It hands two
functions to `cycle`: one that predicts and one that returns innovation and gain. A cycle takes a
state and returns the next one, so that a filter which runs sample by sample is the same code as one
that runs over a record.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from .. import _checks
from .._records import filled
from .._typing import FloatArray
from . import densities, gaussian
from .track import Track

Predict = Callable[[int, FloatArray, FloatArray], tuple[FloatArray, FloatArray]]
Correct = Callable[[int, FloatArray, FloatArray], tuple[FloatArray, ...]]
Bounds = tuple[FloatArray, FloatArray, bool]
_FIELDS = tuple(Track.__annotations__)


def scan(
    step: Callable[[int, Any], tuple[Any, tuple[Any, ...]]],
    state: Any,
    times: range,
    axis: int = 0,
    first: tuple[Any, ...] | None = None,
) -> tuple[FloatArray, ...]:
    """Apply a step to all samples of a record; return its outputs, stacked.

    A step takes the number of the sample and the state before it, and returns the state after it
    and a tuple of outputs. `times` may run backward; `axis` is that of time in the outputs; `first`
    are outputs that stand before those of the first step.
    """
    outputs = [] if first is None else [first]
    for k in times:
        state, output = step(k, state)
        outputs.append(output)
    return tuple(np.stack(values, axis=axis) for values in zip(*outputs, strict=True))


def cycle(
    k: int,
    state: tuple[FloatArray, FloatArray],
    predict: Predict,
    correct: Correct,
    bounds: Bounds | None = None,
) -> tuple[tuple[FloatArray, FloatArray], tuple[Any, ...]]:
    """One cycle of a filter: predict, gate, update.

    The state is (x, P) at the sample before k. `predict` takes k, x and P and returns x and P at
    the sample k. `correct` takes k and the predicted x and P, and returns the innovation (..., m),
    NaN where a measurement is missing, and what `gaussian.gain` returns. `bounds` is a gate on NIS
    for 0, 1, ... components that are measured, see `gate_bounds`, and whether it is soft: what is
    above it counts as if S were larger by so much that NIS is at the bound (Chang 2014). The gain
    is smaller by that factor, and so is what the update takes from P.

    Returned are the state after the update, and x, P, innovation, S, NIS and whether the state was
    updated; without a gate the latter two are left to `filter_records`, which computes them for the
    whole record at once.
    """
    x, P = predict(k, *state)
    innovation, K, P_after, S = correct(k, x, P)
    x_after = gaussian.moved(x, K, innovation)
    if bounds is None:
        return (x_after, P_after), (x_after, P_after, innovation, S)
    nis, count = densities.quadratic_form(innovation, S), _count(innovation)
    lower, upper, soft = bounds
    updated = (count > 0) & (lower[count] <= nis) & (soft | (nis <= upper[count]))
    if soft:
        weight = np.where(nis > upper[count], upper[count] / nis, 1.0)
        x_after = _part_way(x, x_after, weight[..., None])
        P_after = _part_way(P, P_after, weight[..., None, None])
    x = np.where(updated[..., None], x_after, x)
    P = np.where(updated[..., None, None], P_after, P)
    return (x, P), (x, P, innovation, S, nis, updated)


def filter_records(
    x: FloatArray,
    P: FloatArray,
    predict: Predict,
    correct: Correct,
    times: range,
    axis: int,
    bounds: Bounds | None = None,
) -> Track:
    """Apply `cycle` to whole records, many runs at once.

    Estimates x (..., n) and covariances P (..., n, n) one step before the first sample; P has
    leading axes of length one if the runs share it. For `times` and `axis` see `scan`.
    """
    outputs = scan(lambda k, state: cycle(k, state, predict, correct, bounds), (x, P), times, axis)
    return _track(*outputs)


def filter_sample(
    state: tuple[FloatArray, FloatArray], predict: Predict, correct: Correct, bounds: Bounds | None
) -> tuple[tuple[FloatArray, FloatArray], Track]:
    """Apply `cycle` to the sample 0; return the state after it, and its track without a time."""
    state, outputs = cycle(0, state, predict, correct, bounds)
    return state, _track(*outputs)


def _track(x, P, innovation, S, *gated):
    """Return the track of outputs of `cycle`; without a gate NIS is computed here."""
    if not gated:
        gated = [densities.quadratic_form(innovation, S), _count(innovation) > 0]
    # Runs may share covariances.
    P, S = (_checks.each_run("", v, x.shape[:-1], v.shape[-2:]) for v in (P, S))
    fields = dict(zip(_FIELDS, (x, P, innovation, S, *gated), strict=True))
    for value in fields.values():
        value.setflags(write=False)
    return filled(Track, fields)


def finite(names: str, track: Track) -> Track:
    """Return the track, or raise ValueError, which blames the arguments `names`, if it overflows.

    A component that is missing leaves NaN in the innovation, and a scan without any in NIS.
    """
    innovation = track.innovation
    _checks.estimates(names, track.x, track.P, track.S)
    if not _checks.all_finite(innovation):
        _checks.estimates(names, innovation[~np.isnan(innovation)])
    if not _checks.all_finite(track.nis):
        _checks.estimates("z", np.where(_count(innovation) > 0, track.nis, 0.0))
    return track


def _part_way(before, after, weight):
    return np.where(weight < 1, before + weight * (after - before), after)


def _count(innovation):
    return (~np.isnan(innovation)).sum(axis=-1)
