"""The settings are those of the thesis's text, of its code, or ours, and which is said."""

import numpy as np
import pytest

from dopplerlib.systems import asheim2015 as thesis


def test_text_and_code_differ_where_the_code_does_not_square():
    text, code = thesis.filter_settings("text"), thesis.filter_settings("code")
    sigma = thesis.reported().scenario.filter.sigma_range
    assert text.R(1.0)[0] == pytest.approx(sigma**2)
    assert code.R(1.0)[0] == pytest.approx(sigma)
    assert text.R(1.0)[1] == code.R(1.0)[1]
    assert not np.allclose(np.diag(text.Q), np.diag(code.Q))


def test_the_process_noise_of_the_code_is_white_noise_acceleration_over_the_interval():
    """Its spectral density thus depends on the interval: 1 m^2/s^3 at 0.1 s, 0.1 at 1 s."""
    for T, q in ((0.1, 1.0), (1.0, 0.1)):
        code, same = thesis.filter_settings("code", T), thesis.filter_settings("modern", T, q=q)
        np.testing.assert_allclose(code.Q, same.Q, rtol=1e-12)


def test_the_gate_of_text_and_code_is_the_same_box():
    """|nu| < sqrt(c sigma), by hand: the roots of 0.8 and of 0.4."""
    for name in ("text", "code"):
        np.testing.assert_allclose(thesis.filter_settings(name).box, [0.8944, 0.6325], atol=5e-5)


def test_the_resolutions_are_those_of_pulse_and_integration():
    np.testing.assert_allclose(thesis.resolutions(), [0.15, 0.3 / 14], rtol=1e-12)
    np.testing.assert_allclose(
        thesis.noise_std(3.5), np.array(thesis.resolutions()) / np.sqrt(20), rtol=1e-12
    )


def test_our_measurement_noise_is_the_law_with_a_floor():
    modern, bare = (
        thesis.filter_settings("modern"),
        thesis.filter_settings("modern", floor=(0.0, 0.0)),
    )
    d = np.array([0.5, 4.0])
    np.testing.assert_allclose(bare.R(d), thesis.noise_std(d) ** 2)
    np.testing.assert_allclose(
        modern.R(d), thesis.noise_std(d) ** 2 + [0.02**2, 0.01**2], rtol=1e-12
    )


def test_an_unknown_name_is_refused():
    with pytest.raises(ValueError, match="name must be one of 'text', 'code', 'modern'"):
        thesis.filter_settings("thesis")
    with pytest.raises(ValueError, match="gate must be one of"):
        thesis.filter_settings("code", gate="round")


def test_the_printed_numbers_agree_where_they_stand_twice():
    s, q = thesis.reported().scenario, thesis.reported().quoted
    f = s.filter
    assert f.text.Q_diagonal.tolist() == [f.text.range_variance, f.text.velocity_variance]
    assert q.noise.snr_useless == s.error_area.snr


def test_the_constants_that_are_printed_twice_contradict_each_other():
    n, q = thesis.reported().scenario.noise, thesis.reported().quoted.noise
    assert n.speed_of_light / n.frequency == pytest.approx(3 / 70)
    assert q.wavelength_published / (3 / 70) == pytest.approx(1.15, abs=0.01)
    resolutions = [one / (2 * n.integration) for one in (q.wavelength_code, q.wavelength_published)]
    told = q.velocity_resolution_published
    assert [abs(one - told) < 5e-5 for one in resolutions] == [True, False]
    assert thesis.resolutions()[0] == pytest.approx(n.speed_of_light * 1e-9 / 2)
    assert q.pulse_exponent_published == 9  # and not -9


def test_the_law_has_less_than_the_text_says_at_one_meter_and_at_the_error_area():
    """By hand: 52 - 12 = 40 dB, and 52 - 12 sqrt(16.25) = 3.6 dB."""
    q, area = thesis.reported().quoted.noise, thesis.reported().scenario.error_area
    assert thesis.snr(1.0) == pytest.approx(40.0) and q.snr_at_one_published == 42.0
    d = np.hypot(*(np.array(area.position) - thesis.radar_positions()).T)
    np.testing.assert_allclose(thesis.snr(d), 3.63, atol=0.005)
    assert area.snr == 10.0


def test_four_meters_on_both_axes_are_the_useful_range_and_the_real_one_has_two_values():
    q = thesis.reported().quoted.range
    assert np.hypot(q.axis, q.axis) == pytest.approx(q.fused, abs=0.005)
    assert q.real_abstract != q.real_conclusion
