"""Errors of plain and robust starts against the fraction of wrong windows, from a saved study."""

import numpy as np

from .._data import read_lines, results
from .._hints import checked
from .._records import record
from .._typing import BoolArray, FloatArray, IntArray
from .bootstrap import bootstrap_interval

SCENES = ("road", "ring")  # in the order of their numbers in the file
KINDS = ("scattered", "line", "target")


@record
class RobustStarts:
    """Position errors of starts with wrong windows, one for each run.

    Attributes
    ----------
    scene, kind : ndarray of str, shape (R,)
        "road" or "ring"; "scattered", "line" or "target": where the wrong windows lie.
    fraction : ndarray, shape (R,)
        Fraction of wrong windows.
    error : ndarray, shape (R, 3)
        Errors in m of a fit to the right windows alone, and of a robust and a plain fit to all.
    converged : ndarray of bool, shape (R, 2)
        Whether the robust fit and the plain one state that they have converged.
    """

    scene: np.ndarray
    kind: np.ndarray
    fraction: np.ndarray
    error: np.ndarray
    converged: np.ndarray

    def runs(self, scene: str, kind: str, fraction: float) -> BoolArray:
        """Return which runs (R,) are of a scene, kind and fraction; without wrong windows all."""
        alike = (self.kind == kind) | (self.fraction == 0)
        return (self.scene == scene) & alike & (self.fraction == fraction)

    @checked
    def ratios(self, scene: str, kind: str, *, rng: np.random.Generator) -> FloatArray:
        """Return root mean square errors over those of the fit to the right windows alone.

        Parameters
        ----------
        scene, kind : str
            See the attributes.
        rng : numpy.random.Generator
            Source of the bootstrap of the intervals.

        Returns
        -------
        ndarray, shape (2, F, 4)
            For the robust and the plain fit: fraction, ratio, and the ends of its 95 % interval.
        """
        found = []
        for i in (1, 2):
            for fraction in np.unique(self.fraction):
                square = self.error[self.runs(scene, kind, fraction)] ** 2
                ratio = bootstrap_interval(
                    _root_of_ratio, [square[:, i], square[:, 0]], rng=rng
                )  # fmt: skip
                found.append((fraction, ratio.value, ratio.low, ratio.high))
        return np.reshape(found, (2, -1, 4))

    def counts(self, scene: str) -> IntArray:
        """Return runs, and those that converged: robust, plain; a row (F, 3) for each fraction."""
        rows = []
        for fraction in np.unique(self.fraction):
            some = (self.scene == scene) & (self.fraction == fraction)
            rows.append([some.sum(), *self.converged[some].sum(axis=0)])
        return np.array(rows)


def _root_of_ratio(one, other):
    return np.sqrt(one / other)


@checked
def saved_starts() -> RobustStarts:
    """Return the starts of the study that is saved in ``results``.

    Returns
    -------
    RobustStarts

    Notes
    -----
    Made by ``make study NAME=robust_start``; see the README of ``results``.

    Examples
    --------
    >>> saved_starts().error.shape[1]
    3
    """
    numbers = np.loadtxt(
        read_lines("robust_start.csv", folder=results), delimiter=",", skiprows=1, unpack=True
    )
    scene, kind = (
        np.array(names)[code.astype(int)]
        for names, code in zip((SCENES, KINDS), numbers[:2], strict=True)
    )
    return RobustStarts(scene, kind, numbers[2], numbers[3:6].T, numbers[6:].T > 0)
