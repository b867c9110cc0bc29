"""Results of the study of symptoms: mistakes that were made on purpose, and their symptoms."""

import re
from functools import cache

import numpy as np

from .._data import read_json, results
from .intervals import proportion_interval, quantile_interval
from .table import Table

# The look that tells a mistake from the others.
LOOKS = {
    "nothing": "all checks pass",
    "I and Q exchanged": "track with layout qi: the start becomes plausible",
    "I and Q of one sensor exchanged": "each sensor conjugated in turn: one makes NIS normal",
    "two sensors exchanged": "all pairs exchanged in turn; walk past the modules one by one",
    "one sensor 0.3 m from its place": "each sensor left out in turn; then a tape measure",
    "one sensor late by 30 to 100 ms": "knock on the rig: all modules see it at once",
    "all sensors late by 50 ms": "a target at a known place: no check of innovations sees it",
    "carrier 1 % too low": "a target of known speed, or a frequency counter",
    "sampling rate 1 % too low": "count the samples of a minute",
    "height 0.4 m wrong": "the height left free in the box: NIS becomes normal",
    "window eight times as long": "half the window: the track moves",
    "windows overlap by three quarters": "hop as long as the window: innovations become white",
    "hum": "spectrogram: level lines at the mains and its harmonics, at both signs",
    "DC offset drifts": "spectrum near 0 Hz: it falls within a few Hz",
    "one module dies": "fraction of windows with a measurement, by sensor",
    "50 ms of samples lost": "NIS over time: calm, a jump, and never calm again",
    "target turns": "NIS over time: grows when it turns; more random walk makes it normal",
    "target is no point": "scatter of shifts about the track: white, and the same in all sensors",
    "no target": "spectrogram: nothing moves",
}
_COLUMNS = {  # column: (key of a run, factor)
    "start χ² per degree": ("start", 1.0),
    "NIS per shift": ("NIS", 1.0),
    "NEES per component": ("NEES", 0.25),
    "mean innovation (σ)": ("mean sigma", 1.0),
    "lag-one autocorrelation": ("lag1", 1.0),
    "error (mm)": ("error", 1e3),
}


@cache
def _runs():
    """Return {mistake: its runs}."""
    found = {}
    for row in read_json("symptoms.json", folder=results)["rows"]:
        found.setdefault(row["mistake"], []).append(row)
    return found


def symptom_table() -> Table:
    """Return the symptoms of each mistake, with NEES and error, which need truth.

    Returns
    -------
    Table
        Medians with their intervals of 95 %; a dash where there is no track.

    Examples
    --------
    >>> symptom_table().rows["no target"][0]
    '–'
    """
    rows = {
        mistake: [_median(runs, *column) for column in _COLUMNS.values()]
        for mistake, runs in _runs().items()
    }
    return Table(rows, tuple(_COLUMNS), ".2g", corner="mistake")


def cause_table() -> Table:
    """Return the fraction of runs in which the symptoms name the mistake, and the look for it.

    Returns
    -------
    Table
        With the cause that is named most often, numbers of sensors and frequencies left out, the
        fraction of runs in which it is, that in which the sensors are right where sensors are
        named, both with their intervals of 95 %, and the look that decides.

    Examples
    --------
    >>> cause_table().rows["two sensors exchanged"][0]
    'sensors # and # exchanged'
    """
    rows = {}
    for mistake, runs in _runs().items():
        causes = np.array([re.sub(r"\d+", "#", run["cause"]) for run in runs])
        names, counts = np.unique(causes, return_counts=True)
        most = names[np.argmax(counts)]
        right = [_right(run) for run in runs if "sensor" in run["cause"]]
        fractions = [
            proportion_interval(hits) if len(hits) else "–" for hits in (causes == most, right)
        ]
        rows[mistake] = str(most), *fractions, LOOKS[mistake]
    columns = "most frequent cause", "fraction of runs", "sensors right", "look that decides"
    return Table(rows, columns, ".0%", corner="mistake")


def confusions() -> Table:
    """Return the causes that are named for each mistake whose cause is not always the same.

    Returns
    -------
    Table
        Number of runs by cause.

    Examples
    --------
    >>> "none found" in confusions().columns
    True
    """
    named = {
        mistake: [re.sub(r"\d+", "#", run["cause"]) for run in runs]
        for mistake, runs in _runs().items()
    }
    mixed = {mistake: causes for mistake, causes in named.items() if len(set(causes)) > 1}
    columns = sorted({cause for causes in mixed.values() for cause in causes})
    rows = {mistake: [causes.count(c) for c in columns] for mistake, causes in mixed.items()}
    return Table(rows, tuple(columns), corner="mistake")


def _right(run):
    """Return whether the sensors in a cause are those of which something is wrong."""
    named = {int(one) for one in re.findall(r"\d+", run["cause"])}
    return named == set(run["sensors"][: len(named)])


def _median(runs, key, factor):
    values = [factor * run[key] for run in runs if run.get(key) is not None]
    return quantile_interval(values) if values else "–"
