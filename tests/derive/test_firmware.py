"""The printed C99 is the library's filter and alarm, and costs what its header says."""

import ctypes
import platform
import re
import shutil
import subprocess

import numpy as np
import pytest
import sympy
from scipy.special import ndtri

from dopplerlib import RadarArray, doppler_shift, ekf, simulate
from dopplerlib.chain.alarm import stop_alarm
from dopplerlib.chain.track import IqTrack
from dopplerlib.derive.firmware import NAME, STACK
from dopplerlib.derive.operations import KINDS
from dopplerlib.estimation.extended_kalman import gate_bounds
from dopplerlib.systems.mittermaier2016 import reported, run_example
from tools.kernels import FIRMWARE, firmware_files

STRICT = (
    "-std=c99 -pedantic -Wall -Wextra -Werror -Wconversion -Wsign-conversion -Wdouble-promotion "
    "-Wfloat-conversion -Wfloat-equal -Wshadow -Wstrict-prototypes -Wmissing-prototypes -Wundef "
    "-Wcast-qual -Wbad-function-cast -Wswitch-enum -Wvla"
).split()
# Without -ffp-contract=off some processors would multiply and add with one rounding.
RELEASE = ["-O2", "-fno-math-errno", "-ffp-contract=off"]
PRECISIONS = {"double": [], "float": ["-DDOPPLER_FLOAT"]}
COMPILERS = [name for name in ("gcc", "clang") if shutil.which(name)]
NOISE = {"shared": 1, "horizontal": 2, "per_axis": 3}
POINT, DISTANCE, PROBABILITY = (0.0, 0.0, 0.0), 0.25, 1e-3


