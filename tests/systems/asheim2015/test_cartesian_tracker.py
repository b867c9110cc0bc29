"""The gate and the angle of the filters in the plane."""

from dataclasses import replace

import numpy as np
import pytest

from dopplerlib.model.motion import cwna_process_noise, ncv_transition
from dopplerlib.model.range_rate import range_rate, range_rate_jacobian
from dopplerlib.systems import asheim2015 as thesis
from tests.gate_edges import beside_the_gate

TIME = np.array([0.0, 0.1])
START = np.array([0.3, 2.0, 0.1, -0.2])


def records(z):
    sensors = thesis.radar_positions()
    states = np.tile(START, (2, 1))
    ranges = np.moveaxis(range_rate(states, sensors), 0, 1)
    return thesis.RadarRecords(TIME, states, sensors, ranges, z[None], 0.0)


@pytest.mark.parametrize("radar", [0, 1])
@pytest.mark.parametrize("probability", [0.9, 0.999])
def test_the_gate_ends_at_the_quantile_for_range_and_range_rate(radar, probability):
    """Four states, two components; the other radar sees nothing."""
    own = replace(thesis.filter_settings("modern"), gate_probability=probability)
    F = ncv_transition(0.1, dim=2, order="derivative")
    Q = cwna_process_noise(0.1, own.Q[1, 1] / own.T, dim=2, order="derivative")
    sensor = thesis.radar_positions()[radar : radar + 1]
    P0 = thesis.reported().scenario.cartesian.start_covariance * np.eye(4)
    predicted = range_rate(F @ START, sensor)[0]
    H = range_rate_jacobian(F @ START, sensor)[0]
    S = H @ (F @ P0 @ F.T + Q) @ H.T + np.diag(own.R(predicted[0]))
    for nu, inside in beside_the_gate(S, probability):
        z = np.full((2, 2, 2), np.nan)
        z[radar, 1] = predicted + nu
        track = thesis.central_filter(records(z), own, start=START)
        assert track.updated[0, radar, 1] == inside


def test_an_angle_is_measured_around_the_circle():
    """Behind the radars, near the negative x axis, where the angle jumps by a full turn.

    Circles that meet always give a point in front; so the state is behind, and the innovation of
    an angle must be small and not nearly 2 pi: the position stays near, to the start's 0.1 m.
    """
    d = np.hypot(-3.0 - np.array([-0.5, 0.5]), 0.05)
    z = np.zeros((2, 2, 2))
    z[:, :, 0] = d[:, None]
    behind = np.array([-3.0, -0.05, 0.0, 0.0])
    track = thesis.table_3_2(records(z), start=behind)
    assert np.hypot(*(track.p[0, 1] - behind[:2])) < 0.1
