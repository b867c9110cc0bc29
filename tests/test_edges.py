"""What all public functions of estimation and tracking share at their edges, tried on each."""

import datetime

import numpy as np
import pytest

from dopplerlib.estimation import (
    colored_errors,
    extended_update,
    imm,
    linear_kalman,
    nonlinear_kalman,
    online,
    robust_kalman,
    steady_state,
)
from dopplerlib.estimation.imm_records import ImmModel
from dopplerlib.tracking import multi_target, pda
from tests.estimates import (
    BOOLEANS,
    CALLS,
    COVARIANCES,
    INSIDE,
    ITERABLES,
    NOT_NUMBERS,
    call,
    label,
    public_functions,
    results,
    with_argument,
)

EVERY = list(CALLS)


def callable_argument(function, name):
    return (name == "assign" and function is multi_target.track_scans) or callable(
        CALLS[function].get(name)
    )


NUMBERS = [
    (function, name)
    for function, arguments in CALLS.items()
    for name, value in arguments.items()
    if name not in NOT_NUMBERS and not callable(value)
] + [(f, "gate") for f in EVERY if "gate" in CALLS[f] and isinstance(CALLS[f]["gate"], float)]


def test_every_public_function_is_tried():
    untried = set(public_functions()) - set(EVERY) - INSIDE
    assert not untried, "needs an example in its docstring that calls it"


@pytest.mark.parametrize("function", EVERY, ids=label)
def test_the_calls_are_valid(function):
    assert all(array.dtype.kind in "fbiuU" for array in results(call(function)))


# --------------------------------------------------------------- what np.asarray loses


class Quantity(np.ndarray):
    """An array with a unit, as astropy has it."""

    unit = "km"


class Measured:
    """A number with a unit, as pint has it."""

    units = "km"

    def __init__(self, value):
        self.value = value

    def __array__(self, dtype=None, copy=None):
        return np.asarray(self.value, dtype)


def masked(value):
    value = np.asarray(value, float)
    return np.ma.masked_array(value, np.zeros(value.shape, bool))


LOST = {
    "a mask": masked,
    "a mask in a list": lambda value: (
        list(masked(np.atleast_1d(value))) if np.ndim(value) > 1 else [masked(value)]
    ),
    "a mask two lists deep": lambda value: [[masked(value)], [np.asarray(value)]],
    "one masked value": lambda value: [np.ma.masked, 1.0],
    "a unit": lambda value: np.asarray(value, float).view(Quantity),
    "a unit in a list": lambda value: [Measured(value)],
    "complex": lambda value: np.asarray(value) + 0j,
    "complex in a list": lambda value: [np.asarray(value) + 0j],
    "text": lambda value: np.asarray(value).astype(str),
    "booleans": lambda value: np.ones(np.shape(value), bool),
    "booleans among numbers": lambda value: [True, 1.0],
    "booleans in a list of arrays": lambda value: [np.ones(2, bool), np.ones(2)],
    "durations": lambda value: np.ones(np.shape(value), "m8[s]"),
    "times": lambda value: np.ones(np.shape(value), "M8[s]"),
    "a time with its zone": lambda value: datetime.datetime(2020, 1, 1, tzinfo=datetime.UTC),
    "nothing": lambda value: np.full(np.shape(value), None),
}


@pytest.mark.parametrize(("function", "name"), NUMBERS, ids=label)
def test_what_numpy_would_lose_is_refused(function, name):
    for lost, change in LOST.items():
        with pytest.raises(ValueError, match=rf"^{name} must .* got ") as raised:
            call(function, **{name: change(CALLS[function][name])})
        assert "mask" not in lost or "mask" in str(raised.value), lost


@pytest.mark.parametrize("value", ["True", 1, np.ma.masked_array([True], [True]), [1.0], None])
@pytest.mark.parametrize(("function", "name"), with_argument(BOOLEANS), ids=label)
def test_only_booleans_are_true_or_false(function, name, value):
    if value is None and name == "accept":
        return  # all are accepted
    with pytest.raises(ValueError, match=rf"^{name} must "):
        function(**CALLS[function] | {name: value})


@pytest.mark.parametrize("function", EVERY, ids=label)
def test_lists_and_iterators_mean_the_same_as_arrays(function):
    """In place of all arrays at once: one that is read otherwise changes what comes out."""
    values = {name: np.asarray(CALLS[function][name]) for f, name in NUMBERS if f is function}
    lists = {name: value.tolist() for name, value in values.items() if value.ndim}
    expected = results(call(function))
    for other in (list, iter, lambda rows: (row for row in rows)):
        found = results(call(function, **{name: other(rows) for name, rows in lists.items()}))
        for got, want in zip(found, expected, strict=True):
            np.testing.assert_array_equal(got, want)


