"""The built pages: links arrive, ids are unique, tables have heads, formulas have numbers."""

import re
from collections import Counter
from pathlib import PurePosixPath
from posixpath import normpath
from urllib.parse import unquote

import pytest

ID = re.compile(r'<[^>]*\sid="([^"]+)"')
LINK = re.compile(r'<a\b[^>]*\shref="([^"]*)"')
GRADE = re.compile(r'<p class="grade">(.*?)</p>')
GRADES = ["By hand", "At the computer", "A small project"]
PRINTED = re.compile(r'<div class="cell_output.*?(?=<div class="cell docutils|</section>)', re.S)


@pytest.fixture(scope="module")
def pages(built_book):
    """Return the text of every page, by its path."""
    return {
        path.relative_to(built_book).as_posix(): path.read_text(encoding="utf8")
        for path in built_book.rglob("*.html")
        if path.relative_to(built_book).parts[0] != "_static"
    }


def test_every_link_arrives_at_a_page_and_at_an_anchor_that_it_has(pages, built_book):
    ids = {page: set(ID.findall(text)) for page, text in pages.items()}
    lost = set()
    for page, text in pages.items():
        for link in set(LINK.findall(text)):
            if re.match(r"\w+:", link):
                continue
            path, _, anchor = unquote(link).partition("#")
            target = normpath(str(PurePosixPath(page).parent / path)) if path else page
            if target not in pages:
                lost |= set() if (built_book / target).exists() else {(page, link)}
            elif anchor and not anchor.startswith(":~:") and anchor not in ids[target]:
                lost.add((page, link))
    assert lost == set()


def test_no_id_stands_twice_on_a_page(pages):
    twice = {
        page: [name for name, count in Counter(ID.findall(text)).items() if count > 1]
        for page, text in pages.items()
    }
    assert {page: names for page, names in twice.items() if names} == {}


def test_no_head_of_a_table_is_empty(pages):
    assert [page for page, text in pages.items() if re.search(r"<th[^>]*>\s*</th>", text)] == []


def test_every_formula_has_a_number_but_for_those_that_a_cell_prints(pages):
    without = {}
    for page, text in pages.items():
        formulas = re.findall(
            r'<div class="[^"]*\bmath\b[^>]*>(.{20})', PRINTED.sub("", text), re.S
        )
        missing = [start for start in formulas if "eqno" not in start]
        if missing and "/" not in page:
            without[page] = missing
    assert without == {}


def test_every_chapter_gives_its_notebook_and_every_page_a_description(pages, built_book):
    for page, text in pages.items():
        if "/" in page or page in {"genindex.html", "search.html"}:
            continue
        assert '<meta name="description" content="' in text, page
        if 'class="reading-time"' in text:
            (notebook,) = re.findall(r'href="([^"]*)" download', text)
            assert (built_book / notebook).stat().st_size > 1000


def test_exercises_go_from_paper_to_the_computer_to_a_project(pages):
    grades = {page: [GRADES.index(g) for g in GRADE.findall(text)] for page, text in pages.items()}
    assert {page: found for page, found in grades.items() if found != sorted(found)} == {}
    assert sum(2 in found for found in grades.values()) >= 12


def test_no_link_has_the_name_of_a_file_for_its_text(pages):
    """Of a page that has a longer title: "tour" leads to "A tour in ten minutes"."""
    names = {name.removesuffix(".html").replace("_", " ") for name in pages if "/" not in name}
    links = {
        (page, words)
        for page, text in pages.items()
        for words in re.findall(r'<a href="\w+\.html#cell-[^>]*>([^<]+)</a>', text)
    }
    assert {(page, words) for page, words in links if words in names} == set()


def test_only_the_search_loads_its_index_and_icons_are_those_that_pages_show(pages, built_book):
    loading = {page for page, text in pages.items() if "searchindex.js" in text}
    # A page of source stays from an earlier build while its module has not changed.
    assert {page for page in loading if not page.startswith("_modules/")} == {"search.html"}
    icons = built_book / "_static" / "scripts" / "fontawesome.js"
    assert icons.stat().st_size < 100_000
