"""Error of the initial estimate against the noise (Fig 4), under any interpretation of the text."""

from collections.abc import Iterable
from dataclasses import field
from functools import cache
from typing import Annotated, Literal

import numpy as np

from ..._hints import Array, Count, Index, Positive, between, checked, covariances, exactly, shaped
from ..._progress import progress_bar
from ..._records import record
from ..._typing import FloatArray
from ...estimation.maximum_likelihood import ml_initialize
from ...evaluation.bounds import crlb
from ...model.doppler import doppler_shift
from ...model.radar_array import RadarArray
from .published import reported

_PLANE = [True, True, False, True, True, False]
Likelihood = Literal["constant_velocity", "stationary"]
Speed = Annotated[float, between(0, 100)]  # m/s


def _study():
    return reported().figure4_study


@cache
def noise_levels() -> FloatArray:
    """Return the variances of the noise levels of the figure.

    Returns (31,): In Hz^2; read-only.
    """
    noise = _study().noise
    low, high = np.log10([noise.lowest, noise.highest])
    levels = 10.0 ** (low + (high - low) * np.arange(noise.levels) / (noise.levels - 1))
    levels.flags.writeable = False
    return levels


def error_limits() -> tuple[float, float]:
    """Return the limits that the text states for the averaged errors.

    Returns position, velocity: In m and m/s.
    """
    limits = _study().limits
    return limits.position, limits.velocity


def _ours(name):
    return field(default_factory=lambda: getattr(_study().ours, name))


@checked
@record
class SweepReading:
    """An interpretation of the text on Fig 4: one choice for each point that it leaves open.

    velocity: How a velocity is drawn. "center": towards the middle of the array, at a uniform
        speed. "direction": any direction with v_x < 0, at a uniform speed. "disc" and "square":
        uniform in the half with v_x < 0 of a disc of radius `speed[1]`, or of a square of twice
        that side.
    speed: Least and largest speed in m/s; the least is for "center" and "direction" only.
    shared: Whether one draw serves all grid points (of "center": one speed), or each has its own.
    likelihood: See `ml_initialize`; the simulated target does what the likelihood says.
    spacing: Of the grid, in m.
    box: Which bounds the search has.
    axis: Along which the array stands. The text gives its length only.

    Notes
    -----
    The defaults are our choice, but for the spacing; they and the boxes stand in
    ``data/mittermaier2016/figure4.toml``.
    """

    velocity: Literal["center", "direction", "disc", "square"] = _ours("velocity")
    speed: tuple[Speed, Speed] = field(default_factory=lambda: tuple(_study().ours.speed.tolist()))
    shared: bool = _ours("shared")
    likelihood: Likelihood = _ours("likelihood")
    spacing: Positive = field(default_factory=lambda: _study().grid.spacing)
    box: Literal["wide", "approaching", "region"] = _ours("box")
    axis: Literal["y", "x"] = _ours("axis")


@checked
@record
class NoiseSweep:
    """Errors of the start, averaged over the grid: one value for each level and each draw.

    variance (L,): Of the noise, in Hz^2.
    position, velocity (L, D): Mean size of the errors in m and m/s.
    median_position, median_velocity (L, D): Medians over the grid.
    bound_position, bound_velocity (L, D): Mean sizes of the errors that an unbiased and normally
        distributed estimate would have at the Cramér-Rao bound, averaged over the grid.
    """

    variance: Annotated[FloatArray, exactly(None)]
    position: Annotated[FloatArray, exactly(None, None)]
    velocity: Annotated[FloatArray, exactly(None, None)]
    median_position: Annotated[FloatArray, exactly(None, None)]
    median_velocity: Annotated[FloatArray, exactly(None, None)]
    bound_position: Array
    bound_velocity: Array


