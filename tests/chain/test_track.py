"""From a file to a track on an array of one's own: no setting of a document is in it.

Seeds were written down once and are not chosen.
"""

import re
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.signal import hilbert
from scipy.stats import chi2

from dopplerlib import RadarArray, iq_from_geometry, nis
from dopplerlib.chain.baseband import Baseband
from dopplerlib.chain.track import track_iq
from dopplerlib.estimation.initial_estimate import ImplausibleStart
from dopplerlib.signal.frequency import ml_frequency
from dopplerlib.signal.impairments import add_dc, add_iq_imbalance
from dopplerlib.signal.real_tone import ml_frequency_real
from dopplerlib.signal.recording import Recording, write_sigmf
from dopplerlib.signal.synthesis import complex_noise

README = Path(__file__).parents[2] / "README.md"
# A room of 6 m by 5 m, five modules of 10.525 GHz on one wall, a target at a height of 1.2 m.
PLACES = np.array([[0, 0.5, 1.0], [0, 1.5, 2.0], [0, 2.5, 1.0], [0, 3.5, 2.0], [0, 4.5, 1.0]])
BOX = [0, 0, 1.2], [6, 5, 1.2]
CARRIER, FS, LENGTH, RUNS = 10.525e9, 4000.0, 2.0, 20
SETTINGS = {"speed_limit": 2.5, "velocity_random_walk": 0.05, "window": 0.05, "start": 0.5}


def recorded(run):
    """Return a recording of cheap modules and the states at all samples."""
    rng = np.random.default_rng([101, run])
    t = np.arange(round(LENGTH * FS)) / FS
    start = [4.8, 1.5, 1.2] + rng.uniform(-0.5, 0.5, 3) * [1, 1, 0]
    velocity = [-1.4, 0.4, 0] + rng.uniform(-0.3, 0.3, 3) * [1, 1, 0]
    path = start + t[:, None] * velocity
    array = RadarArray(PLACES, 299_792_458 / CARRIER)
    x = iq_from_geometry(path, array, 24.0, rng=rng)
    x = 0.3 * add_iq_imbalance(add_dc(x, 0.5 + 0.3j), 1.0, 5.0)
    return Recording(x, FS, CARRIER), np.hstack([path, np.broadcast_to(velocity, path.shape)])


def tracked(meta):
    """Return samples and track by the lines of the README."""
    text = README.read_text(encoding="utf-8")
    (lines,) = re.findall(r"```python\n(.*?track_iq\(.*?)```", text, flags=re.DOTALL)
    names = {}
    exec(lines.replace("room.sigmf-meta", meta.as_posix()), names)
    return names["iq"], names["found"]


@pytest.fixture(scope="module")
def room(tmp_path_factory):
    """Return samples, tracks and true paths of all runs, each from a file."""
    folder = tmp_path_factory.mktemp("room")
    found = []
    for run in range(RUNS):
        recording, truth = recorded(run)
        found.append((*tracked(write_sigmf(folder / f"{run}", recording, "int16")), truth))
    return found


def test_a_target_in_a_room_is_known_to_millimeters_from_a_file(room):
    """The rms error of the last moment is 2.3 mm in 20 runs; with 95 % it is 1.9 to 2.9 mm.

    Two directions of normal errors: the square is off by 40 / chi2.ppf(q, 40). With the q of a
    chance of 1e-6, it is less than half a centimeter.
    """
    end = (round(LENGTH * FS) - 1) / FS
    error = [f.at(end)[0][:3] - truth[-1, :3] for _, f, truth in room]
    square = np.mean(np.sum(np.square(error), axis=1))
    assert np.sqrt(square * 2 * RUNS / chi2.ppf(1e-6, 2 * RUNS)) < 5e-3


def test_and_its_nis_is_near_the_five_that_five_shifts_have(room):
    """The mean of 20 runs of 30 samples is within 2.5 % of its law, 30 % below 5 at most.

    It is below since a chirp is noise to the fit of a tone, so that deviations are too wide.
    """
    nis = [f.final_nis.mean() for _, f, _ in room]
    assert 3.5 < np.mean(nis) < 5.2
    assert all(f.plausible for _, f, _ in room)


