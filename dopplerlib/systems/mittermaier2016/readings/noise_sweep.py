"""Interpretations of Fig 4, ranked by the likelihood of the published dots."""

from dataclasses import replace
from functools import cache
from typing import Annotated

import numpy as np

from .... import _checks
from ...._data import read_json, read_lines, results
from ...._hints import Count, checked, exactly
from ...._records import record
from ...._typing import FloatArray
from ..noise_sweep import NoiseSweep, SweepReading, noise_levels
from ..published import PublishedFigure4, reported


def _positive(name, value, shape):
    return _checks.positive(name, _checks.moderate(name, value, shape))


def _logarithm(name, value, shape):
    """Return logarithms of numbers from 1e-60 to 1e60."""
    array = _checks.finite(name, value, shape)
    if (np.abs(array) > 140).any():
        raise ValueError(f"{name} must hold logarithms between -140 and 140, got {array}")
    return array


def _sequences(name, value):
    return (
        value
        if isinstance(value, float) and value == np.inf
        else _checks.moderate_number(name, value)
    )


Dots = Annotated[FloatArray, exactly(None, None, check=_positive)]
Pairs = Annotated[FloatArray, exactly(2, 2)]


@cache
def sweep_readings() -> tuple[SweepReading, ...]:
    """Return the readings of Fig 4 that are compared, and each of which is simulated.

    Returns: Every velocity with either likelihood, one draw for all points or one for each. Then,
        for some of them, what else could be different: the grid of the text, other boxes, the array
        turned.
    """
    study = reported().figure4_study
    compared = study.ours.comparison
    velocities = [
        SweepReading(kind, (low, high), spacing=compared.coarse)
        for kind, low, high in compared.velocities
    ]
    some = {
        name: [velocities[i] for i in compared.table[name]]
        for name in ("text_grid", "more_boxes", "turned")
    }
    likelihoods = ("constant_velocity", "stationary")
    both = [(shared, likelihood) for shared in (True, False) for likelihood in likelihoods]
    return (
        *(replace(v, shared=s, likelihood=name) for v in velocities for s, name in both),
        *(
            replace(v, likelihood=name, spacing=study.grid.spacing)
            for v in some["text_grid"]
            for name in likelihoods
        ),
        *(
            replace(v, shared=s, likelihood=name, box=box)
            for v in some["more_boxes"]
            for s, name in both
            for box in ("approaching", "region")
        ),
        *(replace(v, axis="x") for v in some["turned"]),
    )


def scored_levels() -> tuple[int, ...]:
    """Return the numbers of the noise levels at which readings are compared."""
    return tuple(reported().figure4_study.ours.comparison.levels.tolist())


@checked
@record
class DotsStructure:
    """Model of the dots: a sequence has a level of its own, and a scatter from dot to dot.

    Everything is for logarithms; position first, velocity second.

    mean (L, 2): At each noise level.
    between (2, 2): Covariance of what a sequence keeps over all levels. Unbiased, so not always
        positive.
    within (2, 2): Covariance of what changes from dot to dot.
    draws: Number of sequences that `mean` is the average of; infinite if it is exact.
    """

    mean: Annotated[FloatArray, exactly(None, 2, check=_logarithm)]
    between: Pairs
    within: Pairs
    draws: Annotated[float, _sequences] = np.inf


@checked
def dots_structure(position: Dots, velocity: Dots) -> DotsStructure:
    """Return the model of dots that are given.

    position, velocity (L, D): Mean errors in m and m/s: L levels of D sequences, both at least two.

    Examples
    --------
    Two sequences that differ by a constant factor and nothing else:

    >>> dots = np.array([[1.0, 2.0], [3.0, 6.0], [5.0, 10.0]])
    >>> result = dots_structure(dots, dots)
    >>> bool(np.allclose(result.within, 0)), result.between.round(3).tolist()
    (True, [[0.24, 0.24], [0.24, 0.24]])
    """
    dots = _dots(position, velocity)
    levels, draws = dots.shape[:2]
    if min(levels, draws) < 2:
        raise ValueError(f"position must hold two levels of two sequences, got {levels, draws}")
    mean = dots.mean(axis=1)
    rest = dots - mean[:, None]
    kept = rest.mean(axis=0)
    change = rest - kept
    within = np.einsum("ldi,ldj->ij", change, change) / ((draws - 1) * (levels - 1))
    between = kept.T @ kept / (draws - 1) - within / levels
    return DotsStructure(mean, between, within, draws)


@checked
def dots_log_likelihood(model: DotsStructure, position: Dots, velocity: Dots) -> float:
    """Return the log-likelihood of dots under a model, a sum over independent sequences.

    model: From a simulation.
    position, velocity (L, D): The dots, at the levels of the model.
    Returns: In nats. Only differences mean something.

    Notes
    -----
    The logarithms of a sequence are taken as normally distributed, with the rounding of the
    figure's markers added. A negative variance between sequences counts as zero. Where the mean
    of the model is itself that of m simulated sequences of covariance S, its error S / m is added
    to the covariance of the mean of the dots: else our own Monte Carlo error would look like a
    misfit.

    Examples
    --------
    >>> dots = np.array([[1.0, 2.0, 1.5], [3.0, 7.0, 4.0]])
    >>> model = dots_structure(dots, dots[:, ::-1])
    >>> bool(np.isfinite(dots_log_likelihood(model, dots, dots)))
    True
    """
    dots = _dots(position, velocity)
    levels, draws = dots.shape[:2]
    if len(model.mean) != levels:
        raise ValueError(f"model must have the {levels} levels of the dots, got {len(model.mean)}")
    size, axes = np.linalg.eigh(model.between)
    between = (axes * np.maximum(size, 0)) @ axes.T
    S = np.kron(np.ones((levels, levels)), between) + np.kron(np.eye(levels), model.within)
    ours = S / model.draws
    step = reported().figure4_study.drawing.step  # of the grid of markers, in m or m/s
    S = S + np.diag(step**2 / 12 / np.exp(2 * model.mean.ravel()))
    error = (dots - model.mean[:, None]).transpose(0, 2, 1).reshape(-1, draws)
    # Mean and deviations of the sequences are independent; only the mean shares our error.
    average = error.mean(axis=1, keepdims=True)
    loss = _square(error - average, S) + (draws - 1) * np.linalg.slogdet(2 * np.pi * S)[1]
    S = S + draws * ours
    loss += draws * _square(average, S) + np.linalg.slogdet(2 * np.pi * S)[1]
    return float(-0.5 * loss)


