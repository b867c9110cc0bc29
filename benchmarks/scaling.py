"""Throughput of a Monte Carlo study by its size, in this process and in two others.

``make bench NAME=scaling`` writes ``measured/scaling.json``, which the chapter *Scaling a study*
shows: two minutes.
"""

import time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from tempfile import TemporaryDirectory

from measuring import processor_time, progress, save

from dopplerlib.evaluation.monte_carlo import run_rngs, run_study
from dopplerlib.workspace.comparison import tracker_study

SETTINGS = {"case": "A", "tracker": "ekf", "assumed": "right"}
SIZES = 10, 100, 1000, 10_000
MOST = 1000  # runs of a chunk
WORKERS = 1, 2


def nothing(settings, seed, runs):
    """Draw one number in each run: the time of all this is that of the engine."""
    return {"x": [rng.random() for rng in run_rngs(seed, runs)]}


def timed(study, runs, workers, chunk):
    """Return what a study takes, the start of its workers with it: times in s, bytes on disk."""
    with TemporaryDirectory() as folder:
        begun = time.perf_counter(), processor_time()
        options = {"seed": 1, "chunk": chunk, "folder": folder}
        if workers == 1:
            run_study(study, SETTINGS, runs, **options)
        else:
            with ProcessPoolExecutor(workers, get_context("spawn")) as pool:
                run_study(study, SETTINGS, runs, executor=pool, **options)
        wall, processor = time.perf_counter() - begun[0], processor_time() - begun[1]
        size = sum(path.stat().st_size for path in Path(folder).iterdir())
    row = {"runs": runs, "workers": workers, "chunk": chunk, "wall": wall, "processor": processor}
    progress(row)
    return row | {"bytes": size}


def main():
    """Measure, and write what was measured."""
    for study in (nothing, tracker_study):
        run_study(study, SETTINGS, 2, seed=1)  # compiled, or loaded
    rows = [timed(tracker_study, n, w, min(MOST, -(-n // 10))) for n in SIZES for w in WORKERS]
    engine = [timed(nothing, 100_000, 1, chunk) for chunk in (100, 1000, 10_000)]
    save("scaling", {"settings": SETTINGS, "rows": rows, "engine": engine})


if __name__ == "__main__":
    main()
