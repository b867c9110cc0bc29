"""Five coefficients of a ring's snapshot, in symbols."""

import numpy as np
import pytest
import sympy as sp

from dopplerlib.derive import ring, snapshot

VALUES = dict(zip(ring.INVARIANTS, (0.75, 0.11, 0.09, -0.64, -0.125, -0.02), strict=True))


@pytest.fixture(scope="module")
def harmonics():
    return snapshot.ring_harmonics()


def test_the_coefficients_give_the_gradient_anywhere_on_the_circle(harmonics):
    values = VALUES | {ring.RADIUS: 0.2, ring.WAVELENGTH: 0.0125}
    C = np.array(harmonics.subs(values), float)
    shift = ring.shift_on_circle()
    for angle in (0.3, 2.0, 4.5):
        at = values | {ring.ANGLE: angle}
        gradient = np.array([float(sp.diff(shift, q).subs(at)) for q in ring.INVARIANTS])
        A, y, z = (VALUES[q] for q in ring.INVARIANTS[:3])
        square = A - 2 * 0.2 * (np.cos(angle) * y + np.sin(angle) * z)
        row = [1, np.cos(angle), np.sin(angle), np.cos(2 * angle), np.sin(2 * angle)] @ C
        # A dozen roundings.
        np.testing.assert_allclose(row, gradient * 0.0125 * square**1.5, rtol=1e-12, atol=1e-15)


def test_the_family_is_all_that_the_coefficients_miss(harmonics):
    assert snapshot.rank(harmonics) == 5
    assert snapshot.prove_harmonics_miss_the_family() == sp.zeros(5, 1)
    # The proof would be empty if any direction were missed.
    assert harmonics @ sp.Matrix([1, 0, 0, 0, 0, 0]) != sp.zeros(5, 1)


def test_shifts_in_proportion_to_ranges_leave_three_directions(harmonics):
    A, y, z, w, v_y, v_z = ring.INVARIANTS
    k = sp.Symbol("k")
    state = {w: -k * A, v_y: -2 * k * y, v_z: -2 * k * z}
    assert snapshot.rank(harmonics.subs(state, simultaneous=True)) == 3
