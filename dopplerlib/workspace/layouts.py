"""Layouts of sensors judged over the workspace: bounds of targets, and their second valleys."""

from typing import Annotated

import numpy as np

from .._hints import Count, checked, exactly
from .._records import record
from .._typing import FloatArray
from ..evaluation.path_bounds import path_crlb
from ..model.information import fisher_information
from ..model.radar_array import RadarArray
from ._layout_valleys import LEAST, blocks, prior, starts
from .targets import ARRAY, INTERVAL, PRIOR_COVARIANCE, PRIOR_MEAN, SIGMA_F

# Directions, from the true one, in which a search for another valley starts; half a turn is the
# twin of a plane array.
_TURNS = np.pi * np.arange(1, 6) / 3
_RADIUS = 0.2

States = Annotated[FloatArray, exactly(None, 6)]


@record
class Twins:
    """The likeliest second valley of targets in uniform motion.

    Attributes
    ----------
    probability : ndarray, shape (R,)
        Probability that it weighs more than the true one; 0 where there is none.
    x : ndarray, shape (R, 6)
        State at its bottom at time zero, in m and m/s; the true one where there is none.
    """

    probability: np.ndarray
    x: np.ndarray


@checked
def named_layouts() -> dict[str, RadarArray]:
    """Return layouts of six sensors in a disc of 0.2 m that need no search.

    Returns
    -------
    dict of RadarArray
        The ring of the paper; the same with one sensor in the center, a gap on the rim; five even
        on the rim and one in the center; three on the rim and three on half of the radius, turned
        by 60 degrees; the ring with every other sensor set back by 5 cm; five and the center with
        two neighbors set back by 5 cm and the center by half of that; the ring with every other
        sensor set back and the last one, which is, moved to the center.

    Examples
    --------
    >>> [len(array) for array in named_layouts().values()]
    [6, 6, 6, 6, 6, 6, 6]
    """
    ring, center = ARRAY.positions, np.zeros((1, 3))
    five, three = (RadarArray.ring(n, _RADIUS).positions for n in (5, 3))
    inner = RadarArray.ring(3, _RADIUS / 2, np.pi / 3).positions
    back = ring.copy()
    back[1::2, 0] = -0.05
    tilted = np.concatenate([five, center])
    tilted[[2, 3, 5], 0] = -0.05, -0.05, -0.025
    return {
        "ring of six": ARRAY,
        "one moved to the center": RadarArray(np.concatenate([ring[:5], center])),
        "five and the center": RadarArray(np.concatenate([five, center])),
        "three and three, turned": RadarArray(np.concatenate([three, inner])),
        "ring, every other one set back": RadarArray(back),
        "five and the center, two set back": RadarArray(tilted),
        "one in the center, two set back": RadarArray(np.concatenate([back[:5], center])),
    }


@record
class LayoutQuality:
    """Quality of one array for many targets in uniform motion; numbers of each target.

    Attributes
    ----------
    static, moving : ndarray, shape (R,)
        Cramer-Rao bound of the position in m, with the prior of the workspace: of ten samples that
        all see the target where it is at time zero, and after 0.1 s of motion.
    range : ndarray, shape (R,)
        Bound of the distance from the origin in m, after 0.1 s.
    early, late : ndarray, shape (R,)
        Probability that a second valley weighs more after 0.05 and 0.1 s, see `twins`.
    """

    static: np.ndarray
    moving: np.ndarray
    range: np.ndarray
    early: np.ndarray
    late: np.ndarray


@checked
def layout_quality(x: States, array: RadarArray) -> LayoutQuality:
    """Return bounds and second valleys of targets in uniform motion before an array.

    Parameters
    ----------
    x : array_like, shape (R, 6)
        States at time zero in m and m/s, in front of the array.
    array : RadarArray
        Sensors near the plane x = 0, the target on the side of positive x.

    Returns
    -------
    LayoutQuality

    Examples
    --------
    The ring does not see range in ten samples; with one sensor in the center it does:

    >>> from dopplerlib.workspace.targets import TABLE_2
    >>> for name in ("ring of six", "five and the center"):
    ...     print(layout_quality(TABLE_2[None], named_layouts()[name]).static.round(2)[0])
    0.24
    0.13
    """
    static = np.linalg.inv(prior() + fisher_information(x, array, SIGMA_F, 10))
    path = np.repeat(x[:, None], 100, axis=1)
    path[..., :3] += INTERVAL * np.arange(1, 101)[:, None] * x[:, None, 3:]
    moving = path_crlb(path, array, SIGMA_F, PRIOR_COVARIANCE, INTERVAL, every=100)[:, 0, :3, :3]
    sight = path[:, -1, :3] / np.linalg.norm(path[:, -1, :3], axis=-1, keepdims=True)
    return LayoutQuality(
        np.sqrt(np.trace(static[:, :3, :3], axis1=1, axis2=2)),
        np.sqrt(np.trace(moving, axis1=1, axis2=2)),
        np.sqrt(np.einsum("ri,rij,rj->r", sight, moving, sight)),
        *(twins(x, array, samples).probability for samples in (50, 100)),
    )


@checked
def twins(x: States, array: RadarArray, samples: Count = 100) -> Twins:
    """Return second valleys of the posterior density, of targets in uniform motion.

    Parameters
    ----------
    x : array_like, shape (R, 6)
        True states at time zero in m and m/s, in front of the array.
    array : RadarArray
        Sensors near the plane x = 0, the target on the side of positive x.
    samples : int
        Number of samples.

    Returns
    -------
    Twins

    Notes
    -----
    Shifts without noise have the bottom of the true valley near the truth. Searches for another
    one start at five states with the same first harmonic around the array, the middle one of which
    is its twin (`dopplerlib.derive.ring_coordinates`). With noise, the logarithm of the ratio of
    the weights, by Laplace's approximation, is normal: its standard deviation is the distance d of
    the shifts of both, in standard deviations of the noise, its mean is -d^2/2 and the difference
    that prior and volumes make. A valley that is not found does not count, so that a probability
    is too low rather than too high.

    Examples
    --------
    >>> from dopplerlib.workspace.targets import TABLE_2
    >>> found = twins(TABLE_2[None], named_layouts()["ring of six"])
    >>> bool(0.03 < found.probability[0] < 0.1)
    True
    """
    from . import _layout_loop

    x = np.array(x, order="C")  # one that can be written to: for others numba compiles again
    seen, weights = blocks(samples, len(array))
    probability, other = np.empty(len(x)), np.empty((len(x), 6))
    _layout_loop.chances(
        x, starts(x, array, samples * INTERVAL / 2, _TURNS), array.positions,
        array.doppler_per_speed, seen, weights, PRIOR_MEAN, prior(), LEAST, probability, other,
    )  # fmt: skip
    return Twins(probability, other)
