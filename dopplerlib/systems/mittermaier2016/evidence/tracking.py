"""Evidence on the simulation example: the same record again and again, with other noise."""

from dataclasses import replace
from itertools import product

import numpy as np

from ...._hints import checked
from ....estimation.extended_kalman import ekf
from ....evaluation.bounds import crlb
from ....evaluation.consistency import chi2_interval, nees, nis
from ....evaluation.intervals import (
    ConfidenceInterval,
    mean_interval,
    proportion_interval,
    quantile_interval,
)
from ....model.doppler import doppler_jacobian, doppler_shift
from ....model.motion import constant_velocity
from ....model.radar_array import RadarArray
from ....model.simulation import simulate
from ....replication.evidence import Draws, Readings
from ..example import run_example
from ..published import reported
from ..start import table2_starts

_RUNS = 1200
_SETTLED = 10  # samples; the innovations of the start are tens of times as large
_KNOWN = 24  # sample from which on all drawn errors are known


@checked
def tracking_evidence(rng: np.random.Generator) -> dict[str, object]:
    """Return evidence by the id of the claim, see `evidence`."""
    runs, sizes, rotation, updates, right, covariances = rng.spawn(6)
    return (
        _readings(runs)
        | _sizes(sizes)
        | _rotation(rotation)
        | _updates(updates)
        | _right_filter(right)
        | _initial_nees(covariances)
    )


def _starts():
    return {"start of Table 2": reported().table2.x_ml, "start as drawn": reported().figure6.start}


def _readings(rng):
    """Return statistics of whole runs by interpretation: with or without gate, either start."""
    found = {}
    *children, drawn_run = rng.spawn(5)
    gates = {"no gate": None, "two-sided gate": "two-sided"}
    for child, (gate, start) in zip(children, product(gates, _starts()), strict=True):
        result = run_example(
            _RUNS, rng=child, gate=gates[gate], start=_starts()[start], keep=("innovation",)
        )
        for name, evidence in _of_any_run(result).items():
            found.setdefault(name, {})[f"{gate}, {start}"] = evidence
    # What is drawn was drawn with the gate and from the drawn start, says the figure itself.
    start = reported().figure6.start
    parts = []
    for child in drawn_run.spawn(4):  # all runs at once would need a gigabyte
        result = run_example(_RUNS, rng=child, gate="two-sided", start=start, keep=())
        parts.append(_of_the_drawn_run(result))
    drawn = {
        name: Draws(np.concatenate([part[name][0] for part in parts]), float(theirs))
        for name, (_, theirs) in parts[0].items()
    }
    found["range-most"] = {k: v for k, v in found["range-most"].items() if "no gate" not in k}
    return {name: Readings(by_name) for name, by_name in found.items()} | drawn


def _of_any_run(result):
    value, error = result.track.nis, 100 * result.error
    lower, upper = chi2_interval(6)
    average = value.mean(axis=1)
    low, high = chi2_interval(6, runs=value.shape[1])
    mean_error = np.abs(result.track.x - result.truth).mean(axis=1)
    innovation = result.track.innovation[:, _SETTLED:].mean(axis=1)
    return {
        "nis-average": Draws(average),
        "nis-inside": Draws(100 * ((lower <= value) & (value <= upper)).mean(axis=1)),
        "nis-matches": proportion_interval((low <= average) & (average <= high)),
        "innovation-low": Draws(innovation.min(axis=1)),
        "innovation-high": Draws(innovation.max(axis=1)),
        "final-quoted": Draws(np.linalg.norm(error[:, -1], axis=-1)),
        "range-median": quantile_interval(error[:, -1, 0]),
        "range-most": proportion_interval(error[:, -1, 0] < 1),
        "z-worst": proportion_interval(mean_error[:, :3].argmax(axis=1) == 2),
        "vx-best": proportion_interval(mean_error[:, 3:].argmin(axis=1) == 0),
        "vy-before-vz": proportion_interval(mean_error[:, 4] < mean_error[:, 5]),
        "decreasing": _least_decrease(np.linalg.norm(error, axis=-1)),
    }


def _of_the_drawn_run(result):
    """Return the quantities that the curves of Fig 6 show: those of our runs and the drawn ones."""
    drawn = reported().figure6
    value, skipped = result.track.nis, ~result.track.updated
    return {
        "nis-first-ten": (value[:, :10].mean(axis=1), drawn.nis[:10].mean()),
        "skipped-low": (
            (skipped & (value < 6)).sum(axis=1),
            (drawn.skipped & (drawn.nis < 6)).sum(),
        ),
        "skipped-high": (
            (skipped & (value > 6)).sum(axis=1),
            (drawn.skipped & (drawn.nis > 6)).sum(),
        ),
        "final-drawn": [
            100 * np.linalg.norm(e[..., -1, :], axis=-1) for e in (result.error, drawn.error)
        ],
        "error-x": [100 * e[..., _KNOWN:, 0].mean(axis=-1) for e in (result.error, drawn.error)],
        "error-z": [100 * e[..., _KNOWN:, 2].mean(axis=-1) for e in (result.error, drawn.error)],
    }


def _least_decrease(error):
    """Return the median ratio of the error in a tenth of the record before, at its worst."""
    tenths = np.sqrt(np.mean(error[:, 1:].reshape(len(error), 10, -1) ** 2, axis=-1))
    ratios = tenths[:, 1:] / tenths[:, :-1]
    return quantile_interval(ratios[:, np.median(ratios, axis=0).argmax()])


