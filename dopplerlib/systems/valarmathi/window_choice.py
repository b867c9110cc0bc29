"""The document's criterion for windows: its cumulative error, and the table of the best ones."""

from typing import Annotated

import numpy as np

from ... import _checks
from ..._hints import checked, exactly, shaped
from ..._records import record
from ..._typing import BoolArray, FloatArray, IntArray


def _rising(name, value):
    array = _checks.moderate(name, value, (None,))
    if array.ndim != 1 or len(array) < 2 or (np.diff(array) <= 0).any():
        raise ValueError(f"{name} must rise and hold at least two numbers, got {array.tolist()}")
    return array


def _lengths(name, value, least=3):
    array = _checks.moderate(name, value, (None,))
    good = array.ndim == 1 and len(array) and (array % 1 == 0).all()
    if not (good and least <= array.min() and array.max() <= 1e6):
        wanted = f"a row of whole numbers from {least} to a million"
        raise ValueError(f"{name} must be {wanted}, got {array.tolist()}")
    return array.astype(int)


Rising = Annotated[FloatArray, _rising]
Lengths = Annotated[IntArray, _lengths]  # of windows, in samples


@checked
@record
class WindowTable:
    """The best window for some accelerations and signal-to-noise ratios.

    accelerations (A,): In m/s^2, rising.
    snrs_db (B,): In dB, rising.
    windows (W,): Lengths that were tried, in samples.
    cee (A, B, W): Their cumulative estimation errors at the end of a record, mean over the runs.

    Examples
    --------
    >>> cee = np.array([[[1.0, 2.0], [2.0, 1.0]], [[1.0, 2.0], [1.0, 2.0]]])
    >>> table = WindowTable([0, 10], [0, 20], [8, 64], cee)
    >>> table.best.tolist(), table.inside.any().item()
    ([[8, 64], [8, 8]], False)
    >>> table.labels()[10.0], table.only([8, 64]).best.shape
    (['≤ 8', '≤ 8'], (2, 2))
    """

    accelerations: Rising
    snrs_db: Rising
    windows: Lengths
    cee: Annotated[FloatArray, exactly(None, None, None)]

    def __post_init__(self):
        """Check that there is one error for each cell and window."""
        shape = len(self.accelerations), len(self.snrs_db), len(self.windows)
        if self.cee.shape != shape:
            raise ValueError(f"cee must have shape {shape}, got {self.cee.shape}")

    @property
    def best(self) -> IntArray:
        """Windows with the least error, shape (A, B)."""
        return self.windows[np.argmin(self.cee, axis=-1)]

    @property
    def inside(self) -> BoolArray:
        """Whether they are neither the first nor the last one that was tried, shape (A, B).

        Where not, the least error may lie beyond: then `best` is the best of these windows, and
        no optimum.
        """
        place = np.argmin(self.cee, axis=-1)
        return (place > 0) & (place < len(self.windows) - 1)

    def labels(self) -> dict[float, list[str]]:
        """Return `best` as text by acceleration; at an end of the windows tried with ≤ or ≥."""
        signs = np.where(self.inside, "", np.where(self.best == self.windows[0], "≤ ", "≥ "))
        return {
            float(a): [f"{sign}{window}" for sign, window in zip(*row, strict=True)]
            for a, *row in zip(self.accelerations, signs, self.best, strict=True)
        }

    @checked
    def only(self, windows: Lengths) -> "WindowTable":
        """Return the table of some of the windows."""
        if not np.isin(windows, self.windows).all():
            raise ValueError(f"windows must be some of {self.windows.tolist()}, got {windows}")
        places = np.searchsorted(self.windows, windows)
        return WindowTable(self.accelerations, self.snrs_db, windows, self.cee[..., places])


@checked
def cumulative_error(
    v: Annotated[FloatArray, exactly(None)],
    estimate: Annotated[FloatArray, shaped(None)],
) -> FloatArray:
    """Return the running mean of the relative errors, which the document judges by.

    v (K,): True velocity in m/s, nowhere zero.
    estimate (..., K): Estimated velocities.
    Returns (..., K)
    Raises ValueError if shapes do not fit, a value is not finite, or a true velocity is zero.

    Notes
    -----
    Eq 13 of the document, "cee".

    Examples
    --------
    >>> cumulative_error([100.0, 100.0], [101.0, 100.0]).tolist()
    [0.01, 0.005]
    """
    _checks.check_shape("estimate", estimate, v.shape)
    if (v == 0).any():
        raise ValueError("v must not be zero, where a relative error has no meaning, got a 0")
    count = np.arange(1, v.shape[-1] + 1)
    return np.cumsum(np.abs(estimate - v) / np.abs(v), axis=-1) / count
