"""The frame of every command: what it is for, and how it ends."""

import argparse
import os
import signal
import subprocess
import sys
from contextlib import contextmanager, suppress

GRACE = 2  # seconds for tidying up after an interruption
_children = []


def parser(doc):
    """Return a parser of the command line; `doc` is None where Python strips docstrings."""
    return argparse.ArgumentParser(description=(doc or "").partition("\n")[0])


def start(main, *arguments):
    """End the process with what `main` returns; what stops it from outside takes one line.

    A polite kill is an interruption like Ctrl-C, so that temporary files go. A disk that is full or
    must not be written is named, without the way to the line that met it.
    """
    signal.signal(signal.SIGINT, _interrupt)
    signal.signal(signal.SIGTERM, _interrupt)
    try:
        code = main(*arguments)
    except KeyboardInterrupt:
        _end()
    except OSError as error:
        where = f": {error.filename}" if error.filename else ""
        print(f"\nerror: {error.strerror or error}{where}", file=sys.stderr)
        code = 1
    sys.exit(code)


@contextmanager
def child(command, **options):
    """Run a program that hears of an interruption from us only, since it would answer at length.

    `command` and `options` are those of `subprocess.Popen`; the program ends with the block.
    """
    process = subprocess.Popen(command, start_new_session=True, **options)
    _children.append(process)
    try:
        yield process
    finally:
        _kill(process, signal.SIGTERM)
        with suppress(subprocess.TimeoutExpired):
            process.wait(GRACE / 4)
        _kill(process, signal.SIGKILL)
        process.wait()
        _children.remove(process)


def quiet_worker():
    """Prepare a process of a pool: only the parent takes notice of an interruption."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)


def _kill(process, number):
    """Send a signal to a child and to its children, if the child has not been waited for."""
    if process.returncode is None:
        os.killpg(process.pid, number)


def _interrupt(*_):
    # Threads that compute would be waited for: not for long.
    signal.signal(signal.SIGALRM, _end)
    signal.alarm(GRACE)
    raise KeyboardInterrupt


def _end(*_):
    for process in _children:
        _kill(process, signal.SIGKILL)
    print("\ninterrupted; what was written is whole", file=sys.stderr, flush=True)
    os._exit(130)
