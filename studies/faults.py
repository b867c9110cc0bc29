"""Trackers by faults: errors, consistency, lost targets, and decisions to stop.

Some thirty minutes on one processor. All trackers of a fault have the same records, and all faults
the same truths and noise.
"""

import json
from functools import cache

import numpy as np

from dopplerlib.evaluation.intervals import mean_interval, quantile_interval, rms_interval
from dopplerlib.workspace.comparison import EVERY
from dopplerlib.workspace.errors import BOUNDS, FAR, track_errors
from dopplerlib.workspace.faults import FAULTS, with_fault
from dopplerlib.workspace.stopping import (
    SAMPLES,
    courses_along,
    draw_courses,
    judge_stops,
    stop_times,
)
from dopplerlib.workspace.targets import INTERVAL, SIGMA_F, draw_records, draw_targets
from dopplerlib.workspace.trackers import track_targets
from studies._rows import rows, texts

FILES = (".json",)
COMPILED = (
    "bank", "gated_bank", "moving_bank", "paper", "gated_start", "gate_paper", "gate_upper",
)  # fmt: skip
SLOW = "gate_each", "huber", "student_t", "adaptive", "gated_start_ukf"
DECIDING = "bank", "gated_bank", "moving_bank", "paper"
PARAMETERS = {
    "seed": 8087, "runs": 500, "compiled": COMPILED, "times": [0.2, 0.5], "slow": SLOW,
    "slow_times": [0.2], "courses": 250, "moved": 4000, "deciding": DECIDING,
    "rule": "within 0.3 s", "threshold": 0.5,
}  # fmt: skip
KINDS = "collision", "passing"  # near misses are left out
BEGIN = 10  # samples of the start
STEPS = 5  # samples from one decision to the next
MOVING = "acceleration", "turn"  # kinds of faults that make another course
FIRST = 3  # runs whose errors are kept, to be computed again


def parts():
    """Return the one part, of which each run is a fault."""
    return [({}, len(FAULTS), 1)]


def compute(settings, seed, runs):
    """Return what the trackers make of some faults."""
    return texts(row([*FAULTS][run]) for run in runs)


def row(fault):
    """Return what each tracker makes of a fault."""
    errors = {name: errors_of(fault, name) for name in (*COMPILED, *SLOW)}
    decisions = {name: decisions_of(fault, name) for name in DECIDING}
    records.cache_clear()
    begun.cache_clear()
    return {"fault": fault, "errors": errors, "decisions": decisions}


def errors_of(fault, tracker):
    """Return statistics of the errors of a tracker at each time, and the first errors."""
    found, times = errors_in(fault, tracker), times_of(tracker)
    first = [_short(value) for value in found.position[:FIRST, place(times[0])]]
    return {"first": first, "at": [summary(found, place(time)) for time in times]}


def place(time):
    """Return the number of the output at a time."""
    return round(time / INTERVAL) // EVERY - 1


def times_of(tracker):
    """Return the times at which errors are taken."""
    return PARAMETERS["slow_times" if tracker in SLOW else "times"]


def errors_in(fault, tracker, runs=None):
    """Return the errors of a tracker in the first runs."""
    paths, z = records(fault, runs or PARAMETERS["runs"])
    samples = round(times_of(tracker)[-1] / INTERVAL)
    paths, z = paths[:, :samples], z[:, :samples]
    own = tracker in ("bank", "gated_bank", "moving_bank", "paper")
    x, P = tracked(fault, tracker, z, EVERY, None if own else begun(fault, len(z)))
    return track_errors(paths, x, P, every=EVERY)


@cache
def records(fault, runs, kind=None):
    """Return paths and records with a fault: targets from the prior, or courses of a kind.

    Where a fault moves the target, it is the path with the fault that has to be of that kind.
    """
    f, place = FAULTS[fault], 0 if kind is None else len(kind)
    truths, noise, faults = np.random.default_rng([PARAMETERS["seed"], place]).spawn(3)
    if kind is None:
        samples = round(max(PARAMETERS["times"]) / INTERVAL)
        paths = draw_targets(runs, rng=truths, samples=samples)
    elif f.kind in MOVING:
        return _moved_courses(f, runs, kind, truths, noise, faults)
    else:
        paths = _drawn(runs, kind, place)
    return with_fault(paths, draw_records(paths, rng=noise), f.kind, f.size, rng=faults)


