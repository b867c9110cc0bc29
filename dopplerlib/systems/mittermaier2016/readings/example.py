"""Interpretations of Section 4 whose runs resemble the one that Fig 6 shows.

What the paper leaves open is drawn at random for each run of ours. All runs are described by the
same few numbers as the published one, and the runs nearest to it are asked what they were made of.
"""

from collections.abc import Iterable
from itertools import product
from typing import Annotated, Any

import numpy as np

from .... import _checks
from ...._hints import Booleans, Count, Index, Runs, checked, exactly, shaped
from ...._records import record
from ...._typing import FloatArray, IntArray
from ....estimation.extended_kalman import ekf
from ....evaluation.consistency import chi2_interval
from ....evaluation.intervals import ConfidenceInterval, proportion_interval
from ....model.motion import constant_velocity
from ....model.simulation import simulate
from .._assumed import RAISED, assumed_deviation
from ..published import reported

Errors = Annotated[FloatArray, shaped(1001, 3, check=_checks.measured)]
Nis = Annotated[FloatArray, shaped(1001)]

# Samples over which errors are averaged: in all of them the drawn ones are known.
WINDOWS = ((7, 14), (50, 150), (200, 300), (450, 550), (700, 800), (950, 1001))

SUMMARIES = (
    "average NIS", "spread of NIS", "share of NIS inside", "NIS, first ten", "NIS, memory",
    "refused, too small", "refused, too large",
    *(f"error of {axis}, {a} to {b} ms" for (a, b), axis in product(WINDOWS, "xyz")),
)  # fmt: skip

OPTIONS = {
    "start": ("of Table 2", "as drawn"),
    "P0": ("0.01 I", "0.1 I", "1 I", "0.1 I, noise of 10 %", "0.1 I, noise of 20 %"),
    "process noise": (
        "shared, 0.4 m/s²", "shared, 0.04 m/s²", "shared, 4 m/s²",
        "per axis, 0.4 m/s²", "per axis, 0.04 m/s²",
    ),
    "noise at the start": tuple(RAISED),
}  # fmt: skip


@checked
@record
class ExampleReadings:
    """Runs of many readings of the simulation example, described by a few numbers.

    option (runs,): For each question of `OPTIONS`, which of its answers a run was made with.
    summary (runs, 25): Numbers named in `SUMMARIES`; errors, averages and counts are logarithms.
    published (25,): The same of the published run.
    """

    option: dict[str, np.ndarray]
    summary: Annotated[FloatArray, exactly(None, len(SUMMARIES))]
    published: Annotated[FloatArray, exactly(len(SUMMARIES))]

    def __post_init__(self):
        """Check that each run has an answer to each question."""
        for question, answers in OPTIONS.items():
            if question not in self.option:
                raise ValueError(f"option must answer {question!r}, got {list(self.option)}")
            name = f"option[{question!r}]"
            answer = _checks.real(name, self.option[question])
            if (
                answer.shape != self.summary.shape[:1]
                or not np.isin(answer, range(len(answers))).all()
            ):
                raise ValueError(
                    f"{name} must hold one of 0 to {len(answers) - 1} for each run, got {answer}"
                )

    @checked
    def nearest(
        self, count: Count, *, decorrelate: bool = True, only: Iterable[Index] | None = None
    ) -> IntArray:
        """Return the numbers of the `count` runs nearest to the published one.

        Every summary is first turned into a normal score, by its rank among all runs and the
        published one: heavy tails and units do not matter.

        count: How many.
        decorrelate: Whether distance is that of Mahalanobis, in which numbers that say the same
            count once.
        only: Which summaries count; all if None.
        Returns (count,): The nearest first.

        Examples
        --------
        >>> example_readings(15, rng=np.random.default_rng(1)).nearest(2).shape
        (2,)
        """
        from scipy.stats import norm, rankdata

        columns = slice(None) if only is None else list(only)
        values = np.vstack([self.published, self.summary])[:, columns]
        score = norm.ppf((rankdata(values, axis=0) - 0.5) / len(values))
        away = score[1:] - score[0]
        if decorrelate:
            # Summaries that are nearly one number are not told apart: a floor for eigenvalues.
            size, axes = np.linalg.eigh(np.corrcoef(score[1:].T))
            away = away @ axes / np.sqrt(np.maximum(size, 0.01))
        return np.argsort(np.sum(away**2, axis=1))[:count]

    @checked
    def shares(self, count: Count, **how: Any) -> dict[str, dict[str, ConfidenceInterval]]:
        """Return the fraction of every option among the nearest runs.

        count: Number of nearest runs.
        **how: See `nearest`.
        Returns: By question and answer. All answers to a question were equally frequent beforehand.

        Examples
        --------
        >>> list(example_readings(15, rng=np.random.default_rng(1)).shares(2)["start"])
        ['of Table 2', 'as drawn']
        """
        near = self.nearest(count, **how)
        return {
            question: {
                answer: proportion_interval(self.option[question][near] == i)
                for i, answer in enumerate(answers)
            }
            for question, answers in OPTIONS.items()
        }


@checked
def ruled_out(shares: dict[str, dict[str, ConfidenceInterval]]) -> set[tuple[str, str]]:
    """Return the answers that another one beats by ten to one, on the whole of both intervals.

    shares: From `ExampleReadings.shares`.
    Returns: Question and answer.

    Examples
    --------
    >>> ruled_out(example_readings(15, rng=np.random.default_rng(1)).shares(2))
    set()
    """
    return {
        (question, answer)
        for question, answers in shares.items()
        for answer, share in answers.items()
        if 10 * share.high < max(other.low for other in answers.values())
    }