@pytest.mark.parametrize(("function", "name"), with_argument(ITERABLES), ids=label)
def test_an_iterable_argument_may_be_an_iterator(function, name):
    value = CALLS[function][name]
    expected = results(call(function))
    for other in (iter(value), (one for one in value), dict.fromkeys(range(len(value)), 0)):
        if isinstance(other, dict):
            other = map(value.__getitem__, other)
        for got, want in zip(results(call(function, **{name: other})), expected, strict=True):
            np.testing.assert_array_equal(got, want)


@pytest.mark.parametrize("value", [0, None, 1.5, object()])
@pytest.mark.parametrize(("function", "name"), with_argument(ITERABLES), ids=label)
def test_what_is_not_iterable_is_refused(function, name, value):
    with pytest.raises(ValueError, match=rf"^{name} must .* got "):
        function(**CALLS[function] | {name: value})


# --------------------------------------------------------------------- covariances

# What is no covariance whatever the units of its two components are.
INDEFINITE = {
    "a negative variance beside a large one": np.diag([1e6, -1e-4]),
    "beside a huge one": np.diag([1e20, -1e-20]),
    "a negative variance beside a small one": np.diag([1e-20, -1e-26]),
    "antisymmetric between units": np.array([[1e6, 1e-4], [-1e-4, 1e-6]]),
    "correlation beyond one": np.array([[1e12, 1.1], [1.1, 1e-12]]),
    "covariance with what is known": np.array([[1e6, 1e-9], [1e-9, 0.0]]),
}


def as_argument(function, name, matrix):
    """Return the matrix with as many components as the argument has, and in as many models."""
    shape = np.shape(CALLS[function][name])
    size = shape[-1]
    value = np.eye(size)
    value[: min(size, 2), : min(size, 2)] = matrix[-size:, -size:] if size < 2 else matrix
    return np.broadcast_to(value, shape)


@pytest.mark.parametrize(("function", "name"), with_argument(COVARIANCES), ids=label)
def test_what_is_no_covariance_is_refused_at_any_scale(function, name):
    for matrix in INDEFINITE.values():
        value = as_argument(function, name, matrix)
        if value.shape[-1] < 2 and value.ravel()[0] > 0:
            continue  # of one component only the variance is left
        wanted = rf"^{name} must be (symmetric|positive (semi)?definite), got "
        with pytest.raises(ValueError, match=wanted):
            call(function, **{name: value})


@pytest.mark.parametrize(("function", "name"), with_argument(COVARIANCES), ids=label)
def test_rounding_in_a_covariance_is_taken_in_any_unit(function, name):
    """The second component is in another unit: 1e-10 of the correlation is rounding in all."""
    value = np.array(CALLS[function][name], float)
    # In other units than those of F there is no noise, and a filter that never settles.
    settles = function.__name__ in ("steady_state_gain", "remedy_errors")
    units = (1.0,) if settles else (1e-9, 1.0, 1e9)
    for unit in units if value.shape[-1] > 1 else ():
        scale = np.ones(value.shape[-1])
        scale[1] = unit
        rounded = value * scale * scale[:, None]
        rounded[..., 0, 1] += 1e-10 * np.sqrt(rounded[..., 0, 0] * rounded[..., 1, 1])
        if function.__name__ == "fuse_state_vectors":  # P12 would have to fit
            call(function, P12=None, **{name: rounded})
        else:
            call(function, **{name: rounded})


# ------------------------------------------------------------- what is missing, and when

MISSING = [
    (function, "z")
    for function in EVERY
    if "z" in CALLS[function] and function.__name__ not in ("pda_update", "velocity_given_position")
]


@pytest.mark.parametrize(("function", "name"), MISSING, ids=label)
def test_nan_is_a_measurement_that_is_missing(function, name):
    """Of all filters; an infinite one is refused by all."""
    z = np.array(CALLS[function][name], float)
    z[(0, *[slice(None)] * (z.ndim - 1)) if z.ndim else ()] = np.nan
    call(function, z=z)
    with pytest.raises(ValueError, match=r"^z must be finite, or NaN where .* missing, got inf"):
        call(function, z=np.where(np.isnan(z), np.inf, z))