def test_errors_have_the_stated_covariance(room):
    """Normalized errors of four free components: chi-square, false alarm 1e-6 each way.

    Upwards a half more, for the curvature in windows.
    """
    total = 0.0
    for iq, f, truth in room:
        moment = iq.first + (iq.x.shape[-1] - 1) / iq.fs
        x, P, _ = f.at(moment)
        error = (x - truth[round(moment * FS)])[[0, 1, 3, 4]]
        total += error @ np.linalg.solve(P[np.ix_([0, 1, 3, 4], [0, 1, 3, 4])], error)
    low, high = chi2.ppf([1e-6, 1 - 1e-6], 4 * RUNS)
    assert low < total < 1.5 * high


def test_the_track_of_the_likeliest_hypothesis_is_that_of_the_filter(room):
    """Its innovations give its NIS, and its states are those that `at` returns."""
    _, f, _ = room[0]
    track = f.final_track
    assert_allclose(nis(track.innovation, track.S), f.final_nis, rtol=1e-9)
    for k in (0, -1):
        x = f.at(f.available_at[f.used :][k])[0]
        ahead = f.available_at[f.used :][k] - f.time[f.used :][k]
        assert_allclose(x[:3] - ahead * x[3:], track.x[k, :3], rtol=1e-9)
    assert track.updated.all() and len(track.x) == len(f.time) - f.used


def test_hum_and_a_drift_go_and_deviations_stay_right(room):
    """A third of an echo at 50 and 100 Hz, among the shifts, and a constant that doubles.

    Normalized errors as in the test above; the mean NIS, of as many shifts as there are, is within
    5 % of its law in 6 runs.
    """
    rng = np.random.default_rng(7)
    raw, cured, total = [], [], 0.0
    for run, (iq, _, truth) in enumerate(room[:6]):
        t = iq.first + np.arange(iq.x.shape[-1]) / iq.fs
        a, b = np.exp(2j * np.pi * rng.uniform(size=(2, 2, 5, 1)))
        hum = sum((a[k] * np.exp(100j * np.pi * (k + 1) * t)).real * b[k] for k in range(2))
        bad = replace(iq, x=iq.x + 0.1 * hum + 0.5 * t / LENGTH)
        if run < 2:
            raw.append(track_iq(bad, BOX, **SETTINGS).final_nis.mean())
        f = track_iq(bad, BOX, **SETTINGS, lines=[0, 50, 100])
        cured.append(f.final_nis.sum() / np.isfinite(f.shift[f.used :]).sum() * 5)
        moment = iq.first + (iq.x.shape[-1] - 1) / iq.fs
        x, P, _ = f.at(moment)
        error = (x - truth[round(moment * FS)])[[0, 1, 3, 4]]
        total += error @ np.linalg.solve(P[np.ix_([0, 1, 3, 4], [0, 1, 3, 4])], error)
    assert np.mean(raw) > 10
    assert 3.5 < np.mean(cured) < 5.4
    low, high = chi2.ppf([1e-6, 1 - 1e-6], 4 * 6)
    assert low < total < 1.5 * high


def test_live_states_are_those_at_the_times_from_which_they_are_known(room):
    _, f, _ = room[0]
    time, x, P = f.live
    for k in (0, 7, -1):
        at = f.at(time[k])
        assert_allclose(x[k], at[0], rtol=1e-9)
        assert_allclose(P[k], at[1], rtol=1e-9)


def crossing(run):
    """Return analytic signals of modules without Q on all walls, and the last state."""
    rng = np.random.default_rng([102, run])
    places = [[0, 0, 2], [6, 0, 2.2], [6, 5, 2], [0, 5, 2.2], [3, 0, 1.8]]
    array = RadarArray(places, wavelength=0.0125)
    velocity = np.array([1, 0.3, 0]) + np.append(rng.uniform(-0.3, 0.3, 2), 0)
    start = np.array([1.5, 2.5, 1]) + np.append(rng.uniform(-0.4, 0.4, 2), 0)
    path = start + np.arange(2000)[:, None] / 1e3 * velocity
    x = hilbert(iq_from_geometry(path, array, 20, rng=rng).real)
    return Baseband(x, 1e3, array, without_q=True), np.append(path[-1], velocity)


