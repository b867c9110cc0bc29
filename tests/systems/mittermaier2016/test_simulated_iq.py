"""The recording in results/ is the one that its seed gives, and holds what its README says."""

import json
import re

import numpy as np
import pytest

from dopplerlib._data import results
from dopplerlib.chain.simulation import MODULE_FAULTS
from dopplerlib.systems import mittermaier2016 as paper

RESULTS = results()
README = (RESULTS / "README.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def again(tmp_path_factory):
    return paper.write_simulated_iq(tmp_path_factory.mktemp("recording"))


@pytest.mark.parametrize("number", [1, 2], ids=["samples", "truth"])
def test_the_files_are_written_again_byte_for_byte(again, number):
    """Rounding to 16 bits hides the last bits in which processors differ."""
    assert again[number].read_bytes() == (RESULTS / again[number].name).read_bytes()


def test_so_are_the_settings_but_for_the_version_of_the_format(again):
    both = [json.loads(path.read_text()) for path in (again[0], RESULTS / again[0].name)]
    for settings in both:
        del settings["global"]["core:version"]
    assert both[0] == both[1]


def test_the_files_are_small():
    assert sum(path.stat().st_size for path in RESULTS.glob("simulated_recording*")) < 100_000


def test_another_seed_gives_another_recording(monkeypatch, tmp_path):
    monkeypatch.setitem(paper.SIMULATED, "seed", 1)
    other = paper.write_simulated_iq(tmp_path)
    assert other[1].read_bytes() != (RESULTS / other[1].name).read_bytes()


def test_the_readme_tells_the_settings():
    told = paper.SIMULATED | MODULE_FAULTS
    for pattern, key in [
        (r"\| seed \| (\d+),", "seed"),
        (r"\| (?:\d+) for each channel at (\d) kHz", "kHz"),
        (r"\| echo \| amplitude ([\d.]+) in", "amplitude"),
        (r"power is (\d+) dB above its", "snr_db"),
        (r"Q (\d) dB stronger", "gain_db"),
        (r"and (\d)° off", "phase_deg"),
    ]:
        number = float(re.search(pattern, README).group(1))
        assert number == (told["fs"] / 1e3 if key == "kHz" else told[key]), key
    assert (
        complex(re.search(r"constant of ([\d.]+ \+ [\d.]+j)", README).group(1).replace(" ", ""))
        == MODULE_FAULTS["dc"]
    )


def test_its_noise_and_its_constant_are_as_told():
    """Means over 2001 samples: the noise variance is off by 1 % or so, 5 % is five deviations."""
    iq, _, _ = paper.read_simulated_iq()
    level = paper.SIMULATED["amplitude"]
    mean = iq.x[0].mean(axis=-1)
    dc = MODULE_FAULTS["dc"]
    g, phi = 10 ** (MODULE_FAULTS["gain_db"] / 20), np.deg2rad(MODULE_FAULTS["phase_deg"])
    expected = level * (dc.real + 1j * g * (dc.imag * np.cos(phi) + dc.real * np.sin(phi)))
    # an echo of some hundred turns has a mean of less than a hundredth of its amplitude
    np.testing.assert_allclose(mean, expected, atol=0.02 * level)
    power = np.mean(np.abs(iq.x[0] - mean[:, None]) ** 2, axis=-1) / level**2
    np.testing.assert_allclose(power, (1 + g**2) / 2, rtol=0.03)


def test_the_truth_is_the_track_of_table_2():
    s = paper.reported().scenario
    _, time, truth = paper.read_simulated_iq()
    assert time[0] == 0 and time[-1] == s.time[-1]
    picked = np.round(time / s.T).astype(int)
    np.testing.assert_allclose(truth, s.truth[picked], atol=0.51e-6)


def test_a_recording_of_another_wavelength_is_refused(again):
    meta = json.loads(again[0].read_text())
    meta["captures"][0]["core:frequency"] *= 1.1
    again[0].write_text(json.dumps(meta))
    with pytest.raises(ValueError, match=r"must have the wavelength 0\.0125 m"):
        paper.read_simulated_iq(again[0].parent)
