"""The text of RINEX files: headers, epochs of observations, records of navigation messages."""

from contextlib import contextmanager
from datetime import datetime
from pathlib import Path

import numpy as np

from ..model.broadcast_orbit import ELEMENTS, WEEK

_START = datetime(1980, 1, 6)  # of GPS time
# Which of several signals on L1 is read: the first of these that the file has for GPS.
_SIGNALS = ("1C", "1W", "1P", "1X", "1L", "1S", "1Y", "1M", "A", "1")
_WIDTH = 16  # of an observation: 14 characters of number, two of flags
# Places of the elements in a navigation record, counted from 0; that of toc is its head.
_PLACES = {
    "af0": 0, "af1": 1, "af2": 2, "crs": 4, "delta_n": 5, "m0": 6, "cuc": 7, "e": 8, "cus": 9,
    "sqrt_a": 10, "toe": 11, "cic": 12, "omega0": 13, "cis": 14, "i0": 15, "crc": 16, "omega": 17,
    "omega_dot": 18, "i_dot": 19, "health": 24,
}  # fmt: skip


def observed(name, path):
    """Return satellites, times (K,), values (K, S, 4) and header position of an observation file.

    The values are Doppler shift, carrier over noise density, pseudorange, and the cycles counted
    since the epoch before.
    """
    version, header, lines = _opened(name, path, "O")
    first = dict(reversed(header))  # of a label that occurs several times
    system = first.get("TIME OF FIRST OBS", "")[48:51].strip()
    if system not in ("", "GPS"):
        raise ValueError(f"{name} must have GPS time, got {system!r}")
    kinds, read = (_kinds_2, _epochs_2) if version < 3 else (_kinds_3, _epochs_3)
    with _readable(name, path):
        kinds = kinds(header)
        signals = [s for kind in "DL" for s in _SIGNALS if kind + s in kinds]
        if not signals:
            got = " ".join(kinds) or "none"
            raise _Refused(f"hold Doppler shifts or phases of GPS on L1, got {got}")
        signal = signals[0]
        columns = [kinds.index(k + signal) if k + signal in kinds else None for k in "DSCL"]
        epochs = [epoch for epoch in read(lines, len(kinds)) if epoch[1]]
        satellites = sorted({satellite for _, row in epochs for satellite in row})
        values = np.full((len(epochs), len(satellites), 4), np.nan)
        lost = np.zeros(values.shape[:2], bool)
        for k, (_, row) in enumerate(epochs):
            for satellite, text in row.items():
                s = satellites.index(satellite)
                values[k, s] = [np.nan if c is None else _number(_part(text, c)) for c in columns]
                lost[k, s] = columns[3] is not None and _lost(text, columns[3])
        place = first.get("APPROX POSITION XYZ", "")
        position = np.array([_number(place[14 * i : 14 * i + 14]) for i in range(3)])
    values[values == 0] = np.nan  # RINEX writes a missing observation as a blank or as 0.0
    phase = values[..., 3]
    phase[1:] = np.where(lost[1:], np.nan, phase[:-1] - phase[1:])  # it grows with the distance
    phase[:1] = np.nan
    times = np.array([time for time, _ in epochs])
    return satellites, times, values, position if position.any() else np.full(3, np.nan)


def navigated(name, path):
    """Return satellites and elements (E, 20) of the healthy GPS satellites of a navigation file."""
    version, _, lines = _opened(name, path, "N")
    width = 3 if version < 3 else 4  # of what stands before the first number of a line
    satellites, rows = [], []
    with _readable(name, path):
        for i, line in enumerate(lines):
            satellite = _head(line, version, lines[i - 1] if i else "")
            if satellite is None:
                continue
            tokens = line[width - 1 : width + 19].split()
            text = line[width + 19 :].ljust(57)
            for more in range(1, 8):
                text += lines[i + more][width:].ljust(76)[:76]
            values = [_number(text[19 * j : 19 * j + 19]) for j in range(29)]
            told = {key: values[place] for key, place in _PLACES.items()}
            if not told["health"] > 0:  # or blank
                told["toc"] = _seconds(*tokens)
                # In the week nearest to toc: some files count weeks from 1999 or 2019 on.
                told["toe"] += WEEK * round((told["toc"] - told["toe"]) / WEEK)
                satellites.append(satellite)
                rows.append([told[key] for key in ELEMENTS])
    return satellites, rows


def _head(line, version, before):
    """Return the satellite if the line begins a record of GPS, or None."""
    if version < 3:
        return f"G{int(line[:2]):02d}" if line[:2].strip().isdigit() else None
    if line[:1] != "G" or (version >= 4 and "LNAV" not in before):
        return None
    return _satellite(line)


def _kinds_2(header):
    text = "".join(text[6:60].ljust(54) for label, text in header if label == "# / TYPES OF OBSERV")
    return text.split()


