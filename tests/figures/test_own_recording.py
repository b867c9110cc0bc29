"""Figures of a recording and its track show what they are given."""

import numpy as np
import pytest

from dopplerlib import RadarArray, chi2_interval
from dopplerlib.chain.alarm import stop_alarm
from dopplerlib.chain.setup import Setup
from dopplerlib.chain.simulation import simulate_recording
from dopplerlib.figures import own_recording as draw
from dopplerlib.signal.spectrogram import Spectrogram

TIME, FREQUENCY = np.array([1.0, 3.0]), np.array([-10.0, 0.0, 10.0])
DENSITY = np.array([[1.0, 10.0], [100.0, np.nan], [1.0, 1e9]])


def test_a_panel_shows_levels_where_they_belong():
    figure = draw.spectrogram(Spectrogram(TIME, FREQUENCY, DENSITY), wavelength=0.1)
    panel, bar = figure.axes
    (image,) = panel.images
    np.testing.assert_allclose(image.get_array().filled(np.nan), 10 * np.log10(DENSITY))
    assert image.get_extent() == [0.0, 4.0, -15.0, 15.0]
    assert image.get_clim() == (30.0, 90.0)  # at most 60 dB
    assert (panel.get_xlabel(), panel.get_ylabel()) == ("time (s)", "frequency (Hz)")
    assert bar.get_ylabel() == "power density (dB)"
    (speed,) = panel.child_axes
    figure.draw_without_rendering()
    np.testing.assert_allclose(speed.get_ylim(), (-0.75, 0.75))  # f wavelength / 2


def test_a_band_and_one_panel_for_each_sensor():
    seen = Spectrogram(TIME, FREQUENCY, np.stack([DENSITY] * 3))
    *panels, _ = draw.spectrogram(seen, band=(0, 20)).axes
    assert [len(ax.images) for ax in panels] == [1, 1, 1, 0]
    assert [ax.get_title("left") for ax in panels[:3]] == ["sensor 1", "sensor 2", "sensor 3"]
    assert panels[0].images[0].get_array().shape == (2, 2)


def test_nothing_to_show_is_refused():
    with pytest.raises(ValueError, match="band must hold a frequency of the spectrogram"):
        draw.spectrogram(Spectrogram(TIME, FREQUENCY, DENSITY), band=(11, 20))
    with pytest.raises(ValueError, match="seen must hold power"):
        draw.spectrogram(Spectrogram(TIME, FREQUENCY, np.nan * DENSITY))


@pytest.fixture(scope="module")
def setup():
    array = RadarArray([[0, 0.5, 1], [0, 2.5, 1.4], [0, 3.7, 1]], 0.0285)
    return Setup(array, ([1, 0, 1.2], [6, 5, 1.2]), 2.5, 0.01, 0.05, 0.4, search="whole")


@pytest.fixture(scope="module")
def path():
    return [4.6, 1.5, 1.2] + np.arange(1000)[:, None] / 1000 * [-1.4, 0.4, 0]


@pytest.fixture(scope="module")
def found(setup, path):
    x = simulate_recording(path, setup.array, 1000, rng=np.random.default_rng(31), snr_db=18)
    return setup.track(setup.baseband(x))


def test_shifts_are_drawn_beside_those_that_the_track_predicts(found, setup):
    ax = draw.shifts(found, setup).axes[0]
    dots = [bar.lines[0] for bar in ax.containers]
    np.testing.assert_array_equal([dot.get_ydata() for dot in dots], found.shift.T)
    curves = [line for line in ax.lines if len(line.get_xdata()) == len(found.time) - found.used]
    for curve, measured in zip(curves, found.shift[found.used :].T, strict=True):
        np.testing.assert_allclose(curve.get_ydata(), measured, atol=2.0)


def test_residuals_are_in_standard_deviations_with_the_interval_of_nis(found):
    upper, lower = draw.residuals(found).axes
    track = found.final_track
    expected = track.innovation / np.sqrt(np.diagonal(track.S, axis1=-2, axis2=-1))
    np.testing.assert_allclose([line.get_ydata() for line in upper.lines], expected.T)
    np.testing.assert_array_equal(lower.lines[0].get_ydata(), found.final_nis)
    band = lower.patches[0].get_bbox()
    np.testing.assert_allclose([band.y0, band.y1], chi2_interval(3))
    assert f"mean {found.final_nis.mean():.3g}, expected 3" == lower.texts[0].get_text()


def test_views_show_sensors_track_truth_and_alarm(found, setup, path):
    alarm = stop_alarm(found, [0, 2.5, 1.2], 4.0)
    above, side = draw.views(found, setup, path, alarm).axes
    by_name = {line.get_label(): line for line in side.lines}
    np.testing.assert_array_equal(by_name["sensors"].get_xydata(), setup.array.positions[:, [0, 2]])
    np.testing.assert_array_equal(by_name["track"].get_xydata(), found.live[1][:, [0, 2]])
    np.testing.assert_array_equal(by_name["truth"].get_xydata(), path[:, [0, 2]])
    (mark,) = (line for line in above.lines if line.get_label() == "alarm")
    at = found.live[1][np.argmax(alarm.alarm)]
    np.testing.assert_array_equal(mark.get_xydata(), [at[:2]])
