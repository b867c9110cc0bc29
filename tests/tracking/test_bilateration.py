"""Two circles meet where they should, and where they don't it is said."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import least_squares

from dopplerlib.model.range_rate import range_rate
from dopplerlib.tracking.bilateration import bilaterate

PLACE = st.floats(-20, 20), st.floats(0.01, 20), st.floats(0.1, 5)


@given(*PLACE)
def test_the_position_behind_two_ranges_is_found(x, y, b):
    found = bilaterate(np.hypot(x + b / 2, y), np.hypot(x - b / 2, y), b)
    assert found[2]
    # Errors of 1e-15 of the ranges grow with the distance over the baseline and over y.
    d = np.hypot(x, y) + b
    assert found[0] == pytest.approx(x, abs=1e-14 * d * d / b + 1e-12)
    assert found[1] == pytest.approx(y, abs=1e-14 * d**3 / (b * y) + 1e-10)


def test_it_is_the_solution_that_a_general_solver_finds():
    sensors = np.array([[-0.3, 0.0], [0.3, 0.0]])
    ranges = np.array([2.1, 2.3])

    def residual(p):
        return range_rate([*p, 0.0, 0.0], sensors)[:, 0] - ranges

    solution = least_squares(residual, [0.0, 1.0], xtol=1e-14, ftol=1e-14, gtol=1e-14).x
    x, y, valid = bilaterate(*ranges, 0.6)
    assert valid
    np.testing.assert_allclose([x, y], solution, atol=1e-9)


def test_it_is_the_formula_that_the_thesis_prints():
    """Åsheim (2015), Eq 5.8: y is written there with a detour that adds up to the same."""
    rng = np.random.default_rng(3)
    p = rng.uniform(0.5, 4, (50, 2))
    d0 = 0.5
    d1, d2 = np.hypot(p[:, 0] + d0, p[:, 1]), np.hypot(p[:, 0] - d0, p[:, 1])
    x = (d1**2 - d2**2) / (4 * d0)
    y = np.sqrt(d2**2 - d0**2 + (d1**2 - d2**2) / 2 - x**2)
    np.testing.assert_allclose(np.stack(bilaterate(d1, d2, 1.0)[:2]), [x, y], rtol=1e-9)


@given(st.floats(0, 10), st.floats(0, 10), st.floats(0.1, 5))
def test_the_circles_meet_if_three_sides_make_a_triangle(d1, d2, b):
    margins = np.array([d1 + d2 - b, d1 + b - d2, d2 + b - d1])
    x, y, valid = bilaterate(d1, d2, b)
    if np.abs(margins).min() > 1e-9:  # closer than that, rounding decides
        assert valid == (margins > 0).all()
    assert np.isnan(y) == (not valid)
    assert np.isfinite(x)


@pytest.mark.parametrize("b", [0.1, 0.3, 0.7, 1.1])
@pytest.mark.parametrize("steps", [1, 2, 5])
def test_circles_that_hardly_meet_do_so_where_rational_arithmetic_says(b, steps):
    """Ranges a few last digits over half the baseline: their squares would have cancelled."""
    d = b / 2
    for _ in range(steps):
        d = np.nextafter(d, 9)
    x, y, valid = bilaterate(d, d, b)
    square = Fraction(d) ** 2 - Fraction(b) ** 2 / 4
    assert valid and x == 0
    assert y == pytest.approx(np.sqrt(float(square)), rel=1e-14)  # some roundings


def test_a_missing_or_a_negative_range_has_no_position():
    x, y, valid = bilaterate([np.nan, -1.0], [1.0, 1.0], 1.0)
    assert np.isnan(x[0]) and np.isnan(y).all() and not valid.any()


def test_what_does_not_fit_is_refused():
    with pytest.raises(ValueError, match="baseline must be positive"):
        bilaterate(1.0, 1.0, 0.0)
    with pytest.raises(ValueError, match="d1 must have leading axes"):
        bilaterate(np.ones(2), np.ones(3), 1.0)
