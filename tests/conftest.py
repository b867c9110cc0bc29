"""What holds for every test: no window opens, and a property is tried on the same examples.

And in which order they run: a long file that comes last would be waited for.
"""

from pathlib import Path

import matplotlib
import pytest
from _pytest.doctest import DoctestModule
from hypothesis import settings

from tools.alone import alone

BUILT = Path(__file__).resolve().parents[1] / "book" / "_build"

collect_ignore = ["typed.py"]  # for the type checker alone: it names files that are not there

matplotlib.use("agg")

# No deadline: the first call of a kernel compiles it.
settings.register_profile("repeatable", derandomize=True, deadline=None, database=None)
settings.load_profile("repeatable")


@pytest.fixture(scope="session")
def built_book():
    """Return the folder of the book's pages, once nobody is building them."""
    if not (BUILT / ".lock").exists():
        pytest.skip("the book has not been built: make book")
    with alone(BUILT / ".lock", "the book"):
        return BUILT / "html"


def pytest_collection_modifyitems(items):
    """Begin with the long files, and end with those that look at the built book.

    The browser takes longest of these, and does not come last.
    """
    last = {item.path for item in items if "built_book" in getattr(item, "fixturenames", ())}

    def rank(item):
        if "wheel" in item.path.parts:
            return 0
        if item.path.suffix == ".ipynb":
            return 1
        if item.path in last:
            return 2 if "browser" in item.path.parts else 4
        return 3

    items.sort(key=rank)


@pytest.hookimpl(wrapper=True)
def pytest_collect_file():
    """Look for examples in the library alone: in tests there are none, but looking takes long."""
    return [one for one in (yield) if not isinstance(one, DoctestModule)]
