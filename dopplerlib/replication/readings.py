"""Evidence on a claim from many runs, or under several interpretations."""

from collections.abc import Iterator

import numpy as np

from .._records import record


@record
class Draws:
    """Evidence on the outcome of a random run: the outcomes of many runs of ours.

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
    """Evidence on an ambiguous claim: one piece for each interpretation.

    Attributes
    ----------
    by_name : dict
        A float, `ConfidenceInterval` or `Draws` for each reading.
    """

    by_name: dict
