"""What the explorables of the book begin with, and their still pictures, which Node draws.

An explorable is a file in ``book/_explorables``. Its numbers come from the library when the book is
built. Its picture at the start is stored beside it, for paper and for readers without JavaScript.
"""

import json
import shutil
import subprocess
from dataclasses import replace
from functools import cache, partial
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.stats import chi2

from dopplerlib import (
    RadarArray,
    chi2_interval,
    constant_velocity,
    doppler_shift,
    ml_initialize,
    simulate,
)
from dopplerlib._files import write_text
from dopplerlib.chain.collision import _normal
from dopplerlib.derive import doppler, ekf, ring
from dopplerlib.derive.printers import javascript_function
from dopplerlib.estimation.extended_kalman import gate_bounds
from dopplerlib.evaluation.intervals import proportion_interval, quantile_interval
from dopplerlib.model.motion import dwna_gain
from dopplerlib.systems import asheim2015 as thesis
from dopplerlib.systems import mittermaier2016 as paper
from dopplerlib.systems import sombatsatien as student
from dopplerlib.systems.mittermaier2016.readings import combinations
from dopplerlib.systems.sombatsatien.descent import local_start
from dopplerlib.systems.sombatsatien.variants import LONG
from dopplerlib.workspace.stop_study import LABELS, THRESHOLDS, saved_stops
from dopplerlib.workspace.stopping import RADIUS, RULES, judge_stops
from studies.combinations import PARAMETERS
from tools.command import parser, start

FOLDER = Path(__file__).resolve().parent.parent / "book" / "_explorables"
KERNELS = "kernels.js"
TRACKER = "tracker.js"
COMPUTING = {"shifts", "blind"}  # those that use the printed kernels
TRACKING = {"hero", "filter", "repairs"}  # and those that also run a filter
TRACKERS = "truth", "bank", "paper", "ekf_bayes", "ekf", "ukf", "ring_iekf"
LENGTHS = 21, 31, 41, 61, 81, 101, 151, 201, 251, 301, 401, 501, 601, 701, 801  # samples
MOMENTS = 0.999  # confidence of the intervals that needles are compared with
RUNS = 6  # of a filter that failed
POINTS = 64  # states that are tried for a probability of collision
BIN, LAST = 0.025, 39  # s of lead, and the number of the last class
WIDTH = 360  # of a still picture in pixels: it is read on a phone, and printed


def _hero():
    """Return the simulation example of the paper, its first estimate, and a rule to stop."""
    scenario, table = paper.reported().scenario, paper.reported().table2
    gain, _ = dwna_gain(np.array(scenario.T), 1.0, "shared")
    return {
        "sensors": scenario.array.positions.tolist(),
        "perSpeed": scenario.array.doppler_per_speed,
        "x0": scenario.x0.tolist(),
        "error": (table.x_ml - scenario.x0).round(6).tolist(),
        "T": scenario.T,
        "columns": gain.T.tolist(),
        "sigmaA": scenario.sigma_a,
        "sigmaF": scenario.sigma_f,
        "fades": 30,  # samples, as in the chapter on consistency
        "samples": 1000,
        "every": 10,
        "runs": 10,
        "window": 100,
        "disc95": chi2.ppf(0.95, 2),
        "neesMedian": chi2.median(6),
        "radius": RADIUS,
        "within": RULES["within 0.3 s"][0],
        "threshold": 0.5,
        "normal": _normal(POINTS).T.tolist(),
    }


def _combinations():
    """Return what a study saved of every combination of causes."""
    saved = combinations.saved_combinations()
    return {
        "switches": combinations.SWITCHES,
        "moments": combinations.MOMENTS,
        "runs": PARAMETERS["runs"],
        "middle": chi2.median(6),
        "rows": {
            ",".join(key): {name: medians.tolist() for name, medians in row.items()}
            for key, row in saved.items()
        },
    }


def _repairs():
    """Return the student's system, the paper's ring, and the starts of some runs for each."""
    told, settings = student.reported(), student.reported().start
    s = told.scenario
    gain, _ = dwna_gain(np.array(s.T), 1.0, "shared")
    return {
        "planes": {plane: _ring(plane, settings) for plane in "zx"},
        "perSpeed": s.array.doppler_per_speed,
        "x0": s.x0.tolist(),
        "T": s.T,
        "columns": gain.T.tolist(),
        "sigmaA": s.sigma_a,
        "sigmaF": s.sigma_f,
        "P0": s.P0[0, 0],
        "samples": s.samples,
        "every": 10,
        "told": {"error": told.run.final_position_error, "nees": chi2.median(6)},
    }


