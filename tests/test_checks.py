"""Every error names the argument, its value and what was expected."""

import datetime
from fractions import Fraction

import numpy as np
import pytest

from dopplerlib import RadarArray, _checks, chi2_interval, constant_velocity, doppler_shift

BAD = [
    # check, further arguments, value, the value as the message gives it, what was expected
    (_checks.real, (), "1.5", "'1.5'", "real numbers"),
    (_checks.real, (), ["1", "2"], "['1', '2']", "real numbers"),
    (_checks.real, (), None, "None", "real numbers"),
    (_checks.real, (), [1.0, None], "[1.0, None]", "real numbers"),
    (_checks.real, (), True, "True", "real numbers"),
    (_checks.real, (), 1j, "1j", "real numbers"),
    (_checks.real, (), [[1, 2], [3]], "[[1, 2], [3]]", "real numbers"),
    (_checks.real, (), np.array(["2020-01-01"], "M8[D]"), "2020-01-01", "real numbers"),
    (_checks.real, (), [datetime.date(2020, 1, 1)], "2020", "real numbers"),
    (_checks.real, (), [Fraction(1, 3)], "Fraction(1, 3)", "real numbers"),
    (_checks.real, (), 10**400, "1000", "real numbers"),
    (_checks.real, (), {"a": 1}, "{'a': 1}", "real numbers"),
    (_checks.real, (), np.ma.masked_less([-1.0, 2.0], 0), "masked_array", "mask"),
    (_checks.finite, (), [1.0, np.nan], "nan at index (1,)", "finite"),
    (_checks.finite, (), -np.inf, "-inf", "finite"),
    (_checks.finite, ((6,),), np.zeros(5), "(5,)", "(..., 6)"),
    (_checks.finite, ((6, 6),), np.zeros(6), "(6,)", "(..., 6, 6)"),
    (_checks.finite, ((None, 3),), np.zeros((2, 4)), "(2, 4)", "(..., any, 3)"),
    (_checks.finite_complex, (), [1j, np.nan], "nan", "finite"),
    (_checks.finite_complex, (), "1j", "'1j'", "numbers"),
    (_checks.finite_complex, (), [[1j, 2], [3]], "[[1j, 2], [3]]", "numbers"),
    (_checks.finite_complex, (), np.ma.masked_equal([1j, 2], 2), "masked_array", "mask"),
    (_checks.finite_complex, ((None, 3),), np.zeros(3, complex), "(3,)", "(..., any, 3)"),
    (_checks.increasing_pair, (), (2, 1), "(2, 1)", "smaller one first"),
    (_checks.increasing_pair, (), (1, 1), "(1, 1)", "smaller one first"),
    (_checks.increasing_pair, (), (1, 2, 3), "(3,)", "(..., 2)"),
    (_checks.increasing_pair, (), 5.0, "()", "(..., 2)"),
    (_checks.matrix, ((2, 2),), np.zeros((1, 2, 2)), "(1, 2, 2)", "one matrix"),
    (_checks.positive, (), 0, "0.0", "positive"),
    (_checks.positive, (), [1, -2], "-2.0 at index (1,)", "positive"),
    (_checks.deviation, (), 1e-200, "1e-200", "square"),
    (_checks.deviation, (), 1e200, "1e+200", "square"),
    (_checks.positive_number, (), [1.0], "(1,)", "one number"),
    (_checks.positive_number, (), np.nan, "nan", "finite"),
    (_checks.whole_number, (), 0, "0", "at least 1"),
    (_checks.whole_number, (), 1.0, "1.0", "whole number"),
    (_checks.whole_number, (), True, "True", "whole number"),
    (_checks.whole_number, (), "3", "'3'", "whole number"),
    (_checks.whole_number, (), 10**400, "1000", "whole number"),
    (_checks.whole_number, (2,), 1, "1", "at least 2"),
    (_checks.one_of, (("a", None),), "b", "'b'", "one of 'a', None"),
    (_checks.one_of, (("a", "b"),), ["a"], "['a']", "one of 'a', 'b'"),
    (_checks.one_of, (("a", "b"),), np.array(["a", "b"]), "array", "one of 'a', 'b'"),
    (_checks.some_of, (("a", "b"),), "ab", "'ab'", "collection of 'a', 'b'"),
    (_checks.some_of, (("a", "b"),), None, "None", "collection of 'a', 'b'"),
    (_checks.some_of, (("a", "b"),), ["a", "c"], "'c'", "one of 'a', 'b'"),
    (_checks.instance, (RadarArray,), "ring", "'ring'", "RadarArray"),
    (_checks.probability, (), 0, "0.0", "between 0 and 1"),
    (_checks.probability, (), 1, "1.0", "between 0 and 1"),
    (_checks.probability, (), "half", "'half'", "real numbers"),
    (_checks.covariance, (2,), [[1, 0.1], [0, 1]], "0.1", "symmetric"),
    (_checks.covariance, (2,), [[1, 0], [0, 0]], "0", "positive definite"),
    (_checks.covariance, (2,), [[1, 2], [2, 1]], "-1", "positive definite"),
    (_checks.covariance, (2, False), [[1, 2], [2, 1]], "-1", "positive semidefinite"),
    (_checks.covariance, (2,), [1, 1], "(2,)", "(..., 2, 2)"),
    (_checks.generator, (), 1, "1", "numpy.random.Generator"),
    (_checks.each_run, ((2,), (6,)), np.zeros((3, 6)), "(3,)", "broadcast against the runs (2,)"),
]


