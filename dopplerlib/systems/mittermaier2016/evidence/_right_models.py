"""Evidence on theory, in a world in which the models of the filter are right."""

from functools import cache

import numpy as np

from ...._hints import checked
from ....estimation.extended_kalman import ekf
from ....estimation.linear_kalman import kf
from ....evaluation.averages import nees_samples
from ....evaluation.consistency import chi2_interval, nis
from ....evaluation.intervals import ConfidenceInterval, mean_interval
from ....model.doppler import doppler_jacobian, doppler_shift
from ....model.motion import constant_velocity
from ....replication.evidence import Draws, sweep
from ..published import reported
from ._runs import choices

_RUNS = 500
_SHORT = 20  # samples; NEES of one moment is averaged over runs, since in a run it has a memory
_MANY = 120_000  # short runs: an average of chi-square numbers is then good to 0.17 %
_LAGS = 20  # of the autocorrelation of NIS, as in tests of whiteness


@checked
def right_evidence(rng: np.random.Generator) -> dict[str, object]:
    """Return evidence by the id of the claim, see `evidence`."""
    (deviations,) = choices("small-start")
    values = deviations.values + deviations.beyond
    children = dict(zip(values, rng.spawn(len(values)), strict=True))
    runs = cache(lambda deviation: _described(children[deviation], deviation))
    return (
        sweep(choices("small-start"), lambda deviation: _averages(runs(deviation)))
        | sweep(
            choices("small-start", "left-out"),
            lambda deviation, number: {
                "innovation-zero": Draws(np.abs(runs(deviation)[f"without {number}"]).max(axis=1))
            },
        )
        | sweep(choices("outlier"), _outliers)
        | {"best-linear": _best_linear()}
    )


def matched_records(rng, runs, deviation, samples):
    """Return true paths and shifts of targets that move as the filter expects, Eqs 4, 9 and 17.

    The state one interval before the first sample is that of Table 2, with a normal error of
    `deviation` in m and m/s. Shapes (runs, samples, 6), twice.
    """
    s = reported().scenario
    F, _ = constant_velocity(s.T, s.sigma_a)
    G = np.repeat([s.T**2 / 2, s.T], 3)
    x = s.x0 + deviation * rng.standard_normal((runs, 6))
    push = s.sigma_a * rng.standard_normal((runs, samples, 1)) * G
    truth = np.empty((runs, samples, 6))
    for k in range(samples):
        x = x @ F.T + push[:, k]
        truth[:, k] = x
    z = doppler_shift(truth, s.array)
    return truth, z + s.sigma_f * rng.standard_normal(z.shape)


def _filtered(rng, runs, deviation, samples, keep):
    s = reported().scenario
    truth, z = matched_records(rng, runs, deviation, samples)
    P0 = deviation**2 * np.eye(6)
    return truth, ekf(z, s.array, s.x0, P0, s.T, s.sigma_a, s.sigma_f, keep=keep)


def _described(rng, deviation):
    """Return quantities of runs with right models, by their names, runs first."""
    s = reported().scenario
    long, single, short = rng.spawn(3)
    _, track = _filtered(long, _RUNS, deviation, s.samples, ("innovation",))
    _, one = _filtered(single, 1, deviation, s.samples, ("P",))
    last = []
    for child in short.spawn(20):  # all runs at once would need a gigabyte
        truth, brief = _filtered(child, _MANY // 20, deviation, _SHORT, ("P",))
        last.append(nis(brief.x[:, -1] - truth[:, -1], brief.P[:, -1]))
    found = {
        "nis": track.nis,
        "nees": np.concatenate(last),
        "samples": nees_samples(one.P[0], *constant_velocity(s.T, s.sigma_a)),
    }
    (left_out,) = choices("left-out")
    for number in left_out.values + left_out.beyond:
        found[f"without {number}"] = track.innovation[:, number:].mean(axis=1)
    return found


def _averages(run):
    """Return distances of averages from the dimension, and effective sample sizes."""
    return {
        "nis-expectation": _away_from(6, run["nis"].mean(axis=1)),
        "nees-expectation": _away_from(6, run["nees"]),
        "nis-independent": worth(run["nis"]),
        "nees-independent": run["samples"] / reported().scenario.samples,
    }


def _away_from(expected, values):
    """Return the relative difference of a mean from its expectation, whatever its sign."""
    mean = mean_interval(values)
    away, half = abs(mean.value / expected - 1), mean.half_width / expected
    return ConfidenceInterval(away, max(away - half, 0.0), away + half)


def worth(values):
    """Return the fraction of samples that would be as many if they were independent.

    One over 1 + 2 times the sum of the autocorrelations, with the mean and the variance that a
    chi-square variable of six degrees of freedom has, 6 and 12. `values` has shape (runs, K).
    """
    away = (values - 6) / np.sqrt(12)
    sums = sum((away[:, lag:] * away[:, :-lag]).mean(axis=1) for lag in range(1, _LAGS + 1))
    inflation = mean_interval(1 + 2 * sums)
    return ConfidenceInterval(1 / inflation.value, 1 / inflation.high, 1 / inflation.low)


def _outliers(size):
    """Return the probability that NIS with one wrong shift is above its 95 % interval.

    A settled filter knows the shift so well that S is R: NIS is then a non-central chi-square
    variable of six degrees of freedom, shifted by the square of the error.
    """
    from scipy.stats import ncx2

    return {"nis-outliers": float(ncx2.sf(chi2_interval(6)[1], 6, size**2))}


def _best_linear(samples=50):
    """Return the variance of the range from a Kalman filter over that of the best linear estimator.

    The model is linear: shifts on the tangent at Table 2. Every linear estimator of the last state
    is a matrix times all shifts; the best one follows from their covariance at one blow.
    """
    s = reported().scenario
    F, Q = constant_velocity(s.T, s.sigma_a)
    H, R = doppler_jacobian(s.x0, s.array), s.sigma_f**2 * np.eye(6)
    z = np.zeros((samples, 6))
    filtered = kf(z, F, Q, H, R, np.zeros(6), s.P0).P[-1, 0, 0]
    # Covariance of all states, row by row: each follows from the one before.
    blocks = np.zeros((samples, samples, 6, 6))
    for k in range(samples):
        blocks[k, k] = F @ (blocks[k - 1, k - 1] if k else s.P0) @ F.T + Q
        for later in range(k + 1, samples):
            blocks[later, k] = F @ blocks[later - 1, k]
            blocks[k, later] = blocks[later, k].T
    seen = np.einsum("ia,jkab,lb->jikl", H, blocks, H).reshape(6 * samples, 6 * samples)
    seen += s.sigma_f**2 * np.eye(6 * samples)
    with_last = np.einsum("jab,ib->aji", blocks[-1], H).reshape(6, -1)
    best = blocks[-1, -1] - with_last @ np.linalg.solve(seen, with_last.T)
    return float(filtered / best[0, 0])
