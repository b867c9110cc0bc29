"""Explorables compute what the library computes; their still pictures are what they draw."""

import json
import re
import shutil
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.stats import kstest

from dopplerlib import (
    RadarArray,
    crlb,
    crlb_frequency_std,
    doppler_shift,
    ekf,
    fisher_information,
    ml_frequency,
    nees,
    ring_family,
    simulate,
)
from dopplerlib.chain.collision import collision_probability
from dopplerlib.signal import laws
from dopplerlib.systems import asheim2015 as thesis
from dopplerlib.systems import mittermaier2016 as paper
from dopplerlib.systems import sombatsatien as student
from dopplerlib.systems.mittermaier2016.readings.combinations import SWITCHES
from dopplerlib.tracking.bilateration import bilaterate
from dopplerlib.workspace.stop_study import saved_stops
from dopplerlib.workspace.stopping import RADIUS
from tools import explorables, notebooks

SCENARIO = paper.reported().scenario
NAMES = sorted(explorables.SETTINGS)
FIFTH = np.arange(6) == 4  # the velocity across
FLAT = [True, True, False, True, True, False]
# What the two languages may differ by: kernels are the same bits, sums have another order.
EXACT = {"rtol": 1e-12, "atol": 0}

needs_node = pytest.mark.skipif(shutil.which("node") is None, reason="no node on this machine")


def measured(name, *states):
    """Return the numbers of an explorable in each of some states, as changes of the first."""
    program = (
        f"{json.dumps(states)}.map(c => explorable.measure(settings, Object.assign(state, c)))"
    )
    return explorables.node(name, program)


def test_the_printed_kernels_are_those_that_are_derived():
    stored = explorables.FOLDER.joinpath(explorables.KERNELS).read_text(encoding="utf-8")
    assert stored == explorables.kernels(), "run make kernels"


@needs_node
@pytest.mark.parametrize("name", NAMES)
def test_the_still_picture_is_what_is_drawn_first(name):
    stored = explorables.FOLDER.joinpath(f"{name}.svg").read_text(encoding="utf-8")
    assert stored == explorables.still(name), "run python -m tools.explorables"


def test_every_file_belongs_to_an_explorable():
    files = {script for name in NAMES for script in (*explorables.scripts(name), f"{name}.svg")}
    assert {path.name for path in explorables.FOLDER.iterdir()} == files


def test_every_explorable_is_on_a_page_that_a_phone_can_load():
    found = []
    for path in notebooks.chapters():
        names = re.findall(r"\{explorable\} (\w+)", path.read_text(encoding="utf-8"))
        files = {file for name in names for file in (*explorables.scripts(name), f"{name}.svg")}
        size = sum(explorables.FOLDER.joinpath(file).stat().st_size for file in files)
        assert size + sum(len(explorables.settings(name)) for name in names) < 100_000, path.name
        found += names
    assert sorted(found) == NAMES


@pytest.mark.parametrize("name", NAMES)
def test_a_script_asks_for_no_file_and_no_address(name):
    for script in explorables.scripts(name):
        text = explorables.FOLDER.joinpath(script).read_text(encoding="utf-8")
        text = text.replace("http://www.w3.org/2000/svg", "")  # a name, which is not fetched
        assert not re.search(r"https?:|\bfetch\b|\bimport\b|XMLHttpRequest|eval\(", text)


