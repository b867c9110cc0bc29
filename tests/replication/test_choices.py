"""What we choose is declared with its range and its reason, or refused."""

import pytest

from dopplerlib._data import data
from dopplerlib.replication.choices import read_choices
from dopplerlib.replication.documents import documents, read_document

GOOD = """
[[choice]]
id = "gate"
kind = "ours"
meaning = "gate on the innovations"
values = ["none", "two-sided"]
reason = "both are usual"
since = 2026-11-29
"""


def read(tmp_path, text):
    path = tmp_path / "choices.toml"
    path.write_text(text, encoding="utf-8")
    return read_choices(path)


def test_a_choice_has_what_the_file_says(tmp_path):
    (choice,) = read(tmp_path, GOOD)
    assert (choice.id, choice.values, choice.beyond) == ("gate", ("none", "two-sided"), ())
    assert choice.since.year == 2026


@pytest.mark.parametrize(
    "old, new, message",
    [
        (GOOD, GOOD + GOOD, "the id of a choice must be unique, got 'gate' twice"),
        ('"ours"', '"theirs"', "kind of choice 'gate' must be one of 'reading', 'ours'"),
        ('"both are usual"', '""', "reason of choice 'gate' must"),
        ("2026-11-29", '"today"', "since of choice 'gate' must be a date"),
        ('["none", "two-sided"]', "[]", "values of choice 'gate' must be a list of at least 1"),
        ('["none", "two-sided"]', '"none"', "values of choice 'gate' must be a list of at least 1"),
        (
            '["none", "two-sided"]',
            '["none", 1.0]',
            "values and beyond of choice 'gate' must be an array of real",
        ),
        (
            '["none", "two-sided"]',
            "[1.0, inf]",
            "values and beyond of choice 'gate' must be finite",
        ),
        (
            '["none", "two-sided"]',
            '["none", "none"]',
            "values and beyond of choice 'gate' must differ",
        ),
    ],
)
def test_a_wrong_file_is_refused(tmp_path, old, new, message):
    assert old in GOOD
    with pytest.raises(ValueError, match=message):
        read(tmp_path, GOOD.replace(old, new))


@pytest.mark.parametrize("name", documents())
def test_every_choice_of_a_document_enters_one_of_its_claims(name):
    document = read_document(name)
    used = {one for claim in document.claims for one in (*claim.choices, claim.limit)}
    shared = {one.id for one in shared_choices()}
    assert {one.id for one in document.choices} - shared <= used


def shared_choices():
    """Return the choices that all documents share."""
    return read_choices(data("choices.toml"))


def test_every_word_that_documents_share_is_used_by_one():
    claims = [claim for name in documents() for claim in read_document(name).claims]
    used = {one for claim in claims for one in (*claim.choices, claim.limit)}
    assert {one.id for one in shared_choices()} <= used
