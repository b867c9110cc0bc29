"""Break the library on purpose, one realistic fault at a time, and see whether a test notices.

tests/mutants/NAME.toml names the faults: file, text and what somebody could have written instead,
and the tests that should fail. Prints every fault that survives; the exit code is 1 if more than
one in ten of a file's faults does. Nothing of the checkout changes: each fault is made in a copy.
"""

import os
import shutil
import subprocess
import sys
import tempfile
import tomllib
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from tools.command import parser, start

ROOT = Path(__file__).resolve().parent.parent
FOLDER = ROOT / "tests" / "mutants"
MOST_SURVIVORS = 0.1
COPIED = ("dopplerlib", "data", "results", "tests", "tools", "studies", "book", "benchmarks")


def mutants(name):
    """Return the faults of a file, each a dict with id, file, old, new, tests, says."""
    found = tomllib.loads((FOLDER / f"{name}.toml").read_text(encoding="utf-8"))["mutant"]
    return [one | {"tests": list(one["tests"])} for one in found]


def names():
    """Return the names of the lists of faults."""
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


def copied(folder):
    """Copy what the tests need."""
    leave = shutil.ignore_patterns("_build", "*.nbi", "*.nbc")
    for name in COPIED:
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, folder / name, ignore=leave)
    for path in ROOT.glob("*.*"):
        if path.is_file():
            shutil.copy(path, folder)


def killed(folder, one):
    """Return whether a test fails when the fault is made in a copy, which is mended afterwards."""
    path = folder / one["file"]
    whole = path.read_text(encoding="utf-8")
    if whole.count(one["old"]) != 1:
        raise ValueError(f"old of {one['id']} must occur once in {one['file']}")
    path.write_text(whole.replace(one["old"], one["new"]), encoding="utf-8")
    try:
        return not passes(folder, one["tests"])
    finally:
        path.write_text(whole, encoding="utf-8")


def passes(folder, tests):
    """Run tests in a copy; what numba compiled for another text is not taken for this one."""
    environment = os.environ | {
        "PYTHONPATH": str(folder),
        "PYTHONDONTWRITEBYTECODE": "1",
        "NUMBA_CACHE_DIR": str(folder / "compiled"),
    }
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *tests],
        cwd=folder,
        env=environment,
        capture_output=True,
        check=False,
    )
    if done.returncode not in (0, 1):
        raise RuntimeError(f"tests did not run: {done.stdout.decode()[-2000:]}")
    return done.returncode == 0


def survivors(name, workers=2):
    """Return the faults of a list that no test notices, and the number of all."""
    wanted = mutants(name)
    with tempfile.TemporaryDirectory() as place:
        folders = [Path(place, str(worker)) for worker in range(workers)]
        for folder in folders:
            copied(folder)
        tests = sorted({test for one in wanted for test in one["tests"]})
        if not passes(folders[0], tests):
            raise RuntimeError("the tests must pass before anything is broken")

        def of_worker(worker):
            found = []
            for one in wanted[worker::workers]:
                if not killed(folders[worker], one):
                    found.append(one)
                print(f"{one['id']}: {'survives' if one in found else 'killed'}", file=sys.stderr)
            return found

        with ThreadPoolExecutor(workers) as pool:
            found = [one for part in pool.map(of_worker, range(workers)) for one in part]
    return found, len(wanted)


def main(argv=None):
    """Try the faults, print what survives, and return the exit code."""
    options = parser(__doc__)
    options.add_argument("names", nargs="*", help="lists of faults; all if none is named")
    bad = 0
    for name in options.parse_args(argv).names or names():
        left, total = survivors(name)
        print(f"{name}: {total - len(left)} of {total} faults are noticed")
        print(*(f"  {one['id']} survives: {one['says']}" for one in left), sep="\n")
        bad |= len(left) > MOST_SURVIVORS * total
    return int(bad)


if __name__ == "__main__":
    start(main)