@needs_node
def test_shifts_and_bound_of_the_plane_scene_are_those_of_the_library():
    sensors = RadarArray.linear(6, 0.3).positions[:, :2].tolist()
    moved = {"x": 0.8, "y": -0.1, "speed": 1.2, "direction": 140, "sensors": sensors}
    start, after = measured("shifts", {}, moved)
    settings = explorables.SETTINGS["shifts"]()
    for numbers in (start, after):
        x, y, v_x, v_y = numbers["x"]
        state = np.array([x, y, 0, v_x, v_y, 0])
        array = RadarArray(np.column_stack([numbers["sensors"], np.zeros(6)]))
        assert_allclose(numbers["shifts"], doppler_shift(state, array), **EXACT)
        record = settings["samples"], settings["T"], "constant_velocity"
        J = fisher_information(state, array, settings["deviation"], *record)
        free = np.ix_([0, 1, 3, 4], [0, 1, 3, 4])
        assert_allclose(numbers["information"], J[free], rtol=1e-12, atol=1e-12 * J[free].max())
        P = crlb(state, array, settings["deviation"], *record, free=FLAT)[:2, :2]
        # An inverse loses as many digits as the matrix, with a unit diagonal, has in its condition.
        size = np.sqrt(np.diag(J[free]))
        loss = np.linalg.cond(J[free] / np.outer(size, size))
        assert_allclose(numbers["position"], P, rtol=1e-14 * loss)
        assert_allclose(numbers["bound"], np.sqrt(np.trace(P)), rtol=1e-14 * loss)
    assert after["bound"] > start["bound"]  # a shorter row, a target farther away
    slider = "explorable.controls().find(({ name }) => name === 'length').set(0.3, state)"
    assert_allclose(explorables.node("shifts", slider)["sensors"], sensors, atol=1e-12)


@needs_node
def test_a_target_at_rest_has_no_shift_and_no_bound():
    (numbers,) = measured("shifts", {"speed": 0})
    assert not np.any(numbers["shifts"])
    assert numbers["bound"] is None


@needs_node
def test_the_blind_family_is_that_of_the_library_and_stands_still():
    scales = [0.5, 1.0, 1.5, 2.0]
    *still, lifted = measured("blind", *({"t": t} for t in scales), {"t": 0.7, "lift": 5})
    radius = np.linalg.norm(SCENARIO.array.positions[0])
    family = ring_family(SCENARIO.x0, radius, scales)
    assert_allclose([numbers["x"] for numbers in still], family, rtol=1e-12)
    shifts = [numbers["shifts"] for numbers in still]
    assert_allclose(shifts, doppler_shift(family, SCENARIO.array), **EXACT)
    assert all(n["change"] < 1e-12 and n["bound"] is None for n in still)

    places = SCENARIO.array.positions.copy()
    places[0, 0] += 0.05
    array, x = RadarArray(places), lifted["x"]
    assert_allclose(lifted["shifts"], doppler_shift(x, array), **EXACT)
    change = np.abs(np.subtract(lifted["shifts"], doppler_shift(SCENARIO.x0, array))).max()
    assert_allclose(lifted["change"], change, atol=1e-12)
    J = fisher_information(x, array, SCENARIO.sigma_f, 100)
    assert_allclose(lifted["information"], J, rtol=1e-12, atol=1e-12 * J.max())
    size = np.sqrt(np.diag(J))
    bound = np.sqrt(np.trace(crlb(x, array, SCENARIO.sigma_f, 100)[:3, :3]))
    loss = np.linalg.cond(J / np.outer(size, size))
    assert_allclose(lifted["bound"], bound, rtol=1e-14 * loss)


@needs_node
def test_the_decisions_shown_are_those_of_the_saved_study():
    settings = explorables.SETTINGS["stop"]()
    cases = [
        ("ekf", "must stop now", 0.1),
        ("ring_iekf", "within 0.3 s", 0.5),
        ("truth", "ever", 0.98),
    ]
    states = [
        {"tracker": tracker, "rule": rule, "place": settings["thresholds"].index(threshold)}
        for tracker, rule, threshold in cases
    ]
    study = saved_stops("workspace")
    for numbers, (tracker, rule, threshold) in zip(measured("stop", *states), cases, strict=True):
        summary = study.summary(tracker, rule, threshold)
        assert numbers["threshold"] == threshold
        hit, false = summary.in_time, summary.false
        missed = [100 * (1 - value) for value in (hit.value, hit.high, hit.low)]
        assert_allclose(numbers["missed"], missed, atol=0.005 + 1e-9)  # as they are rounded
        shown = [100 * value for value in (false.value, false.low, false.high)]
        assert_allclose(numbers["false"], shown, atol=0.005 + 1e-9)
        assert_allclose(numbers["median"], summary.lead.value, atol=0.0005 + 1e-9)
        collisions = (study.courses.kind == "collision").sum()
        counted = sum(numbers["inTime"]) + sum(numbers["late"]) + numbers["never"]
        assert counted == collisions == settings["counts"]["collision"]
        assert_allclose(sum(numbers["inTime"]), collisions * hit.value, rtol=1e-12)


