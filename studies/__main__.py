"""Run a study and write its results, or list the studies.

results/NAME.* appears when it is complete. Beside the numbers stands results/NAME.toml, with the
parameters and the versions that made them. An interrupted study goes on where it stopped.
"""

import argparse
import ast
import json
import platform
from contextlib import closing
from importlib import import_module
from importlib.metadata import version
from pathlib import Path

from dopplerlib._files import replacing
from dopplerlib._progress import progress_bar
from studies._resume import started
from tools.command import start

HERE = Path(__file__).resolve().parent
RESULTS = HERE.parent / "results"


def names():
    """Return the names of the studies."""
    return sorted(path.stem for path in HERE.glob("[!_]*.py"))


def about(name):
    """Return the docstring of a study, which is not imported for that."""
    return ast.get_docstring(ast.parse((HERE / f"{name}.py").read_text(encoding="utf-8")))


def listing():
    """Return a line for each study."""
    return "\n".join(f"{name:{max(map(len, names()))}}  {_first(name)}" for name in names())


def run(name, folder=RESULTS):
    """Do what is left of a study and write its files, all at once."""
    study = import_module(f"studies.{name}")
    items = list(study.items())
    with started(folder / name, items, **study.PARAMETERS) as part:
        with closing(study.rows(part.left)) as rows:
            for _ in progress_bar(part.left, name, wanted=len(items) > 1):
                part.keep(next(rows))
        contents = [*study.contents(part.rows), provenance(study, name)]
        with replacing(*files(study, name, folder), folder / f"{name}.toml") as unfinished:
            for path, content in zip(unfinished, contents, strict=True):
                path.write_bytes(content.encode() if isinstance(content, str) else content)


def files(study, name, folder=RESULTS):
    """Return where a study leaves its numbers."""
    return [folder / f"{name}{end}" for end in study.FILES]


def provenance(study, name):
    """Return the text of the file that says how the others were made."""
    made_by = {"python": platform.python_version()}
    made_by |= {package: version(package) for package in ("dopplerlib", "numba", "numpy", "scipy")}
    lines = [f"# {_first(name)}", f"# Written by `make study NAME={name}`; do not edit."]
    for title, table in {"parameters": study.PARAMETERS, "versions": made_by}.items():
        lines += [
            "",
            f"[{title}]",
            *(f"{key} = {json.dumps(table[key], default=str)}" for key in table),
        ]
    return "\n".join(lines) + "\n"


def _first(name):
    return about(name).partition("\n")[0]


def main(argv=None):
    """Run the study that is named, or list all."""
    options = argparse.ArgumentParser(
        prog="python -m studies",
        description=f"Run a study and write results/NAME.*\n\n{listing()}",
        epilog="NAME --help says what a study computes and what it costs.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        add_help=False,
    )
    options.add_argument("name", metavar="NAME", nargs="?", choices=names(), help="a study")
    options.add_argument("--help", action="store_true", help="show this, or what NAME is")
    chosen = options.parse_args(argv)
    if chosen.name is None:
        print(options.format_help() if chosen.help else listing())
    elif chosen.help:
        print(about(chosen.name))
    else:
        run(chosen.name)


if __name__ == "__main__":
    start(main)
