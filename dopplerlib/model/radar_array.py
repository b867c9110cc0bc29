"""Positions and wavelength of an array of sensors."""

from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np

from .. import _checks
from .._hints import Positive, Runs, checked, up_to
from .._records import record
from .._typing import ArrayLike

_AXES = {"x": 0, "y": 1, "z": 2}


@record
class RadarArray:
    """Fixed monostatic continuous-wave radar sensors on one platform.

    Parameters
    ----------
    positions : array_like, shape (N, 3)
        Sensor positions in m.
    wavelength : float
        Wavelength in m. The default, 12.5 mm, is the paper's 24 GHz with its 160 Hz per m/s.

    Raises
    ------
    ValueError
        If `positions` is not an (N, 3) array of numbers up to 1e60 with at least one sensor, if two
        sensors share a place, or if `wavelength` is not between 1e-60 and 1e60.

    Notes
    -----
    Mittermaier et al. (2016), Eq 2 and Section 4.

    Examples
    --------
    >>> RadarArray([[0, -0.1, 0], [0, 0.1, 0]]).doppler_per_speed
    160.0
    """

    positions: np.ndarray
    wavelength: float = 0.0125

    if TYPE_CHECKING:  # what a field holds is an array, what makes it need not be

        def __init__(self, positions: ArrayLike, wavelength: float = 0.0125) -> None: ...

    def __post_init__(self):
        """Check the fields."""
        positions = _checks.moderate("positions", self.positions, (None, 3)).copy()
        if positions.ndim != 2 or not len(positions):
            raise ValueError(f"positions must have shape (N, 3) with N >= 1, got {positions.shape}")
        if len(np.unique(positions, axis=0)) < len(positions):
            raise ValueError(f"positions must differ from one another, got {positions.tolist()}")
        wavelength = _checks.moderate_number("wavelength", self.wavelength)
        return {"positions": positions, "wavelength": wavelength}

    def __len__(self):
        """Return the number of sensors N."""
        return len(self.positions)

    @property
    def doppler_per_speed(self) -> float:
        """Doppler shift of a radial speed of 1 m/s, which is 2 / wavelength, in Hz per m/s."""
        return 2 / self.wavelength

    @classmethod
    @checked
    def ring(
        cls,
        n: Runs,
        radius: Positive,
        phase: float = 0.0,
        normal: Literal["x", "y", "z"] = "x",
        wavelength: float = 0.0125,
    ) -> "RadarArray":
        """Return `n` sensors at equal angles on a circle about the origin.

        Parameters
        ----------
        n : int
            Number of sensors.
        radius : float
            Radius in m.
        phase : float
            Angle of the first sensor in rad, counted from the axis that follows `normal`
            (y for x, z for y, x for z) towards the one after it.
        normal : {"x", "y", "z"}
            Axis at right angles to the plane of the ring.
        wavelength : float
            Wavelength in m.

        Examples
        --------
        >>> RadarArray.ring(4, 0.2).positions.round(3)[:2].tolist()
        [[0.0, 0.2, 0.0], [0.0, 0.0, 0.2]]
        """
        angle = _checks.one_number("phase", phase) + 2 * np.pi * np.arange(n) / n
        axis = _AXES[normal]
        positions = np.zeros((n, 3))
        positions[:, (axis + 1) % 3] = radius * np.cos(angle)
        positions[:, (axis + 2) % 3] = radius * np.sin(angle)
        return cls(positions, wavelength)

    @classmethod
    @checked
    def linear(
        cls,
        n: Annotated[int, up_to(10**6, 2)],
        length: Positive,
        axis: Literal["x", "y", "z"] = "y",
        wavelength: float = 0.0125,
    ) -> "RadarArray":
        """Return `n` sensors at equal distances on a line through the origin, its center.

        Parameters
        ----------
        n : int
            Number of sensors, at least 2.
        length : float
            Distance between the first and the last sensor in m.
        axis : {"x", "y", "z"}
            Axis along which the sensors stand.
        wavelength : float
            Wavelength in m.

        Examples
        --------
        >>> RadarArray.linear(3, 0.4).positions.tolist()
        [[0.0, -0.2, 0.0], [0.0, 0.0, 0.0], [0.0, 0.2, 0.0]]
        """
        positions = np.zeros((n, 3))
        positions[:, _AXES[axis]] = np.linspace(-length / 2, length / 2, n)
        return cls(positions, wavelength)
