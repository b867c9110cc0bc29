"""Symptoms speak for the cause that was made on purpose. The study of symptoms counts how often."""

from dataclasses import replace

import numpy as np
import pytest

from dopplerlib import RadarArray
from dopplerlib.chain.setup import Setup
from dopplerlib.chain.simulation import simulate_recording
from dopplerlib.evaluation.symptoms import symptoms

ARRAY = RadarArray([[0, 0.5, 1], [0, 2.5, 1.4], [0, 3.7, 1]], 0.0285)
SETUP = Setup(
    ARRAY, ([1, 0, 1.2], [6, 5, 1.2]), 2.5, 0.01, 0.05, 0.4, search="whole", noise="horizontal"
)
FS = 1000


@pytest.fixture(scope="module")
def recording():
    rng = np.random.default_rng(21)
    path = [4.6, 1.5, 1.2] + np.arange(1500)[:, None] / FS * [-1.4, 0.4, 0]
    return simulate_recording(path, ARRAY, FS, rng=rng, snr_db=18)


def with_samples(recording, x):
    return replace(recording, x=x, valid=None)


def test_a_sound_recording_shows_nothing(recording):
    """Each of five checks and the explanation reject with a probability of 0.001."""
    found = symptoms(recording, SETUP)
    assert found.cause == "none found" and found.explanation is None
    assert all(check.passed for check in found.checks)
    assert 0.2 < found.nis < 1.5 and found.chirp < 0.1 and np.isnan(found.line)
    np.testing.assert_array_equal(found.present, [1, 1, 1])


def hum(r):
    return r.x + 0.05 * (1 + 0.7j) * np.cos(2 * np.pi * 50 * r.time)


def dead(r):
    return np.where((np.arange(3)[:, None] == 1) & (r.time > 0.6), 0, r.x)


def noise(r):
    return np.random.default_rng(22).standard_normal((*r.x.shape, 2)) @ [0.1, 0.1j]


@pytest.mark.parametrize(
    ("spoil", "cause"),
    [
        (lambda r: r.x.imag + 1j * r.x.real, "I and Q exchanged"),
        (hum, "hum at 50 Hz"),
        (lambda r: r.x + 0.3 * r.time, "DC offset drifts"),
        (dead, "sensor 2 dead or blind"),
        (noise, "no target"),
    ],
)
def test_a_fault_of_the_samples_is_named(recording, spoil, cause):
    assert symptoms(with_samples(recording, spoil(recording)), SETUP).cause == cause


@pytest.mark.parametrize(
    ("change", "cause"),
    [({"window": 0.35, "start": 0.9}, "window too long"), ({"hop": 0.0125}, "windows overlap")],
)
def test_a_fault_of_the_settings_is_named(recording, change, cause):
    assert symptoms(recording, replace(SETUP, **change)).cause == cause
