"""One text, many machines: the same bits from Python, NumPy, numba, C and JavaScript.

Equal to the last bit, not close: the printers use only operations that IEEE 754 rounds exactly, in
one order. This is what lets a filter of ten thousand lanes be tested by one run of plain Python.
"""

import ctypes
import json
import shutil
import subprocess

import numpy as np
import pytest
from numba import njit

from dopplerlib.derive import ekf as derive
from dopplerlib.derive.doppler import gradient_block
from dopplerlib.derive.printers import c99_function, javascript_function
from dopplerlib.kernels import doppler, ekf

RUNS, SENSORS, LANES = 37, 6, 16  # 37 leaves the last group of lanes partly empty
BLOCKS = {"predict": derive.predict_block(), "update": derive.update_block()}
OUT = {  # rows where the outputs of a block belong, in its order
    "predict": [*range(ekf.PREDICTED, ekf.PREDICTED + 6), *range(6, 6 + 21)],
    "update": [
        *range(ekf.COVARIANCE, ekf.COVARIANCE + 21),
        *range(ekf.CORRECTION, ekf.CORRECTION + 6),
        ekf.NIS,
        ekf.INNOVATION,
        *range(ekf.GRADIENT, ekf.GRADIENT + 6),
    ],
}
IN = {  # rows of the inputs of a block, before its arguments
    "predict": [*range(ekf.PREDICTED, 6), *range(6, 27), *range(ekf.PROCESS_NOISE, ekf.ROWS)],
    "update": [*range(ekf.PREDICTED, ekf.SEEN + 1)],
}


@pytest.fixture(scope="module")
def cycle(random_cycle):
    return random_cycle(np.random.default_rng(2016), SENSORS, RUNS, missing=0.1)


@pytest.fixture(scope="module")
def expected(cycle):
    """Return the work array after one cycle, each run with plain Python numbers."""
    columns = []
    for run, column in enumerate(cycle.work().T):
        work = column.tolist()
        ekf.predict(work, 1, 0, cycle.T)
        for n, (sensor, variance) in enumerate(parameters(cycle)):
            work[ekf.MEASUREMENT], work[ekf.SEEN] = (a.tolist()[run] for a in cycle.measured(n))
            ekf.update(work, 1, 0, *sensor, cycle.g, variance)
        columns.append(work)
    return np.array(columns, dtype=float).T


def parameters(cycle):
    return list(zip(cycle.sensors.tolist(), cycle.variance.tolist(), strict=True))


def assert_same_bits(got, expected):
    """Also tells 0.0 from -0.0, and says where the first difference is."""
    got, expected = (np.ascontiguousarray(a).view(np.int64) for a in (got, expected))
    differs = np.argwhere(got != expected)
    assert not len(differs), f"{len(differs)} of {got.size} differ, the first at {differs[0]}"


def run_on_arrays(cycle, predict, update):
    """Run a cycle on work of shape (ROWS, RUNS): one call for all runs."""
    work = cycle.work()
    predict(work, 1, 0, cycle.T)
    for n, (sensor, variance) in enumerate(parameters(cycle)):
        work[ekf.MEASUREMENT], work[ekf.SEEN] = cycle.measured(n)
        update(work, 1, 0, *sensor, cycle.g, variance)
    return work


def run_in_lanes(cycle, predict, update, lanes):
    """Run a cycle on flat work arrays of `lanes` runs each, as the compiled loop does."""
    result = np.empty((ekf.ROWS, RUNS))
    start = cycle.work()
    for first in range(0, RUNS, lanes):
        part = slice(first, min(first + lanes, RUNS))
        width = part.stop - part.start
        work = np.zeros((ekf.ROWS, lanes))
        work[:, :width] = start[:, part]
        flat = work.reshape(-1)
        predict(flat, lanes, width, cycle.T)
        for n, (sensor, variance) in enumerate(parameters(cycle)):
            z, seen = cycle.measured(n)
            work[ekf.MEASUREMENT, :width], work[ekf.SEEN, :width] = z[part], seen[part]
            update(flat, lanes, width, *sensor, cycle.g, variance)
        result[:, part] = work[:, :width]
    return result


def test_numpy_arrays_give_the_same_bits(cycle, expected):
    assert_same_bits(run_on_arrays(cycle, ekf.predict, ekf.update), expected)


@pytest.fixture(scope="module")
def compiled():
    """Return both kernels compiled, each in a loop over the first `width` lanes."""
    inner_predict = njit(forceinline=True, error_model="numpy")(ekf.predict)
    inner_update = njit(forceinline=True, error_model="numpy")(ekf.update)

    @njit(error_model="numpy")
    def predict(work, lanes, width, T):
        for lane in range(width):
            inner_predict(work, lanes, lane, T)

    @njit(error_model="numpy")
    def update(work, lanes, width, s_x, s_y, s_z, g, variance):
        for lane in range(width):
            inner_update(work, lanes, lane, s_x, s_y, s_z, g, variance)

    return predict, update


@pytest.mark.parametrize("lanes", [1, LANES])
def test_numba_gives_the_same_bits_alone_and_in_lanes(cycle, expected, compiled, lanes):
    assert_same_bits(run_in_lanes(cycle, *compiled, lanes), expected)


def run_with_scalars(cycle, call):
    """Run a cycle with ``call(block name, rows of numbers) -> rows of outputs``."""
    work = cycle.work()
    arguments = {"predict": [[cycle.T]], "update": [[*s, cycle.g, r] for s, r in parameters(cycle)]}
    for name, steps in arguments.items():
        for n, step in enumerate(steps):
            if name == "update":
                work[ekf.MEASUREMENT], work[ekf.SEEN] = cycle.measured(n)
            inputs = [[*column, *step] for column in work[IN[name]].T.tolist()]
            work[OUT[name]] = np.array(call(name, inputs)).T
    return work


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
