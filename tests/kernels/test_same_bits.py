"""One text, many machines: the same bits from Python, NumPy, numba, C and JavaScript.

Equal to the last bit, not close: the printers use only operations that IEEE 754 rounds exactly, in
one order. This is what lets a filter of ten thousand lanes be tested by one run of plain Python.
"""

import ctypes
import json
import shutil
import subprocess
import types

import numpy as np
import pytest
from numba import njit

from dopplerlib.derive import ekf as derive
from dopplerlib.derive.doppler import gradient_block
from dopplerlib.derive.printers import c99_function, javascript_function
from dopplerlib.kernels import doppler, ekf

RUNS, SENSORS, LANES = 37, 6, 16  # 37 leaves the last group of lanes partly empty
BLOCKS = {
    block.name: block
    for block in (
        derive.predict_block(), derive.linearize_block(), derive.project_block(),
        derive.update_block(),
    )
}  # fmt: skip


def rows(first, size, array="work"):
    """Return row numbers in the work array with the array of one sensor below it."""
    first += ekf.ROWS if array == "sensor" else 0
    return list(range(first, first + size))


STATE, COVARIANCE = rows(ekf.PREDICTED, 6), rows(ekf.COVARIANCE, 21)
CORRECTION, NIS, NOISE = rows(ekf.CORRECTION, 6), rows(ekf.NIS, 1), rows(ekf.PROCESS_NOISE, 21)
MEASUREMENT, SEEN = rows(ekf.MEASUREMENT, 1, "sensor"), rows(ekf.SEEN, 1, "sensor")
INNOVATION, GRADIENT = rows(ekf.INNOVATION, 1, "sensor"), rows(ekf.GRADIENT, 6, "sensor")
PROJECTION = rows(ekf.PROJECTION, 6, "sensor")
IN = {  # rows of the inputs of a block, in its order, before its arguments
    "predict": STATE + COVARIANCE + NOISE,
    "linearize": STATE + MEASUREMENT,
    "project": COVARIANCE + GRADIENT,
    "update": COVARIANCE + CORRECTION + NIS + SEEN + INNOVATION + GRADIENT,
}
OUT = {  # rows where the outputs of a block belong, in its order
    "predict": STATE + COVARIANCE,
    "linearize": INNOVATION + GRADIENT,
    "project": PROJECTION,
    "update": COVARIANCE + CORRECTION + NIS,
}


@pytest.fixture(scope="module")
def cycle(random_cycle):
    return random_cycle(np.random.default_rng(2016), SENSORS, RUNS, missing=0.1)


@pytest.fixture(scope="module")
def expected(cycle):
    """Return all rows after one cycle, each run with plain Python numbers."""
    work, sensors = start(cycle)
    columns = []
    for run in range(RUNS):
        numbers = [array[:, run].tolist() for array in (work, *sensors)]
        run_cycle(cycle, numbers[0], numbers[1:], ekf, 1, 0)
        columns.append(np.concatenate(numbers))
    return np.array(columns, dtype=float).T


def start(cycle):
    """Return the work array, (ROWS, RUNS), and one for each sensor, before the cycle."""
    sensors = np.zeros((SENSORS, ekf.SENSOR_ROWS, RUNS))
    for n, sensor in enumerate(sensors):
        sensor[ekf.MEASUREMENT], sensor[ekf.SEEN] = cycle.measured(n)
    return cycle.work(), list(sensors)


def steps(cycle):
    """Yield the name of a kernel, the number of its sensor or None, and its arguments."""
    yield "predict", None, [cycle.T]
    for n, position in enumerate(cycle.sensors.tolist()):
        yield "linearize", n, [*position, cycle.g]
    for n in range(SENSORS):
        yield "project", n, []
    for n, variance in enumerate(cycle.variance.tolist()):
        yield "update", n, [variance]


def run_cycle(cycle, work, sensors, kernels, lanes, lane):
    """Run one cycle in place, with ``kernels.predict`` and so on."""
    for name, n, arguments in steps(cycle):
        arrays = [work] if n is None else [work, sensors[n]]
        getattr(kernels, name)(*arrays, lanes, lane, *arguments)


def assert_same_bits(got, expected):
    """Also tells 0.0 from -0.0, and says where the first difference is."""
    got, expected = (np.ascontiguousarray(a).view(np.int64) for a in (got, expected))
    differs = np.argwhere(got != expected)
    assert not len(differs), f"{len(differs)} of {got.size} differ, the first at {differs[0]}"


def run_on_arrays(cycle):
    """Run a cycle on arrays (rows, RUNS): one call for all runs."""
    work, sensors = start(cycle)
    run_cycle(cycle, work, sensors, ekf, 1, 0)
    return np.concatenate([work, *sensors])


def run_in_lanes(cycle, kernels, lanes):
    """Run a cycle on flat arrays of `lanes` runs each, as the compiled loop does."""
    work, sensors = start(cycle)
    before = np.concatenate([work, *sensors])
    result = np.empty_like(before)
    for first in range(0, RUNS, lanes):
        part = slice(first, min(first + lanes, RUNS))
        width = part.stop - part.start
        flat = np.zeros((len(before), lanes))
        flat[:, :width] = before[:, part]
        work, *sensors = (
            piece.reshape(-1)
            for piece in np.split(flat, range(ekf.ROWS, len(before), ekf.SENSOR_ROWS))
        )
        run_cycle(cycle, work, sensors, kernels, lanes, width)
        result[:, part] = flat[:, :width]
    return result