@needs_node
@pytest.mark.parametrize(
    "knobs",
    [
        {},
        {"R": -1, "Q": 1, "P0": 1, "late": 7, "gate": "upper"},
        {"sign": True, "gate": "two-sided"},
    ],
    ids=str,
)
def test_the_filter_in_the_page_is_ekf_to_the_last_bit(knobs):
    record = explorables.node(
        "filter",
        f"(() => {{ Object.assign(state, {json.dumps(knobs)}); settings.samples = 200;"
        "const { truth, z } = explorable.simulate(settings, state, 3);"
        "const { x, nis, updated, P } = explorable.track(settings, state, z);"
        "const error = x.at(-1).map((value, c) => value - truth.at(-1)[c]);"
        "const last = P(199), nees = algebra.distance(last, error);"
        "return { truth, z, x, nis, updated, P: last, nees }; })()",
    )
    settings = explorables.SETTINGS["filter"]()
    R, Q, P0 = (10.0 ** knobs.get(name, 0) for name in ("R", "Q", "P0"))
    start = settings["start"], np.diag([(settings["spread"] * P0) ** 2] * 6)
    deviations = settings["sigmaA"] * Q, settings["sigmaF"] * R
    gate = knobs.get("gate")
    track = ekf(record["z"], SCENARIO.array, *start, settings["T"], *deviations, "per_axis", gate)
    assert record["x"] == track.x.tolist()
    assert record["P"] == track.P[-1].tolist()
    assert record["nis"] == track.nis.tolist()
    assert record["updated"] == track.updated.tolist()
    # The last step is a division by P, whose condition the digits pay for.
    P = track.P[-1] / np.sqrt(np.outer(*[np.diag(track.P[-1])] * 2))
    truth = np.array(record["truth"])
    assert_allclose(record["nees"], nees(track, truth)[-1], rtol=1e-14 * np.linalg.cond(P))


