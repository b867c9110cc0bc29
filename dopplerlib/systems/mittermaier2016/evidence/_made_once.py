"""Results that several claims share, made at the first call from noise of their own."""

from collections.abc import Callable, Iterable
from functools import cache
from typing import Any

import numpy as np

from ....replication.choices import Choice
from ....replication.evidence import combinations


def made_once(
    choices: Iterable[Choice], function: Callable[..., Any], rng: np.random.Generator
) -> Callable[..., Any]:
    """Return a function of a value of each choice, that calls `function(child, *values)` once."""
    values = combinations(choices)
    children = dict(zip(values, rng.spawn(len(values)), strict=True))
    return cache(lambda *at: function(children[at], *at))
