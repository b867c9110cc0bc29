"""Evidence on the signal chain: accuracy of the frequency estimate of a tone in noise."""

import numpy as np

from ...._hints import checked
from ....evaluation.intervals import ConfidenceInterval, mean_interval, proportion_interval
from ....replication.evidence import Readings
from ....signal.frequency import ml_frequency
from ....signal.interpolation import peak_bin
from ....signal.laws import (
    crlb_frequency_std,
    integrated_snr_for_std,
    overlap_correlation,
    window_for_std,
)
from ....signal.synthesis import tone
from ..published import reported

_RUNS = 4000
_FS = 10e3  # Hz; the paper prints none. Ratios to the bound do not depend on it.
_SNR_DB = 0.0  # where the paper says that the bound begins to be attained


@checked
def signal_evidence(rng: np.random.Generator) -> dict[str, object]:
    """Return evidence by the id of the claim, see `evidence`."""
    s = reported().scenario
    snr = 10 ** (_SNR_DB / 10)
    errors = {
        f"{n} samples, {name}": (_errors(estimator, n, child), crlb_frequency_std(snr, n, _FS))
        for (n, name, estimator), child in zip(
            (
                (10, "maximum of the periodogram", ml_frequency),
                (100, "maximum of the periodogram", ml_frequency),
                (1000, "maximum of the periodogram", ml_frequency),
                (100, "highest bin", peak_bin),
            ),
            rng.spawn(4),
            strict=True,
        )
    }
    normal = errors["100 samples, maximum of the periodogram"]
    rates = (10e3, 100e3, 1e6)
    needed = [integrated_snr_for_std(s.sigma_f, s.T) / (rate * s.T) for rate in rates]
    # Windows so long that the noise is as small as Section 4 sets it, every millisecond.
    long = [s.T / window_for_std(s.sigma_f, snr * rate) for rate in rates]
    return {
        "signal-bound": Readings(
            {name: mean_interval((e / bound) ** 2) for name, (e, bound) in errors.items()}
        ),
        "signal-depends": _dependence(rng.spawn(3)),
        "signal-normal": proportion_interval(np.abs(normal[0]) < 1.96 * normal[1]),
        "signal-variance": Readings(
            {
                f"{1e3 * window:.0f} ms": float(
                    crlb_frequency_std(snr, round(window * _FS), _FS) ** 2
                )
                for window in (0.001, 0.01, 0.1)
            }
        ),
        "signal-short": Readings(
            {
                f"{rate / 1e3:.0f} kHz": float(10 * np.log10(v))
                for rate, v in zip(rates, needed, strict=True)
            }
        ),
        "signal-white": Readings(
            {
                f"{r / 1e3:.0f} kHz": float(overlap_correlation(v))
                for r, v in zip(rates, long, strict=True)
            }
        ),
    }


def _dependence(children):
    """Return the variance ratios for twice the signal-to-noise ratio and for twice the length."""
    settings = ((100, 10.0), (100, 10.0 + 10 * np.log10(2)), (200, 10.0))
    usual, stronger, longer = (
        _errors(ml_frequency, n, child, level) ** 2
        for (n, level), child in zip(settings, children, strict=True)
    )
    return Readings({"ratio": _ratio(stronger, usual), "length": _ratio(longer, usual)})


def _ratio(some, others):
    """Return the ratio of two means, with an interval by the logarithms of both."""
    one, two = mean_interval(some), mean_interval(others)
    spread = np.hypot((one.high - one.value) / one.value, (two.high - two.value) / two.value)
    ratio = one.value / two.value
    return ConfidenceInterval(ratio, float(ratio * np.exp(-spread)), float(ratio * np.exp(spread)))


def _errors(estimator, n, rng, snr_db=_SNR_DB):
    """Return errors in Hz, of tones at random places of the middle half of the spectrum."""
    f = rng.uniform(-_FS / 4, _FS / 4, _RUNS)
    return estimator(tone(f, _FS, n, snr_db, rng=rng), _FS) - f