ACROSS = {
    "box": ([0, 0, 1], [6, 5, 1]),
    **SETTINGS,
    "start": 0.7,
    "estimator": ml_frequency_real,
}


def test_modules_without_q_track_a_straight_flight():
    """Signs come from the law of straight flight. Normalized errors as above, in 8 runs."""
    total = 0.0
    for run in range(8):
        iq, truth = crossing(run)
        found = track_iq(iq, **ACROSS, signs="straight")
        x, P, _ = found.at(1.999)
        error = (x - truth)[[0, 1, 3, 4]]
        total += error @ np.linalg.solve(P[np.ix_([0, 1, 3, 4], [0, 1, 3, 4])], error)
        assert found.plausible
    low, high = chi2.ppf([1e-6, 1 - 1e-6], 4 * 8)
    assert low < total < 1.5 * high


def test_signs_can_be_given_and_must_be_where_nothing_tells_them():
    iq, _ = crossing(0)
    law = track_iq(iq, **ACROSS, signs="straight")
    given = np.where(np.isnan(law.shift), 0, np.sign(law.shift)).astype(int)
    assert track_iq(iq, **ACROSS, signs=given) == law
    for signs, message in [
        (None, "signs must be given with an estimator for modules without Q, .*, got None"),
        ("any", "signs must be one of 'straight', got 'any'"),
        ([1, 1, 2, 1, 1], "signs must be 1, -1 or 0, got"),
        ([1, 1], "signs must have"),
    ]:
        with pytest.raises(ValueError, match=f"^{message}"):
            track_iq(iq, **ACROSS, signs=signs)
    usual = {**ACROSS, "estimator": ml_frequency}
    with pytest.raises(ValueError, match=r"estimator must be ml_frequency_real .* got ml_f"):
        track_iq(iq, **usual)
    with pytest.raises(ValueError, match="signs must be None, since this estimator finds them"):
        track_iq(replace(iq, without_q=False), **usual, signs="straight")


def test_leading_axes_are_those_of_the_samples(room):
    iq, one, _ = room[0]
    two = replace(iq, x=iq.x[None, None], valid=iq.valid[None, None])
    many = track_iq(two, BOX, **SETTINGS)
    for name in (
        "shift",
        "x",
        "P",
        "innovation",
        "S",
        "nis",
        "lag1_autocorrelation",
        "score",
        "degrees",
        "final_nis",
        "plausible",
    ):
        a, b = getattr(one, name), getattr(many, name)
        assert_array_equal(a, b[0, 0], err_msg=name)
    for a, b in zip(one.at(1.5), many.at(1.5), strict=True):
        assert_array_equal(a, b[0, 0])


def test_a_box_of_positions_is_that_of_all_velocities_within_the_limit(room):
    iq, one, _ = room[1]
    v = np.array([2.5, 2.5, 0])
    box = np.concatenate([BOX[0], -v]), np.concatenate([BOX[1], v])
    assert track_iq(iq, box, **SETTINGS) == one


def test_a_hop_moves_what_the_velocity_may_wander_and_not_the_belief(room):
    """With a missing target the velocity's variance grows with time, whatever the hop."""
    iq, *_ = room[0]
    k = round((1.0 - iq.first) * iq.fs)
    lost = np.arange(iq.x.shape[-1]) < k
    for hop in (0.05, 0.01):
        f = track_iq(replace(iq, valid=iq.valid & lost), BOX, hop=hop, **SETTINGS)
        best = np.argmin(f.score[:, -1])
        gone = f.used + int(np.argmax(np.isnan(f.shift[f.used :]).all(axis=-1)))
        P = f.P[best, gone - f.used :]
        grown = np.diagonal(P[-1] - P[0])[3:5]
        assert_allclose(grown, 0.05**2 * (f.time[-1] - f.time[gone - 1]), rtol=1e-6)


