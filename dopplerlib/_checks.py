"""Checks of arguments, for the public edge: every error names argument, value and expectation."""

import inspect
from collections.abc import Iterator, MappingView
from itertools import chain
from math import isfinite

import numpy as np

# Rounding in a covariance, as a share of the two standard deviations that an entry belongs to: an
# error of this size in a correlation coefficient. A product of n terms in double precision is off
# by n 1e-16 of its factors' lengths, so that what `estimation.gaussian` returns is off by 1e-14. A
# filter that subtracts loses as many digits more as the variance before an update is larger than
# that after it: this admits 1e6. Scaled by the diagonal, it does not depend on the units.
_ROUNDING = 1e-9

# Around every public function that computes: what is too large or too small for a float becomes
# infinite, NaN or zero, whatever `np.seterr` says, and `estimates` looks at what comes out.
quiet = np.errstate(all="ignore")

_PLAIN = {float, int, np.ndarray, np.float64}
_LISTS = {list, tuple}
_DOUBLE = np.dtype(float)
_SCALARS = {float, int, bool, np.float64, np.bool_}


def real(name, value):
    """Return `value` as a float array, or raise unless it is made of real numbers.

    Text, booleans, None, complex numbers, dates, masks and units are refused, also inside lists:
    NumPy would turn each of them into floats and lose what they meant. An iterator is a list.
    """
    if type(value) is np.ndarray and value.dtype is _DOUBLE:
        return value
    return _numbers(name, value, "iuf", "real numbers").astype(float, copy=False)


def booleans(name, value, shape=None):
    """Return `value` as an array of booleans, or raise if it is none, or not of `shape`.

    `shape` is matched from the right as by `check_shape`.
    """
    array = _numbers(name, value, "b", "booleans")
    check_shape(name, array, shape)
    return array


def one_boolean(name, value):
    """Return `value` as a bool, or raise if it is not one boolean."""
    if not isinstance(value, (bool, np.bool_)):
        raise ValueError(f"{name} must be True or False, got {_short(value)}")
    return bool(value)


def measured(name, value, shape):
    """Return `value` as a float array of `shape`, or raise; NaN stands for what is missing."""
    array = real(name, value)
    check_shape(name, array, shape)
    if not all_finite(array):
        _check_all(name, "finite, or NaN where it is missing", array, ~np.isinf(array))
    return array


def finite(name, value, shape=None):
    """Return `value` as a float array, or raise if it is not finite or not of `shape`.

    `shape` is matched from the right and may hold None for "any length"; more axes may lead.
    """
    array = real(name, value)
    check_shape(name, array, shape)
    if not all_finite(array):
        _check_all(name, "finite", array, np.isfinite(array))
    return array


def all_finite(array):
    """Return whether all numbers are finite; a False may also come of very large ones."""
    return isfinite(abs(np.vdot(array, array)))  # a third of the time that `np.isfinite` takes


def numbers(name, value, shape=None):
    """Return `value` as a float or a complex array, or raise if it is neither or not of `shape`.

    Values that are not finite may be in it; everything else that `real` refuses is refused here.
    """
    array = _numbers(name, value, "iufc", "numbers")
    array = array.astype(complex if array.dtype.kind == "c" else float, copy=False)
    check_shape(name, array, shape)
    return array


def finite_complex(name, value, shape=None):
    """Return `value` as a complex array, or raise if it is not finite or not of `shape`.

    Real numbers are complex ones; everything else that `real` refuses is refused here as well.
    """
    array = numbers(name, value, shape)
    _check_all(name, "finite", array, np.isfinite(array))
    return array.astype(complex, copy=False)


def check_shape(name, array, shape):
    """Raise unless the last axes of `array` have `shape`."""
    if shape is None or array.shape == shape:
        return
    leading = array.ndim - len(shape)
    good = leading >= 0
    for got, want in zip(array.shape[max(leading, 0) :], shape, strict=False):
        good = good and (want is None or got == want)
    if not good:
        wanted = ", ".join("any" if want is None else str(want) for want in shape)
        raise ValueError(f"{name} must have shape (..., {wanted}), got {array.shape}")


def exact_shape(name, array, shape):
    """Return `array`, or raise unless it has this shape."""
    if array.shape != shape:
        raise ValueError(f"{name} must have shape {shape}, got {array.shape}")
    return array


def matrix(name, value, shape):
    """Return `value` as a float array, or raise unless it is one finite matrix of `shape`."""
    return one_matrix(name, finite(name, value, shape))


def one_matrix(name, array):
    """Return `array`, or raise unless it has two axes."""
    if array.ndim != 2:
        raise ValueError(f"{name} must be one matrix, got an array of shape {array.shape}")
    return array


