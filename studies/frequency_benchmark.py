"""Errors of every frequency estimator against the Cramér-Rao bound, with their outliers.

Two minutes on one processor. 36 signal-to-noise ratios, 20 000 windows of 100 samples at each, the
same ones for all estimators of the library.
"""

import json

from dopplerlib.evaluation import frequency_benchmark as benchmark
from studies._rows import rows, texts

FILES = (".json",)
PARAMETERS = {
    "seed": benchmark.SEED,
    "windows": benchmark.WINDOWS,
    "snr_db": list(benchmark.LEVELS),
}
COLUMNS = ("outliers", "ratio", "low", "high")


def parts():
    """Return the one part, of which each run is a level."""
    return [({}, len(benchmark.LEVELS), 1)]


def compute(settings, seed, runs):
    """Return what is found at some levels."""
    return texts(level(settings["snr_db"][run]) for run in runs)


def level(snr_db, names=tuple(benchmark.ESTIMATORS)):
    """Return what the file holds of one level: by name the outliers, the ratio and its interval."""
    x, f = benchmark.benchmark_windows(snr_db)
    result = {}
    for name in names:
        ratio, outliers = benchmark.benchmark_cell(name, x, f, snr_db)
        ends = (float(f"{v:.5g}") for v in (ratio.value, ratio.low, ratio.high))
        result[name] = [outliers, *ends]
    return result


def contents(found):
    """Return the table: a column by level, for each estimator."""
    levels = rows(*found)
    text = [f'  "{name}": {json.dumps(value)}' for name, value in PARAMETERS.items()]
    for k, column in enumerate(COLUMNS):
        lines = (
            f'    "{name}": {json.dumps([one[name][k] for one in levels])}'
            for name in benchmark.ESTIMATORS
        )
        text.append(f'  "{column}": {{\n' + ",\n".join(lines) + "\n  }")
    return ["{\n" + ",\n".join(text) + "\n}\n"]
