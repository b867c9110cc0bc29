"""Every page of the book in a browser without a network: whole, and fit for every reader.

A page is loaded once and then resized, since loading and setting its formulas is what costs.
"""

import json
from importlib.metadata import files
from pathlib import Path

import pytest
import yaml

from tests.book.test_book import BOOK, listed
from tests.browser.test_explorables import awake

THEMES = ("light", "dark")
NARROW, MIDDLE, WIDE = 360, 768, 1440
# In an order that changes one thing at a time.
STATES = (
    *((NARROW, theme) for theme in THEMES),
    *((MIDDLE, theme) for theme in reversed(THEMES)),
    *((WIDE, theme) for theme in THEMES),
)
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
    return {theme: [] for theme in THEMES}


def wear(tab, theme):
    """Give the page its theme, which it takes from the system."""
    tab.wear(theme)
    tab.wait(f"document.documentElement.dataset.theme === '{theme}'")


@pytest.mark.parametrize("page", PAGES)
def test_a_page_is_whole_and_accessible_at_every_width_and_in_both_themes(
    tab, page, axe, looked_at
):
    tab.open(f"{page}.html", NARROW)
    for name in tab.run(EXPLORABLES):
        awake(tab, name)
    tab.run(QUESTIONS)
    found = [f"{page}: {text}" for text in [*tab.run("book.broken()"), *tab.complaints]]
    tab.complaints.clear()
    tab.run("book.thin()")
    for width, theme in STATES:
        tab.resize(width)
        wear(tab, theme)
        found += [f"{page} at {width} px, {theme}: {text}" for text in tab.run("book.tooWide()")]
    tab.run(axe)
    for theme in reversed(THEMES):  # the tab still wears the last one
        wear(tab, theme)
        new = tab.run(f"book.mark({json.dumps(looked_at[theme])})")
        whole = theme == THEMES[0]  # what is no question of colors is the same in the other one
        if new or whole:
            told = tab.run(f"book.axeFinds({json.dumps(not whole)})")
            found += [f"{page}, {theme}: {text}" for text in told]
            looked_at[theme] += [] if told else new
    found += [f"{page}: {text}" for text in tab.complaints]
    assert found == []


@pytest.mark.parametrize("words, page", [("observability", "observability"), ("NEES", "glossary")])
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
