"""Which samples are measurements: 30 s of twelve channels at 48 kHz, beside plain NumPy.

``make bench NAME=validity`` prints Markdown. Processor time of one process, system included.
"""

import os
import platform
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from dopplerlib.signal.impairments import quantize
from dopplerlib.signal.synthesis import tone
from dopplerlib.signal.validity import valid_samples
from tests.signal import slow_validity

FS, SECONDS, MODULES = 48e3, 30, 6
ROUNDS = 3


def cpu(call):
    """Return the processor time of a call in s, and what it gives."""
    before = os.times()
    result = call()
    after = os.times()
    return after.user + after.system - before.user - before.system, result


def records():
    """Return {name: samples} of recordings that are sound, and of two that are not."""
    rng = np.random.default_rng(1)
    x = tone(np.linspace(-300, 300, MODULES), FS, int(FS * SECONDS), 20.0, rng=rng)
    found = {f"{bits} bits": quantize(x, bits, 2.0) for bits in (16, 12, 8, 4)}
    found["a module dead for a sixth"] = dead = found["16 bits"].copy()
    dead[2, dead.shape[1] // 3 : dead.shape[1] // 2] = 0
    return found | {"I clipped": np.clip(x.real, -0.5, 0.5) + 1j * x.imag}


def main():
    valid_samples(np.ones((MODULES, 100)))  # compiled, or read from the cache
    print(f"{platform.processor() or platform.machine()}, Python {platform.python_version()}, ")
    print(f"load {', '.join(f'{load:.1f}' for load in os.getloadavg())} at the start.\n")
    print("| recording | NumPy, s | `valid_samples`, s | ratio |\n|---|---|---|---|")
    for name, x in records().items():
        times = []
        for _ in range(ROUNDS):
            slow, expected = cpu(lambda x=x: slow_validity.valid_samples(x))
            fast, valid = cpu(lambda x=x: valid_samples(x))
            assert np.array_equal(valid, expected)
            times.append((slow, fast, slow / fast))
        slow, fast, ratio = np.median(times, axis=0)
        print(f"| {name} | {slow:.2f} | {fast:.2f} | {ratio:.1f} |")


if __name__ == "__main__":
    main()
