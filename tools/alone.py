"""Let one process at a time do a piece of work in this checkout.

Without packages: the environment itself is made under this lock.
"""

import fcntl
import os
import sys
from contextlib import contextmanager, suppress


@contextmanager
def alone(path, work):
    """Hold a lock while something is done that two must not do at once; wait for whoever has it.

    Parameters
    ----------
    path : pathlib.Path
        File that stands for the work; it is made if need be. Whoever has the lock may remove it.
    work : str
        What is waited for, as a noun.

    Yields
    ------
    int
        The open file. The system takes the lock away when the last process that has it open ends,
        however it ends: nobody has to tidy up after a kill. A child that must not go on after the
        lock has gone inherits it (`pass_fds`).
    """
    file = None
    while file is None:
        path.parent.mkdir(parents=True, exist_ok=True)  # the other one may remove it, too
        with suppress(FileNotFoundError):
            file = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
        if file is None:
            continue
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            print(f"waiting for another process that is busy with {work} ...", file=sys.stderr)
            fcntl.flock(file, fcntl.LOCK_EX)
        if not _is(file, path):  # removed by the other one: whoever comes next would not meet us
            os.close(file)
            file = None
    try:
        yield file
    finally:
        os.close(file)


def _is(file, path):
    try:
        return os.path.samestat(os.fstat(file), os.stat(path))
    except FileNotFoundError:
        return False
