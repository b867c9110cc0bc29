"""Run the tests of the library with every Python that is found, and with the oldest packages.

Every Python gets the packages of environment.lock in an environment of its own. The oldest that is
supported also gets those of tests/minimum.lock, the least that pyproject.toml allows: newer ones
have no such packages. Each has one line of result; a failure keeps nothing from being tried.
"""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

from tools.alone import alone
from tools.command import child, parser, start

ROOT = Path(__file__).resolve().parent.parent
FOLDER = ROOT / ".venv-matrix"
TRIED = [(3, minor) for minor in range(11, 15)]
LOCK, MINIMUM = Path("environment.lock"), Path("tests/minimum.lock")
PYTEST = ["-m", "pytest", "-q", "-n", "logical", "--maxprocesses", "4"]
PYTEST += ["--dist", "loadfile", "--no-loadscope-reorder"]
# The chapters and the tools need the packages of the book, and are tried by `make test`.
TESTS = ["tests", "dopplerlib", "--ignore=tests/book", "--ignore=tests/tools"]
ASK = (
    "import json, platform, sys; "
    "print(json.dumps([platform.python_implementation(), *sys.version_info[:3]]))"
)


def candidates():
    """Return the programs that may be a Python: on the path, and where pyenv and uv keep them."""
    on_path = [shutil.which(f"python{major}.{minor}") for major, minor in TRIED]
    kept = [
        Path(os.environ.get("PYENV_ROOT", "~/.pyenv"), "versions"),
        Path(os.environ.get("UV_PYTHON_INSTALL_DIR", "~/.local/share/uv/python")),
    ]
    found = [path for folder in kept for path in folder.expanduser().glob("*/bin/python3")]
    return [path for path in on_path if path] + found


def interpreters(programs):
    """Return by (major, minor) the newest CPython among some programs: version and program."""
    found = {}
    for program in programs:
        asked = subprocess.run([program, "-c", ASK], capture_output=True, text=True, check=False)
        if asked.returncode:  # pyenv puts a name on the path for a version that is not switched on
            continue
        name, *version = json.loads(asked.stdout)
        key = tuple(version[:2])
        if name == "CPython" and key in TRIED and version > found.get(key, ([],))[0]:
            found[key] = version, program
    return {key: (".".join(map(str, found[key][0])), found[key][1]) for key in sorted(found)}


def tested(folder, program, lock):
    """Make the environment and run the tests in it; return whether they pass, and the log."""
    log = folder.with_suffix(".log")
    make = [program, "-m", "tools.environment", folder.relative_to(ROOT), lock]
    with log.open("w", encoding="utf-8") as file:
        for command in (make, [folder / "bin" / "python", *PYTEST, *TESTS]):
            with child(command, cwd=ROOT, stdout=file, stderr=subprocess.STDOUT) as process:
                if process.wait():
                    return False, log
    return True, log


def main(argv=None):
    """Try all; return 1 if one fails or none is found."""
    options = parser(__doc__)
    options.add_argument("pythons", nargs="*", help="default: all that are found")
    chosen = options.parse_args(argv)
    found = interpreters(chosen.pythons or candidates())
    absent = [f"{major}.{minor}" for major, minor in TRIED if (major, minor) not in found]
    if absent:
        print("not found: CPython", ", ".join(absent), file=sys.stderr)
    runs = [(*python, LOCK) for python in found.values()]
    runs += [(*found[key], MINIMUM) for key in TRIED[:1] if key in found]
    failed = not runs
    with alone(FOLDER / ".lock", "the matrix"):
        for number, (version, program, lock) in enumerate(runs, start=1):
            name = f"CPython {version}, {lock.stem}"
            print(f"{number} of {len(runs)}: {name} ...", file=sys.stderr, flush=True)
            folder = FOLDER / f"{version}-{lock.stem}".replace(".", "_")
            passed, log = tested(folder, program, lock)
            failed |= not passed
            last = log.read_text(encoding="utf-8", errors="replace").rstrip().rpartition("\n")[2]
            word = "passes" if passed else f"FAILS, see {log.relative_to(ROOT)}"
            print(f"{name}: {word}: {last}", flush=True)
    return int(failed)


if __name__ == "__main__":
    start(main)
