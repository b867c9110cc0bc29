"""Claims, deviations and scenarios: read as they stand, or refused with the file's name."""

import os
import re
import zipfile
from dataclasses import MISSING, fields

import numpy as np
import pytest

from dopplerlib import Scenario
from dopplerlib.replication.choices import Choice, read_choices
from dopplerlib.replication.claims import Claim, read_claims
from dopplerlib.replication.deviations import Deviation, read_deviations
from tests import together

TEXTS = {
    "claim": """
[[claim]]
id = "nis"
where = "Fig 6"
statement = "NIS is near six"
form = "number"
published = 5.82
rounding = 0.005
unit = "1"
verdict = "reproduced"
page = "figure6"
cell = "nis"
test = "tests/test_x.py::test_nis"
note = "n"
surrogate = "a walk"
kind = "result"
keys = ["5.82"]
premises = "p"
weight = "finding"
choices = ["gate"]
""",
    "choice": """
[[choice]]
id = "gate"
kind = "ours"
meaning = "gate"
values = ["none", "two-sided"]
reason = "both are usual"
since = 2026-11-29
beyond = ["one-sided"]
""",
    "deviation": """
[[deviation]]
id = "box"
where = "Section 3"
kind = "gap"
document = "The box is not told."
choice = "Two meters."
page = "start"
cell = "boxes"
claims = ["start-reliable"]
""",
    "scenario": """
[array]
shape = "ring"
n = 6
radius = 0.2
[target]
x0 = [0.8, 0.1, 0.1, -0.7, 0, 0]
[sampling]
T = 0.001
samples = 20
sigma_f = 0.4
[tracker]
sigma_a = 0.4
P0_diagonal = [0.1, 0.1, 0.1, 0.1, 0.1, 0.1]
""",
}
READ = {
    "claim": read_claims,
    "choice": read_choices,
    "deviation": read_deviations,
    "scenario": Scenario.from_toml,
}
each = pytest.mark.parametrize("what", READ)


def refused(what, path, content, message=""):
    """Check that a file is refused by a ValueError that begins with its name."""
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    with pytest.raises(ValueError, match=f"^{re.escape(str(path))}: .*{message}") as error:
        READ[what](path)
    assert len(str(error.value)) < 1000


@each
@pytest.mark.parametrize("before", [b"", b"\xef\xbb\xbf"])
@pytest.mark.parametrize("newline", ["\n", "\r\n"])
def test_what_editors_write_is_read(what, before, newline, tmp_path):
    path = tmp_path / "a.toml"
    path.write_bytes(before + TEXTS[what].replace("\n", newline).encode())
    assert READ[what](path) == READ[what](str(path))


@each
def test_a_file_in_an_archive_is_read(what, tmp_path):
    with zipfile.ZipFile(tmp_path / "a.zip", "w") as archive:
        archive.writestr("inside/a.toml", TEXTS[what])
        archive.writestr("inside/bad.toml", "x = 1")
    inside = zipfile.Path(tmp_path / "a.zip", "inside/")
    (tmp_path / "a.toml").write_text(TEXTS[what])
    assert READ[what](inside / "a.toml") == READ[what](tmp_path / "a.toml")
    with pytest.raises(ValueError, match=r"bad\.toml: "):
        READ[what](inside / "bad.toml")


@each
@pytest.mark.parametrize(
    "content",
    [
        '[[claim]]\nid = "a',
        b"\x80",
        "x = 1".encode("utf-16"),
        b"\x89PNG\x00",
        "",
        "a = " + "[" * 100_000,
        "a = " + "{b = " * 100_000,
        "a = 1" + "0" * 10_000,
        *(
            f"{name} = {value}"
            for name in ("claim", "array")
            for value in ("1", "'x'", "[[1]]", "[]")
        ),
        "claim = 'x'\ndeviation = 'x'",
        "[claim]\nid = 1",
        "[[array]]",
        "[[claim]]\n[[deviation]]",
    ],
)
def test_what_is_no_such_file_is_refused_by_its_name(what, content, tmp_path):
    refused(what, tmp_path / "a.toml", content)


@each
def test_an_entry_that_is_unknown_is_refused(what, tmp_path):
    refused(what, tmp_path / "a.toml", TEXTS[what] + "\nextra = 1\n", "extra")
    refused(what, tmp_path / "a.toml", "extra = 1\n" + TEXTS[what], "extra")
    refused(what, tmp_path / "a.toml", TEXTS[what] + "\n[extra]\na = 1\n", "extra")


