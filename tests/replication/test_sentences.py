"""Every sentence of a document has a claim or a reason, and none is left out.

The texts are not ours to give away. Who has them names their folder in SOURCE_TEXTS.
"""

import hashlib
import os
import re
from pathlib import Path

import pytest

from dopplerlib.replication.documents import documents, read_document
from dopplerlib.replication.sentences import Sentence, Sentences, read_sentences

COMPARES = re.compile(
    r"\d|\b(better|worse|higher|lower|more|less|larger|smaller|faster|improve[ds]?|reduce[ds]?"
    r"|increase[ds]?|decrease[ds]?|converges?|accurate|accuracy|reliable|always|never|only|all"
    r"|most|best)\b"
)
GOOD = """
[text]
lines = 2
sha256 = "%s"
[[sentence]]
lines = [1, 2]
where = "Section 1"
keys = ["six"]
says = "There are six sensors."
claims = ["ring"]
"""


@pytest.fixture(params=documents())
def document(request):
    return read_document(request.param)


def read(tmp_path, text):
    path = tmp_path / "sentences.toml"
    path.write_text(text % ("0" * 64), encoding="utf-8")
    return read_sentences(path)


def test_a_sentence_has_what_the_file_says(tmp_path):
    found = read(tmp_path, GOOD)
    assert (found.lines, found.entries[0].claims) == (2, ("ring",))
    assert "| Section 1 | There are six sensors. |" in found._repr_markdown_()
    assert found.of("ring") == found.entries
    assert found.of("other") == ()


@pytest.mark.parametrize(
    "old, new, message",
    [
        ("[1, 2]", "[2, 2]", "entries must cover every line, got none for line 1"),
        ("[1, 2]", "[1, 3]", "lines of .*sentence 1, must be the first and the last of 2 lines"),
        ('claims = ["ring"]', "", "sentence 1, must have claims or the reason"),
        ('["ring"]', '["ring"]\nreason = "none"', "sentence 1, must have claims or the reason"),
        ('["six"]', '"six"', "keys of .*sentence 1, must be a tuple"),
        ('where = "Section 1"', "", "sentence 1 must have where"),
        ("[text]", "[txt]", "the file must have text"),
    ],
)
def test_a_wrong_file_is_refused(tmp_path, old, new, message):
    assert old in GOOD
    with pytest.raises(ValueError, match=message):
        read(tmp_path, GOOD.replace(old, new))


def test_what_is_no_sentence_is_refused():
    with pytest.raises(ValueError, match="entries must be a Sentence"):
        Sentences(1, "0" * 64, ["text"])
    with pytest.raises(ValueError, match="lines must be a whole number of at least 1"):
        Sentences(0, "0" * 64, [Sentence((1, 1), "w", "s", reason="r")])


def test_every_claim_rests_on_a_sentence_and_no_sentence_on_a_claim_that_is_not_there(document):
    named = {claim for one in document.sentences.entries for claim in one.claims}
    assert named == {claim.id for claim in document.claims}


def text_of(document):
    """Return the lines of the document's text, if it is at hand."""
    for path in sorted(Path(os.environ.get("SOURCE_TEXTS", "no-folder")).glob("*.txt")):
        content = path.read_bytes()
        if hashlib.sha256(content).hexdigest() == document.sentences.sha256:
            return content.decode().splitlines()
    pytest.skip("the text of this document is not at hand")


def test_no_sentence_is_left_out_and_every_key_is_where_it_should_be(document):
    lines = text_of(document)
    assert len(lines) == document.sentences.lines
    whole, reached = [False] * len(lines), [[] for _ in lines]
    for one in document.sentences.entries:
        first, last = one.lines
        text = " ".join(" ".join(lines[first - 1 : last]).split())
        assert [key for key in one.keys if key not in text] == [], (one.where, one.lines)
        for place in range(first - 1, last):
            whole[place] |= not one.keys
            reached[place] += one.keys
    left = [
        (place + 1, sentence)
        for place, line in enumerate(lines)
        if not whole[place]
        for sentence in re.split(r"(?<=[.!?:;]) (?=[A-Z(*$])", " ".join(line.split()))
        if COMPARES.search(sentence) and not any(key in sentence for key in reached[place])
    ]
    assert left == []


def test_the_place_of_every_claim_is_found_by_its_keys(document):
    text = " ".join(" ".join(text_of(document)).split())
    assert {
        one.id: one.keys for one in document.claims if not all(k in text for k in one.keys)
    } == {}
