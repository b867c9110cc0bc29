"""Nearly constant velocity and acceleration are white noise behind integrators."""

import numpy as np
import pytest
from scipy.linalg import expm

from dopplerlib.model.motion import (
    cwna_process_noise,
    cwnj_process_noise,
    nca_transition,
    ncv_transition,
)

T, q = 0.3, 0.7
FAMILIES = [(2, ncv_transition, cwna_process_noise), (3, nca_transition, cwnj_process_noise)]


def van_loan(n):
    """Return F and Q of n integrators from one matrix exponential (Van Loan 1978)."""
    A = np.eye(n, k=1)
    noise = np.zeros((n, n))
    noise[-1, -1] = q
    block = expm(T * np.block([[-A, noise], [np.zeros((n, n)), A.T]]))
    F = block[n:, n:].T
    return F, F @ block[:n, n:]


@pytest.mark.parametrize(("n", "transition", "noise"), FAMILIES)
def test_one_axis_is_the_exponential_of_the_integrators(n, transition, noise):
    F, Q = van_loan(n)
    np.testing.assert_allclose(transition(T, dim=1), F, rtol=1e-12, atol=1e-15)
    np.testing.assert_allclose(noise(T, q, dim=1), Q, rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize(("n", "transition", "noise"), FAMILIES)
@pytest.mark.parametrize("order", ["axis", "derivative"])
def test_two_steps_are_one_of_twice_the_length(n, transition, noise, order):
    """True of noise that is white in time; the noise of Macaveiu's Eq 3 does not have it."""
    F, Q = transition(T, 2, order), noise(T, q, 2, order)
    np.testing.assert_allclose(F @ F, transition(2 * T, 2, order), rtol=1e-12, atol=1e-15)
    np.testing.assert_allclose(F @ Q @ F.T + Q, noise(2 * T, q, 2, order), rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize(("n", "transition", "noise"), FAMILIES)
@pytest.mark.parametrize("order", ["axis", "derivative"])
def test_in_no_time_nothing_moves_and_nothing_becomes_uncertain(n, transition, noise, order):
    np.testing.assert_array_equal(transition(0, 2, order), np.eye(2 * n))
    np.testing.assert_array_equal(noise(0.0, q, 2, order), np.zeros((2 * n, 2 * n)))


@pytest.mark.parametrize("n", [2, 3])
def test_the_orders_hold_the_same_numbers_at_other_places(n):
    transition, noise = {2: FAMILIES[0][1:], 3: FAMILIES[1][1:]}[n]
    dim = 2
    places = np.arange(n * dim).reshape(dim, n).T.ravel()  # of [x, y, v_x, ...] in [x, v_x, ...]
    for make in (lambda order: transition(T, dim, order), lambda order: noise(T, q, dim, order)):
        np.testing.assert_array_equal(make("derivative"), make("axis")[np.ix_(places, places)])


@pytest.mark.parametrize(
    ("function", "arguments", "name"),
    [
        (ncv_transition, (-1e-9,), "T"),
        (ncv_transition, (T, 0), "dim"),
        (ncv_transition, (T, 2, "blocks"), "order"),
        (nca_transition, (-1.0,), "T"),
        (cwna_process_noise, (T, -1.0), "q"),
        (cwna_process_noise, (-1.0, 1.0), "T"),
        (cwnj_process_noise, (np.nan, 1.0), "T"),
        (cwnj_process_noise, ([T, -T], 1.0), "T"),
    ],
)
def test_an_impossible_setting_is_refused_by_name(function, arguments, name):
    with pytest.raises(ValueError, match=rf"^{name} must "):
        function(*arguments)


@pytest.mark.parametrize("order", ["axis", "derivative"])
def test_many_intervals_come_at_once(order):
    T = np.array([[0.0, 0.1], [0.7, 2.0]])
    for function, rest in (
        (ncv_transition, ()), (nca_transition, ()), (cwna_process_noise, (0.3,)),
        (cwnj_process_noise, (0.3,)),
    ):  # fmt: skip
        many = function(T, *rest, dim=3, order=order)
        for i in np.ndindex(T.shape):
            one = function(float(T[i]), *rest, dim=3, order=order)
            np.testing.assert_allclose(many[i], one, rtol=1e-15)