@needs_node
@pytest.mark.parametrize("knobs", [{}, {"raise": 0, "P0": -1.3, "aside": 0.2, "dx": 0.02}], ids=str)
def test_the_first_page_computes_what_the_library_does(knobs):
    program = (
        f"(() => {{ Object.assign(state, {json.dumps({**knobs, 'k': 199})});"
        "Object.assign(settings, { samples: 200, runs: 3 });"
        "const truth = explorable.path(settings, state);"
        "const sigma = truth.map((_, k) => explorable.deviation(settings, state, k));"
        "const runs = [0, 1, 2].map((run) => explorable.record(settings, state, truth, run));"
        "return { truth, sigma, numbers: explorable.measure(settings, state), runs: runs.map("
        "({ z, estimate, x, nis, P }) => ({ z, estimate, x, nis, P: P(199) })) }; })()"
    )
    page = explorables.node("hero", program)
    truth, numbers, runs = np.array(page["truth"]), page["numbers"], page["runs"]
    turned = replace(SCENARIO, x0=np.where(FIFTH, truth[0], SCENARIO.x0), samples=200)
    assert_allclose(truth, turned.truth, **EXACT)
    entered = -truth[0, 0] / truth[0, 3] * (truth[0, 4] - SCENARIO.x0[4])
    assert_allclose(entered, knobs.get("aside", 0), atol=1e-15)
    far = np.linalg.norm(truth[0, :3] + np.linspace(0, 2, 20_001)[:, None] * truth[0, 3:], axis=1)
    assert_allclose(numbers["closest"], far.min(), rtol=1e-6)  # steps of 0.1 ms

    most = 10 ** knobs.get("raise", 1.5)
    sigma = SCENARIO.sigma_f * (1 + (most - 1) * np.exp(-np.arange(200) / 30))
    assert_allclose(page["sigma"], sigma, rtol=1e-14)
    z, estimate = (np.array([run[name] for run in runs]) for name in ("z", "estimate"))
    # 3600 errors of measurements: their spread is within 6 % but for a chance of 1e-6.
    assert_allclose((z - doppler_shift(truth, SCENARIO.array)).std(), SCENARIO.sigma_f, rtol=0.06)
    before = estimate - SCENARIO.T * np.pad(estimate[:, 3:], ((0, 0), (0, 3)))
    P0 = 10 ** (2 * knobs.get("P0", -0.5)) * np.eye(6)
    deviations = SCENARIO.sigma_a, np.array(page["sigma"])[:, None]
    track = ekf(z, SCENARIO.array, before, P0, SCENARIO.T, *deviations)
    assert [run["x"] for run in runs] == track.x.tolist()
    assert [run["nis"] for run in runs] == track.nis.tolist()
    P = track.P[:, -1]
    assert [run["P"] for run in runs] == P.tolist()

    error = np.linalg.norm(track.x[:, -1, :3] - truth[-1, :3], axis=-1)
    assert_allclose(numbers["error"], np.median(error), rtol=1e-12)
    claimed = np.sqrt(np.trace(P[:, :3, :3], axis1=1, axis2=2))
    assert_allclose(numbers["claimed"], np.median(claimed), **EXACT)
    assert_allclose(numbers["nis"], np.median(track.nis[:, 100:].mean(axis=1)), rtol=1e-12)
    condition = np.linalg.cond(P / np.sqrt(np.einsum("ri,rj->rij", *[np.einsum("rii->ri", P)] * 2)))
    value = np.median(nees(track, truth)[:, -1])
    assert_allclose(numbers["nees"], value, rtol=1e-14 * condition.max())


@needs_node
def test_the_first_page_decides_like_the_library():
    settings = explorables.SETTINGS["hero"]()
    x = SCENARIO.truth[::100] - [0.0, 0, 0.03, 0, 0, 0]
    P = np.diag([0.06, 0.05, 0.04, 0.1, 0.08, 0.1]) ** 2 + 0.001
    chances = explorables.node(
        "hero", f"{x.tolist()}.map(x => explorable.entering(x, {P.tolist()}, settings))"
    )
    points = len(settings["normal"])
    found = collision_probability(x, P, RADIUS, settings["within"], points=points)
    assert chances == found.tolist()
    assert min(chances) < 0.1 < 0.5 < max(chances)


@needs_node
def test_the_combinations_shown_are_those_of_the_saved_study():
    places = {"P0": 0, "noise": 1, "start": 2, "world": 3}
    saved = paper.saved_combinations()
    states = [
        {name: key[i] == SWITCHES[name][1] for name, i in places.items()} | {"place": place}
        for key in saved
        for place in (0, 6, 11)
    ]
    found = iter(measured("combinations", *states))
    for key, row in saved.items():
        for place in (0, 6, 11):
            numbers = next(found)
            assert numbers["key"] == list(key)
            assert numbers["nees"] == row["nees"][place].tolist()
            assert numbers["nis"] == row["nis"][place].tolist()


REPAIRED = {"sign": True, "ring": True, "start": "global, of 0.1 s"}


