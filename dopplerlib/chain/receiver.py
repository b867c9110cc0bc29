"""Where a receiver stands still, by the Doppler shifts of satellites alone."""

from typing import Annotated, Literal

import numpy as np

from .. import _checks
from .._hints import Count, Positive, between, checked
from .._records import record
from .._typing import ArrayLike, FloatArray
from ..model.doppler import doppler_jacobian, doppler_shift
from ..model.information import inverse_information
from ..model.links import DopplerLinks
from ..signal.rinex import SatelliteShifts
from ._receiver_fit import least_absolute, reduced, relative_deviation, solve, typical
from .satellites import satellite_links

GATE = 5.0  # standard deviations; a normal error is beyond with probability 6e-7
_ROUNDS = 50
_ARRIVED = 1e-3  # m, of a step
_NEAR = 1e3  # m, of a step after which the place is good enough to know up from down


@record
class ReceiverFix:
    """Place of a receiver by Doppler shifts, with the grounds of its covariance.

    Attributes
    ----------
    position : ndarray, shape (3,)
        Place in m, in the frame of the earth.
    P : ndarray, shape (3, 3)
        Its covariance, with `offset_std`.
    clock : ndarray, shape (K,)
        Frequency offset of the receiver's clock at each epoch in Hz; NaN without measurements.
    z, residual, sigma_f : ndarray, shape (K, S)
        Measurements, what is left of them, and their standard deviations in Hz. NaN where there is
        none, or where it was left out.
    wrong : ndarray of bool, shape (K, S)
        Measurements that were left out as wrong. Whole epochs of them say that the receiver moved.
    level : float
        Standard deviation in Hz at 45 dB-Hz.
    offset_std : float
        Standard deviation in Hz of offsets, one for each satellite, that stay all the time: found
        by the residuals, zero if they show none.
    offset, offset_error : ndarray, shape (S,)
        Mean residual of each satellite in Hz, and its standard deviation if there were no offset.
    links : DopplerLinks
        Links at the place that was found.
    steps : ndarray, shape (J, 3)
        The places from the start to the end.
    converged : bool
        Whether the last step was shorter than 1 mm.
    """

    position: np.ndarray
    P: np.ndarray
    clock: np.ndarray
    z: np.ndarray
    residual: np.ndarray
    sigma_f: np.ndarray
    wrong: np.ndarray
    level: float
    offset_std: float
    offset: np.ndarray
    offset_error: np.ndarray
    links: DopplerLinks
    steps: np.ndarray
    converged: bool

    @property
    def state(self) -> FloatArray:
        """State at the first epoch as links have it, position, velocity zero, and clock (7,)."""
        position = _checks.matrix("position", [self.position], (1, 3))[0]
        clock = _checks.one_row("clock", self.clock, _checks.measured)
        return np.r_[position, np.zeros(3), np.nan_to_num(clock[:1])]


