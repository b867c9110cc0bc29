"""Evidence on the signal chain: accuracy of the frequency estimate of a tone in noise."""

from collections.abc import Callable

import numpy as np
from scipy.special import ndtr

from ....evaluation.intervals import ConfidenceInterval, mean_interval
from ....replication.choices import Choice
from ....replication.evidence import sweep
from ....signal.frequency import ml_frequency
from ....signal.interpolation import peak_bin
from ....signal.laws import crlb_frequency_std, overlap_correlation, window_for_std
from ....signal.synthesis import tone
from ..published import reported

_RUNS = 4000
_FS = 10e3  # Hz; ratios to the bound do not depend on it
_LEAST_DB = 0.0  # from which on the bound is attained, says the paper
_ESTIMATORS = {"between the bins": ml_frequency, "highest bin": peak_bin}


def signal_evidence(
    choice: Callable[..., tuple[Choice, ...]], rng: np.random.Generator
) -> dict[str, object]:
    """Return evidence by the id of the claim, see `evidence`; choices are asked for by name."""
    bound, normal, depends = rng.spawn(3)
    return {
        "signal-bound": sweep(choice("window-samples", "peak"), _over_bound, bound),
        "signal-normal": sweep(choice("snr", "window-samples", "peak"), _from_normal, normal),
        "signal-depends": sweep(choice("dependence"), _doubled, depends),
        "signal-variance": sweep(
            choice("snr", "sampling-rate", "window"), lambda *values: _std(*values) ** 2
        ),
        "signal-short": sweep(
            choice("snr", "sampling-rate"),
            lambda snr, rate: _std(snr, rate, reported().scenario.T),
        ),
        "signal-white": sweep(choice("snr", "sampling-rate"), _remembered),
    }


def _over_bound(rng, n, peak):
    errors = _errors(_ESTIMATORS[peak], int(n), rng, _LEAST_DB)
    return mean_interval((errors / crlb_frequency_std(_ratio(_LEAST_DB), int(n), _FS)) ** 2)


def _from_normal(rng, snr_db, n, peak):
    """Return the distance between the distribution of errors and a normal one of their size."""
    errors = np.sort(_errors(_ESTIMATORS[peak], int(n), rng, snr_db, 2000))
    expected = ndtr((errors - errors.mean()) / errors.std())
    steps = np.arange(len(errors) + 1) / len(errors)
    distance = float(max((steps[1:] - expected).max(), (expected - steps[:-1]).max()))
    # Dvoretzky, Kiefer and Wolfowitz: a distribution function of n draws is as near to its own.
    reach = float(np.sqrt(np.log(2 / 0.05) / (2 * len(errors))))
    return ConfidenceInterval(distance, max(0.0, distance - reach), distance + reach)


def _doubled(rng, what):
    """Return the ratio of variances if the signal-to-noise ratio or the length is doubled."""
    n, level = (200, 10.0) if what == "length" else (100, 10.0 + 10 * np.log10(2))
    usual, other = rng.spawn(2)
    one = mean_interval(_errors(ml_frequency, n, other, level) ** 2)
    two = mean_interval(_errors(ml_frequency, 100, usual, 10.0) ** 2)
    spread = np.hypot((one.high - one.value) / one.value, (two.high - two.value) / two.value)
    ratio = one.value / two.value
    return ConfidenceInterval(ratio, float(ratio * np.exp(-spread)), float(ratio * np.exp(spread)))


def _std(snr_db, rate, window):
    """Return the least standard deviation of a frequency from a window, in Hz."""
    return float(crlb_frequency_std(_ratio(snr_db), round(rate * window), rate))


def _remembered(snr_db, rate):
    """Return the largest correlation between shifts whose windows are as long as they must be."""
    s = reported().scenario
    lags = s.T * np.arange(1, s.samples)
    window = window_for_std(s.sigma_f, _ratio(snr_db) * rate)
    return float(np.abs(overlap_correlation(lags / window)).max())


def _errors(estimator, n, rng, snr_db, runs=_RUNS):
    """Return errors in Hz, of tones at random places of the middle half of the spectrum."""
    f = rng.uniform(-_FS / 4, _FS / 4, runs)
    return estimator(tone(f, _FS, n, snr_db, rng=rng), _FS) - f


def _ratio(level_db):
    return 10 ** (level_db / 10)
