"""What a type checker sees of the library: `make lint` reads this file, nothing runs it."""

from pathlib import Path
from typing import assert_type

import numpy as np

import dopplerlib
from dopplerlib import (
    DopplerRecord,
    InitialEstimate,
    RadarArray,
    Scenario,
    Track,
    average_interval,
    chi2_interval,
    constant_velocity,
    crlb,
    doppler_shift,
    ekf,
    kf_update,
    ml_frequency,
    ml_initialize,
    nees,
    simulate,
    sliding_doppler,
)
from dopplerlib._typing import ComplexArray, FloatArray

rng = np.random.default_rng(1)
ring = RadarArray.ring(6, 0.2, normal="x")
assert_type(ring, RadarArray)
assert_type(ring.doppler_per_speed, float)
assert_type(RadarArray([[0, 0, 0.1], [0, 0, -0.1]], wavelength=0.01), RadarArray)
scenario = Scenario.from_toml(Path("scenario.toml"))
assert_type(scenario, Scenario)
assert_type(Scenario(ring, [1, 0, 0, -1, 0, 0], 0.001, 100, 0.4, 0.4, np.eye(6)), Scenario)
assert_type(simulate(scenario, 2, rng=rng), tuple[FloatArray, FloatArray])

# What is like an array may be given, and a whole number for a float.
x = [1, 0, 0, -1, 0, 0]
assert_type(doppler_shift(x, ring), FloatArray)
assert_type(constant_velocity(1, 1, noise="shared"), tuple[FloatArray, FloatArray])
assert_type(crlb(x, ring, 0.4, free=[True] * 6), FloatArray)
track = ekf([[0.0] * 6], ring, x, np.eye(6), 0.001, 0.4, 0.4, gate="upper", keep=["P"])
assert_type(track, Track)
assert_type(nees(track, [x]), FloatArray)
assert_type(ml_initialize([[0.0] * 6], ring, 0.4, 0.001, ([0] * 6, [1] * 6)), InitialEstimate)
assert_type(kf_update(x, np.eye(6), [0], np.eye(6)[:1], [[1]])[0], FloatArray)
assert_type(chi2_interval(6), tuple[float, float])
assert_type(average_interval(6, 10), tuple[float, float])

# Modules are attributes of their packages; names that load when they are used have their types.
assert_type(dopplerlib.ml_frequency([1, 1j], 1e3), FloatArray)
assert_type(dopplerlib.signal.synthesis.complex_noise(3, 1.0, rng=rng), ComplexArray)
assert_type(sliding_doppler(np.ones((1, 9), complex), 1e3, window=3, hop=3), DopplerRecord)
sliding_doppler([[1, 1j]], 1e3, window=2, hop=2, estimator=ml_frequency, timestamp="center")

# What is wrong is found: each of these lines would be an error without its comment.
ekf([[0.0] * 6], ring, x, np.eye(6), 0.001, 0.4, 0.4, gate="lower")  # type: ignore[arg-type]
doppler_shift(x, [[0, 0, 0]])  # type: ignore[arg-type]
simulate(scenario, 2, rng=1)  # type: ignore[arg-type]
RadarArray.ring(6, 0.2, normal="w")  # type: ignore[arg-type]
ring.wavelength = 1.0  # type: ignore[misc]
print(dopplerlib.kalman)  # type: ignore[attr-defined]
print(dopplerlib.signal.nothing)  # type: ignore[attr-defined]
