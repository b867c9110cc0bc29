"""Write files whole or not at all, and touch no file but those that are named."""

import errno
import os
import secrets
import stat
from contextlib import contextmanager, suppress
from pathlib import Path

# How the name of an unfinished file begins. It is left behind only by a process that was killed.
PARTIAL = ".partial-"


@contextmanager
def replacing(*paths):
    """Give temporary files beside `paths`, which replace them if all goes well.

    Whatever happens, no temporary file is left behind. Links are followed, and a file that is
    replaced keeps its mode and, where the process may give it away, its owner. The ends of the
    names stay, since SigMF tells by them what a file is.

    *paths: Files to write, each an ordinary file or none yet.
    Yields: Empty files with names of their own, to be written to.
    Raises ValueError if a path leads to something that is no ordinary file, or to one that is
        read-only; or if its folder does not exist or may not be written to.
    Raises OSError with the path, if writing fails, for instance on a full disk.
    """
    paths = [file_to_write(path) for path in paths]
    targets = [_target(path) for path in paths]
    made = []
    try:
        for path, (target, status) in zip(paths, targets, strict=True):
            # Noted before it is made, so that an interrupt in between leaves nothing. A name of
            # 64 random bits is that of no other file.
            made.append(target.with_name(f"{PARTIAL}{secrets.token_hex(8)}{path.suffix}"))
            _make(made[-1], status, path)
        yield list(made)
        for new, (target, _) in zip(made, targets, strict=True):
            new.replace(target)
    except OSError as error:
        if error.errno is None or (error.filename and Path(error.filename) not in made):
            raise
        where = ", ".join(map(str, paths))  # the system names no file, or the temporary one
        raise OSError(error.errno, os.strerror(error.errno), where) from None
    finally:
        for new in made:
            new.unlink(missing_ok=True)


def write_text(path, text):
    """Write a file of text in UTF-8, whole or not at all."""
    with replacing(path) as (new,):
        new.write_text(text, encoding="utf-8", newline="\n")


def file_to_write(path):
    """Return a path, or raise unless it leads to a file that may be written or made."""
    if not isinstance(path, (str, os.PathLike)) or not isinstance(os.fspath(path), str):
        raise ValueError(f"path must be the path of a file, got {path!r}")
    path = Path(path)
    target, status = _target(path)
    if not target.parent.is_dir() or (status is not None and stat.S_ISDIR(status.st_mode)):
        raise ValueError(f"path must be that of a file in a folder that exists, got {str(path)!r}")
    if status is not None and not stat.S_ISREG(status.st_mode):
        raise ValueError(
            f"path must be an ordinary file, got {str(path)!r}, which is a device, a pipe or a "
            "socket"
        )
    # To root every file is writable: what has no mode of writing at all was protected on purpose.
    if status is not None and not (status.st_mode & 0o222 and os.access(target, os.W_OK)):
        raise ValueError(f"path must be a file that may be written to, got {str(path)!r}")
    return path


def _target(path):
    """Return where a path leads, links followed, and the status of the file there, or None."""
    try:
        target = Path(os.path.realpath(path))
        return target, target.stat()
    except (FileNotFoundError, NotADirectoryError):
        return target, None
    except (OSError, ValueError) as error:  # a loop of links, a name too long, a null character
        reason = os.strerror(error.errno) if isinstance(error, OSError) else str(error)
        raise ValueError(f"path must lead to a file, got {str(path)!r}: {reason}") from None


def _make(new, status, path):
    """Make an empty file of the mode and owner that `status` tells, or of a new file's."""
    # Until it is the owner's, nobody else may open what replaces a private file.
    mode = 0o666 if status is None else 0o600
    try:
        os.close(os.open(new, os.O_WRONLY | os.O_CREAT | os.O_EXCL, mode))
    except OSError as error:
        if error.errno not in (errno.EACCES, errno.EPERM, errno.EROFS):
            raise
        raise ValueError(
            f"path must be in a folder that may be written to, got {str(path)!r}"
        ) from None
    if status is not None:
        with suppress(PermissionError, AttributeError):  # AttributeError: Windows has no owners
            os.chown(new, status.st_uid, status.st_gid)
        new.chmod(stat.S_IMODE(status.st_mode))
