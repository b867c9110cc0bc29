"""The text that a reviewer reads: one sentence a line, nothing lost, nothing but words moved."""

import json
import re

import pytest

from tools.notebooks import chapters
from tools.prose import as_text, sentences, text_path


@pytest.mark.parametrize(
    ("text", "lines"),
    [
        ("One. Two\nand more. Three?", ["One.", "Two and more.", "Three?"]),
        ("See Fig. 3 and Li et al. (2016). Then", ["See Fig. 3 and Li et al. (2016).", "Then"]),
        ("A value of 0.4 Hz. Yes.", ["A value of 0.4 Hz.", "Yes."]),
        ('He says "no." She asks.', ['He says "no."', "She asks."]),
        ("Take `a. B` or $x. Y$ first. Go.", ["Take `a. B` or $x. Y$ first.", "Go."]),
        ("1. First. Second.\n2. Third.", ["1. First.", "   Second.", "2. Third."]),
        ("* A long\n  item. Ends.", ["* A long item.", "  Ends."]),
        ("It ends. 1. is no list here.", ["It ends. 1. is no list here."]),
    ],
)
def test_a_sentence_is_a_line(text, lines):
    assert sentences(text).split("\n") == lines


@pytest.mark.parametrize(
    "text",
    [
        "# A title. Of two sentences.",
        "| a. B | c |\n|---|---|",
        "$$\na. B\n$$",
        "$$ a. B $$",
        "```python\nx = 1. \nY = 2\n```",
        ":::{note}\n:class: tip. Top",
        "A line break.  \nThat is meant. Here.",
    ],
)
def test_what_is_laid_out_by_hand_stays(text):
    assert sentences(text) == text


def test_of_all_chapters_nothing_but_white_space_changes():
    for path in chapters():
        for cell in json.loads(path.read_text(encoding="utf8"))["cells"]:
            if cell["cell_type"] != "code":
                text = "".join(cell["source"])
                once = sentences(text)
                assert sentences(once) == once
                assert re.sub(r"\s+", " ", once) == re.sub(r"\s+", " ", text)


def test_the_text_of_a_chapter_has_its_prose_code_and_results_and_no_picture():
    outputs = [
        {"output_type": "stream", "name": "stdout", "text": ["0.4\n"]},
        {"output_type": "display_data", "data": {"image/png": "iVBOR", "text/plain": "<Figure>"}},
        {"output_type": "execute_result", "data": {"text/plain": ["7"]}},
    ]
    cells = [
        {"cell_type": "markdown", "source": ["One. ", "Two."]},
        {"cell_type": "code", "id": "sum", "source": "print(0.4)", "outputs": outputs},
    ]
    assert as_text({"cells": cells}) == (
        "One.\nTwo.\n\n```python\n# cell sum\nprint(0.4)\n```\n\n```text\n0.4\n7\n```\n"
    )


@pytest.mark.parametrize("chapter", chapters(), ids=lambda path: path.stem)
def test_the_text_beside_a_chapter_is_that_of_the_chapter(chapter):
    text = as_text(json.loads(chapter.read_text(encoding="utf8")))
    assert text_path(chapter).read_text(encoding="utf8") == text, "run: make chapter NAME=..."


def test_no_text_is_left_of_a_chapter_that_is_gone():
    folder = text_path(chapters()[0]).parent
    assert sorted(folder.iterdir()) == sorted(text_path(path) for path in chapters())
