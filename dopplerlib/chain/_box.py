"""Box of a position or a state, checked."""

from .. import _checks


def bounds(name, box):
    """Return the lower and upper bounds of a position or a state, or raise."""
    given = tuple(_checks.iterable(name, box, "a pair (lower, upper)"))
    if len(given) != 2:
        raise ValueError(f"{name} must be a pair (lower, upper), got {len(given)} bounds")
    lower, upper = (_checks.moderate(name, bound) for bound in given)
    if lower.shape != upper.shape or lower.shape not in ((3,), (6,)):
        got = f"{lower.shape}, {upper.shape}"
        raise ValueError(f"{name} must be a pair of arrays of shape (3,) or (6,), got {got}")
    if (lower > upper).any():
        raise ValueError(f"{name} must not be empty, got {lower.tolist()} to {upper.tolist()}")
    return lower, upper
