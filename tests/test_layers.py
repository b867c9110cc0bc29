"""Imports go one way: a package may use only itself and those above it in this list."""

import ast
from functools import cache
from pathlib import Path

import pytest

LIBRARY = Path(__file__).resolve().parents[1] / "dopplerlib"

ORDER = [
    "_lazy",
    "_records",
    "_data",
    "_typing",
    "_checks",
    "_hints",
    "_compile",
    "_straight",
    "_cholesky",
    "_progress",
    "_toml",
    "_files",
    "kernels",
    "model",
    "signal",
    "estimation",
    "tracking",
    "chain",
    "evaluation",
    "workspace",
    "replication",
    "systems",
    "figures",
    "commandline",
    "__main__",
]
# Computes with none of them, and none imports it.
APART = {"derive": ["_lazy", "_records", "_checks", "_hints"]}
ROOT = "__init__"  # loads nothing before a name is asked for; test_import.py sees to it
MAY_IMPORT = (
    {name: ORDER[: place + 1] for place, name in enumerate(ORDER)}
    | {name: [*used, name] for name, used in APART.items()}
    | {ROOT: ["_lazy"]}
)
# Libraries that only one package may import. With importlib an import could hide from this test,
# though not with the part of it that finds files.
ONLY = {"sympy": "derive", "matplotlib": "figures", "importlib": "_lazy"}
HARMLESS = "importlib.resources", "importlib.metadata"


@cache
def imports(path, package):
    """Return (line, absolute dotted name) of every import in a module, inside functions as well.

    ``from a import b`` is a.b, since b may be a module. `package` is where the module stands.
    """
    found = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found += [(node.lineno, alias.name) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) + 1 - node.level] if node.level else ()
            base = (*base, node.module) if node.module else base
            found += [(node.lineno, ".".join([*base, alias.name])) for alias in node.names]
    return found


def violations(library):
    """Return "file:line: name" of every import under the folder `library` that is not allowed."""
    found = []
    for path in sorted(library.rglob("*.py")):
        parts = path.relative_to(library).with_suffix("").parts
        if parts[0] not in MAY_IMPORT:
            found.append(f"{path.relative_to(library).as_posix()}: has no place in the order")
            continue
        for line, name in imports(path, (library.name, *parts[:-1])):
            top, _, rest = name.partition(".")
            if top == library.name:
                allowed = rest.split(".")[0] in MAY_IMPORT[parts[0]]
            else:
                allowed = name.startswith(HARMLESS) or ONLY.get(top, parts[0]) == parts[0]
            if not allowed:
                found.append(f"{path.relative_to(library).as_posix()}:{line}: {name}")
    return found


def test_the_library_imports_one_way_only():
    assert violations(LIBRARY) == []


def test_every_module_of_the_library_was_seen():
    seen = {
        path.relative_to(LIBRARY).parts[0].removesuffix(".py") for path in LIBRARY.rglob("*.py")
    }
    assert {"_checks", "kernels", "model", "derive", "figures", ROOT} <= seen <= set(MAY_IMPORT)


def private_imports(library):
    """Return "file:line: name" of every private name that is imported from another package."""
    found = []
    for path in sorted(library.rglob("*.py")):
        parts = path.relative_to(library).with_suffix("").parts
        for line, name in imports(path, (library.name, *parts[:-1])):
            top, package, *rest = [*name.split("."), ""]
            foreign = top == library.name and package != parts[0] and not package.startswith("_")
            if foreign and any(part.startswith("_") for part in rest):
                found.append(f"{path.relative_to(library).as_posix()}:{line}: {name}")
    return found


def test_no_package_uses_what_is_private_to_another():
    """What the house needs without checks stands in a public module, such as gaussian."""
    assert private_imports(LIBRARY) == []


@pytest.fixture
def tree(tmp_path):
    """Return a function that writes modules, given by path and text, and returns their folder."""

    def write(modules):
        for name, text in modules.items():
            path = tmp_path / "dopplerlib" / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        return tmp_path / "dopplerlib"

    return write


