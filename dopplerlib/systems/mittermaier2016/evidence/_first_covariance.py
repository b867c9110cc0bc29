"""Evidence on the initial covariance, on bad starts, and on the error of linearization."""

from functools import cache

import numpy as np

from ...._hints import checked
from ....evaluation.consistency import chi2_interval, nees, nis
from ....evaluation.intervals import proportion_interval, quantile_interval
from ....model.doppler import doppler_jacobian, doppler_shift
from ....model.simulation import simulate
from ....replication.evidence import Draws, sweep
from ..published import reported
from ..start import table2_starts
from ._runs import choices, example_runs, starts, tracked

_RUNS = 600
_MATRICES = 2000
_LATER = (0.05, 0.1, 0.2, 0.3, 0.5, 1.0)  # s, all that the choices of a moment name


@checked
def covariance_evidence(rng: np.random.Generator) -> dict[str, object]:
    """Return evidence by the id of the claim, see `evidence`."""
    records, noise, initial, bad, runs, points = rng.spawn(6)
    return (
        _sizes(records, noise)
        | sweep(choices("start", "off-diagonal-or-none"), _initial_nees, initial)
        | sweep(choices("bad-start"), _bad_start, bad)
        | _updates(runs, points)
    )


def _sizes(rng, noise):
    """Return ratios of errors of the same records filtered with two covariances of the start."""
    s = reported().scenario
    record, again = rng.spawn(2)
    truth, z = simulate(s, _RUNS, rng=record)
    anew = table2_starts(_RUNS, rng=again, likelihood="stationary").start.x
    all_starts = starts() | {"drawn anew": anew}
    shares = choices("off-diagonal")[0]
    covariances = {
        share: noisy_covariances(share, _RUNS, child)
        for share, child in zip(
            shares.values + shares.beyond,
            noise.spawn(len(shares.values + shares.beyond)),
            strict=True,
        )
    }

    @cache
    def errors(start, scale, share=0.0):
        P0 = covariances[share] if share else scale * np.eye(6)
        track = tracked(z, s.array, all_starts[start], P0)
        return np.linalg.norm((track.x - truth)[..., :3], axis=-1)

    def larger(start, sizes, average):
        """Return the ratio of a whole record's error to that of a smaller covariance."""
        large, small = (float(size.split(" ")[0]) for size in sizes.split(" with "))
        power = 1 if average == "mean" else 2
        ratio = np.mean(errors(start, large) ** power, axis=1)
        ratio = (ratio / np.mean(errors(start, small) ** power, axis=1)) ** (1 / power)
        return {"larger-covariance": quantile_interval(ratio)}

    def noisy(start, share, moment):
        k = round(moment / s.T)
        ratio = errors(start, s.P0[0, 0], share)[:, k] / errors(start, s.P0[0, 0])[:, k]
        return {"noise-on-covariance": quantile_interval(ratio)}

    return sweep(choices("any-start", "larger", "mean-error"), larger) | sweep(
        choices("any-start", "off-diagonal", "moment"), noisy
    )


def noisy_covariances(share, number, rng):
    """Return 0.1 I with normal noise on the off-diagonals, as far as it is a covariance."""
    P0 = reported().scenario.P0
    found = np.empty((0, 6, 6))
    while len(found) < number:
        noise = np.triu(rng.standard_normal((number, 6, 6)) * share * P0[0, 0], 1)
        P = P0 + noise + np.swapaxes(noise, -1, -2)
        found = np.concatenate([found, P[np.linalg.eigvalsh(P)[:, 0] > 0]])
    return found[:number]


def _initial_nees(rng, start, share):
    s = reported().scenario
    error = np.broadcast_to(starts()[start] - s.x0, (_MATRICES, 6))
    return {"nees-initial": Draws(nis(error, noisy_covariances(share, _MATRICES, rng)))}


def bad_start(name):
    """Return a start by a value of the choice `bad-start`."""
    x0 = reported().scenario.x0
    if name == "mirrored in the plane of the sensors":
        return x0 * [-1, 1, 1, -1, 1, 1]
    away = 0.3 if name == "0.3 m too far" else -0.3
    return np.concatenate([x0[:3] * (1 + away / np.linalg.norm(x0[:3])), x0[3:]])


def _bad_start(rng, name):
    """Return the error of a record over that from the start of Table 2."""
    s = reported().scenario
    truth, z = simulate(s, _RUNS, rng=rng)
    bad, usual = (
        tracked(z, s.array, start, s.P0).x - truth
        for start in (bad_start(name), starts()["Table 2"])
    )
    ratio = np.divide(*(np.linalg.norm(e[..., :3], axis=-1).mean(axis=1) for e in (bad, usual)))
    return {"bad-start": quantile_interval(ratio)}


def _updates(rng, points):
    """Return linearization errors at the start and later, and the fraction of consistent NEES."""
    s = reported().scenario
    moments = [round(t / s.T) for t in _LATER]
    runs = example_runs(
        rng,
        ("gate", "start"),
        _RUNS,
        lambda result: {
            "x": result.track.x[:, moments],
            "P": result.track.P[:, moments],
            "truth": np.broadcast_to(result.truth[moments], result.track.x[:, moments].shape),
            "nees": nees(result.track, result.truth)[:, moments],
        },
        ("P",),
        chunk=200,
    )
    lower, upper = chi2_interval(6)

    def first(rng, start, whose):
        x = np.repeat(starts()[start][None], _RUNS, axis=0)
        tried = errors_of(x, s.P0, s.x0, whose, rng)
        return {"tangent-first": quantile_interval(neglected(x, tried))}

    def later(rng, gate, start, moment, whose):
        run, k = runs(gate, start), _LATER.index(moment)
        tried = errors_of(run["x"][:, k], run["P"][:, k], run["truth"][:, k], whose, rng)
        return {"tangent-later": quantile_interval(neglected(run["x"][:, k], tried))}

    def consistent(gate, start, moment):
        value = runs(gate, start)["nees"][:, _LATER.index(moment)]
        return {"filter-consistent": proportion_interval((lower <= value) & (value <= upper))}

    return (
        sweep(choices("start", "whose-error"), first, points)
        | sweep(choices("gate", "start", "later", "whose-error"), later, points)
        | sweep(choices("gate", "start", "moment"), consistent)
    )


def errors_of(x, P, truth, whose, rng):
    """Return errors, shape (runs, draws, 6): as the filter states them, or the actual one."""
    if whose == "actual":
        return np.broadcast_to(truth - x, x.shape)[:, None]
    normal = rng.standard_normal((len(x), 6, 40))
    return np.swapaxes(np.linalg.cholesky(P) @ normal, -1, -2)


def neglected(x, away):
    """Return the part of a shift that the tangent misses, in its standard deviations."""
    s = reported().scenario
    tangent = away @ np.swapaxes(doppler_jacobian(x, s.array), -1, -2)
    there, here = doppler_shift(x[:, None] + away, s.array), doppler_shift(x, s.array)[:, None]
    return np.sqrt(np.mean((there - here - tangent) ** 2, axis=(1, 2))) / s.sigma_f