def _dots(position, velocity):
    """Return the logarithms of the dots, position and velocity on the last axis."""
    _checks.exact_shape("velocity", velocity, position.shape)
    return np.log(np.stack([position, velocity], axis=-1))


def _square(error, S):
    return np.sum(error * np.linalg.solve(S, error))


@checked
def sweep_score(
    figure: NoiseSweep,
    published: PublishedFigure4,
    *,
    rng: np.random.Generator,
    resamples: Count = 200,
) -> tuple[float, float, float]:
    """Return the log-likelihood of the published dots under our simulation of an interpretation.

    figure: Ours; many draws make the interval narrow.
    published: At least the levels of `figure`.
    rng: Draws our sequences again, for the interval.
    resamples: How often.
    Returns score: Log-likelihood in nats; only differences between readings mean something.
        low, high: Central 95 % of the score when our sequences are drawn again from themselves.

    Examples
    --------
    >>> ours, rng = saved_noise_sweep(), np.random.default_rng(1)
    >>> score, low, high = sweep_score(ours, reported().figure4, rng=rng, resamples=3)
    >>> low <= high
    True
    """
    if figure.velocity.shape != figure.position.shape:
        raise ValueError(
            "figure must have positions and velocities of the same draws, got "
            f"{figure.position.shape} and {figure.velocity.shape}"
        )
    rows = [int(np.argmin(np.abs(noise_levels() - variance))) for variance in figure.variance]
    dots = published.position[rows], published.velocity[rows]
    draws = figure.position.shape[1]

    def one(columns):
        ours = dots_structure(figure.position[:, columns], figure.velocity[:, columns])
        return dots_log_likelihood(ours, *dots)

    again = [one(rng.integers(draws, size=draws)) for _ in range(resamples)]
    return one(np.arange(draws)), *(float(q) for q in np.quantile(again, (0.025, 0.975)))


def coarse_readings() -> dict[str, SweepReading]:
    """Return readings on the coarse grid whose errors are saved: the default one and three others.

    Examples
    --------
    >>> list(coarse_readings())
    ['default', 'towards the center', 'stationary', 'own velocity at each point']
    """
    spacing = reported().figure4_study.ours.comparison.coarse
    return {
        "default": SweepReading(spacing=spacing),
        "towards the center": SweepReading("center", (0.5, 1.5), spacing=spacing),
        "stationary": SweepReading(likelihood="stationary", spacing=spacing),
        "own velocity at each point": SweepReading("square", (0, 1), False, spacing=spacing),
    }


def saved_coarse_sweeps() -> dict[str, tuple[FloatArray, FloatArray]]:
    """Return errors on the coarse grid, as ``make study NAME=noise_sweep`` left them.

    Returns {label: (position, velocity)}: Of `coarse_readings`, mean sizes of the errors at the
        `scored_levels` and of each draw, (L, D), in m and m/s.

    Examples
    --------
    >>> saved_coarse_sweeps()["default"][0].shape
    (16, 20)
    """
    lines = read_lines("noise_sweep.coarse.csv", folder=results)
    table, names = np.genfromtxt(lines, delimiter=",", names=True), coarse_readings()
    shape = len(names), len(scored_levels()), -1
    parts = (table[name].reshape(shape) for name in ("position", "velocity"))
    return dict(zip(names, zip(*parts, strict=True), strict=True))


@checked
def saved_sweep_readings(again: bool = False) -> list[tuple[SweepReading, float, float, float]]:
    """Return every reading with its score, the most likely first, as they are saved.

    again: Whether to return, instead, the best reading with either likelihood, simulated once more
        with another seed.
    Returns: The reading, its score in nats, and the ends of its 95 % interval.

    Examples
    --------
    >>> len(saved_sweep_readings(again=True))
    2
    """
    saved = read_json("noise_sweep_readings.json", folder=results)
    rows = []
    for row in saved["again" if again else "readings"]:
        values = tuple(row.pop(name) for name in ("score", "low", "high"))
        rows.append((SweepReading(**row | {"speed": tuple(row["speed"])}), *values))
    return sorted(rows, key=lambda row: -row[1])


def saved_noise_sweep() -> NoiseSweep:
    """Return the study in full, as ``make study NAME=noise_sweep`` left it.

    Returns: All levels and points of the grid, as many draws as the figure has markers at a level.
    """
    lines = read_lines("noise_sweep.csv", folder=results)
    table, levels = np.genfromtxt(lines, delimiter=",", names=True), noise_levels()
    parts = [table[name].reshape(len(levels), -1) for name in table.dtype.names[2:]]
    return NoiseSweep(levels, *parts)
