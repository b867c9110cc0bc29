"""Run a study and write its results, or list the studies.

results/NAME.* appears when it is complete. Beside the numbers stands results/NAME.toml, with the
parameters and the versions that made them. An interrupted study goes on where it stopped. Worker
processes, here or on other machines, change nothing but the time it takes.
"""

import argparse
import ast
import json
import shutil
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from importlib import import_module
from multiprocessing import get_context
from pathlib import Path

from dopplerlib._files import replacing
from dopplerlib._lazy import require
from dopplerlib.evaluation._study_folder import versions
from dopplerlib.evaluation.monte_carlo import run_study
from tools.alone import alone
from tools.command import quiet_worker, start

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


def run(name, folder=RESULTS, executor=None):
    """Do what is left of a study and write its files, all at once.

    Chunks of runs are kept in NAME.part until then. `executor` computes them; None: this process.
    """
    study = import_module(f"studies.{name}")
    parts, unfinished = list(study.parts()), folder / f"{name}.part"
    parameters = json.loads(json.dumps(study.PARAMETERS, default=str))
    with alone(unfinished / "lock", name):
        found = [
            run_study(
                study.compute,
                parameters | settings,
                runs,
                seed=parameters["seed"],
                chunk=chunk,
                folder=unfinished / str(place),
                executor=executor,
                label=f"{name} {place}/{len(parts)}" if runs > chunk else None,
            )
            for place, (settings, runs, chunk) in enumerate(parts, start=1)
        ]
        contents = [*study.contents(found), provenance(study, name)]
        with replacing(*files(study, name, folder), folder / f"{name}.toml") as new:
            for path, content in zip(new, contents, strict=True):
                path.write_bytes(content.encode() if isinstance(content, str) else content)
        shutil.rmtree(unfinished)


def files(study, name, folder=RESULTS):
    """Return where a study leaves its numbers."""
    return [folder / f"{name}{end}" for end in study.FILES]


def provenance(study, name):
    """Return the text of the file that says how the others were made."""
    lines = [f"# {_first(name)}", f"# Written by `make study NAME={name}`; do not edit."]
    for title, table in {"parameters": study.PARAMETERS, "versions": versions()}.items():
        lines += [
            "",
            f"[{title}]",
            *(f"{key} = {json.dumps(table[key], default=str)}" for key in table),
        ]
    return "\n".join(lines) + "\n"


@contextmanager
def executor(workers, scheduler):
    """Give the executor that is asked for: of processes here, of a Dask cluster, or none."""
    if scheduler is not None:
        require("distributed", extra="cluster")
        from distributed import Client

        with Client(scheduler) as client:
            yield client.get_executor()
    elif workers > 1:
        fresh = get_context("spawn")  # no thread of ours is copied
        with ProcessPoolExecutor(workers, fresh, quiet_worker) as pool:
            yield pool
    else:
        yield None


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
    where = options.add_mutually_exclusive_group()
    where.add_argument("--workers", metavar="N", type=int, default=1, help="processes, one if not")
    where.add_argument("--scheduler", metavar="ADDRESS", help="of a Dask cluster: tcp://host:8786")
    options.add_argument("--help", action="store_true", help="show this, or what NAME is")
    chosen = options.parse_args(argv)
    if chosen.name is None:
        print(options.format_help() if chosen.help else listing())
    elif chosen.help:
        print(about(chosen.name))
    else:
        with executor(chosen.workers, chosen.scheduler) as pool:
            run(chosen.name, executor=pool)


if __name__ == "__main__":
    start(main)
