"""From IQ to Doppler: a zero-padded Fourier transform that errs as little as `ml_frequency`.

``make bench NAME=iq`` writes what the chapter on benchmarks shows, in a minute. The frequency of a
tone in noise: the peak of the padded periodogram, by itself and with a parabola through the
logarithms of three points, beside the maximum of the likelihood, on the same windows. First comes
the error by padding, then the time at the least padding whose error is at most a hundredth larger.
Processor time of one thread.
"""

import time

import numpy as np
from measuring import interleaved, progress, save
from scipy.fft import fft, next_fast_len

from dopplerlib import ml_frequency, sliding_doppler
from dopplerlib.signal import interpolation
from dopplerlib.signal.synthesis import tone

FS, WINDOW, HOP, SENSORS = 10e3, 250, 10, 6
SNR, HIGHER_SNR = 10.0, 30.0  # dB
WINDOWS, TIMED = 4000, 1000  # for the errors, and for the times
ALLOWED = 1.01  # times the error of `ml_frequency`
LONGEST = 500 * WINDOW
BLOCK = 2**17  # numbers transformed at once, which a cache holds


def main():
    rng = np.random.default_rng(1)
    cases = {"FFT": (SNR, False), "FFT, parabola": (SNR, True)}
    cases[f"FFT, parabola, {HIGHER_SNR:g} dB"] = HIGHER_SNR, True
    found = {name: errors_by_padding(*case, rng) for name, case in cases.items()}
    # The first number of points at which the error is small enough.
    points = {name: rows["points"][-1] for name, rows in found.items()}

    windows = tone(rng.uniform(-4000, 4000, TIMED), FS, WINDOW, SNR, rng=rng)
    calls = {"ml_frequency": (lambda: ml_frequency(windows, FS), 5)}
    calls |= {
        name: (lambda name=name: padded_peak(windows, FS, points[name], cases[name][1]), 1)
        for name in cases
    }
    seconds = interleaved("windows", calls, time.process_time)

    record = tone(np.linspace(80, 120, SENSORS), FS, int(FS), SNR, rng=rng, chirp=-30.0)
    size = points["FFT, parabola"]
    settings = {
        "ml_frequency": {},
        "ml_frequency, band ±400 Hz": {"band": (-400, 400)},
        "FFT, parabola": {"estimator": lambda x, fs, band: padded_peak(x, fs, size, True)},
        "candan": {"estimator": interpolation.candan},
        "aboutanios_mulgrew": {"estimator": interpolation.aboutanios_mulgrew},
    }
    clocks = {
        name: (lambda options=options: sliding_doppler(record, FS, WINDOW, HOP, **options), 1)
        for name, options in settings.items()
    }
    found = {
        "fs": FS,
        "window": WINDOW,
        "allowed": ALLOWED,
        "errors": found,
        "s a window": {name: s / TIMED for name, s in seconds.items()},
        "s a second of six sensors": interleaved("a second", clocks, time.process_time),
    }
    save("iq", found, packages=("numpy", "numba", "scipy"))


def errors_by_padding(snr, parabola, rng):
    """Return points of the transform, and rms errors beside that of `ml_frequency`, until enough.

    The ratio is that of the same windows, with its standard error.
    """
    f = rng.uniform(-4000, 4000, WINDOWS)
    windows = tone(f, FS, WINDOW, snr, rng=rng)
    error = ml_frequency(windows, FS) - f
    sizes, ratios = [], []
    size = WINDOW
    while True:
        progress(f"{snr:g} dB, {'parabola of ' * parabola}{size} points")
        sizes.append(size)
        ratios.append(compared(padded_peak(windows, FS, size, parabola) - f, error))
        if ratios[-1][0] <= ALLOWED or size > LONGEST:
            break
        size = next_fast_len(int(1.25 * size))
    return {"snr in dB": snr, "rms error in Hz": rms(error), "points": sizes, "ratio": ratios}


def padded_peak(windows, fs, size, parabola):
    """Return the frequencies (runs,) of the peaks of periodograms padded to `size` points."""
    bins = np.empty(len(windows))
    step = max(1, BLOCK // size)
    for k in range(0, len(windows), step):
        spectrum = fft(windows[k : k + step], size)
        power = spectrum.real**2 + spectrum.imag**2
        peak = power.argmax(axis=-1)
        bins[k : k + step] = peak
        if parabola:
            rows = np.arange(len(peak))
            left, middle, right = (np.log(power[rows, (peak + i) % size]) for i in (-1, 0, 1))
            bins[k : k + step] += (left - right) / (2 * (left - 2 * middle + right))
    return (bins + size / 2) % size * (fs / size) - fs / 2


def rms(error):
    return np.sqrt(np.mean(error**2))


def compared(error, other):
    """Return the ratio of two rms errors of the same windows, and its standard error.

    By the delta method, from both squares of each window.
    """
    ratio = rms(error) / rms(other)
    influence = error**2 / np.mean(error**2) - other**2 / np.mean(other**2)
    return ratio, ratio / 2 * influence.std(ddof=1) / np.sqrt(len(error))


if __name__ == "__main__":
    main()
