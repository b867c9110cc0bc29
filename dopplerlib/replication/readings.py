"""Evidence on a claim that one number cannot be: many runs, or several ways to read the claim."""

from collections.abc import Iterator

import numpy as np

from .._records import record


@record
class Draws:
    """Evidence on the outcome of a random run: what it is in many runs of ours.

    Attributes
    ----------
    values : array_like, shape (runs,)
        The same quantity in independent runs.
    published : float, optional
        The document's, if its ``claims.toml`` cannot state it.
    """

    values: np.ndarray
    published: float | None = None

    def __post_init__(self):
        """Keep the values, also those of an iterator: they are looked at more than once."""
        if isinstance(self.values, Iterator):
            object.__setattr__(self, "values", tuple(self.values))


@record
class Readings:
    """Evidence on a claim that leaves something open: one piece for each way to read it.

    Attributes
    ----------
    by_name : dict
        A float, `ConfidenceInterval` or `Draws` for each reading.
    """

    by_name: dict
