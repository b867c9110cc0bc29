"""What is committed is what is printed, and printing is repeatable and safe."""

import difflib
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import sympy

import dopplerlib
from dopplerlib.derive import __main__ as command
from dopplerlib.derive.sources import kernel_sources

PACKAGE = Path(dopplerlib.__file__).parent
KERNELS = PACKAGE / "kernels"


@pytest.fixture(scope="module")
def sources():
    return kernel_sources()


@pytest.mark.parametrize("name", sorted(path.name for path in KERNELS.glob("[!_]*.py")))
def test_the_committed_kernel_is_what_is_printed(name, sources):
    committed = (KERNELS / name).read_text(encoding="utf-8")
    # That of the lock; older ones print the same formulas.
    committed = re.sub(r"(?<=SymPy )[\d.]+\d", sympy.__version__, committed, count=1)
    if committed != sources[name]:
        lines = difflib.unified_diff(
            committed.splitlines(),
            sources[name].splitlines(),
            "committed",
            "printed",
            "",
            "",
            0,
            "",
        )
        pytest.fail(f"run make kernels: {name} is not what is printed\n" + "\n".join(lines))


def test_there_is_no_kernel_that_nobody_prints(sources):
    assert {path.name for path in KERNELS.glob("*.py")} == {"__init__.py", *sources}


def derive(root, seed):
    """Run the command in a copy of the package at `root`."""
    environment = {**os.environ, "PYTHONPATH": str(root), "PYTHONHASHSEED": str(seed)}
    subprocess.run(
        [sys.executable, "-m", "dopplerlib.derive"],
        cwd=root, env=environment, check=True, capture_output=True,
    )  # fmt: skip


def test_the_text_does_not_depend_on_the_order_of_sets(tmp_path, sources):
    # Python orders sets of strings by a hash that differs from process to process.
    for seed in (0, 1):  # these two do order the sets of this program differently
        root = tmp_path / str(seed)
        for part in ("derive", "kernels"):
            shutil.copytree(
                PACKAGE / part,
                root / "dopplerlib" / part,
                ignore=shutil.ignore_patterns("__pycache__"),
            )
        for name in ("__init__.py", "_records.py"):
            shutil.copy(PACKAGE / name, root / "dopplerlib")
        written = root / "dopplerlib" / "kernels"
        for name in sources:
            (written / name).write_text("stale = True\n")
        derive(root, seed)
        for name, text in sources.items():
            assert (written / name).read_bytes() == text.encode()
        committed = {path.name for path in KERNELS.iterdir() if path.is_file()}
        assert {path.name for path in written.iterdir()} == committed


def test_a_kernel_is_replaced_in_one_step(tmp_path, monkeypatch, sources):
    """Whoever reads while the command writes sees the old text or the new one, both whole."""
    for name in sources:
        (tmp_path / name).write_text("old\n")
    replaced = []

    def replace(source, target):
        assert Path(target).read_text() == "old\n"
        assert Path(source).read_text(encoding="utf-8") == sources[Path(target).name]
        assert Path(source).parent == Path(target).parent  # else it would be a copy
        replaced.append(Path(target).name)
        os.rename(source, target)

    monkeypatch.setattr(command, "KERNELS", tmp_path)
    monkeypatch.setattr(command.os, "replace", replace)
    command.main()
    assert replaced == list(sources)
    assert {path.name for path in tmp_path.iterdir()} == set(sources)
