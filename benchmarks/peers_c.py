"""The same filter in C of the library's formulas, which `derive` prints; needs gcc.

One run: -O3, for any x86-64. Many: the same functions inside loops over sixteen runs, which gcc
turns into vector instructions of this processor. Both give the bits of `ekf`; those with fused
multiplication and addition do not. And the loop of `ekf` itself, without its call.
"""

import ctypes
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from dopplerlib.derive import ekf as derive
from dopplerlib.derive.doppler import DOPPLER_PER_SPEED, GRADIENT, SENSOR, STATE
from dopplerlib.derive.printers import c99_function
from dopplerlib.estimation._ekf_loop import compiled, new_memory
from dopplerlib.estimation.extended_kalman import gate_bounds
from dopplerlib.model.motion import dwna_gain

LANES = 16
BLOCKS = {block.name: block for block in derive.blocks()}
USED = "predict", "add_noise", "linearize", "update"
EXACT = ["-O3", "-ffp-contract=off"]
NATIVE = ["-march=native", "-fno-math-errno"]
FUSED = ["-O3", "-ffp-contract=fast", *NATIVE]  # with -std=c99 gcc fuses nothing unless told to
# For one run, and for many: the bits of `ekf`; and with fused operations, other bits.
OPTIONS = {
    "C": ([*EXACT], [*EXACT, *NATIVE]),
    "C, fused operations": ([*FUSED], [*FUSED, "-mprefer-vector-width=512"]),
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


def library(name, lanes):
    """Return the C of `lanes` runs at a time, compiled with the options of that name."""
    calls = {block: call(block) for block in USED}
    functions = "\n".join(
        c99_function(BLOCKS[block]).replace("void ", "static inline void ", 1) for block in USED
    )
    return built(functions + FRAME.format(lanes=lanes, **calls), OPTIONS[name][lanes > 1])


def built(text, options):
    """Return the library that gcc makes of a C text."""
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "text.c").write_text(text)
        command = ["gcc", "-std=c99", *options, "-shared", "-fPIC", "-o", "text.so", "text.c"]
        subprocess.run([*command, "-lm"], cwd=folder, check=True)
        return ctypes.CDLL(f"{folder}/text.so")


def gcc_version():
    """Return the version of gcc."""
    return subprocess.run(["gcc", "-dumpfullversion"], check=True, capture_output=True,
                          text=True).stdout.strip()  # fmt: skip


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


class Filters:
    """The filters of `lanes` runs at a time, of one scenario: x and NIS of records (R, K, N).

    R is a multiple of `lanes`.
    """

    def __init__(self, s, x0, lanes):
        if np.any(s.P0 - np.diag(np.diagonal(s.P0))):
            raise ValueError("the start of this scenario must be diagonal")
        G, sigma = dwna_gain(np.array([s.T]), s.sigma_a, "shared")
        self.scenario, self.x0, self.lanes = s, x0, lanes
        self.noise = np.ascontiguousarray(sigma * np.swapaxes(G, -1, -2)).reshape(-1)
        self.gates = gate_bounds(None, len(s.array))
        self.sensors = np.ascontiguousarray(s.array.positions)

    def in_c(self, name):
        """Return the filter in C, compiled with the options of that name."""
        s, run_c = self.scenario, library(name, self.lanes).run
        U = np.array([s.P0[i, i] if i == j else 0.0 for i, j in derive.UPPER])
        one, number = ctypes.c_int, ctypes.c_double

        def pointer(array):
            return ctypes.c_void_p(array.ctypes.data)

        def run(z):
            runs, K, N = z.shape
            out = np.empty((runs, K, 6)), np.empty((runs, K)), np.empty((runs, K), bool)
            run_c(
                pointer(z), pointer(self.sensors), number(s.array.doppler_per_speed),
                number(s.sigma_f**2), number(s.T), pointer(self.noise), pointer(self.x0),
                pointer(U), *map(pointer, self.gates), one(runs), one(K), one(N),
                *map(pointer, out),
            )  # fmt: skip
            return out[:2]

        return run

    def loop(self, z):
        """Filter with the compiled loop of `ekf` alone."""
        s, (runs, K, N), nothing = self.scenario, z.shape, np.empty(0)
        memory = new_memory(self.lanes, self.sensors, s.array.doppler_per_speed, *self.gates)
        inputs = [z, np.array([s.T]), self.noise, np.full((K, N), s.sigma_f**2),
                  np.tile(self.x0, (runs, 1)), np.tile(s.P0, (runs, 1, 1))]  # fmt: skip
        inputs = [np.ascontiguousarray(value).reshape(-1) for value in inputs]
        for value in inputs:
            value.setflags(write=False)
        x, nis, updated = np.empty((runs, K, 6)), np.empty((runs, K)), np.empty((runs, K), bool)
        filter_records = compiled(self.lanes)
        filter_records(memory, N, K, 1, *inputs, x.reshape(-1), nothing, nothing, nothing,
                       nis.reshape(-1), updated.reshape(-1))  # fmt: skip
        return x, nis