def one_row(name, value, check=finite, least=1):
    """Return `value` as an array of one axis that passes `check`, `least` entries or more."""
    array = check(name, value, (None,))
    if array.ndim != 1 or len(array) < least:
        raise ValueError(
            f"{name} must have one axis with {least} values or more, got shape {array.shape}"
        )
    return array


def detections(name, value, m):
    """Return measurements (..., D, m), NaN for what is missing; an empty list is an empty scan."""
    array = real(name, value)
    return measured(name, array.reshape(0, m) if array.shape == (0,) else array, (None, m))


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


def check_leading(**arguments):
    """Raise unless the leading axes of all broadcast; each argument is (array, own axes)."""
    leading = {name: value.shape[: value.ndim - own] for name, (value, own) in arguments.items()}
    try:
        np.broadcast_shapes(*leading.values())
    except ValueError:
        got = ", ".join(f"{lead} of {name}" for name, lead in leading.items())
        raise ValueError(
            f"{', '.join(leading)} must have leading axes that broadcast, got {got}"
        ) from None


def each_sample(name, value, samples, shape):
    """Return `value`, one of `shape` or one for each sample, as (samples, *shape), or raise."""
    if value.shape not in (shape, (samples, *shape)):
        raise ValueError(
            f"{name} must have shape {shape}, or {(samples, *shape)} with one for each sample, "
            f"got {value.shape}"
        )
    return np.broadcast_to(value, (samples, *shape))


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
    if type(value) is float and 1e-60 < value < 1e3:
        return value  # passes every check there is, without becoming an array
    array = check(name, value)
    if array.ndim:
        raise ValueError(f"{name} must be one number, got an array of shape {array.shape}")
    return float(array)


def positive_number(name, value):
    """Return `value` as a float, or raise if it is not one finite positive number."""
    return one_number(name, value, positive)


def is_whole(value):
    """Return whether `value` is a whole number: no boolean, and no duration of NumPy."""
    return isinstance(value, (int, np.integer)) and not isinstance(value, (bool, np.timedelta64))


def whole_number(name, value, least=1):
    """Return `value` as an int, or raise if it is not a whole number of at least `least`.

    With ``least=None`` it may be any whole number.
    """
    lowest = -(2**63) if least is None else least
    if not is_whole(value) or not lowest <= value < 2**63:
        wanted = "a whole number" + (f" of at least {least}" if least is not None else "")
        raise ValueError(f"{name} must be {wanted}, got {_short(value)}")
    return int(value)


def increasing_pair(name, value):
    """Return `value` as two floats, or raise unless they are finite and the second is larger."""
    array = finite(name, value, (2,))
    if array.ndim != 1 or not array[0] < array[1]:
        raise ValueError(f"{name} must be two numbers, the smaller one first, got {_short(value)}")
    return float(array[0]), float(array[1])


def one_of(name, value, choices):
    """Return `value`, or raise if it is none of `choices`."""
    if (value is None or type(value) is str) and value in choices:
        return value

    def is_it(choice):
        alike = is_whole(value) if is_whole(choice) else isinstance(value, type(choice))
        return alike and value == choice

    if not any(map(is_it, choices)):
        raise ValueError(
            f"{name} must be one of {', '.join(map(repr, choices))}, got {_short(value)}"
        )
    return value


def some_of(name, values, choices):
    """Return `values`, or raise if it is not a collection that holds only some of `choices`."""
    if values is choices:
        return choices
    wanted = f"a collection of {', '.join(map(repr, choices))}"
    return tuple(one_of(name, value, choices) for value in iterable(name, values, wanted))


def components(name, values, count):
    """Return `values`, any iterable, as a tuple of places from 0 to `count` - 1, or raise."""
    wanted = f"some of the components from 0 to {count - 1}"
    places = tuple(iterable(name, values, wanted))
    if not all(is_whole(place) and 0 <= place < count for place in places):
        raise ValueError(f"{name} must be {wanted}, got {_short(places)}")
    return places


def iterable(name, values, wanted="an iterable"):
    """Return an iterator over `values`, or raise if there is none or it is text."""
    try:
        iterator = iter(values)
    except TypeError:
        iterator = None
    if iterator is None or isinstance(values, (str, bytes, bytearray, memoryview)):
        raise ValueError(f"{name} must be {wanted}, got {_short(values)}")
    return iterator