@cache
def begun(fault, runs):
    """Return the start that most trackers share, that of "gated_start"."""
    z = records(fault, runs)[1][:, :BEGIN]
    x, P = tracked(fault, "gated_bank", z, BEGIN)
    return x[:, 0], P[:, 0]


@cache
def _drawn(runs, kind, place):
    """Return courses of a kind, the same for all faults."""
    truths = np.random.default_rng([PARAMETERS["seed"], place]).spawn(3)[0]
    return draw_courses(runs, kind, rng=truths).paths


def _moved_courses(f, runs, kind, truths, noise, faults):
    """Return courses of a kind among many targets that a fault has moved; few, if they are rare."""
    drawn = draw_targets(PARAMETERS["moved"], rng=truths, samples=SAMPLES)
    paths, z = with_fault(drawn, draw_records(drawn, rng=noise), f.kind, f.size, rng=faults)
    right = np.flatnonzero(courses_along(paths).kind == kind)[:runs]
    return paths[right], z[right]


def tracked(fault, tracker, z, every, start=None):
    """Return the estimates of a tracker that does not know of the fault."""
    assumed = FAULTS[fault].assumed * SIGMA_F
    return track_targets(z, tracker, every=every, sigma_f=assumed, start=start)


def summary(errors, place):
    """Return the statistics over runs whose records last until then."""
    there = ~np.isnan(errors.position_bound[:, place])
    nees, position, bound = (
        value[there, place] for value in (errors.nees, errors.position, errors.position_bound)
    )
    known = np.isfinite(position)  # the others have been given up
    lost = (position > FAR) & (position > BOUNDS * bound)
    out = {
        "runs": int(there.sum()),
        "given up": int(np.sum(~known)),
        "lost": int(lost.sum()),
        "median error": _ends(quantile_interval(position)),
        "median NEES": _ends(quantile_interval(nees)),
    }
    if known.sum() > 1:
        out["rms error"] = _ends(rms_interval(position[known]))
        out["mean NEES"] = _ends(mean_interval(nees[known]))
    return out


def decisions_of(fault, tracker):
    """Return how many courses there are of either kind, and how often the machine is wrong."""
    (into, alarm), (_, other) = (decided(fault, tracker, kind) for kind in KINDS)
    judged = judge_stops(into, alarm) if len(alarm) else None
    return {
        "collisions": len(alarm),
        "late": int(np.sum(~judged.in_time)) if judged else 0,
        "passing": len(other),
        "false": int(np.sum(other < np.inf)),
        "median lead": _short(float(np.median(judged.lead))) if judged else None,
    }


def decided(fault, tracker, kind):
    """Return courses of a kind, and when the machine decides to stop."""
    paths, z = records(fault, PARAMETERS["courses"], kind)
    if not len(paths):
        return None, np.zeros(0)
    x, P = tracked(fault, tracker, z, STEPS)
    rule, threshold = PARAMETERS["rule"], PARAMETERS["threshold"]
    return courses_along(paths), stop_times(paths, x, P, rule, threshold, every=STEPS)


def contents(found):
    """Return all rows, a line for each fault and tracker."""
    lines = []
    for fault in rows(*found):
        for name, errors in fault["errors"].items():
            one = {"fault": fault["fault"], "tracker": name, **errors}
            if name in fault["decisions"]:
                one["decisions"] = fault["decisions"][name]
            lines.append("    " + json.dumps(one, separators=(",", ":"), ensure_ascii=False))
    return ['{\n  "rows": [\n' + ",\n".join(lines) + "\n  ]\n}\n"]


def _ends(interval):
    return [_short(value) for value in (interval.value, interval.low, interval.high)]


def _short(value):
    """Return three digits; None is infinite."""
    return float(f"{value:.3g}") if np.isfinite(value) else None
