"""When the innovations alone raise an alarm: three tests, taken again and again as data come in."""

import numpy as np

from .. import _checks
from .whiteness import innovation_whiteness


def innovation_alarms(track, looks, probability=0.001, lags=5):
    """Test after some numbers of samples whether the innovations are those of a right filter.

    None of the tests needs the truth.

    Parameters
    ----------
    track : Track
        With `innovation` and `S`; leading axis ``runs``.
    looks : sequence of int
        Numbers of samples after which each test is taken, each time on all samples so far.
    probability : float
        Of a false alarm at any of the looks, at most, for each test.
    lags : int
        Of the test of whiteness, which is not taken after fewer than ten samples per lag.

    Returns
    -------
    dict of str to ndarray of bool, shape (runs, looks)
        By the name of the test, whether it rejects at each look.

    Raises
    ------
    ValueError
        If a look is not a number of samples in the record, or another argument is refused.

    Notes
    -----
    "NIS average" is chi-square, and raises an alarm when it is too large: errors larger than the
    filter believes are what is dangerous. The "innovation mean" is taken over the innovations
    divided by their Cholesky factor, and its square is chi-square. "whiteness" is that of
    `innovation_whiteness`. Each look spends an equal part of `probability` (Bonferroni), so that
    looking often does not raise more false alarms.

    Bar-Shalom, Li and Kirubarajan (2001), Section 5.4.
    """
    from scipy.stats import chi2  # here: it takes longer to load than all the rest

    innovation = _checks.finite("track.innovation", track.innovation, (None, None))
    samples, m = innovation.shape[-2:]
    looks = [_checks.whole_number("looks", look) for look in looks]
    if max(looks) > samples:
        raise ValueError(f"looks must be at most the {samples} samples, got {max(looks)}")
    threshold = _checks.probability("probability", probability) / len(looks)
    innovation, S = innovation[:, : max(looks)], track.S[:, : max(looks)]
    white = np.linalg.solve(np.linalg.cholesky(S), innovation[..., None])[..., 0]
    p = {name: [] for name in ("NIS average", "innovation mean", "whiteness")}
    for n in looks:
        total = np.sum(white[:, :n] ** 2, axis=(-2, -1))
        p["NIS average"].append(chi2.sf(total, n * m))
        mean = white[:, :n].mean(axis=-2)
        p["innovation mean"].append(chi2.sf(n * np.sum(mean**2, axis=-1), m))
        enough = n >= 10 * lags
        p["whiteness"].append(
            innovation_whiteness(innovation[:, :n], S[:, :n], lags).p_value
            if enough
            else np.ones(len(white))
        )
    return {name: np.stack(values, axis=-1) < threshold for name, values in p.items()}


def first_alarm(alarms, looks):
    """Return after how many samples each run raises its first alarm.

    Parameters
    ----------
    alarms : array_like of bool, shape (runs, looks)
        Of one test, see `innovation_alarms`.
    looks : sequence of int
        Numbers of samples, ascending.

    Returns
    -------
    ndarray, shape (runs,)
        Infinite where there is none.
    """
    alarms = np.asarray(alarms, bool)
    return np.where(alarms.any(axis=-1), np.asarray(looks, float)[alarms.argmax(axis=-1)], np.inf)
