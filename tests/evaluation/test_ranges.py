"""What floats cannot hold is refused by name: no warning, no NaN and no wrong zero in silence."""

import warnings

import numpy as np
import pytest

from dopplerlib import (
    RadarArray,
    Scenario,
    Track,
    crlb,
    doppler_jacobian,
    doppler_shift,
    innovation_mean,
    innovation_whiteness,
    nees,
    nees_samples,
    nis,
)  # fmt: skip
from dopplerlib._records import record
from dopplerlib.evaluation.alarms import first_alarm, innovation_alarms
from dopplerlib.evaluation.averages import effective_samples
from dopplerlib.evaluation.directions import principal_axis_errors
from dopplerlib.evaluation.intervals import (
    mean_interval,
    proportion_interval,
    quantile_interval,
    rms_interval,
)
from dopplerlib.evaluation.observability import observable_rank, rms_bounds
from dopplerlib.evaluation.range_bounds import range_crlb
from dopplerlib.model.ambiguity import ring_family, ring_family_direction, ring_family_limits
from dopplerlib.model.information import fisher_information, inverse_information
from dopplerlib.model.motion import (
    constant_velocity,
    cwna_process_noise,
    cwnj_process_noise,
    nca_transition,
    ncv_transition,
)  # fmt: skip
from dopplerlib.model.polar_radar import polar_position, polar_radar_h, polar_radar_jacobian
from dopplerlib.model.range_rate import range_rate, range_rate_jacobian
from dopplerlib.model.ranging_noise import (
    detection_probability,
    fourth_power_snr,
    linear_snr,
    range_std,
)  # fmt: skip
from dopplerlib.model.twin import planar_twin
from dopplerlib.replication.claims import Claim
from dopplerlib.replication.evidence import Draws
from dopplerlib.replication.verdicts import judge
from dopplerlib.signal.impairments import add_iq_imbalance, quantize
from dopplerlib.signal.synthesis import iq_from_geometry, iq_from_velocity, tone, velocity_profile

RING = RadarArray.ring(6, 0.2)
X = np.array([0.8, 0.1, 0.1, -0.7, 0.05, 0.02])
PLANE = np.array([3.0, 0.2, 4.0, 0.1])
WHITE = np.resize([1.0, -1.0, 2.0], (60, 1))
ONES = np.ones((60, 1, 1))
EYES = np.tile(np.eye(2), (4, 1, 1))


def rng():
    return np.random.default_rng(1)


