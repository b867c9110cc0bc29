"""A compiled loop never outlives the kernels that it was compiled from."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import dopplerlib

PACKAGE = Path(dopplerlib.__file__).parent
TRACK = """
import json
import numpy as np
from dopplerlib import RadarArray, ekf
z = np.full((2, 3), 100.0)
x = ekf(z, RadarArray.ring(3, 0.2), [1, 0, 0, -1, 0, 0], 0.1 * np.eye(6), 0.001, 0.4, 0.4).x
print(json.dumps(x.tolist()))
"""


def track(root):
    """Filter two samples in a new process, with the copy of the library at `root`."""
    environment = {**os.environ, "PYTHONPATH": str(root), "NUMBA_OPT": "1"}  # compiles sooner
    environment.pop("NUMBA_CACHE_DIR", None)  # the copy keeps its cache in its own folder
    done = subprocess.run(
        [sys.executable, "-c", TRACK], cwd=root, env=environment, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_a_changed_kernel_is_compiled_again(tmp_path):
    # numba looks at the file of the compiled loop only, which does not change here. What this
    # checkout has compiled is copied, too, with the times of its files: that saves a compilation.
    copy = tmp_path / "dopplerlib"
    shutil.copytree(PACKAGE, copy, ignore=shutil.ignore_patterns("*.pyc"))
    cache = copy / "estimation" / "__pycache__"
    before = track(tmp_path)
    compiled = sorted(cache.glob("*.nbc"))
    assert compiled  # else there is no cache that could be stale
    assert track(tmp_path) == before
    assert sorted(cache.glob("*.nbc")) == compiled  # and it is used as long as nothing changes

    kernel = copy / "kernels" / "ekf.py"
    text = kernel.read_text(encoding="utf-8")
    right = "h_vx = d_x*t1\n"
    assert text.count(right) == 1
    kernel.write_text(text.replace(right, "h_vx = -d_x*t1\n"), encoding="utf-8")
    assert track(tmp_path) != before
