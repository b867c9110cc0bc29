"""Results of the study of faults: trackers beside one another, as tables and as maps.

``LABELS`` has a label for each of its trackers.
"""

from functools import cache, partial
from types import MappingProxyType
from typing import Annotated, Literal, get_args

import numpy as np

from .. import _checks
from .._data import read_json, results
from .._hints import checked
from ..evaluation.intervals import ConfidenceInterval, proportion_interval
from ..evaluation.table import Table
from .faults import FAULTS

LABELS = MappingProxyType(
    {
        "bank": "Gaussian sum",
        "gated_bank": "Gaussian sum, gate",
        "moving_bank": "Gaussian sums, three motions",
        "paper": "EKF as in the paper",
        "gated_start": "EKF, better start",
        "gated_start_ukf": "UKF, same start",
        "gate_paper": "EKF, two-sided gate, 95 %",
        "gate_upper": "EKF, upper gate, 99.9 %",
        "gate_each": "EKF, gate for each sensor",
        "huber": "EKF, Huber",
        "student_t": "EKF, Student t",
        "adaptive": "EKF, adaptive R",
    }
)
TIMES = 0.2, 0.5  # in s
_Time = Literal["0.2 s", "0.5 s"]
_Size = Literal["rms error", "median error", "mean NEES", "median NEES"]
_SIZES = get_args(_Size)
_fault = partial(_checks.one_of, choices=tuple(FAULTS))


@cache
def _rows():
    """Return the rows of the study by fault and tracker."""
    found = read_json("faults.json", folder=results)["rows"]
    return {(row["fault"], row["tracker"]): row for row in found}


def _faults():
    return list(dict.fromkeys(fault for fault, _ in _rows()))


def _at(fault, tracker, time):
    """Return the statistics at a time, or None: some trackers were only run to the first."""
    found, place = _rows()[fault, tracker]["at"], TIMES.index(float(time.split()[0]))
    return found[place] if place < len(found) else None


@checked
def lost_map(time: _Time = "0.5 s") -> dict[str, dict[str, float]]:
    """Return the fraction of targets that each tracker has lost with each fault.

    Parameters
    ----------
    time : {"0.2 s", "0.5 s"}
        Time after the targets appear.

    Returns
    -------
    dict of str to dict
        For each fault the fraction by the label of the tracker: off by more than 5 cm and four
        bounds, or given up. After 0.5 s of the seven trackers that were run for so long.

    Examples
    --------
    >>> lost_map()["none"]["Gaussian sum"] < 0.01
    True
    """
    return {
        fault: {
            label: found["lost"] / found["runs"]
            for name, label in LABELS.items()
            if (found := _at(fault, name, time))
        }
        for fault in _faults()
    }


@checked
def size_table(quantity: _Size, trackers: tuple[str, ...], time: _Time = "0.5 s") -> Table:
    """Return errors or NEES of some trackers with each fault.

    Parameters
    ----------
    quantity : {"rms error", "median error", "mean NEES", "median NEES"}
        RMS and mean are those of the runs that have an estimate. Medians are those of all, and
        infinite where more than half have been given up.
    trackers : tuple of str
        Names in `LABELS`.
    time : {"0.2 s", "0.5 s"}
        Time after the targets appear.

    Returns
    -------
    Table
        With intervals of 95 %; errors in mm. A dash where a tracker was not run for so long, or has
        given up all runs.

    Examples
    --------
    >>> size_table("median NEES", ("bank",)).rows["none"][0].value < 7
    True
    """
    ending = " (mm)" if quantity.endswith("error") else ""
    columns = tuple(LABELS[_known(name)] + ending for name in trackers)
    rows = {
        fault: [_interval(_at(fault, name, time), quantity) for name in trackers]
        for fault in _faults()
    }
    return Table(rows, columns, ".3g", corner="fault")


@checked
def tracker_table(fault: Annotated[str, _fault], time: _Time = "0.2 s") -> Table:
    """Return the losses, errors and consistency of each tracker with one fault.

    Parameters
    ----------
    fault : str
        Name in `FAULTS`.
    time : {"0.2 s", "0.5 s"}
        Time after the targets appear.

    Returns
    -------
    Table
        Fraction of lost targets, errors in mm and NEES, with intervals of 95 %.

    Examples
    --------
    >>> tracker_table("none").rows["Gaussian sum"][0].value < 0.01
    True
    """
    rows = {}
    for name, label in LABELS.items():
        found = _at(fault, name, time)
        if found:
            lost = proportion_interval(np.arange(found["runs"]) < found["lost"])
            rows[label] = lost, *(_interval(found, size) for size in _SIZES)
    columns = "lost", "RMS error (mm)", "median error (mm)", "mean NEES", "median NEES"
    return Table(rows, columns, (".0%", ".3g", ".3g", ".2g", ".2g"), corner="tracker")


@checked
def decision_table(wrong: Literal["late", "false"]) -> Table:
    """Return the fraction of wrong decisions to stop, with each fault and tracker.

    Parameters
    ----------
    wrong : {"late", "false"}
        Fraction of the collisions for which it stops too late or never, or of the passing courses
        for which it stops.

    Returns
    -------
    Table
        With intervals of 95 %; a dash where no course was of this kind.

    Examples
    --------
    >>> decision_table("false").rows["none"][0].value < 0.05
    True
    """
    of = {"late": "collisions", "false": "passing"}[wrong]
    names = [name for name in LABELS if "decisions" in _rows()[_faults()[0], name]]
    rows = {}
    for fault in _faults():
        found = [_rows()[fault, name]["decisions"] for name in names]
        rows[fault] = [
            proportion_interval(np.arange(one[of]) < one[wrong]) if one[of] else np.nan
            for one in found
        ]
    return Table(rows, tuple(LABELS[name] for name in names), ".0%", corner="fault")


def _interval(found, quantity):
    ends = found and found.get(quantity)
    if not ends:
        return np.nan
    unit = 1e3 if quantity.endswith("error") else 1.0
    return ConfidenceInterval(*(np.inf if end is None else unit * end for end in ends))


def _known(name):
    return _checks.one_of("trackers", name, tuple(LABELS))