def compiled(compiler, folder, output, *options, sources=(f"{NAME}.c",)):
    """Compile into `folder`; return the path of `output`."""
    files = [FIRMWARE / source for source in sources]
    command = [compiler, *STRICT, *options, "-o", output, *files, "-lm"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return folder / output


class Tracker:
    """The firmware in one precision, called from Python."""

    def __init__(self, path, real):
        self.library, self.real = ctypes.CDLL(str(path)), real
        pointer = ctypes.POINTER(real)

        class Setting(ctypes.Structure):
            _fields_ = [
                ("sensors", ctypes.c_int), ("positions", pointer), ("variance", pointer),
                ("doppler_per_speed", real), ("sigma_a", real), ("noise", ctypes.c_int),
                ("lower", pointer), ("upper", pointer), ("point", real * 3), ("distance", real),
                ("quantile", real),
            ]  # fmt: skip

        class Track(ctypes.Structure):
            _fields_ = [
                ("x", real * 6), ("factors", real * 21), ("nis", real), ("updated", ctypes.c_int),
            ]  # fmt: skip

        class Decision(ctypes.Structure):
            _fields_ = [("distance", real), ("distance_std", real), ("alarm", ctypes.c_int)]

        self.Setting, self.Track = Setting, Track
        self.library.doppler_stop.restype = Decision

    def numbers(self, values):
        values = np.ravel(values)
        return (self.real * len(values))(*values)

    def decide(self, track, setting):
        return self.library.doppler_stop(ctypes.byref(track), ctypes.byref(setting))

    def setting(self, array, sigma_a, sigma_f, columns=1, bounds=(None, None)):
        positions, variance = self.numbers(array.positions), self.numbers(np.square(sigma_f))
        limits = [None if bound is None else self.numbers(bound) for bound in bounds]
        return self.Setting(
            len(array), positions, variance, array.doppler_per_speed, sigma_a, columns, *limits,
            POINT, DISTANCE, ndtri(PROBABILITY),
        )  # fmt: skip

    def run(self, z, setting, x0, P0, T):
        """Return x, P, NIS, updated, and the decisions (distance, deviation, alarm)."""
        track, P = self.Track(), (self.real * 36)()
        here = ctypes.byref(track), ctypes.byref(setting)
        self.library.doppler_start(here[0], self.numbers(x0), self.numbers(P0))
        rows = []
        for shifts, interval in zip(z, np.broadcast_to(T, len(z)), strict=True):
            self.library.doppler_cycle(*here, self.real(interval), self.numbers(shifts))
            self.library.doppler_covariance(here[0], P)
            found = self.library.doppler_stop(*here)
            decision = found.distance, found.distance_std, found.alarm
            rows.append(
                (list(track.x), np.array(P).reshape(6, 6), track.nis, track.updated, decision)
            )
        return [np.array(column) for column in zip(*rows, strict=True)]


@pytest.fixture(scope="module")
def printed():
    return firmware_files()


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """Return the folder with what gcc, or clang, makes of the source."""
    if not COMPILERS:
        pytest.skip("no gcc or clang on this machine")
    folder, compiler = tmp_path_factory.mktemp("firmware"), COMPILERS[0]
    usual = [*RELEASE, "-fPIC"]
    if platform.machine() in ("x86_64", "AMD64"):
        usual.append("-mno-red-zone")  # below the stack, where no usage is counted
    if compiler == "gcc":
        usual.append("-fstack-usage")
    for name, options in PRECISIONS.items():
        compiled(compiler, folder, f"{name}.o", *usual, *options, "-c")
        link = [compiler, "-shared", "-o", f"{name}.so", f"{name}.o", "-lm"]
        subprocess.run(link, cwd=folder, check=True)
    return folder


@pytest.fixture(scope="module")
def trackers(built):
    real = {"double": ctypes.c_double, "float": ctypes.c_float}
    return {name: Tracker(built / f"{name}.so", real[name]) for name in PRECISIONS}


def start_of_example():
    """Return the printed estimate, moved back by one interval."""
    x0 = reported().table2.x_ml.copy()
    x0[:3] -= reported().scenario.T * x0[3:]
    return x0


@pytest.fixture(scope="module")
def example():
    """Return scenario, measurements, start and the library's track of the example of Fig 6."""
    scenario, x0 = reported().scenario, start_of_example()
    _, z = simulate(scenario, 1, rng=np.random.default_rng(2016))
    track = run_example(1, rng=np.random.default_rng(2016), gate="two-sided").track
    return scenario, z[0], x0, track


def alarm_of(x, P, time):
    """Return the library's decision on a track, (K, 6) and (K, 6, 6), that is known at once."""
    K = len(x)
    shifts, many, S = np.ones((K, 1)), np.ones((1, K - 1)), np.ones((1, K - 1, 1, 1))
    found = IqTrack(
        time, time, shifts, shifts, 1, x[None], P[None], many[..., None], S, many, 0.0,
        np.ones((1, K)), 0, 0.01,
    )  # fmt: skip
    return stop_alarm(found, POINT, DISTANCE, PROBABILITY)


def same(got, expected):
    """Return whether all numbers are the same to the last bit, NaN where it is expected."""
    return np.array_equal(got, expected, equal_nan=True)


def split(text):
    """Return the numbers of a setting, and the text without them."""
    numbers = re.compile(r"(?<=R\()[-+.e\d]+(?=\))")
    return np.array(numbers.findall(text), float), numbers.sub("", text)


def test_what_is_committed_is_what_is_printed(printed):
    for name, text in printed.items():
        committed = (FIRMWARE / name).read_text(encoding="utf-8")
        # That of the lock; older ones print the same formulas, and quantiles to rounding.
        committed = re.sub(r"(?<=SymPy )[\d.]+\d", sympy.__version__, committed, count=1)
        (numbers, rest), (expected, expected_rest) = split(committed), split(text)
        assert rest == expected_rest, f"run make kernels: {name}"
        assert np.allclose(numbers, expected, rtol=1e-13, atol=0), f"run make kernels: {name}"


def test_there_is_no_other_source_but_the_example(printed):
    assert {path.name for path in FIRMWARE.glob("*.[ch]")} == {*printed, "main.c"}


def test_double_precision_is_the_library_over_the_example(trackers, example):
    scenario, z, x0, track = example
    setting = trackers["double"].setting(
        scenario.array,
        scenario.sigma_a,
        np.full(6, scenario.sigma_f),
        1,
        gate_bounds("two-sided", 6),
    )
    x, P, nis, updated, decision = trackers["double"].run(z, setting, x0, scenario.P0, scenario.T)
    assert 0 < updated.sum() < len(z)  # the gate was open and shut
    assert same(x, track.x[0]) and same(P, track.P[0]) and same(nis, track.nis[0])
    assert same(updated, track.updated[0])
    # A square root of a sum of squares here, and of a product with P there: some twenty roundings.
    alarm = alarm_of(track.x[0], track.P[0], scenario.time)
    assert np.allclose(decision[:, 0], alarm.distance, rtol=1e-14, atol=0)
    assert np.allclose(decision[:, 1], alarm.distance_std, rtol=1e-12, atol=0)
    assert same(decision[:, 2], alarm.alarm) and 0 < alarm.alarm.sum() < len(z)


@pytest.mark.parametrize("n", [1, 3, 6, 12])
@pytest.mark.parametrize(("noise", "columns"), NOISE.items())
def test_double_precision_is_the_library_whatever_is_missing(trackers, noise, columns, n):
    rng = np.random.default_rng(n)
    array = RadarArray(rng.normal(size=(n, 3)) * 0.3, 0.0125)
    T, sigma_f = rng.uniform(0.001, 0.1, 60), rng.uniform(0.2, 2.0, n)
    time, x0 = np.cumsum(T)[:, None], np.array([6.0, 0.5, -0.3, -1.0, 0.2, 0.1])
    truth = np.concatenate([x0[:3] + time * x0[3:], np.tile(x0[3:], (60, 1))], axis=1)
    z = doppler_shift(truth, array) + sigma_f * rng.normal(size=(60, n))
    z[rng.uniform(size=z.shape) < 0.3] = np.nan
    z[17] = np.nan
    A = rng.normal(size=(6, 6)) * 0.1
    P0 = A[:, :4] @ A[:, :4].T if n == 3 else A @ A.T  # of rank four: it may be singular
    gate = {1: None, 6: "two-sided"}.get(n, "upper")
    track = ekf(z, array, x0, P0, T, 0.4, sigma_f, noise=noise, gate=gate)
    bounds = gate_bounds(gate, n) if gate else (None, None)
    tracker = trackers["double"]
    setting = tracker.setting(array, 0.4, sigma_f, columns, bounds)
    x, P, nis, updated, _ = tracker.run(z, setting, x0, P0, T)
    assert same(x, track.x) and same(P, track.P) and same(nis, track.nis)
    assert same(updated, track.updated) and not updated[17] and np.isnan(nis[17])


def test_single_precision_is_as_far_off_as_the_table_states(trackers):
    # Every operation is rounded the same way everywhere, so that even the differences are the same.
    rows = re.findall(r"\| record \d \| ([\d.]+) \|", (FIRMWARE / "README.md").read_text("utf-8"))
    scenario, x0 = reported().scenario, start_of_example()
    _, z = simulate(scenario, len(rows), rng=np.random.default_rng(2016))
    setting = scenario.array, scenario.sigma_a, np.full(6, scenario.sigma_f)
    for record, stated in zip(z, rows, strict=True):
        (x, P, _, updated, decision), (rough, _, _, used, judged) = (
            tracker.run(
                record, tracker.setting(*setting, 1, gate_bounds("two-sided", 6)), x0,
                scenario.P0, scenario.T,
            )
            for tracker in (trackers["double"], trackers["float"])
        )  # fmt: skip
        std = np.sqrt(np.diagonal(P, axis1=1, axis2=2))
        assert f"{np.max(np.abs(rough - x) / std):.4f}" == stated
        assert same(used, updated) and same(judged[:, 2], decision[:, 2])


@pytest.mark.parametrize("precision", PRECISIONS)
def test_a_track_that_is_no_number_is_an_alarm(trackers, precision):
    tracker = trackers[precision]
    setting = tracker.setting(RadarArray.ring(6, 0.2), 0.4, np.full(6, 0.4))
    far, P0 = [9.0, 0, 0, -1, 0, 0], 1e-4 * np.eye(6)
    for x0, alarm in ((far, 0), ([np.nan] * 6, 1), ([*POINT, 0, 0, 0], 1)):
        *_, decision = tracker.run(np.full((1, 6), np.nan), setting, x0, P0, 0.001)
        assert decision[0, 2] == alarm


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("odd", [np.inf, -np.inf, 3e38])
def test_a_shift_out_of_range_leaves_the_state_predicted(trackers, precision, odd):
    tracker = trackers[precision]
    setting = tracker.setting(RadarArray.ring(6, 0.2), 0.4, np.full(6, 0.4), 1, (None, [1e9] * 7))
    start = [1.0, 0, 0, -1, 0, 0], 0.01 * np.eye(6), 0.001
    z = np.full((1, 6), 160.0)
    z[0, 2] = odd
    x, P, _, updated, _ = tracker.run(z, setting, *start)
    none = tracker.run(np.full((1, 6), np.nan), setting, *start)
    assert not updated[0] and same(x, none[0]) and same(P, none[1])


COUNTED = """
#include <float.h>
#include <math.h>
#include <stdio.h>
static long count[4];
struct Counted {
    double value;
    Counted(double v = 0) : value(v) {}
};
#define OPERATION(symbol, kind) \\
    static Counted operator symbol(Counted a, Counted b) \\
    { count[kind]++; return Counted(a.value symbol b.value); }
OPERATION(+, 0) OPERATION(-, 0) OPERATION(*, 1) OPERATION(/, 2)
static void operator-=(Counted &a, Counted b) { a = a - b; }
static Counted operator-(Counted a) { return Counted(-a.value); }
static bool operator<=(Counted a, Counted b) { return a.value <= b.value; }
static bool operator>=(Counted a, Counted b) { return a.value >= b.value; }
static bool operator>(Counted a, Counted b) { return a.value > b.value; }
static Counted sqrt(Counted a) { count[3]++; return Counted(sqrt(a.value)); }
static bool isnan(Counted a) { return a.value != a.value; }
#define double Counted
#include "doppler_tracker.c"
static void show(void)
{
    for (int i = 0; i < 4; i++)
        printf("%ld ", count[i]);
    puts("");
}
#define START for (int i = 0; i < 4; i++) count[i] = 0;
int main(void)
{
    const Counted places[12] = {0, .2, 0, 0, -.2, 0, 0, 0, .2, 0, 0, -.2};
    const Counted z[4] = {100, 101, 102, 103}, variance[4] = {1, 1, 1, 1};
    const Counted x0[6] = {1, 0, 0, -1, 0, 0};
    Counted P0[36];
    for (int i = 0; i < 6; i++)
        P0[7 * i] = 1;
    for (int n = 1; n <= 4; n++)
        for (int columns = 1; columns <= 3; columns++) {
            doppler_setting setting = {n, places, variance, 160, 1, (doppler_noise)columns,
                                       NULL, NULL, {0, 0, 0}, 1, -3};
            doppler_track track;
            doppler_start(&track, x0, P0);
            START doppler_cycle(&track, &setting, .001, z); show();
            START doppler_stop(&track, &setting); show();
        }
}
"""
STATED = re.compile(r" \*   ([a-z ]+?) +(\d+) \+ +(\d+) C \+ +(\d+) N +(\d+)\n")


@pytest.mark.skipif(not shutil.which("g++"), reason="no g++ on this machine")
def test_the_header_states_the_operations_that_a_cycle_needs(tmp_path, printed):
    # The same source, read as C++ with a number that counts, so that loops and calls count, too.
    (tmp_path / "counted.cpp").write_text(COUNTED)
    command = ["g++", "-O0", f"-I{FIRMWARE}", "-o", "counted", "counted.cpp"]
    subprocess.run(command, cwd=tmp_path, check=True, capture_output=True)
    done = subprocess.run([tmp_path / "counted"], capture_output=True, text=True, check=True)
    counted = np.array([line.split() for line in done.stdout.splitlines()], int)
    stated = STATED.findall(printed[f"{NAME}.h"])
    assert [kind for kind, *_ in stated] == list(KINDS)
    once, column, sensor, decision = np.array([numbers for _, *numbers in stated], int).T
    cycles = [once + c * column + n * sensor for n in range(1, 5) for c in range(1, 4)]
    assert same(counted[::2], cycles) and same(counted[1::2], [decision] * len(cycles))


@pytest.mark.skipif(not shutil.which("gcc"), reason="no gcc on this machine")
@pytest.mark.parametrize("precision", PRECISIONS)
def test_a_call_takes_less_stack_than_the_header_states(built, precision):
    rows = [line.split("\t") for line in (built / f"{precision}.su").read_text().splitlines()]
    assert {kind for *_, kind in rows} == {"static"}  # no alloca, no array of variable length
    sizes = {place.rsplit(":", 1)[1]: int(size) for place, size, _ in rows}
    inner = sum(size for name, size in sizes.items() if not name.startswith("doppler_"))
    assert STACK[precision] / 2 < inner + max(sizes.values()) < STACK[precision]


@pytest.mark.skipif(not shutil.which("nm"), reason="no nm on this machine")
@pytest.mark.parametrize("precision", PRECISIONS)
def test_the_source_has_no_variables_and_calls_no_library(built, precision):
    command = ["nm", "--format=posix", built / f"{precision}.o"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    symbols = [line.split()[:2] for line in done.stdout.splitlines()]
    assert {kind for _, kind in symbols} <= set("TtRrU")
    needed = {name.lstrip("_") for name, kind in symbols if kind == "U"}
    # Where there is no instruction for it; and the copies that a compiler makes calls of.
    assert needed <= {"sqrt", "sqrtf", "memcpy", "memset", "GLOBAL_OFFSET_TABLE_"}


SANITIZED = ["-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"]


@pytest.fixture(scope="module")
def programs(built):
    """Return the example program in both precisions; in double with all that watches it."""
    sources = ("main.c", f"{NAME}.c")
    watched = ["-O1", "-ffp-contract=off", *SANITIZED]
    (built / "empty.c").write_text("int main(void) { return 0; }\n")
    command = [COMPILERS[0], *SANITIZED, "-o", "empty", "empty.c"]
    if subprocess.run(command, cwd=built, capture_output=True).returncode:
        watched = RELEASE  # without the libraries of the sanitizers
    return {
        name: compiled(
            COMPILERS[-1], built, f"track-{name}", *options,
            *(watched if name == "double" else RELEASE), sources=sources,
        )
        for name, options in PRECISIONS.items()
    }  # fmt: skip


def lines_of(time, z):
    """Return times and shifts as the example program reads them, an empty field where missing."""
    rows = [[t, *row] for t, row in zip(time.tolist(), z.tolist(), strict=True)]
    fields = [["" if f != f else repr(f) for f in row] for row in rows]
    return "\n".join(["time,f1,f2,f3,f4,f5,f6", *(",".join(row) for row in fields)]) + "\n"


def tracked(program, text):
    done = subprocess.run([program], input=text, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    names, *rows = done.stdout.splitlines()
    assert names == "time,x,y,z,v_x,v_y,v_z,nis,updated,distance,distance_std,alarm"
    return np.array([row.split(",") for row in rows], float)


def test_the_example_tracks_a_file_as_the_library_does(programs, example):
    scenario, z, x0, _ = example
    z = z.copy()
    z[200:400, 1] = np.nan  # a sensor is missing for a while, and all for a moment
    z[500:503] = np.nan
    time, P0, sigma_f = scenario.time, scenario.P0, scenario.sigma_f
    T = np.concatenate([[scenario.T], np.diff(time)])
    track = ekf(z, scenario.array, x0, P0, T, scenario.sigma_a, sigma_f, gate="two-sided")
    alarm = alarm_of(track.x, track.P, time)
    got = tracked(programs["double"], lines_of(time, z))
    # The program prints all digits.
    assert same(got[:, 0], time) and same(got[:, 8], track.updated)
    assert same(got[:, 1:7], track.x) and same(got[:, 7], track.nis)
    assert np.allclose(got[:, 9], alarm.distance, rtol=1e-12, atol=0)
    assert np.allclose(got[:, 10], alarm.distance_std, rtol=1e-12, atol=0)
    assert same(got[:, 11], alarm.alarm)


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("0.1,1,2,3,4,5\n", "line 1: must be a time and one field for each sensor"),
        ("time,f\n0.1,1,2,3,4,5,6,7\n", "line 2: must be a time and one field for each sensor"),
        ("0.1,1,2,x,4,5,6\n", "line 1: must be a time and one field for each sensor"),
        ("0.1,1,2,3,4,5,6\n0.1,1,2,3,4,5,6\n", "line 2: must have a later time than the line"),
        ("0.1,1,2,3,4,5,6\n,1,2,3,4,5,6\n", "line 2: must have a later time than the line"),
        ("0.1," + "1" * 2000 + "\n", "line 1: must be shorter"),
    ],
)
def test_the_example_names_the_line_that_it_cannot_read(programs, text, error):
    done = subprocess.run([programs["double"]], input=text, capture_output=True, text=True)
    assert done.returncode == 1 and done.stderr.startswith(error)
