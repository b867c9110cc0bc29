"""Peaks of zero-padded transforms of windows that slide by one sample, compiled."""

import numpy as np

from ..._compile import cached_njit, inner_njit

_inner = inner_njit(fastmath=True)


@_inner
def _sums(re, im, c, s, old_re, old_im, new_re, new_im):
    """Add one sample to the sums; in two loops, for with more arrays the compiler gives up."""
    for k in range(len(c)):
        new_re[k] = old_re[k] + (re * c[k] - im * s[k])
    for k in range(len(c)):
        new_im[k] = old_im[k] + (re * s[k] + im * c[k])


@_inner
def _heights(new_re, new_im, old_re, old_im, height):
    for k in range(len(height)):
        a, b = new_re[k] - old_re[k], new_im[k] - old_im[k]
        height[k] = a * a + b * b


def slide(re, im, loud, wave_re, wave_im, windows, first, place, power):
    """Write `place` (R, W, K) in bins and `power` of the highest bin of each window.

    `re`, `im` (R, samples) hold records, `wave_re`, `wave_im` (N, N) the powers of the N-th root
    of unity: row m, column k is exp(-2 pi j m k / N). The window of sample n ends with it; the
    first has n = `first`. The phase of a transform is counted from sample 0 and not from the
    start of the window, so that it is the difference of two sums from there. All in single
    precision: frequencies err by about a hundredth of a bin. Where `loud` (R, samples) is True, the
    sums begin anew, as they would keep the rounding; windows with such a sample get NaN.

    With S_m(k) the sum of x_j exp(-2 pi i j k / N) over j = 0 ... m, the transform of the window of
    W samples that ends with m is S_m - S_(m - W): of the order of N operations a sample and N a
    window, where a transform of its own takes N log N. Only the sums of as many samples as the
    longest window has are kept, in a ring: sample m overwrites the row m % ring.
    """
    records, samples = re.shape
    n = wave_re.shape[0]
    ring = np.max(windows) + 1
    sum_re = np.zeros((ring, n), np.float32)
    sum_im = np.zeros((ring, n), np.float32)
    height = np.zeros(n, np.float32)
    # Numbers that are not negative have the order of their bits, and integers compare faster.
    bits = height.view(np.int32)
    peaks = np.zeros(len(windows), np.int64)
    for r in range(records):
        sum_re[ring - 1] = 0
        sum_im[ring - 1] = 0
        last = -1  # the sums were begun anew here: none from before may be subtracted
        for m in range(samples):
            new, old = m % ring, (m - 1) % ring
            row = m % n
            if loud[r, m]:
                sum_re[new] = 0
                sum_im[new] = 0
                last = m
            else:
                _sums(
                    re[r, m], im[r, m], wave_re[row], wave_im[row],
                    sum_re[old], sum_im[old], sum_re[new], sum_im[new],
                )  # fmt: skip
            if m < first:
                continue
            for w in range(len(windows)):
                if m - windows[w] < last:
                    place[r, w, m - first], power[r, w, m - first] = np.nan, 0.0
                    continue
                old = (m - windows[w]) % ring
                _heights(sum_re[new], sum_im[new], sum_re[old], sum_im[old], height)
                top = bits[0]
                for k in range(n):
                    top = max(top, bits[k])
                peak = max(peaks[w] - 4, 0)  # it is seldom far from the last one
                while bits[peak] < top:
                    peak = peak + 1 if peak < n - 1 else 0
                peaks[w] = peak
                # The parabola through the magnitudes l, m, r of three neighbors, in double
                # precision: its vertex lies at d = (l - r) / (2 (l - 2 m + r)), and its height
                # there is m - (l - r) d / 4.
                left = np.float64(height[peak - 1 if peak > 0 else n - 1]) ** 0.5
                middle = np.float64(height[peak]) ** 0.5
                right = np.float64(height[peak + 1 if peak < n - 1 else 0]) ** 0.5
                bend = left - 2 * middle + right
                shift = 0.5 * (left - right) / bend if bend < 0 else 0.0
                place[r, w, m - first] = peak + shift
                power[r, w, m - first] = (middle - 0.25 * (left - right) * shift) ** 2


compiled = cached_njit(slide, fastmath=True)