def called(name, function, *arguments):
    """Return what a function that was handed in returns, or raise if it does not take them."""
    if not callable(function):
        raise ValueError(f"{name} must be a function, got {_short(function)}")
    try:
        return function(*arguments)
    except (TypeError, ValueError) as error:
        try:
            inspect.signature(function).bind(*arguments)
        except TypeError as misfit:
            raise ValueError(
                f"{name} must take {len(arguments)} argument(s), got a function with {misfit}"
            ) from None
        except ValueError:  # a function of C that does not tell
            pass
        if error.__traceback__.tb_next is None:  # nothing of Python ran, as in int or dict
            raise ValueError(
                f"{name} must take the arrays it is called with, got {_short(function)}: {error}"
            ) from None
        raise


def function(name, value):
    """Return `value`, or raise if it cannot be called."""
    if not callable(value):
        raise ValueError(f"{name} must be a function, got {_short(value)}")
    return value


def estimates(names, *arrays, what="estimates"):
    """Return the results that come of the arguments `names`, or raise unless they are finite."""
    for array in arrays:
        if not all_finite(array) and not np.isfinite(array).all():
            place = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
            raise ValueError(
                f"{names} must keep the {what} within the range of floating-point numbers, "
                f"got {array[place]} at index {place}"
            )
    return arrays if len(arrays) > 1 else arrays[0]


def instance(name, value, kind):
    """Return `value`, or raise if it is not an instance of `kind`, a class or a tuple of some."""
    if not isinstance(value, kind):
        kinds = kind if isinstance(kind, tuple) else (kind,)
        wanted = " or a ".join(one.__name__ for one in kinds)
        raise ValueError(f"{name} must be a {wanted}, got {_short(value)}")
    return value


def probability(name, value):
    """Return `value` as a float, or raise if it is not strictly between 0 and 1."""
    number = one_number(name, value)
    if not 0 < number < 1:
        raise ValueError(f"{name} must lie between 0 and 1, got {number}")
    return number


def covariance(name, value, n, definite=True):
    """Return `value` as a float array, or raise if a matrix in it is not a covariance.

    A covariance is symmetric and positive definite; with ``definite=False`` it may have no spread
    in some directions. Both are judged after it was scaled to a diagonal of ones, and so whatever
    the units: as correlations, up to rounding. It is returned as it came.
    """
    return factored(name, value, n, definite)[0]


def factored(name, value, n, definite=True):
    """Return what `covariance` does, and its Cholesky factors, None if one has no spread."""
    array = finite(name, value, (n, n))
    if not _symmetric(array):
        difference = np.abs(array - array.mT)
        deviation = np.sqrt(np.abs(np.diagonal(array, axis1=-2, axis2=-1)))
        if (difference > _ROUNDING * deviation[..., :, None] * deviation[..., None, :]).any():
            raise ValueError(
                f"{name} must be symmetric, got a difference of {difference.max():.3g} across "
                "the diagonal"
            )
    try:  # Scaling changes nothing for this test, which most matrices pass.
        return array, np.linalg.cholesky(array)
    except np.linalg.LinAlgError:
        least = _least_eigenvalue(array)
    if not definite and least >= -_ROUNDING:
        return array, None
    plain = np.linalg.eigvalsh(array)[..., 0].min()
    got = f"{plain:.3g}" if plain <= 0 else f"{least:.3g} relative to its diagonal"
    raise ValueError(
        f"{name} must be positive {'definite' if definite else 'semidefinite'}, "
        f"got a smallest eigenvalue of {got}"
    )


def _symmetric(array):
    """Return whether matrices are symmetric to the last bit."""
    if array.ndim == 2 and array.tobytes() == array.T.tobytes():  # a quarter of the time
        return True
    return (array == array.mT).all()


def _least_eigenvalue(array):
    """Return the smallest eigenvalue of symmetric matrices that are scaled by their diagonals."""
    deviation = np.sqrt(np.abs(np.diagonal(array, axis1=-2, axis2=-1)))
    # Where a variance is zero, every covariance with it has to be: it is weighed like a large one.
    deviation = np.where(deviation > 0, deviation, np.finfo(float).tiny ** 0.5)
    with np.errstate(over="ignore", under="ignore"):
        scaled = array / deviation[..., :, None] / deviation[..., None, :]
    scaled = np.clip(scaled, -1e9, 1e9)  # a correlation beyond 1 is refused, however large
    return np.linalg.eigvalsh(scaled)[..., 0].min()


def generator(name, value):
    """Return `value`, or raise if it is not a `numpy.random.Generator`."""
    if not isinstance(value, np.random.Generator):
        raise ValueError(
            f"{name} must be a numpy.random.Generator, for example "
            f"numpy.random.default_rng(1), got {_short(value)}"
        )
    return value


