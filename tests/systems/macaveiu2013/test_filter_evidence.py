"""The numbers judged for Sections III to V, by the library's filter on records of their own."""

import numpy as np
import pytest

from dopplerlib.evaluation.intervals import mean_interval, proportion_interval, quantile_interval
from dopplerlib.replication.documents import read_document
from dopplerlib.systems import macaveiu2013 as paper
from dopplerlib.systems.macaveiu2013.evidence import _filter as found

PATHS = paper.vehicle_paths()
PLACE = (0.5, 2.0, 0.01)  # noise of the position in m, ratio of the noises, velocity step in m/s
S = paper.automotive_settings().with_(sigma_x=0.5, sigma_v=1.0, w=0.01)


@pytest.fixture(scope="module")
def judged(monkeypatch_module):
    """Return the judged numbers at one place of each sweep, as the evidence makes them."""
    places = {
        "fig7-error": (*PLACE, "after the first second", 0.9),
        "all-below-resolution": (*PLACE, "all samples"),
        "large-Ez-smooths": (*PLACE, 10),
        "harder-turn": (*PLACE, 3),
    }
    whole = {}

    def one_place(choices, function, rng=None):
        axes = tuple(one.id for one in choices)
        at = {
            found.NOISE: PLACE,
            (*found.NOISE, "counted", "most"): places["fig7-error"],
            (*found.NOISE, "counted"): places["all-below-resolution"],
            (*found.NOISE, "larger-covariance"): places["large-Ez-smooths"],
            (*found.NOISE, "turn-duration"): places["harder-turn"],
        }
        whole[axes] = function
        return function(*at[axes]) if axes in at else function

    monkeypatch_module.setattr(found, "sweep", one_place)
    return found.found(np.random.default_rng(1)), whole


@pytest.fixture(scope="module")
def monkeypatch_module():
    """Return a monkeypatch that lasts as long as the module."""
    with pytest.MonkeyPatch.context() as patch:
        yield patch


@pytest.fixture(scope="module")
def runs():
    """Return 100 records of each path through the library's filter."""
    return {
        figure: paper.track_vehicle(path, 100, rng=np.random.default_rng(90 + figure), s=S)
        for figure, path in PATHS.items()
    }


def together(one, other):
    """Return whether two intervals of 95 % overlap when both are twice as wide.

    Of the same number: two estimates differ by more than 5.5 of their deviations, 4e-8.
    """
    reach = 2 * (one.high - one.low + other.high - other.low) / 2
    return abs(one.value - other.value) <= reach


def test_scores_are_those_of_the_library_filter(judged, runs):
    """Errors, shares and speeds of other records, other code and another seed."""
    numbers, functions = judged
    settled = {i: one.position_error[:, S.skip :].max(axis=1) for i, one in runs.items()}
    whole = {i: one.position_error.max(axis=1) for i, one in runs.items()}
    assert together(numbers["fig7-error"], quantile_interval(settled[7], 0.9))
    fig7 = functions[(*found.NOISE, "counted", "most")]
    median = fig7(*PLACE, "all samples", 0.5)
    assert together(median, quantile_interval(whole[7], 0.5))
    assert median.low > numbers["fig7-error"].high
    below = functions[(*found.NOISE, "counted")]
    for counted, largest in (("all samples", whole), ("after the first second", settled)):
        share = proportion_interval(np.max(list(largest.values()), axis=0) < 1)
        assert together(below(*PLACE, counted), share), counted
    speed = {
        i: np.sqrt(np.mean(one.error[:, S.skip :, 1::2] ** 2, axis=1)) for i, one in runs.items()
    }
    assert together(numbers["fig7-speed"], mean_interval(speed[7].max(axis=1) / S.sigma_v))
    worst = np.max([one.max(axis=1) for one in speed.values()], axis=0)
    assert together(numbers["speeds-promising"], mean_interval(worst / S.sigma_v))
    straight = np.max([speed[i] for i in (7, 8, 9)], axis=0)
    varies = (speed[10][:, 0] > straight[:, 0]) & (speed[11][:, 1] > straight[:, 1])
    assert together(numbers["varying-speed"], proportion_interval(varies))


def test_scores_of_another_place_are_those_of_the_library_filter(judged):
    """A share that is neither 0 nor 1, and measurements in units of a small noise of the speed."""
    place = 0.5, 0.28, 0.1
    s = paper.automotive_settings().with_(sigma_x=0.5, sigma_v=0.14, w=0.1)
    speed = {}
    for figure, path in PATHS.items():
        one = paper.track_vehicle(path, 100, rng=np.random.default_rng(70 + figure), s=s)
        speed[figure] = np.sqrt(np.mean(one.error[:, s.skip :, 1::2] ** 2, axis=1))
    numbers = judged[1][found.NOISE](*place)
    straight = np.max([speed[i] for i in (7, 8, 9)], axis=0)
    varies = (speed[10][:, 0] > straight[:, 0]) & (speed[11][:, 1] > straight[:, 1])
    assert 0.05 < numbers["varying-speed"].value < 0.95
    assert together(numbers["varying-speed"], proportion_interval(varies))
    assert together(numbers["fig7-speed"], mean_interval(speed[7].max(axis=1) / 0.14))


