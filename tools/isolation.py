"""What a chapter must not depend on: the user's profile, home, and number of threads."""

import os
import tempfile
from contextlib import contextmanager

# The order of a floating-point sum depends on the number of threads.
ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
PROFILE = ("IPYTHONDIR", "JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "JUPYTER_RUNTIME_DIR")


@contextmanager
def own_profile():
    """Keep away from this process and its kernels what a user has set up, and a missing home."""
    before = dict(os.environ)
    with tempfile.TemporaryDirectory() as folder:
        os.environ.update(dict.fromkeys(PROFILE, folder))
        os.environ.setdefault("MPLCONFIGDIR", folder)  # that of `make` has a list of fonts
        try:
            yield
        finally:
            os.environ.clear()
            os.environ.update(before)