def _tracked(z, array, start, P0):
    """Return the track from a start at the first sample, without a gate."""
    s = reported().scenario
    F, _ = constant_velocity(s.T, s.sigma_a)
    before = np.linalg.solve(F, start[..., None])[..., 0]
    return ekf(z, array, before, P0, s.T, s.sigma_a, s.sigma_f, keep=())


def _sizes(rng, runs=500):
    """Return ratios of errors of the same records filtered with two covariances of the start."""
    s = reported().scenario
    record, again, noise = rng.spawn(3)
    truth, z = simulate(s, runs, rng=record)
    starts = _starts() | {
        "starts of our own": table2_starts(runs, rng=again, likelihood="stationary").start.x
    }

    def errors(start, P0):
        return np.linalg.norm((_tracked(z, s.array, start, P0).x - truth)[..., :3], axis=-1)

    larger, noisy = {}, {}
    for name, start in starts.items():
        usual, smaller = errors(start, s.P0), errors(start, s.P0 / 10)
        ratio = quantile_interval(usual.mean(axis=1) / smaller.mean(axis=1))
        larger[f"as printed instead of a tenth, {name}"] = ratio
        if name == "start as drawn":
            ratio = smaller.mean(axis=1) / errors(start, s.P0 / 100).mean(axis=1)
            larger[f"a tenth instead of a hundredth, {name}"] = quantile_interval(ratio)
        plain = usual[:, 100]
        for share in (0.1, 0.2):
            ratio = errors(start, _noisy_covariances(share, runs, noise))[:, 100] / plain
            noisy[f"{100 * share:.0f} % of the diagonal, {name}"] = quantile_interval(ratio)
    return {"larger-covariance": Readings(larger), "noise-on-covariance": Readings(noisy)}


def _rotation(rng):
    """Return ratios of errors of z, with the ring turned by half the angle between two sensors."""
    s = reported().scenario
    turned = replace(s, array=RadarArray.ring(6, 0.2, phase=np.pi / 6))
    errors, bounds = [], []
    for one, child in zip((turned, s), rng.spawn(2), strict=True):
        truth, z = simulate(one, 1500, rng=child)
        track = _tracked(z, one.array, reported().table2.x_ml, s.P0)
        errors.append(np.log(np.abs(track.x - truth)[..., 2].mean(axis=1)))
        bounds.append(
            crlb(s.x0, one.array, s.sigma_f, s.samples, s.T, "constant_velocity")[2, 2] ** 0.5
        )
    change = mean_interval(errors[0] - errors[1])
    ratio = (float(np.exp(number)) for number in (change.value, change.low, change.high))
    readings = {
        "error of our runs": ConfidenceInterval(*ratio),
        "bound": float(bounds[0] / bounds[1]),
    }
    return {"rotation": Readings(readings)}


def _noisy_covariances(share, number, rng):
    """Return 0.1 I with normal noise on the off-diagonals, as far as it is a covariance."""
    P0 = reported().scenario.P0
    found = []
    while len(found) < number:
        noise = np.triu(rng.standard_normal((6, 6)) * share * P0[0, 0], 1)
        P = P0 + noise + noise.T
        if np.linalg.eigvalsh(P)[0] > 0:
            found.append(P)
    return np.stack(found)


def _initial_nees(rng):
    """Return the initial NEES, with noise on the off-diagonal elements of the covariance."""
    s = reported().scenario
    readings = {}
    for name, start in _starts().items():
        for share in (0.0, 0.1, 0.2):
            P0 = _noisy_covariances(share, _RUNS, rng)
            error = np.broadcast_to(start - s.x0, (_RUNS, 6))
            label = f"noise of {100 * share:.0f} %" if share else "no noise"
            readings[f"{label}, {name}"] = Draws(nis(error, P0))
    return {"nees-initial": Readings(readings)}


def _updates(rng, runs=200):
    """Return linearization errors at the start and later, and the fraction of consistent NEES."""
    s = reported().scenario
    result = run_example(runs, rng=rng, keep=("P",))
    k = round(0.5 / s.T)
    x, P = result.track.x[:, k], result.track.P[:, k]
    start = np.repeat(reported().table2.x_ml[None], runs, axis=0)
    value = nees(result.track, result.truth)[:, k]
    lower, upper = chi2_interval(6)
    return {
        "tangent-first": quantile_interval(_neglected(start, s.P0, rng)),
        "tangent-later": quantile_interval(_neglected(x, P, rng)),
        "filter-consistent": proportion_interval((lower <= value) & (value <= upper)),
    }


def _neglected(x, P, rng):
    s = reported().scenario
    normal = rng.standard_normal((len(x), 6, 40))
    away = np.swapaxes(np.linalg.cholesky(P) @ normal, -1, -2)
    tangent = away @ np.swapaxes(doppler_jacobian(x, s.array), -1, -2)
    there, here = doppler_shift(x[:, None] + away, s.array), doppler_shift(x, s.array)[:, None]
    return np.sqrt(np.mean((there - here - tangent) ** 2, axis=(1, 2))) / s.sigma_f


def _right_filter(rng, runs=500):
    """Return innovations and NIS of a consistent filter, which starts close to the truth."""
    s = reported().scenario
    deviation = 1e-3  # m and m/s
    child, noise = rng.spawn(2)
    start = s.x0 + deviation * child.standard_normal((runs, 6))
    P0 = deviation**2 * np.eye(6)
    track = run_example(runs, rng=noise, start=start, P0=P0, keep=("innovation",)).track
    mean = track.innovation[:, _SETTLED:].mean(axis=1)
    return {
        "innovation-zero": Draws(np.abs(mean).max(axis=1)),
        "nis-expectation": mean_interval(track.nis.mean(axis=1)),
    }
