"""Baseband samples of an array, after low-pass filter and decimation."""

from dataclasses import replace
from typing import Annotated

import numpy as np

from .. import _checks
from .._hints import Booleans, Positive, Real, checked
from .._records import record
from .._typing import ArrayLike, BoolArray, ComplexArray
from ..model.radar_array import RadarArray
from ..signal.front_end import lowpass, lowpass_decimate
from ..signal.impairments import branches_differ, remove_mean
from ..signal.recording import Recording
from ..signal.validity import known_samples, valid_samples

_SAME_WAVELENGTH = 1e-3  # relative: a difference of that scales all speeds as much


@checked
@record
class Baseband:
    """Baseband samples of an array, with the validity of each.

    Attributes
    ----------
    x : ndarray of complex, shape (..., N, n)
        Samples of N sensors, from a filter that is full.
    fs : float
        Sampling rate in Hz.
    array : RadarArray
        The N sensors.
    delay : float
        Group delay of the low-pass in s.
    first : float
        Time on the clock at which the first sample comes out, in s. It shows what happened at
        ``first - delay``.
    noise_gain : float
        Variance of white noise after the low-pass over what its density in the passband amounts
        to at the new rate. Below 1: the skirts of the filter lose a little of it.
    valid : ndarray of bool, shape (..., N, n), optional
        Which samples are measurements, and finite, as decided before the low-pass: see
        `valid_samples` and `lowpass_decimate`. If None, the samples in `x` tell it.
    without_q : bool
        Whether the modules have no Q, see `Recording`.

    Examples
    --------
    >>> array = RadarArray([[0, -0.1, 0], [0, 0.1, 0]])
    >>> x = np.random.default_rng(1).standard_normal((2, 50, 2)) @ [1, 1j]
    >>> Baseband(x, 1e3, array).noise_gain
    1.0
    """

    x: Annotated[ComplexArray, _checks.numbers]
    fs: Positive
    array: RadarArray
    delay: Real = 0.0
    first: Real = 0.0
    noise_gain: Positive = 1.0
    valid: Booleans | None = None
    without_q: bool = False

    def __post_init__(self):
        """Check the fields."""
        _checks.check_shape("x", self.x, (len(self.array), None))
        if self.valid is not None:
            known_samples("x", self.x, self.valid, (None,))

    @classmethod
    def from_samples(
        cls,
        x: ArrayLike,
        fs: float,
        array: RadarArray,
        *,
        factor: int = 1,
        taps: int | None = None,
        valid: ArrayLike | None = None,
    ) -> "Baseband":
        """Low-pass filter and decimate samples of a converter.

        Parameters
        ----------
        x : array_like of complex, shape (..., N, n)
            IQ samples of N sensors.
        fs : float
            Their sampling rate in Hz.
        array : RadarArray
            The N sensors.
        factor : int
            Every how many samples one is kept. Doppler shifts up to ``0.4 fs / factor`` stay as
            they are, see `lowpass_decimate`. With 1 there is no low-pass.
        taps : int, optional
            Length of the filter, odd; 20 for each of the `factor` and one more if None.
        valid : array_like of bool, broadcast to (..., N, n), optional
            Which samples are measurements, see `valid_samples`. If None, the samples behind the
            low-pass tell it later.

        Returns
        -------
        Baseband
            Its clock starts with the first sample. What comes out while the filter is filling is
            left out.

        Raises
        ------
        ValueError
            If an argument is refused by `lowpass_decimate`, or no sample is left.

        Examples
        --------
        >>> array = RadarArray([[0, -0.1, 0], [0, 0.1, 0]])
        >>> x = np.random.default_rng(1).standard_normal((2, 500, 2)) @ [1, 1j]
        >>> iq = Baseband.from_samples(x, 10e3, array, factor=5)
        >>> iq.x.shape, iq.fs, iq.delay, iq.first, round(iq.noise_gain, 2)
        ((2, 80), 2000.0, 0.005, 0.01, 0.96)
        """
        y, fs_out, delay, *kept = lowpass_decimate(x, fs, factor, taps, valid=valid)
        filling = int(np.ceil(2 * delay * fs_out - 1e-9))
        if not y[..., filling:].size:
            raise ValueError(
                f"factor must leave samples of x behind the low-pass, got {factor} for "
                f"{np.shape(x)[-1]} samples and {round(2 * delay * fs) + 1} taps"
            )
        kept = kept[0][..., filling:] if kept else None
        gain = _noise_gain(fs, factor, round(2 * delay * fs) + 1)
        return cls(y[..., filling:], fs_out, array, delay, filling / fs_out, gain, kept)

    @classmethod
    @checked
    def from_recording(
        cls, recording: Recording, array: RadarArray, *, factor: int = 1, taps: int | None = None
    ) -> "Baseband":
        """Low-pass filter and decimate a recording.

        Parameters
        ----------
        recording : Recording
            Samples of N sensors. Their validity mask is kept.
        array : RadarArray
            Where these sensors are, in the same order, with the recording's wavelength.
        factor, taps : int
            See `from_samples`.

        Returns
        -------
        Baseband
            Its clock starts with the first sample of the recording.

        Raises
        ------
        ValueError
            If the number of sensors differs, or the wavelength by more than a thousandth, or an
            argument is refused by `from_samples`.

        Examples
        --------
        >>> x = np.random.default_rng(1).standard_normal((2, 500, 2)) @ [1, 1j]
        >>> recording = Recording(x, 10e3, 10.525e9)
        >>> array = RadarArray([[0, 0, 1], [6, 0, 1]], recording.wavelength)
        >>> Baseband.from_recording(recording, array, factor=5).x.shape
        (2, 80)
        """
        if len(recording.x) != len(array):
            raise ValueError(
                f"array must have the {len(recording.x)} sensors of recording, got {len(array)}"
            )
        if not np.isclose(array.wavelength, recording.wavelength, _SAME_WAVELENGTH, 0.0):
            raise ValueError(
                f"array must have the wavelength {recording.wavelength:.6g} m of recording, "
                f"got {array.wavelength:.6g} m"
            )
        iq = cls.from_samples(
            recording.x, recording.fs, array, factor=factor, taps=taps, valid=recording.valid
        )
        return replace(iq, without_q=recording.without_q)

    def samples(self) -> tuple[ComplexArray, BoolArray]:
        """Return the samples, with zeros in place of invalid ones, and the mask.

        Returns
        -------
        x : ndarray of complex, shape (..., N, n)
        valid : ndarray of bool, shape (..., N, n)
            False throughout for a module whose I and Q are proportional: they tell no direction.

        Examples
        --------
        >>> x = np.random.default_rng(1).standard_normal((2, 50, 2)) @ [1, 1j]
        >>> x[1] = x[1].real
        >>> Baseband(x, 1e3, RadarArray([[0, -1, 0], [0, 1, 0]])).samples()[1].all(axis=-1)
        array([ True, False])
        """
        valid = valid_samples(self.x) if self.valid is None else self.valid
        x, valid = known_samples("x", self.x, valid, (None,))
        known = valid & branches_differ(remove_mean(x, valid), valid)[..., None]
        return np.where(known, x, 0.0), known


def _noise_gain(fs, factor, taps):
    """Return the power of the low-pass's impulse response, times `factor`."""
    impulse = np.zeros(2 * taps - 1)
    impulse[0] = 1.0
    b = lowpass(impulse, fs, fs / (2 * factor), taps)[0].real if factor > 1 else impulse
    return factor * float(np.sum(b**2))
