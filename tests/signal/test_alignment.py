"""The offset of two clocks is found between the samples, with a deviation that is right."""

from datetime import UTC, datetime

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.signal import firwin, oaconvolve
from scipy.stats import chi2

from dopplerlib.signal.alignment import clock_offset
from dopplerlib.signal.recording import Recording, align

FS, N, OVER = 2000.0, 4000, 8


def pair(rng, delay, ppm, snr_db, event=None):
    """Return what two recorders have of one signal of 200 Hz bandwidth, or of a short event.

    The signal is made at eight times the rate; a spline between its samples is exact to 1e-5.
    """
    source = oaconvolve(
        rng.standard_normal((N + 2000) * OVER), firwin(401, 0.2 / OVER), mode="same"
    )
    t = np.arange(len(source)) / OVER - 1000
    if event is not None:
        source = source * np.exp(-(((t - event) / 60) ** 2))
    at = CubicSpline(t, source / source.std())
    i = np.arange(N)
    noise = 10 ** (-snr_db / 20) * rng.standard_normal((2, N))
    return at(i) + noise[0], at(delay * FS + i * (1 - 1e-6 * ppm)) + noise[1]


@pytest.mark.parametrize(
    "delay, ppm, snr_db", [(0.0185, 0, 10), (-0.12345, 150, 10), (0.0003, -80, 30), (0.2, 50, 3)]
)
def test_offset_and_rate_are_off_by_their_deviations(delay, ppm, snr_db):
    """Four pairs: the sum of squares is chi-square."""
    rng = np.random.default_rng(1)
    total = np.zeros(2)
    for _ in range(4):
        found = clock_offset(*pair(rng, delay, ppm, snr_db), FS)
        assert found.used >= 12
        total += (
            ((found.delay - delay) / found.delay_std) ** 2,
            ((found.rate_ppm - ppm) / found.rate_std_ppm) ** 2,
        )
    assert (total < chi2.ppf(1 - 1e-5, 4)).all()
    assert (total > chi2.ppf(1e-5, 4)).all()
    assert found.delay_std < 0.5 / FS


@pytest.mark.parametrize("event", [300, 2000])
def test_one_short_event_tells_the_offset_and_no_rate(event):
    delay = 37.3 / FS
    x, y = pair(np.random.default_rng(2), delay, 0, 20, event)
    found = clock_offset(x, y[:-37], FS)
    assert abs(found.delay - delay) < 5 * found.delay_std < 0.5 / FS
    assert np.isnan(found.rate_ppm) and found.used < 3


def test_signals_with_nothing_in_common_are_refused():
    """Each pair with the probability of 1e-6 that is asked for."""
    signals = [pair(np.random.default_rng([3, i]), 0.0, 0, 10)[0] for i in range(6)]
    for i in range(6):
        x, y = signals[i], signals[i - 1]
        with pytest.raises(ValueError, match="x and y must have something in common"):
            clock_offset(x, y, FS, false_alarm=1e-6)
    with pytest.raises(ValueError, match="x and y must have something in common"):
        clock_offset(np.ones(1000), np.ones(1000), FS, parts=4)
    with pytest.raises(ValueError, match="parts must have 64 samples of y or more"):
        clock_offset(x, y[:1000], FS)


def test_recordings_of_two_recorders_are_put_on_one_clock():
    """The event is at the same sample afterwards, to half a sample."""
    x, y = pair(np.random.default_rng(4), 37.3 / FS, 0, 20, 2000)
    one, two = (Recording([v + 0j], FS, 24e9) for v in (x, y[:-37]))
    found = clock_offset(x, y[:-37], FS)
    both = align([one, two], delays=[0, found.delay])
    assert both.x.shape == (2, N - 37) and both.start is None
    np.testing.assert_array_equal(both.x[0], x[37:])
    moment = datetime(2024, 5, 1, tzinfo=UTC)
    timed = align([Recording([x + 0j], FS, 24e9, moment), two], delays=[2.0, 2.0 + found.delay])
    np.testing.assert_array_equal(timed.x, both.x)
    assert (timed.start - moment).total_seconds() == pytest.approx(37.3 / FS, abs=1e-5)
    with pytest.raises(ValueError, match=r"delays must have shape \(2,\), got \(1,\)"):
        align([one, two], delays=[0.0])
