"""Time of ``import dopplerlib`` in a fresh process, against bare Python and against NumPy.

``python benchmarks/import_time.py`` prints Markdown. Interleaved; the first round fills the
byte-code caches and does not count. Where the time goes: ``python -X importtime -c "import
dopplerlib"``.
"""

import subprocess
import sys
import time

import numpy as np

ROUNDS = 15
CODES = {
    "nothing": "pass",
    "import numpy": "import numpy",
    "import dopplerlib": "import dopplerlib",
    "from dopplerlib import Scenario, simulate, nees": (
        "from dopplerlib import Scenario, simulate, nees"
    ),
    "from dopplerlib import ekf": "from dopplerlib import ekf",
    "the same, and numba for its first call": (
        "from dopplerlib import ekf; import dopplerlib.estimation._ekf_loop"
    ),
}
HEAVY = ("sympy", "matplotlib", "numba", "scipy", "numpy")
ASK = f"; import sys; print(*(name for name in {HEAVY} if name in sys.modules))"


def main():
    times = {name: [] for name in CODES}
    for k in range(-1, ROUNDS):
        for name, code in CODES.items():
            start = time.perf_counter()
            subprocess.run([sys.executable, "-c", code], check=True)
            if k >= 0:
                times[name].append(time.perf_counter() - start)
    print("| | s, whole process: median (least to most) | ÷ import numpy | loads |")
    print("|---|---|---|---|")
    for name, code in CODES.items():
        loaded = subprocess.check_output([sys.executable, "-c", code + ASK], text=True).split()
        seconds = np.array(times[name])
        ratio = np.median(seconds / np.array(times["import numpy"]))
        print(f"| `{name}` | {np.median(seconds):.2f} ({seconds.min():.2f} to {seconds.max():.2f})"
              f" | {ratio:.2f} | {', '.join(loaded)} |")  # fmt: skip


if __name__ == "__main__":
    main()
