"""Departure, usable range and errors are what their definitions say."""

import numpy as np
import pytest
from scipy.stats import bootstrap

from dopplerlib.systems import asheim2015 as thesis


def test_a_departure_is_the_first_long_run_of_misses():
    time = np.arange(30) * 0.1
    updated = np.ones((3, 30), bool)
    updated[0, 5:14] = False  # nine are not enough
    updated[0, 18:28] = False
    updated[1, 20:] = False
    np.testing.assert_allclose(thesis.departure_times(updated, time), [1.8, 2.0, np.inf])


def test_the_usable_range_is_where_the_average_of_all_runs_passes_the_limit():
    """Errors of 2 and 0 m have a root mean square of 1.4 m: they begin at the tenth second."""
    time = np.arange(0, 20, 0.1)
    error = np.zeros((2, len(time)))
    error[0, 100:] = 2.0
    # With ten scans in a window it is above 1 m when 1.41 n / 10 > 1: for n = 8.
    found = thesis.usable_range(error, time, distance=time)
    assert found == pytest.approx(10.0, abs=0.4)
    assert thesis.usable_range(error[1:], time, time) == np.inf
    error[0, :10] = 9.0  # before the search begins
    assert thesis.usable_range(error, time, time) == found


def test_the_error_at_a_time_is_over_runs_and_half_a_second_on_both_sides():
    time = np.arange(0, 3, 0.1)
    error = np.where(np.abs(time - 1.5) <= 0.51, 3.0, 100.0) * np.ones((2, 1))
    error[1] = np.nan
    assert thesis.rmse(error, time, 1.5) == pytest.approx(3.0)


@pytest.fixture(scope="module")
def errors():
    time = np.arange(0, 30, 0.5)
    a = np.random.default_rng(3).normal(size=(50, 60)) * np.linspace(0, 2, 60)
    a[:, ::7] = np.nan  # scans without any estimate of some run
    a[0, ::7] = 1.0
    return time, a, a * 1.2


def drawn(statistic, *arrays):
    """Return value and interval as SciPy finds them; its percentiles lie between two draws."""

    def of(index):
        return statistic(*(array[index] for array in arrays))

    index = np.arange(len(arrays[0]))
    found = bootstrap(
        (index,), of, n_resamples=400, vectorized=False, method="percentile",
        random_state=np.random.default_rng(4),
    ).bootstrap_distribution  # fmt: skip
    return [of(index), *np.percentile(found, [2.5, 97.5], method="lower")]


def test_intervals_are_those_of_drawing_runs_with_replacement(errors):
    """The same draws give the same numbers as computing the statistic on the drawn runs."""
    time, a, b = errors

    def reach(e):
        return min(thesis.usable_range(e, time, time), time[-1])

    def rms(e):
        return thesis.rmse(e, time, 20)

    for found, expected in (
        (thesis.usable_interval(a, time, time, rng=rng()), drawn(reach, a)),
        (
            thesis.usable_ratio(b, a, time, time, rng=rng()),
            drawn(lambda a, b: reach(b) / reach(a), a, b),
        ),
        (thesis.rmse_interval(a, time, 20, rng=rng()), drawn(rms, a)),
        (
            thesis.rmse_ratio(b, a, time, 20, rng=rng()),
            drawn(lambda a, b: rms(b) / rms(a), a, b),
        ),
    ):
        np.testing.assert_allclose([found.value, found.low, found.high], expected, rtol=1e-9)


def rng():
    return np.random.default_rng(4)


def test_the_range_of_each_run_is_that_of_the_run_alone(errors):
    time, a, _ = errors
    each = thesis.usable_range(a[:, None], time, time)
    np.testing.assert_array_equal(each, [thesis.usable_range(e[None], time, time) for e in a])


def test_one_scan_has_no_range_and_a_record_no_less_than_one_interval():
    with pytest.raises(ValueError, match="time must have two scans or more and rise"):
        thesis.usable_range([[1.0]], [0.0], [0.0])
    with pytest.raises(ValueError, match=r"duration must be at least the interval of 0\.1 s"):
        thesis.scan_times(duration=0.04)