def _numbers(name, value, kinds, wanted):
    """Return `value` as an array whose dtype is of one of `kinds`, or raise."""
    good = True
    if type(value) not in _PLAIN:
        if isinstance(value, (Iterator, MappingView)):
            value = list(value)  # NumPy would make one object of it
        good = _nothing_is_lost(name, value, wanted, "b" in kinds)
    try:
        array = np.asarray(value)
    except (TypeError, ValueError):  # a ragged nested list
        good = False
    if not good or array.dtype.kind not in kinds:
        raise ValueError(f"{name} must be an array of {wanted}, got {_short(value)}")
    return array


def _nothing_is_lost(name, value, wanted, boolean):
    """Return whether NumPy would not mix other things into numbers; raise for masks and units."""
    level = [value]
    for depth in range(64):  # as deep as an array can be
        kinds = set(map(type, level))  # as fast as NumPy's own look at a list
        for part in () if kinds <= _SCALARS or kinds <= _LISTS else level:
            if isinstance(part, (bytes, bytearray, memoryview)):
                return False  # NumPy would take them for small numbers
            if type(part) is np.ndarray:
                kinds.add(part.dtype.type)
            elif type(part) not in _SCALARS:
                _check_plain(name, part, wanted)
        if not boolean and not kinds.isdisjoint((bool, np.bool_)):
            return False
        if kinds <= _SCALARS:
            break
        nested = level if kinds <= _LISTS else [p for p in level if isinstance(p, (list, tuple))]
        if depth > 8:  # a list that holds itself is looked at once
            nested = {id(part): part for part in nested}.values()
        level = list(chain.from_iterable(nested))
    return True


def _check_plain(name, value, wanted):
    """Raise if NumPy would drop a mask or a unit of `value`."""
    if isinstance(value, np.ma.MaskedArray) or _has_data(value, "mask"):
        raise ValueError(
            f"{name} must not be a masked array, whose mask would be lost, got {_short(value)}"
        )
    if _has_data(value, "unit") or _has_data(value, "units"):
        raise ValueError(
            f"{name} must be an array of {wanted} without a unit, which would be lost, "
            f"got {_short(value)}"
        )


def _has_data(value, attribute):
    """Return whether something other than a method has this name (pandas has a method `mask`)."""
    found = getattr(value, attribute, None)
    return found is not None and not callable(found)


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


def text(name, value, least=0):
    """Return `value`, or raise if it is not a text of at least `least` characters."""
    if not isinstance(value, str) or len(value) < least:
        wanted = "a text" if not least else "a text that is not empty"
        raise ValueError(f"{name} must be {wanted}, got {_short(value)}")
    return value


def records(name, values, kind):
    """Return `values`, any iterable of records of the class `kind`, as a tuple, or raise."""
    return tuple(instance(name, value, kind) for value in iterable(name, values))


# Products of five numbers of this size are finite, and so are the formulas of models. No length,
# speed or time in the universe is beyond it, in SI units.
_MODERATE = 1e60


def moderate(name, value, shape=None):
    """Return `value` as a float array, or raise if it is not finite or beyond 1e60 in size."""
    array = real(name, value)
    check_shape(name, array, shape)
    if not np.vdot(array, array) <= _MODERATE**2:
        finite(name, array)
        good = np.abs(array) <= _MODERATE
        _check_all(name, f"between -{_MODERATE:g} and {_MODERATE:g}", array, good)
    return array


def bounded(name, value, shape=None, most=_MODERATE):
    """Return `value` as by `measured`, or raise if a number in it is beyond `most` in size."""
    array = measured(name, value, () if shape is None else shape)
    good = np.isnan(array) | (np.abs(array) <= most)
    _check_all(name, f"between -{most:g} and {most:g}", array, good)
    return array


def moderate_number(name, value):
    """Return `value` as a float, or raise if it is not one number from 1e-60 to 1e60."""
    number = positive_number(name, value)
    if not 1 / _MODERATE <= number <= _MODERATE:
        raise ValueError(
            f"{name} must lie between {1 / _MODERATE:g} and {_MODERATE:g}, got {number}"
        )
    return number


def decibels(name, value):
    """Return `value` as a float array, or raise if a ratio in dB is none of two floats."""
    array = finite(name, value)
    _check_all(name, "between -3000 and 3000 dB", array, np.abs(array) <= 3000)
    return array


def count(name, value, most, least=1):
    """Return `value` as an int, or raise if it is not a whole number from `least` to `most`."""
    number = whole_number(name, value, least)
    if number > most:
        raise ValueError(f"{name} must be at most {most}, got {number}")
    return number


def shape(name, value):
    """Return `value`, a whole number or an iterable of them, as the shape of an array, or raise."""
    lengths = (value,) if isinstance(value, (int, np.integer)) else tuple(iterable(name, value))
    return tuple(count(name, length, 2**40, least=0) for length in lengths)