def post_mortem_in_the_page(**knobs):
    """Return the first two records of the post-mortem, of 300 samples, and their tracks."""
    program = (
        f"(() => {{ Object.assign(state, {json.dumps(knobs)});"
        "settings.samples = 300;"
        "const runs = [0, 1].map((run) => explorable.record(settings, state, run));"
        "return runs.map(({ z, x, nis, P }) => ({ z, x, nis, P: P(z.length - 1) })); })()"
    )
    return explorables.node("repairs", program)


@needs_node
def test_the_failed_filter_in_the_page_is_that_of_the_report():
    runs = post_mortem_in_the_page()
    s, settings = student.ring_scenario("z"), explorables.SETTINGS["repairs"]()
    start = settings["planes"]["z"]["starts"]["one descent"]
    z = np.array([run["z"] for run in runs])
    # 3480 errors of measurements: their spread is within 6 % but for a chance of 1e-6.
    assert_allclose((z - doppler_shift(s.truth[10:300], s.array)).std(), s.sigma_f, rtol=0.06)
    for run, x0 in zip(runs, start["x"], strict=False):
        # The report's own form of the update, Joseph's: another rounding at each of 290 samples,
        # which a filter that is driven away from the target amplifies.
        track = student.student_ekf(
            np.array([run["z"]]), s.array, x0, s.P0, s.T, s.sigma_a, s.sigma_f
        )
        assert_allclose(run["x"][0], track.x[0, 0], atol=1e-12)
        assert_allclose(run["x"], track.x[0], atol=1e-6)
        assert_allclose(run["P"], track.P[0, -1], atol=1e-6 * abs(track.P[0, -1]).max())


@needs_node
def test_the_repaired_filter_in_the_page_is_that_of_the_library():
    runs = post_mortem_in_the_page(**REPAIRED)
    s, settings = student.ring_scenario("x"), explorables.SETTINGS["repairs"]()
    start = settings["planes"]["x"]["starts"][REPAIRED["start"]]
    for run, x0, P0 in zip(runs, start["x"], start["P"], strict=False):
        track = ekf([run["z"]], s.array, x0, P0, s.T, s.sigma_a, s.sigma_f)
        assert_allclose(run["x"], track.x[0], **EXACT)
        assert_allclose(run["nis"], track.nis[0], rtol=1e-9)
        assert_allclose(run["P"], track.P[0, -1], atol=1e-12 * abs(track.P[0, -1]).max())


def test_the_starts_of_the_post_mortem_are_those_of_the_library():
    settings = explorables.SETTINGS["repairs"]()
    names = {"one descent": "as reported", "global search": "global", "global, of 0.1 s": "long"}
    for plane, ring in settings["planes"].items():
        _, z = simulate(
            student.ring_scenario(plane), explorables.RUNS, rng=np.random.default_rng(8)
        )
        for shown, name in names.items():
            run = student.post_mortem(
                len(z), rng=None, z=z, plane=plane, start=name, jacobian="derived"
            )
            assert_allclose(ring["starts"][shown]["x"], run.start, atol=0.51e-5)


@needs_node
def test_late_measurements_are_those_of_an_earlier_place():
    program = (
        "[0, 5].map(late => explorable.simulate({ ...settings, samples: 40, sigmaF: 0 }, "
        "{ ...state, late }, 0))"
    )
    on_time, late = explorables.node("filter", program)
    assert on_time["truth"] == late["truth"]
    assert on_time["z"][:-5] == late["z"][5:]
    assert_allclose(on_time["z"], doppler_shift(on_time["truth"], SCENARIO.array), **EXACT)
    # The target is pushed on each axis: T times a number of deviation sigma_a. Of 120 numbers the
    # spread is within 35 % of it, but for a chance of 1e-7.
    push = np.diff(np.array(on_time["truth"])[:, 3:], axis=0) / SCENARIO.T
    assert_allclose(push.std(), SCENARIO.sigma_a, rtol=0.35)


@needs_node
def test_random_numbers_are_normal():
    values = explorables.node("filter", "(n => Array.from({ length: 4000 }, n))(algebra.normal(5))")
    assert kstest(values, "norm").pvalue > 1e-6  # the chance of a false alarm


