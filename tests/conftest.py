"""What holds for every test: no window opens, and a property is tried on the same examples."""

import matplotlib
from hypothesis import settings

matplotlib.use("agg")

# No deadline: the first call of a kernel compiles it.
settings.register_profile("repeatable", derandomize=True, deadline=None, database=None)
settings.load_profile("repeatable")
