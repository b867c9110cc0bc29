"""Metadata of SigMF: checks, and the times and the validity of samples."""

import json
import re
from datetime import UTC, datetime
from typing import NamedTuple

import numpy as np

from ._recording import first_line, later, utc

INVALID = "dopplerlib:invalid"  # [sensor, first sample, count] each
# What says that the samples are elsewhere, or something else among them.
_ELSEWHERE = ("core:dataset", "core:metadata_only", "core:trailing_bytes", "core:header_bytes")


class Piece(NamedTuple):
    """A stretch of a recording: samples of the file, or a gap."""

    at: int  # in the recording
    row: int | None  # in the file; None: a gap
    count: int  # type: ignore[assignment]  # hides tuple.count


def parsed(text):
    """Return the content of metadata, or raise unless all of it can be obeyed."""
    from jsonschema import Draft202012Validator
    from jsonschema.exceptions import best_match
    from sigmf.schema import get_schema

    def refuse(word):
        raise ValueError(f"its numbers must be finite, got {word}")

    content = json.loads(text, parse_constant=refuse)
    error = best_match(Draft202012Validator(get_schema()).iter_errors(content))
    if error is not None:
        where = ".".join(map(str, error.absolute_path)) or "its content"
        raise ValueError(f"{where}: {first_line(error.message)}")
    info, captures = content["global"], content["captures"]
    if not info["core:version"].startswith(("0.", "1.")):
        raise ValueError(f"its core:version must be one of SigMF 1, got {info['core:version']}")
    if not isinstance(info.get("core:num_channels", 1), int):  # to a schema 3.0 is a whole number
        raise ValueError(
            f"its core:num_channels must be a whole number, got {info['core:num_channels']}"
        )
    for extension in info.get("core:extensions", []):
        if not extension["optional"] and extension["name"] != INVALID.split(":")[0]:
            raise ValueError(
                f"it must not require an extension, got {extension['name']!r}, which is not "
                "supported"
            )
    for name in _ELSEWHERE:
        for part in (info, *captures):
            if part.get(name):
                raise ValueError(f"it must not have {name}, got {part[name]!r}")
    return content


def segments(content, frames):
    """Return the start of a recording and its pieces, for a file of so many samples.

    A recording begins with its first capture. Captures follow each other without a gap unless their
    global indices say otherwise, or else their times, by more than a sample and the digits that
    these are written with.
    """
    info, captures = content["global"], content["captures"] or [{}]
    fs, offset = info.get("core:sample_rate", 1.0), info.get("core:offset", 0)
    told = [capture.get("core:frequency") for capture in captures]
    for value in told[1:]:
        if value is not None and value != told[0]:
            raise ValueError(
                f"its captures must have one core:frequency, got {told[0]} and {value}"
            )
    firsts = [int(capture.get("core:sample_start", 0)) for capture in captures]
    rows = [max(first - offset, 0) for first in firsts]
    if any(b < a for a, b in zip(rows, [*rows[1:], frames], strict=True)):
        raise ValueError(
            f"its captures must start one after the other within {frames} samples, got "
            f"core:sample_start {firsts}, core:offset {offset}"
        )
    pieces, at = [], 0
    for i, row in enumerate(rows):
        if i:
            gap = _gap(captures[i - 1], captures[i], firsts[i] - firsts[i - 1], fs)
            if gap:
                pieces.append(Piece(at, None, gap))
                at += gap
        pieces.append(Piece(at, row, [*rows, frames][i + 1] - row))
        at += pieces[-1].count
    start, _ = _time(captures[0])
    return later(start, max(offset - firsts[0], 0) / fs), pieces


def _gap(one, two, count, fs):
    """Return the number of missing samples between two captures, the first of `count` samples."""
    names = ("core:global_index", "core:datetime")
    (a, _), (b, digit) = _time(one), _time(two)
    if names[0] in one and names[0] in two:
        gap = int(two[names[0]]) - int(one[names[0]]) - count
    elif a is not None and b is not None:
        gap = (b - a).total_seconds() * fs - count
        gap = 0 if abs(gap) <= 1 + digit * fs else round(gap)
    else:
        return 0
    if gap < 0:
        raise ValueError(f"its captures must not overlap in time, got {-gap} samples that do")
    return gap


def _time(capture):
    """Return the time of a capture in UTC, and the value of its last digit in s."""
    text = capture.get("core:datetime")
    if text is None:
        return None, 0.0
    moment = datetime.fromisoformat(text)
    if moment.utcoffset() is None:  # SigMF knows no other time zone
        moment = moment.replace(tzinfo=UTC)
    digits = re.search(r"\.(\d+)", text)
    return utc("its core:datetime", moment), 10.0 ** -len(digits[1]) if digits else 1.0


def invalid_runs(valid):
    """Return the runs of invalid samples, [sensor, first, count] each."""
    edges = np.diff(~valid, axis=1, prepend=False, append=False)
    sensor, place = (part.tolist() for part in np.nonzero(edges))
    return [[s, a, b - a] for s, a, b in zip(sensor[::2], place[::2], place[1::2], strict=True)]


def which_invalid(content, sensors):
    """Return a function of (first, count) that gives the invalid samples, bool (sensors, count)."""
    runs = content["global"].get(INVALID, [])
    if not isinstance(runs, list) or not all(
        isinstance(run, list)
        and len(run) == 3
        and all(type(value) is int and value >= 0 for value in run)
        and run[0] < sensors
        for run in runs
    ):
        raise ValueError(
            f"its {INVALID} must be a list of [sensor, first, count], got {runs!r:.80}"
        )

    def invalid(first, count):
        mask = np.zeros((sensors, count), dtype=bool)
        for sensor, a, many in runs:
            mask[sensor, max(a - first, 0) : max(a + many - first, 0)] = True
        return mask

    return invalid
