"""Peaks of zero-padded transforms of windows that slide by one sample, compiled."""

import numpy as np
from numba import njit

options = dict(nogil=True, fastmath=True, error_model="numpy", cache=True)


@njit(**options)
def _add(sum_re, sum_im, re, im, c, s):
    """Add one sample to the sums; in two loops, for with more arrays the compiler gives up."""
    for k in range(len(c)):
        sum_re[k] += re * c[k] - im * s[k]
    for k in range(len(c)):
        sum_im[k] += re * s[k] + im * c[k]


def slide(re, im, wave_re, wave_im, windows, first, place, power):
    """Write `place` (W, R, K) in bins and `power` of the highest bin of each window.

    `re`, `im` (R, samples) hold records, `wave_re`, `wave_im` (N, N) the powers of the N-th root
    of unity: row m, column k is exp(-2 pi j m k / N). The window of sample n ends with it; the
    first has n = `first`. The phase of a transform is counted from sample 0 and not from the
    start of the window, so that a step adds one term and takes one away. All in single precision:
    the sums err by a few millionths, the frequencies by less than a thousandth of a bin.
    """
    records, samples = re.shape
    n = wave_re.shape[0]
    sum_re, sum_im, height = wave_re[0].copy(), wave_im[0].copy(), wave_re[0].copy()
    # Numbers that are not negative have the order of their bits, and integers compare faster.
    bits = height.view(np.int32)
    for w in range(len(windows)):
        length = windows[w]
        for r in range(records):
            sum_re[:] = 0
            sum_im[:] = 0
            peak = 0
            for m in range(samples):
                _add(sum_re, sum_im, re[r, m], im[r, m], wave_re[m % n], wave_im[m % n])
                if m >= length:
                    old = m - length
                    c, s = wave_re[old % n], wave_im[old % n]
                    _add(sum_re, sum_im, -re[r, old], -im[r, old], c, s)
                if m < first:
                    continue
                for k in range(n):
                    height[k] = sum_re[k] * sum_re[k] + sum_im[k] * sum_im[k]
                top = bits[0]
                for k in range(n):
                    top = max(top, bits[k])
                peak = peak - 4 if peak > 3 else 0  # it is seldom far from the last one
                while bits[peak] < top:
                    peak = peak + 1 if peak < n - 1 else 0
                # The parabola through the magnitudes of three neighbors, in double precision.
                left = np.float64(height[peak - 1 if peak > 0 else n - 1]) ** 0.5
                middle = np.float64(height[peak]) ** 0.5
                right = np.float64(height[peak + 1 if peak < n - 1 else 0]) ** 0.5
                bend = left - 2 * middle + right
                shift = 0.5 * (left - right) / bend if bend < 0 else 0.0
                place[w, r, m - first] = peak + shift
                power[w, r, m - first] = (middle - 0.25 * (left - right) * shift) ** 2


compiled = njit(**options)(slide)
