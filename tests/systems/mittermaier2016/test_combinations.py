"""What the study of all combinations saved comes out again, and says what the chapter reads."""

from itertools import product

import numpy as np
import pytest
from numpy.testing import assert_allclose

from dopplerlib._data import read_json, results
from dopplerlib.systems import mittermaier2016 as paper
from dopplerlib.systems.mittermaier2016.readings.combinations import MOMENTS, SWITCHES
from studies import combinations as study

KEYS = list(product(*SWITCHES.values()))
# A straight world takes the filter in plain NumPy: two of them show what eight would.
AGAIN = [k for k in KEYS if k[-1] == "curved" or k[:3] in {KEYS[0][:3], KEYS[-1][:3]}]


@pytest.mark.parametrize("key", AGAIN, ids=" ".join)
def test_the_first_runs_come_out_again(key):
    stored = read_json("combinations.json", folder=results)
    row = stored["rows"][KEYS.index(key)]
    assert tuple(row[name] for name in SWITCHES) == key
    assert stored["moments"] == list(MOMENTS)
    runs = paper.combination_runs(2, *key, rng=np.random.default_rng(study.PARAMETERS["seed"]))
    assert_allclose(runs.nees, row["first"], rtol=1e-3)  # of four digits


def test_without_curvature_every_filter_is_nearly_consistent_and_with_it_none():
    at = MOMENTS.index(100)
    nees = {key: row["nees"][at] for key, row in paper.saved_combinations().items()}
    assert list(nees) == KEYS
    for *rest, world in KEYS:
        value, low, high = nees[*rest, world]
        assert low < value < high
        # A P0 or Q that is larger than the truth halves it; the median of chi-square is 5.3.
        assert 2.5 < value < 8 if world == "straight" else low > 6
    published = nees["published", "shared", "fixed", "curved"]
    assert published[1] > 10 * nees["matched", "shared", "fixed", "curved"][2]
