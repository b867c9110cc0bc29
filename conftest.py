"""Tests run by hand as by `make`: on one thread, with nothing from a home, and without one."""

import gc
import json
import os
import sys
from contextlib import ExitStack
from importlib.metadata import EntryPoint
from pathlib import Path

from ipykernel.kernelspec import get_kernel_dict
from jupyter_client.provisioning import KernelProvisionerFactory

from tools.isolation import ONE_THREAD, own_profile

gc.disable()  # until all is collected: a fifth of the time, for modules and tests that stay

# At once: other files of this kind import NumPy and Matplotlib.
PREPARED = ExitStack()
PREPARED.enter_context(own_profile())
# The figures of chapters are drawn once (a tight box is drawn twice) and, where kernels are copied,
# not painted: their pixels would be compared with nothing.
SETTINGS = Path(os.environ["IPYTHONDIR"]) / "profile_default" / "ipython_config.py"
SETTINGS.parent.mkdir()
figures = {"bbox_inches": None, "dpi": 80}
SETTINGS.write_text(f"c.InlineBackend.print_figure_kwargs = {figures}\n")
# Their kernels are copies of one process, where processes can be copied.
SPEC = Path(os.environ["JUPYTER_DATA_DIR"]) / "kernels" / "copied" / "kernel.json"
SPEC.parent.mkdir(parents=True)
copied = {"kernel_provisioner": {"provisioner_name": "copied"}} if sys.platform == "linux" else {}
spec = get_kernel_dict() | {"metadata": copied}
SPEC.write_text(json.dumps(spec))
KernelProvisionerFactory.instance().provisioners["copied"] = EntryPoint(
    "copied", "tools.copied_kernel:Provisioner", KernelProvisionerFactory.GROUP_NAME
)
os.environ.update(ONE_THREAD)


def pytest_collection_finish():
    """Look for garbage again, but not among what has been collected, and not that often."""
    gc.freeze()
    gc.set_threshold(10_000, 20, 100)
    gc.enable()


def pytest_unconfigure():
    """Take the folder of the profile away."""
    PREPARED.close()
