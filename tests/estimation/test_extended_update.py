"""The general EKF update is `kf_update` where the model is linear."""

import numpy as np
import pytest

from dopplerlib import kf_update, nis
from dopplerlib.estimation.extended_update import ekf_update
from dopplerlib.model.polar_radar import polar_radar_h, polar_radar_jacobian

RNG = np.random.default_rng(12)
n, m, runs = 4, 3, 5
LINEAR = RNG.normal(size=(m, n))
ROOT = RNG.normal(size=(n, n))
P = ROOT @ ROOT.T
R = np.diag([0.2, 0.5, 1.0])
x, z = RNG.normal(size=(runs, n)), RNG.normal(size=(runs, m))


def linear_h(x):
    return x @ LINEAR.T


def linear_H(x):
    return LINEAR


def test_it_is_the_linear_update_for_a_linear_measurement():
    for got, want in zip(
        ekf_update(x, P, z, linear_h, linear_H, R), kf_update(x, P, z, LINEAR, R), strict=True
    ):
        np.testing.assert_allclose(got, np.broadcast_to(want, got.shape), rtol=1e-11, atol=1e-12)


def test_refused_and_missing_measurements_leave_the_prediction():
    accept = np.array([True, False, True, True, False])
    holes = z.copy()
    holes[2] = np.nan
    x_new, P_new, innovation, _ = ekf_update(x, P, holes, linear_h, linear_H, R, accept=accept)
    used, left = [0, 3], [1, 2, 4]
    np.testing.assert_array_equal(x_new[left], x[left])
    np.testing.assert_array_equal(P_new[left], np.broadcast_to(P, (3, n, n)))
    whole = ekf_update(x, P, z, linear_h, linear_H, R)
    np.testing.assert_array_equal(x_new[used], whole[0][used])
    assert np.isnan(innovation[2]).all() and np.isfinite(innovation[1]).all()


def test_a_component_that_is_missing_is_a_row_that_is_missing():
    holes = z.copy()
    holes[1, 0] = holes[2, 1:] = np.nan
    got = ekf_update(x, P, holes, linear_h, linear_H, R)
    for run in range(runs):
        row = ~np.isnan(holes[run])
        want = kf_update(x[run], P, z[run, row], LINEAR[row], R[row][:, row])
        np.testing.assert_allclose(got[0][run], want[0], rtol=1e-11, atol=1e-12)
        np.testing.assert_allclose(got[1][run], want[1], rtol=1e-11, atol=1e-12)
    np.testing.assert_array_equal(np.isnan(got[2]), np.isnan(holes))
    np.testing.assert_allclose(got[3], LINEAR @ P @ LINEAR.T + R, rtol=1e-11)


def test_an_angle_that_wraps_is_the_angle_next_to_it():
    """A target behind the radar, on either side of the cut at 180 degrees."""
    target = np.array([0.01, 0.0, -5.0, 1.0])
    prior = target + np.array([0.1, 0.1, -0.1, 0.1])
    R = np.diag([0.1**2, 0.02**2, 0.1**2])
    seen = polar_radar_h(target)
    results = [
        ekf_update(
            prior,
            np.eye(4),
            seen + np.array([0, turn, 0]),
            polar_radar_h,
            polar_radar_jacobian,
            R,
            (1,),
        )
        for turn in (0, 2 * np.pi, -2 * np.pi)
    ]
    for other in results[1:]:
        np.testing.assert_allclose(other[0], results[0][0], rtol=1e-9)
    assert abs(results[0][2][1]) < 0.1


def test_polar_updates_are_consistent_where_the_tangent_is_the_curve():
    """False-alarm probability 1.2e-6: two means, each within five of its deviations."""
    target = np.array([2.0, 1.0, 6.0, -1.0])
    R = np.diag([0.05**2, 0.01**2, 0.05**2])
    deviation = 0.01  # so small that the tangent is the curve
    rng = np.random.default_rng(13)
    many = 20_000
    prior = target + rng.normal(size=(many, 4)) * deviation
    noise = rng.normal(size=(many, 3)) * np.sqrt(np.diag(R))
    seen = polar_radar_h(target) + noise
    x, P, innovation, S = ekf_update(
        prior, deviation**2 * np.eye(4), seen, polar_radar_h, polar_radar_jacobian, R, (1,)
    )
    # The variance of a chi-square value is twice its degrees of freedom.
    assert nis(innovation, S).mean() == pytest.approx(3, abs=5 * np.sqrt(6 / many))
    error = x - target
    nees = np.sum(error * np.linalg.solve(P, error[..., None])[..., 0], axis=-1)
    assert nees.mean() == pytest.approx(4, abs=5 * np.sqrt(8 / many))


def test_leading_axes_of_accept_are_checked_like_the_others():
    accept = np.ones(runs + 1, bool)
    with pytest.raises(ValueError, match=r"^x, P, z, R, accept must .* \(6,\) of accept"):
        ekf_update(x, P, z, linear_h, linear_H, R, accept=accept)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("x", np.full(n, np.nan)),
        ("P", -np.eye(n)),
        ("z", np.full(m, np.inf)),
        ("R", np.zeros((m, m))),
        ("h(x)", lambda x: x),
        ("H(x)", lambda x: np.eye(n)),
        ("accept", np.ones(runs)),
        ("wrap", (m,)),
        ("wrap", (-1,)),
    ],
)
def test_bad_input_is_named(name, value):
    key = name.removesuffix("(x)")
    arguments = {"x": x, "P": P, "z": z, "h": linear_h, "H": linear_H, "R": R, "accept": None}
    with pytest.raises(ValueError) as raised:
        ekf_update(**(arguments | {key: value}))
    assert str(raised.value).startswith(f"{name} must ")


def test_functions_that_do_not_fit_are_refused_and_their_own_errors_come_through():
    arguments = {"x": x, "P": P, "z": z, "h": linear_h, "H": linear_H, "R": R}
    with pytest.raises(
        ValueError, match=r"^h must take 1 argument\(s\), got a function with too many"
    ):
        ekf_update(**arguments | {"h": lambda: z})
    with pytest.raises(ValueError, match=r"leading axes that broadcast, got .* \(7,\) of H\(x\)"):
        ekf_update(**arguments | {"H": lambda x: np.stack([LINEAR] * 7)})

    for kind in (int, dict):
        with pytest.raises(ValueError, match=r"^h must take the arrays .*, got <class '"):
            ekf_update(**arguments | {"h": kind})

    def broken(x):
        return x + "text"

    with pytest.raises(TypeError):
        ekf_update(**arguments | {"H": broken})
