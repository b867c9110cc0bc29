"""All algorithms for all that the document leaves open: a saved sweep, and each cell again."""

from functools import cache

import numpy as np

from ... import _checks
from ..._data import read_lines, results
from ..._hints import Index, Real, Runs, checked
from ..._records import record
from ..._typing import FloatArray
from ...signal.synthesis import iq_from_velocity
from .error_measures import MEASURES, run_measures
from .fusion_study import SEED
from .published import reported
from .velocity_filter import filter_velocity
from .velocity_paths import velocity_path
from .window_choice import WindowTable
from .window_transform import doppler_filter

RUNS = 20
SNRS_DB = (0, 10, 20, 40)
WINDOWS = (8, 16, 32, 64, 96, 5, 128)  # the last two lie beyond the declared range
GRIDS = {"4 to 96": (4, 96), "8 to 64": (8, 64)}
INTENSITIES = (7, 30, 380)
PATHS = {
    "path 1, 5 m/s²": ("path 1", 5.0),
    "path 1, 15 m/s²": ("path 1", 15.0),
    "path 2": ("path 2", None),
    "fighter": ("fighter", None),
}
APART = 10.0  # dB
SENSORS = ("equal", "10 dB apart, one variance", "10 dB apart, own variances")

STATE = 7  # in the file: algorithm 5 with the fused state fed back
_KEPT = {"1": MEASURES, "5 state": ("whole", "cee")}  # of the others all but what delay explains


@checked
@record
class FusionSweep:
    """Measures of every run of all algorithms for all that the document leaves open.

    cells (runs,): By path, signal-to-noise ratio in dB, intensity of the jerk, sensors, algorithm,
        setting (its fixed window or its set of windows) and measure, see `run_measures`. Of
        algorithms with one sensor only the better one's; "5 state" is algorithm 5 with the fused
        state fed back.

    Examples
    --------
    >>> cell = {("path 2", 0, 30, "equal", "1", "64", "cee"): np.ones(2)}
    >>> FusionSweep(cell).of("cee", "1", 64, path="path 2", snr_db=0, q=30).tolist()
    [1.0, 1.0]
    """

    cells: dict[tuple, FloatArray]

    @checked
    def of(
        self,
        measure: str,
        algorithm: str,
        setting: Index | str,
        *,
        path: str,
        snr_db: Real,
        q: Real,
        sensors: str = "equal",
    ) -> FloatArray:
        """Return one measure of one algorithm, shape (runs,); arguments are those of a key."""
        if algorithm in ("1", "2"):
            sensors = "equal"
        key = path, snr_db, q, sensors, algorithm, f"{setting}", measure
        if key not in self.cells:
            raise ValueError(f"measure, algorithm, ... must be a cell of the sweep, got {key}")
        return self.cells[key]


@checked
def sweep_cell(
    path: str, snr_db: Index, table: WindowTable, runs: Runs = RUNS, seed: Index = SEED
) -> dict[tuple, FloatArray]:
    """Simulate one path at one signal-to-noise ratio, and run everything on the same samples.

    path: One of `PATHS`.
    snr_db: Signal-to-noise ratio of a sample of the better sensor in dB.
    table: For the choice of windows, with those of `chosen`.
    runs: Number of runs. The first are the same however many follow.
    seed: Of the sweep; together with path and ratio it fixes the random numbers.
    Returns (runs,): By intensity, sensors, algorithm, setting and measure; see `FusionSweep`.

    Examples
    --------
    >>> cee = np.array([[[1.0, 2.0], [2.0, 1.0]], [[1.0, 2.0], [1.0, 2.0]]])
    >>> table = WindowTable([0, 10], [0, 20], [8, 64], cee)
    >>> len(sweep_cell("fighter", 20, table, runs=1))
    333
    """
    name, gentle = PATHS[_checks.one_of("path", path, tuple(PATHS))]
    truth = velocity_path(name, gentle)
    rng = np.random.default_rng([seed, 1, tuple(PATHS).index(path), snr_db])
    x, levels = _records(truth, snr_db, rng.spawn(runs))
    doppler = doppler_filter(x, np.union1d(table.windows, WINDOWS))
    found = {}
    for sensors in SENSORS if name != "fighter" else SENSORS[:1]:
        two = [0, 1] if sensors == "equal" else [0, 2]
        assumed = levels[two]
        if sensors == "10 dB apart, one variance":  # the mean of both
            assumed = -10 * np.log10(np.mean(10 ** (-assumed / 10)))
        for q in INTENSITIES:
            for key, velocity in _velocities(doppler, two, assumed, q, table):
                if key[0] in ("1", "2") and sensors != "equal":
                    continue
                measures = run_measures(truth, velocity)
                for measure in _KEPT.get(key[0], ("whole", "maneuver", "constant", "cee", "delay")):
                    found[q, sensors, *key, measure] = measures[measure]
    return found


def _records(truth, snr_db, children):
    """Return samples of three sensors, shape (runs, 3, n), and their ratios; the last is worse."""
    levels = np.array([snr_db, snr_db, snr_db - APART], dtype=float)
    T, wavelength = reported().stated.T, reported().chosen.wavelength
    x = [
        [
            iq_from_velocity(truth.v, T, wavelength, level, rng=one)
            for level, one in zip(levels, child.spawn(3), strict=True)
        ]
        for child in children
    ]
    return np.array(x), levels


def _velocities(doppler, two, assumed, q, table):
    """Yield the velocities of all algorithms, by algorithm and setting."""
    for window in WINDOWS:
        track = filter_velocity(doppler.part([window], two), assumed, window=window, q=q)
        yield ("1", str(window)), track.x[:, 0, :, 0]
        yield ("3", str(window)), track.fused_x[..., 0]
    for grid, (least, most) in GRIDS.items():
        windows = table.windows[(least <= table.windows) & (table.windows <= most)]
        some, choose = doppler.part(windows, two), table.only(windows)
        for feedback in ("own", "fused", "state"):
            track = filter_velocity(some, assumed, table=choose, feedback=feedback, q=q)
            if feedback == "own":
                yield ("2", grid), track.x[:, 0, :, 0]
            name = {"own": "4", "fused": "5", "state": "5 state"}[feedback]
            yield (name, grid), track.fused_x[..., 0]


@cache
def saved_sweep() -> FusionSweep:
    """Read the sweep as ``make study NAME=velocity_fusion`` wrote it.

    Examples
    --------
    >>> {len(runs) for runs in saved_sweep().cells.values()}
    {20}
    """
    rows = np.loadtxt(
        read_lines("velocity_fusion.sweep.csv", folder=results), delimiter=",", skiprows=1
    )
    grids = {str(least): grid for grid, (least, _) in GRIDS.items()}
    cells = {}
    for block in np.split(rows, np.flatnonzero(np.any(np.diff(rows[:, :6], axis=0), axis=1)) + 1):
        path, snr_db, q, sensors, number, setting = (int(one) for one in block[0, :6])
        algorithm = "5 state" if number == STATE else str(number)
        name = str(setting) if algorithm in ("1", "3") else grids[str(setting)]
        key = tuple(PATHS)[path - 1], snr_db, q, SENSORS[sensors - 1], algorithm, name
        for measure, values in zip(MEASURES, block[:, 6:].T, strict=True):
            if not np.isnan(values).any():
                cells[*key, measure] = values
    return FusionSweep(cells)
