"""Errors of every frequency estimator against the Cramér-Rao bound, with their outliers.

Two minutes on one processor. 36 signal-to-noise ratios, 20 000 windows of 100 samples at each, the
same ones for all estimators of the library.
"""

import json

from dopplerlib.evaluation import frequency_benchmark as benchmark

FILES = (".json",)
PARAMETERS = {
    "seed": benchmark.SEED,
    "windows": benchmark.WINDOWS,
    "snr_db": list(benchmark.LEVELS),
}
COLUMNS = ("outliers", "ratio", "low", "high")


def items():
    """Return the levels."""
    return benchmark.LEVELS


def rows(items):
    """Yield what is found at each level."""
    for snr_db in items:
        yield level(snr_db)


def level(snr_db, names=tuple(benchmark.ESTIMATORS)):
    """Return what the file holds of one level: by name the outliers, the ratio and its interval."""
    x, f = benchmark.benchmark_windows(snr_db)
    result = {}
    for name in names:
        ratio, outliers = benchmark.benchmark_cell(name, x, f, snr_db)
        ends = (float(f"{v:.5g}") for v in (ratio.value, ratio.low, ratio.high))
        result[name] = [outliers, *ends]
    return result


def contents(rows):
    """Return the table: a column by level, for each estimator."""
    parts = [f'  "{name}": {json.dumps(value)}' for name, value in PARAMETERS.items()]
    for k, column in enumerate(COLUMNS):
        lines = (
            f'    "{name}": {json.dumps([found[name][k] for found in rows])}'
            for name in benchmark.ESTIMATORS
        )
        parts.append(f'  "{column}": {{\n' + ",\n".join(lines) + "\n  }")
    return ["{\n" + ",\n".join(parts) + "\n}\n"]
