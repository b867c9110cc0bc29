"""Interpretations of Section 3.4, ranked by the likelihood of the maps of Fig 3."""

from typing import Annotated, Literal

import numpy as np
from scipy.special import ndtr

from .... import _checks
from ...._hints import Probability, between, checked, exactly, up_to
from ...._records import record
from ...._typing import FloatArray
from ..error_maps import ErrorMap
from ..published import PublishedFigure3

QUANTITIES = ("position", "state", "velocity")


def _as_published(values):
    """Return a map as it is: sensors along y, the velocity of the text."""
    return values


def _velocity_reversed(values):
    """Return the map for the opposite v_x: reflected upside down, as the sensors stay."""
    return values[::-1]


def _turned(values):
    """Return the map with sensors and velocity turned by a quarter: sensors along x.

    From +x towards -y; the other way is the same but for the sign of the velocity, to which the
    errors of a stationary target are blind.
    """
    return np.swapaxes(values[::-1], 0, 1)


def _array_turned(values):
    """Return the map with the sensors along x and the velocity of the text."""
    return _turned(values)[::-1]


ORIENTATIONS = {
    "as published": _as_published,
    "v_x reversed": _velocity_reversed,
    "array turned": _array_turned,
    "all turned": _turned,
}


Quantity = Literal["position", "state", "velocity"]
Width = Annotated[float, between(0.001, 100)]


@checked
@record
class MapReading:
    """An interpretation of the figure, and its log-likelihood below that of the best one.

    orientation: One of `ORIENTATIONS`.
    label: Which of the maps.
    quantity: Whose error.
    behind: By how much its log-likelihood is below that of the best reading.
    deviation: Standard error of `behind`, from how it varies between places; zero for the best.
    """

    orientation: str
    label: str
    quantity: Quantity
    behind: float
    deviation: float

    def __str__(self):
        """Return a line of a table, the loss with the half width of its 95 % interval."""
        names = f"{self.orientation:13} {self.label:8} {self.quantity:8}"
        return f"{names} {0 - self.behind:6.0f} +/- {1.96 * self.deviation:.0f}"


@checked
@_checks.quiet
def map_score(
    error: Annotated[FloatArray, exactly(None, None, None, check=_checks.measured)],
    published: PublishedFigure3,
    panel: Annotated[int, up_to(1, least=0)],
    *,
    width: Width = 0.15,
    stray: Probability = 0.02,
) -> FloatArray:
    """Return the log-likelihood of every published value under draws of an error.

    error (39, 39, draws): Draws, as `figure3` makes them, oriented as the figure.
    published: The digitized figure.
    panel: 0 for the left map, 1 for the right one.
    width: Standard deviation of the kernel that smooths the draws, in powers of ten.
    stray: Fraction of values that may be anything: half of them below the lowest contour, half
        within three powers of ten above it.
    Returns (39, 39): Per power of ten. Where the published error is only known to be below the
        lowest contour, the logarithm of the probability of that. NaN where it is hidden, and on the
        lines x = 0 and y = 0, on one of which every reading has its sensors.

    Examples
    --------
    >>> from dopplerlib.systems.mittermaier2016 import error_map, reported
    >>> ours = error_map(2, rng=np.random.default_rng(1))
    >>> map_score(ours.position, reported().figure3, 0).shape
    (39, 39)
    """
    if error.shape[:2] != published.error.shape[1:]:
        raise ValueError(
            f"error must have shape {published.error.shape[1:]} by draws, got {error.shape}"
        )
    draw = np.log10(error)
    value, below = np.log10(published.error[panel]), published.below[panel]
    density = np.exp(-0.5 * ((value[..., None] - draw) / width) ** 2).mean(axis=-1)
    density /= np.sqrt(2 * np.pi) * width
    chance = ndtr((np.log10(published.lowest) - draw) / width).mean(axis=-1)
    score = np.where(
        below, np.log((1 - stray) * chance + stray / 2), np.log((1 - stray) * density + stray / 6)
    )
    axes = (np.abs(published.x)[:, None] < 1e-9) | (np.abs(published.y) < 1e-9)
    return np.where(axes, np.nan, score)


@checked
@_checks.quiet
def map_readings(
    maps: dict[str, ErrorMap],
    published: PublishedFigure3,
    panel: Annotated[int, up_to(1, least=0)],
    *,
    width: Width = 0.15,
) -> list[MapReading]:
    """Compare readings of one map of Fig 3: its orientation, its estimator, its quantity.

    maps: Our draws by label, all of the same number.
    published: The digitized figure.
    panel: 0 for the left map, 1 for the right one.
    width: See `map_score`.
    Returns: The best first.
    Raises ValueError if the maps have different numbers of draws: more of them give a smoother
        density.

    Examples
    --------
    >>> from dopplerlib.systems.mittermaier2016 import error_map, reported
    >>> ours = error_map(2, rng=np.random.default_rng(1))
    >>> map_readings({"one sample": ours}, reported().figure3, 0)[0].behind
    0.0
    """
    numbers = {m.position.shape[-1] for m in maps.values()}
    if len(numbers) != 1:
        raise ValueError(f"maps must have the same number of draws, got {sorted(numbers)}")
    scores = {
        (orientation, label, quantity): map_score(
            turn(getattr(m, quantity)), published, panel, width=width
        )
        for orientation, turn in ORIENTATIONS.items()
        for label, m in maps.items()
        for quantity in QUANTITIES
    }
    best = max(scores.values(), key=np.nansum)
    readings = []
    for names, score in scores.items():
        loss = (best - score)[~np.isnan(score)]
        readings.append(MapReading(*names, loss.sum(), np.sqrt(loss.size) * loss.std()))
    return sorted(readings, key=lambda reading: reading.behind)