@checked
def run_noise_sweep(
    levels: Iterable[Index] | None = None,
    draws: Count | None = None,
    *,
    rng: np.random.Generator,
    reading: SweepReading | None = None,
    bound: bool = True,
    progress: bool = False,
    workers: Count | None = None,
) -> NoiseSweep:
    """Run the study of Fig 4.

    levels: Numbers of the noise levels, 0 to 30; all if None.
    draws: Number of velocity draws; as many as the figure has markers at a level if None.
    rng: Source of velocities and noise. Fewer levels or draws give the same values of those asked
        for.
    reading: What the text leaves open; `SweepReading()` if None.
    bound: Whether the bounds are wanted; else they are NaN.
    progress: Whether to show a bar on standard error.
    workers: See `ml_initialize`. The result does not depend on it.
    Raises ValueError if a level is not one of 0 to 30, `draws` is not a positive whole number, or
        the reading names something unknown.

    Examples
    --------
    >>> coarse = SweepReading(spacing=0.25)
    >>> rng = np.random.default_rng(1)
    >>> result = run_noise_sweep([0, 30], draws=2, rng=rng, reading=coarse)
    >>> result.position.shape, bool((result.position[1] > 10 * result.position[0]).all())
    ((2, 2), True)
    """
    reading = SweepReading() if reading is None else reading
    settings, variance = _study(), noise_levels()
    levels = list(range(len(variance)) if levels is None else levels)
    if not levels or max(levels) >= len(variance):
        raise ValueError(f"levels must be whole numbers from 0 to 30, got {levels}")
    draws = settings.velocities.in_figure if draws is None else draws

    T, samples = settings.sampling.T, settings.sampling.samples
    array = sweep_array(reading.axis)
    streams = [child.spawn(1 + len(variance)) for child in rng.spawn(draws)]
    x = np.stack([_states(reading, own[0]) for own in streams])
    path = np.repeat(x[..., None, :], samples, axis=-2)
    if reading.likelihood == "constant_velocity":
        path[..., :3] += T * np.arange(samples)[:, None] * path[..., 3:]
    clean = doppler_shift(path, array)
    box = _box(reading)
    errors = []
    for k in progress_bar(levels, "noise level", progress):
        noise = np.stack([own[1 + k].standard_normal(clean.shape[1:]) for own in streams])
        sigma_f = np.sqrt(variance[k])
        z = clean + sigma_f * noise
        start = ml_initialize(z, array, sigma_f, T, box, reading.likelihood, workers=workers)
        errors.append(_sizes(start.x - x))
    errors = np.array(errors)  # levels, two parts, draws, grid points
    mean, median = errors.mean(axis=-1), np.median(errors, axis=-1)
    unit = _unit_bounds(x, reading) if bound else np.full((2, draws), np.nan)
    bounds = np.sqrt(variance[levels])[:, None, None] * unit
    parts = (values[:, i] for values in (mean, median, bounds) for i in (0, 1))
    return NoiseSweep(variance[levels], *parts)


_PARTS = (np.s_[:2], np.s_[3:5])


@checked
def sweep_bounds(
    draws: Count, *, rng: np.random.Generator, reading: SweepReading | None = None
) -> tuple[FloatArray, FloatArray]:
    """Return the bounds of the study for noise of 1 Hz, without simulating it.

    draws: Number of velocity draws.
    rng: Source of velocities.
    reading: What the text leaves open; `SweepReading()` if None.
    Returns position, velocity (draws,): Mean sizes of the errors at the Cramér-Rao bound in m and
        m/s, averaged over the grid, as `run_noise_sweep` has them.
    Raises ValueError if `draws` is not a positive whole number, or the reading names something
        unknown.

    Examples
    --------
    >>> coarse = SweepReading(spacing=0.25)
    >>> position, velocity = sweep_bounds(2, rng=np.random.default_rng(1), reading=coarse)
    >>> result = run_noise_sweep([30], 2, rng=np.random.default_rng(1), reading=coarse)
    >>> bool(np.allclose(result.bound_position[0], position))
    True
    """
    reading = SweepReading() if reading is None else reading
    levels = 1 + len(noise_levels())
    streams = [child.spawn(levels)[0] for child in rng.spawn(draws)]
    position, velocity = _unit_bounds(np.stack([_states(reading, one) for one in streams]), reading)
    return position, velocity


def _unit_bounds(x, reading):
    """Return mean sizes of both parts of the error at the bound, for 1 Hz; shape (2, draws)."""
    sampling = _study().sampling
    array = sweep_array(reading.axis)
    P = crlb(x, array, 1.0, sampling.samples, sampling.T, reading.likelihood, free=_PLANE)
    return np.stack([mean_norm(P[..., part, part]).mean(axis=-1) for part in _PARTS])


