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

from dopplerlib._straight import straight
from dopplerlib.derive import ekf as derive
from dopplerlib.derive import links as moving
from dopplerlib.derive import ring_coordinates as ring
from dopplerlib.derive.doppler import GRADIENT, STATE, gradient_block
from dopplerlib.derive.printers import c99_function, javascript_function
from dopplerlib.kernels import doppler, ekf, links, ring_coordinates

RUNS, SENSORS, LANES = 37, 6, 16  # 37 leaves the last group of lanes partly empty
BLOCKS = {block.name: block for block in derive.blocks()}
KERNELS = {name: getattr(ekf, name) for name in BLOCKS}
WITH_SENSOR = {"linearize", "project", "update"}
BLOCKS["doppler_shift_and_gradient"] = gradient_block()
BLOCKS["leg_shift_and_gradient"] = moving.gradient_block()
RING = {block.name: block for block in ring.blocks()}
BLOCKS |= RING

PLACES = {}  # array and row of each symbol, by name
for _array, _start, _symbols in [
    ("work", ekf.PREDICTED, STATE),
    ("work", ekf.FACTORS, derive.FACTORS),
    ("work", ekf.CORRECTION, derive.CORRECTION),
    ("work", ekf.NIS, [derive.NIS]),
    ("work", ekf.COVARIANCE, derive.COVARIANCE),
    ("sensor", ekf.MEASUREMENT, [derive.MEASUREMENT]),
    ("sensor", ekf.VARIANCE, [derive.VARIANCE]),
    ("sensor", ekf.INNOVATION, [derive.INNOVATION]),
    ("sensor", ekf.GRADIENT, GRADIENT),
    ("sensor", ekf.PROJECTION, derive.PROJECTION),
    ("sensor", ekf.WEIGHTED, derive.WEIGHTED),
]:
    for _row, _symbol in enumerate(_symbols, _start):
        PLACES[_symbol.name] = PLACES[f"{_symbol.name}_new"] = _array, _row


@pytest.fixture(scope="module")
def cycle(random_cycle):
    return random_cycle(np.random.default_rng(2016), SENSORS, RUNS)


def run(cycle, kernels, work, sensors, lanes=1, lane=0):
    """Run a cycle on `work` and one array for each sensor, which hold what it measured."""
    kernels["predict"](work, lanes, lane, cycle.T)
    for g in cycle.G.T.tolist():
        kernels["add_noise"](work, lanes, lane, *g)
    for sensor, position in zip(sensors, cycle.sensors.tolist(), strict=True):
        kernels["linearize"](work, sensor, lanes, lane, *position, cycle.g)
        kernels["project"](work, sensor, lanes, lane)
    for sensor in sensors:
        kernels["update"](work, sensor, lanes, lane)
    kernels["covariance"](work, lanes, lane)


def sensor_rows(cycle):
    """Return the arrays of the sensors before the cycle, (SENSORS, SENSOR_ROWS, RUNS)."""
    rows = np.zeros((SENSORS, ekf.SENSOR_ROWS, RUNS))
    for n in range(SENSORS):
        rows[n, ekf.MEASUREMENT], rows[n, ekf.VARIANCE] = cycle.z[:, n], cycle.variance[n]
    return rows


def everything(work, sensors):
    return np.concatenate([work, *sensors])


@pytest.fixture(scope="module")
def expected(cycle):
    """Return all rows after one cycle, each run with plain Python numbers."""
    columns = []
    for i in range(RUNS):
        work = cycle.work()[:, i].tolist()
        sensors = sensor_rows(cycle)[:, :, i].tolist()
        run(cycle, KERNELS, work, sensors)
        columns.append(np.concatenate([work, *sensors]))
    return np.array(columns).T


def assert_same_bits(got, expected):
    """Also tells 0.0 from -0.0, and says where the first difference is."""
    got, expected = (np.ascontiguousarray(a).view(np.int64) for a in (got, expected))
    differs = np.argwhere(got != expected)
    assert not len(differs), f"{len(differs)} of {got.size} differ, the first at {differs[0]}"


def test_numpy_arrays_give_the_same_bits(cycle, expected):
    work, sensors = cycle.work(), sensor_rows(cycle)
    run(cycle, KERNELS, work, sensors)
    assert_same_bits(everything(work, sensors), expected)


def compiled(lanes):
    """Return the kernels as the library compiles them, for a number of lanes."""
    predict, add_noise, linearize, project, update, covariance = (
        straight(KERNELS[name])
        for name in ("predict", "add_noise", "linearize", "project", "update", "covariance")
    )
    functions = {
        "predict": lambda work, T: predict(work, 0, lanes, T),
        "add_noise": lambda work, a, b, c, d, e, f: add_noise(work, 0, lanes, a, b, c, d, e, f),
        "linearize": lambda work, sensor, x, y, z, g: linearize(
            work, 0, sensor, 0, lanes, x, y, z, g
        ),
        "project": lambda work, sensor: project(work, 0, sensor, 0, lanes),
        "update": lambda work, sensor: update(work, 0, sensor, 0, lanes),
        "covariance": lambda work: covariance(work, 0, lanes),
    }

    def called(function):
        """Return a function that leaves out which lanes there are: it knows."""
        kernel = njit(error_model="numpy")(function)
        return lambda *given: kernel(*[one for one in given if not isinstance(one, int)])

    assert functions.keys() == KERNELS.keys()
    return {name: called(function) for name, function in functions.items()}