@needs_node
def test_spectrum_and_estimate_of_a_window_are_those_of_the_library():
    lengths = explorables.LENGTHS
    states = [
        {"place": lengths.index(101), "tag": "center"},
        {"place": lengths.index(801), "tag": "end", "snr": 5},
    ]
    program = (
        f"{json.dumps(states)}.map(c => {{ Object.assign(state, c);"
        "const length = settings.lengths[state.place], normal = algebra.normal(3);"
        "const noise = Array.from({ length: 2 * length }, normal);"
        "const { re, im } = explorable.samples(settings, { ...state, length }, noise);"
        "const r = new Float64Array(2048), m = new Float64Array(2048);"
        "r.set(re); m.set(im); explorable.transform(r, m);"
        "return [[re, im, r, m].map(v => [...v]), explorable.estimate({ re, im }, settings.fs)]; })"
    )
    fs = explorables.SETTINGS["window"]()["fs"]
    for (real, imaginary, r, m), frequency in explorables.node("window", program):
        window = np.array(real) + 1j * np.array(imaginary)
        spectrum = np.fft.fft(window, 2048)
        assert_allclose(r, spectrum.real, atol=1e-12 * abs(spectrum).max())
        assert_allclose(m, spectrum.imag, atol=1e-12 * abs(spectrum).max())
        # The highest of some values is known to half of their digits; Newton's method finds more.
        assert_allclose(frequency, ml_frequency(window, fs), rtol=1e-9)


@needs_node
def test_laws_of_the_window_are_those_of_the_library():
    settings = explorables.SETTINGS["window"]()
    states = [{"place": 3, "snr": 12}, {"place": 9, "tag": "center", "bend": 700}]
    end, center = measured("window", *states)
    snr, fs = 10**1.2, settings["fs"]
    for numbers in (end, center):
        bound = crlb_frequency_std(snr, numbers["length"], fs)
        assert_allclose(numbers["bound"], bound, rtol=1e-12)
        # Sixty errors: the root of a chi-square of sixty, within a factor of 1.6 but for 1e-6.
        expected = np.hypot(bound, numbers["bias"])
        assert expected / 1.6 < numbers["rms"] < 1.6 * expected
    assert_allclose(end["best"], laws.optimal_window_end(fs * snr, settings["chirp"]), rtol=1e-12)
    assert_allclose(center["best"], laws.optimal_window_center(fs * snr, 700), rtol=1e-12)


@needs_node
def test_errors_of_two_circles_are_those_of_the_library():
    cases = [(0.4, 3.6, 1.0), (-1.2, 1.5, 2.0), (0.0, 5.0, 0.4)]
    states = [{"x": x, "y": y, "baseline": b} for x, y, b in cases]
    near, wide, far = found = measured("circles", *states)
    assert near["missed"] < 0.05 < far["missed"]
    assert wide["missed"] == 0
    for numbers, (x, y, b) in zip(found, cases, strict=True):
        p = np.array([x, y])
        d = np.hypot(*(p - thesis.radar_positions(b)).T)
        assert_allclose(numbers["ranges"], d, **EXACT)
        assert_allclose(numbers["deviations"], thesis.noise_std(d)[:, 0], **EXACT)
        # A condition of some tens.
        P = thesis.one_scan_bound(p, b)
        assert_allclose(numbers["covariance"], P, rtol=1e-12, atol=1e-12 * P.max())
    pairs = [[2.0, 2.1], [3.0, 2.5], [1.0, 4.0]]
    found = explorables.node(
        "circles", f"{pairs}.map(([a, b]) => explorable.bilaterate(a, b, 0.8))"
    )
    x, y, valid = bilaterate(*np.transpose(pairs), 0.8)
    assert [p is not None for p in found] == valid.tolist() == [True, True, False]
    assert_allclose(found[:2], np.stack([x, y], axis=-1)[:2], **EXACT)
