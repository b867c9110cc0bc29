"""Saved studies of layouts: arrays, bounds, and errors of the tracker."""

from functools import cache
from typing import Annotated, Any, Literal

import numpy as np

from .._data import read_json, read_toml, results
from .._hints import checked, up_to
from .._records import record
from .._typing import FloatArray
from ..evaluation.intervals import ConfidenceInterval, proportion_interval
from ..model.radar_array import RadarArray
from .layouts import named_layouts

# Names of layouts that were searched: kind, sensors, depth in m, and static or limit of the bound.
_FOUND = {
    "six, plane, bound + 120 %": ("front", 6, 0.0, 2.2),
    "six, 5 cm deep, bound + 10 %": ("front", 6, 0.05, 1.1),
    "seven, 5 cm deep, best bound": ("bound", 7, 0.05, False),
    "eight, 5 cm deep, best bound": ("bound", 8, 0.05, False),
}
Lost = Annotated[int, up_to(7, 0)]
TIMES = (0.01, 0.1, 0.2, 0.5)  # in s


@checked
def saved_searches() -> list[dict[str, Any]]:
    """Return the layouts of each saved search, see the README of ``results``.

    Examples
    --------
    >>> {row["kind"] for row in saved_searches()} == {"bound", "front"}
    True
    """
    saved = read_json("layouts.json", folder=results)
    return [*saved["bound"], *saved["front"]]


@checked
def saved_arrays() -> dict[str, RadarArray]:
    """Return the layouts that are compared: those with a name, and those that were searched.

    Examples
    --------
    >>> len(saved_arrays()["seven, 5 cm deep, best bound"])
    7
    """
    rows = {}
    for row in saved_searches():
        how = row["static"] if row["kind"] == "bound" else row["limit"]
        rows[row["kind"], row["n"], row["depth"], how] = row["sensors"]
    found = {name: RadarArray(np.array(rows[key]) / 1000) for name, key in _FOUND.items()}
    return named_layouts() | found


@checked
def saved_rows(
    kind: Literal["quality", "map", "solutions"], layout: str | None = None
) -> list[dict[str, Any]]:
    """Return rows of the saved comparison of layouts, see the README of ``results``.

    Parameters
    ----------
    kind : {"quality", "map", "solutions"}
        Bounds and second valleys, the same over places, or numbers of exact solutions.
    layout : str, optional
        Name of the layout; those of all if None.

    Examples
    --------
    >>> saved_rows("solutions", "three")[1]["ranks"][0]
    6
    """
    saved = read_json("layout_tracks.json", folder=results)
    return [row for row in saved[kind] if layout in (None, row["layout"])]


@checked
def saved_places() -> tuple[FloatArray, FloatArray]:
    """Return the places of the saved maps.

    Returns
    -------
    x : ndarray, shape (X,)
        Distances from the plane of the array in m.
    y : ndarray, shape (Y,)
        Distances from its axis in m.

    Examples
    --------
    >>> [len(each) for each in saved_places()]
    [5, 6]
    """
    parameters = read_toml("layout_tracks.toml", folder=results)["parameters"]
    return np.array(parameters["map_x"]), np.array(parameters["map_y"])


@cache
def _tracks():
    """Return the rows of the tracker, which are read once: not to be changed."""
    return read_json("layout_tracks.json", folder=results)["track"]


@record
class LayoutErrors:
    """Errors of the tracker before one layout after 0.01, 0.1, 0.2 and 0.5 s, with 95 % intervals.

    Attributes
    ----------
    position, range : tuple of ConfidenceInterval
        Root mean square errors in mm.
    bound : tuple of float
        Root mean square of the Cramer-Rao bound of the position along the paths, in mm.
    nees : tuple of ConfidenceInterval
        Mean normalized estimation error squared.
    wrong : tuple of ConfidenceInterval
        Share of the runs with more than half of the weight on the wrong side.
    lost : tuple of ConfidenceInterval
        Share of the runs that are off by more than 5 cm and 4 bounds.
    """

    position: tuple
    range: tuple
    bound: tuple
    nees: tuple
    wrong: tuple
    lost: tuple


@checked
def saved_errors(layout: str, case: Literal["A", "T"], lost: Lost | None = None) -> LayoutErrors:
    """Return errors of the tracker in the saved comparison of layouts.

    Parameters
    ----------
    layout : str
        Name of the layout, see `saved_arrays`.
    case : {"A", "T"}
        Targets of the workspace; or all with the start of Table 2, turned about the axis of the
        array by multiples of 45 degrees. Both with process noise.
    lost : int, optional
        Number of the sensor that is missing.

    Returns
    -------
    LayoutErrors

    Examples
    --------
    >>> errors = saved_errors("five and the center", "A")
    >>> errors.range[1].high < saved_errors("ring of six", "A").range[1].low
    True
    """
    parts = [
        row
        for row in _tracks()
        if (row["layout"], row["case"], row.get("without")) == (layout, case, lost)
    ]
    if not parts:
        raise ValueError(f"layout must be one that was tracked, got {layout!r} without {lost}")
    total = {
        key: np.sum([part[key] for part in parts], axis=0)
        for key in parts[0]
        if isinstance(parts[0][key], list)
    }
    n = total["n"]

    def means(key):
        mean = total[key] / n
        error = 1.96 * np.sqrt((total[f"{key}2"] / n - mean**2) / n)
        return np.stack([mean, mean - error, mean + error])

    def shares(key):
        counts = zip(total[key].astype(int), n, strict=True)
        return tuple(proportion_interval(np.arange(runs) < hits) for hits, runs in counts)

    position, away = (np.sqrt(np.maximum(means(key), 0)) for key in ("position", "range"))
    intervals = (
        tuple(ConfidenceInterval(*map(float, one)) for one in each.T)
        for each in (position, away, means("nees"))
    )
    position, away, nees = intervals
    bound = tuple(np.sqrt(total["bound"] / n).tolist())
    return LayoutErrors(position, away, bound, nees, shares("wrong"), shares("lost"))