NUMBERS = {"published", "rounding", "n", "radius", "T", "samples", "sigma_f", "sigma_a"}
LISTS = {"x0", "P0_diagonal"}
BAD = {
    "of_text": ["1", "1.5", "true", "nan", "[1]", "['a']", "{a = 1}", "2020-01-01", "''"],
    "of_number": ["'x'", "true", "nan", "inf", "-1.5", "{a = 1}", "2020-01-01", "['a']", "[[1]]"],
    "of_list": ["'x'", "true", "1.0", "[nan, 1, 1, 1, 1, 1]", "{a = 1}", "['a']", "[]", "[true]"],
    "texts": ["'x'", "1", "[1]", "['']", "{a = 1}", "[['a']]"],
    "values": ["'x'", "1", "['']", "['a', 1]", "{a = 1}", "[['a']]", "[nan]", "['none', 'none']"],
    "date": ["'2026-11-29'", "1", "true", "[2026-11-29]", "12:00:00"],
}
CASES = [
    (what, name, value)
    for what, text in TEXTS.items()
    for name in re.findall(r"^(\w+) = ", text, re.MULTILINE)
    for value in BAD[
        "of_number"
        if name in NUMBERS
        else "of_list"
        if name in LISTS
        else "texts"
        if name in ("claims", "choices", "keys")
        else "values"
        if name in ("values", "beyond")
        else "date"
        if name == "since"
        else "of_text"
    ]
    if not (
        name in ("unit", "note", "surrogate", "premises") and value == "''"
    )  # these may be empty
    and not (name == "published" and value == "-1.5")
]


@pytest.mark.parametrize(("what", "name"), dict.fromkeys(case[:2] for case in CASES))
def test_an_entry_of_a_wrong_kind_is_refused(what, name, tmp_path):
    entry = re.compile(rf"^{name} = .*$", flags=re.MULTILINE)

    def check(*case):
        text, count = entry.subn(f"{name} = {case[-1]}", TEXTS[what])
        assert count == 1
        refused(what, tmp_path / "a.toml", text, name)

    together.each([case for case in CASES if case[:2] == (what, name)], check)


def test_every_entry_was_tried():
    for what, cls in (("claim", Claim), ("deviation", Deviation), ("choice", Choice)):
        tried = {name for of, name, _ in CASES if of == what}
        assert tried == {field.name for field in fields(cls)} - {"relation", "limit"}


@pytest.mark.parametrize(
    ("what", "name"),
    [
        (what, field.name)
        for what, cls in (("claim", Claim), ("deviation", Deviation), ("choice", Choice))
        for field in fields(cls)
        if field.default is MISSING
    ],
)
def test_an_entry_that_is_missing_is_named(what, name, tmp_path):
    text = re.sub(rf"^{name} = .*\n", "", TEXTS[what], flags=re.MULTILINE)
    refused(what, tmp_path / "a.toml", text, f"must have {name}")


@pytest.mark.parametrize(
    ("form", "relation"),
    [("relation", ""), ("relation", "'='"), ("draw", "'<'"), ("draw", "1")],
)
def test_a_relation_belongs_to_a_relation_and_to_nothing_else(form, relation, tmp_path):
    text = TEXTS["claim"].replace('"number"', f'"{form}"')
    text += f"relation = {relation}\n" if relation else ""
    refused("claim", tmp_path / "a.toml", text, "relation of claim 'nis' must")


def test_numbers_that_do_not_fit_into_memory_are_refused(tmp_path):
    text = TEXTS["scenario"].replace("n = 6", "n = 1000000000000000")
    refused("scenario", tmp_path / "a.toml", text, "n must be at most 1000000")


@each
@pytest.mark.parametrize(
    "path",
    [None, 1.5, True, 3, b"a.toml", ["a.toml"], "a\0b", "", "no/where.toml", "x" * 5000, np.nan],
    ids=lambda value: repr(value)[:12],
)
def test_what_is_no_path_of_a_file_is_refused(what, path):
    with pytest.raises(ValueError, match=r"^path must be a (path|file)"):
        READ[what](path)


@each
def test_a_number_is_no_open_file(what, tmp_path):
    (tmp_path / "a.toml").write_text(TEXTS[what])
    number = os.open(tmp_path / "a.toml", os.O_RDONLY)
    try:
        with pytest.raises(ValueError, match=r"^path must be a path"):
            READ[what](number)
        os.fstat(number)  # it was not closed
    finally:
        os.close(number)


@each
def test_a_folder_and_a_pipe_are_refused(what, tmp_path):
    os.mkfifo(tmp_path / "pipe")  # reading it would wait for ever
    for path in (tmp_path, tmp_path / "pipe", "/dev/null"):
        with pytest.raises(ValueError, match=r"^path must be a file that exists"):
            READ[what](path)
