"""Evidence on a claim: from many runs, and over the ranges of all its open points."""

from collections.abc import Callable, Iterable, Iterator
from itertools import product
from typing import Any

import numpy as np

from .. import _checks
from .._records import record
from .choices import Choice, check_choice


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
class Sweep:
    """Evidence for every combination of choices, as `sweep` makes it.

    Attributes
    ----------
    axes : tuple of str
        Names of the choices.
    points : dict
        A float, array, `ConfidenceInterval` or `Draws` by the values of the choices, a tuple.
    """

    axes: tuple
    points: dict


def combinations(choices: Iterable[Choice]) -> tuple[tuple, ...]:
    """Return every combination of values to try, and each value beyond its range in turn.

    Parameters
    ----------
    choices : iterable of Choice
        The axes.

    Returns
    -------
    tuple of tuple
        A value for each choice. At most one of them lies beyond its declared range.

    Raises
    ------
    ValueError
        If there is no choice.

    Examples
    --------
    >>> from datetime import date
    >>> gate = Choice("gate", "ours", "gate", ("none", "two-sided"), "both are usual", date.today())
    >>> angle = Choice("angle", "ours", "angle", (15, 30), "the text has none", date.today(), (45,))
    >>> combinations([gate, angle])[-2:]
    (('none', 45), ('two-sided', 45))
    """
    choices = _checks.records("choices", choices, Choice)
    if not choices:
        raise ValueError("choices must be at least one, got none")
    for one in choices:
        check_choice(f"choice {one.id!r}", one)
    within = [one.values for one in choices]
    found = list(product(*within))
    for place, one in enumerate(choices):
        found += product(*within[:place], one.beyond, *within[place + 1 :])
    return tuple(found)


def sweep(
    choices: Iterable[Choice],
    function: Callable[..., Any],
    rng: np.random.Generator | None = None,
) -> Any:
    """Compute evidence for every combination of choices.

    Parameters
    ----------
    choices : iterable of Choice
        The axes.
    function : callable
        ``function(*values)``, with a value of each choice, returns a piece of evidence, or a dict
        of pieces by the ids of several claims; not checked here, but by `judge`.
    rng : numpy.random.Generator, optional
        ``function(child, *values)`` gets a generator of its own for each combination.

    Returns
    -------
    Sweep or dict of str to Sweep
        As many as the function returns pieces.

    Raises
    ------
    ValueError
        If there is no choice, `rng` is no generator, or `function` cannot be called or does not
        return the same claims every time.

    Examples
    --------
    >>> from datetime import date
    >>> power = Choice("power", "ours", "exponent", (1, 2), "the text has none", date.today())
    >>> sweep([power], lambda exponent: 3.0**exponent).points
    {(1,): 3.0, (2,): 9.0}
    """
    choices = _checks.records("choices", choices, Choice)
    values = combinations(choices)
    _checks.function("function", function)
    arguments = values
    if rng is not None:
        children = _checks.generator("rng", rng).spawn(len(values))
        arguments = tuple((child, *one) for child, one in zip(children, values, strict=True))
    places = _tried(choices, len(values))
    values = tuple(values[place] for place in places)
    found = [function(*arguments[place]) for place in places]
    axes = tuple(one.id for one in choices)
    if not isinstance(found[0], dict):
        return Sweep(axes, dict(zip(values, found, strict=True)))
    if any(not isinstance(one, dict) or one.keys() != found[0].keys() for one in found):
        raise ValueError("function must return evidence on the same claims for all values")
    pieces = {name: [one[name] for one in found] for name in found[0]}
    return {
        name: Sweep(axes, dict(zip(values, of_claim, strict=True)))
        for name, of_claim in pieces.items()
    }


def _tried(choices, count):
    """Return the places of the combinations to compute: all but in a test that repeats a part."""
    return range(count)