@pytest.mark.parametrize(
    ("places", "lower", "upper", "count"),
    [
        ([[0, -1, 0], [0, 1, 0]], [0, -2, -2], [3, 2, 2], 2),  # a line: two sides
        ([[0, -1, 0], [0, 1, 0]], [0, 0, -2], [3, 2, 2], 1),  # a box on one of them
        ([[0, -1, -1], [0, 1, 1]], [0, -2, -2], [3, 2, 2], 4),
        ([[0, -1, -1], [0, 1, 1]], [0, -2, 0], [3, 2, 0], 2),  # the height is known
        ([[0, 0, 0], [6, 5, 2]], [0, 0, 0], [6, 5, 3], 8),
    ],
)
def test_there_is_a_hypothesis_for_each_part_of_the_box(places, lower, upper, count):
    """With a single part, the second optimum of the whole is another one."""
    array = RadarArray(places)
    x = complex_noise((2, 400), 1.0, rng=np.random.default_rng(102))
    iq = Baseband(x, 1e3, array)
    f = track_iq(
        iq, (lower, upper), speed_limit=2, velocity_random_walk=0.1, window=0.05, start=0.4
    )
    assert f.x.shape[0] == (count if count > 1 else 2)


def test_noise_is_taken_for_a_target_as_often_as_the_formula_says():
    """Of 20 000 windows, 3 % at 7 and 0.7 % at 9: the counts vary by 4 % and 9 % of themselves."""
    n, fs = 40, 1000.0
    array = RadarArray([[0, -1, 0], [0, 1, 0]])
    top = 0.4 * fs / array.doppler_per_speed
    x = complex_noise((2, 10_000 * n), 1.0, rng=np.random.default_rng(103))
    iq = Baseband(x, fs, array, valid=np.ones(x.shape, bool))
    box = [0.1, 0, 0], [3, 2, 0]
    for least, tolerance in ((7.0, 0.2), (9.0, 0.4)):
        f = track_iq(
            iq, box, speed_limit=top, velocity_random_walk=1, window=n / fs, start=0.2,
            least_snr=least, remove_dc=False, balance=False, search="whole",
        )  # fmt: skip
        s = least + 1.5
        expected = 1 + 0.8 * n * np.sqrt(np.pi * s / 3)
        expected *= (1 + s / (n - 2.5)) ** (1 - n)
        assert np.mean(~np.isnan(f.shift)) == pytest.approx(expected, rel=tolerance)


@pytest.mark.parametrize("wrong", ["branches", "sensors"])
def test_what_no_flight_explains_is_warned_of(room, wrong):
    iq, *_ = room[0]
    x = iq.x.imag + 1j * iq.x.real if wrong == "branches" else iq.x[[1, 0, 2, 3, 4]]
    with pytest.warns(ImplausibleStart, match=r"of run 0: chi-square \d+ for \d+ degrees"):
        f = track_iq(replace(iq, x=x), BOX, **SETTINGS)
    assert not f.plausible


