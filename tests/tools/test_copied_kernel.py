"""A copied kernel is one of its own, and what happens to it is noticed."""

import signal
import subprocess
import sys
from contextlib import contextmanager

import pytest
from jupyter_client.manager import KernelManager

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="kernels are not copied here")


@contextmanager
def started(folder):
    """Start a kernel as those of the chapters are; give its manager, and what runs a cell."""
    manager = KernelManager(kernel_name="copied")
    manager.start_kernel(cwd=str(folder))
    client = manager.client()
    client.start_channels()

    def run(code):
        """Return what a cell prints, or the name of its error."""
        printed = []
        reply = client.execute_interactive(
            code,
            timeout=60,
            output_hook=lambda message: printed.append(message["content"].get("text", "")),
        )
        return reply["content"].get("ename") or "".join(printed)

    try:
        client.wait_for_ready(timeout=60)
        yield manager, run
    finally:
        client.stop_channels()
        manager.shutdown_kernel(now=True)


def test_a_kernel_knows_nothing_of_another_one(tmp_path):
    with started(tmp_path) as (_, first), started(tmp_path) as (_, second):
        where = "import os; print(os.getcwd())"
        assert first(f"x = 1; {where}") == second(where) == f"{tmp_path}\n"
        assert second("x") == "NameError"
        assert first("import dopplerlib; print(x)") == "1\n"


def test_a_kernel_finds_the_modules_that_any_other_finds(tmp_path):
    code = "import sys; print(sorted(sys.path), 'tools' in sys.modules)"
    alone = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    with started(tmp_path) as (_, run):
        assert run(code) == alone.stdout


def test_a_kernel_draws_figures_without_paint_and_without_the_folder_of_the_tools(tmp_path):
    with started(tmp_path) as (_, run):
        draw = "from matplotlib.figure import Figure; f = Figure(); f.text(0, 0, 'text')"
        assert run(f"{draw}; f.savefig('x.png'); print(6 * 7)") == "42\n"
        assert (tmp_path / "x.png").read_bytes() == b""
        assert run("import tools") == "ModuleNotFoundError"


def test_a_kernel_is_interrupted_alone(tmp_path):
    with started(tmp_path) as (manager, run):
        beep = "import os, signal; os.killpg(0, signal.SIGINT); import time; time.sleep(60)"
        assert run(beep) == "KeyboardInterrupt"
        assert run("print(6 * 7)") == "42\n" and manager.is_alive()


def test_the_end_of_a_kernel_is_noticed_with_its_code(tmp_path):
    with started(tmp_path) as (manager, _):
        process = manager.provisioner.process
        assert process.poll() is None
        process.kill()
        assert process.wait() == -signal.SIGKILL
        assert not manager.is_alive()
