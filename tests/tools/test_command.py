"""Commands say what they are for, and end in one line whatever ends them."""

import signal
import subprocess
import sys
import time
from importlib import import_module
from pathlib import Path

import pytest

TOOLS = Path(__file__).resolve().parents[2] / "tools"
COMMANDS = sorted(
    path.stem for path in TOOLS.glob("*.py") if "__main__" in path.read_text(encoding="utf-8")
)


@pytest.mark.parametrize("name", COMMANDS)
def test_the_help_begins_with_the_first_line_of_the_module(name, monkeypatch, capsys):
    monkeypatch.setenv("COLUMNS", "200")
    tool = import_module(f"tools.{name}")
    with pytest.raises(SystemExit) as end:
        tool.main(["--help"])
    assert end.value.code == 0
    assert tool.__doc__.partition("\n")[0] in capsys.readouterr().out


@pytest.mark.parametrize("name", COMMANDS)
def test_a_command_whose_docstrings_were_stripped_has_help_all_the_same(name, monkeypatch, capsys):
    """As by `python -OO`."""
    tool = import_module(f"tools.{name}")
    monkeypatch.setattr(tool, "__doc__", None)
    with pytest.raises(SystemExit) as end:
        tool.main(["--help"])
    assert end.value.code == 0
    assert capsys.readouterr().out.startswith("usage:")


BUSY = """
import sys, time
from concurrent.futures import ThreadPoolExecutor
from tools.command import child, start

def main():
    with child([sys.executable, "-c", "import time; print(1, flush=True); time.sleep(60)"]):
        with ThreadPoolExecutor() as pool:  # whose end is waited for
            list(pool.map(time.sleep, [60]))

start(main)
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_command_ends_soon_with_one_line_and_takes_its_child_along(number):
    with subprocess.Popen(
        [sys.executable, "-c", BUSY], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        process.stdout.readline()
        start = time.monotonic()
        process.send_signal(number)
        _, err = process.communicate()  # ends when the child has closed its output, too
        assert time.monotonic() - start < 15
    assert process.returncode == 130
    assert err.split("\n") == ["", "interrupted; what was written is whole", ""]


def test_a_disk_that_cannot_be_written_is_named_in_one_line(tmp_path):
    code = (
        "import sys, pathlib; from tools.command import start\n"
        "start(lambda: pathlib.Path(sys.argv[1], 'no', 'a').write_text(''))"
    )
    ended = subprocess.run([sys.executable, "-c", code, tmp_path], capture_output=True, text=True)
    assert ended.returncode == 1
    assert ended.stderr == f"\nerror: No such file or directory: {tmp_path}/no/a\n"


POOL = """
import os, time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from tools.command import quiet_worker

with ProcessPoolExecutor(1, get_context("spawn"), quiet_worker) as pool:
    print(pool.submit(os.getpid).result(), flush=True)
    time.sleep(60)
"""


def test_a_worker_ends_with_its_parent_even_if_that_is_killed():
    command = [sys.executable, "-c", POOL]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        worker = int(process.stdout.readline())
        process.kill()
    for _ in range(100):
        if not Path(f"/proc/{worker}").exists():
            break
        time.sleep(0.1)
    assert not Path(f"/proc/{worker}").exists()