def test_numpy_arrays_give_the_same_bits(cycle, expected):
    assert_same_bits(run_on_arrays(cycle), expected)


@pytest.fixture(scope="module")
def compiled():
    """Return the kernels compiled, each in a loop over the first `width` lanes."""
    predict, linearize, project, update = (
        njit(forceinline=True, error_model="numpy")(getattr(ekf, name)) for name in BLOCKS
    )

    @njit(error_model="numpy")
    def predict_all(work, lanes, width, T):
        for lane in range(width):
            predict(work, lanes, lane, T)

    @njit(error_model="numpy")
    def linearize_all(work, sensor, lanes, width, s_x, s_y, s_z, g):
        for lane in range(width):
            linearize(work, sensor, lanes, lane, s_x, s_y, s_z, g)

    @njit(error_model="numpy")
    def project_all(work, sensor, lanes, width):
        for lane in range(width):
            project(work, sensor, lanes, lane)

    @njit(error_model="numpy")
    def update_all(work, sensor, lanes, width, variance):
        for lane in range(width):
            update(work, sensor, lanes, lane, variance)

    loops = (predict_all, linearize_all, project_all, update_all)
    return types.SimpleNamespace(**dict(zip(BLOCKS, loops, strict=True)))


@pytest.mark.parametrize("lanes", [1, LANES])
def test_numba_gives_the_same_bits_alone_and_in_lanes(cycle, expected, compiled, lanes):
    assert_same_bits(run_in_lanes(cycle, compiled, lanes), expected)


def run_with_scalars(cycle, call):
    """Run a cycle with ``call(block name, rows of numbers) -> rows of outputs``."""
    work, sensors = start(cycle)
    for name, n, arguments in steps(cycle):
        both = np.concatenate([work, np.zeros_like(sensors[0]) if n is None else sensors[n]])
        inputs = [[*column, *arguments] for column in both[IN[name]].T.tolist()]
        both[OUT[name]] = np.array(call(name, inputs)).T
        work = both[: ekf.ROWS]
        if n is not None:
            sensors[n] = both[ekf.ROWS :]
    return np.concatenate([work, *sensors])


@pytest.fixture(scope="module")
def c99(tmp_path_factory):
    """Return a caller of the printed C99."""
    compiler = shutil.which("gcc") or shutil.which("cc")
    if compiler is None:
        pytest.skip("no C compiler on this machine")
    folder = tmp_path_factory.mktemp("c99")
    blocks = {**BLOCKS, "doppler_shift_and_gradient": gradient_block()}
    (folder / "kernels.c").write_text("\n".join(map(c99_function, blocks.values())))
    # Without -ffp-contract=off some processors would multiply and add with one rounding.
    subprocess.run(
        [compiler, "-std=c99", "-O2", "-ffp-contract=off", "-Wall", "-Wextra", "-Werror",
         "-shared", "-fPIC", "-o", "kernels.so", "kernels.c", "-lm"],
        cwd=folder, check=True,
    )  # fmt: skip
    library = ctypes.CDLL(str(folder / "kernels.so"))

    def call(name, rows):
        block = blocks[name]
        function = getattr(library, name)
        function.restype = None
        function.argtypes = [ctypes.c_double] * len(block.inputs) + [ctypes.c_void_p]
        out = np.empty((len(rows), len(block.outputs)))
        for row, result in zip(rows, out, strict=True):
            function(*row, result.ctypes.data)
        return out

    return call


@pytest.fixture(scope="module")
def javascript():
    """Return a caller of the printed JavaScript."""
    node = shutil.which("node")
    if node is None:
        pytest.skip("no node on this machine")
    blocks = {**BLOCKS, "doppler_shift_and_gradient": gradient_block()}
    text = "\n".join(map(javascript_function, blocks.values()))

    def call(name, rows):
        # Numbers travel as JSON: the shortest decimal that reads back as the same double. JSON
        # knows no -0, so JavaScript sends it as text.
        program = (
            f'"use strict";\n{text}\nconst rows = {json.dumps(rows)};\n'
            f"const send = (value) => Object.is(value, -0) ? '-0.0' : value;\n"
            f"console.log(JSON.stringify(rows.map((row) => {name}(...row).map(send))));"
        )
        done = subprocess.run([node, "-"], input=program, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return [[float(value) for value in row] for row in json.loads(done.stdout)]

    return call


def test_c99_gives_the_same_bits(cycle, expected, c99):
    assert_same_bits(run_with_scalars(cycle, c99), expected)


def test_javascript_gives_the_same_bits(cycle, expected, javascript):
    assert_same_bits(run_with_scalars(cycle, javascript), expected)


@pytest.mark.parametrize("language", ["c99", "javascript", "numpy", "numba"])
def test_shift_and_gradient_are_the_same_bits_in_every_language(language, request):
    rng = np.random.default_rng(6)
    rows = np.concatenate(
        [rng.normal(size=(500, 9)) * 10 ** rng.uniform(-3, 3, (500, 1)), np.full((500, 1), 160.0)],
        axis=1,
    ).tolist()
    function = doppler.doppler_shift_and_gradient
    expected = np.array([function(*row) for row in rows])
    if language == "numpy":
        got = np.stack(function(*np.transpose(rows)), axis=1)
    elif language == "numba":
        compiled = njit(error_model="numpy")(function)
        got = np.array([compiled(*row) for row in rows])
    else:
        got = np.array(request.getfixturevalue(language)("doppler_shift_and_gradient", rows))
    assert_same_bits(got, expected)
