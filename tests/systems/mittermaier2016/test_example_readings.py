"""What Fig 6 decides about the settings of its run, for another seed than the page's."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from dopplerlib import chi2_interval
from dopplerlib.evaluation.intervals import ConfidenceInterval
from dopplerlib.systems import mittermaier2016 as paper
from dopplerlib.systems.mittermaier2016.readings.example import (
    OPTIONS,
    SUMMARIES,
    example_summary,
)

NEAREST = 120


@pytest.fixture(scope="module")
def runs():
    return paper.example_readings(6000, rng=np.random.default_rng(5))


@pytest.fixture(scope="module")
def drawn():
    return paper.reported().figure6


def test_the_published_run_is_described_by_what_is_drawn(runs, drawn):
    told = dict(zip(SUMMARIES, runs.published, strict=True))
    assert told["average NIS"] == pytest.approx(np.log10(drawn.nis.mean()))
    refused = drawn.skipped & (drawn.nis < 6)
    assert np.expm1(told["refused, too small"]) == pytest.approx(refused.sum())
    last = np.sqrt(np.mean(drawn.error[950:, 1] ** 2))
    assert 10 ** told["error of y, 950 to 1001 ms"] == pytest.approx(last)
    assert np.isfinite(runs.published).all()
    assert np.isfinite(runs.summary).all()


def test_white_values_have_no_memory_and_a_walk_has_much():
    rng = np.random.default_rng(1)
    error, skipped = np.ones((1, 1001, 3)), np.zeros((1, 1001), bool)
    memory = SUMMARIES.index("NIS, memory")
    white = rng.chisquare(6, (1, 1001))
    walk = np.exp(np.cumsum(rng.standard_normal((1, 1001)), axis=1) / 10)
    # 1 / sqrt(1001) is one deviation.
    assert abs(example_summary(error, white, skipped)[0, memory]) < 0.15
    assert example_summary(error, walk, skipped)[0, memory] > 0.9


def test_every_answer_is_given_about_equally_often(runs):
    for question, answers in OPTIONS.items():
        counts = np.bincount(runs.option[question], minlength=len(answers))
        # Six deviations of a binomial of 6000.
        spread = 6 * np.sqrt(6000 / len(answers))
        assert np.abs(counts - 6000 / len(answers)).max() < spread


def test_long_raised_noise_is_ruled_out_and_the_printed_settings_are_not(runs):
    for decorrelate in (True, False):
        out = paper.ruled_out(runs.shares(NEAREST, decorrelate=decorrelate))
        assert ("noise at the start", "R x 10, 100 samples") in out
        for printed in (
            ("start", "of Table 2"),
            ("start", "as drawn"),
            ("P0", "0.1 I"),
            ("process noise", "shared, 0.4 m/s²"),
            ("noise at the start", "not raised"),
        ):
            assert printed not in out


@pytest.mark.parametrize("answer", range(3))
def test_a_pretended_publication_is_recognized(runs, answer):
    """The nearest runs are more often right than by chance, 1/3, for every answer."""
    question = "noise at the start"
    own = np.flatnonzero(runs.option[question] == answer)[:20]
    right = []
    for run in own:
        near = replace(runs, published=runs.summary[run]).nearest(NEAREST + 1)
        assert near[0] == run
        right.append(np.mean(runs.option[question][near[1:]] == answer))
    assert np.mean(right) > 0.45


def test_an_answer_is_ruled_out_by_ten_to_one_and_not_by_less():
    shares = {
        "q": {"a": ConfidenceInterval(0.9, 0.8, 1.0), "b": ConfidenceInterval(0.1, 0.05, 0.15)},
        "r": {"a": ConfidenceInterval(0.9, 0.8, 1.0), "b": ConfidenceInterval(0.01, 0.0, 0.07)},
    }
    assert paper.ruled_out(shares) == {("r", "b")}


def test_the_gate_is_seen_in_samples_that_stand_still(drawn):
    low, high = paper.still_counts(drawn.error, drawn.nis)
    assert low > 15
    assert high > 10
    for gate in (None, "upper"):
        ours = paper.run_example(
            150, rng=np.random.default_rng(6), gate=gate, start=drawn.start, keep=()
        )
        assert paper.still_counts(ours.error, ours.track.nis)[0].max() < low / 2


def test_a_sample_stands_still_where_no_error_moves():
    rng = np.random.default_rng(2)
    nis = np.full(1001, 6.0)
    lower, upper = chi2_interval(6)
    steps = 1 + rng.random((1001, 3))
    for sample, value in ((100, lower / 2), (200, upper * 2), (300, 6.0)):
        steps[sample], nis[sample] = 0.01, value
    steps[400, 0] = 0.01  # only one of the three
    nis[400] = lower / 2
    low, high = paper.still_counts(np.cumsum(steps, axis=0), nis)
    assert (low, high) == (1, 1)


def test_too_few_runs_are_refused():
    with pytest.raises(ValueError, match="runs must be"):
        paper.example_readings(14, rng=np.random.default_rng(1))
    with pytest.raises(ValueError, match="rng must be"):
        paper.example_readings(15, rng=1)


def test_numbers_that_describe_a_run_by_hand():
    rng = np.random.default_rng(21)
    nis, error = rng.chisquare(5, 1001), np.abs(rng.standard_normal((1001, 3)))
    skipped = rng.random(1001) < 0.1
    found = dict(zip(SUMMARIES, example_summary(error, nis, skipped), strict=True))
    # Ends of chi-square with six degrees of freedom, from a printed table.
    inside = sum(1.237 < one < 14.449 for one in nis) / 1001
    away = np.log10(nis) - sum(np.log10(nis)) / 1001
    memory = sum(a * b for a, b in pairwise(away)) / 1000 / (sum(away**2) / 1001)
    small = sum(s and one < 6 for s, one in zip(skipped, nis, strict=True))
    for name, expected in {
        "average NIS": np.log10(sum(nis) / 1001),
        "share of NIS inside": inside,
        "NIS, first ten": np.log10(sum(nis[k] for k in range(10)) / 10),
        "NIS, memory": memory,
        "refused, too small": np.log(1 + small),
        "refused, too large": np.log(1 + skipped.sum() - small),
        "error of y, 50 to 150 ms": np.log10(np.sqrt(sum(error[50:150, 1] ** 2) / 100)),
        "error of z, 950 to 1001 ms": np.log10(np.sqrt(sum(error[950:, 2] ** 2) / 51)),
    }.items():
        assert found[name] == pytest.approx(expected, rel=1e-9), name
