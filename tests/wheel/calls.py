"""Import all of a dopplerlib that was installed somewhere, and call something of every part of it.

Run as ``python -I -S calls.py LIBRARIES ROOT[:ROOT ...] [OPTION ...]``: isolated, so that no
checkout is seen. LIBRARIES is the folder of what the library depends on, ROOT the folder or the zip
file that holds it. Of several each is used by a copy of one process, which has imported LIBRARIES.
Prints a line of JSON for each ROOT.

core     What extras bring counts as not installed.
strict   NumPy raises where it would warn, and a process that is started afresh filters, too.
quick    The filter and a search for bad samples, which take seconds to compile, are left out.
"""

import json
import multiprocessing
import os
import pkgutil
import sys
from importlib import import_module

EXTRAS = {"matplotlib": "figures", "sympy": "derive", "sigmf": "recordings"}
COMPILED = ("estimation, compiled", "figures.figure6")


def part_calls(dl, np):
    """Return {what: function without arguments}: one at least for each package but the figures.

    Of the systems these are some that read files, or compile; `judged` reads what all have.
    """
    s = dl.systems
    ring, x0, one = dl.RadarArray.ring(6, 0.2), [1.0, 0, 0, -1, 0, 0], np.eye(1)
    nodes = np.arange(3.0)
    return {
        "model": lambda: dl.doppler_shift(x0, ring),
        "signal": lambda: dl.crlb_frequency_std(10.0, 64, 1000.0),
        "signal, recordings": lambda: s.mittermaier2016.read_simulated_iq()[2],
        "kernels": lambda: dl.kernels.doppler.doppler_shift(*x0, 0.0, 0.2, 0.0, 2.0),
        "estimation": lambda: dl.kf_update([0.0], one, [1.0], one, one)[0],
        "estimation, compiled": lambda: filtered(dl, np),
        "tracking": lambda: dl.gnn_assign([[1.0, 2.0], [3.0, 0.5]], 4.0)[0],
        "chain": lambda: dl.chain.baseband.Baseband.from_samples(np.ones((6, 500)), 1e3, ring).fs,
        "commandline": lambda: dl.commandline.main.main(["a.wav", "--array", "missing.toml"]),
        "evaluation": lambda: dl.chi2_interval(6),
        "workspace": lambda: dl.workspace.targets.draw_targets(1, rng=np.random.default_rng(1)),
        "replication": lambda: judged(dl),
        "systems, asheim2015": lambda: s.asheim2015.noise_std([1.0, 2.0]),
        "systems, macaveiu2013": lambda: s.macaveiu2013.saved_detections()[7]["target"],
        "systems, mittermaier2016": lambda: s.mittermaier2016.reported().figure6.nis,
        "systems, scenario": lambda: s.mittermaier2016.reported().scenario.truth,
        "systems, sombatsatien": lambda: s.sombatsatien.reported_record(),
        "systems, valarmathi": lambda: s.valarmathi.saved_study().snrs_db,
        "systems, compiled": lambda: s.valarmathi._pair_kernel.choose(
            0.1, 2.0, nodes, nodes, np.ones((3, 3)), nodes
        ),
    }


def filtered(dl, np):
    """Return where the compiled filter ends on a record of two samples."""
    dl, np = (import_module(one) if isinstance(one, str) else one for one in (dl, np))
    ring, x0 = dl.RadarArray.ring(3, 0.2), [1.0, 0, 0, -1, 0, 0]
    return dl.ekf(np.full((2, 3), 90.0), ring, x0, np.eye(6), 0.001, 0.4, 0.4).x[-1]


def filtered_afresh(dl, np):
    """Return the same from a new process, which finds the library by the path of this one."""
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        return pool.apply(filtered, (dl.__name__, np.__name__))


def judged(dl):
    """Read all judgments; return whether their verdicts are those of the claims."""
    names = dl.replication.documents.documents()
    judgments = [one for name in names for one in dl.replication.judgments.read_judgments(name)]
    return [one.verdict == one.claim.verdict for one in judgments]


def figure_calls(dl, np):
    """Return {figure: function without arguments that draws it}: all files that figures need.

    These are the style, which every figure has, and data. What else a module of the figures could
    lack outside of a checkout, importing it tells.
    """
    f, paper, rng = dl.figures, dl.systems.mittermaier2016, np.random.default_rng(1)
    return {
        "style": lambda: f.style.STYLE.read_text(encoding="utf-8"),
        "figure6": lambda: f.figure6.errors(
            paper.run_example(1, rng=rng, keep=()), paper.reported().figure6
        ),
    }


class Blocked:
    """Finder of modules for which those that extras bring are not installed."""

    @staticmethod
    def find_spec(name, path=None, target=None):
        """Refuse what belongs to an extra."""
        if name.split(".")[0] in EXTRAS:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)


def imported(dl):
    """Import every module; return their names, and the errors of packages that lack an extra."""
    names, errors = [], []
    # A package that cannot be imported is not walked into; its error is that of the loop.
    for module in pkgutil.walk_packages(dl.__path__, f"{dl.__name__}.", lambda name: None):
        if module.name.endswith("__main__"):
            continue
        try:
            import_module(module.name)
            names.append(module.name)
        except ModuleNotFoundError as error:
            errors.append(f"{module.name}: {error}")
    return names, errors


def check(result, np):
    """Raise unless a call gave finite numbers, a text, or a figure with something in it."""
    if hasattr(result, "axes"):
        result = len(result.axes) or np.nan
    if not result if isinstance(result, str) else not np.isfinite(np.array(result, float)).all():
        raise ValueError(f"got {result!r}")


def main(libraries, roots, *options):
    """Use the library of each root as the command line asks for."""
    sys.path.append(libraries)
    first, *others = roots.split(os.pathsep)
    if others:
        for name in ("matplotlib.pyplot", "scipy.optimize", "scipy.signal", "sigmf", "sympy"):
            import_module(name)
        import_module("numba").njit(lambda x: x)(1.0)  # reads the tables of its compiler
    for root in others:
        copy = os.fork()
        if not copy:
            return use(root, *options)
        if os.waitpid(copy, 0)[1]:
            raise SystemExit(f"not used: {root}")
    use(first, *options)


def use(root, *options):
    """Import and call all that is at a root, and print what was done."""
    sys.path[:0] = [root]
    if "core" in options:
        sys.meta_path.insert(0, Blocked)
    import dopplerlib as dl

    if not dl.__file__.startswith(root):
        raise SystemExit(f"the library comes from {dl.__file__}")
    packages = [hasattr(dl, name) for name in ("signal", "systems", "tracking")]
    import numpy as np

    if "strict" in options:
        np.seterr(all="raise")
    names, errors = imported(dl)
    calls = part_calls(dl, np)
    if "core" not in options:
        calls |= {f"figures.{name}": call for name, call in figure_calls(dl, np).items()}
    if "quick" in options:
        # Which samples are valid is told by loops that would be compiled for each root.
        dl.signal._joining.valid_samples = lambda x: np.ones(x.shape, bool)
        calls = {what: call for what, call in calls.items() if what not in COMPILED}
    if "strict" in options:
        calls["spawn"] = lambda: filtered_afresh(dl, np)
    for what, call in calls.items():
        try:
            check(call(), np)
        except Exception as error:
            errors.append(f"{what}: {type(error).__name__}: {error}")
    told = {"imports": names, "calls": [*calls], "errors": errors, "packages": packages}
    print(json.dumps(told | {"root": root}), flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