def _ring(plane, settings):
    """Return the sensors of a ring, and what three searches find in the first samples of records.

    The page makes the other samples, whose noise does not depend on these.
    """
    s = student.ring_scenario(plane)
    _, z = simulate(replace(s, samples=LONG), RUNS, rng=np.random.default_rng(8))
    short, box = z[:, : settings.samples], (settings.lower, settings.upper)
    search = partial(ml_initialize, array=s.array, sigma_f=s.sigma_f, T=s.T, box=box, at="last")
    long = search(z)
    return {
        "sensors": s.array.positions.tolist(),
        "starts": {
            "one descent": _used(short, local_start(short, s.array, settings.guess, box)[0]),
            "global search": _used(short, search(short).x),
            "global, of 0.1 s": _used(z, long.x)
            | {"P": [[[float(f"{v:.6g}") for v in row] for row in P] for P in long.P]},
        },
    }


def _used(z, x):
    # Another processor may stop a search elsewhere, by less than a rounding of these.
    return {"used": z.shape[1], "x": x.round(5).tolist()}


def _shifts():
    """Return a row of sensors, a target, and a record of the paper's noise."""
    scenario, quoted = paper.reported().scenario, paper.reported().quoted
    return {
        "sensors": RadarArray.linear(6, 0.5).positions[:, :2].tolist(),
        "x": [0.6, 0.2, 0, -0.5, -0.6, 0],
        "perSpeed": scenario.array.doppler_per_speed,
        "T": scenario.T,
        "deviation": scenario.sigma_f,
        "samples": 10 * round(quoted.mle_integration_time_s / scenario.T),
    }


def _blind():
    """Return the ring of the paper, its target, and the first tenth of a second as one state."""
    scenario, quoted = paper.reported().scenario, paper.reported().quoted
    return {
        "sensors": scenario.array.positions.tolist(),
        "radius": float(np.linalg.norm(scenario.array.positions[0])),
        "x0": scenario.x0.tolist(),
        "perSpeed": scenario.array.doppler_per_speed,
        "deviation": scenario.sigma_f,
        "samples": 10 * round(quoted.mle_integration_time_s / scenario.T),
    }


def _filter():
    """Return a world in which a filter is consistent: a small start, pushes on each axis."""
    scenario, runs, window = paper.reported().scenario, 10, 100
    gain, _ = dwna_gain(np.array(scenario.T), 1.0, "per_axis")
    F, _ = constant_velocity(scenario.T, scenario.sigma_a)
    gates = {name: gate_bounds(name, len(scenario.array)) for name in ("upper", "two-sided")}
    return {
        "sensors": scenario.array.positions.tolist(),
        "perSpeed": scenario.array.doppler_per_speed,
        "start": np.linalg.solve(F, scenario.x0).tolist(),
        "spread": 0.01,
        "T": scenario.T,
        "columns": gain.T.tolist(),
        "sigmaA": scenario.sigma_a,
        "sigmaF": scenario.sigma_f,
        "samples": 1000,
        "every": 10,
        "runs": runs,
        "window": window,
        # A reader looks at a hundred moments: 95 % would be left at five of them.
        "nisBounds": chi2_interval(6, runs * window, MOMENTS),
        "neesBounds": chi2_interval(6, runs, MOMENTS),
        "disc95": chi2.ppf(0.95, 2),
        # JSON has no infinity; the upper gate has no lower bound.
        "gates": {
            name: [max(lower[-1], -1.0), upper[-1]] for name, (lower, upper) in gates.items()
        },
    }


def _window():
    """Return the first sensor's shift at 0.85 s, and how it changes: the chapter's example."""
    scenario = paper.reported().scenario
    seen = doppler_shift(scenario.truth, scenario.array)[:, 0]
    shift = CubicSpline(scenario.time, seen)
    chirp, bend = (abs(float(shift(0.85, order))) for order in (1, 2))
    return {
        "fs": 10_000,
        "tone": round(float(shift(0.85))),
        "chirp": round(chirp, -1),
        "bend": round(bend, -2),
        "snr": 20,
        "lengths": LENGTHS,
    }


def _circles():
    """Return the noise of the thesis, and its radars."""
    noise = thesis.reported().scenario.noise
    return {
        "resolution": thesis.resolutions()[0],
        "snr": noise.snr_at_zero,
        "slope": noise.snr_slope,
        "baseline": float(np.ptp(thesis.radar_positions()[:, 0])),
    }


