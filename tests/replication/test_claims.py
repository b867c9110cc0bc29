"""A file of claims is read as it is written, or refused with the reason."""

import pytest

from dopplerlib.replication.claims import read_claims

GOOD = """
[[claim]]
id = "nis"
where = "Fig 6"
statement = "NIS is near six"
form = "draw"
published = 5.82
rounding = 0.005
verdict = "typical"
keys = ["NIS"]
unit = ""
page = "figure6"
cell = "nis"
test = "tests/test_x.py::test_nis"
"""


def read(tmp_path, text):
    path = tmp_path / "claims.toml"
    path.write_text(text, encoding="utf-8")
    return read_claims(path)


def test_a_claim_has_what_the_file_says(tmp_path):
    (claim,) = read(tmp_path, GOOD)
    assert (claim.id, claim.published, claim.rounding, claim.unit) == ("nis", 5.82, 0.005, "")


@pytest.mark.parametrize(
    "old, new, message",
    [
        (GOOD, "", r"must hold a list of \[\[claim\]\], got none"),
        (GOOD, GOOD + GOOD, "the id of a claim must be unique, got 'nis' twice"),
        ('where = "Fig 6"', "", "claim 'nis' must have where, got only"),
        ("unit", "unt", "claim 'nis' must have nothing but id, .*, got unt"),
        ('"draw"', '"luck"', "form of claim 'nis' must be one of .*, got 'luck'"),
        ('"typical"', '"fine"', "verdict of claim 'nis' must be one of .*, got 'fine'"),
        ('"draw"', '"relation"', "relation of claim 'nis' must be one of .*, got None"),
        (
            '"typical"',
            '"contradicted"',
            "note of claim 'nis' must say why it is contradicted, got none",
        ),
    ],
)
def test_a_wrong_file_is_refused(tmp_path, old, new, message):
    assert old in GOOD
    with pytest.raises(ValueError, match=message):
        read(tmp_path, GOOD.replace(old, new))
