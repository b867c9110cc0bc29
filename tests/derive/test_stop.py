"""The distance and its deviation are the norm and u' P u, however they are factored."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from dopplerlib.derive import ekf
from dopplerlib.derive.doppler import STATE
from dopplerlib.derive.printers import python_function
from dopplerlib.derive.stop import POINT, QUANTILE, nearest_block


@settings(max_examples=50, derandomize=True, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_nearest_is_distance_and_quantile_of_its_error(seed):
    rng, program = np.random.default_rng(seed), {"sqrt": np.sqrt}
    exec(python_function(nearest_block()), program)
    U, D = np.triu(rng.normal(size=(6, 6)), 1) + np.eye(6), rng.uniform(0.1, 2, 6)
    position, point, quantile = rng.normal(size=3), rng.normal(size=3), rng.normal()
    values = dict(zip(STATE, [*position, 0, 0, 0], strict=True))
    values |= dict(zip(POINT, point, strict=True)) | {QUANTILE: quantile}
    factors = [D[i] if i == j else U[i, j] for i, j in ekf.UPPER]
    values |= dict(zip(ekf.FACTORS, factors, strict=True))
    got = program["nearest"](*(values[symbol] for symbol in nearest_block().inputs))
    away = position - point
    length = np.linalg.norm(away)
    P = (U * D @ U.T)[:3, :3]
    std = np.sqrt(away @ P @ away) / length
    # Some thirty roundings, of sums in which little cancels.
    assert np.allclose(got, [length, std, length + quantile * std], rtol=1e-12, atol=1e-12)
