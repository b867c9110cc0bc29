"""Tests run by hand as by `make`: on one thread, with nothing from a home, and without one."""

import os
from contextlib import ExitStack
from pathlib import Path

from tools.isolation import ONE_THREAD, own_profile

# At once: other files of this kind import NumPy and Matplotlib.
PREPARED = ExitStack()
PREPARED.enter_context(own_profile())
# A chapter's figures are drawn, and their pixels compared with nothing: a coarse raster, drawn once
# (a tight box is drawn twice), shows every error and warning that a fine one would.
SETTINGS = Path(os.environ["IPYTHONDIR"]) / "profile_default" / "ipython_config.py"
SETTINGS.parent.mkdir()
SETTINGS.write_text("c.InlineBackend.print_figure_kwargs = {'bbox_inches': None, 'dpi': 80}\n")
os.environ.update(ONE_THREAD)


def pytest_unconfigure():
    """Take the folder of the profile away."""
    PREPARED.close()
