"""The Gaussian sum behind the signal chain: the saved study comes out again."""

import numpy as np
import pytest

from dopplerlib.systems import mittermaier2016 as paper
from studies import sum_iq as study


def test_the_saved_errors_come_out_again():
    times, window = study.PARAMETERS["times"], study.PARAMETERS["window"]
    found = paper.track_iq(study.records(0, 2), window=window, hop=study.PARAMETERS["hops"][0])
    alone, several = paper.track_errors(found, times), paper.sum_errors(found, times)
    saved = paper.saved_sum_errors()[0, :, :, :2]
    for column, got in enumerate((alone.error, alone.nees, *several)):
        np.testing.assert_allclose(saved[:, column], got, rtol=1e-3)  # four digits are saved


def test_one_sum_follows_what_the_hypotheses_lose():
    """At 0.5 s the sum is never worse by more than chance, and loses fewer tracks."""
    for side in paper.saved_sum_errors()[:, 0]:
        error_alone, _, error, _ = side
        assert (error > 0.05).sum() <= (error_alone > 0.05).sum()
        assert np.mean(error**2) < np.mean(error_alone**2)


def test_a_time_before_the_shifts_is_named():
    found = paper.track_iq(study.records(0, 1))
    with pytest.raises(ValueError, match="times must be after the second shift"):
        paper.sum_errors(found, (0.02,))
