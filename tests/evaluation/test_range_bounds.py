"""The bound on a position from ranges is what theory and simulation say."""

import numpy as np

from dopplerlib.evaluation.range_bounds import range_crlb
from dopplerlib.tracking.bilateration import bilaterate

SENSORS = np.array([[-0.5, 0.0], [0.5, 0.0]])


def test_in_front_of_the_middle_it_is_a_closed_form():
    """Both ranges are equal: along y sigma/sqrt(2)/cos, across it sigma/sqrt(2)/sin."""
    y, sigma, b = 4.0, 0.03, 1.0
    half = np.arctan2(b / 2, y)
    P = range_crlb([0, y], SENSORS, sigma)
    expected = sigma**2 / 2 / np.array([np.sin(half), np.cos(half)]) ** 2
    np.testing.assert_allclose(P, np.diag(expected), atol=1e-15)


def test_far_away_the_deviation_across_is_one_over_the_baseline():
    """To second order in the baseline over the distance, here 1e-4."""
    wide, narrow = (
        range_crlb([0, 40], [[-b / 2, 0], [b / 2, 0]], 0.03)[0, 0] ** 0.5 for b in (1.0, 0.5)
    )
    np.testing.assert_allclose(narrow / wide, 2.0, rtol=1e-3)


def test_bilateration_attains_it_while_the_noise_is_small():
    """4000 runs: each variance within 5 of its own deviations, which fails by chance at 1e-6.

    Two ranges for two unknowns leave nothing to weigh, so the bound is exact to first order.
    """
    rng, p, sigma, runs = np.random.default_rng(5), np.array([1.0, 2.0]), [1e-3, 2e-3], 4000
    d = np.hypot(*(p - SENSORS).T) + sigma * rng.standard_normal((runs, 2))
    x, y, _ = bilaterate(d[:, 0], d[:, 1], 1.0)
    bound = range_crlb(p, SENSORS, sigma)
    C = np.cov([x, y])
    spread = np.sqrt((np.outer(np.diag(bound), np.diag(bound)) + bound**2) / runs)
    assert (np.abs(C - bound) < 5 * spread).all()


def test_on_the_baseline_the_position_along_it_is_known_and_the_other_is_not():
    P = range_crlb([0.1, 0.0], SENSORS, 0.03)
    assert P[1, 1] == np.inf
    np.testing.assert_allclose(P[0, 0], 0.03**2 / 2)


def test_a_third_radar_can_only_help():
    three = np.vstack([SENSORS, [[3.0, 3.0]]])
    gain = range_crlb([1, 2], SENSORS, 0.03) - range_crlb([1, 2], three, 0.03)
    assert np.linalg.eigvalsh(gain).min() > -1e-12
