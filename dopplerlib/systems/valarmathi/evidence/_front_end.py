"""Evidence on what lies before and behind the filters: transform, residuals, lost sensors."""

import numpy as np

from ....evaluation.intervals import mean_interval
from ....signal.interpolation import parabolic, parabolic_three_highest, peak_bin
from ....signal.synthesis import iq_from_velocity, tone
from ..error_measures import run_measures
from ..fusion import error_correlation, matched_model
from ..published import reported
from ..residual_noise import residual_variance, updated_residual
from ..velocity_filter import filter_velocity
from ..velocity_paths import velocity_path
from ..window_transform import FilteredDoppler, doppler_filter, measurement_variance
from ._axes import swept

WINDOWS = (5, 8, 16, 32, 64, 96, 128)  # fixed ones, those beyond the range too
SNR_DB = 15.0
FAILED_AT = 7.5  # s: in the middle of the record, at constant velocity
_ESTIMATORS = {"neighbors of the highest": parabolic, "three highest": parabolic_three_highest}


def front_end(rng):
    """Return the evidence on transform, residuals, independence and a lost sensor."""
    for_padding, for_model, for_still, for_path = rng.spawn(4)
    _, ideal = matched_model(200, 700, SNR_DB, rng=for_model)
    white = _filtered(ideal, reported().chosen.fixed_window, 200)
    velocity = reported().stated.v_before
    still = _measured(np.full((10, 1, 2000), velocity), for_still)
    path = velocity_path("path 2")
    both = _measured(np.broadcast_to(path.v, (5, 2, len(path.v))), for_path)
    noise = for_path.standard_normal((5, len(path.v), 2)) @ [1, 1j]

    def overlapping(indices, fixed):
        return _residuals(*_filtered(still, fixed, 500), indices)

    return {
        "quantization": swept("nfft bins", _quantization),
        "padding": swept("padding snr", _padding, for_padding),
        "eq-14": swept("indices", lambda indices: _residuals(*white, indices)),
        "eq-14-overlap": swept("indices fixed", overlapping),
        "white-measurements": swept(
            "fixed",
            lambda fixed: float(error_correlation(still.part([fixed]), velocity, 1)[1]),
        ),
        "fused-covariance": _common_part(ideal),
        "redundancy": swept("failure fixed", lambda *one: _redundancy(path, both, noise, *one)),
    }


def _measured(v, rng):
    own, T = reported().chosen, reported().stated.T
    return doppler_filter(iq_from_velocity(v, T, own.wavelength, SNR_DB, rng=rng), WINDOWS)


def _filtered(doppler, window, skipped):
    """Return innovations of the first sensor, their variances, and the assumed R."""
    track = filter_velocity(doppler.part([window]), SNR_DB, window=window)
    R = float(measurement_variance(window, SNR_DB))
    return track.innovation[:, 0, skipped:], track.S[:, 0, skipped:], R


def _residuals(innovation, S, R, indices):
    """Return the variance that Eq 14 finds, over the assumed one."""
    residual, HPH = updated_residual(innovation, S, R)
    if indices == "before the update":
        residual, HPH = innovation, S - R
    return mean_interval(residual_variance(residual, HPH[:, -1]) / R)


def _common_part(doppler):
    """Return the mean NEES of naive fusion over its two components, when filters have settled.

    It claims half of the covariance of either; its error has what both have in common, too.
    """
    track = filter_velocity(doppler, SNR_DB)
    P, P12 = track.P[0, 0, -1], track.P12[0, -1]
    return float(np.trace(np.linalg.solve(track.fused_P[0, -1], (P + P12) / 2)) / 2)


def _quantization(nfft, bins):
    """Return the error of the parabola over that of the highest bin, of tones without noise."""
    window, T = reported().chosen.fixed_window, reported().stated.T
    steps = np.linspace(0.0, 1.0, 200, endpoint=False)  # of the bins of a window
    f = (10 + steps) / (window * T)
    x = np.exp(2j * np.pi * f[:, None] * T * np.arange(window))
    errors = [
        estimator(x, 1 / T, (0.0, 1 / T), nfft * window) - f
        for estimator in (_ESTIMATORS[bins], peak_bin)
    ]
    return float(np.sqrt(np.mean(errors[0] ** 2) / np.mean(errors[1] ** 2)))


def _padding(rng, padding, snr):
    """Return the error of the highest bin with padding over that without, by groups of tones."""
    window, T = reported().chosen.fixed_window, reported().stated.T
    f = rng.uniform(50.0, 250.0, (20, 50))
    x = np.array([[tone(one, 1 / T, window, snr, rng=rng) for one in group] for group in f])
    errors = [
        np.sqrt(np.mean((peak_bin(x, 1 / T, (0.0, 1 / T), length) - f) ** 2, axis=-1))
        for length in (padding * window, window)
    ]
    return mean_interval(errors[0] / errors[1])


def _redundancy(path, both, noise, failure, fixed):
    """Return the error after a sensor has failed: of the fusion over that of its filter alone."""
    T = reported().stated.T
    lost = slice(round(FAILED_AT / T) - both.first, None)
    part = both.part([fixed], [0, 1])
    v, snr_db = part.v.copy(), part.snr_db.copy()
    if failure.startswith("noticed"):
        v[:, :, 1, lost], snr_db[:, :, 1, lost] = np.nan, -30.0
    else:
        broken = doppler_filter(noise[:, None], [fixed])
        v[:, :, 1, lost], snr_db[:, :, 1, lost] = broken.v[:, :, 0, lost], -30.0
    track = filter_velocity(
        FilteredDoppler(part.windows, part.first, v, snr_db), SNR_DB, window=fixed
    )
    fused, alone = (
        run_measures(path, one)["whole"] for one in (track.fused_x[..., 0], track.x[:, 1, :, 0])
    )
    return mean_interval(fused / alone)
