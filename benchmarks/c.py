"""One run and a thousand beside C of the same formulas, which `derive` prints.

``make bench NAME=c`` prints Markdown; it needs gcc. One run: -O3, for any x86-64. A thousand runs:
the same functions inside loops over sixteen runs, which gcc turns into vector instructions of this
processor. Both give the bits of `ekf`, or nothing is timed; a line of its own says what fused
multiplication and addition, which does not, would win.
"""

import ctypes
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np
from ekf import SCENARIO
from measuring import interleaved, load, spread

from dopplerlib import Scenario, ekf, simulate
from dopplerlib.derive import ekf as derive
from dopplerlib.derive.doppler import DOPPLER_PER_SPEED, GRADIENT, SENSOR, STATE
from dopplerlib.derive.printers import c99_function
from dopplerlib.estimation._ekf_loop import compiled, new_memory
from dopplerlib.estimation.extended_kalman import gate_bounds
from dopplerlib.model.motion import dwna_gain

LANES, RUNS, REPETITIONS = 16, 1008, 50
BLOCKS = {block.name: block for block in derive.blocks()}
USED = "predict", "add_noise", "linearize", "update"
ONE = "gcc -O3"
SAME = "gcc -O3 -march=native, without fused operations"
FUSED = "gcc -O3 -march=native, vectors of 512 bits, fused operations"
EXACT = ["-O3", "-ffp-contract=off"]
OPTIONS = {
    ONE: EXACT,
    SAME: [*EXACT, "-march=native", "-fno-math-errno"],
    FUSED: ["-O3", "-march=native", "-fno-math-errno", "-mprefer-vector-width=512"],
}

FRAME = """
#include <string.h>
enum {{ L = {lanes} }};
void run(const double *z, const double *positions, double per_speed, double variance, double T,
         const double *noise, const double *x0, const double *U0, const double *lower,
         const double *upper, int runs, int K, int N, double *xs, double *nises,
         unsigned char *updated)
{{
    for (int first = 0; first + L <= runs; first += L) {{
        double x[6][L], U[21][L], kept[21][L], c[6][L], nis[L], r[L], zs[16][L], nu[16][L],
            h[16][6][L];
        int seen[L];
        for (int l = 0; l < L; l++) {{
            for (int i = 0; i < 6; i++) x[i][l] = x0[i];
            for (int i = 0; i < 21; i++) U[i][l] = U0[i];
        }}
        for (int k = 0; k < K; k++) {{
            {predict}
            {add_noise}
            memset(seen, 0, sizeof seen);
            for (int n = 0; n < N; n++) {{
                for (int l = 0; l < L; l++) {{
                    zs[n][l] = z[((first + l) * (long)K + k) * N + n];
                    seen[l] += !isnan(zs[n][l]);
                }}
                const double *s = positions + 3 * n;
                {linearize}
            }}
            memcpy(kept, U, sizeof U);
            memset(c, 0, sizeof c);
            memset(nis, 0, sizeof nis);
            for (int n = 0; n < N; n++) {{
                for (int l = 0; l < L; l++) {{
                    int gone = isnan(zs[n][l]);
                    r[l] = gone ? 1.0 : variance;
                    if (gone) {{
                        nu[n][l] = 0;
                        for (int i = 0; i < 6; i++) h[n][i][l] = 0;
                    }}
                }}
                {update}
            }}
            for (int l = 0; l < L; l++) {{
                long at = (first + l) * (long)K + k;
                int good = seen[l] > 0 && lower[seen[l]] <= nis[l] && nis[l] <= upper[seen[l]];
                if (good) for (int i = 0; i < 6; i++) x[i][l] += c[i][l];
                else for (int i = 0; i < 21; i++) U[i][l] = kept[i][l];
                for (int i = 0; i < 6; i++) xs[at * 6 + i] = x[i][l];
                nises[at] = seen[l] ? nis[l] : NAN;
                updated[at] = good;
            }}
        }}
    }}
}}
"""


def main():
    scenario = Scenario.from_toml(SCENARIO)
    z = simulate(scenario, RUNS, rng=np.random.default_rng(2016))[1]
    print(f"Load of the machine (1, 5, 15 minutes): {load()}.\n")
    with tempfile.TemporaryDirectory() as folder:
        for title, data, lanes, names in (
            ("one run", z[:1], 1, (ONE,)),
            (f"{RUNS} runs", z, LANES, (SAME, FUSED)),
        ):
            libraries = {name: library(Path(folder), name, lanes) for name in names}
            compare(title, scenario, data, lanes, libraries)
    print(f"Load at the end: {load()}.")


