"""What the benchmarks have measured: whole files, each with its program, and all of them shown."""

import json
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
FILES = sorted((ROOT / "benchmarks" / "measured").glob("*"))
TEXTS = {
    name: (ROOT / "book" / "text" / f"{name}.md").read_text(encoding="utf-8")
    for name in ("benchmarks", "scaling")
}


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_a_measured_file_says_how_when_and_with_what_it_was_made(path):
    content = json.loads(path.read_text(encoding="utf-8"))
    program = content["made by"].removeprefix("python ")
    assert program == f"benchmarks/{path.stem}.py"
    assert (ROOT / program).is_file()
    assert content["versions"].keys() >= {"Python", "numpy", "numba"}
    assert content["date"] >= "2026-11-30"
    assert len(content["load"]) == 2
    assert content["found"]
    # The page shows this measurement, and not that of another machine: it names them all.
    assert f'measured["{path.stem}"]' in TEXTS["benchmarks"] or path.name in TEXTS["scaling"]


def test_what_the_page_compares_agrees_in_most_runs():
    path = ROOT / "benchmarks" / "measured" / "ekf.json"
    found = json.loads(path.read_text(encoding="utf-8"))["found"]
    rows = {
        (kind, name): row for kind in ("one run", "many runs") for name, row in found[kind].items()
    }
    assert len(rows) > 20
    apart = {name for (_, name), row in rows.items() if 2 * row["beyond"] >= row["compared"]}
    assert apart <= {"Stone Soup, numerical"}  # its Jacobian is one of finite differences
