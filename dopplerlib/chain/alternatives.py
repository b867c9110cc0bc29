"""Single mistakes that would explain a recording better than its setup does."""

import warnings
from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations

import numpy as np

from .. import _checks
from .._hints import Array, Positive, Probability, checked
from .._records import record
from ..estimation.initial_estimate import ImplausibleStart
from .baseband import Baseband
from .setup import Setup

_LOG_2PI = np.log(2 * np.pi)


@checked
@record
class Explanation:
    """Fit of a recording under the setup, and under each of several mistakes in it.

    Attributes
    ----------
    names : tuple of str
        What would be different: "sensors 1 and 3 exchanged".
    gain : ndarray, shape (M,)
        Twice the increase of the log likelihood under each of them; -inf without a track.
    limit : float
        A larger gain than this one is taken for an explanation.

    Examples
    --------
    >>> Explanation(("I and Q exchanged", "sensor 2 disagrees"), [-3.0, 80.0], 15.2).best
    'sensor 2 disagrees'
    """

    names: tuple[str, ...]
    gain: Array
    limit: Positive

    def __post_init__(self):
        """Check the fields."""
        if self.gain.shape != (len(self.names),):
            wanted = len(self.names), self.gain.shape
            raise ValueError("gain must have the shape ({},) of names, got {}".format(*wanted))

    @property
    def best(self) -> str | None:
        """Name of the mistake with the largest gain; None if that is not above `limit`."""
        i = int(np.argmax(self.gain))
        return self.names[i] if self.gain[i] > self.limit else None


@checked
@_checks.quiet
def explain(iq: Baseband, setup: Setup, probability: Probability = 1e-3) -> Explanation:
    """Look for a single mistake in a setup that explains a recording better.

    Parameters
    ----------
    iq : Baseband
        Samples of one record, with the array of `setup`.
    setup : Setup
        Settings, in which there may be a mistake.
    probability : float
        Of an explanation if there is no mistake, at most, see the notes.

    Returns
    -------
    Explanation
        Tried are: I and Q exchanged, of all sensors or of one; two sensors exchanged; one that
        disagrees with the others, whatever it is that it measures; one that is late or early by
        a window; a coordinate of the box that is not as known; a target that maneuvers ten times
        as much; standard deviations of shifts three times as large.

    Notes
    -----
    Each alternative is tracked anew, and compared by the likelihood of all shifts. A shift that an
    alternative does not explain counts as one anywhere in the band. For two given models, data of
    the first give the second a likelihood that is higher by a factor a with a probability of at
    most 1/a; hence the limit 2 log(M / probability) for M alternatives (Royall 1997). The
    likelihood of a start is that of its best state, so the bound is only near; the study of
    symptoms counts.

    No explanation is no proof that there is no mistake: what all sensors share, a lag, a wrong
    carrier, changes the likelihood little or not at all.

    Examples
    --------
    Two of three sensors on a wall, whose cables are exchanged:

    >>> from dopplerlib import RadarArray, iq_from_geometry
    >>> array = RadarArray([[0, 0, 1], [0, 2, 1], [0, 5, 1]], 0.0285)
    >>> box = [1, 0, 1], [6, 5, 1]
    >>> setup = Setup(array, box, 2, 0.1, window=0.05, start=0.3, search="whole")
    >>> path = [3, 2.5, 1] + np.arange(500)[:, None] / 500 * [-1, 0.6, 0]
    >>> x = iq_from_geometry(path, array, 20, rng=np.random.default_rng(1))
    >>> explain(Baseband(x[[1, 0, 2]], 500, array), setup).best
    'sensors 1 and 2 exchanged'
    """
    base = _fit(iq, setup, None)
    if base is None:
        raise ValueError("iq must be samples in which a target is detected, got none")
    names, found = [], []
    for name, other, changed in _alternatives(iq, setup):
        fit = _fit(other, changed, base[1])
        names.append(name)
        found.append(-np.inf if fit is None else base[0] - fit[0])
    return Explanation(tuple(names), found, 2 * np.log(len(names) / probability))


def _alternatives(iq: Baseband, setup: Setup) -> Iterator[tuple[str, Baseband, Setup]]:
    x, valid = iq.samples()
    iq, N = replace(iq, x=x, valid=valid), len(iq.array)
    yield "I and Q exchanged", replace(iq, x=x.conj()), setup
    yield "target maneuvers more", iq, _with(setup, velocity_random_walk=10)
    yield "standard deviations too small", iq, _with(setup, variance_inflation=9)
    lower, upper = map(np.array, setup.box)
    around = 0.1 * np.max(upper[:3] - lower[:3])
    for axis in np.flatnonzero(lower[:3] == upper[:3]):
        free = lower.copy(), upper.copy()
        free[0][axis] -= around
        free[1][axis] += around
        yield f"{'xyz'[axis]} not as known", iq, replace(setup, box=free)
    step = round(setup.window * iq.fs)
    for i in range(N):
        one = np.arange(N)[:, None] == i
        if N > 1:
            yield (
                f"I and Q of sensor {i + 1} exchanged",
                replace(iq, x=np.where(one, x.conj(), x)),
                setup,
            )
        if N > 2:
            yield f"sensor {i + 1} disagrees", replace(iq, valid=valid & ~one), setup
        if N > 1:
            for word, by in (("late", -step), ("early", step)):
                yield f"sensor {i + 1} {word}", _moved(iq, one, by), setup
    for i, j in combinations(range(N), 2):
        order = np.arange(N)
        order[[i, j]] = j, i
        other = replace(iq, x=x[..., order, :], valid=valid[..., order, :])
        yield f"sensors {i + 1} and {j + 1} exchanged", other, setup


def _with(setup, **factors):
    return replace(setup, **{name: by * getattr(setup, name) for name, by in factors.items()})


def _moved(iq, one, by):
    """Return samples of which one sensor's come `by` samples later."""
    n = iq.x.shape[-1]
    kept = (np.arange(n) >= by) & (np.arange(n) < n + by)
    x = np.where(one, np.roll(iq.x, by, axis=-1), iq.x)
    return replace(iq, x=x, valid=np.where(one, np.roll(iq.valid, by, axis=-1) & kept, iq.valid))


def _fit(iq, setup, wanted):
    """Return minus twice the log likelihood and the number of shifts, or None without a track.

    If there are fewer than `wanted`, each of the others has the density of a band of frequencies.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ImplausibleStart)
        found = setup.track(iq)
    score = float(np.min(found.score[..., -1]))
    if not np.isfinite(score):
        return None
    n = round(setup.window * iq.fs)
    apart = 1 if setup.hop is None else -(-n // max(1, round(setup.hop * iq.fs)))
    early = found.shift_std[..., (found.used - 1) % apart : found.used : apart, :]
    early = early[np.isfinite(early)]
    count = early.size + int(np.isfinite(found.shift[..., found.used :, :]).sum())
    score += count * _LOG_2PI + early.size * np.log(np.mean(early**2))
    missing = 0 if wanted is None else wanted - count
    top = setup.speed_limit * iq.array.doppler_per_speed
    return score + 2 * missing * np.log(2 * top), count