# Each function of one argument that is 1 where it is ordinary and s times as large otherwise.
SCALED = {
    "doppler_shift x": lambda s: doppler_shift(s * X, RING),
    "doppler_shift v": lambda s: doppler_shift(X * [1, 1, 1, s, s, s], RING),
    "doppler_jacobian": lambda s: doppler_jacobian(X * [1, 1, 1, s, s, s], RING),
    "RadarArray positions": lambda s: RadarArray(s * RING.positions).positions,
    "RadarArray wavelength": lambda s: RadarArray(RING.positions, 0.01 * s).doppler_per_speed,
    "ring": lambda s: RadarArray.ring(3, 0.2 * s).positions,
    "linear": lambda s: RadarArray.linear(3, 0.2 * s).positions,
    "Scenario x0": lambda s: Scenario(RING, s * X, 0.1, 3, 1.0, 1.0, np.eye(6)).truth,
    "Scenario T": lambda s: Scenario(RING, X, 0.1 * s, 3, 1.0, 1.0, np.eye(6)).truth,
    "fisher x": lambda s: fisher_information(X * [1, 1, 1, s, s, s], RING, 0.4),
    "fisher sigma": lambda s: fisher_information(X, RING, 0.4 * s),
    "fisher T": lambda s: fisher_information(X, RING, 0.4, 3, 0.1 * s, "constant_velocity"),
    "crlb": lambda s: crlb(X, RING, 0.4 * s, free=[True] * 2 + [False] * 4),
    "observable_rank": lambda s: observable_rank(s * X, RING),
    "inverse_information": lambda s: inverse_information(s * np.eye(2))[0],
    "ncv": lambda s: ncv_transition(s),
    "nca": lambda s: nca_transition(s),
    "wna T": lambda s: cwna_process_noise(s, 1.0),
    "wna q": lambda s: cwna_process_noise(1e10, s),
    "wnj": lambda s: cwnj_process_noise(s, 1.0),
    "constant_velocity": lambda s: constant_velocity(s, 0.4)[1],
    "polar h": lambda s: polar_radar_h(s * PLANE),
    "polar jacobian": lambda s: polar_radar_jacobian(PLANE * [1, s, 1, s]),
    "polar position": lambda s: polar_position([s, 0.2]),
    "range_rate": lambda s: range_rate(s * PLANE, [[0, 0]]),
    "range_rate_jacobian": lambda s: range_rate_jacobian(PLANE * [1, 1, s, s], [[0, 0]]),
    "range_crlb": lambda s: range_crlb([1.0, 4.0], [[-0.5, 0], [0.5, 0]], 0.03 * s),
    "linear_snr": lambda s: linear_snr(s, 52.0, 1e-100 * s),
    "fourth_power_snr": lambda s: fourth_power_snr(s, 1.0),
    "range_std": lambda s: range_std(0.1, s),
    "detection_probability": lambda s: detection_probability(s, 1e-6),
    "planar_twin": lambda s: planar_twin(s * X),
    "ring_family": lambda s: ring_family(X * [s, s, s, 1, 1, 1], 0.2 * s, 1.1),
    "ring_family_limits": lambda s: ring_family_limits(s * X, 0.2)[0],
    "ring_family_direction": lambda s: ring_family_direction(s * X, 0.2),
    "nis": lambda s: nis([s, 1.0], np.eye(2)),
    "nis S": lambda s: nis([1.0, 1.0], s * np.eye(2)),
    "nees": lambda s: nees(
        Track(s * np.ones((4, 2)), EYES, None, None, None, None), np.zeros((4, 2))),
    "mean": lambda s: innovation_mean(WHITE, s * ONES),
    "whiteness": lambda s: innovation_whiteness(s * WHITE, ONES, 2).p_value,
    "alarms": lambda s: innovation_alarms(
        Track(None, None, s * WHITE, ONES, None, None), [60])["NIS average"],
    "nees_samples F": lambda s: nees_samples(EYES, s * np.eye(2), np.eye(2)),
    "nees_samples P": lambda s: nees_samples(s * EYES, np.eye(2), np.eye(2)),
    "principal_axis_errors": lambda s: principal_axis_errors([s, 1.0], np.eye(2)),
    "rms_bounds": lambda s: rms_bounds(s * np.eye(6), X),
    "rms_bounds x": lambda s: rms_bounds(np.eye(6), s * X),
    "mean_interval": lambda s: [mean_interval([s, 2.0, 3.0]).value],
    "rms_interval": lambda s: [rms_interval([s, 2.0, 3.0]).value],
    "quantile_interval": lambda s: [quantile_interval([-s, s]).value],
    "quantize": lambda s: quantize([s, 1.0], 8, 1.0),
    "quantize full": lambda s: quantize([1.0, 1.0], 8, s),
    "add_iq_imbalance": lambda s: add_iq_imbalance([1.0, 1j], s, 1.0),
    "velocity_profile": lambda s: velocity_profile([0.0, s], 1.0, [(0, 1, s)]),
    "tone f": lambda s: tone(s, 1e3, 4, None, rng=rng()),
    "tone fs": lambda s: tone(1.0, s, 4, None, rng=rng()),
    "tone snr": lambda s: tone(1.0, 1e3, 4, s, rng=rng()),
    "iq_from_velocity": lambda s: iq_from_velocity([s, s], 1.0, 0.01, None, rng=rng()),
    "iq_from_geometry": lambda s: iq_from_geometry([s * X[:3]], RING, None, rng=rng()),
}  # fmt: skip
# An infinite variance, with NaN as its covariances, says that there is no information.
INFINITE = ("inverse_information", "range_crlb")
SIZES = (1e-310, 1e-200, 1e-155, 1e-60, 1e-9, 1e9, 1e30, 1e60, 1e100, 1e155, 1e200, 1e307)


