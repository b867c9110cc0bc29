"""The interacting multiple model estimator, against Bayes' rule where it is exact."""

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import block_diag
from scipy.stats import multivariate_normal

from dopplerlib import coordinated_turn, coordinated_turn_jacobian, ekf_records, kf, ukf
from dopplerlib.estimation.imm import imm, imm_start, imm_step
from dopplerlib.estimation.imm_online import imm_online
from dopplerlib.estimation.imm_records import ImmModel
from dopplerlib.model.motion import cwna_process_noise, ncv_transition

PEERS = json.loads(Path(__file__).with_name("imm_peers.json").read_text(encoding="utf-8"))
T, K = 0.5, 8
F1 = ncv_transition(T, dim=1)
Q1, Q2 = cwna_process_noise(T, 0.01, dim=1), cwna_process_noise(T, 4.0, dim=1)
F, Q = np.stack([F1, F1]), np.stack([Q1, Q2])
H, R = np.array([[1.0, 0.0]]), np.array([[0.3]])
x0, P0 = np.array([0.0, 1.0]), np.diag([1.0, 0.5])
SWITCH = np.array([[0.9, 0.1], [0.2, 0.8]])
Z = np.random.default_rng(8).normal(scale=2, size=(3, K, 1))


def linear(F, Q, H, R):
    """Return models that differ in the motion only."""
    return [ImmModel(*motion, H, R) for motion in zip(F, Q, strict=True)]


MODELS = linear(F, Q, H, R)


def test_with_one_model_or_two_alike_it_is_the_kalman_filter():
    alone = kf(Z, F1, Q1, H, R, x0, P0)
    for M, transition in ((1, [[1.0]]), (2, SWITCH)):
        track = imm(Z, MODELS[:1] * M, transition, x0, P0)
        np.testing.assert_allclose(track.x, alone.x, rtol=1e-11, atol=1e-12)
        np.testing.assert_allclose(track.P, alone.P, rtol=1e-10, atol=1e-12)


def test_models_that_never_switch_are_weighed_by_the_likelihood_of_the_whole_record():
    prior = np.array([0.3, 0.7])
    track = imm(Z, MODELS, np.eye(2), x0, P0, prior)
    weight = np.empty((3, 2))
    means = np.empty((3, 2, 2))
    for i, noise in enumerate((Q1, Q2)):
        alone = kf(Z, F1, noise, H, R, x0, P0)
        means[:, i] = alone.x[:, -1]
        for run in range(3):
            log = sum(
                multivariate_normal(cov=S).logpdf(nu)
                for nu, S in zip(alone.innovation[run], alone.S[run], strict=True)
            )
            weight[run, i] = prior[i] * np.exp(log)
    weight /= weight.sum(axis=1, keepdims=True)
    np.testing.assert_allclose(track.mode[:, -1], weight, rtol=1e-9)
    np.testing.assert_allclose(
        track.x[:, -1], np.sum(weight[..., None] * means, axis=1), rtol=1e-9, atol=1e-10
    )


def test_the_first_step_is_the_exact_mixture():
    """All models start from one Gaussian, so that mixing loses nothing yet."""
    track = imm(Z, MODELS, SWITCH, x0, P0, [0.3, 0.7])
    prior = np.array([0.3, 0.7]) @ SWITCH
    for run in range(3):
        weight, mean, second = [], [], []
        for p, noise in zip(prior, (Q1, Q2), strict=True):
            predicted = F1 @ P0 @ F1.T + noise
            S = H @ predicted @ H.T + R
            weight.append(p * multivariate_normal(H @ F1 @ x0, S).pdf(Z[run, 0]))
            one = kf(Z[run, :1], F1, noise, H, R, x0, P0)
            mean.append(one.x[0])
            second.append(one.P[0] + np.outer(one.x[0], one.x[0]))
        weight = np.array(weight) / sum(weight)
        expected = np.tensordot(weight, mean, 1)
        np.testing.assert_allclose(track.mode[run, 0], weight, rtol=1e-10)
        np.testing.assert_allclose(track.x[run, 0], expected, rtol=1e-10, atol=1e-12)
        covariance = np.tensordot(weight, second, 1) - np.outer(expected, expected)
        np.testing.assert_allclose(track.P[run, 0], covariance, rtol=1e-9, atol=1e-12)


def test_where_nothing_is_measured_only_the_models_switch():
    holes = Z.copy()
    holes[:, 2:5] = np.nan
    track = imm(holes, MODELS, SWITCH, x0, P0)
    for k in (2, 3, 4):
        np.testing.assert_allclose(track.mode[:, k], track.mode[:, k - 1] @ SWITCH, rtol=1e-12)