def _kinds_3(header):
    kinds, system = [], None
    for label, text in header:
        if label == "SYS / # / OBS TYPES":
            system = text[0].strip() or system
            kinds += text[6:60].split() if system == "G" else []
    return kinds


def _epochs_3(lines, kinds):
    """Return (time, {satellite: its line from the first observation on}) for each epoch."""
    found, i = [], 0
    while i < len(lines):
        if not lines[i].strip():
            i += 1
            continue
        if lines[i][:1] != ">":
            raise _Refused(f"begin an epoch with '>', got {lines[i][:20]!r}")
        flag, count = int(lines[i][31:32]), int(lines[i][32:35])
        rows = [lines[i + 1 + j] for j in range(count)]
        if flag < 2:  # beyond: events, and comments in between
            row = {_satellite(text): text[3:] for text in rows if text[:1] == "G"}
            found.append((_seconds(*lines[i][1:29].split()), row))
        i += 1 + count
    return found


def _epochs_2(lines, kinds):
    found, i = [], 0
    height = -(-kinds // 5)  # lines of a satellite
    while i < len(lines):
        if not lines[i].strip():  # at the end; elsewhere such a line holds observations
            i += 1
            continue
        flag, count = int(lines[i][28:29]), int(lines[i][29:32])
        if flag > 1:
            i += 1 + count
            continue
        rows = -(-count // 12)  # lines of names
        names = "".join(lines[i + j].ljust(68)[32:68] for j in range(rows))
        names = [names[3 * j : 3 * j + 3] for j in range(count)]
        time, i = _seconds(*lines[i][:26].split()), i + rows
        row = {}
        for name in names:
            text = "".join(lines[i + j].ljust(80)[:80] for j in range(height))
            if name[0] in "G ":
                row[_satellite(name)] = text
            i += height
        found.append((time, row))
    return found


def _satellite(text):
    return f"G{int(text[1:3]):02d}"


def _part(text, place):
    return text[_WIDTH * place : _WIDTH * place + 14]


def _lost(text, place):
    """Return whether the receiver says that it lost count of the phase since the epoch before."""
    flag = text[_WIDTH * place + 14 : _WIDTH * place + 15].strip()
    return bool(flag) and int(flag) % 2 == 1


def _number(text):
    """Return the number of a fixed column, NaN if it is blank; FORTRAN writes D for E."""
    return float(text.replace("D", "E").replace("d", "e")) if text.strip() else np.nan


def _seconds(year, month, day, hour, minute, second):
    """Return the time in s since GPS time began; of a year of two digits, 80 is 1980."""
    year = int(year)
    year += 0 if year > 99 else 1900 if year >= 80 else 2000
    start = datetime(year, int(month), int(day), int(hour), int(minute))
    return (start - _START).total_seconds() + float(second)


class _Refused(ValueError):
    """Refusal of a file: the rest of the sentence that begins with its name and must."""


@contextmanager
def _readable(name, path):
    """Turn what goes wrong with the text of a file into an error that names the file."""
    try:
        yield
    except _Refused as error:
        raise ValueError(f"{name} must {error} in {str(path)!r}") from None
    except IndexError:
        raise ValueError(
            f"{name} must be complete, got {str(path)!r}, which ends within a record"
        ) from None
    except (ValueError, TypeError) as error:
        raise ValueError(f"{name} must have the columns of RINEX, got {path!r}: {error}") from None


def _opened(name, path, kind):
    """Return version, header as (label, text), and other lines of a RINEX file, or raise."""
    try:
        text = Path(path).read_text(encoding="latin-1")
    except (OSError, TypeError, ValueError) as error:
        raise ValueError(f"{name} must be a file to read, got {path!r}: {error}") from None
    lines = text.splitlines()
    first = lines[0] if lines else ""
    if "COMPACT RINEX" in first or text[:2] in ("\x1f\x8b", "\x1f\x9d"):
        raise ValueError(f"{name} must be plain text, got {str(path)!r}, which is compressed")
    wanted = {"O": "an observation", "N": "a navigation"}[kind]
    if first[60:].strip() != "RINEX VERSION / TYPE" or first[20:21] != kind:
        raise ValueError(f"{name} must be {wanted} file in RINEX, got {str(path)!r}")
    with _readable(name, path):
        version = _number(first[:9])
        if not 2 <= version < 5:
            raise _Refused(f"have RINEX version 2 to 4, got {version}")
        ends = [i for i, line in enumerate(lines) if line[60:].strip() == "END OF HEADER"]
        if not ends:
            raise _Refused("have a header that ends, got none")
    header = [(line[60:].strip(), line[:60]) for line in lines[: ends[0]]]
    return version, header, lines[ends[0] + 1 :]