@checked
def mean_norm(P: Annotated[FloatArray, shaped(2, 2, check=covariances)]) -> FloatArray:
    """Return the mean length of a normally distributed vector in a plane.

    P (..., 2, 2): Covariance; the mean is zero.
    Returns (...)

    Notes
    -----
    ``sqrt(2 a / pi) E(1 - b / a)`` with the eigenvalues a >= b and the complete elliptic integral
    of the second kind; sqrt(2 / pi) standard deviations on a line, sqrt(pi / 2) on a circle.

    Examples
    --------
    >>> float(mean_norm(np.diag([1.0, 0.0])).round(4)), float(mean_norm(np.eye(2)).round(4))
    (0.7979, 1.2533)
    """
    from scipy.special import ellipe  # here: it takes longer to load than all the rest

    middle = (P[..., 0, 0] + P[..., 1, 1]) / 2
    half = np.hypot((P[..., 0, 0] - P[..., 1, 1]) / 2, P[..., 0, 1])
    large = middle + half
    share = 2 * half / np.where(large > 0, large, 1.0)  # nothing spreads where `large` is zero
    return np.sqrt(2 * large / np.pi) * ellipe(np.minimum(1.0, share))


@checked
def sweep_array(axis: Literal["x", "y"] | None = None) -> RadarArray:
    """Return the sensors of the study.

    axis: Along which they stand, which the text does not say; that of `SweepReading()` if None.

    Examples
    --------
    >>> len(sweep_array("x"))
    5
    """
    settings = dict(_study().array.table)
    if settings.pop("shape") != "linear":
        raise ValueError("array in figure4.toml must have the shape linear")
    return RadarArray.linear(**settings, axis=_study().ours.axis if axis is None else axis)


@checked
def grid_points(spacing: Positive | None = None) -> FloatArray:
    """Return the positions of the study.

    spacing: In m; that of the text if None.
    Returns (M, 2): In m.

    Examples
    --------
    >>> grid_points().shape
    (315, 2)
    """
    grid = _study().grid
    spacing = grid.spacing if spacing is None else spacing
    if spacing < 1e-3:
        raise ValueError(f"spacing must be at least a millimeter, got {spacing}")
    axes = [
        low + spacing * np.arange(int((high - low) / spacing + 1e-9) + 1)
        for low, high in (grid.x, grid.y)
    ]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)


def _states(reading, rng):
    """Return true states at the grid points, shape (M, 6), for one draw of velocities."""
    points = grid_points(reading.spacing)
    x = np.zeros((len(points), 6))
    x[:, :2] = points
    size = 1 if reading.shared else len(points)
    low, high = reading.speed
    kind = reading.velocity
    if kind == "square":
        x[:, 3] = -rng.uniform(0, high, size)
        x[:, 4] = rng.uniform(-high, high, size)
    else:
        speed = high * np.sqrt(rng.random(size)) if kind == "disc" else rng.uniform(low, high, size)
        if kind == "center":
            direction = -points / np.linalg.norm(points, axis=-1, keepdims=True)
        else:
            angle = rng.uniform(-np.pi / 2, np.pi / 2, size)
            direction = np.stack([-np.cos(angle), np.sin(angle)], axis=-1)
        x[:, 3:5] = speed[:, None] * direction
    if reading.axis == "x":
        # The line is blind for the sign of y, as it is for that of x when it stands along y. What
        # is straight ahead of it, at y = 0, it does not see at all.
        x = x[np.abs(x[:, 1]) > 1e-9]
        x[:, [1, 4]] *= np.where(x[:, 1] < 0, -1, 1)[:, None]
    return x


def _box(reading):
    """Return the bounds of the state; the first of the box is the distance from the array."""
    order = [0, 1, 3, 4] if reading.axis == "y" else [1, 0, 4, 3]
    box = np.zeros((2, 6))
    box[:, order] = getattr(_study().ours.boxes, reading.box)
    return box


def _sizes(error):
    """Return the lengths of both parts of the error, stacked first."""
    return np.stack([np.linalg.norm(error[..., part], axis=-1) for part in _PARTS])
