"""Make an environment: what a lock holds, and the library itself; or find that it is there.

An environment knows its place: a copied or moved checkout would go on with the library of another
one, and an unpacked or pulled lock would not be looked at. So `.ready` in its folder holds what it
was made of and where, and is compared every time. Only what comes with Python is used here.
"""

import hashlib
import json
import os
import re
import shutil
import sys
import sysconfig
import tomllib
from contextlib import ExitStack
from importlib.util import find_spec
from pathlib import Path

from tools.alone import alone
from tools.command import child, parser, start

ROOT = Path(__file__).resolve().parent.parent
READY, HELD = ".ready", ".lock"
MADE_OF = ("build-system", "project", "tool.setuptools")  # of pyproject.toml: not how it is tested


def digest(content):
    """Return the first digits of the SHA-256 of some bytes."""
    return hashlib.sha256(content).hexdigest()[:12]  # read by people, in a message


def wanted(lock, root=ROOT):
    """Return what an environment made now would be of, by the words in which we tell it."""
    settings = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))
    tables = settings | {f"tool.{name}": table for name, table in settings["tool"].items()}
    made_of = json.dumps([tables.get(name) for name in MADE_OF], sort_keys=True)
    made_of += (root / "setup.py").read_text(encoding="utf-8")
    return {
        "checkout": str(root),
        "Python": sys.version,
        "Python's folder": os.path.realpath(sys.base_prefix),
        "lock": f"{lock.name} {digest(lock.read_bytes())}",
        "needs": f"pyproject.toml {digest(made_of.encode())}",
    }


def reasons(folder, want):
    """Return why an environment cannot be used: nothing if it can."""
    try:
        have = json.loads((folder / READY).read_text(encoding="utf-8"))
    except (FileNotFoundError, ValueError):
        return ["it is not there, or not complete"]
    if not os.access(folder / "bin" / "python", os.X_OK):
        return ["its Python is gone"]
    if not isinstance(have, dict):
        have = {}
    return [
        f"{name} was {have.get(name)}, is {value}"
        for name, value in want.items()
        if have.get(name) != value
    ]


def entries(lock):
    """Return the entries of a lock: lines that begin with a name, each with the hashes below it."""
    return re.split(r"^(?=\w)", lock.read_text(encoding="utf-8"), flags=re.MULTILINE)


def parts(lock, folder):
    """Write the installer's entry, every other one of a lock, and the rest; return the paths.

    The installer is that of the book's lock, whichever lock is installed.
    """
    installer = [entry for entry in entries(ROOT / "environment.lock") if entry.startswith("pip==")]
    split = installer, entries(lock)[0::2], entries(lock)[1::2]
    paths = [folder / f"{number}-{lock.name}" for number in range(len(split))]
    for path, part in zip(paths, split, strict=True):
        path.write_text("".join(part), encoding="utf-8")
    return paths


def bundled():
    """Return the file of the pip that comes with Python, if any, which runs from there."""
    ensurepip = find_spec("ensurepip")  # Linux distributions may leave it out, or its file
    places = [sysconfig.get_config_var("WHEEL_PKG_DIR")]
    places += [Path(ensurepip.origin).parent / "_bundled"] if ensurepip else []
    return next((path for place in places if place for path in Path(place).glob("pip-*.whl")), None)


def steps(folder, lock, temporary):
    """Return the commands that fill a folder, by what they do; those of a step run side by side."""
    python, install = folder / "bin" / "python", ["install", "--quiet", "--no-deps"]
    # Byte code is left to the first import: compiling all of it up front doubles the time, and
    # most of it is never read.
    exact = ["--no-compile", "--require-hashes", "--only-binary", ":all:", "-r"]
    installer, *halves = parts(lock, temporary)
    # Python's own pip installs another one only: an old one takes twice as long for the rest. Where
    # it is not found, venv installs it or says what is missing.
    own, pip = bundled(), [python, "-m", "pip", *install]
    first, without = ([python, own / "pip", *install], ["--without-pip"]) if own else (pip, [])
    return {
        "an empty environment": [[sys.executable, "-m", "venv", *without, folder]],
        "an installer": [[*first, *exact, installer]],
        # A pip takes one package after the other; two keep two cores busy.
        f"what {lock.name} holds, half a minute or so": [[*pip, *exact, half] for half in halves],
        # More quiet: that a checkout is what Python imports is no warning.
        "the library": [[*pip, "--quiet", "--no-build-isolation", "--no-index", "-e", ROOT]],
    }


def make(folder, lock, held):
    """Make an environment anew; `held` goes to the commands, so that nobody else begins before."""
    for path in folder.iterdir():
        if path.name != HELD:
            shutil.rmtree(path) if path.is_dir() and not path.is_symlink() else path.unlink()
    temporary = folder / "tmp"  # what a killed pip leaves goes with the folder
    temporary.mkdir()
    env = os.environ | {"TMPDIR": str(temporary)}
    todo = steps(folder, lock, temporary)
    for number, (name, commands) in enumerate(todo.items(), start=1):
        print(f"{folder.name}: {number} of {len(todo)}, {name}", file=sys.stderr, flush=True)
        with ExitStack() as stack:
            started = [
                stack.enter_context(child(command, env=env, pass_fds=[held]))
                for command in commands
            ]
            codes = [step.wait() for step in started]
        if any(codes):
            return max(codes, key=abs)
    return 0


def main(argv=None):
    """Make the environment if it is not the one wanted; return the exit code."""
    options = parser(__doc__)
    options.add_argument("folder", type=Path)
    options.add_argument("lock", type=Path)
    chosen = options.parse_args(argv)
    folder, lock = ROOT / chosen.folder, ROOT / chosen.lock
    want = wanted(lock)
    if not reasons(folder, want):
        return 0
    with alone(folder / HELD, folder.name) as held:
        found = reasons(folder, want)  # again: whoever was here before has made it
        if not found:
            return 0
        (folder / READY).unlink(missing_ok=True)
        for reason in found:
            print(f"{folder.name} is made anew: {reason}", file=sys.stderr)
        code = make(folder, lock, held)
        if not code:
            unfinished = folder / f"{READY}.tmp"
            unfinished.write_text(json.dumps(want, indent=1) + "\n", encoding="utf-8")
            unfinished.replace(folder / READY)
        return code


if __name__ == "__main__":
    start(main)
