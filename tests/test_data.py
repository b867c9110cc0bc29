"""Data and results are what their READMEs say: the files, the columns, and what is missing."""

import csv
import hashlib
import json
import math
import re
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
DATA, RESULTS = ROOT / "data", ROOT / "results"
SOURCES = sorted(path for path in DATA.iterdir() if path.is_dir())
FOLDERS = [*SOURCES, RESULTS]
FILES = sorted(
    path for folder in FOLDERS for path in folder.iterdir() if path.suffix not in (".md", ".part")
)
PAPER = DATA / "mittermaier2016"


def name(path):
    return path.relative_to(ROOT).as_posix()


def readme(folder):
    return (folder / "README.md").read_text(encoding="utf-8")


def table_under(title, text):
    """Return the first column of the table in the section of that title, without its head."""
    section = text.split(f"## `{title}`\n")[1].split("\n## ")[0]
    return re.findall(r"^\| `([^`]+)` \|", section, flags=re.MULTILINE)


def rows(path):
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def column(path, title):
    return [float(row[title]) for row in rows(path)]


def unknown(path, title):
    """Return the samples at which a column has no value."""
    values = zip(column(path, "sample"), column(path, title), strict=True)
    return [int(sample) for sample, value in values if math.isnan(value)]


def test_every_folder_is_in_the_readme_of_the_data():
    linked = re.findall(r"\]\(([\w-]+)\)", readme(DATA))
    assert sorted(linked) == [folder.name for folder in SOURCES]


@pytest.mark.parametrize("folder", FOLDERS, ids=name)
def test_every_file_is_in_the_readme_of_its_folder_and_no_other(folder):
    linked = re.findall(r"^\| \[`([^`]+)`\]\(\1\) \|", readme(folder), flags=re.MULTILINE)
    # How a result was made stands beside it, in NAME.toml: one sentence tells of all of them.
    beside = {".toml"} if folder == RESULTS else set()
    here = [path.name for path in FILES if path.parent == folder and path.suffix not in beside]
    assert sorted(linked) == here


@pytest.mark.parametrize("folder", SOURCES, ids=name)
def test_every_source_is_cited_and_its_terms_are_told(folder):
    """A source has authors, a title and a year; not every one has a DOI or an open license."""
    quote = " ".join(re.findall(r"^> (.*)$", readme(folder), flags=re.MULTILINE))
    assert re.search(r"^\w.*: \*[^*]+\*.*\b(19|20)\d\d\b", quote)
    assert re.search(r"\blicense\b", readme(folder))


@pytest.mark.parametrize("path", [p for p in FILES if p.suffix == ".csv"], ids=name)
def test_a_csv_has_the_columns_that_its_readme_explains(path):
    with path.open(encoding="utf-8", newline="") as file:
        head, *lines = csv.reader(file)
    assert head == table_under(path.name, readme(path.parent))
    assert {len(line) for line in lines} == {len(head)}
    for line in lines:
        for value in line:
            assert math.isfinite(float(value)) or value == "NaN"


@pytest.mark.parametrize("path", [p for p in FILES if p.suffix == ".json"], ids=name)
def test_a_json_file_has_the_entries_that_its_readme_explains(path):
    content = json.loads(path.read_text(encoding="utf-8"))
    title = re.sub(r"^\w+\.verdicts", "NAME.verdicts", path.name)  # the same in all of them
    assert list(content) == table_under(title, readme(path.parent))


@pytest.mark.parametrize("path", sorted(DATA.glob("*/*.toml")), ids=name)
def test_a_toml_file_names_its_source(path):
    text = path.read_text(encoding="utf-8")
    tomllib.loads(text)
    first, folder = text.splitlines()[0], path.parent.name
    assert first.startswith("# ") and folder.rstrip("0123456789") in first.lower().replace("å", "a")


@pytest.mark.parametrize("path", [p for p in FILES if p.suffix == ".sigmf-meta"], ids=name)
def test_a_recording_says_that_it_is_simulated_and_has_its_samples(path):
    meta = json.loads(path.read_text(encoding="utf-8"))["global"]
    assert "Simulated" in meta["core:description"]
    data = path.with_suffix(".sigmf-data").read_bytes()
    assert hashlib.sha512(data).hexdigest() == meta["core:sha512"]
    told = re.search(r"\| (\d+) for each channel at (\d+) kHz", readme(path.parent)).groups()
    samples, kilohertz = map(int, told)
    assert len(data) == samples * meta["core:num_channels"] * 2 * 2  # I and Q of two bytes each
    assert meta["core:sample_rate"] == 1000 * kilohertz


@pytest.mark.parametrize("file", ["fig6_nis.csv", "fig6_errors.csv"])
def test_a_curve_has_every_sample_once_and_in_order(file):
    count = tomllib.loads((PAPER / "table2.toml").read_text())["derived_checks"]["nis_count"]
    assert column(PAPER / file, "sample") == list(range(1, count + 1))


def test_nis_is_known_at_every_sample_and_skips_at_all_but_the_first():
    path = PAPER / "fig6_nis.csv"
    assert unknown(path, "nis") == []
    assert unknown(path, "update_skipped") == [1]
    assert min(column(path, "nis")) > 0
    assert set(column(path, "update_skipped")[1:]) == {0, 1}


def test_errors_are_unknown_where_the_readme_says():
    path = PAPER / "fig6_errors.csv"
    told = re.search(
        r"that is x at samples (\d+) to (\d+) and z at samples (\d+) to (\d+) and (\d+) to (\d+)",
        readme(PAPER),
    )
    a, b, c, d, e, f = map(int, told.groups())
    assert unknown(path, "ex_cm") == list(range(a, b + 1))
    assert unknown(path, "ey_cm") == []
    assert unknown(path, "ez_cm") == [*range(c, d + 1), *range(e, f + 1)]


@pytest.mark.parametrize("axis", "xz")
def test_a_flag_says_whether_an_error_lies_above_the_axis_and_whether_it_is_known(axis):
    path = PAPER / "fig6_errors.csv"
    for value, flag in zip(column(path, f"e{axis}_cm"), column(path, f"e{axis}_flag"), strict=True):
        if flag == 2:
            assert math.isnan(value)
        else:
            assert flag == (value > 10)
            assert value >= 0


def test_the_final_errors_of_the_curves_are_those_of_the_checks():
    last = rows(PAPER / "fig6_errors.csv")[-1]
    checks = tomllib.loads((PAPER / "table2.toml").read_text())["derived_checks"]
    assert [float(last[f"e{axis}_cm"]) for axis in "xyz"] == checks["final_abs_error_cm_digitized"]
