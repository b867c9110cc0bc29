"""Errors that are correlated in time, made white."""

import numpy as np
import pytest
from scipy.linalg import toeplitz

from dopplerlib.estimation.whitening import whitening_matrices


def test_what_is_there_becomes_white_and_nothing_else_is_touched():
    correlation, there = [1, 0.5, 0.1], np.ones((6, 2), bool)
    there[[1, 4], 1] = False
    W = whitening_matrices(correlation, there)
    C = toeplitz([1, 0.5, 0.1, 0, 0, 0])
    np.testing.assert_allclose(W[0] @ C @ W[0].T, np.eye(6), atol=1e-14)
    np.testing.assert_allclose(W[1] @ C @ W[1].T, np.diag(there[:, 1]), atol=1e-14)
    assert not W[1][:, ~there[:, 1]].any()


@pytest.mark.parametrize(
    ("correlation", "message"),
    [([0.9], "begin with 1"), ([1, 0.9], "be that of some errors"), ([[1]], "have one axis")],
)
def test_what_is_no_correlation_is_refused(correlation, message):
    with pytest.raises(ValueError, match=f"correlation must {message}"):
        whitening_matrices(correlation, np.ones((5, 1), bool))
