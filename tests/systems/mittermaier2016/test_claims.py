"""What claims of the paper rest on, where no other test has it."""

import numpy as np
import pytest

from dopplerlib import RadarArray, constant_velocity, crlb
from dopplerlib.replication.documents import read_document
from dopplerlib.systems import mittermaier2016 as paper

CLAIMS = read_document("mittermaier2016").claims


def test_every_part_of_the_paper_has_claims():
    told = " ".join(claim.where for claim in CLAIMS)
    for part in ("Section 2", "Section 3", "Section 4", "Eq 10", "Table 1", "Table 2"):
        assert part in told
    for figure in (3, 4, 5, 6):
        assert f"Fig {figure}" in told


def test_what_the_paper_quotes_is_what_is_judged():
    """The numbers of claims.toml and of table2.toml were typed independently."""
    quoted, published = paper.reported().quoted, {c.id: c.published for c in CLAIMS}
    assert published["nis-average"] == published["nis-average-drawn"] == quoted.nis_avg
    assert published["nis-inside"] == pytest.approx(100 * quoted.fraction_nis_inside_95)
    assert list(published["chi-square-interval"]) == quoted.nis_bounds_95.tolist()
    means = [published["innovation-low"], published["innovation-high"]]
    assert means == quoted.innovation_mean_range_hz.tolist()
    assert published["nees-initial"] == quoted.initial_nees
    assert published["table2-position-norm"] == quoted.position_error_norm_m
    assert published["table2-velocity-norm"] == quoted.velocity_error_norm_m_s
    assert published["start-drawn"] == paper.reported().table2.x_ml[0]
    true, estimated = (getattr(quoted, f"final_{of}_position_m") for of in ("true", "estimated"))
    assert list(published["final-true"]) == true.tolist()
    error = 100 * np.abs(np.subtract(true, estimated))
    np.testing.assert_allclose(published["final-errors-drawn"], error, atol=1e-9)
    # The norm is stated to a unit of its own last digit.
    assert published["final-quoted"] == pytest.approx(np.linalg.norm(error), abs=0.005)


def test_an_acceleration_has_the_unit_of_a_speed_per_time():
    """A doubled interval doubles the speed that the acceleration sigma_a gives: Eq 17."""
    _, Q = constant_velocity(0.001, 0.4)
    _, Q_long = constant_velocity(0.002, 0.4)
    np.testing.assert_allclose(np.sqrt(Q_long[3, 3] / Q[3, 3]), 2, rtol=1e-12)


@pytest.mark.parametrize("place", [(0.3, 0.1), (0.9, -0.8), (-0.5, 0.4)])
def test_one_sample_of_a_line_does_not_see_where_the_target_is_heading(place):
    """The bound on the position has the speed in it and not the direction.

    With u_n the unit vector to sensor n and d the distance to the line, r_n = d / cos(angle), so
    the part of H that belongs to the position is a cubic in (cos, sin). Modulo the part that
    belongs to the velocity, which is linear in them, two functions are left; their coefficients
    are (v_x dx - v_y dy) and (v_y dx + v_x dy): the error, turned and times the speed.
    """
    array = RadarArray.linear(5, 0.4)
    angle = np.linspace(0, 2 * np.pi, 13)
    x = np.zeros((13, 6))
    x[:, :2] = place
    x[:, 3], x[:, 4] = 2 * np.cos(angle), 2 * np.sin(angle)
    free = np.array([True, True, False, True, True, False])
    P = crlb(x, array, 0.1, free=free)
    bound = np.sqrt(P[:, 0, 0] + P[:, 1, 1])
    # The information has a condition of 1e9 after scaling.
    np.testing.assert_allclose(bound, bound[0], rtol=1e-5)
    moving = crlb(x, array, 0.1, 10, 0.001, "constant_velocity", free=free)
    assert np.ptp(np.log(moving[:, 0, 0] + moving[:, 1, 1])) > 0.2


def test_the_drawn_error_of_z_at_the_first_sample_is_not_that_of_table_2():
    """Both columns may be off by half a millimeter, and the velocity adds less in a millisecond."""
    table, drawn = paper.reported().table2, paper.reported().figure6
    difference = drawn.first_error[2] - abs(table.x0 - table.x_ml)[2]
    assert difference > 2 * 0.0005 + abs(table.x0 - table.x_ml)[5] * paper.reported().scenario.T


def test_turning_the_ring_hardly_changes_the_bound():
    """Six sensors on a circle: the bound on z depends on the angle by a few percent."""
    s = paper.reported().scenario
    for samples in (10, 100, 1000):
        rings = [RadarArray.ring(6, 0.2, phase=np.deg2rad(a)) for a in range(0, 60, 10)]
        z = [
            crlb(s.x0, r, s.sigma_f, samples, s.T, "constant_velocity")[2, 2] ** 0.5 for r in rings
        ]
        assert max(z) < 1.1 * min(z)


def test_the_variance_falls_with_the_ratio_and_the_third_power_of_the_length():
    """By the highest bin of a padded transform; variances of 600 runs are good to 6 % each.

    Powers from a factor of four: 0.09 / log 4 or 0.06 is one deviation, and 0.3 five.
    """
    rng = np.random.default_rng(3)

    def variance(n, snr):
        f = rng.uniform(-0.02, 0.02, 600)
        noise = rng.standard_normal((2, 600, n)) / np.sqrt(2 * snr)
        x = np.exp(2j * np.pi * f[:, None] * np.arange(n)) + noise[0] + 1j * noise[1]
        grid = np.arange(-1024, 1024) / 2**15
        wave = np.exp(-2j * np.pi * np.arange(n)[:, None] * grid)
        return np.var(grid[np.abs(x @ wave).argmax(axis=1)] - f)

    usual, strong, long = variance(40, 10.0), variance(40, 40.0), variance(160, 10.0)
    assert np.log(strong / usual) / np.log(4) == pytest.approx(-1, abs=0.3)
    assert np.log(long / usual) / np.log(4) == pytest.approx(-3, abs=0.3)