def records(path, s, seed, filters):
    """Return errors (filters, runs, K, 4) of several filters on the same 100 records."""
    z = paper.measure_vehicle(path.truth, 100, rng=np.random.default_rng(seed), s=s)
    return np.stack([paper.filter_vehicle(z, one) for one in filters]) - path.truth


@pytest.mark.parametrize("factor", [2, 10])
def test_a_larger_covariance_smooths_and_lags_in_simulated_records(judged, factor):
    """Filters that are told a covariance, on records with that of the noise.

    Deviations of 200 axes at ten times that are nearly independent: 1.6 % each, and correlated.
    """
    told = [S, S.with_(sigma_x=S.sigma_x * factor**0.5, sigma_v=S.sigma_v * factor**0.5)]
    noise = records(PATHS[7], S, 31, told)[:, :, 260:]
    left = np.sqrt(np.mean(noise**2, axis=(1, 2)).reshape(2, 2, 2).mean(axis=1))
    lag = np.abs(records(PATHS[10], S, 32, told)[:, :, -100:, :2].mean(axis=(1, 2)))
    numbers = judged[1][(*found.NOISE, "larger-covariance")](*PLACE, factor)
    assert numbers["large-Ez-smooths"] == pytest.approx((left[1] / left[0]).max(), rel=0.1)
    assert numbers["large-Ez-lags"] == pytest.approx((lag[1] / lag[0]).min(), rel=0.06)
    assert (left[1] / left[0]).min() < 0.9 * (left[1] / left[0]).max()
    assert (lag[1] / lag[0]).max() > 1.15 * (lag[1] / lag[0]).min()


@pytest.mark.parametrize("duration", [2, 3, 5])
def test_a_hard_turn_is_worse_in_simulated_records(judged, duration):
    """Rms of 100 records, of both axes together; the deviation of the ratio is below 1 %.

    After the first second the noise of Fig 10 is still larger than what is left in the end: 2 %.
    """
    turn, turning = paper.hard_turn(duration)
    heading = np.unwrap(np.arctan2(turn.truth[:, 1], turn.truth[:, 3]))
    assert heading[-1] - heading[0] == pytest.approx(np.pi / 2)
    assert turning.sum() * S.T == pytest.approx(duration, abs=S.T)
    hard = records(turn, S, 33, [S])[0, :, turning, 1::2]
    gentle = records(PATHS[10], S, 34, [S])[0, :, S.skip :, 1::2]
    ratio = np.sqrt(np.mean(hard**2) / np.mean(gentle**2))
    number = judged[1][(*found.NOISE, "turn-duration")](*PLACE, duration)
    assert number == pytest.approx(ratio, rel=0.05)


@pytest.mark.parametrize("noise", [(2.0, 0.28, 0.1)])
def test_where_noise_drowns_the_lag_both_axes_of_it_count(judged, noise):
    """With much noise the ratio is near 1, and hangs on how much noise there is."""
    s = found.settings(*noise)
    assert (s.sigma_x, s.sigma_v, s.w) == (2.0, 0.56, 0.1)
    turn, turning = paper.hard_turn(3)
    hard = records(turn, s, 35, [s])[0, :, turning, 1::2]
    gentle = records(PATHS[10], s, 36, [s])[0, :, s.skip :, 1::2]
    ratio = np.sqrt(np.mean(hard**2) / np.mean(gentle**2))
    assert judged[1][(*found.NOISE, "turn-duration")](*noise, 3) == pytest.approx(ratio, rel=0.04)


@pytest.mark.parametrize("periods", [0.5, 1, 1.5])
def test_the_way_to_the_side_is_the_integral_of_the_speed(periods):
    """The sine of 1.5 km/h, summed in steps of a millisecond."""
    t = (np.arange(19_000) + 0.5) / 1000
    way = np.sum(1.5 / 3.6 * np.sin(2 * np.pi * periods * t / 19)) / 1000
    assert found.left_over(periods) == pytest.approx(way, abs=1e-6)


def test_the_best_step_improves_simulated_records():
    """Rms speed error at the end of Fig 10: a ratio of 100 records, and no other step is better."""
    a = 10 * paper.KMH / 19
    tried = [S.with_(w=w) for w in (paper.best_w(a), 0.02, 0.08)]
    error = records(PATHS[10], S, 37, [S, *tried])[:, :, -150:, 1]
    rms = np.sqrt(np.mean(error**2, axis=(1, 2)))
    assert found.arithmetic()["improvable"] == pytest.approx(rms[1] / rms[0], rel=0.08)
    assert rms[1] < min(rms[2:])


def test_the_choices_of_the_sweeps_are_those_of_the_claims(judged):
    claims = {one.id: one.choices for one in read_document("macaveiu2013").claims}
    assert claims["fig7-error"] == (*found.NOISE, "counted", "most")
    assert set(judged[1]) <= set(claims.values())