EMPTY = {
    "pda_update": ("z", [], np.empty((0, 1))),
    "gnn_assign": ("cost", [], [[], []]),
    "greedy_assign": ("cost", [], [[], []]),
    "nearest_neighbor": ("distance", [], [[], []]),
    "track_scans": ("scans", [], [[], np.empty((0, 1)), []]),
}


@pytest.mark.parametrize("function", [f for f in EVERY if f.__name__ in EMPTY], ids=label)
def test_a_scan_without_detections_is_one(function):
    name, *values = EMPTY[function.__name__]
    for value in values:
        call(function, **{name: value, "accept": None})


# --------------------------------------------------------------------- words of errors


def test_two_sensors_that_say_the_same_and_hardly_err_are_refused_by_name():
    same, R = np.ones((2, 2)), 1e-20 * np.eye(2)
    changed = {"H": same, "R": R}
    functions = {
        linear_kalman.kf_update: changed | {"z": [1.0, 1.0]},
        linear_kalman.kf: changed | {"z": [[1.0, 1.0]] * 2},
        imm.imm: {"z": [[1.0, 1.0]] * 2, "models": [ImmModel(np.eye(2), np.eye(2), same, R)] * 2},
        nonlinear_kalman.ekf_records: {"z": [[1.0, 1.0]] * 2, "R": R} | of_state(same),
        nonlinear_kalman.ukf: {"z": [[1.0, 1.0]] * 2, "R": R, "h": lambda x: x @ same},
        robust_kalman.robust_ekf: {"z": [[1.0, 1.0]] * 2, "R": R} | of_state(same),
        extended_update.ekf_update: {"z": [1.0, 1.0], "R": R} | of_state(same),
        pda.pda_update: changed | {"z": [[1.0, 1.0]]},
        multi_target.track_scans: {
            "scans": [[[1.0, 1.0]]] * 2,
            "R": R,
            "start": lambda z: (z, [np.eye(2)]),
        }
        | of_state(same),
    }
    # A settled filter is as sure as its measurements, and a larger model measures nothing yet.
    takes = {f for f in EVERY if "R" in CALLS[f]} - {steady_state.steady_state_gain}
    takes -= {colored_errors.augment_linear, colored_errors.augment_functions}
    takes -= {online.ekf_records_online, online.ukf_online}  # nothing is measured yet
    assert functions.keys() == takes | {imm.imm}
    for function, arguments in functions.items():
        message = "^R must make H P H' [+] R positive definite, got a smallest eigenvalue of"
        with pytest.raises(ValueError, match=message):
            call(function, **arguments)


def of_state(H):
    return {"h": lambda x: x @ H.T, "H": lambda x: H}


MEANT = (
    "bilaterate",
    "ml_initialize",
    "ekf",
    "gate_bounds",
    "gaussian_sum",
    "importance_posterior",
    "gaussian_sum_online",
    "ekf_online",
    "ekf_records_online",
    "ukf_online",
    "imm_online",
)  # NaN and infinity mean something there
HUGE = [1e155, 1e200, 1e308]


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(("function", "name"), NUMBERS, ids=label)
def test_what_is_too_large_or_too_small_for_a_float_gives_numbers_or_a_named_error(function, name):
    """Also where NumPy is set to raise, and without a warning."""
    value = CALLS[function][name]
    for factor in (1e-308, 1e-200, 1e-150, *HUGE):
        with np.errstate(all="raise"):
            changed = scaled(value, factor)
            try:
                got = call(function, **{name: changed})
            except ValueError as error:
                assert " must " in str(error) and "got " in str(error)
                continue
        if function.__name__ not in MEANT:
            assert all(np.isfinite(a).all() for a in results(got) if a.dtype.kind == "f")


def scaled(value, factor):
    with np.errstate(all="ignore"):
        value = np.asarray(value, float) * factor
    return np.where(np.isfinite(value), value, 1e308)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("function", EVERY, ids=label)
def test_numpy_set_to_raise_changes_no_result(function):
    expected = results(call(function))
    with np.errstate(all="raise"):
        for got, want in zip(results(call(function)), expected, strict=True):
            np.testing.assert_array_equal(got, want)


@pytest.mark.parametrize("value", [None, 3, "f", np.eye(2)])
@pytest.mark.parametrize(
    ("function", "name"),
    [
        (f, name)
        for f in EVERY
        for name in ("h", "H", "start", "assign")
        if callable_argument(f, name)
    ],
    ids=label,
)
def test_what_is_no_function_is_refused(function, name, value):
    with pytest.raises(ValueError, match=rf"^{name} must be a function, got "):
        function(**CALLS[function] | {name: value})