@pytest.mark.parametrize(("check", "more", "value", "got", "expected"), BAD)
def test_error_names_argument_value_and_expectation(check, more, value, got, expected):
    with pytest.raises(ValueError, match=r"^speed must ") as raised:
        check("speed", value, *more)
    before, _, after = str(raised.value).partition("got ")
    assert expected in before
    assert got in after


GOOD = [
    (_checks.finite, (), [1, 2]),
    (_checks.finite, ((None, 2),), np.zeros((3, 0, 2))),
    (_checks.finite, (), np.float32(1.5)),
    (_checks.positive, (), np.ones((2, 3), np.uint8)),
    (_checks.whole_number, (), np.int32(4)),
    (_checks.one_of, (("a", None),), None),
    (_checks.some_of, (("a", "b"),), ()),
    (_checks.probability, (), np.float64(0.5)),
    (_checks.covariance, (2, False), [[0, 0], [0, 1]]),
    (_checks.covariance, (2,), [[1, 0.3 + 1e-16], [0.3, 1]]),
    # What an update in the form of Joseph may leave, from one linear-algebra library to another.
    (_checks.covariance, (2,), [[1, 0.3 + 1e-11], [0.3, 1]]),
    (_checks.covariance, (2, False), [[1, 1 + 1e-11], [1, 1]]),
]


@pytest.mark.parametrize(("check", "more", "value"), GOOD)
def test_what_is_right_comes_back_unchanged(check, more, value):
    np.testing.assert_array_equal(check("speed", value, *more), value)


def test_one_asymmetric_matrix_is_not_hidden_by_a_large_one():
    small = np.array([[1, 1e-8], [0, 1]])
    with pytest.raises(ValueError, match=r"P0 must be symmetric, got a difference of 1e-08"):
        _checks.covariance("P0", np.stack([1e6 * np.eye(2), small]), 2)


def test_a_long_value_is_cut():
    with pytest.raises(ValueError, match=r"\.\.\.$") as raised:
        _checks.real("z", ["text"] * 10**5)
    assert len(str(raised.value)) < 200


SETTINGS = [
    (lambda: constant_velocity(0, 0.4), "T must be positive, got 0.0"),
    (lambda: constant_velocity(1e100, 0.4), "T must give a finite Q"),
    (lambda: constant_velocity(1e300, 0.4), "T must be a number whose square"),
    (lambda: constant_velocity(1e-3, 1e200), "sigma_a must be a number whose square"),
    (lambda: constant_velocity(1e-3, [0.4, 0.4]), "sigma_a must be one number"),
    (lambda: constant_velocity(1e-3, 0.4, "white"), "noise must be one of 'shared'"),
    (lambda: doppler_shift(np.ones(6), np.zeros((6, 3))), "array must be a RadarArray"),
    (lambda: chi2_interval(10**400), "dof must be a whole number"),
]


@pytest.mark.parametrize(("call", "message"), SETTINGS)
def test_public_functions_use_the_checks(call, message):
    with pytest.raises(ValueError, match="^" + message):
        call()
