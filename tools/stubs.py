"""Write the stubs of the packages: what they load when it is asked for, for editors and mypy."""

import ast
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules

import dopplerlib
from tools.command import parser, start

LIBRARY = Path(dopplerlib.__file__).parent


def stubs():
    """Return {path: text} of the stub of every package that has nothing but what it loads."""
    found = {}
    for path in sorted(LIBRARY.rglob("__init__.py")):
        package = import_module(".".join(path.relative_to(LIBRARY.parent).parent.parts))
        home = getattr(package, "_HOME", {})
        if not home and _gives_names(path):
            continue
        modules = sorted(m.name for m in iter_modules([str(path.parent)]) if m.name[0] != "_")
        lines = ["# Made by python -m tools.stubs; do not edit."]
        lines += [f"from . import {name} as {name}" for name in modules]
        by_module = sorted(home.items(), key=lambda item: (item[1], *_rank(item[0])))
        lines += [f"from .{module} import {name} as {name}" for name, module in by_module]
        if home:
            names = "".join(f'    "{name}",\n' for name in sorted(package.__all__, key=_rank))
            lines += ["", f"__all__ = [\n{names}]"]
            lines += ["__version__: str"] * hasattr(package, "__version__")
        found[path.with_suffix(".pyi")] = "\n".join(lines) + "\n"
    return found


def _rank(name):
    """Return the key of the order that the linter wants: constants, classes, functions."""
    return not name.isupper(), name[0].islower(), name


def _gives_names(path):
    tree = ast.parse(path.read_text(encoding="utf-8"))
    imports = [node for node in tree.body if isinstance(node, ast.ImportFrom)]
    return any(node.module != "_lazy" for node in imports)


def main(argv=None):
    """Write them."""
    parser(__doc__).parse_args(argv)
    for path, text in stubs().items():
        path.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    start(main)
