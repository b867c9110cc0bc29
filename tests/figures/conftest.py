"""Every figure of a test has units, letters to be read, colors with one meaning, and is closed."""

import matplotlib.pyplot as plt
import pytest

from tests.drawn import check_colors, check_labels, pale, small


@pytest.fixture(scope="module", autouse=True)
def drawn():
    """Check what a module of tests has drawn."""
    figures, make = [], plt.figure

    def figure(*args, **kwargs):
        figures.append(make(*args, **kwargs))
        return figures[-1]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(plt, "figure", figure)
        yield
    assert plt.get_fignums() == []
    for each in figures:
        check_labels(each)
        check_colors(each)
        assert small(each) == pale(each) == []