def library(folder, name, lanes):
    """Return the compiled C of `lanes` runs at a time."""
    calls = {block: call(block) for block in USED}
    functions = "\n".join(
        c99_function(BLOCKS[block]).replace("void ", "static inline void ", 1) for block in USED
    )
    stem = f"{lanes}-{list(OPTIONS).index(name)}"
    (folder / f"{stem}.c").write_text(functions + FRAME.format(lanes=lanes, **calls))
    command = ["gcc", "-std=c99", *OPTIONS[name], "-shared", "-fPIC", "-o", f"{stem}.so"]
    subprocess.run([*command, f"{stem}.c", "-lm"], cwd=folder, check=True)
    return ctypes.CDLL(str(folder / f"{stem}.so"))


def call(name):
    """Return the C that calls a block for every lane, with its outputs in the place of inputs."""
    places = {DOPPLER_PER_SPEED.name: "per_speed", "T": "T", derive.NIS.name: "nis[l]"}
    for array, symbols in (
        ("x[{}][l]", STATE), ("U[{}][l]", derive.FACTORS), ("c[{}][l]", derive.CORRECTION),
        ("h[n][{}][l]", GRADIENT), ("s[{}]", SENSOR), ("noise[{}]", derive.NOISE),
        ("zs[n][l]", [derive.MEASUREMENT]), ("r[l]", [derive.VARIANCE]),
        ("nu[n][l]", [derive.INNOVATION]),
    ):  # fmt: skip
        places |= {symbol.name: array.format(i) for i, symbol in enumerate(symbols)}
    block = BLOCKS[name]
    inputs = ", ".join(places[symbol.name] for symbol in block.inputs)
    outputs = " ".join(
        f"{places[symbol.name.removesuffix('_new')]} = out[{i}];"
        for i, symbol in enumerate(block.outputs)
    )
    size = len(block.outputs)
    return f"for (int l = 0; l < L; l++) {{ double out[{size}]; {name}({inputs}, out); {outputs} }}"


def compare(title, s, z, lanes, libraries):
    """Print the times of `ekf` (x and NIS), of its compiled loop alone, and of C."""
    runs, K, N = z.shape
    G, sigma = dwna_gain(np.array([s.T]), s.sigma_a, "shared")
    noise = np.ascontiguousarray(sigma * np.swapaxes(G, -1, -2)).reshape(-1)
    lower, upper = gate_bounds(None, N)
    memory = new_memory(lanes, s.array.positions, s.array.doppler_per_speed, lower, upper)
    inputs = [z, np.array([s.T]), noise, np.full((K, N), s.sigma_f**2), np.tile(s.x0, (runs, 1)),
              np.tile(s.P0, (runs, 1, 1))]  # fmt: skip
    inputs = [np.ascontiguousarray(value).reshape(-1) for value in inputs]
    for value in inputs:
        value.setflags(write=False)
    out = np.empty((runs, K, 6)), np.empty((runs, K)), np.empty((runs, K), bool)
    x, *rest = (value.reshape(-1) for value in out)

    def loop():
        nothing = np.empty(0)
        compiled(lanes)(memory, N, K, 1, *inputs, x, nothing, nothing, nothing, *rest)

    def whole():
        return ekf(
            z[0] if runs == 1 else z,
            s.array,
            s.x0,
            s.P0,
            s.T,
            s.sigma_a,
            s.sigma_f,
            keep=(),
            workers=1,
        )

    U = np.array([s.P0[i, j] / s.P0[j, j] if i != j else s.P0[i, i] for i, j in derive.UPPER])
    if np.any(s.P0 - np.diag(np.diagonal(s.P0))):
        raise SystemExit("the start of this scenario must be diagonal")
    sensors = np.ascontiguousarray(s.array.positions)

    def in_c(library):
        def pointer(array):
            return ctypes.c_void_p(array.ctypes.data)

        one, number = ctypes.c_int, ctypes.c_double
        library.run(
            pointer(z), pointer(sensors), number(s.array.doppler_per_speed), number(s.sigma_f**2),
            number(s.T), pointer(noise), pointer(s.x0), pointer(U), pointer(lower), pointer(upper),
            one(runs), one(K), one(N), *map(pointer, out),
        )  # fmt: skip

    z = np.ascontiguousarray(z)
    track, clocks = whole(), {"`ekf`": (whole, 1), "its compiled loop": (loop, 1)}
    for name, one in libraries.items():
        in_c(one)
        if name != FUSED and out[0].tobytes() != track.x.tobytes():
            raise SystemExit(f"{name} gives other bits than ekf")
        clocks[name] = (lambda one=one: in_c(one)), 1
    if runs == 1:
        clocks = {name: (run, REPETITIONS) for name, (run, _) in clocks.items()}
    times = interleaved(title, clocks, time.process_time)
    exact = next(iter(libraries))
    print(f"{title}, {K} steps, x and NIS, processor time:\n")
    print(f"| | ns a step and run | ÷ {exact} |\n|---|---|---|")
    for name, seconds in times.items():
        ns = spread(seconds / runs / K * 1e9)
        print(f"| {name} | {ns} | {spread(seconds / times[exact])} |")
    print()


if __name__ == "__main__":
    main()