def _stop():
    """Return what saved courses say of each tracker, rule and threshold."""
    study = saved_stops("workspace")
    hits, passes = (study.courses.kind == kind for kind in ("collision", "passing"))
    table = {
        name: {
            rule: [_decisions(study, name, rule, limit, hits, passes) for limit in THRESHOLDS]
            for rule in RULES
        }
        for name in TRACKERS
    }
    return {
        "thresholds": THRESHOLDS,
        "labels": {name: LABELS[name] for name in TRACKERS},
        "counts": {"collision": int(hits.sum()), "passing": int(passes.sum())},
        "bin": BIN,
        "table": table,
    }


def _decisions(study, name, rule, limit, hits, passes):
    """Return percentages with their intervals, the median lead, and collisions by lead."""
    judged = judge_stops(study.courses, study.of(name, rule, limit))
    lead, in_time = judged.lead[hits], judged.in_time[hits]
    decided = np.isfinite(lead)
    middle = quantile_interval(lead).value
    return [
        *_percent(~in_time),
        *_percent(judged.false[passes]),
        round(middle, 3) if np.isfinite(middle) else None,
        _by_lead(lead[in_time]),
        _by_lead(lead[decided & ~in_time]),
    ]


def _percent(events):
    interval = proportion_interval(events)
    return [round(100 * value, 2) for value in (interval.value, interval.low, interval.high)]


def _by_lead(lead):
    """Return numbers of collisions by lead in steps of `BIN`, after the number of the first step.

    The last step has the rest.
    """
    place = np.clip(np.floor(lead / BIN), 0, LAST).astype(int)
    first = int(place.min(initial=LAST))
    return [first, *np.bincount(place)[first:].tolist()]


SETTINGS = {
    "hero": _hero,
    "combinations": _combinations,
    "repairs": _repairs,
    "shifts": _shifts,
    "blind": _blind,
    "filter": _filter,
    "stop": _stop,
    "window": _window,
    "circles": _circles,
}


@cache
def settings(name):
    """Return what an explorable begins with, as JSON."""
    return json.dumps(SETTINGS[name](), separators=(",", ":"))


def scripts(name):
    """Return the names of the files that an explorable consists of, in the order of loading."""
    shared = [KERNELS] * (name in COMPUTING | TRACKING) + [TRACKER] * (name in TRACKING)
    return ["explorable.js", *shared, f"{name}.js"]


def kernels():
    """Return the text of the kernels, one object of functions."""
    blocks = [doppler.shift_block(), doppler.gradient_block(), ring.family_block(), *ekf.blocks()]
    names = ", ".join(block.name for block in blocks)
    return "\n".join(
        [
            "// Printed by `make kernels`. Do not edit: change dopplerlib.derive and print again.",
            '"use strict";\n',
            "const kernels = (() => {",
            *map(javascript_function, blocks),
            f"return {{ {names} }};",
            "})();\n",
        ]
    )


def node(name, program):
    """Return what a JavaScript expression of `explorable`, `settings` and `state` gives."""
    files = [(FOLDER / script).read_text(encoding="utf-8") for script in scripts(name)]
    ask = (
        f"const explorable = explorables.{name}, settings = {settings(name)};\n"
        f"const state = explorable.start(settings);\n"
        f"console.log(JSON.stringify({program}));"
    )
    found = subprocess.run(
        [shutil.which("node") or "node", "-"], input="\n".join([*files, ask]),
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    if found.returncode:
        raise RuntimeError(f"{name}: {found.stderr}")
    return json.loads(found.stdout)


def still(name):
    """Return the first picture of an explorable, as the inside of an SVG, and its height."""
    drawn = node(
        name,
        f"(numbers => explorable.draw(settings, state, numbers, {WIDTH}))"
        "(explorable.measure(settings, state))",
    )
    box = f'viewBox="0 0 {WIDTH} {drawn["height"]}"'
    return f'<svg xmlns="http://www.w3.org/2000/svg" {box}>{drawn["shapes"]}</svg>\n'


def main(argv=None):
    """Write the still pictures."""
    parser(__doc__).parse_args(argv)
    for name in SETTINGS:
        write_text(FOLDER / f"{name}.svg", still(name))
        print(f"book/_explorables/{name}.svg")


if __name__ == "__main__":
    start(main)