@checked
def example_readings(runs: Runs, *, rng: np.random.Generator) -> ExampleReadings:
    """Run the simulation example with everything that the paper leaves open drawn at random.

    The gate is the two-sided one, which the figure itself shows.

    runs: Number of runs, at least one for each mixture of process noise and noise at the start; it
        is rounded down to a multiple of their number, 15.
    rng: Source of the measurement noise and of the choices.
    Raises ValueError if `runs` is smaller than 15 or not a whole number, or `rng` is not a
        generator.
    """
    groups = list(product(range(5), range(3)))
    each = _checks.whole_number("runs", runs, least=len(groups)) // len(groups)
    s, drawn = reported().scenario, reported().figure6
    starts = np.stack([reported().table2.x_ml, drawn.start])
    F, _ = constant_velocity(s.T, s.sigma_a)
    option = {question: [] for question in OPTIONS}
    summary = []
    for (noise, raised), child in zip(groups, rng.spawn(len(groups)), strict=True):
        start, covariance = child.integers(2, size=each), child.integers(5, size=each)
        before = np.linalg.solve(F, starts[start][..., None])[..., 0]
        P0 = np.stack([_covariance(OPTIONS["P0"][c], child) for c in covariance])
        kind, sigma_a = OPTIONS["process noise"][noise].removesuffix(" m/s²").split(", ")
        deviation = assumed_deviation(OPTIONS["noise at the start"][raised])
        truth, z = simulate(s, each, rng=child)
        track = ekf(
            z, s.array, before, P0, s.T, float(sigma_a), deviation,
            kind.replace(" ", "_"), gate="two-sided", keep=(),
        )  # fmt: skip
        error = np.abs(track.x[..., :3] - truth[:, :3])
        summary.append(example_summary(error, track.nis, ~track.updated))
        for name, values in zip(OPTIONS, (start, covariance, noise, raised), strict=True):
            option[name].append(np.broadcast_to(values, each))
    published = example_summary(drawn.error, drawn.nis, drawn.skipped)
    chosen = {name: np.concatenate(parts) for name, parts in option.items()}
    return ExampleReadings(chosen, np.concatenate(summary), published)


@checked
@_checks.quiet
def example_summary(error: Errors, nis: Nis, skipped: Booleans) -> FloatArray:
    """Describe runs by the numbers named in `SUMMARIES`.

    error (..., 1001, 3): Absolute position errors in m.
    nis (..., 1001): Normalized innovations squared.
    skipped (..., 1001): Samples at which the state was only predicted.
    Returns (..., 25): NaN or infinite where an error is unknown or zero.

    Examples
    --------
    >>> drawn = reported().figure6
    >>> example_summary(drawn.error, drawn.nis, drawn.skipped).shape
    (25,)
    """
    lower, upper = chi2_interval(6)
    small = nis < 6
    log = np.log10(nis) - np.log10(nis).mean(axis=-1, keepdims=True)
    memory = (log[..., 1:] * log[..., :-1]).mean(axis=-1) / (log**2).mean(axis=-1)
    numbers = [
        np.log10(nis.mean(axis=-1)),
        np.log10(nis.std(axis=-1)),
        ((lower <= nis) & (nis <= upper)).mean(axis=-1),
        np.log10(nis[..., :10].mean(axis=-1)),
        memory,
        np.log1p((skipped & small).sum(axis=-1)),
        np.log1p((skipped & ~small).sum(axis=-1)),
    ]
    for first, last in WINDOWS:
        square = np.mean(error[..., first:last, :] ** 2, axis=-2)
        numbers += list(np.moveaxis(np.log10(square) / 2, -1, 0))
    return np.stack(numbers, axis=-1)


@checked
@_checks.quiet
def still_counts(error: Errors, nis: Nis) -> tuple[IntArray, IntArray]:
    """Count the samples that stand still, by the error curves alone, at small and at large NIS.

    A sample stands still if no error changes by more than a quarter of what is usual in its block
    of 25 samples. The first block is left out: there the drawn errors are not all known.

    error, nis: See `example_summary`.
    Returns low, high (...): Number of samples that stand still with a NIS below and above the 95 %
        interval.

    Examples
    --------
    >>> drawn = reported().figure6
    >>> [int(count) for count in still_counts(drawn.error, drawn.nis)]
    [20, 17]
    """
    lower, upper = chi2_interval(6)
    change = np.abs(np.diff(error, axis=-2))[..., 25:, :]
    blocks = change.reshape(*change.shape[:-2], -1, 25, 3)
    ratio = blocks / np.median(blocks, axis=-2, keepdims=True)
    still = (ratio.max(axis=-1) < 0.25).reshape(change.shape[:-1])
    nis = nis[..., 26:]
    return (still & (nis < lower)).sum(axis=-1), (still & (nis > upper)).sum(axis=-1)


def _covariance(name, rng):
    """Return a P0 by its name, with noise on its off-diagonal elements if that is part of it."""
    scale = float(name.split(" ")[0])
    P0 = scale * np.eye(6)
    if "noise" not in name:
        return P0
    deviation = scale * float(name.split(" ")[-2]) / 100
    while True:
        noise = np.triu(deviation * rng.standard_normal((6, 6)), 1)
        P = P0 + noise + noise.T
        # Barely positive is no covariance that anybody would start with.
        if np.linalg.eigvalsh(P)[0] > 0.01 * scale:
            return P
