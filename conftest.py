"""Tests run by hand as by `make`: on one thread, with nothing from a home, and without one."""

import os
from contextlib import ExitStack

from tools.isolation import ONE_THREAD, own_profile

# At once: other files of this kind import NumPy and Matplotlib.
PREPARED = ExitStack()
PREPARED.enter_context(own_profile())
os.environ.update(ONE_THREAD)


def pytest_unconfigure():
    """Take the folder of the profile away."""
    PREPARED.close()
