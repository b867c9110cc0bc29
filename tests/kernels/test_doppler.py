"""The printed Doppler shift and its gradient against two derivations that share nothing with them.

A complex step differentiates the printed shift itself; the closed vector form is typed anew with
NumPy vectors. 200 examples of 50 states each, of 1 to 12 sensors: 10 000 states.
"""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from dopplerlib import RadarArray, doppler_jacobian
from dopplerlib.kernels.doppler import doppler_shift, doppler_shift_and_gradient

STATES = 50
EXAMPLES = settings(max_examples=200, derandomize=True, deadline=None)

# An entry comes out of some twenty operations, each right to half a unit in the last place, which
# is 1.1e-16. None of them is amplified, if the error is measured against the *scale* of the entry:
# g for a derivative by velocity and g |v| / rho for one by position, with g = 2 / lambda. The entry
# itself can be far smaller: it is v minus its part along the line of sight, and for a target that
# flies straight at the sensor nothing but rounding is left. 1e-14 is twenty such errors in each of
# the two that are compared, and room for twice that; a wrong sign or factor shows as 1.
TOLERANCE = 1e-14


@st.composite
def scenes(draw):
    """Draw states (STATES, 1, 6), sensors (N, 3) and g, near and far, slow and fast."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    sensors = rng.normal(size=(draw(st.integers(1, 12)), 3)) * 10 ** draw(st.floats(-2, 1))
    distance = 10 ** draw(st.floats(-3, 4))
    speed = 10 ** draw(st.floats(-4, 3))
    # The angle between line of sight and velocity: 0 is head on, where the most cancels.
    angle = draw(st.sampled_from([0.0, 1e-8, 1e-3, np.pi / 2, np.pi])) + draw(
        st.sampled_from([0.0, 1.0])
    ) * rng.uniform(0, np.pi, STATES)
    radial, other = rng.normal(size=(2, STATES, 3))
    radial /= np.linalg.norm(radial, axis=-1, keepdims=True)
    across = np.cross(radial, other)
    across /= np.linalg.norm(across, axis=-1, keepdims=True)
    angle = np.broadcast_to(angle, STATES)[:, None]
    position = sensors[0] - distance * radial  # `distance` away from the first sensor
    velocity = speed * (np.cos(angle) * radial + np.sin(angle) * across)
    g = 2 / 10 ** draw(st.floats(-3, 0))
    return np.concatenate([position, velocity], axis=-1)[:, None, :], sensors, g


def kernel(function, x, sensors, g):
    return function(*np.moveaxis(x, -1, 0), *sensors.T, g)


def scales(x, sensors, g):
    """Return the size of shift, (..., N), and gradient, (..., N, 6), before anything cancels."""
    rho = np.linalg.norm(sensors - x[..., :3], axis=-1)
    speed = np.linalg.norm(x[..., 3:], axis=-1)
    gradient = np.empty((*rho.shape, 6))
    gradient[..., :3] = (g * speed / rho)[..., None]
    gradient[..., 3:] = g
    return np.broadcast_to(g * speed, rho.shape), gradient


def closed_form(x, sensors, g):
    """Return shift, (..., N), and gradient, (..., N, 6), in vectors."""
    p, v = x[..., :3], x[..., 3:]
    rho = np.linalg.norm(sensors - p, axis=-1, keepdims=True)
    u = (sensors - p) / rho
    radial = np.sum(u * v, axis=-1, keepdims=True)
    return g * radial[..., 0], np.concatenate([g / rho * (radial * u - v), g * u], axis=-1)


@EXAMPLES
@given(scenes())
def test_shift_and_gradient_are_the_closed_vector_form(scene):
    shift, *gradient = kernel(doppler_shift_and_gradient, *scene)
    expected_shift, expected_gradient = closed_form(*scene)
    shift_scale, gradient_scale = scales(*scene)
    assert (np.abs(shift - expected_shift) <= TOLERANCE * shift_scale).all()
    error = np.abs(np.stack(gradient, axis=-1) - expected_gradient)
    assert (error <= TOLERANCE * gradient_scale).all()


@EXAMPLES
@given(scenes())
def test_the_gradient_is_a_complex_step_of_the_shift(scene):
    # The imaginary part of f(x + i h) is h f'(x) and terms of h^3, which are nothing at h = 1e-100:
    # no difference is formed, so the step costs no digits (Squire and Trapp 1998).
    x, sensors, g = scene
    _, *gradient = kernel(doppler_shift_and_gradient, *scene)
    _, scale = scales(*scene)
    step = 1e-100
    for i in range(6):
        stepped = x.astype(complex)
        stepped[..., i] += 1j * step
        expected = kernel(doppler_shift, stepped, sensors, g).imag / step
        assert (np.abs(gradient[i] - expected) <= TOLERANCE * scale[..., i]).all()


@EXAMPLES
@given(scenes())
def test_the_shift_alone_and_with_its_gradient_is_the_same_number(scene):
    # The simulation uses one, the filter the other: the innovation of a perfect state is zero.
    shift, *_ = kernel(doppler_shift_and_gradient, *scene)
    assert np.array_equal(kernel(doppler_shift, *scene), shift)


@EXAMPLES
@given(scenes())
def test_scaling_lengths_speeds_and_wavelength_scales_shift_and_gradient(scene):
    # By powers of two, so that nothing is rounded and the results are equal to the last bit.
    x, sensors, g = scene
    length, speed, factor = 4.0, 0.5, 8.0
    shift, *gradient = kernel(doppler_shift_and_gradient, *scene)
    grown = x * np.repeat([length, speed], 3)
    scaled, *scaled_gradient = kernel(
        doppler_shift_and_gradient, grown, length * sensors, factor * g
    )
    assert np.array_equal(scaled, factor * speed * shift)
    for i in range(6):
        by = factor * speed / length if i < 3 else factor
        assert np.array_equal(scaled_gradient[i], by * gradient[i])


@settings(max_examples=50, derandomize=True, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 12))
@example(1, 1)
def test_the_public_jacobian_hands_the_kernel_its_arguments_in_order(seed, n):
    rng = np.random.default_rng(seed)
    array = RadarArray(rng.normal(size=(n, 3)), 0.0125)
    x = rng.normal(size=(4, 7, 6))
    _, expected = closed_form(x[..., None, :], array.positions, 160.0)
    _, scale = scales(x[..., None, :], array.positions, 160.0)
    H = doppler_jacobian(x, array)
    assert H.shape == (4, 7, n, 6)
    assert (np.abs(H - expected) <= TOLERANCE * scale).all()


def test_a_head_on_target_has_no_gradient_by_position_but_for_rounding():
    x = (3.0, 0.0, 0.0, -2.0, 0.0, 0.0)
    shift, *gradient = doppler_shift_and_gradient(*x, 0.0, 0.0, 0.0, 160.0)
    assert shift == 320.0
    assert gradient == pytest.approx([0.0, 0.0, 0.0, -160.0, 0.0, 0.0], abs=1e-13)
