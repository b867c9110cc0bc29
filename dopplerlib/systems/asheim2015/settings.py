"""Settings of one radar's filter: those of the thesis's text, of its code, and ours."""

from typing import Annotated, Literal

import numpy as np

from ..._hints import Positive, Probability, Reals, checked, exactly
from ..._records import record
from ..._typing import FloatArray
from ...model.motion import cwna_process_noise
from .noise import noise_std
from .published import reported

Pair = Annotated[FloatArray, exactly(2)]
Symmetric = Annotated[FloatArray, exactly(2, 2)]


@checked
@record
class FilterSettings:
    """Settings of one radar's filter.

    name: Whose settings they are.
    T: Sampling interval in s.
    Q (2, 2): Covariance of the process noise of [range, velocity].
    variances (2,): Variances of range in m^2 and velocity in m^2/s^2; those of the noise law at the
        predicted range if None.
    floor (2,): Least standard deviations in m and m/s, added in squares to those of the law.
    box (2,): Half-widths of the fixed gate in m and m/s.
    gate: Which gate is used.
    gate_probability: Probability of a detection of the target to be inside the gate on NIS.
    P0 (2, 2): Covariance with which the filter starts.

    Examples
    --------
    >>> filter_settings("code").R(4.0).tolist()
    [0.2, 0.01]
    """

    name: Literal["text", "code", "modern"]
    T: Positive
    Q: Symmetric
    variances: Pair | None
    floor: Pair
    box: Pair
    gate: Literal["box", "nis"] | None
    gate_probability: Probability
    P0: Symmetric

    @checked
    def R(self, d: Reals) -> FloatArray:
        """Return variances of range and velocity at the ranges `d` (...), shape (..., 2)."""
        if self.variances is not None:
            return np.broadcast_to(self.variances, (*np.shape(d), 2))
        return noise_std(d) ** 2 + np.square(self.floor)


@checked
def filter_settings(
    name: Literal["text", "code", "modern"],
    T: Positive | None = None,
    *,
    q: Positive | None = None,
    floor: Pair | None = None,
    gate: Literal["own", "box", "nis"] | None = "own",
) -> FilterSettings:
    """Return the settings of one radar's filter.

    name: The settings of the thesis's text (Sec 5.5.1), those of its code (Appendix A), or ours.
    T: Sampling interval in s; that of the simulation, 0.1 s, if None.
    q: For "modern": spectral density of the acceleration in m^2/s^3.
    floor (2,): For "modern": least standard deviations in m and m/s; (0, 0) for none.
    gate: Another gate than the settings' own, which is the box for text and code.
    Raises ValueError if a name is not known or a number not positive.

    Notes
    -----
    Text and code compare a squared innovation over S with a bound over S, so that S cancels: both
    gates are the box sqrt(c sigma). The code adds sigma of the range where its square belongs.

    Examples
    --------
    >>> filter_settings("text").box.round(2).tolist()
    [0.89, 0.63]
    """
    s = reported().scenario
    f, T = s.filter, s.tracks.T if T is None else T
    own = f.table[name]
    box = [np.sqrt(f.c * sigma) for sigma in (f.sigma_range, f.sigma_velocity)]
    if name == "modern":
        Q = cwna_process_noise(T, own.q if q is None else q, dim=1)
        variances = None
        floor = (own.floor_range, own.floor_velocity) if floor is None else floor
    else:
        variances, floor = (own.range_variance, own.velocity_variance), (0.0, 0.0)
        if name == "text":
            Q = np.diag(own.Q_diagonal)
        else:
            Q = own.Q_factor * np.array([[T**2 / 3, T / 2], [T / 2, 1]])
    if gate == "own":
        gate = "nis" if name == "modern" else "box"
    P0 = f.start_covariance * np.eye(2)
    return FilterSettings(name, T, Q, variances, floor, box, gate, f.modern.gate_probability, P0)
