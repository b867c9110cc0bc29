"""Real channels are not taken for I and Q, nor I and Q for real channels."""

import numpy as np
import pytest
from scipy.io import wavfile
from scipy.signal import hilbert

from dopplerlib import RadarArray
from dopplerlib.chain.baseband import Baseband
from dopplerlib.chain.simulation import simulate_baseband
from dopplerlib.signal.recording import (
    Recording,
    align,
    read_sigmf,
    read_wav,
    write_sigmf,
    write_wav,
)
from dopplerlib.systems import mittermaier2016

FS, CARRIER = 2000.0, 24e9


def noise(rng, sensors):
    return (
        rng.standard_normal((sensors, 2000)) + 1j * rng.standard_normal((sensors, 2000))
    ) / 2**0.5


def tones(rng, snr_db, sensors=6, gain=1.0, phase=0.0, dc=0.0):
    """Return tones of 70 to 600 Hz of either sign that change by up to 200 Hz/s, in noise."""
    t = np.arange(2000) / FS
    f = rng.uniform(70, 600, (sensors, 1)) * rng.choice([-1, 1], (sensors, 1))
    rate, start = rng.uniform(-200, 200, (sensors, 1)), rng.uniform(size=(sensors, 1))
    x = 10 ** (snr_db / 20) * np.exp(2j * np.pi * (f * t + rate * t**2 / 2 + start))
    x = x + noise(rng, sensors)
    return gain * x.real + dc + 1j * (x.imag * np.cos(phase) + x.real * np.sin(phase) + dc)


def scene(rng, snr_db):
    return simulate_baseband(
        mittermaier2016.reported().scenario, 1, rng=rng, fs=FS, snr_db=snr_db, factor=1
    ).x[0]


def real_channels(x):
    """Return the real parts as if those of two sensors were I and Q of one."""
    return x.real[::2] + 1j * x.real[1::2]


def flicker(rng):
    """Return noise whose power grows towards 0 Hz, from 100 Hz down."""
    f = np.maximum(np.abs(np.fft.fftfreq(2000, 1 / FS)), 1.0)
    return np.fft.ifft(np.fft.fft(noise(rng, 6)) * np.sqrt(1 + 100 / f))


def read(folder, x, **options):
    path = write_wav(folder / "a.wav", Recording(x, FS, CARRIER))
    return read_wav(path, CARRIER, **options)


# In 200 trials each none was refused; if 1 % were, these eight would see one in 8 of 100 times.
ACCEPTED = {
    "noise": lambda rng: noise(rng, 6),
    "flicker noise": flicker,
    "tones 5 dB below the noise": lambda rng: tones(rng, -5),
    "tones as strong as the noise": lambda rng: tones(rng, 0),
    "tones 50 dB above the noise": lambda rng: tones(rng, 50),
    "imbalance of 2 dB and 15 degrees": lambda rng: tones(rng, 0, gain=1.26, phase=0.26),
    "imbalance of 3.5 dB and 25 degrees": lambda rng: tones(rng, 20, gain=1.5, phase=0.44),
    "DC 60 dB above the noise": lambda rng: tones(rng, 20, gain=1.2, phase=0.17, dc=1e3),
    "Table 2": lambda rng: scene(rng, 27),
}

# In 200 trials each (60 of the scene) all were refused.
REFUSED = {
    "tones 10 dB above the noise": lambda rng: real_channels(tones(rng, 10)),
    "tones 50 dB above the noise": lambda rng: real_channels(tones(rng, 50)),
    "two channels": lambda rng: real_channels(tones(rng, 10, sensors=2)),
    "Table 2": lambda rng: real_channels(scene(rng, 27)),
    "two sensors of Table 2": lambda rng: real_channels(scene(rng, 27)[:2]),
    "one sensor and noise": lambda rng: 30 * tones(rng, 20, 1).real + 1j * noise(rng, 1).real,
}


@pytest.mark.parametrize("kind", ACCEPTED)
def test_i_and_q_are_taken_for_what_they_are(tmp_path, kind):
    rng = np.random.default_rng(1)
    for _ in range(8):
        x = ACCEPTED[kind](rng)
        np.testing.assert_array_equal(read(tmp_path, x).x, x)


