"""Numbers on the start of Table 2 that are judged, by another route."""

import numpy as np
import pytest
from scipy.optimize import least_squares, minimize

from dopplerlib import doppler_shift, simulate
from dopplerlib.systems import mittermaier2016 as paper
from dopplerlib.systems.mittermaier2016.evidence import _start as evidence
from tests.sweeps import narrowed

S = paper.reported().scenario
BOTH = ("stationary", "constant_velocity")
ALL = {
    "likelihood": BOTH,
    "start": ("Table 2", "as drawn"),
    "accuracy": (0.3, 0.45),
    "ring_room": (1.5, 3.0),
}


@pytest.fixture(scope="module")
def both():
    """Return the evidence, and the starts from which it was taken, by the first of two seeds."""
    starts, make = {}, evidence.table2_starts

    def kept(runs, *, rng, likelihood, box):
        starts[likelihood, float(box[1][0])] = make(runs, rng=rng, likelihood=likelihood, box=box)
        return starts[likelihood, float(box[1][0])]

    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(evidence, "table2_starts", kept)
        choice = narrowed("mittermaier2016", **ALL)
        return evidence.start_evidence(choice, np.random.default_rng(6)), starts


@pytest.fixture(scope="module")
def found(both):
    return both[0]


def shifts(x, samples):
    """Return the shifts (..., samples, 6) of targets at x (..., 6) that go straight on."""
    path = np.repeat(np.asarray(x)[..., None, :], samples, axis=-2)
    path[..., :3] += S.T * np.arange(samples)[:, None] * path[..., 3:]
    return doppler_shift(path, S.array)


def slopes(x, samples, step=1e-5):
    """Return the slopes of all shifts (6 samples, 6), by differences."""
    there, back = (shifts(x + sign * step * np.eye(6), samples) for sign in (1, -1))
    return (there - back).reshape(6, -1).T / (2 * step)


def bound(samples):
    """Return the root mean square position error at the bound, by differences of the shifts."""
    _, r = np.linalg.qr(slopes(S.x0, samples))
    return S.sigma_f * np.linalg.norm(np.linalg.inv(r)[:3])


def test_ten_samples_leave_a_meter(found):
    assert found["poor-observability"] == pytest.approx(bound(10), rel=1e-4)


def test_accurate_positions_take_many_samples(found):
    for error in ALL["accuracy"]:
        samples = int(found["many-measurements"].points[error,])
        assert bound(samples) <= error < bound(samples - 1)
        h = shifts(S.x0, samples)
        moved = [abs(sum(column) / samples - column[0]) for column in h.T.tolist()]
        moves = found["integration-long"].points[error,]
        assert moves == pytest.approx(max(moved) * samples**0.5 / 0.4, rel=1e-9)


def test_a_room_excludes_the_mirror_and_not_the_twin(found):
    """The twin has nearly the same shifts as the truth, and stands before the sensors."""
    x, d = S.x0, [-1, 1, 1, -1, 1, 1]
    np.testing.assert_allclose(doppler_shift(x * d, S.array), doppler_shift(x, S.array))
    assert set(found["symmetries-reduced"].points.values()) == {1.0}
    assert evidence._excluded(0.2) == 2  # a room before the target excludes both


def test_a_mean_shift_moves_by_its_slope(found):
    """The middle of ten samples is 4.5 intervals behind the first; slopes by differences."""

    def moves(x, scene):
        x = np.asarray(x)
        later, sooner = (x + s * 1e-4 * np.r_[x[3:], 0, 0, 0] for s in (1, -1))
        h = (doppler_shift(later, scene.array) - doppler_shift(sooner, scene.array)) / 2e-4
        return 4.5 * scene.T * np.abs(h).max() / scene.sigma_f * 10**0.5

    assert found["constant-table2"] == pytest.approx(moves(S.x0, S), rel=0.01)
    p = paper.reported().figure3
    places = [(a, b) for a in p.x for b in p.y if abs(a) > 1e-9 or abs(b) > 0.21]
    typical = np.median([moves([a, b, 0, *p.velocity], p) for a, b in places])
    assert found["constant-figure3"] == pytest.approx(typical, rel=0.05)


@pytest.mark.parametrize("start", ["Table 2", "as drawn"])
def test_the_start_is_as_far_from_the_truth_as_rounding_leaves_it(found, start):
    """Both states may be off by half a millimeter in each entry; a search among those."""
    table = paper.reported()
    x = table.table2.x_ml if start == "Table 2" else table.figure6.start

    def misfit(moved):
        apart = shifts(x + moved[:6] / 2000, 10) - shifts(S.x0 + moved[6:] / 2000, 10)
        return np.sum(apart**2) / S.sigma_f**2

    least = minimize(misfit, np.zeros(12), method="L-BFGS-B", bounds=[(-1, 1)] * 12).fun
    ours = found["start-likely"].points[start, "constant_velocity"]
    assert ours == pytest.approx(np.sqrt(least) / 2, rel=0.02, abs=0.02)


def test_shares_of_starts_are_those_of_their_errors(both):
    """Shares and distances of the same estimates, counted otherwise."""
    found, starts = both
    assert {side for _, side in starts} == {1.5, 3.0}
    for (likelihood, side), some in starts.items():
        error = some.start.x - S.x0
        position, velocity = np.hypot(error[:, 0], np.hypot(error[:, 1], error[:, 2])), error[:, 3:]
        piece = found["start-position"].points[likelihood, side]
        np.testing.assert_allclose(piece.values, position)
        speed = np.sqrt((velocity**2).sum(axis=1))
        np.testing.assert_allclose(found["start-velocity"].points[likelihood, side].values, speed)
        near = found["start-reliable"].points[likelihood, side, 0.3].value
        assert near == pytest.approx(np.mean(position < 0.3))
        apart = np.sqrt(((some.start.second_x - some.start.x)[:, :3] ** 2).sum(axis=1))
        second = found["start-not-convex"].points[likelihood, side, 0.3].value
        assert second == pytest.approx(np.mean(apart > 0.3))


def test_estimates_are_those_of_descents_from_random_states():
    """In a room of 3 m, for six records; a twentieth in likelihood is lost at the most."""
    rng = np.random.default_rng(8)
    low, high = evidence._room(3.0)
    assert high[:3].tolist() == [3.0, 1.5, 1.5] and low[1:3].tolist() == [-1.5, -1.5]
    starts = paper.table2_starts(6, rng=np.random.default_rng(9), box=(low, high)).start
    _, z = simulate(S, 6, rng=np.random.default_rng(9))
    for record, ours in zip(z[:, :10], starts.cost, strict=True):
        costs = []
        for x in [S.x0, *rng.uniform(low, high, (11, 6))]:
            fit = least_squares(
                lambda x, record=record: ((shifts(x, 10) - record) / S.sigma_f).ravel(),
                x,
                jac=lambda x: slopes(x, 10) / S.sigma_f,
                bounds=(low, high),
                x_scale=[1, 1, 1, 0.1, 0.1, 0.1],
                max_nfev=60,
            )
            costs.append(2 * fit.cost)
        assert ours < min(costs) + 0.1
