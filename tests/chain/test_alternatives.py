"""A mistake in a setup is found among the alternatives, and none where there is none."""

from dataclasses import replace

import numpy as np
import pytest

from dopplerlib import RadarArray
from dopplerlib.chain.alternatives import Explanation, explain
from dopplerlib.chain.setup import Setup
from dopplerlib.chain.simulation import simulate_recording

ARRAY = RadarArray([[0, 0.5, 1], [0, 2.5, 1.4], [0, 3.7, 1]], 0.0285)
SETUP = Setup(
    ARRAY, ([1, 0, 1.2], [6, 5, 1.2]), 2.5, 0.01, 0.05, 0.4, search="whole", noise="horizontal"
)


@pytest.fixture(scope="module")
def iq():
    rng = np.random.default_rng(11)
    path = [4.5, 1.5, 1.2] + np.arange(1000)[:, None] / 1000 * [-1.4, 0.4, 0]
    return SETUP.baseband(simulate_recording(path, ARRAY, 1000, rng=rng, snr_db=18))


def test_nothing_is_found_where_nothing_is_wrong(iq):
    """The false-alarm probability is 0.001 in a single record."""
    found = explain(iq, SETUP)
    assert found.best is None and len(found.names) == 1 + 2 + 1 + 4 * 3 + 3
    assert found.limit == pytest.approx(2 * np.log(len(found.names) / 1e-3))


@pytest.mark.parametrize(
    ("change", "name"),
    [
        (lambda x: 1j * x.conj(), "I and Q exchanged"),
        (
            lambda x: np.where(np.arange(3)[:, None] == 1, x.conj(), x),
            "I and Q of sensor 2 exchanged",
        ),
        (lambda x: x[[2, 1, 0]], "sensors 1 and 3 exchanged"),
    ],
)
def test_what_is_exchanged_is_named(iq, change, name):
    assert explain(replace(iq, x=change(iq.x)), SETUP).best == name


def test_without_a_target_there_is_nothing_to_explain(iq):
    noise = np.random.default_rng(12).standard_normal((*iq.x.shape, 2)) @ [1, 1j]
    with pytest.raises(ValueError, match="iq must be samples in which a target is detected"):
        explain(replace(iq, x=noise), SETUP)


def test_the_best_one_has_to_exceed_the_limit():
    assert Explanation(("a", "b"), [3.0, -np.inf], 4.0).best is None
    with pytest.raises(ValueError, match="gain must have the shape"):
        Explanation(("a",), [3.0, 1.0], 4.0)
