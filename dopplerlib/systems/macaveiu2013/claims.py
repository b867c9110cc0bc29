"""Our numbers for the claims of the document."""

import numpy as np

from ...evaluation.intervals import mean_interval, quantile_interval, share_interval
from ...evaluation.verdicts import Readings
from ...model.polar_radar import polar_radar_jacobian
from . import chain, crossing, lag, regions, tracking, two_tones, waveforms
from .published import DATA, KMH, paths, settings

CLAIMS = DATA / "claims.toml"
RUNS = 200
MOST = 0.9  # share of the runs in which a claim on the largest error of a run has to hold
NOISES = (0.25, 0.5, 2.0)  # m: readings of a noise that is called large and not stated


def evidence(*, rng):
    """Return our number for every claim of ``claims.toml``.

    Parameters
    ----------
    rng : numpy.random.Generator
        Source of all randomness.

    Returns
    -------
    dict
        As `judge_all` takes it.
    """
    signals, positions, others = rng.spawn(3)
    return _waveforms(signals) | _positions(positions) | _others(others)


def _waveforms(rng):
    s = settings()
    targets = np.array([[30.0, -5.0], [40.0, 4.0]])
    relations = np.stack([waveforms.chirp_relation(a * s.bandwidth / s.T) for a in (1, -1)])
    pairs, _ = waveforms.intersections(relations, [targets @ row for row in relations])
    A = two_tones.mfsk_relations()
    shared = np.array([targets[0], [44.0, (A[0] @ targets[0] - A[0, 0] * 44.0) / A[0, 1]]])

    def mfsk_off(case, count):
        pair = [waveforms.noisy(one, 20, rng=rng) for one in two_tones.mfsk(case)]
        return np.abs(two_tones.mfsk_solve(*pair, count)[0, 0] - case[:, 0]).min()

    def fsk_off(v):
        r, _ = two_tones.fsk_range(*two_tones.fsk([[30.0, v], [55.0, v]]))
        return float(np.abs(r - [30, 55]).min())

    signal = waveforms.noisy(waveforms.rapid_chirps([[60.0, -60.0]]), 0, rng=rng)
    _, folded = waveforms.strongest(*waveforms.range_doppler_map(signal))
    return {
        "pulse-rate": s.bandwidth / (256 * 512 / s.T),
        "lfm-ghosts": float(len(pairs) - len(targets)),
        "fsk-resolution": fsk_off(-5.0),
        "fsk-at-rest": fsk_off(0.0),
        "mfsk-solves": Readings(
            {
                "beats differ": quantile_interval([mfsk_off(targets, 2) for _ in range(RUNS)]),
                "a beat shared": quantile_interval([mfsk_off(shared, 1) for _ in range(RUNS)]),
            }
        ),
        "rapid-unambiguous": folded,
    }


def _positions(rng):
    s = settings()
    children = iter(rng.spawn(len(NOISES) + 2))
    scores = {
        f"noise of {p:g} m": regions.scores(RUNS, rng=next(children), s=s.with_(sigma_p=p))
        for p in NOISES
    }
    agile = regions.scores(RUNS, rng=next(children), s=s.with_(w=0.1))
    calm = regions.scores(RUNS, rng=next(children), s=s)
    seven = {name: quantile_interval(one.settled[0], MOST) for name, one in scores.items()}
    whole = calm.whole.max(axis=0)
    every = {name: quantile_interval(one.settled.max(axis=0), MOST) for name, one in scores.items()}
    return {
        "fig7-error": Readings(seven),
        "all-below-resolution": Readings(
            every | {"with the first second": quantile_interval(whole, MOST)}
        ),
        "varying-speed": Readings(
            {
                f"w = {s.w:g} m/s": share_interval(calm.speed_worse_when_it_varies()),
                "w = 0.1 m/s": share_interval(agile.speed_worse_when_it_varies()),
            }
        ),
    }


def _others(rng):
    s, five = settings(), paths()
    a = 10 * KMH / (s.samples * s.T)
    smoother = s.with_(w=s.w / np.sqrt(10))  # the gains of a tenfold E_z
    best = s.with_(w=lag.best_w(a))
    children = iter(rng.spawn(8))

    def speed(one):
        error = tracking.errors([five[10]], RUNS, rng=next(children), s=one)[0, :, s.skip :, 1]
        return np.sqrt(np.mean(error**2, axis=1))

    def wrong(angle, rule, which):
        truth = crossing.paths(angle)
        out = crossing.follow(truth, rule, RUNS, rng=next(children), velocity=which == "lost")
        return getattr(out, which).astype(float)

    lost = wrong(0.2, "Hungarian", "lost") - wrong(0.2, "each its nearest", "lost")
    swapped = wrong(0.5, "Hungarian", "swapped") - wrong(0.5, "greedy", "swapped")
    half_period = 1.5 * KMH * (s.samples * s.T) / np.pi / 1.5  # one and a half periods in 19 s
    return {
        "duration": s.samples * s.T,
        "fig7-lateral": float(np.abs(tracking.filtered(five[7].truth)[:, 1]).max()),
        "lane": Readings(
            {
                "one period": round(float(five[11].truth[-1, 2] - five[11].truth[0, 2]), 3),
                "one and a half periods": half_period,
            }
        ),
        "large-Ez-smooths": float(lag.noise_deviation(smoother)[1] / lag.noise_deviation(s)[1]),
        "large-Ez-lags": float(lag.lag(a, smoother)[1] / lag.lag(a, s)[1]),
        "improvable": mean_interval(speed(best) / speed(s)),
        "speed-less-accurate": (s.wavelength / (2 * s.T)) / s.range_resolution,
        "all-measured": float(np.linalg.matrix_rank(polar_radar_jacobian(five[9].truth[0]))),
        "slow-is-clutter": float(chain.hidden(five[8].truth).sum()),
        "hungarian": Readings(
            {
                "tracks on one target, against each its nearest": mean_interval(lost),
                "tracks swapped, against greedy": mean_interval(swapped),
            }
        ),
    }
