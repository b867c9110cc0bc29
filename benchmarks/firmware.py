"""The firmware's C99: single beside double precision, and its speed beside the compiled filter.

The records are those of Fig 6 of Mittermaier et al. (2016), with its two-sided gate, and the same
second sampled ten times as often.
"""

import ctypes
import subprocess
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from dopplerlib import ekf, simulate
from dopplerlib.systems.mittermaier2016 import reported

FIRMWARE = Path(__file__).parents[1] / "firmware"
RUNS, ROUNDS, REPETITIONS = 1000, 7, 100
# Of each record and sample: x, NIS, updated, distance, its deviation, alarm.
NIS, UPDATED, DISTANCE_STD, ALARM, COLUMNS = 6, 7, 9, 10, 11
# The loop over records is in C, so that what is timed is no call from Python.
LOOP = """
#include "doppler_tracker.h"
#include "setting.h"
void run(long records, long samples, double T, const double *z, double *out)
{
    for (long r = 0; r < records; r++) {
        doppler_track track;
        doppler_start(&track, START, START_COVARIANCE);
        for (long k = 0; k < samples; k++) {
            doppler_real now[SENSORS];
            for (int n = 0; n < SENSORS; n++)
                now[n] = (doppler_real)*z++;
            doppler_cycle(&track, &SETTING, (doppler_real)T, now);
            doppler_decision decision = doppler_stop(&track, &SETTING);
            for (int i = 0; i < 6; i++)
                *out++ = track.x[i];
            *out++ = track.nis;
            *out++ = track.updated;
            *out++ = decision.distance;
            *out++ = decision.distance_std;
            *out++ = decision.alarm;
        }
    }
}
"""


def main():
    scenario = reported().scenario
    often = replace(scenario, T=scenario.T / 10, samples=10 * scenario.samples)
    with tempfile.TemporaryDirectory() as folder:
        double, single = (compiled(Path(folder), name) for name in ("double", "float"))
        for one, records in ((scenario, RUNS), (often, RUNS // 10)):
            _, z = simulate(one, records, rng=np.random.default_rng(2016))
            track = ekf(z, *arguments(one), gate="two-sided", keep=("P",))
            exact = double(z, one.T)
            print(f"Double beside ekf: {np.abs(exact[..., :6] - track.x).max():.0e} (m, m/s).\n")
            others = {
                "float": single(z, one.T),
                "double with shifts rounded to floats": double(z.astype(np.float32), one.T),
            }
            for name, other in others.items():
                print(f"{records} records of {z.shape[1]} samples, {name}:\n")
                compare(track, exact, other)
        _, z = simulate(scenario, 1, rng=np.random.default_rng(2016))
        speed(scenario, z, double, single)


def compiled(folder, precision):
    """Return a function z (R, K, N), T -> (R, K, COLUMNS) of the firmware."""
    (folder / "loop.c").write_text(LOOP)
    library = folder / f"{precision}.so"
    subprocess.run(
        ["gcc", "-std=c99", "-O3", "-fno-math-errno", "-ffp-contract=off", "-shared", "-fPIC",
         *(["-DDOPPLER_FLOAT"] if precision == "float" else []), f"-I{FIRMWARE}",
         "-o", library, folder / "loop.c", FIRMWARE / "doppler_tracker.c", "-lm"], check=True,
    )  # fmt: skip
    loop = ctypes.CDLL(str(library)).run

    def run(z, T):
        z = np.ascontiguousarray(z, float)
        out = np.empty((*z.shape[:2], COLUMNS))
        sizes = (ctypes.c_long(size) for size in z.shape[:2])
        loop(*sizes, ctypes.c_double(T), *(ctypes.c_void_p(a.ctypes.data) for a in (z, out)))
        return out

    return run


def arguments(scenario):
    """Return those of `ekf`, from the start of the firmware's setting."""
    s, x0 = scenario, reported().table2.x_ml.copy()
    x0[:3] -= reported().scenario.T * x0[3:]
    return s.array, x0, s.P0, s.T, s.sigma_a, s.sigma_f


def compare(track, exact, other):
    """Print the largest differences of each record, and over all of them."""
    std = np.sqrt(np.diagonal(track.P, axis1=-2, axis2=-1))
    error = np.abs(other - exact)
    relative = (error[..., :6] / std).max(axis=(1, 2))
    place, speed = (error[..., part].max(axis=(1, 2)) for part in (slice(0, 3), slice(3, 6)))
    deviation = np.abs(other[..., DISTANCE_STD] / exact[..., DISTANCE_STD] - 1).max(axis=1)
    gates, alarms = (error[..., column].sum(axis=1) for column in (UPDATED, ALARM))
    each = np.stack([relative, place, speed, 100 * deviation])
    alike = each[:, gates == 0]
    rows = {f"record {i + 1}": each[:, i] for i in range(6)}
    rows |= {
        "median of all": np.median(each, axis=1),
        f"largest of the {alike.shape[1]} with the same gates": alike.max(axis=1),
        "largest of all": each.max(axis=1),
    }
    print(
        "| largest difference | standard deviations | position (m) | velocity (m/s) "
        "| deviation of the distance |\n|---|---|---|---|---|"
    )
    for name, (sigmas, *sizes, percent) in rows.items():
        numbers = " | ".join(f"{size:.1e}" for size in sizes)
        print(f"| {name} | {sigmas:.4f} | {numbers} | {percent:.2g} % |")
    print(
        f"\nOf {error[..., 0].size} samples the gate decides differently in {gates.sum():.0f}, "
        f"the alarm in {alarms.sum():.0f}.\n"
    )


def speed(scenario, z, double, single):
    """Print the time of a step of one record, processor time, rounds interleaved."""
    clocks = {
        "`ekf`, x and NIS": lambda: ekf(z[0], *arguments(scenario), gate="two-sided", keep=()),
        "C99, double, with the decision": lambda: double(z, scenario.T),
        "C99, float, with the decision": lambda: single(z, scenario.T),
    }
    times = {name: np.empty(ROUNDS) for name in clocks}
    for k in range(-1, ROUNDS):  # the first round does not count
        for name, run in clocks.items():
            begin = time.process_time()
            for _ in range(REPETITIONS):
                run()
            times[name][k] = (time.process_time() - begin) / REPETITIONS / z.shape[1]
    print("| | ns a step, median (least to most) | ÷ `ekf` |\n|---|---|---|")
    for name, seconds in times.items():
        ns = seconds * 1e9
        ratio = np.median(seconds / times["`ekf`, x and NIS"])
        print(f"| {name} | {np.median(ns):.0f} ({ns.min():.0f} to {ns.max():.0f}) | {ratio:.2f} |")


if __name__ == "__main__":
    main()
