"""How large the error of a position has to be: the area of the thesis, and the bound."""

import numpy as np

from ... import _checks
from ...evaluation.range_bounds import range_crlb
from ...tracking.bilateration import bilaterate
from .published import deviations, scenario
from .scene import radars


def error_area(position=None, snr_db=None, n_sigma=None, baseline=None, points=1):
    """Return the corners of the area in which a triangulated position is expected (Fig 5.5).

    Parameters
    ----------
    position : array_like, shape (2,), optional
        True position in m; (0, 4) if None.
    snr_db : float, optional
        Signal-to-noise ratio of both radars in dB; that of the law at each range if None.
    n_sigma : float, optional
        Half the width of each ring in standard deviations; 3 if None.
    baseline : float, optional
        In m; 1 m if None.
    points : int
        Number of points on each of the four sides: 1 gives the corners, more the curved outline.

    Returns
    -------
    ndarray, shape (4 points, 2)
        Points in m, around the area: from the left corner to the far, the right and the near one
        for a position in front.

    Raises
    ------
    ValueError
        If a pair of rings does not meet in four points.
    """
    e = scenario()["error_area"]
    p = np.array(e["position"]) if position is None else _checks.finite("position", position, (2,))
    n = e["n_sigma"] if n_sigma is None else _checks.positive_number("n_sigma", n_sigma)
    b = scenario()["radars"]["baseline"] if baseline is None else baseline
    d = np.hypot(p[0] + np.array([b / 2, -b / 2]), p[1])
    law = None if snr_db is None else lambda d: np.full(np.shape(d), float(snr_db))
    half = n * deviations(d, law)[:, 0]
    corners = np.array([[-1, 1], [1, 1], [1, -1], [-1, -1], [-1, 1]])
    at = np.arange(4 * _checks.whole_number("points", points)) / points
    signs = np.stack([np.interp(at, range(5), c) for c in corners.T], axis=-1)
    x, y, valid = bilaterate(*np.moveaxis(d + signs * half, -1, 0), b)
    if not valid.all():
        raise ValueError(f"position must be one whose rings meet in four points, got {p.tolist()}")
    return np.stack([x, y], axis=-1)


def one_scan_bound(p, baseline=None):
    """Return the least covariance of a position from the two ranges of one scan.

    Parameters
    ----------
    p : array_like, shape (..., 2)
        True positions in m.
    baseline : float, optional
        In m; 1 m if None.

    Returns
    -------
    ndarray, shape (..., 2, 2)
        The bound of `range_crlb` with the noise that Eq 5.1 has at each range, in m^2.
    """
    p, sensors = _checks.finite("p", p, (2,)), radars(baseline)
    lines = p[..., None, :] - sensors
    return range_crlb(p, sensors, deviations(np.hypot(lines[..., 0], lines[..., 1]))[..., 0])
