"""Every figure that a test draws has units and letters of a size, and none stays with pyplot."""

import matplotlib.pyplot as plt
import pytest

from tests.drawn import check_labels, small


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
        assert small(each) == []