def test_gaps_and_uneven_times_are_those_of_the_kalman_filter():
    steps = np.array([0.5, 1.5, 0.2, 0.5, 0.5, 3.0, 0.5, 0.5])
    moves = np.stack([ncv_transition(T, dim=1) for T in steps])
    noises = np.stack([cwna_process_noise(T, 0.3, dim=1) for T in steps])
    two, noise = np.array([[1.0, 0.0], [0.3, 1.0]]), np.diag([0.3, 0.5])
    z = np.random.default_rng(18).standard_normal((3, K, 2))
    z[0, 1, 0] = z[:, 3, 1] = z[1, 5] = np.nan
    alone = kf(z, moves, noises, two, noise, x0, P0)
    for M, transition in ((1, [[1.0]]), (2, SWITCH)):
        track = imm(z, [ImmModel(moves, noises, two, noise)] * M, transition, x0, P0)
        np.testing.assert_allclose(track.x, alone.x, rtol=1e-11, atol=1e-12)
        np.testing.assert_allclose(track.P, alone.P, rtol=1e-10, atol=1e-12)


def test_a_component_that_is_missing_speaks_for_no_model():
    """The likelihood of what is there, as in the first step of the exact mixture."""
    two, noise = np.array([[1.0, 0.0], [0.3, 1.0]]), np.array([[0.3, 0.1], [0.1, 0.5]])
    track = imm([[0.4, np.nan]], linear(F, Q, two, noise), SWITCH, x0, P0, [0.3, 0.7])
    few = imm([[0.4]], linear(F, Q, two[:1], noise[:1, :1]), SWITCH, x0, P0, [0.3, 0.7])
    np.testing.assert_allclose(track.mode, few.mode, rtol=1e-12)
    np.testing.assert_allclose(track.x, few.x, rtol=1e-12)


def test_a_model_that_cannot_be_reached_changes_nothing():
    track = imm(Z, MODELS, [[1.0, 0.0], [1.0, 0.0]], x0, P0)
    alone = kf(Z, F1, Q1, H, R, x0, P0)
    assert (track.mode[..., 1] == 0).all()
    np.testing.assert_allclose(track.x, alone.x, rtol=1e-11, atol=1e-12)
    np.testing.assert_allclose(track.P, alone.P, rtol=1e-10, atol=1e-12)


@pytest.mark.filterwarnings("error")
def test_not_even_if_it_alone_could_explain_the_data():
    """Densities of a jump of 1e4: exp(-2.5e7) in the one that is possible, about 1e-5 in the other.

    By hand: S = 1 + 1, the gain is one half.
    """
    one = np.ones((1, 1))
    models = linear([one] * 2, [0 * one, 1e8 * one], one, one)
    track = imm([[1e4]], models, np.eye(2), [0], one, [1, 0])
    assert track.mode.tolist() == [[1.0, 0.0]]
    assert (track.x.item(), track.P.item()) == (5e3, 0.5)


@pytest.mark.filterwarnings("error")
def test_not_even_if_its_state_would_grow_beyond_all_bounds():
    """What it does not measure it multiplies by 10, 400 times: more than a float can hold."""
    wild = np.stack([np.eye(2), np.diag([1.0, 10.0])])
    z = np.random.default_rng(9).normal(size=(400, 1))
    track = imm(z, linear(wild, Q, H, R), [[1.0, 0.0], [1.0, 0.0]], x0, P0)
    alone = kf(z, np.eye(2), Q1, H, R, x0, P0)
    np.testing.assert_allclose(track.x, alone.x, rtol=1e-10, atol=1e-12)


@pytest.mark.filterwarnings("error")
def test_a_model_that_seemed_impossible_comes_back_when_the_whole_record_speaks_for_it():
    """Models that never switch; 400 calm samples leave the second exp(-922), no float.

    A jump follows. The reference is the likelihood of the whole record, from one filter each.
    """
    z = np.r_[np.zeros(400), np.full(4, 50.0)][:, None]
    one = np.ones((1, 1))
    noises = [0 * one, 100 * one]
    track = imm(z, linear([one] * 2, noises, one, one), np.eye(2), [0.0], one)
    alone = [kf(z, one, noise, one, one, [0.0], one) for noise in noises]
    log = np.stack([-(a.nis + np.log(a.S[..., 0, 0])) / 2 for a in alone], axis=-1).cumsum(axis=0)
    assert log[399, 1] - log[399, 0] < -800 and log[-1, 1] > log[-1, 0] + 100
    np.testing.assert_allclose(
        track.mode, np.exp(log - np.logaddexp.reduce(log, axis=-1)[:, None]), rtol=1e-9
    )
    np.testing.assert_allclose(track.x[-1], alone[1].x[-1], rtol=1e-12)