@pytest.mark.parametrize("lanes", [1, LANES])
def test_numba_gives_the_same_bits_alone_and_in_lanes(cycle, expected, lanes):
    result, kernels = np.empty_like(expected), compiled(lanes)
    before = everything(cycle.work(), sensor_rows(cycle))
    for first in range(0, RUNS, lanes):
        part = slice(first, min(first + lanes, RUNS))
        width = part.stop - part.start
        rows = np.zeros((len(before), lanes))
        rows[:, :width] = before[:, part]
        flat = rows.reshape(-1)  # quantity i of lane j at i * lanes + j
        work, sensors = flat[: ekf.ROWS * lanes], flat[ekf.ROWS * lanes :].reshape(SENSORS, -1)
        run(cycle, kernels, work, sensors, lanes)
        result[:, part] = rows[:, :width]
    assert_same_bits(result, expected)


def with_scalars(call):
    """Return kernels for arrays from ``call(block name, rows of numbers) -> rows of outputs``."""

    def kernel(name):
        def function(*arguments):
            arrays, scalars = {"work": arguments[0]}, list(arguments[3:])
            if name in WITH_SENSOR:
                arrays["sensor"], scalars = arguments[1], list(arguments[4:])
            inputs = [
                arrays[PLACES[symbol.name][0]][PLACES[symbol.name][1]]
                for symbol in BLOCKS[name].inputs
                if symbol.name in PLACES
            ]
            rows = [[*column, *scalars] for column in np.transpose(inputs).tolist()]
            outputs = np.transpose(call(name, rows))
            for symbol, output in zip(BLOCKS[name].outputs, outputs, strict=True):
                array, row = PLACES[symbol.name]
                arrays[array][row] = output

        return function

    return {name: kernel(name) for name in KERNELS}


@pytest.fixture(scope="module")
def c99(tmp_path_factory):
    """Return a caller of the printed C99."""
    compiler = shutil.which("gcc") or shutil.which("cc")
    if compiler is None:
        pytest.skip("no C compiler on this machine")
    folder = tmp_path_factory.mktemp("c99")
    (folder / "kernels.c").write_text("\n".join(map(c99_function, BLOCKS.values())))
    # Without -ffp-contract=off some processors would multiply and add with one rounding.
    subprocess.run(
        [compiler, "-std=c99", "-O2", "-ffp-contract=off", "-Wall", "-Wextra", "-Werror",
         "-shared", "-fPIC", "-o", "kernels.so", "kernels.c", "-lm"],
        cwd=folder, check=True,
    )  # fmt: skip
    library = ctypes.CDLL(str(folder / "kernels.so"))

    def call(name, rows):
        block = BLOCKS[name]
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
    text = "\n".join(map(javascript_function, BLOCKS.values()))

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
    work, sensors = cycle.work(), sensor_rows(cycle)
    run(cycle, with_scalars(c99), work, sensors)
    assert_same_bits(everything(work, sensors), expected)


def test_javascript_gives_the_same_bits(cycle, expected, javascript):
    work, sensors = cycle.work(), sensor_rows(cycle)
    run(cycle, with_scalars(javascript), work, sensors)
    assert_same_bits(everything(work, sensors), expected)


@pytest.mark.parametrize("language", ["c99", "javascript", "numpy", "numba"])
@pytest.mark.parametrize(
    "function", [doppler.doppler_shift_and_gradient, links.leg_shift_and_gradient]
)
def test_shift_and_gradient_are_the_same_bits_in_every_language(function, language, request):
    rng = np.random.default_rng(6)
    numbers = len(BLOCKS[function.__name__].inputs) - 1
    rows = np.concatenate(
        [
            rng.normal(size=(500, numbers)) * 10 ** rng.uniform(-3, 3, (500, 1)),
            np.full((500, 1), 160.0),
        ],
        axis=1,
    ).tolist()
    expected = np.array([function(*row) for row in rows])
    if language == "numpy":
        got = np.stack(function(*np.transpose(rows)), axis=1)
    elif language == "numba":
        compiled = njit(error_model="numpy")(function)
        got = np.array([compiled(*row) for row in rows])
    else:
        got = np.array(request.getfixturevalue(language)(function.__name__, rows))
    assert_same_bits(got, expected)


def ring_values(rng, runs):
    """Return values of all inputs of the blocks of ring coordinates, by name, of true states."""
    inputs = {symbol.name for block in RING.values() for symbol in block.inputs}
    values = {name: rng.normal(size=runs) for name in sorted(inputs)}
    values |= {name: np.abs(values[name]) for name in ("T", "r", "x", "doppler_per_speed")}
    state = [values[symbol.name] for symbol in STATE]
    *seen, rho = ring_coordinates.to_coordinates(*state, values["r"])
    names = [symbol.name for symbol in ring.COORDINATES[:5]]
    values |= dict(zip(names, seen, strict=True))
    return values | {"rho": rho, "u": 1 / rho, "V": np.sum(np.square(state[3:]), axis=0)}


@pytest.mark.parametrize("language", ["c99", "javascript", "numpy"])
@pytest.mark.parametrize("name", RING)
def test_ring_coordinates_are_the_same_bits_in_every_language(name, language, request):
    values = ring_values(np.random.default_rng(7), 200)
    rows = np.transpose([values[symbol.name] for symbol in RING[name].inputs]).tolist()
    function = getattr(ring_coordinates, name)
    expected = np.array([function(*row) for row in rows])
    if language == "numpy":
        got = np.stack(function(*np.transpose(rows)), axis=1)
    else:
        got = np.array(request.getfixturevalue(language)(name, rows))
    assert_same_bits(got, expected)
