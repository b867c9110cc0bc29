"""Two tones and two stepped chirps measure range and range rate."""

import pytest

from dopplerlib.signal import fsk
from dopplerlib.signal import waveforms as w

RADAR = w.ChirpRadar(carrier=24e9, bandwidth=150e6, duration=38e-3)
ONE = [[30.0, -5.0]]


def test_fsk_measures_one_target():
    r, v = fsk.fsk_solve(RADAR, *fsk.fsk_beats(RADAR, ONE))
    assert r == pytest.approx(30 - 5 * RADAR.duration / 2, abs=0.1)
    assert v == pytest.approx(-5, abs=0.01)


@pytest.mark.parametrize("target", [[30.0, -5.0], [10.0, 3.0], [90.0, 12.0], [60.0, 0.0]])
def test_mfsk_solves_for_range_and_speed_at_once(target):
    """Unambiguous as long as the phase stays within half a turn."""
    assert abs((fsk.mfsk_relations(RADAR) @ target)[1]) < 0.5
    ((r, v),) = fsk.mfsk_solve(RADAR, *fsk.mfsk_beats(RADAR, [target]))
    # During the measurement the target moves by v T, and its Doppler grows with the carrier.
    assert r == pytest.approx(
        target[0] + target[1] * RADAR.duration / 2, abs=0.02 + 0.02 * abs(target[1])
    )
    # On average half the bandwidth above the carrier: 0.3 % of the speed.
    assert v == pytest.approx(target[1], abs=0.02 + 0.004 * abs(target[1]))