def test_a_model_far_from_the_data_does_not_break_it():
    """Its likelihood is below the smallest float; the other's is not much above."""
    far = Z + 1e3
    track = imm(far, MODELS, SWITCH, x0, P0)
    assert np.isfinite(track.x).all() and np.isfinite(track.P).all()
    np.testing.assert_allclose(track.mode.sum(axis=-1), 1)


def sight(x):
    """Return range and azimuth from the origin."""
    return np.stack([np.hypot(x[..., 0], x[..., 1]), np.arctan2(x[..., 1], x[..., 0])], axis=-1)


def sight_jacobian(x):
    px, py = x[..., 0], x[..., 1]
    r = np.hypot(px, py)
    slope = np.zeros((*x.shape[:-1], 2, x.shape[-1]))
    slope[..., 0, 0], slope[..., 0, 1] = px / r, py / r
    slope[..., 1, 0], slope[..., 1, 1] = -py / r**2, px / r**2
    return slope


NOISE = np.diag([0.04, 1e-4])
STRAIGHT = ncv_transition(T, 2, "derivative")
WOBBLE = cwna_process_noise(T, 0.01, 2, "derivative")
TURN = block_diag(WOBBLE, 0.01)
STARTS = [np.array([10.0, 3.0, -1.0, 2.0]), np.array([10.0, 3.0, -1.0, 2.0, 0.2])]
SPREADS = [np.diag([1.0, 1.0, 0.5, 0.5]), np.diag([1.0, 1.0, 0.5, 0.5, 0.04])]


def turning(jacobians=True):
    """Return straight flight with four components, and a coordinated turn with a fifth."""
    motion = {"f": lambda x: coordinated_turn(x, T), "h": sight, "wrap": (1,)}
    meaning = {
        "to_common": lambda x: x[..., :4],
        "from_common": lambda c, x: np.concatenate([c, x[..., 4:]], axis=-1),
    }
    slopes = (lambda x: coordinated_turn_jacobian(x, T), sight_jacobian)
    F, H = slopes if jacobians else (None, None)
    straight = ImmModel(STRAIGHT, WOBBLE, H, NOISE, h=sight, wrap=(1,))
    return [straight, ImmModel(F, TURN, H, NOISE, **motion, **meaning)]


def seen(runs):
    """Return measurements of a target that flies straight and then turns."""
    x = np.array([9.5, 2.5, -1.0, 2.0, 0.0])
    path = []
    for k in range(12):
        x = coordinated_turn(np.array([*x[:4], 0.0 if k < 6 else 0.8]), T)
        path.append(sight(x))
    noise = np.random.default_rng(5).standard_normal((runs, 12, 2)) * np.sqrt(np.diag(NOISE))
    return np.array(path) + noise


def written_out(z, switch):
    """Return x, P and the probabilities of `turning` on one record, step by step (Sec 11.6.6)."""
    x, P, mode = list(STARTS), list(SPREADS), np.full(2, 0.5)
    for measured in z:
        predicted = mode @ switch
        mixed = []
        for j in range(2):
            weight = mode * switch[:, j] / predicted[j]
            if j == 0:
                parts = [(x[0], P[0]), (x[1][:4], P[1][:4, :4])]
            else:
                parts = [(np.append(x[0], x[1][4]), block_diag(P[0], P[1][4, 4])), (x[1], P[1])]
            mean = sum(w * a for w, (a, _) in zip(weight, parts, strict=True))
            spread = sum(
                w * (A + np.outer(a - mean, a - mean))
                for w, (a, A) in zip(weight, parts, strict=True)
            )
            mixed.append((mean, spread))
        likelihood = np.empty(2)
        for j, (a, A) in enumerate(mixed):
            F = coordinated_turn_jacobian(a, T) if j else STRAIGHT
            a = coordinated_turn(a, T) if j else STRAIGHT @ a
            A = F @ A @ F.T + (TURN if j else WOBBLE)
            J = sight_jacobian(a)
            S = J @ A @ J.T + NOISE
            gain = A @ J.T @ np.linalg.inv(S)
            off = measured - sight(a)
            x[j], P[j] = a + gain @ off, A - gain @ J @ A
            likelihood[j] = multivariate_normal(cov=S).pdf(off)
        mode = predicted * likelihood / (predicted @ likelihood)
        mean = mode[0] * x[0] + mode[1] * x[1][:4]
        parts = [(x[0], P[0]), (x[1][:4], P[1][:4, :4])]
        spread = sum(
            p * (A + np.outer(a - mean, a - mean)) for p, (a, A) in zip(mode, parts, strict=True)
        )
        yield mean, spread, mode


