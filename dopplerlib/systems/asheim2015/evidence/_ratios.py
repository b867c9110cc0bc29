"""Better or worse: errors of one filter over those of another on the same runs."""

import numpy as np

from ....evaluation.bootstrap import bootstrap_interval
from ....evaluation.intervals import quantile_interval
from ....replication.documents import read_document


def choices(*names):
    """Return choices of the thesis by their names."""
    return read_document("asheim2015").choice(*names)


def ends(name):
    """Return both numbers of a window such as "0 to 10 s"."""
    low, _, high, _ = name.split()
    return float(low), float(high)


def within(values, name):
    """Return where values lie in a window such as "0 to 10 s"."""
    low, high = ends(name)
    return (values >= low - 1e-9) & (values <= high + 1e-9)


def ratio(a, b, metric, rng):
    """Return the error of one filter over that of another, with its interval.

    a, b (runs, K): Errors of both on the same runs, of which one may have more; NaN where there is
        none.
    metric: The ratio of their root mean squares; or the median over runs of the ratio in each run,
        which is below 1 if `a` is better in more than half of them.
    rng: Source of the bootstrap.
    """
    both = min(len(a), len(b))
    a, b = a[:both], b[:both]
    some = np.isfinite(a).any(axis=1) & np.isfinite(b).any(axis=1)
    sums = [part for e in (a[some], b[some])
            for part in (np.nansum(e**2, axis=1), np.isfinite(e).sum(axis=1))]  # fmt: skip
    if metric == "most runs":
        return quantile_interval(_of_means(*sums))
    return bootstrap_interval(_of_means, sums, rng=rng)


def _of_means(sa, na, sb, nb):
    return np.sqrt(sa / na / (sb / nb))
