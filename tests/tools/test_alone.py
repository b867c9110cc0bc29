"""A lock is held by one process at a time, and by none that is dead."""

import os
import signal
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import pytest

from tools.alone import alone

HOLD = (
    "import sys, pathlib, subprocess, tools.alone as tool\n"
    "with tool.alone(pathlib.Path(sys.argv[1]), 'this') as lock:\n"
    "    child = subprocess.Popen(['sleep', sys.argv[2]], pass_fds=[lock], stdout=2)\n"
    "    print(child.pid, flush=True)\n"
    "    sys.stdin.read()\n"
)


@pytest.fixture
def holder(tmp_path):
    """Return a function that lets another process, and a child of it, hold a lock."""
    processes = []

    def hold(seconds):
        process = subprocess.Popen(
            [sys.executable, "-c", HOLD, tmp_path / "lock", seconds],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        processes.append(process)
        process.child = int(process.stdout.readline())
        return process

    yield hold
    for process in processes:
        process.kill()
        process.communicate()


def test_a_lock_whose_holder_was_killed_is_free_once_its_child_has_ended(holder, tmp_path, capsys):
    process = holder("60")
    process.kill()
    process.wait()
    with ThreadPoolExecutor() as pool:

        def wait():
            with alone(tmp_path / "lock", "this"):
                return True

        waiting = pool.submit(wait)
        with pytest.raises(TimeoutError):
            waiting.result(timeout=0.3)
        os.kill(process.child, signal.SIGKILL)
        assert waiting.result(timeout=10)
    assert "waiting for another process that is busy with this" in capsys.readouterr().err


def test_a_lock_that_was_removed_while_it_was_waited_for_is_made_again(tmp_path):
    path = tmp_path / "lock"
    inside = []

    def work():
        with alone(path, "this"):
            inside.append(1)
            assert len(inside) == 1
            inside.pop()
            path.unlink()

    with ThreadPoolExecutor(8) as pool:
        for done in [pool.submit(work) for _ in range(200)]:
            done.result()
