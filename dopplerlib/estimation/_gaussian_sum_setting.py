"""Constants and memory of a Gaussian sum filter, as the compiled loop takes them."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from .. import _checks
from ..kernels import ring_coordinates as kernel
from ..model.motion import constant_velocity, dwna_gain, ncv_transition

# Fine windows of the start: distance in units of 1 / radius (of eta), in logarithms (of rho), and
# deviation of each window as a share of that distance, so that their sum is even to a percent.
_ACROSS, _ALONG, _WIDTH = 0.04, 0.2, 0.71
_DRAWN = 2**14  # points of the prior that say where windows are needed
_COVERED = 0.99  # share of them that lie in fine windows
_CENTERED = 0.9  # share of them in windows whose center is a state; else the windows are moved
_COARSE, _TAIL = 3, 5.0  # size of the windows outside; as far as standard deviations of the prior
_SPREAD = 2.0  # of the points that say where those are needed, in standard deviations
_COUNTED = 2**10  # of these points, at which the sum of the windows is taken
_LEAST = 0.15  # of the radius: nearer to the sensors' plane, or the first of them, a member is lost
_FLAT = 1e-9  # of the radius: so far off the plane a sensor is in it
_SETTLING, _SCANS = 30, 512  # blocks of a target that goes straight at the first new fit, at most


class Setting(NamedTuple):
    """Constants of a filter: of array, motion, prior and approximation."""

    positions: np.ndarray
    r: float
    c: float
    T: float
    block: int
    noise: np.ndarray
    flat: bool
    mean: np.ndarray
    information: np.ndarray
    prior: float
    grid: np.ndarray
    widths: np.ndarray
    overlaps: np.ndarray
    least: float
    lightest: float
    loss: float
    limit: float


class Bank(NamedTuple):
    """The members, the block that is being filled, and what went before; written to in place."""

    x: np.ndarray
    P: np.ndarray
    weight: np.ndarray
    samples: np.ndarray
    weights: np.ndarray
    numbers: np.ndarray
    logs: np.ndarray
    scans: np.ndarray
    variances: np.ndarray
    middles: np.ndarray


class Estimates(NamedTuple):
    """Arrays of O estimates, in the order of `GaussianSumTrack`; written to in place."""

    x: np.ndarray
    P: np.ndarray
    members: np.ndarray
    weights: np.ndarray
    means: np.ndarray
    covariances: np.ndarray
    evidence: np.ndarray


class Frame(NamedTuple):
    """Where the array is, and how it is turned, (6, 6)."""

    origin: np.ndarray
    turn: np.ndarray


def prepare(array, x0, P0, T, sigma_a, noise, block, lightest, loss, gate_probability):
    """Return `Frame` and `Setting` of a filter; errors name its arguments."""
    x0 = _checks.exact_shape("x0", _checks.moderate("x0", x0, (6,)), (6,))
    P0 = _checks.exact_shape("P0", _checks.covariance("P0", P0, 6), (6, 6))
    # The frame of the array: origin in the middle, first axis towards the prior.
    center, axes, radius, positions, flat, least = _frame(array, x0)
    from scipy.special import chdtri  # upper-tail quantile of chi-square

    frame = Frame(np.concatenate([center, np.zeros(3)]), np.kron(np.eye(2), axes))
    turn = frame.turn
    ahead = (block + 1) / 2 * T  # from the prior to the middle of the first block
    F, columns = ncv_transition(ahead, 3, "derivative"), np.zeros((0, 6))
    P = F @ P0 @ F.T
    if _checks.one_number("sigma_a", sigma_a) != 0:
        G, sigma_a = dwna_gain(np.array([T]), sigma_a, noise)
        columns = np.ascontiguousarray((turn @ (sigma_a * G[0])).T)
        P = P + constant_velocity(ahead, sigma_a * np.sqrt(T / ahead), noise)[1]
    mean, P = turn @ (F @ (x0 - frame.origin)), turn @ P @ turn.T
    _checks.estimates("x0, P0, T, sigma_a", mean, P)
    P = _checks.covariance("P0", (P + P.T) / 2, 6)
    grid, widths, overlaps = _windows(mean.tobytes(), P.tobytes(), radius, least)
    information = np.linalg.inv(P)
    prior = -0.5 * float(np.linalg.slogdet(P)[1])
    limit = np.inf if gate_probability is None else float(chdtri(1, 1 - gate_probability))
    return frame, Setting(
        np.ascontiguousarray(positions), radius, float(array.doppler_per_speed), float(T), block,
        columns, flat, mean, (information + information.T) / 2,
        prior, grid, widths, overlaps, least, float(lightest), float(loss), limit,
    )  # fmt: skip


def new_bank(setting: Setting) -> Bank:
    """Return a bank without members, before the first sample."""
    size, N = len(setting.grid), len(setting.positions)
    scans = 1 if len(setting.noise) else _SCANS
    numbers = np.zeros(7, np.int64)
    numbers[4], numbers[6] = setting.block, _SETTLING
    return Bank(
        np.empty((size, 6)), np.empty((size, 6, 6)), np.empty(size),
        np.empty((setting.block, N)), np.empty((setting.block, N)), numbers, np.zeros(4),
        np.empty((scans, N)), np.empty((scans, N)), np.empty(scans),
    )  # fmt: skip


def blank(*shape: int, mixture: int) -> Estimates:
    """Return estimates as they are where no member is."""
    return Estimates(
        np.full((*shape, 6), np.nan), np.full((*shape, 6, 6), np.nan), np.zeros(shape, np.int64),
        np.zeros((*shape, mixture)), np.full((*shape, mixture, 6), np.nan),
        np.full((*shape, mixture, 6, 6), np.nan), np.full(shape, -np.inf),
    )  # fmt: skip


def to_caller(found: Estimates, frame: Frame) -> Estimates:
    """Return estimates in the frame of the caller."""
    origin, turn = frame
    return found._replace(
        x=found.x @ turn + origin, P=turn.T @ found.P @ turn,
        means=found.means @ turn + origin, covariances=turn.T @ found.covariances @ turn,
    )  # fmt: skip


def _frame(array, x0):
    """Return center, axes (3, 3) as rows and radius of an array; x0 lies on its first axis."""
    center = array.positions.mean(axis=0)
    around = array.positions - center
    radius = float(np.sqrt(np.mean(np.sum(around**2, axis=-1))))
    _, spread, rows = np.linalg.svd(around, full_matrices=True)
    if len(array) < 3 or spread[1] < 1e-6 * spread[0]:
        raise ValueError(
            "array must have three sensors that are not on a line, got extents "
            f"{np.round(spread, 6).tolist()} m along its axes"
        )
    normal = rows[2] * np.sign((x0[:3] - center) @ rows[2])
    axes = np.array([normal, rows[0], np.cross(normal, rows[0])])
    positions = around @ axes.T
    flat = np.abs(positions[:, 0]).max() < _FLAT * radius
    if flat:
        positions[:, 0] = 0.0
    ahead, least = (x0[:3] - center) @ normal, positions[:, 0].max() + _LEAST * radius
    if not ahead > least:
        raise ValueError(
            f"x0 must lie in front of the sensors, more than {least:g} m from the middle of their "
            f"plane, got {ahead:g} m"
        )
    return center, axes, radius, positions, bool(flat), float(least)


@lru_cache(maxsize=16)
def _windows(mean, P, radius, least):
    """Return centers (W, 3) of eta and ln rho where the prior is, and the windows' widths (W, 3).

    The third (W,) is the logarithm of the sum of all windows, in the mean over each. The prior is
    given by the bytes of its mean and covariance: of the last ones the windows are remembered,
    which take as long as hundreds of samples of a filter.
    """
    mean, P = np.frombuffer(mean), np.frombuffer(P).reshape(6, 6)
    draws = np.random.default_rng(0).standard_normal((_DRAWN, 6))
    root = np.linalg.cholesky(P)
    seen = _seen(mean + draws @ root.T, radius, least)
    if not len(seen):
        raise ValueError("P0 must leave states in front of the sensors, got none")
    cells, place = _distinct(_cells(seen, radius, 1))
    drawn = np.bincount(place)
    order = np.argsort(-drawn, kind="stable")
    order = order[np.cumsum(drawn[order]) - drawn[order] < _COVERED * drawn.sum()]
    fine, middles = cells[order], _centers(cells[order], radius, 1)
    if drawn[order] @ _is_state(middles, radius, least) < _CENTERED * drawn.sum():
        # Near the plane a cell has room on both sides of it: what was drawn is on the right one.
        sums = np.zeros((len(cells), 3))
        np.add.at(sums, place, seen)
        middles = (sums / drawn[:, None])[order]
    # Outside, as far as the tail of the prior goes, a lattice whose cells are larger.
    far = draws[np.sum(draws[:, :3] ** 2, axis=-1) < _TAIL**2 / _SPREAD**2]
    far = _seen(mean + _SPREAD * far @ root.T, radius, least)
    coarse, _ = _distinct(_cells(far, radius, _COARSE))
    near = set(map(tuple, fine.tolist()))
    centers = _centers(coarse, radius, _COARSE)
    outside = [tuple(c) not in near for c in _cells(centers, radius, 1).tolist()]
    grid = np.concatenate([middles, centers[outside]])
    size = np.repeat([1, _COARSE], [len(fine), sum(outside)])
    widths = size[:, None] * (_WIDTH * np.array([_ACROSS / radius, _ACROSS / radius, _ALONG]))
    apart = (far[:_COUNTED, None] - grid) / widths
    inside = np.exp(-0.5 * np.sum(apart * apart, axis=-1))
    tiny = np.finfo(float).tiny  # for a window in which none of these points is
    overlaps = (inside.sum(axis=-1) @ inside + tiny) / (inside.sum(axis=0) + tiny)
    return grid, widths, np.log(overlaps)


def _distinct(rows):
    """Return the different rows (D, k) in order, and the place of each row (N, k) among them.

    They are those of `np.unique`, in a quarter of the time: it compares rows, this sorts columns.
    """
    order = np.lexsort(rows.T[::-1])
    first, place = np.ones(len(rows), bool), np.empty(len(rows), int)
    first[1:] = (rows[order[1:]] != rows[order[:-1]]).any(axis=-1)
    place[order] = np.cumsum(first) - 1
    return rows[order[first]], place


def _seen(states, radius, least):
    """Return eta and ln rho (..., 3) of those states that are in front of the sensors."""
    eta_y, eta_z, *_, rho = kernel.to_coordinates(*states[states[:, 0] > least].T, radius)
    return np.stack([eta_y, eta_z, np.log(rho)], axis=-1)


def _is_state(points, radius, least):
    """Return which points (W, 3) of eta and ln rho are of a position in front of the sensors."""
    eta_y, eta_z, ln_rho = points.T
    still = np.zeros(len(points))
    with np.errstate(invalid="ignore"):
        x = kernel.to_state(eta_y, eta_z, still, still, still, np.exp(ln_rho), radius)[0]
    return x > least


def _cells(points, radius, size):
    """Return the cells (..., 3) of a lattice in which points of eta and ln rho are.

    The lattice is hexagonal: rows sqrt(3) / 2 apart, each other one moved by half.
    """
    across = size * _ACROSS / radius
    row = np.round(points[:, 1] / (across * np.sqrt(3) / 2))
    column = np.round(points[:, 0] / across - 0.5 * (row % 2))
    return np.stack([column, row, np.round(points[:, 2] / (size * _ALONG))], axis=-1).astype(int)


def _centers(cells, radius, size):
    """Return eta and ln rho (..., 3) in the middle of cells."""
    across, (i, j, k) = size * _ACROSS / radius, cells.T
    return np.stack(
        [(i + 0.5 * (j % 2)) * across, j * across * np.sqrt(3) / 2, k * size * _ALONG], axis=-1
    )
