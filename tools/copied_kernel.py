"""Kernels for the tests of the chapters: copies of one process that has imported what all import.

Most of what a short chapter costs is that its kernel starts and imports NumPy, Matplotlib and the
library. Here one process does so, and calls what is compiled; each kernel is a fork of it, in which
no cell has run. `make chapter` and `make record` start every kernel on its own.
"""

import atexit
import gc
import io
import json
import os
import pkgutil
import signal
import subprocess
import sys
import time
from contextlib import suppress
from importlib import import_module
from importlib.resources import as_file
from pathlib import Path

from jupyter_client.provisioning import LocalProvisioner

from tools.command import parser

ROOT = Path(__file__).resolve().parent.parent
POLL, PATIENCE = 0.01, 30.0  # seconds
# Not the inline backend: it looks for its kernel when it is imported.
IMPORTED = (
    *("ipykernel.kernelapp", "ipykernel.debugger", "IPython.core.completerlib"),
    *("IPython.core.pylabtools", "tornado.platform.asyncio", "matplotlib.pyplot", "sympy"),
)
KEPT = "tools.unpainted"  # of the tools, what Matplotlib looks up in a kernel by its name


class Process:
    """A kernel, with the interface of `subprocess.Popen` as far as it is asked for."""

    stdin = stdout = stderr = None

    def __init__(self, source, **wanted):
        self._source, self.returncode = source, None
        self.pid = source.ask(wanted)

    def poll(self):
        """Return the exit code, or None as long as the kernel runs."""
        if self.returncode is None:
            self.returncode = self._source.ask({"pid": self.pid})
        return self.returncode

    def wait(self):
        """Wait for the end; return the exit code."""
        while self.poll() is None:
            time.sleep(POLL)
        return self.returncode

    def send_signal(self, number):
        """Send a signal, if there is somebody to hear of it."""
        with suppress(ProcessLookupError):
            os.kill(self.pid, number)

    def kill(self):
        """End it."""
        self.send_signal(signal.SIGKILL)

    terminate = kill


class Source:
    """The process of which kernels are copies; it ends with the one that started it."""

    def __init__(self):
        self._process = subprocess.Popen(
            [sys.executable, "-m", "tools.copied_kernel"],
            cwd=ROOT,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        atexit.register(self.close)

    def close(self):
        """End it: nobody asks any more."""
        self._process.stdin.close()
        self._process.stdout.close()
        self._process.wait()

    def ask(self, question):
        """Return the answer to a question, which is of what JSON knows."""
        print(json.dumps(question), file=self._process.stdin, flush=True)
        return json.loads(self._process.stdout.readline())


class Provisioner(LocalProvisioner):
    """Starts kernels for Jupyter's manager of kernels."""

    _source = None

    async def launch_kernel(self, cmd, **wanted):
        """Start one; all of a process are copies of the same."""
        if self._source is None:
            Provisioner._source = Source()
        argv = cmd[cmd.index("-f") :]
        self.process = Process(self._source, argv=argv, cwd=wanted["cwd"], env=wanted["env"])
        self.pid = self.pgid = self.process.pid
        return self.connection_info


def draw():
    """Let no image be painted, find the fonts of the book, and build the parser of formulas."""
    from matplotlib import pyplot
    from matplotlib.backend_bases import register_backend
    from matplotlib.figure import Figure

    from dopplerlib.figures.style import STYLE

    register_backend("png", KEPT)
    with as_file(STYLE) as path, pyplot.style.context(path):
        axes = Figure().subplots()
        for size in (8, 8.5, 9, 9.5, 10.5, 11):  # in points, as figures and their style have them
            axes.annotate(
                "text and $x_1$", (0, 1), (0, 2), arrowprops={"arrowstyle": "->"}, fontsize=size
            )
        axes.figure.savefig(io.BytesIO(), format="png")


def prepare():
    """Import what chapters import, call what is compiled, read the documents, and draw."""
    gc.disable()  # here and in all copies: they live for seconds, and leave little garbage
    # As a kernel does before its first cell; Matplotlib reads it when it is imported.
    os.environ.setdefault("MPLBACKEND", "module://matplotlib_inline.backend_inline")
    os.environ["PYDEVD_DISABLE_FILE_VALIDATION"] = "1"  # else a warning on stderr
    for name in IMPORTED:
        import_module(name)
    import dopplerlib
    from tools.compile import main as compile_all

    for module in pkgutil.walk_packages(dopplerlib.__path__, "dopplerlib."):
        if not module.name.endswith("__main__"):
            import_module(module.name)
    compile_all([])
    for name in dopplerlib.replication.documents.documents():
        dopplerlib.replication.documents.read_document(name)
    draw()
    # A copy would lack other threads, and wait for their locks. One that has ended is there yet.
    deadline = time.monotonic() + PATIENCE
    while len(os.listdir("/proc/self/task")) > 1:
        assert time.monotonic() < deadline, "importing the library leaves threads behind"
        time.sleep(POLL)


def kernel(argv, cwd, env):
    """Become a kernel, as `python -m ipykernel_launcher` is one."""
    from ipykernel.kernelapp import IPKernelApp

    nowhere = os.open(os.devnull, os.O_RDWR)
    for stream in range(3):
        os.dup2(nowhere, stream)
    os.environ.clear()
    os.environ.update(env, JPY_PARENT_PID=str(os.getppid()))  # it does not outlive this process
    os.chdir(cwd)
    sys.argv[1:] = argv
    IPKernelApp.launch_instance()


def answer(question):
    """Start a kernel and return its number, or return the exit code of one that has ended."""
    if "pid" in question:
        pid, status = os.waitpid(question["pid"], os.WNOHANG)
        return os.waitstatus_to_exitcode(status) if pid else None
    ready, tell = os.pipe()
    pid = os.fork()
    if pid == 0:
        try:
            os.setsid()  # a signal to all processes of the kernel is none to those of the tests
            os.close(ready)
            os.close(tell)
            kernel(**question)
        finally:
            os._exit(1)
    os.close(tell)
    os.read(ready, 1)  # until it has a group of its own
    os.close(ready)
    return pid


def main(argv=None):
    """Answer questions, one in a line, until nobody is left who asks."""
    parser(__doc__).parse_args(argv)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    prepare()
    sys.path.remove(str(ROOT))  # a chapter has the library, not what tests it
    for name in [name for name in sys.modules if name.partition(".")[0] == "tools"]:
        if name != KEPT:
            del sys.modules[name]
    for line in sys.stdin:
        print(json.dumps(answer(json.loads(line))), flush=True)


if __name__ == "__main__":
    main()
