"""The frame of every command: what it is for, and how it ends."""

import argparse
import multiprocessing
import os
import signal
import subprocess
import sys
import threading
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
    ignore = signal.signal(signal.SIGINT, signal.SIG_IGN)  # inherited
    try:
        process = subprocess.Popen(command, **options)
    finally:
        signal.signal(signal.SIGINT, ignore)
    _children.append(process)
    try:
        yield process
    finally:
        process.terminate()
        with suppress(subprocess.TimeoutExpired):
            process.wait(GRACE / 4)
        process.kill()
        process.wait()
        _children.remove(process)


def end_at_once():
    """Let an interruption end the process where it is: for work that would not let it pass."""
    signal.signal(signal.SIGINT, _end)
    signal.signal(signal.SIGTERM, _end)


def quiet_worker():
    """Prepare a process of a pool: it ends with its parent, which alone is interrupted."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent():
    multiprocessing.parent_process().join()
    os._exit(1)


def _interrupt(*_):
    # Threads that compute would be waited for: not for long.
    signal.signal(signal.SIGALRM, _end)
    signal.alarm(GRACE)
    raise KeyboardInterrupt


def _end(*_):
    for process in _children:
        process.kill()
    print("\ninterrupted; what was written is whole", file=sys.stderr, flush=True)
    os._exit(130)