@pytest.mark.parametrize(
    ("module", "text", "name"),
    [
        ("model/a.py", "from ..estimation.track import Track", "dopplerlib.estimation.track.Track"),
        ("model/a.py", "from ..estimation import track", "dopplerlib.estimation.track"),
        ("model/a.py", "from .. import estimation", "dopplerlib.estimation"),
        ("model/a.py", "import dopplerlib.figures.style", "dopplerlib.figures.style"),
        ("model/a.py", "import numpy, dopplerlib.systems", "dopplerlib.systems"),
        ("model/a.py", "from dopplerlib import ekf", "dopplerlib.ekf"),
        ("model/a.py", "import dopplerlib", "dopplerlib"),
        ("model/a.py", "from dopplerlib import *", "dopplerlib.*"),
        ("model/deep/a.py", "from ...systems import b", "dopplerlib.systems.b"),
        ("model/__init__.py", "from ..tracking import b", "dopplerlib.tracking.b"),
        ("estimation/a.py", "def f():\n    from ..evaluation import b", "dopplerlib.evaluation.b"),
        ("evaluation/a.py", "from ..replication import b", "dopplerlib.replication.b"),
        ("replication/a.py", "if True:\n    from ..systems import b", "dopplerlib.systems.b"),
        ("kernels/a.py", "from ..model import b", "dopplerlib.model.b"),
        ("_checks.py", "from .model import b", "dopplerlib.model.b"),
        ("_checks.py", "from . import kernels", "dopplerlib.kernels"),
        ("derive/a.py", "from ..kernels import b", "dopplerlib.kernels.b"),
        ("derive/a.py", "from .. import _files", "dopplerlib._files"),
        ("figures/a.py", "from ..derive import b", "dopplerlib.derive.b"),
        ("__init__.py", "from .model import b", "dopplerlib.model.b"),
        ("figures/a.py", "import sympy as sp", "sympy"),
        ("model/a.py", "from sympy.printing import c", "sympy.printing.c"),
        ("systems/a.py", "import matplotlib.pyplot as plt", "matplotlib.pyplot"),
        ("derive/a.py", "import matplotlib", "matplotlib"),
        ("model/a.py", "from importlib import import_module", "importlib.import_module"),
    ],
)
def test_an_import_against_the_order_is_found(tree, module, text, name):
    line = text.count("\n") + 1
    assert violations(tree({module: text})) == [f"{module}:{line}: {name}"]


@pytest.mark.parametrize(
    ("module", "text"),
    [
        ("_checks.py", "import numpy as np"),
        ("kernels/a.py", "from numpy import sqrt"),
        ("model/a.py", "from .. import _checks\nfrom ..kernels import b\nfrom .c import d"),
        ("model/a.py", "from . import sympy"),
        ("model/a.py", "text = 'import dopplerlib.figures'"),
        ("signal/a.py", "from ..model.b import c"),
        ("tracking/a.py", "def f():\n    from ..estimation import b"),
        ("evaluation/a.py", "from scipy.stats import chi2"),
        ("replication/a.py", "from ..evaluation import b"),
        ("systems/a.py", "from ..replication import b\nfrom ..model import c"),
        ("figures/a.py", "import matplotlib.pyplot\nfrom ..systems import b\nfrom .style import c"),
        ("figures/a.py", "from importlib.resources import files"),
        ("derive/a.py", "import sympy\nfrom .block import Block\nfrom . import ekf"),
        ("derive/a.py", "from .. import _checks\nfrom .._hints import checked"),
        ("_lazy.py", "from importlib import import_module"),
        ("__init__.py", "from ._lazy import attach"),
    ],
)
def test_an_import_along_the_order_is_not(tree, module, text):
    assert violations(tree({module: text})) == []


def test_a_package_that_has_no_place_in_the_order_is_found(tree):
    folder = tree({"extras/a.py": "", "helpers.py": "", "model/a.py": ""})
    assert violations(folder) == [
        "extras/a.py: has no place in the order",
        "helpers.py: has no place in the order",
    ]


def test_what_is_private_to_another_package_is_found(tree):
    folder = tree(
        {
            "tracking/a.py": "from ..estimation.b import _c\nfrom ._d import e",
            "tracking/f.py": "from .. import _checks\nfrom ..estimation._g import h",
        }
    )
    assert private_imports(folder) == [
        "tracking/a.py:1: dopplerlib.estimation.b._c",
        "tracking/f.py:2: dopplerlib.estimation._g.h",
    ]
