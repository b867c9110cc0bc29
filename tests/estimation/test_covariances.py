"""Roots, squares and solutions of covariances, regular and singular, against their definitions."""

import numpy as np

from dopplerlib.estimation import covariances

n = 4
RNG = np.random.default_rng(23)
F = RNG.standard_normal((n, n))
P = F @ F.T + 0.1 * np.eye(n)


def singular(*values):
    turn = np.linalg.qr(RNG.standard_normal((n, n)))[0]
    tilted = turn @ np.diag(values) @ turn.T
    return (tilted + tilted.T) / 2


def test_a_square_is_symmetric_whatever_rounding_the_noise_has_across_the_diagonal():
    lopsided = P + 1e-10 * np.triu(np.ones((n, n)), 1)
    for square in (covariances.squared(F), covariances.squared(F, lopsided)):
        np.testing.assert_array_equal(square, square.mT)


def test_a_square_root_is_one_also_of_what_is_singular():
    flat = P.copy()
    flat[1] = flat[:, 1] = 0
    tilted = singular(3.0, 1.0, 0.0, 0.0)
    for matrix in (P, flat, tilted, np.zeros((n, n)), np.stack([P, flat])):
        root = covariances.square_root(matrix)
        np.testing.assert_allclose(root @ root.mT, matrix, rtol=0, atol=1e-14 * 50)
    assert (covariances.square_root(flat)[1] == 0).all()  # known exactly stays known exactly


def test_solving_with_a_singular_matrix_solves_what_can_be_solved():
    flat = singular(3.0, 1.0, 0.5, 0.0)
    b = flat @ RNG.standard_normal((n, 2))
    solution = covariances.solve(flat, b)
    np.testing.assert_allclose(flat @ solution, b, rtol=0, atol=1e-13)
    units = np.diag([1.0, 1e-6, 1e3, 1e6])
    scaled = covariances.solve(units @ flat @ units, units @ b)
    np.testing.assert_allclose(units @ scaled, solution, rtol=0, atol=1e-12)


def test_solving_with_a_regular_matrix_is_its_inverse():
    # Rounding times the condition number: a smallest eigenvalue of 0.1 and a largest below 100.
    inverse = covariances.solve(P, np.eye(n))
    np.testing.assert_allclose(inverse, np.linalg.inv(P), rtol=0, atol=1e-10)
