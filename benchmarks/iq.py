"""From IQ to Doppler: time for a second of six sensors, and for a sweep over many windows.

``make bench NAME=iq`` prints Markdown. Processor time of one thread: the
wall time of a machine that does nothing else. Rounds are interleaved, the first does not count.
"""

import os
import platform
import time

import numpy as np

from dopplerlib import ml_frequency, sliding_doppler
from dopplerlib.signal import frequency, interpolation, phase
from dopplerlib.signal.synthesis import tone

FS, WINDOW, HOP, SENSORS = 10e3, 250, 10, 6
ROUNDS = 21
SWEEP = 100_000


def main():
    rng = np.random.default_rng(1)
    record = tone(np.linspace(80, 120, SENSORS), FS, int(FS), 10.0, rng=rng, chirp=-30.0)
    windows = tone(rng.uniform(-400, 400, SWEEP), FS, WINDOW, 10.0, rng=rng)
    print(f"{platform.processor() or platform.machine()}, Python {platform.python_version()}, ")
    print(f"load {', '.join(f'{load:.1f}' for load in os.getloadavg())} at the start.\n")
    count = SENSORS * ((record.shape[-1] - WINDOW) // HOP + 1)
    print(f"One second, {SENSORS} sensors, {count} windows of {WINDOW} samples:\n")
    print("| estimator | ms: median (least to most) | µs a window |\n|---|---|---|")
    calls = {
        "`ml_frequency`": lambda: sliding_doppler(record, FS, WINDOW, HOP),
        "`ml_frequency`, band ±400 Hz": lambda: sliding_doppler(
            record, FS, WINDOW, HOP, band=(-400, 400)
        ),
        "`candan`": lambda: sliding_doppler(record, FS, WINDOW, HOP, interpolation.candan),
        "`aboutanios_mulgrew`": lambda: sliding_doppler(
            record, FS, WINDOW, HOP, interpolation.aboutanios_mulgrew
        ),
    }
    for name, ms in timed(calls, ROUNDS).items():
        least, middle, most = 1e3 * np.quantile(ms, [0, 0.5, 1])
        print(f"| {name} | {middle:.1f} ({least:.1f} to {most:.1f}) | {1e3 * middle / count:.2f} |")
    print(f"\n{SWEEP} windows of {WINDOW} samples, one call:\n")
    print("| estimator | s |\n|---|---|")
    estimators = [
        ml_frequency,
        frequency.ml_frequency_dc,
        interpolation.candan,
        phase.kay,
    ]
    sweeps = {f"`{e.__name__}`": lambda e=e: e(windows, FS) for e in estimators}
    for name, s in timed(sweeps, 1).items():
        print(f"| {name} | {np.median(s):.2f} |")
    print(f"\nLoad at the end: {', '.join(f'{load:.1f}' for load in os.getloadavg())}.")


def timed(calls, rounds):
    """Return the processor times of each call, in interleaved rounds, without the first."""
    times = {name: [] for name in calls}
    for k in range(-1, rounds):
        for name, call in calls.items():
            began = time.process_time()
            call()
            if k >= 0:
                times[name].append(time.process_time() - began)
    return times


if __name__ == "__main__":
    main()
