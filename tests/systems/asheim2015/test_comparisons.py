"""Comparisons of trackers: a delay that is known does less harm than one that is not."""

import numpy as np
import pytest

from dopplerlib.systems import asheim2015 as thesis


def test_a_delay_of_a_scan_moves_x_by_its_range_times_distance_over_baseline():
    """0.14 m in one range at 3.9 m: some 0.5 m across, on top of the noise."""
    names = list(thesis.late_radar([0.0, 1.0], 2, rng=np.random.default_rng(1)))
    found = thesis.late_radar([0.0, 1.0], 60, rng=np.random.default_rng(1))
    for name in names[:2]:  # those that ignore it
        extra = found[name][1].value ** 2 - found[name][0].value ** 2
        assert 0.5 < np.sqrt(extra) < 1.0
    for name in names[2:]:
        assert found[name][1].high < found[names[0]][1].low / 2


def test_without_a_delay_knowing_it_changes_nothing():
    found = list(thesis.late_radar([0.0], 10, rng=np.random.default_rng(2)).values())
    assert found[0][0].value == found[2][0].value
    assert found[1][0].value == found[3][0].value


def test_the_usable_range_is_that_of_each_tracker():
    records = thesis.simulate_radars(30, rng=np.random.default_rng(3))
    raw = thesis.raw_positions(records)
    found = thesis.usable_ranges(records, {"raw": raw}, rng=np.random.default_rng(4))["raw"]
    error = thesis.position_errors(raw.p, records.truth)
    assert found.value == thesis.usable_range(error, records.time, records.distance)
    assert found.low <= found.value <= found.high


def test_the_bound_of_a_scan_is_attained_by_measured_positions():
    """At 2.8 m, 2000 runs: within 5 deviations of a sample variance, by chance 1e-6."""
    records = thesis.simulate_radars(2000, rng=np.random.default_rng(5), duration=20.0, T=1.0)
    p = records.truth[-1, :2]
    C = np.cov(thesis.raw_positions(records).p[:, -1].T)
    bound = thesis.one_scan_bound(p)
    spread = np.sqrt((np.outer(np.diag(bound), np.diag(bound)) + bound**2) / 2000)
    assert (np.abs(C - bound) < 5 * spread).all()


def test_a_longer_baseline_helps_and_both_radars_in_one_filter_need_it_less():
    """A quarter of a meter and two meters: errors differ by factors of 3 and more."""
    found = thesis.baseline_sweep([0.25, 2.0], 40, rng=np.random.default_rng(6))
    apart, together = found.values()
    for short, long in (apart, together):
        assert short.low > long.high
    assert apart[0].value / apart[1].value > 1.2 * together[0].value / together[1].value


def test_what_the_gate_refuses_depends_on_the_start_and_not_with_a_floor():
    """Nearly all scans from 5 cm in front with little process noise, hardly any from 1 cm.

    With the floor fewer than the gate is set to lose (0.1 %) and five of its standard errors.
    """
    (near,), (far,) = thesis.rejected_scans([0.01, 0.05], [1e-4], 20, rng=np.random.default_rng(7))
    assert near.high < 0.05 and far.low > 0.5
    ((kept,),) = thesis.rejected_scans([0.05], [1e-4], 20, rng=np.random.default_rng(8), floor=None)
    assert kept.value < 0.005


def test_without_noise_a_known_delay_leaves_no_error(monkeypatch):
    """The person moves 7 cm in half a scan: errors are taken where the person is by then.

    Filters apart lag behind the bend of the ranges by a centimeter or two.
    """
    monkeypatch.setattr(thesis.scene, "noise_std", lambda d, law=None: np.zeros((*d.shape, 2)))
    found = list(thesis.late_radar([0.5], 1, rng=np.random.default_rng(9)).values())
    for values in found[2:]:
        assert values[0].value < 0.03


def test_a_delay_beyond_the_next_scan_is_refused():
    for offset in (-0.1, 0.2):
        late = thesis.simulate_radars(1, rng=np.random.default_rng(1), duration=1, offset=offset)
        with pytest.raises(ValueError, match="records must have an offset from 0 to the interval"):
            thesis.central_filter(late, thesis.filter_settings("modern"))
