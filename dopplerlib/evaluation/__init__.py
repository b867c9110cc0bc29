"""Filter consistency, observability, bounds and confidence intervals."""

from .._lazy import attach

__getattr__, __dir__ = attach(__name__, __path__)