@checked
def locate_receiver(
    recording: SatelliteShifts,
    start: ArrayLike = (0.0, 0.0, 0.0),
    *,
    mask: Annotated[float, between(0, 90)] = 5.0,
    level: Positive | None = None,
) -> ReceiverFix:
    """Return the place of a receiver at rest by the Doppler shifts of satellites.

    Parameters
    ----------
    recording : SatelliteShifts
        What the receiver measured.
    start : array_like, shape (3,)
        Place in m where the search begins: by default the center of the earth.
    mask : float
        Least elevation in degrees of a satellite that counts.
    level : float, optional
        Standard deviation of a shift at 45 dB-Hz in Hz. If None, that of the residuals.

    Returns
    -------
    ReceiverFix
        Satellites and epochs without measurements are NaN.

    Raises
    ------
    ValueError
        If there are not more measurements than unknowns: three, and one clock for each epoch.

    Notes
    -----
    Gauss-Newton steps, each with the links of the place reached. The clock of each epoch is
    eliminated by weights. A deviation falls by a factor of ten for 20 dB more of C/N0, as in a
    loop that tracks the carrier; the one factor left is the `level`. Once the steps are short,
    satellites below the mask go, the air comes in, and shifts are left out that lie more than five
    deviations off the fit with the least absolute residuals, whose median tells the deviation.

    Noise of one second averages out over a minute, an offset that a satellite keeps does not. The
    variance of offsets is found by restricted maximum likelihood (Patterson and Thompson 1971): it
    is zero if the means of the residuals are no larger than noise makes them. With it the place is
    the generalized least squares estimate, and `P` its covariance. Two things are not in `P`. The
    variance of the offsets is itself an estimate from as many residuals as there are satellites
    beyond four: with few of them it may be found zero although it is not. And errors that look like
    another place of the receiver, as a delay at the zenith like one of height, show in no residual.

    Examples
    --------
    >>> from dopplerlib.signal.rinex import recorded_receiver
    >>> recording, place = recorded_receiver("javad")
    >>> fix = locate_receiver(recording.part(0, 6), place)
    >>> bool(np.linalg.norm(fix.position - place) < 100)
    True
    """
    place = _checks.exact_shape("start", _checks.moderate("start", start, (3,)), (3,)).copy()
    scale = relative_deviation(recording.cn0)
    steps, near, converged = [place], False, False
    wrong = np.zeros(scale.shape, bool)
    for _ in range(_ROUNDS):
        z, links = satellite_links(recording, place, mask if near else None)
        here = np.r_[place, np.zeros(links.n - 3)]
        r = z - doppler_shift(here[None], links)
        H = doppler_jacobian(here[None], links)[..., :3]
        sigma = np.where(np.isnan(z), np.nan, scale)
        if near:
            left = least_absolute(r, H, sigma)
            wrong = np.abs(left) > GATE * sigma * (level or typical(left / sigma, 3))
            sigma[wrong] = np.nan
        found = solve(r, H, sigma, level)
        place = place + found["step"]
        steps.append(place)
        length = np.linalg.norm(found.pop("step"))
        converged = near and bool(length < _ARRIVED)
        if converged:
            break
        near = near or bool(length < _NEAR)
    z = np.where(np.isnan(sigma), np.nan, z)
    return ReceiverFix(
        position=place,
        z=z,
        wrong=wrong,
        links=links,
        steps=np.array(steps),
        converged=converged,
        **found,
    )


@checked
def window_fixes(
    fix: ReceiverFix, epochs: Count = 1, unknown: Literal["position", "velocity"] = "position"
) -> tuple[FloatArray, FloatArray]:
    """Return estimates by parts of a recording, and their covariances by noise alone.

    Parameters
    ----------
    fix : ReceiverFix
        Fix by the whole of it, with the standard deviations of all measurements.
    epochs : int
        Number of epochs of a part. Parts follow on; what is left at the end is left out.
    unknown : {"position", "velocity"}
        "position" of a receiver at rest, one Gauss-Newton step from that of the whole; or its
        "velocity" against the earth at the position of the whole.

    Returns
    -------
    x : ndarray, shape (W, 3)
        Places in m, or velocities in m/s; NaN where a part has too few satellites.
    P : ndarray, shape (W, 3, 3)
        Covariances.

    Examples
    --------
    >>> from dopplerlib.signal.rinex import recorded_receiver
    >>> recording, _ = recorded_receiver("javad")
    >>> v, P = window_fixes(locate_receiver(recording.part(0, 6)), 3, "velocity")
    >>> bool(abs(v).max() < 0.1)
    True
    """
    links = _checks.instance("links", fix.links, DopplerLinks)
    H = doppler_jacobian(fix.state[None], links)
    residual = _checks.bounded("residual", fix.residual, (None, None))
    residual = _checks.exact_shape("residual", residual, H.shape[:2])
    there = ~np.isnan(_checks.exact_shape("sigma_f", np.asarray(fix.sigma_f), H.shape[:2]))
    sigma = _checks.deviation("sigma_f", np.where(there, fix.sigma_f, 1.0))
    parts = len(residual) // epochs
    if not parts:
        raise ValueError(f"epochs must be at most the {len(residual)} of the fix, got {epochs}")
    H = H[..., :3] if unknown == "position" else H[..., 3:6]
    r, H, w = reduced(residual, H, np.where(there, sigma, np.nan))
    shape = (parts, epochs * r.shape[1])
    r, w = (part[: parts * epochs].reshape(shape) for part in (r, w))
    H = H[: parts * epochs].reshape(*shape, 3)
    weighted = (H * w[..., None]).mT
    P, regular = inverse_information(weighted @ H)
    P = np.where(regular[:, None, None], P, np.nan)
    x = (P @ (weighted @ r[..., None]))[..., 0]
    return x + (fix.position if unknown == "position" else 0), P
