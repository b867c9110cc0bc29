"""The browser that the tests of this folder share, and the folder of pages that it looks at."""

import pytest

from tests.browser.chromium import open_browser, program


@pytest.fixture(scope="package")
def tab(built_book):
    """Return the tab of a browser whose pages are those of the built book."""
    path = program()
    if path is None:
        pytest.skip("no Chromium is found: install one, or name it by CHROMIUM")
    with open_browser(path, built_book) as tab:
        yield tab
