"""Checks of arguments, for the public edge: every error names argument, value and expectation."""

import numpy as np

# Rounding in a covariance, as a share of its largest entry. An update in the form of Joseph leaves
# an asymmetry of about 1e-12, from one linear-algebra library to another a little more or less; a
# mistake leaves more than this.
_ROUNDING = 1e-9


def real(name, value):
    """Return `value` as a float array, or raise unless it is made of real numbers.

    Text, booleans, None, complex numbers, dates and masked arrays are refused: NumPy would turn
    each of them into floats and lose what they meant.
    """
    if isinstance(value, np.ma.MaskedArray):
        raise ValueError(
            f"{name} must not be a masked array, whose mask would be lost, got {_short(value)}"
        )
    try:
        array = np.asarray(value)
    except (TypeError, ValueError):  # a ragged nested list
        array = None
    if array is None or array.dtype.kind not in "iuf":
        raise ValueError(f"{name} must be an array of real numbers, got {_short(value)}")
    return array.astype(float, copy=False)


def finite(name, value, shape=None):
    """Return `value` as a float array, or raise if it is not finite or not of `shape`.

    `shape` is matched from the right and may hold None for "any length"; more axes may lead.
    """
    array = real(name, value)
    check_shape(name, array, shape)
    _check_all(name, "finite", array, np.isfinite(array))
    return array


def finite_complex(name, value, shape=None):
    """Return `value` as a complex array, or raise if it is not finite or not of `shape`.

    Real numbers are complex ones; everything else that `real` refuses is refused here as well.
    """
    try:
        array = np.asarray(value)
    except (TypeError, ValueError):  # a ragged nested list
        array = None
    if array is None or array.dtype.kind != "c" or isinstance(value, np.ma.MaskedArray):
        return finite(name, value, shape).astype(complex)
    array = array.astype(complex, copy=False)
    check_shape(name, array, shape)
    _check_all(name, "finite", array, np.isfinite(array))
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


def matrix(name, value, shape):
    """Return `value` as a float array, or raise unless it is one finite matrix of `shape`."""
    array = finite(name, value, shape)
    if array.ndim != 2:
        raise ValueError(f"{name} must be one matrix, got an array of shape {array.shape}")
    return array


def each_run(name, value, batch, shape):
    """Return `value` (..., *shape) broadcast to (*batch, *shape), or raise if it does not fit."""
    if value.shape == (*batch, *shape):
        return value
    try:
        return np.broadcast_to(value, (*batch, *shape))
    except ValueError:
        lead = value.shape[: value.ndim - len(shape)]
        raise ValueError(
            f"{name} must have leading axes that broadcast against the runs {batch}, "
            f"got {lead} in an array of shape {value.shape}"
        ) from None


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
    _check_all(name, "positive", array, array > 0)
    return array


def deviation(name, value, shape=None):
    """Return `value` as a float array, or raise if a square in it is not finite and positive."""
    array = positive(name, value, shape)
    with np.errstate(over="ignore", under="ignore"):
        square = array * array
    _check_all(
        name,
        "a number whose square is positive and finite",
        array,
        (square > 0) & (square < np.inf),
    )
    return array


def one_number(name, value, check=finite):
    """Return `value` as a float, or raise if it is not one number that passes `check`."""
    if type(value) is float and 1e-150 < value < 1e150:
        return value  # passes every check there is, without becoming an array
    array = check(name, value)
    if array.ndim:
        raise ValueError(f"{name} must be one number, got an array of shape {array.shape}")
    return float(array)


def positive_number(name, value):
    """Return `value` as a float, or raise if it is not one finite positive number."""
    return one_number(name, value, positive)


def whole_number(name, value, least=1):
    """Return `value` as an int, or raise if it is not a whole number of at least `least`."""
    whole = isinstance(value, (int, np.integer)) and not isinstance(value, bool)
    if not whole or not least <= value < 2**63:
        raise ValueError(f"{name} must be a whole number of at least {least}, got {_short(value)}")
    return int(value)


def increasing_pair(name, value):
    """Return `value` as two floats, or raise unless they are finite and the second is larger."""
    array = finite(name, value, (2,))
    if array.ndim != 1 or not array[0] < array[1]:
        raise ValueError(f"{name} must be two numbers, the smaller one first, got {_short(value)}")
    return float(array[0]), float(array[1])


def one_of(name, value, choices):
    """Return `value`, or raise if it is none of `choices`."""
    if not any(isinstance(value, type(choice)) and value == choice for choice in choices):
        raise ValueError(
            f"{name} must be one of {', '.join(map(repr, choices))}, got {_short(value)}"
        )
    return value


def some_of(name, values, choices):
    """Return `values`, or raise if it is not a collection that holds only some of `choices`."""
    if isinstance(values, str) or not hasattr(values, "__iter__"):
        raise ValueError(
            f"{name} must be a collection of {', '.join(map(repr, choices))}, got {_short(values)}"
        )
    return tuple(one_of(name, value, choices) for value in values)


def instance(name, value, kind):
    """Return `value`, or raise if it is not an instance of the class `kind`."""
    if not isinstance(value, kind):
        raise ValueError(f"{name} must be a {kind.__name__}, got {_short(value)}")
    return value


def probability(name, value):
    """Return `value` as a float, or raise if it is not strictly between 0 and 1."""
    number = one_number(name, value)
    if not 0 < number < 1:
        raise ValueError(f"{name} must lie between 0 and 1, got {number}")
    return number


def covariance(name, value, n, definite=True):
    """Return `value` as a float array, or raise if a matrix in it is not a covariance.

    A covariance is symmetric to rounding and positive definite; with ``definite=False`` it may
    have no spread in some directions. It is returned as it came.
    """
    array = finite(name, value, (n, n))
    largest = np.abs(array).max(axis=(-2, -1), initial=0.0)
    asymmetry = np.abs(array - array.swapaxes(-1, -2)).max(axis=(-2, -1), initial=0.0)
    if (asymmetry > _ROUNDING * largest).any():
        raise ValueError(
            f"{name} must be symmetric, got a difference of {asymmetry.max():.3g} across "
            "the diagonal"
        )
    if definite:
        try:
            np.linalg.cholesky(array)
            return array
        except np.linalg.LinAlgError:
            wanted = "positive definite"
    else:
        if (np.linalg.eigvalsh(array)[..., :1] >= -_ROUNDING * largest[..., None]).all():
            return array
        wanted = "positive semidefinite"
    least = np.linalg.eigvalsh(array)[..., 0].min()
    raise ValueError(f"{name} must be {wanted}, got a smallest eigenvalue of {least:.3g}")


def generator(name, value):
    """Return `value`, or raise if it is not a `numpy.random.Generator`."""
    if not isinstance(value, np.random.Generator):
        raise ValueError(
            f"{name} must be a numpy.random.Generator, for example "
            f"numpy.random.default_rng(1), got {_short(value)}"
        )
    return value


def _check_all(name, wanted, array, good):
    """Raise unless all of `good` is true; name the first value of `array` where it is not."""
    if good.all():
        return
    place = tuple(int(i) for i in np.argwhere(~good)[0])
    where = f" at index {place}" if place else ""
    raise ValueError(f"{name} must be {wanted}, got {array[place]}{where}")


def _short(value, most=100):
    text = repr(value)
    return text if len(text) <= most else text[:most] + " ..."
