"""TOML files of settings, claims and deviations: read, or refused with the file's name."""

import os
import tomllib
from contextlib import contextmanager
from dataclasses import MISSING, fields
from pathlib import Path
from reprlib import repr as short  # of what may be long or deep


@contextmanager
def tables(path, name="path"):
    """Give the tables of a TOML file; in every ValueError inside, the file's name comes first.

    path: A file on disk, or something with `is_file` and `read_bytes`, such as a file of a package.
        In UTF-8, with or without a byte order mark.
    name: Of the argument.
    Raises ValueError if `path` is no path, is not an ordinary file that can be read, or does not
        hold TOML.
    """
    content = _content(path, name)
    try:
        try:
            yield tomllib.loads(content.decode("utf-8-sig"))
        except UnicodeDecodeError as error:
            raise ValueError(f"the file must be TOML in UTF-8, got {error}") from None
        except RecursionError:
            raise ValueError("the file must be TOML, got too many brackets in each other") from None
    except ValueError as error:  # those of TOML are ValueErrors as well
        raise ValueError(f"{path}: {error}") from error


def check_names(where, table, needed, others=()):
    """Raise unless `table` has all `needed` names, and beside them only `others` (None: any)."""
    if not isinstance(table, dict):
        raise ValueError(f"{where} must be a table, got {short(table)}")
    if missing := [name for name in needed if name not in table]:
        got = ", ".join(table) or "nothing"
        raise ValueError(f"{where} must have {', '.join(missing)}, got only {got}")
    if others is None:
        return
    known = dict.fromkeys([*needed, *others])
    if unknown := [name for name in table if name not in known]:
        raise ValueError(
            f"{where} must have nothing but {', '.join(known)}, got {', '.join(unknown)}"
        )


def entries(file, name, cls, check):
    """Return one record for each ``[[name]]`` of a file, whose ids differ.

    file: The tables, nothing but a list under `name`.
    name: What an entry is called.
    cls: Record whose fields the entries of a table are; one of them is `id`.
    check: ``check(where, made)`` raises unless the fields of a record are right.
    """
    check_names("the file", file, (), (name,))
    found = file.get(name, [])
    if not isinstance(found, list) or not found:
        got = short(found) if found else "none"
        raise ValueError(f"the file must hold a list of [[{name}]], got {got}")
    needed = [field.name for field in fields(cls) if field.default is MISSING]
    made = {}
    for place, table in enumerate(found, 1):
        known = isinstance(table, dict) and "id" in table
        where = f"{name} {short(table['id']) if known else place}"
        check_names(where, table, needed, [field.name for field in fields(cls)])
        one = cls(**table)
        check(where, one)
        if one.id in made:
            raise ValueError(f"the id of a {name} must be unique, got {one.id!r} twice")
        made[one.id] = one
    return tuple(made.values())


def _content(path, name):
    """Return the bytes of an ordinary file; a device or a pipe could be read without an end."""
    try:
        # A number would be taken for an open file by `open`, and closed.
        source = Path(os.fspath(path)) if isinstance(path, (str, os.PathLike)) else path
        if source.is_file():
            return source.read_bytes()
    except (AttributeError, TypeError):
        raise ValueError(
            f"{name} must be a path, or a file of a package, got {short(path)}"
        ) from None
    except (OSError, ValueError) as error:
        raise ValueError(f"{name} must be a file that can be read, got {path!r}: {error}") from None
    raise ValueError(f"{name} must be a file that exists, got {str(path)!r}")
