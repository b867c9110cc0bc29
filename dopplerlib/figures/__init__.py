"""Results in, matplotlib figures out."""

from .._lazy import attach, require

require("matplotlib", extra="figures")
__getattr__, __dir__ = attach(__name__, __path__)