@pytest.mark.parametrize("kind", REFUSED)
def test_real_channels_are_not_taken_for_i_and_q(tmp_path, kind):
    rng = np.random.default_rng(2)
    for _ in range(4):
        x = REFUSED[kind](rng)
        with pytest.raises(
            ValueError, match=r"^layout must be given for a.wav, .* sensor \d.*None$"
        ):
            read(tmp_path, x)
        np.testing.assert_array_equal(read(tmp_path, x, layout="iq").x, x)


def test_a_sensor_without_q_costs_that_sensor_only(tmp_path):
    for q in (0.0, 0.5):
        x = scene(np.random.default_rng(3), 27).copy()
        x[2] = x[2].real + 1j * q
        recording = read(tmp_path, x)
        assert recording.valid[[0, 1, 3, 4, 5]].all() and not recording.valid[2].any()


def test_q_and_i_are_exchanged_where_they_are_told_to_be(tmp_path):
    x = scene(np.random.default_rng(4), 27)
    turned = read(tmp_path, x, layout="qi")
    np.testing.assert_array_equal(turned.x, x.imag + 1j * x.real)
    meta = write_sigmf(tmp_path / "a", Recording(x, FS, CARRIER))
    assert read_sigmf(meta, layout="qi") == turned


@pytest.mark.parametrize("sensors", [1, 5, 6])
def test_real_channels_become_analytic_signals(tmp_path, sensors):
    """Of the right amplitude, with positive Doppler shifts, valid where the channel was."""
    x = tones(np.random.default_rng(5), 30, sensors).real
    x[0, 500:600] = x[0, 500]  # a sensor that sticks
    wavfile.write(tmp_path / "a.wav", int(FS), x.T)
    recording = read_wav(tmp_path / "a.wav", CARRIER, layout="real")
    np.testing.assert_allclose(recording.x, hilbert(x), rtol=0, atol=1e-10)
    assert recording.without_q and align([recording]).without_q
    array = RadarArray(np.arange(3 * sensors).reshape(-1, 3), recording.wavelength)
    assert Baseband.from_recording(recording, array).without_q
    with pytest.raises(ValueError, match="recordings must all have a Q, or none of them"):
        align([recording, Recording(x + 0j, FS, CARRIER)])
    assert not recording.valid[0, 500:600].any()
    assert recording.valid[:, :490].all() and recording.valid[:, 610:].all()


def real_sigmf(folder, x):
    """Write real channels (C, n) as SigMF."""
    meta = write_sigmf(
        folder / "a", Recording(noise(np.random.default_rng(0), len(x)), FS, CARRIER)
    )
    text = meta.read_text().replace("cf64_le", "rf64_le")
    meta.write_text("\n".join(line for line in text.splitlines() if "sha512" not in line))
    (folder / "a.sigmf-data").write_bytes(np.ascontiguousarray(x.T).tobytes())
    return meta


def test_pairs_that_turn_are_not_taken_for_real_channels(tmp_path):
    x = scene(np.random.default_rng(6), 27)
    meta = real_sigmf(tmp_path, np.stack([x.real, x.imag], axis=1).reshape(12, -1))
    with pytest.raises(
        ValueError, match=r"^layout must be given for a.sigmf-meta, .* turn together"
    ):
        read_sigmf(meta)
    np.testing.assert_array_equal(read_sigmf(meta, layout="iq").x, x)
    assert read_sigmf(real_sigmf(tmp_path, x.real)).x.shape == x.shape


@pytest.mark.parametrize(
    "layout, channels, message",
    [
        ("IQ", 2, "layout must be one of 'iq', 'qi', 'real', got 'IQ'"),
        (1, 2, "layout must be one of 'iq', 'qi', 'real', got 1"),
        ("iq", 3, "a.wav must have two channels .*, got 3"),
        ("qi", 1, "a.wav must have two channels .*, got 1"),
        (None, 5, "a.wav must have two channels .* unless layout is 'real', got 5"),
    ],
)
def test_a_layout_that_does_not_fit_is_refused(tmp_path, layout, channels, message):
    wavfile.write(tmp_path / "a.wav", 8000, noise(np.random.default_rng(7), channels).real.T)
    with pytest.raises(ValueError, match=f"^{message}$"):
        read_wav(tmp_path / "a.wav", CARRIER, layout=layout)


def test_complex_samples_are_no_real_channels(tmp_path):
    meta = write_sigmf(tmp_path / "a", Recording(noise(np.random.default_rng(8), 2), FS, CARRIER))
    with pytest.raises(
        ValueError, match=r"layout must be 'iq' or 'qi' for a.sigmf-meta, which is c"
    ):
        read_sigmf(meta, layout="real")