def test_what_makes_no_sense_is_refused_by_name(room):
    iq, *_ = room[0]
    for change, message in [
        ({"box": [0, 1]}, r"box must be a pair of arrays of shape \(3,\) or \(6,\), got \(\)"),
        ({"box": BOX[::-1]}, r"box must not be empty, got \[6.*\] to \[0"),
        ({"box": BOX[:1]}, r"box must be a pair \(lower, upper\), got 1 bounds"),
        ({"speed_limit": 50}, r"speed_limit must be at most 7.12\d* m/s, .*, got 50"),
        ({"velocity_random_walk": 0}, "velocity_random_walk must be positive, got 0"),
        (
            {"velocity_random_walk": 1e8},
            "velocity_random_walk must leave something of the noise .*, got 1e[+]08",
        ),
        ({"window": 3.0}, "window must be at most the 1.98 s of the record, got 3"),
        ({"hop": 1e300}, "hop must lie between .*, got 1e[+]300"),
        ({"start": 0.1}, "start must hold at least two windows, got 1 in 0.1 s"),
        ({"least_snr": -1}, "least_snr must be positive, got -1"),
        ({"search": "quarters"}, r"search must be one of .*parts.*, got 'quarters'"),
        ({"remove_dc": 1}, "remove_dc must be True or False, got 1"),
    ]:
        with pytest.raises(ValueError, match=message):
            track_iq(**{"iq": iq, "box": BOX} | SETTINGS | change)
    two = RadarArray(PLACES[:2], iq.array.wavelength)
    line = replace(iq, array=two, x=iq.x[:2], valid=iq.valid[:2])
    with pytest.raises(ValueError, match="start must hold windows side by side for 6 unknowns"):
        track_iq(line, ([0, 0, 0], [6, 5, 3]), **SETTINGS | {"start": 0.12})


def test_all_windows_make_a_better_start_whose_covariance_is_right():
    """Eight straight flights; normalized errors of four components by chi-square, 1e-6 each way.

    The docstring says a quarter of the errors, a sixteenth in squares. A ratio of 16 squares each
    is four times as large as it should be with a probability of 4e-3 if both are independent.
    """
    array = RadarArray(PLACES, 299_792_458 / CARRIER)
    square, total = dict.fromkeys(("side by side", "all"), 0.0), 0.0
    for rng in np.random.default_rng(102).spawn(8):
        x = np.r_[4.8, 1.5, 1.2, rng.uniform(-1.2, -0.6), rng.uniform(-0.3, 0.3), 0]
        path = x[:3] + np.arange(600)[:, None] / 1e3 * x[3:]
        iq = Baseband(iq_from_geometry(path, array, 20, rng=rng), 1e3, array)
        for how in square:
            f = track_iq(
                iq, BOX, **SETTINGS, hop=0.0125, remove_dc=False, balance=False, start_windows=how
            )
            i, t = np.argmin(f.score[:, 0]), f.time[f.used - 1]
            error = (f.x[i, 0] - x - t * np.r_[x[3:], 0, 0, 0])[[0, 1, 3, 4]]
            square[how] += np.sum(error[:2] ** 2)
        total += error @ np.linalg.solve(f.P[i, 0][np.ix_([0, 1, 3, 4], [0, 1, 3, 4])], error)
    assert square["all"] < 0.25 * square["side by side"]
    low, high = chi2.ppf([1e-6, 1 - 1e-6], 32)
    assert low < total < high


def test_a_start_survives_windows_with_something_else_in_them(room):
    """Two modules hear a strong tone for a fifth of the start, at another frequency each time."""
    rng, off = np.random.default_rng(103), []
    for iq, _, truth in room[:4]:
        first, x = round((0.1 - iq.first) * iq.fs), iq.x.copy()
        there = np.arange(first, first + round(0.1 * iq.fs)) / iq.fs
        x[[1, 3], first : first + len(there)] += 5 * np.exp(
            2j * np.pi * rng.uniform(-90, 90, (2, 1)) * there
        )
        bad = replace(iq, x=x)
        for loss, told in (
            ("least_squares", pytest.warns(ImplausibleStart)), ("bisquare", nullcontext()),
        ):  # fmt: skip
            with told:
                f = track_iq(bad, BOX, **SETTINGS, balance=False, start_loss=loss, rng=rng)
            assert f.plausible == (loss == "bisquare")
            i, t = np.argmin(f.score[:, 0]), f.time[f.used - 1]
            off.append(np.linalg.norm((f.x[i, 0] - truth[round(t * FS)])[:2]))
    plain, robust = np.array(off).reshape(4, 2).T
    # The errors of such starts are some centimeters; a meter is no start.
    assert (robust < 0.2).all() and np.median(plain) > 1
    with pytest.raises(ValueError, match=r"rng must be a numpy\.random\.Generator"):
        track_iq(room[0][0], BOX, **SETTINGS, start_loss="bisquare")
