"""Chunks of a study in a folder: whole or not there, all of one study, and none a pickle."""

import hashlib
import inspect
import json
import platform
import secrets
import sys
import zipfile
from contextlib import suppress
from functools import cache
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path

import numpy as np

from .._data import data
from .._files import PARTIAL, replacing

CLAIM = "study.json"  # says what the folder is of; whoever makes it first has the folder
HEAD = "study"  # entry of a chunk that says the same


def head(study, settings, seed):
    """Return settings, seed, code, data and versions, on which the results of a study depend."""
    return {
        "settings": settings,
        "seed": seed,
        "study": f"{study.__module__}.{study.__qualname__}",
        "code": _code(study),
        "library": _library(),
        **versions(),
    }


def versions():
    """Return the versions of all that computes."""
    packages = ("dopplerlib", "numba", "numpy", "scipy")
    return {"python": platform.python_version()} | {name: version(name) for name in packages}


def _code(study):
    """Return a hash of the module of a study, and of those that stand beside it in a package."""
    try:
        function = inspect.unwrap(study)
        path = Path(inspect.getsourcefile(function))
        if not path.is_file():  # a notebook
            return _digest([inspect.getsource(function).encode()])
    except (OSError, TypeError):
        raise ValueError(
            f"study must be a function whose source can be read, got {study!r}"
        ) from None
    package = getattr(sys.modules.get(study.__module__), "__package__", None)
    beside = path.parent.glob("*.py") if package else [path]
    return _digest(one.read_bytes() for one in sorted(beside))


@cache
def _library():
    """Return a hash of this library as it was loaded: its modules, and what documents report."""
    code = _below(files(__package__.partition(".")[0]), lambda name: name.endswith(".py"))
    reported = _below(data(), lambda name: name[0] != "." and not name.endswith(".part"))
    return _digest(one.read_bytes() for part in (code, reported) for one in part)


def _below(folder, wanted):
    for one in sorted(folder.iterdir(), key=lambda one: one.name):
        if one.is_dir():
            yield from _below(one, wanted)
        elif wanted(one.name):
            yield one


def _digest(contents):
    found = hashlib.sha256()
    for content in contents:
        found.update(content)
    return found.hexdigest()


def claim(folder, text):
    """Make a folder that of the study with the head `text`, or raise if it is another one's.

    Of two processes that begin at once one makes the claim, whole and for the first time; the other
    compares.
    """
    folder.mkdir(parents=True, exist_ok=True)
    there, new = folder / CLAIM, folder / f"{PARTIAL}{secrets.token_hex(8)}.json"
    try:
        new.write_text(text, encoding="utf-8")
        with suppress(FileExistsError):
            there.hardlink_to(new)
    finally:
        new.unlink(missing_ok=True)
    _compare(folder, CLAIM, there.read_text(encoding="utf-8"), text)


def save(folder, text, first, last, found):
    """Write the results of the runs from `first` up to `last`, whole or not at all."""
    with replacing(folder / f"{first:010d}-{last:010d}.npz") as (new,):
        with new.open("wb") as file:
            np.savez_compressed(file, **{HEAD: np.array(text)}, **found)


def saved(folder, text):
    """Return the chunks of a folder by their ranges, or raise if one is of another study."""
    done = {}
    for path in sorted(folder.glob("[0-9]*-[0-9]*.npz")):
        first, last = map(int, path.stem.split("-"))
        try:
            with path.open("rb") as raw, np.load(raw, allow_pickle=False) as file:
                found = {name: file[name] for name in file.files}
        except (OSError, ValueError, EOFError, zipfile.BadZipFile):
            raise ValueError(f"folder must hold whole chunks, got {str(path)!r}") from None
        _compare(folder, path.name, str(found.pop(HEAD, "{}")), text)
        done[first, last] = found
    return done


def _compare(folder, name, theirs, text):
    if theirs == text:
        return
    try:
        there, here = json.loads(theirs), json.loads(text)
        differ = ", ".join(key for key in here if here[key] != there.get(key)) or "order"
    except (ValueError, AttributeError):
        differ = "all"
    raise ValueError(
        f"folder must be empty or hold chunks of this study, got {str(folder)!r}, where {name} is "
        f"of another one: {differ} differ; remove it to begin anew"
    )
