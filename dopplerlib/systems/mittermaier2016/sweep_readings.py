"""Which reading of Fig 4 do the published dots support?"""

from dataclasses import replace
from functools import cache

import numpy as np

from ... import _checks
from ..._data import read_json, read_lines, results
from ..._records import record
from .noise_sweep import Figure4, SweepReading, noise_levels
from .published import figure4_settings


@cache
def sweep_readings():
    """Return the readings of Fig 4 that are compared, and each of which is simulated.

    Returns
    -------
    tuple of SweepReading
        Every velocity with either likelihood, one draw for all points or one for each. Then, for
        some of them, what else could be different: the grid of the text, other boxes, the array
        turned.
    """
    settings = figure4_settings()
    compared = settings["ours"]["comparison"]
    velocities = [
        SweepReading(kind, (low, high), spacing=compared["coarse"])
        for kind, low, high in compared["velocities"]
    ]
    some = {
        name: [velocities[i] for i in compared[name]]
        for name in ("text_grid", "more_boxes", "turned")
    }
    likelihoods = ("constant_velocity", "stationary")
    both = [(shared, likelihood) for shared in (True, False) for likelihood in likelihoods]
    return (
        *(replace(v, shared=s, likelihood=name) for v in velocities for s, name in both),
        *(
            replace(v, likelihood=name, spacing=settings["grid"]["spacing"])
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


def scored_levels():
    """Return the numbers of the noise levels at which readings are compared.

    Returns
    -------
    tuple of int
    """
    return tuple(figure4_settings()["ours"]["comparison"]["levels"])


@record
class Structure:
    """Model of the dots: a sequence has a level of its own, and a scatter from dot to dot.

    Everything is for logarithms; position first, velocity second.

    Attributes
    ----------
    mean : ndarray, shape (L, 2)
        At each noise level.
    between : ndarray, shape (2, 2)
        Covariance of what a sequence keeps over all levels. Unbiased, so not always positive.
    within : ndarray, shape (2, 2)
        Covariance of what changes from dot to dot.
    draws : float
        Number of sequences that `mean` is the average of; infinite if it is exact.
    """

    mean: np.ndarray
    between: np.ndarray
    within: np.ndarray
    draws: float = np.inf


def dots_structure(position, velocity):
    """Return the model of dots that are given.

    Parameters
    ----------
    position, velocity : array_like, shape (L, D)
        Mean errors in m and m/s: L levels of D sequences, both at least two.

    Returns
    -------
    Structure

    Examples
    --------
    Two sequences that differ by a constant factor and nothing else:

    >>> dots = np.array([[1.0, 2.0], [3.0, 6.0], [5.0, 10.0]])
    >>> result = dots_structure(dots, dots)
    >>> bool(np.allclose(result.within, 0)), result.between.round(3).tolist()
    (True, [[0.24, 0.24], [0.24, 0.24]])
    """
    dots = np.log(np.stack([position, velocity], axis=-1))
    levels, draws = dots.shape[:2]
    mean = dots.mean(axis=1)
    rest = dots - mean[:, None]
    kept = rest.mean(axis=0)
    change = rest - kept
    within = np.einsum("ldi,ldj->ij", change, change) / ((draws - 1) * (levels - 1))
    between = kept.T @ kept / (draws - 1) - within / levels
    return Structure(mean, between, within, draws)


def dots_log_likelihood(model, position, velocity):
    """Return how likely dots are under a model, as a sum over independent sequences.

    Parameters
    ----------
    model : Structure
        From a simulation.
    position, velocity : array_like, shape (L, D)
        The dots, at the levels of the model.

    Returns
    -------
    float
        In nats. Only differences mean something.

    Notes
    -----
    The logarithms of a sequence are taken as normally distributed, with the rounding of the
    figure's markers added. A negative variance between sequences counts as zero. Where the mean
    of the model is itself that of m simulated sequences of covariance S, its error S / m is added
    to the covariance of the mean of the dots: else our own Monte Carlo error would look like a
    misfit.
    """
    _checks.instance("model", model, Structure)
    dots = np.log(np.stack([position, velocity], axis=-1))
    levels, draws = dots.shape[:2]
    size, axes = np.linalg.eigh(model.between)
    between = (axes * np.maximum(size, 0)) @ axes.T
    S = np.kron(np.ones((levels, levels)), between) + np.kron(np.eye(levels), model.within)
    ours = S / model.draws
    step = figure4_settings()["drawing"]["step"]  # of the grid of markers, in m or m/s
    S = S + np.diag(step**2 / 12 / np.exp(2 * model.mean.ravel()))
    error = (dots - model.mean[:, None]).transpose(0, 2, 1).reshape(-1, draws)
    # Mean and deviations of the sequences are independent; only the mean shares our error.
    average = error.mean(axis=1, keepdims=True)
    loss = _square(error - average, S) + (draws - 1) * np.linalg.slogdet(2 * np.pi * S)[1]
    S = S + draws * ours
    loss += draws * _square(average, S) + np.linalg.slogdet(2 * np.pi * S)[1]
    return float(-0.5 * loss)


def _square(error, S):
    return np.sum(error * np.linalg.solve(S, error))


def figure4_score(figure, published, *, rng, resamples=200):
    """Return how likely the published dots are under our simulation of a reading.

    Parameters
    ----------
    figure : Figure4
        Ours; many draws make the interval narrow.
    published : PublishedFigure4
        At least the levels of `figure`.
    rng : numpy.random.Generator
        Draws our sequences again, for the interval.
    resamples : int
        How often.

    Returns
    -------
    score : float
        Log-likelihood in nats; only differences between readings mean something.
    low, high : float
        Central 95 % of the score when our sequences are drawn again from themselves.
    """
    _checks.instance("figure", figure, Figure4)
    rows = [int(np.argmin(np.abs(noise_levels() - variance))) for variance in figure.variance]
    dots = published.position[rows], published.velocity[rows]
    draws = figure.position.shape[1]

    def one(columns):
        ours = dots_structure(figure.position[:, columns], figure.velocity[:, columns])
        return dots_log_likelihood(ours, *dots)

    again = [one(rng.integers(draws, size=draws)) for _ in range(resamples)]
    return one(np.arange(draws)), *(float(q) for q in np.quantile(again, (0.025, 0.975)))


def figure4_readings(again=False):
    """Return every reading with its score, the most likely first, as they are saved.

    Parameters
    ----------
    again : bool
        Whether to return, instead, the best reading with either likelihood, simulated once more
        with another seed.

    Returns
    -------
    list of tuple
        The reading, its score in nats, and the ends of its 95 % interval.
    """
    saved = read_json("noise_sweep_readings.json", folder=results)
    rows = []
    for row in saved["again" if again else "readings"]:
        values = tuple(row.pop(name) for name in ("score", "low", "high"))
        rows.append((SweepReading(**row | {"speed": tuple(row["speed"])}), *values))
    return sorted(rows, key=lambda row: -row[1])


def saved_figure4():
    """Return the study in full, as ``make study NAME=noise_sweep`` left it.

    Returns
    -------
    Figure4
        All levels and points of the grid, as many draws as the figure has markers at a level.
    """
    lines = read_lines("noise_sweep.csv", folder=results)
    table, levels = np.genfromtxt(lines, delimiter=",", names=True), noise_levels()
    parts = [table[name].reshape(len(levels), -1) for name in table.dtype.names[2:]]
    return Figure4(levels, *parts)
