"""Errors of plain and robust starts against the fraction of wrong windows, from a saved study."""

from typing import Any, Literal

import numpy as np

from .. import _checks
from .._data import read_lines, results
from .._hints import Real, checked
from .._records import record
from .._typing import BoolArray, FloatArray, IntArray
from .bootstrap import bootstrap_interval

SCENES = ("road", "ring")  # in the order of their numbers in the file
KINDS = ("scattered", "line", "target")

_Scene = Literal["road", "ring"]
_Kind = Literal["scattered", "line", "target"]


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

    def __post_init__(self):
        """Check the fields."""
        error = _checks.matrix("error", self.error, (None, 3))
        runs = error.shape[:1]
        names: dict[str, Any] = {"scene": SCENES, "kind": KINDS}
        for name, known in names.items():
            values = np.asarray(getattr(self, name), dtype=object)
            if values.shape != runs or not all(isinstance(v, str) and v in known for v in values):
                raise ValueError(
                    f"{name} must hold one of {', '.join(known)} for each of {runs} runs, got "
                    f"{str(values)[:80]}"
                )
            names[name] = values.astype(str)
        fraction = _checks.exact_shape("fraction", _checks.finite("fraction", self.fraction), runs)
        converged = _checks.booleans("converged", self.converged)
        converged = _checks.exact_shape("converged", converged, (*runs, 2))
        return {**names, "error": error, "fraction": fraction, "converged": converged}

    @checked
    def runs(self, scene: _Scene, kind: _Kind, fraction: Real) -> BoolArray:
        """Return which runs are of a scene, kind and fraction; without wrong windows, of any kind.

        Parameters
        ----------
        scene, kind, fraction
            See the attributes.

        Returns
        -------
        ndarray of bool, shape (R,)

        Examples
        --------
        >>> int(saved_starts().runs("road", "line", 0.2).sum())
        100
        """
        alike = (self.kind == kind) | (self.fraction == 0)
        return (self.scene == scene) & alike & (self.fraction == fraction)

    @checked
    def ratios(self, scene: _Scene, kind: _Kind, *, rng: np.random.Generator) -> FloatArray:
        """Return root mean square errors over those of the fit to the right windows alone.

        Parameters
        ----------
        scene, kind
            See the attributes.
        rng : numpy.random.Generator
            Source of the bootstrap of the intervals.

        Returns
        -------
        ndarray, shape (2, F, 4)
            For the robust and the plain fit: fraction, ratio, and the ends of its 95 % interval.

        Examples
        --------
        A fifth of the windows on another line:

        >>> found = saved_starts().ratios("road", "line", rng=np.random.default_rng(1))
        >>> found[:, 3, :2].round(1).tolist()
        [[0.2, 1.4], [0.2, 408.6]]
        """
        found = []
        for i in (1, 2):
            for fraction in np.unique(self.fraction):
                some = self.runs(scene, kind, fraction)
                if not some.any():
                    raise ValueError(
                        f"kind must have runs at all fractions of wrong windows, got {kind!r}, "
                        f"which has none at {fraction} ({scene})"
                    )
                square = self.error[some] ** 2
                ratio = bootstrap_interval(
                    _root_of_ratio, [square[:, i], square[:, 0]], rng=rng
                )  # fmt: skip
                found.append((fraction, ratio.value, ratio.low, ratio.high))
        return np.reshape(found, (2, -1, 4))

    @checked
    def counts(self, scene: _Scene) -> IntArray:
        """Return runs, and those that converged: robust, plain.

        Parameters
        ----------
        scene
            See the attributes.

        Returns
        -------
        ndarray of int, shape (F, 3)
            A row for each fraction.

        Examples
        --------
        >>> saved_starts().counts("road")[-1].tolist()
        [300, 296, 1]
        """
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