@pytest.mark.parametrize("name", SCALED)
def test_every_size_is_computed_or_refused_by_name(name):
    """Every result is finite and raises no warning; what is refused is named."""
    call = SCALED[name]
    call(1.0)
    for size in SIZES:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            try:
                result = call(size)
            except ValueError as error:
                assert " must " in str(error), (size, error)
                continue
        results = result if isinstance(result, tuple) else (result,)
        for value in results:
            array = np.asarray(value)
            if name in INFINITE:
                assert not np.isnan(np.diagonal(array)).any(), (size, value)
            else:
                assert np.isfinite(array).all(), (size, value)


@pytest.mark.parametrize("size", [1e155, -1e155])
def test_a_shift_is_never_zero_because_its_range_overflows(size):
    with pytest.raises(ValueError, match=r"x must be between -1e\+60 and 1e\+60, got"):
        doppler_shift([size, 0, 0, 1, 0, 0], RING)


@pytest.mark.parametrize("power", [-50, -9, 9, 50])
def test_a_shift_does_not_depend_on_the_unit_of_length(power):
    unit = 10.0**power
    scaled = RadarArray(RING.positions * unit, RING.wavelength * unit)
    np.testing.assert_allclose(doppler_shift(X * unit, scaled), doppler_shift(X, RING), rtol=1e-12)


ITERATED = {
    "doppler_shift": lambda of: doppler_shift(of(X), RING),
    "RadarArray": lambda of: RadarArray(of([[0.0, 0.0, 0.0], [0.0, 1.0, 0.0]])),
    "crlb": lambda of: crlb(of(X), RING, of([0.4] * 6), free=of([True] * 2 + [False] * 4)),
    "polar_radar_h": lambda of: polar_radar_h(of(PLANE)),
    "range_rate": lambda of: range_rate(of(PLANE), of([[0.0, 0.0]])),
    "planar_twin": lambda of: planar_twin(of(X)),
    "ring_family": lambda of: ring_family(X, 0.2, of([0.5, 1.5])),
    "nis": lambda of: nis(of([1.0, 2.0]), of([[1.0, 0.0], [0.0, 1.0]])),
    "nees": lambda of: nees(Track(np.ones((4, 2)), EYES, None, None, None, None), of([[0, 0]] * 4)),
    "nees_samples": lambda of: nees_samples(of(EYES), of(np.eye(2)), of(np.eye(2))),
    "innovation_mean": lambda of: innovation_mean(of(WHITE), of(ONES)),
    "innovation_whiteness": lambda of: innovation_whiteness(of(WHITE), of(ONES), 2),
    "alarms": lambda of: innovation_alarms(
        Track(None, None, WHITE, ONES, None, None), of([20, 60])),
    "first_alarm": lambda of: first_alarm(of([[False, True]]), of([20, 60])),
    "principal_axis_errors": lambda of: principal_axis_errors(of([1.0, 1.0]), of(np.eye(2))),
    "rms_bounds": lambda of: rms_bounds(of(np.eye(6)), of(X)),
    "mean_interval": lambda of: mean_interval(of([1.0, 2.0, 3.0])),
    "rms_interval": lambda of: rms_interval(of([1.0, 2.0, 3.0])),
    "quantile_interval": lambda of: quantile_interval(of([1.0, 2.0, 3.0])),
    "proportion_interval": lambda of: proportion_interval(of([True, False])),
    "effective_samples": lambda of: effective_samples(of([0.5, 0.2]), 10),
    "velocity_profile": lambda of: velocity_profile(of([0.0, 1.0]), 1.0, of([[0, 1, 2]])),
    "quantize": lambda of: quantize(of([1.0, 1j]), 8, 1.0),
    "judge": lambda of: [judge(CLAIM, draws).verdict for draws in [Draws(of(range(50)), 7.0)] * 2],
    "Draws": lambda of: Draws(of([1.0, 2.0])),
}  # fmt: skip
CLAIM = Claim("a", "w", "s.", "draw", "typical", "p", "c", "t", ("k",))


@pytest.mark.parametrize("of", [iter, lambda values: (one for one in values)])
@pytest.mark.parametrize("name", ITERATED)
def test_an_iterator_means_the_same_as_a_list(name, of):
    @record
    class Result:
        value: object

    assert Result(ITERATED[name](of)) == Result(ITERATED[name](list))
