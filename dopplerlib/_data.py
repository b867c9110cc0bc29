"""The files of `data/` and `results/`, wherever the library runs: checkout, wheel or zip file."""

import json
import tomllib
from contextlib import contextmanager
from importlib.resources import files
from pathlib import Path
from tempfile import TemporaryDirectory


def data(*names):
    """Return a file or folder of ``data/``, which holds what the documents report.

    It is a Traversable: a `Path`, unless it lies in a zip file.
    """
    return _shipped("data").joinpath(*names)


def results(*names):
    """Return a file or folder of ``results/``, which holds what our studies found; as `data`."""
    return _shipped("results").joinpath(*names)


def _shipped(name):
    # A wheel carries both inside the package; in a checkout they stand beside it.
    folder = files(__package__) / name
    return folder if folder.is_dir() else Path(__file__).parents[1] / name


def read_toml(*names, folder=data):
    """Return the tables of a TOML file of ``data/``, or of another folder, a new dict each time."""
    return tomllib.loads(_text(names, folder))


def read_json(*names, folder=data):
    """Return the content of a JSON file of ``data/``, or of another folder, new each time."""
    return json.loads(_text(names, folder))


def read_lines(*names, folder=data):
    """Return the lines of a file of ``data/``, or of another folder.

    `numpy.genfromtxt` and `csv` take them.
    """
    return _text(names, folder).splitlines()


def _text(names, folder):
    return folder(*names).read_text(encoding="utf-8-sig")


@contextmanager
def on_disk(folder, *names):
    """Give a folder that holds these files of a Traversable, for what cannot read a zip."""
    if isinstance(folder, Path):
        yield folder
        return
    with TemporaryDirectory() as copies:
        for name in names:
            Path(copies, name).write_bytes((folder / name).read_bytes())
        yield Path(copies)
