"""Every page of the book in a browser without a network: whole, and fit for every reader.

A page is loaded once, and its formulas are set once. Whether it scrolls sideways is asked at each
width in both themes, pictures and formulas once; axe judges the whole page once, in the light
theme at the largest width, where nothing is folded away. Its two rules of colors are asked in both
themes, of one text or link for each look that no earlier page had (`mark` in page.js).
"""

import json
from importlib.metadata import files
from pathlib import Path

import pytest
import yaml

from tests.book.test_book import BOOK, listed
from tests.browser.test_explorables import awake

NARROW, MIDDLE, WIDE = 360, 768, 1440
# Each change makes the browser set the page anew: there are as few as can be, and all of a page is
# seen, at the largest width, when it is opened and at the end.
WIDTHS = {"dark": (WIDE, MIDDLE, NARROW), "light": (NARROW, MIDDLE, WIDE)}
TOC = yaml.safe_load((BOOK / "_toc.yml").read_text(encoding="utf8"))
# What Sphinx adds, and one page of the library's source.
ADDED = ("genindex", "search", "_modules/dopplerlib/model/doppler")
PAGES = [*listed(TOC), *ADDED]
EXPLORABLES = """
    [...document.querySelectorAll("[data-explorable]")].map((element) => element.dataset.explorable)
"""
QUESTIONS = Path(__file__).with_name("page.js").read_text(encoding="utf8")


@pytest.fixture(scope="module")
def axe():
    """Return the program of axe-core."""
    (program,) = (f for f in files("axe-playwright-python") if f.name == "axe.min.js")
    return program.read_text(encoding="utf8")


@pytest.fixture(scope="module")
def looked_at():
    """Return for each theme the looks of text whose contrast axe has found to be enough."""
    return {theme: [] for theme in WIDTHS}


def wear(tab, theme):
    """Give the page its theme, which it takes from the system."""
    tab.wear(theme)
    tab.wait(f"document.documentElement.dataset.theme === '{theme}'")


@pytest.mark.parametrize("page", PAGES)
def test_a_page_is_whole_and_accessible_at_every_width_and_in_both_themes(
    tab, page, axe, looked_at
):
    tab.open(f"{page}.html", WIDE, "dark")
    for name in tab.run(EXPLORABLES):
        awake(tab, name)
    tab.run(QUESTIONS)
    found = [f"{page}: {text}" for text in [*tab.run("book.broken()"), *tab.complaints]]
    tab.complaints.clear()
    tab.run("book.thin()")
    tab.run(axe)
    for theme, widths in WIDTHS.items():
        wear(tab, theme)
        for width in widths:
            tab.resize(width)
            told = tab.run("book.tooWide()")
            if (width, theme) == (NARROW, "dark"):
                told += tab.run("book.squeezed()")
            if width == WIDE:
                new = tab.run(f"book.mark({json.dumps(looked_at[theme])})")
                whole = theme == "light"  # what is no question of colors is the same in both
                if new or whole:
                    finds = tab.run(f"book.axeFinds({json.dumps(not whole)})")
                    looked_at[theme] += [] if finds else new
                    told += finds
            found += [f"{page} at {width} px, {theme}: {text}" for text in told]
    found += [f"{page}: {text}" for text in tab.complaints]
    assert found == []


def test_a_dark_page_is_printed_as_a_light_one(tab):
    tab.open("search.html", theme="dark")
    events = "beforeprint", "afterprint"
    ask = "dispatchEvent(new Event('{}')), document.documentElement.dataset.theme"
    assert [tab.run(ask.format(event)) for event in events] == ["light", "dark"]


@pytest.mark.parametrize(
    "words, page", [("observability", "observability"), ("number of runs", "consistency")]
)
def test_the_search_finds_a_page_without_a_network(tab, words, page):
    tab.open("index.html")
    tab.run("document.querySelector('.search-button-field, .search-button__button').click()")
    tab.type(words)
    tab.press("Enter")
    tab.arrive()
    tab.wait("document.querySelector('.search-summary')?.innerText.includes('finished')")
    hits = tab.run("[...document.querySelectorAll('ul.search a')].map((a) => a.pathname)")
    assert f"/{page}.html" in "".join(hits[:5]), hits[:5]
    assert tab.complaints == []
