"""Demands are met where the numbers are within their limits, and coverage counts times."""

from dataclasses import replace

import numpy as np
import pytest

from dopplerlib.workspace.demands import _MEDIAN, coverage, demand_table
from dopplerlib.workspace.errors import ErrorSummary


def summary(**changed):
    """Return statistics that meet all demands, but for those that are changed."""
    n, one = np.full(50, 4000.0), np.ones(50)
    right = ErrorSummary(
        runs=n, nees=6 * one, nees_error=0.05 * one, nees_median=5.3 * one, inside=0.95 * one,
        axes=np.full((50, 6), 0.95), position=0.01 * one, velocity=0.1 * one,
        position_error=0.01 * one, velocity_error=0.01 * one, position_bound=0.01 * one,
        velocity_bound=0.1 * one, lost=0 * one, nees_worst=np.full((50, 3), 20.0),
        position_worst=np.full((50, 3), 0.04),
    )  # fmt: skip
    return replace(right, **changed)


def unmet(case, **changed):
    """Return the demands that a tracker does not meet if one case is changed."""
    found = {each: summary() for each in "ABCD"} | {case: summary(**changed)}
    return {label: row for label, row in demand_table(found).rows.items() if row[-1] == "no"}


def at(i, value, rest):
    values = np.full(50, float(rest))
    values[i] = value
    return values


def test_all_may_be_met():
    assert unmet("A") == {}


def test_a_mean_nees_beyond_its_limits_is_named_with_its_time_and_interval():
    ((label, row),) = unmet("A", nees=at(9, 6.4, 6)).items()
    assert label == "A: mean NEES, from 0.1 s"
    interval, time, limits, _ = row
    assert (interval.value, time, limits) == (6.4, pytest.approx(0.2), "5.7 to 6.3")
    assert interval.half_width == pytest.approx(1.96 * 0.05)
    assert unmet("A", nees=at(3, 6.4, 6)) == {}  # 0.08 s: not demanded
    assert list(unmet("B", nees=at(3, 7.4, 6))) == ["B: mean NEES, from 0.02 s"]
    assert list(unmet("C", nees=at(29, 6.4, 6))) == ["C: mean NEES, from 0.6 s"]
    assert unmet("C", nees=at(5, 9, 6)) == {}
    assert list(unmet("C", nees_median=at(5, 9, 5))) == ["C: median NEES, before 0.3 s"]


def test_none_of_4000_runs_may_still_be_some_of_all():
    found = demand_table({case: summary() for case in "ABCD"})
    interval = found.rows["A: fraction lost, at 1 s"][0]
    assert interval.low == interval.value == 0
    assert interval.high == pytest.approx(1 - 0.025 ** (1 / 4000))  # Clopper and Pearson's, by hand


def test_errors_axes_and_lost_runs_beyond_their_limits_are_named():
    far = at(49, 0.0121, 0.01)
    assert list(unmet("B", position=far)) == ["B: position over bound, from 0.4 s"]
    assert unmet("A", position=far) == {}  # 1.35 at the end
    axes = np.full((50, 6), 0.95)
    axes[20, 4] = 0.91
    ((label, row),) = unmet("B", axes=axes).items()
    assert (label, row[0].value) == ("B: within 95 %, all axes, from 0.1 s", 0.91)
    assert list(unmet("D", lost=at(49, 1 / 4000, 0))) == ["D: fraction lost, at 1 s"]
    assert list(unmet("A", lost=at(24, 0.003, 0))) == ["A: fraction lost, at 0.5 s"]
    assert unmet("C", lost=at(24, 0.003, 0)) == {}


def test_coverage_is_the_fraction_of_times_with_six_inside():
    # Of 4000 runs the chi-square interval is 5.89 to 6.11; by their scatter, 0.098 to each side.
    nees = np.full(50, 6.0)
    nees[4:14] = 6.105
    nees[14:24] = 5.8
    chi_square, empirical = coverage(summary(nees=nees))
    assert chi_square == pytest.approx(36 / 46)
    assert empirical == pytest.approx(26 / 46)


def test_what_is_no_comparison_is_refused():
    with pytest.raises(ValueError, match=r"found\['B'\] must be"):
        demand_table({"A": summary()})
    with pytest.raises(ValueError, match="first must be at most 1"):
        coverage(summary(), first=2)


def test_the_error_of_a_median_is_that_of_chi_square():
    from scipy.stats import chi2

    density = chi2.pdf(chi2.median(6), 6)
    assert _MEDIAN == pytest.approx(1 / (2 * density) / np.sqrt(12), abs=0.005)
