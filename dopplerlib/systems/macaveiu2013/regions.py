"""For which noise the claims of Section IV hold: the document does not state its noise."""

from dataclasses import dataclass

import numpy as np

from ... import _checks
from .published import paths, settings
from .tracking import errors

MUCH_SMALLER = 0.5  # our reading of "much smaller than 1 m": less than half of it


@dataclass(frozen=True)
class Scores:
    """How the five paths went, in every run.

    Attributes
    ----------
    figures : tuple of int
        Numbers of the figures, in the order of the arrays.
    settled : ndarray, shape (paths, runs)
        Largest position error after the first second, in m.
    whole : ndarray, shape (paths, runs)
        Largest position error of the whole record, in m.
    speed : ndarray, shape (paths, runs, 2)
        Root mean square of the errors of v_x and v_y after the first second, in m/s.
    resolution : float
        Range resolution in m, the measure of the claims.
    """

    figures: tuple
    settled: np.ndarray
    whole: np.ndarray
    speed: np.ndarray
    resolution: float

    def small_in_figure_7(self, largest=None):
        """Return in which runs the error of Fig 7 is much smaller than the resolution, (runs,)."""
        largest = self.settled if largest is None else largest
        return largest[self.figures.index(7)] < MUCH_SMALLER * self.resolution

    def below_resolution(self, largest=None):
        """Return in which runs all five paths stay below the resolution, shape (runs,)."""
        largest = self.settled if largest is None else largest
        return largest.max(axis=0) < self.resolution

    def speed_worse_when_it_varies(self):
        """Return in which runs Figs 10b and 11c are worse than all of Figs 7 to 9, (runs,)."""
        row = {figure: self.speed[i] for i, figure in enumerate(self.figures)}
        steady = np.maximum.reduce([row[7], row[8], row[9]])
        return (row[10][:, 0] > steady[:, 0]) & (row[11][:, 1] > steady[:, 1])


def scores(runs, *, rng, s=None):
    """Run all five paths and score them.

    Parameters
    ----------
    runs : int
        Number of independent records of each path.
    rng : numpy.random.Generator
        Source of the measurement noise.
    s : Settings, optional
        Those of the data file if None.

    Returns
    -------
    Scores

    Raises
    ------
    ValueError
        If `runs` is not a positive whole number, or `rng` is not a generator.
    """
    s = settings() if s is None else s
    five = paths()
    error = errors(list(five.values()), runs, rng=rng, s=s)
    distance = np.hypot(error[..., 0], error[..., 2])
    return Scores(
        tuple(five),
        settled=distance[..., s.skip :].max(axis=-1),
        whole=distance.max(axis=-1),
        speed=np.sqrt(np.mean(error[:, :, s.skip :, 1::2] ** 2, axis=2)),
        resolution=s.range_resolution,
    )


def claim_map(rows, columns, runs, *, rng, s=None):
    """Return in how many runs the claims hold, over two settings.

    Parameters
    ----------
    rows, columns : tuple (str, sequence of float)
        Name and values of a setting: "sigma_p", "sigma_v" or "w" of `Settings`.
    runs : int
        Number of records of each path at each place of the map.
    rng : numpy.random.Generator
        Source of the measurement noise.
    s : Settings, optional
        What is not varied; those of the data file if None.

    Returns
    -------
    dict of str to ndarray, shape (rows, columns)
        Share of the runs in which each claim holds, and "all three".

    Raises
    ------
    ValueError
        If a name is none of the three; see `scores`.
    """
    s = settings() if s is None else s
    (row, heights), (column, widths) = rows, columns
    for name in (row, column):
        _checks.one_of("the name of a setting", name, ("sigma_p", "sigma_v", "w"))
    shape = len(heights), len(widths)
    names = ("Fig 7 much below 1 m", "all below 1 m", "10b and 11c worse", "all three")
    shares = {name: np.empty(shape) for name in names}
    for (i, j), child in zip(np.ndindex(shape), rng.spawn(shape[0] * shape[1]), strict=True):
        here = s.with_(**{row: heights[i], column: widths[j]})
        one = scores(runs, rng=child, s=here)
        held = [
            one.small_in_figure_7(),
            one.below_resolution(),
            one.speed_worse_when_it_varies(),
        ]
        for name, runs_held in zip(names, [*held, np.all(held, axis=0)], strict=True):
            shares[name][i, j] = runs_held.mean()
    return shares