def test_straight_flight_and_a_coordinated_turn_are_the_estimator_written_out():
    z = seen(3)
    track = imm(z, turning(), SWITCH, STARTS, SPREADS)
    for run in range(3):
        for k, (x, P, mode) in enumerate(written_out(z[run], SWITCH)):
            np.testing.assert_allclose(track.x[run, k], x, rtol=1e-9, atol=1e-9)
            np.testing.assert_allclose(track.P[run, k], P, rtol=1e-8, atol=1e-9)
            np.testing.assert_allclose(track.mode[run, k], mode, rtol=1e-8, atol=1e-12)
    assert (track.mode[:, 4, 1] < 0.5).all() and (track.mode[:, -1, 1] > 0.9).all()


def test_sigma_points_take_the_place_of_jacobians():
    """They see curvature that Jacobians miss: close, and the same where everything is linear."""
    z = seen(3)
    slopes, points = (imm(z, turning(j), SWITCH, STARTS, SPREADS) for j in (True, False))
    assert 0 < np.abs(slopes.x - points.x).max() < 0.3
    functions = [
        ImmModel(None, noise, None, R, f=lambda x: x @ F1.T, h=lambda x: x @ H.T)
        for noise in (Q1, Q2)
    ]
    track, same = (imm(Z, models, SWITCH, x0, P0) for models in (MODELS, functions))
    np.testing.assert_allclose(same.x, track.x, rtol=1e-10, atol=1e-11)
    np.testing.assert_allclose(same.mode, track.mode, rtol=1e-9)


def test_with_one_nonlinear_model_it_is_the_filter_of_that_model():
    z = seen(2)
    common = {"f": lambda x: x @ STRAIGHT.T, "h": sight, "wrap": (1,)}
    slope = {"F": lambda x: STRAIGHT, "H": sight_jacobian}
    given = {"Q": WOBBLE, "R": NOISE, **common}
    start = STARTS[0], SPREADS[0]
    for alone, model in (
        (ekf_records(z, **given, **slope, x0=start[0], P0=start[1]), ImmModel(**given, **slope)),
        (ukf(z, **given, x0=start[0], P0=start[1]), ImmModel(F=None, H=None, **given)),
    ):
        track = imm(z, [model], [[1.0]], *start)
        np.testing.assert_allclose(track.x, alone.x, rtol=1e-11)
        np.testing.assert_allclose(track.P, alone.P, rtol=1e-9, atol=1e-12)


def test_the_meaning_of_a_state_changes_nothing_but_its_words():
    """The second model in other units, turned and with its components exchanged."""
    A = np.array([[0.0, 3.0], [-0.5, 1.0]])
    back = np.linalg.inv(A)
    other = ImmModel(
        A @ F1 @ back, A @ Q2 @ A.T, H @ back, R,
        to_common=lambda x: x @ back.T, from_common=lambda c, x: c @ A.T,
    )  # fmt: skip
    starts = [x0, A @ x0], [P0, A @ P0 @ A.T]
    track, same = imm(Z, MODELS, SWITCH, x0, P0), imm(Z, [MODELS[0], other], SWITCH, *starts)
    np.testing.assert_allclose(same.x, track.x, rtol=1e-9, atol=1e-10)
    np.testing.assert_allclose(same.P, track.P, rtol=1e-8, atol=1e-10)
    np.testing.assert_allclose(same.mode, track.mode, rtol=1e-8)
    np.testing.assert_allclose(same.last.model_x[1], track.last.model_x[1] @ A.T, rtol=1e-8)


@pytest.mark.parametrize(
    ("z", "models", "start"),
    [(Z, MODELS, (x0, P0)), (seen(3), turning(), (STARTS, SPREADS))],
    ids=["linear", "turning"],
)
def test_one_sample_at_a_time_gives_the_same_bits(z, models, start):
    track = imm(z, models, SWITCH, *start)
    first = [np.repeat(np.asarray(x)[None], 3, axis=0) for x in start[0]]
    state = imm_start(models, first if len(first[0].shape) > 1 else np.stack([x0] * 3), start[1])
    for k in range(z.shape[1]):
        state = imm_step(z[:, k], state, models, SWITCH)
        for name in ("x", "P", "mode"):
            np.testing.assert_array_equal(getattr(state, name), getattr(track, name)[:, k])
    assert state == track.last
    whole = imm_step(z[:, -1], imm(z[:, :-1], models, SWITCH, *start).last, models, SWITCH)
    assert whole == track.last


