"""The expected error of a position: the area of the thesis, and the Cramér-Rao bound."""

from functools import partial
from typing import Annotated

import numpy as np

from ... import _checks
from ..._hints import Count, Positive, checked, exactly, shaped
from ..._typing import FloatArray
from ...evaluation.range_bounds import range_crlb
from ...tracking.bilateration import bilaterate
from .noise import _near, noise_std
from .published import reported
from .scene import Baseline, radar_positions

Decibels = Annotated[float, partial(_checks.one_number, check=_checks.decibels)]


@checked
def error_area(
    position: Annotated[FloatArray, exactly(2, check=_near)] | None = None,
    snr_db: Decibels | None = None,
    n_sigma: Positive | None = None,
    baseline: Baseline | None = None,
    points: Count = 1,
) -> FloatArray:
    """Return the corners of the area in which a bilaterated position is expected (Fig 5.5).

    position (2,): True position in m; (0, 4) if None.
    snr_db: Signal-to-noise ratio of both radars in dB; that of the law at each range if None.
    n_sigma: Half the width of each ring in standard deviations; 3 if None.
    baseline: In m; 1 m if None.
    points: Number of points on each of the four sides: 1 gives the corners, more the curved
        outline.
    Returns (4 points, 2): Points in m, around the area: from the left corner to the far, the right
        and the near one for a position in front.
    Raises ValueError if an argument is not of the kind described, or a pair of rings does not meet
        in four points.

    Examples
    --------
    >>> error_area(snr_db=10.0).round(1).tolist()
    [[-0.8, 3.9], [0.0, 4.1], [0.8, 3.9], [0.0, 3.9]]
    """
    s = reported().scenario
    p = s.error_area.position if position is None else position
    n = s.error_area.n_sigma if n_sigma is None else n_sigma
    b = s.radars.baseline if baseline is None else baseline
    d = np.hypot(p[0] + np.array([b / 2, -b / 2]), p[1])
    law = None if snr_db is None else lambda d: np.full(np.shape(d), float(snr_db))
    half = n * noise_std(d, law)[:, 0]
    corners = np.array([[-1, 1], [1, 1], [1, -1], [-1, -1], [-1, 1]])
    at = np.arange(4 * _checks.count("points", points, 10**6)) / points
    signs = np.stack([np.interp(at, range(5), c) for c in corners.T], axis=-1)
    d1, d2 = np.moveaxis(d + signs * half, -1, 0)
    x, y, valid = bilaterate(d1, d2, b)
    if not valid.all():
        raise ValueError(f"position must be one whose rings meet in four points, got {p.tolist()}")
    return np.stack([x, y], axis=-1)


@checked
def one_scan_bound(
    p: Annotated[FloatArray, shaped(2, check=_near)], baseline: Baseline | None = None
) -> FloatArray:
    """Return the least covariance of a position from the two ranges of one scan.

    p (..., 2): True positions in m.
    baseline: In m; 1 m if None.
    Returns (..., 2, 2): The bound of `range_crlb` with the noise that Eq 5.1 has at each range, in
        m^2: infinite or NaN on the line through the radars, where ranges do not fix y.
    Raises ValueError if an argument is not of the kind described; see also `range_crlb`.

    Examples
    --------
    >>> np.sqrt(np.diag(one_scan_bound([0.0, 4.0]))).round(2).tolist()
    [0.4, 0.05]
    """
    sensors = radar_positions(baseline)
    lines = p[..., None, :] - sensors
    return range_crlb(p, sensors, noise_std(np.hypot(lines[..., 0], lines[..., 1]))[..., 0])
