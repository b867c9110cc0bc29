"""Every figure of a test can be read on a page, and a module of tests draws all of its figures.

A module whose data are nobody's results names in `MADE_UP` the drawings whose curves run through
a legend.
"""

import matplotlib.pyplot as plt
import pytest

from tests.drawn import MODULES, check_figure, covered, drawings


@pytest.fixture(scope="module", autouse=True)
def drawn(request):
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
        check_figure(each)
    through = {each.get_label() for each in figures if covered(each)}
    made_up = getattr(request.module, "MADE_UP", set())
    assert through <= made_up
    tests = {name for name in vars(request.module) if name.startswith("test_")}
    items = (item for item in request.session.items if item.path == request.path)
    if tests <= {item.originalname for item in items}:  # nothing was left out
        assert through == made_up
        functions = drawings(name) if (name := request.path.stem[5:]) in MODULES else {}
        assert functions.keys() <= {each.get_label() for each in figures}
