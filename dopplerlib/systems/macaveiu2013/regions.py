"""For which noise the claims of Section IV hold: the document does not state its noise."""

from itertools import pairwise

import numpy as np

from ... import _checks
from ..._records import record
from ...evaluation.intervals import proportion_interval
from ...model.motion import ncv_transition
from .published import paths, settings
from .tracking import gain_sequence, measure

MUCH_SMALLER = 0.5  # our reading of "much smaller than 1 m": less than half of it
MOST = 0.9  # a claim on every record holds where it is true in this share of them
CLAIMS = ("Fig 7 much below 1 m", "all below 1 m", "10b and 11c worse", "all three")


@record
class Scores:
    """How the five paths went, in every run.

    Attributes
    ----------
    figures : tuple of int
        Numbers of the figures, in the order of the arrays.
    settled : ndarray, shape (paths, runs)
        Largest position error after the first second, in m.
    whole : ndarray, shape (paths, runs)
        Largest position error of the whole record, in m.
    speed : ndarray, shape (paths, runs, 2)
        Root mean square of the errors of v_x and v_y after the first second, in m/s.
    resolution : float
        Range resolution in m, the measure of the claims.
    """

    figures: tuple
    settled: np.ndarray
    whole: np.ndarray
    speed: np.ndarray
    resolution: float

    def small_in_figure_7(self, largest=None):
        """Return in which runs the error of Fig 7 is much smaller than the resolution, (runs,)."""
        largest = self.settled if largest is None else largest
        return largest[self.figures.index(7)] < MUCH_SMALLER * self.resolution

    def below_resolution(self, largest=None):
        """Return in which runs all five paths stay below the resolution, shape (runs,)."""
        largest = self.settled if largest is None else largest
        return largest.max(axis=0) < self.resolution

    def speed_worse_when_it_varies(self):
        """Return in which runs Figs 10b and 11c are worse than all of Figs 7 to 9, (runs,)."""
        row = {figure: self.speed[i] for i, figure in enumerate(self.figures)}
        steady = np.maximum.reduce([row[7], row[8], row[9]])
        return (row[10][:, 0] > steady[:, 0]) & (row[11][:, 1] > steady[:, 1])

    def by_claim(self):
        """Return in which runs each of `CLAIMS` is true, as a dict of arrays of shape (runs,)."""
        three = (
            self.small_in_figure_7(),
            self.below_resolution(),
            self.speed_worse_when_it_varies(),
        )
        return dict(zip(CLAIMS, (*three, np.all(three, axis=0)), strict=True))


def scores(runs, *, rng, s=None):
    """Run all five paths and score them.

    Parameters
    ----------
    runs : int
        Number of independent records of each path.
    rng : numpy.random.Generator
        Source of the measurement noise.
    s : Settings, optional
        Those of the data file if None.

    Returns
    -------
    Scores

    Raises
    ------
    ValueError
        If `runs` is not a positive whole number, or `rng` is not a generator.
    """
    runs = _checks.whole_number("runs", runs)
    _checks.generator("rng", rng)
    s = settings() if s is None else s
    return _scores(_unit_noise(runs, rng, s), s)


def _unit_noise(runs, rng, s):
    """Return noise of deviation one for every path, (K, position and velocity, paths, runs, axis).

    Time first, so that a step of the filter works on contiguous memory.
    """
    one, nothing = s.with_(sigma_p=1.0, sigma_v=1.0), np.zeros((s.samples, 4))
    children = rng.spawn(len(paths()))
    noise = np.stack([measure(nothing, runs, rng=child, s=one) for child in children])
    noise = noise.reshape(*noise.shape[:-1], 2, 2)
    return np.ascontiguousarray(np.moveaxis(noise, (2, 4), (0, 1)))