@pytest.mark.parametrize(
    ("z", "models", "start"),
    [(Z, MODELS, (x0, P0)), (seen(3), turning(), (STARTS, SPREADS))],
    ids=["linear", "turning"],
)
def test_a_prepared_estimator_gives_the_same_bits(z, models, start):
    z = z[0].copy()
    z[4, 0], z[7] = np.nan, np.nan
    track = imm(z, models, SWITCH, *start)
    update = imm_online(models, SWITCH, *start)
    with pytest.raises(ValueError, match=r"^z must .*got"):
        update(z)  # changes nothing
    for k, sample in enumerate(z):
        state = update(sample)
        for name in ("x", "P", "mode"):
            np.testing.assert_array_equal(getattr(state, name), getattr(track, name)[k])
    assert state == track.last


def test_runs_together_are_the_runs_alone():
    """To rounding: NumPy's sines and exponentials of many numbers may have other last bits."""
    z, models = seen(3), turning()
    track = imm(z, models, SWITCH, STARTS, SPREADS)
    for run in range(3):
        alone = imm(z[run], models, SWITCH, STARTS, SPREADS)
        np.testing.assert_allclose(track.x[run], alone.x, rtol=1e-11, atol=1e-12)
        np.testing.assert_allclose(track.mode[run], alone.mode, rtol=1e-11)


@pytest.mark.parametrize("kind", PEERS["tracks"])
def test_it_is_the_estimator_of_filterpy(kind):
    """Stored by `python benchmarks/imm_peers.py`."""
    stored, setting = PEERS["tracks"][kind], PEERS["setting"]
    F, Q, H, R = (np.array(setting[name]) for name in "FQHR")
    models = linear(F, Q, H, R)
    if kind == "points":
        models = [
            ImmModel(None, noise, None, R, f=lambda x, F=one: x @ F.T, h=sight)
            for one, noise in zip(F, Q, strict=True)
        ]
    track = imm(
        stored["z"], models, *(np.array(setting[v]) for v in ("switch", "x0", "P0", "mode0"))
    )
    for name in ("x", "mode"):
        np.testing.assert_allclose(getattr(track, name), stored[name], rtol=1e-8, atol=1e-10)
    np.testing.assert_allclose(track.P[-1], stored["P"], rtol=1e-8, atol=1e-10)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("transition", np.ones((2, 2))),
        ("transition", np.eye(3)),
        ("mode0", [0.5, 0.6]),
        ("mode0", [1.5, -0.5]),
        ("z", np.empty((3, 0, 1))),
        ("models", []),
        ("models", [F1]),
        ("models", [MODELS[0], ImmModel([[1.0]], [[1.0]], [[1.0]], [[1.0]])]),
        ("models", [MODELS[0], ImmModel(F1, Q1, np.eye(2), np.eye(2))]),
        (r"models\[1\].F", [MODELS[0], ImmModel([F1] * 3, Q1, H, R)]),
        (r"models\[1\].f", [MODELS[0], ImmModel(None, Q1, H, R, f=[abs])]),
        (r"models\[1\].h\(x\)", [MODELS[0], ImmModel(F1, Q1, None, R, h=lambda x: x)]),
        ("x0", np.zeros(3)),
        ("P0", -np.eye(2)),
    ],
)
def test_bad_input_is_named(name, value):
    arguments = {"z": Z, "models": MODELS, "transition": SWITCH, "x0": x0, "P0": P0}
    with pytest.raises(ValueError, match=rf"^{name} must "):
        imm(**(arguments | {name.partition("\\")[0]: value}))


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("F", None),
        ("F", np.ones((2, 3))),
        ("F", np.ones((1, 1, 2, 2))),
        ("Q", -np.eye(2)),
        ("H", np.eye(3)),
        ("R", np.zeros((1, 1))),
        ("f", 3),
        ("h", [sight, 4]),
        ("wrap", [1]),
        ("from_common", 5),
    ],
)
def test_a_bad_model_is_refused_when_it_is_made(name, value):
    with pytest.raises(ValueError, match=rf"^{name} must "):
        ImmModel(**({"F": F1, "Q": Q1, "H": H, "R": R, "to_common": abs} | {name: value}))


def test_a_model_with_a_meaning_of_its_own_starts_from_a_state_of_its_own():
    z, models = seen(1), turning()
    with pytest.raises(ValueError, match=r"^x0 must have one entry for each model, got 1"):
        imm(z, models, SWITCH, STARTS[:1], SPREADS)
    with pytest.raises(ValueError, match=r"^state.model_x must have shape"):
        imm_step(z[:, 0], imm(Z, MODELS, SWITCH, x0, P0).last, models, SWITCH)
