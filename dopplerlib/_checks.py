"""Checks of arguments, for the public edge: every error names argument, value and expectation."""

import numpy as np


def finite(name, value, shape=None):
    """Return `value` as a float array, or raise if it is not finite or not of `shape`.

    `shape` is matched from the right and may hold None for "any length"; more axes may lead.
    """
    try:
        array = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        raise ValueError(f"{name} must be an array of real numbers, got {value!r}") from None
    check_shape(name, array, shape)
    if not np.isfinite(array).all():
        bad = array[~np.isfinite(array)].flat[0]
        raise ValueError(f"{name} must be finite, got {bad} in an array of shape {array.shape}")
    return array


def check_shape(name, array, shape):
    """Raise unless the last axes of `array` have `shape`."""
    if shape is None:
        return
    last = array.shape[array.ndim - len(shape) :] if array.ndim >= len(shape) else None
    if last is None or any(
        want is not None and got != want for got, want in zip(last, shape, strict=True)
    ):
        wanted = ", ".join("any" if want is None else str(want) for want in shape)
        raise ValueError(f"{name} must have shape (..., {wanted}), got {array.shape}")


def check_broadcast(name, shape, other_name, other_shape):
    """Raise unless the leading axes of two arguments broadcast against each other."""
    try:
        np.broadcast_shapes(shape, other_shape)
    except ValueError:
        raise ValueError(
            f"{name} must have leading axes that broadcast against {other_shape} of {other_name}, "
            f"got {shape}"
        ) from None


def positive(name, value, shape=None):
    """Return `value` as a float array, or raise if it is not finite and positive."""
    array = finite(name, value, shape)
    if not (array > 0).all():
        raise ValueError(f"{name} must be positive, got {array[~(array > 0)].flat[0]}")
    return array


def one_number(name, value, check=finite):
    """Return `value` as a float, or raise if it is not one number that passes `check`."""
    array = check(name, value)
    if array.ndim:
        raise ValueError(f"{name} must be one number, got an array of shape {array.shape}")
    return float(array)


def positive_number(name, value):
    """Return `value` as a float, or raise if it is not one finite positive number."""
    return one_number(name, value, positive)


def whole_number(name, value, least=1):
    """Return `value` as an int, or raise if it is not a whole number of at least `least`."""
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)) or value < least:
        raise ValueError(f"{name} must be a whole number of at least {least}, got {value!r}")
    return int(value)


def one_of(name, value, choices):
    """Return `value`, or raise if it is none of `choices`."""
    if value not in choices:
        raise ValueError(f"{name} must be one of {', '.join(map(repr, choices))}, got {value!r}")
    return value


def probability(name, value):
    """Return `value` as a float, or raise if it is not strictly between 0 and 1."""
    number = positive_number(name, value)
    if number >= 1:
        raise ValueError(f"{name} must lie between 0 and 1, got {number}")
    return number


def covariance(name, value, n):
    """Return `value` as a float array, or raise if a matrix in it is not a covariance.

    A covariance is symmetric to rounding and positive definite. It is returned as it came.
    """
    array = finite(name, value, (n, n))
    asymmetry = np.abs(array - array.swapaxes(-1, -2)).max(initial=0.0)
    if asymmetry > 1e-12 * np.abs(array).max(initial=0.0):
        raise ValueError(
            f"{name} must be symmetric, got a difference of {asymmetry:.3g} across the diagonal"
        )
    try:
        np.linalg.cholesky(array)
    except np.linalg.LinAlgError:
        least = np.linalg.eigvalsh(array)[..., 0].min()
        raise ValueError(
            f"{name} must be positive definite, got a smallest eigenvalue of {least:.3g}"
        ) from None
    return array


def generator(name, value):
    """Return `value`, or raise if it is not a `numpy.random.Generator`."""
    if not isinstance(value, np.random.Generator):
        raise ValueError(
            f"{name} must be a numpy.random.Generator, for example "
            f"numpy.random.default_rng(1), got {value!r}"
        )
    return value