def _scores(noise, s):
    """Score the paths with this noise, scaled to the settings.

    The error after a step is e_k = (I - K) (F e_{k-1} - push) + K n_k, where push is what the truth
    does beside the model: x_k = F x_{k-1} + push. The filter is linear and its gains depend on no
    measurement, so the errors need neither states nor measurements, and both axes share F and K of
    2 by 2. `e` (2, paths * runs * axes) holds position and velocity of all of them side by side,
    so that a step is one product of matrices. Only what is scored is kept.
    """
    five = paths()
    truth = np.stack([path.truth for path in five.values()], axis=1)
    F = ncv_transition(s.T, dim=1)
    push = (truth[1:] - truth[:-1] @ ncv_transition(s.T).T).reshape(-1, len(five), 2, 2)
    K = gain_sequence(s)
    stay = np.eye(2) - K[1:]
    A, scaled = stay @ F, K * [s.sigma_p, s.sigma_v]
    pushed = np.einsum("kij,kfaj->kifa", stay, push)[..., None, :]
    shape, flat = noise.shape[1:], noise.reshape(*noise.shape[:2], -1)
    e = scaled[0] @ flat[0]  # the first state is the first measurement: its gain is the identity
    whole = np.sum(e[0].reshape(shape[1:]) ** 2, axis=-1)
    settled, speed = np.zeros_like(whole), np.zeros(shape[1:])
    for k in range(1, s.samples):
        e = (A[k - 1] @ e + scaled[k] @ flat[k]).reshape(shape) - pushed[k - 1]
        off = e[0, ..., 0] ** 2 + e[0, ..., 1] ** 2
        if k < s.skip:
            np.maximum(whole, off, out=whole)
        else:
            np.maximum(settled, off, out=settled)
            speed += e[1] ** 2
        e = e.reshape(2, -1)
    return Scores(
        tuple(five),
        settled=np.sqrt(settled),
        whole=np.sqrt(np.maximum(whole, settled)),
        speed=np.sqrt(speed / (s.samples - s.skip)),
        resolution=s.range_resolution,
    )


def claim_map(rows, columns, runs, *, rng, s=None):
    """Return in how many runs the claims hold, over two settings.

    Parameters
    ----------
    rows, columns : tuple (str, sequence of float)
        Name and values of a setting: "sigma_p", "sigma_v" or "w" of `Settings`.
    runs : int
        Number of records of each path at each place of the map.
    rng : numpy.random.Generator
        Source of the measurement noise. Every place gets the same draws, scaled: places differ by
        their settings alone.
    s : Settings, optional
        What is not varied; those of the data file if None.

    Returns
    -------
    dict of str to ndarray, shape (3, rows, columns)
        For each of `CLAIMS` the share of the runs in which it is true, and the ends of its 95 %
        interval.

    Raises
    ------
    ValueError
        If a name is none of the three; see `scores`.
    """
    s = settings() if s is None else s
    (row, heights), (column, widths) = rows, columns
    for name in (row, column):
        _checks.one_of("the name of a setting", name, ("sigma_p", "sigma_v", "w"))
    noise = _unit_noise(runs, rng, s)
    shape = len(heights), len(widths)
    shares = {name: np.empty((3, *shape)) for name in CLAIMS}
    for i, j in np.ndindex(shape):
        here = s.with_(**{row: heights[i], column: widths[j]})
        for name, true in _scores(noise, here).by_claim().items():
            share = proportion_interval(true)
            shares[name][:, i, j] = share.value, share.low, share.high
    return shares


def decided(shares):
    """Return where a claim holds: where it is true in most runs, `MOST` of them or more.

    Parameters
    ----------
    shares : ndarray, shape (3, ...)
        Shares and the ends of their intervals, from `claim_map`.

    Returns
    -------
    ndarray of int, shape (...)
        1 where the whole interval says so, -1 where it says the contrary, 0 where the runs are too
        few to tell.
    """
    return np.where(shares[1] >= MOST, 1, np.where(shares[2] < MOST, -1, 0))


def bounds(values, shares):
    """Return between which values of a setting a claim begins to hold, and ends.

    Parameters
    ----------
    values : sequence of float
        Of the setting, in rising order.
    shares : ndarray, shape (3, values)
        A row or a column of what `claim_map` returns for a claim.

    Returns
    -------
    list of tuple (float, float, bool)
        The last value before and the first one after, both decided, and whether the claim holds
        after it.
    """
    verdicts = decided(shares)
    told = [(value, one) for value, one in zip(values, verdicts, strict=True) if one]
    return [
        (float(before), float(after), bool(now > 0))
        for (before, was), (after, now) in pairwise(told)
        if was != now
    ]


def bounds_along(name, values, runs, *, rng, s=None):
    """Return between which values of one setting each claim begins to hold, and ends.

    Parameters
    ----------
    name : {"sigma_p", "sigma_v", "w"}
        The setting.
    values : sequence of float
        In rising order.
    runs, rng, s
        See `claim_map`.

    Returns
    -------
    dict of str to list
        For each of `CLAIMS`, see `bounds`.

    Raises
    ------
    ValueError
        See `claim_map`.
    """
    s = settings() if s is None else s
    other = "w" if name == "sigma_p" else "sigma_p"  # stays what it is
    shares = claim_map((name, values), (other, (getattr(s, other),)), runs, rng=rng, s=s)
    return {claim: bounds(values, share[..., 0]) for claim, share in shares.items()}
