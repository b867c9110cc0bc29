"""Each number by which the report is judged, computed again by another route.

The filter is written again from the textbook, with a plain inverse, the search from the report's
own listing, the formulas by hand. Both sides take the same noise, so no comparison is random.
"""

from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation
from scipy.stats import chi2

from dopplerlib import doppler_shift, ml_initialize, simulate
from dopplerlib.evaluation.checklist import complex_step_jacobian
from dopplerlib.systems import mittermaier2016
from dopplerlib.systems import sombatsatien as student
from dopplerlib.systems.sombatsatien.evidence import evidence, outcomes
from dopplerlib.systems.sombatsatien.evidence.settings import formula

SEED, RUNS, HALF, FEW = 3, 24, 12, 8
COMPONENTS = ("x", "y", "z", "vx", "vy", "vz")
S, START = student.reported().scenario, student.reported().start


@pytest.fixture(scope="module")
def found():
    return evidence(rng=np.random.default_rng(SEED), runs=RUNS)


@pytest.fixture(scope="module")
def streams():
    """Return the noise and the starts that the evidence takes, by the names of its generators."""
    noise, rounding = np.random.default_rng(SEED).spawn(2)
    truth, z = simulate(S, RUNS, rng=noise)
    near = START.estimate + rounding.uniform(-5e-5, 5e-5, (100, 6))
    return SimpleNamespace(truth=truth, z=z, near=near)


@pytest.fixture(scope="module")
def starts(found):
    return np.stack([found[f"start-{c}"].values for c in COMPONENTS], axis=-1)


@pytest.fixture(scope="module")
def plain(streams, starts):
    """Return the report's filter on every record, from the starts of the evidence."""
    return plain_ekf(streams.z[:, 10:], ring("z"), starts, S.P0, position_sign=-1)


def ring(plane):
    """Return six places on a circle, first on the +x or +y axis."""
    angle = np.arange(6) * np.pi / 3
    circle = 0.2 * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    return np.insert(circle, 2 if plane == "z" else 0, 0, axis=-1)


def shifts(x, places):
    """Return shifts and their derivatives from unit vectors along the lines of sight."""
    line = places - x[..., None, :3]
    distance = np.sqrt((line**2).sum(axis=-1))[..., None]
    unit, v = line / distance, x[..., None, 3:]
    along = (unit * v).sum(axis=-1)
    gain = 2 / 0.0125
    H = np.concatenate([(along[..., None] * unit - v) / distance, unit], axis=-1)
    return gain * along, gain * H


def plain_ekf(z, places, x, P, position_sign=1):
    """Predict and update as textbooks have it; return states, covariances and NIS."""
    T = 0.001
    F = np.eye(6) + T * np.eye(6, k=3)
    G = 0.4 * np.repeat([T**2 / 2, T], 3)
    Q, R, signs = np.outer(G, G), 0.16 * np.eye(6), np.repeat([position_sign, 1], 3)
    P, found = np.broadcast_to(P, (len(z), 6, 6)), []
    for k in range(z.shape[1]):
        x, P = x @ F.T, F @ P @ F.T + Q
        h, H = shifts(x, places)
        H = H * signs
        inverse = np.linalg.inv(H @ P @ H.mT + R)
        K, nu = P @ H.mT @ inverse, z[:, k] - h
        x = x + np.einsum("rij,rj->ri", K, nu)
        IKH = np.eye(6) - K @ H
        P = IKH @ P @ IKH.mT + K @ R @ K.mT
        found.append((x, P, np.einsum("ri,rij,rj->r", nu, inverse, nu)))
    x, P, nis = (np.stack(one, axis=1) for one in zip(*found, strict=True))
    return SimpleNamespace(x=x, P=P, nis=nis)


def position_error(track, truth):
    return np.sqrt(((track.x - truth)[..., :3] ** 2).sum(axis=-1))


def of_runs(values, run, worst=0.9):
    return np.quantile(values, {"the median": 0.5, "the worst of ten": worst}[run])


def number(errors, statistic):
    if statistic == "root mean square":
        return np.sqrt(np.mean(errors**2))
    return np.quantile(errors, {"median": 0.5, "nine in ten": 0.9}[statistic])


def values(sweep):
    """Return our numbers at each combination of choices."""
    return {at: getattr(one, "value", one) for at, one in sweep.points.items()}


def same(sweep, expected, rel=1e-3, abs=1e-9):
    """Compare a sweep with what a function gives for the same choices."""
    for at, ours in values(sweep).items():
        assert ours == pytest.approx(expected(*at), rel=rel, abs=abs), at


# What the report sets up


def test_the_settings_are_those_of_the_paper_and_of_the_report(found):
    paper, run = mittermaier2016.reported().scenario, student.reported().run
    assert (found["sigma-p"], found["sigma-f"], found["interval"]) == (0.4, 0.4, 0.001)
    assert (paper.sigma_a, paper.sigma_f, paper.T) == (0.4, 0.4, 0.001)
    assert found["tracked"] == 1000 - 10 == run.tracked
    at_end = 0.833 - 0.750 * 0.999
    assert found["final-true-x"] == pytest.approx(at_end)
    assert found["nearest"] == pytest.approx(at_end)


def test_the_formula_of_the_report_is_the_rate_of_the_distance(found):
    """Central differences over 2 microseconds: their error is below 1e-9 of the rate."""
    distance = [
        np.linalg.norm(ring("z") - (S.x0[:3] + t * S.x0[3:]), axis=1) for t in (-1e-6, 1e-6)
    ]
    rate = (distance[0] - distance[1]) / 2e-6 * 2 / 0.0125
    np.testing.assert_allclose(formula(S.x0, S.array) / rate, found["h"], rtol=1e-7)
    np.testing.assert_allclose(found["h"], 1, rtol=1e-12)


def test_all_points_of_a_cone_have_one_shift(found):
    """The line of sight turned about the velocity, by rotations of SciPy."""
    apex, v = ring("z")[0], S.x0[3:]
    turned = Rotation.from_rotvec(np.linspace(0, 6, 20)[:, None] * v / np.linalg.norm(v))
    places = apex + 3 * turned.apply(S.x0[:3] - apex)
    states = np.column_stack([places, np.broadcast_to(v, places.shape)])
    ratio = shifts(states, ring("z"))[0][:, 0] / shifts(S.x0, ring("z"))[0][0]
    np.testing.assert_allclose([ratio.min(), ratio.max()], found["cone"], rtol=1e-12)


def test_one_sensor_determines_three_numbers_of_six(found):
    """Its record depends on d.d, d.v and v.v alone, so that a turned state gives the same one."""
    counts = {"one sample": 1, "ten samples": 3, "the record": 3}
    assert values(found["sensors"]) == {(name,): n for name, n in counts.items()}
    turned = Rotation.from_rotvec([0.3, -0.8, 0.5])
    d, v = turned.apply(S.truth[:, :3] - ring("z")[0]), turned.apply(S.truth[:, 3:])
    image = np.column_stack([ring("z")[0] + d, v])
    ours, theirs = (shifts(x, ring("z")[:1])[0] for x in (S.truth, image))
    np.testing.assert_allclose(ours, theirs, rtol=1e-9)


def test_the_rings_have_one_shape_and_two_places(found):
    a, b = np.meshgrid(*[np.arange(6) * np.pi / 3] * 2, indexing="ij")
    apart = 0.2 * np.sqrt(
        np.cos(a) ** 2 + (np.sin(a) - np.cos(b)) ** 2 + np.sin(b) ** 2
    )  # (cos a, sin a, 0) and (0, cos b, sin b)
    expected = {"its shape": 0, "its place": apart.min(axis=1).max()}
    same(found["ring"], expected.get)


def test_the_ratio_of_the_jacobians_is_that_of_complex_steps(found):
    H = student.student_jacobian(S.x0, S.array) / complex_step_jacobian(S.x0, S.array)
    np.testing.assert_allclose(H, np.broadcast_to(found["jacobian"], H.shape), rtol=1e-9)


def test_the_bound_on_x_is_that_of_an_information_matrix_summed_by_hand(found):
    def bound(plane, samples):
        n = {"one sample": 1, "ten samples": 10, "the record": 1000}[samples]
        t = 0.001 * np.arange(n) - 0.001 * (n - 1)  # by the state at the last of them
        H = shifts(S.truth[:n], ring(plane))[1]
        H[..., 3:] += t[:, None, None] * H[..., :3]
        information = np.einsum("kni,knj->ij", H, H) / 0.16
        if n == 1:
            assert np.linalg.matrix_rank(information) < 6
            return 2.0 - 0.1
        scale = 1 / np.sqrt(np.diag(information))
        return np.sqrt(np.linalg.inv(information * np.outer(scale, scale))[0, 0]) * scale[0]

    same(found["range-poor"], bound)


def test_the_bound_at_the_end_is_that_of_the_library(found):
    """Least squares reach it, see test_system.py."""
    same(found["limit-bound"], student.final_bound, rel=1e-12)


# Its run


def test_the_starts_are_those_of_the_listing(starts, streams):
    """SciPy as the report calls it. Where it stops in the flat valley hangs on the last bit.

    So in every component half of the starts agree within a tenth of their spread, and all of them
    explain the average equally well, within a tenth of its variance.
    """

    def misfit(x, average):
        return np.sum((average - shifts(x, ring("z"))[0]) ** 2)

    listed = [
        minimize(
            misfit,
            [0.5, 0.0, 0.1, -0.5, 0.0, 0.0],
            args=(z.mean(axis=0),),
            method="L-BFGS-B",
            bounds=[(0.1, 2.0), (-1.0, 1.0), (-0.5, 0.5), (-2.0, 0.0), (-1.0, 1.0), (-1.0, 1.0)],
            options={"maxiter": 1000},
        ).x
        for z in streams.z[:HALF, :10]
    ]
    off = np.median(np.abs(starts[:HALF] - listed), axis=0)
    assert (off < 0.1 * starts.std(axis=0)).all()
    for ours, theirs, z in zip(starts, listed, streams.z, strict=False):
        average = z[:10].mean(axis=0)
        assert abs(misfit(ours, average) - misfit(theirs, average)) < 0.1 * 0.16 / 10


def test_the_starts_explain_the_average(found, starts, streams):
    residual = streams.z[:, :10].mean(axis=1) - shifts(starts, ring("z"))[0]
    left = np.sqrt((residual**2).mean(axis=1)) / (0.4 / np.sqrt(10))
    same(found["optimizer"], lambda run: of_runs(left, run), rel=1e-6)


def test_the_outcomes_are_those_of_a_filter_written_plainly(found, plain):
    error = plain.x - S.truth[10:]
    final = plain.x[:, -1]
    expected = {
        "position-rmse": np.sqrt((error[..., :3] ** 2).sum(axis=-1).mean(axis=1)),
        "velocity-rmse": np.sqrt((error[..., 3:] ** 2).sum(axis=-1).mean(axis=1)),
        "final-x": final[:, 0],
        "final-error": np.sqrt((error[:, -1, :3] ** 2).sum(axis=-1)),
        **{f"final-v{c}": final[:, 3 + i] for i, c in enumerate("xyz")},
    }
    for name, ours in expected.items():
        np.testing.assert_allclose(found[name].values, ours, atol=1e-5, err_msg=name)
    assert found["behind"].value == (final[:, 0] < 0).mean()


def test_behind_is_behind_the_platform_and_not_the_target():
    """Three estimates of x about the ring; the target stands at 0.084 m."""
    x = np.zeros((3, 1, 6))
    x[:, 0, 0] = -0.05, 0.05, 0.15
    result = SimpleNamespace(
        track=SimpleNamespace(x=x),
        start=np.zeros((3, 6)),
        position_rmse=np.zeros(3),
        velocity_rmse=np.zeros(3),
        position_error=np.zeros((3, 1)),
    )
    assert outcomes.of_one_run(result)["behind"].value == pytest.approx(1 / 3)


def test_the_reported_run_comes_from_a_filter_written_plainly(found, streams):
    z = np.repeat(student.reported_record()[None, 10:], 5, axis=0)
    again = plain_ekf(z, ring("z"), streams.near[:5], S.P0, position_sign=-1)
    error = again.x - S.truth[10:]
    expected = {
        "position-rmse": np.sqrt((error[..., :3] ** 2).sum(axis=-1).mean(axis=1)),
        "velocity-rmse": np.sqrt((error[..., 3:] ** 2).sum(axis=-1).mean(axis=1)),
        "final-x": again.x[:, -1, 0],
        "final-error": position_error(again, S.truth[10:])[:, -1],
    }
    for name, ours in expected.items():
        np.testing.assert_allclose(found[f"rerun-{name}"].values[:5], ours, atol=1e-5)


def test_the_error_falls_and_settles_as_a_plain_filter_has_it(found, plain, starts):
    error = position_error(plain, S.truth[10:])
    first = {
        "estimate of the start": np.sqrt(((starts - S.truth[9])[:, :3] ** 2).sum(axis=1)),
        "first tracked sample": error[:, 0],
        "after 10 ms": error[:, 9],
        "after 50 ms": error[:, 49],
        "largest in the first 100 ms": np.max(error[:, :100], axis=1),
    }
    late = {
        "second half": error[:, 495:].mean(axis=1),
        "last quarter": error[:, 990 - 247 :].mean(axis=1),
        "last tenth": error[:, 990 - 99 :].mean(axis=1),
        "last sample": error[:, 989],
    }
    for (name,), draws in found["initial-error"].points.items():
        np.testing.assert_allclose(draws.values, first[name], atol=1e-5, err_msg=name)
    same(found["decreases"], lambda a, b, run: of_runs(late[b] / first[a], run))
    same(found["settled-above"], lambda b, run: of_runs(late[b], run, 0.1))
    same(found["settled-below"], lambda b, run: of_runs(late[b], run))

    def grown(share, run):
        n = int(990 * share)
        parts = [error[:, 990 - n :], error[:, 990 - 2 * n : 990 - n]]
        return of_runs(parts[0].mean(axis=1) / parts[1].mean(axis=1), run)

    same(found["no-divergence"], grown)
    # Of two that are read as steadiness, `consistent` takes the same.
    steady = {at: one for at, one in values(found["consistent"]).items() if "record" in at[0]}
    for (_, _, share, run), ours in steady.items():
        assert ours == pytest.approx(grown(share, run), rel=1e-3)


def test_the_average_of_nis_is_that_of_a_plain_filter(found, plain):
    average = plain.nis.mean(axis=1)
    covariance = {at: one for at, one in values(found["consistent"]).items() if "errors" in at[0]}
    assert covariance
    for (_, confidence, _, run), ours in covariance.items():
        upper = chi2.ppf((1 + confidence) / 2, 6 * 990) / 990
        assert ours == pytest.approx(of_runs(average, run) / upper, rel=1e-3)


def test_the_shape_of_a_path_is_measured_again(found, plain):
    path, truth = plain.x[..., :3], S.truth[10:, :3]

    def likeness(shape, run):
        if "beginning" in shape:
            ways = [(p[-1] - p[0]) / np.linalg.norm(p[-1] - p[0]) for p in (*path, truth)]
            each = [1 - np.sum((way - ways[-1]) ** 2) / 2 for way in ways[:-1]]  # cosine
        elif "tenth" in shape:
            at = range(0, 900, 100)
            forward = [[(p[k + 100] - p[k]) @ S.x0[3:] > 0 for k in at] for p in path]
            each = np.mean(forward, axis=1)
        else:
            each = 1 - (path - truth).var(axis=1).sum(axis=1) / truth.var(axis=0).sum()
        return of_runs(each, run, 0.1)

    same(found["shape"], likeness)


def test_the_distance_is_off_by_what_a_plain_filter_has(found, plain):
    off = plain.x[..., 0] - (0.833 - 0.750 * 0.001 * np.arange(10, 1000))
    errors = {"at the end": np.abs(off[:, -1]), "over the record": off.std(axis=1)}
    errors["over the record"] = np.sqrt(off.var(axis=1) + off.mean(axis=1) ** 2)
    for name in ("centimeter", "range-lost"):
        same(found[name], lambda when, statistic: number(errors[when], statistic))


def test_an_interval_of_a_mean_square_stays_above_what_its_median_tells():
    """One error of 90 among 29 of about one: by itself the interval would reach down to zero."""
    errors = np.append(np.linspace(0.9, 1.1, 29), 90.0)
    one = outcomes.summary(errors, "root mean square")
    assert one.value == pytest.approx(np.sqrt(np.mean(errors**2)))
    twice = one.value - 2 * (one.value - one.low)
    assert 0.6 < twice < 1 / np.sqrt(2)
    assert one.high > one.value


def test_the_covariance_is_far_from_rounding(found, plain):
    """A plain inverse rounds otherwise, by less than a factor of ten."""
    least = np.linalg.eigvalsh(plain.P[:, ::10])[..., 0] / np.linalg.norm(
        plain.P[:, ::10], 2, axis=(-2, -1)
    )
    for (run,), ours in values(found["numerical"]).items():
        plainly = of_runs(least.min(axis=1), run, 0.1) / np.finfo(float).eps
        assert 0.1 < ours / plainly < 10

    def of(P):
        track = SimpleNamespace(P=np.broadcast_to(P, (1, 20, 6, 6)))
        return outcomes.positivity(SimpleNamespace(track=track))[0]

    eps = np.finfo(float).eps
    assert of(np.diag([1, 1, 1, 1, 1, 1e-3])) == pytest.approx(1e-3 / eps)
    assert of(np.diag([1, 1, 1, 1, 1, -1e-3])) == pytest.approx(-1e-3 / eps)
    askew = np.eye(6)
    askew[0, 1], askew[1, 0] = 1e-4, -1e-4
    assert of(askew) == pytest.approx(1 / 2e-4, rel=1e-6)


# What it concludes


@pytest.fixture(scope="module")
def both(streams):
    """Return the records of both rings with the same noise, to the last bit."""
    noise = streams.z - doppler_shift(S.truth, S.array)
    arrays = {plane: student.ring_scenario(plane).array for plane in "zx"}
    return {plane: doppler_shift(S.truth, array) + noise for plane, array in arrays.items()}


def descents(plane, z, samples):
    array = student.ring_scenario(plane).array
    box = START.lower, START.upper
    return student.local_start(z[:, :samples], array, START.guess, box)[0]


def test_what_ten_samples_add_to_one_is_counted_again(found, both):
    ours = values(found["ambiguity"])
    assert ours["z", "which of two images"] == 0
    x = S.x0
    kappa = x[:3] @ x[3:] / (x[:3] @ x[:3])
    across = 2 * x[4:] / kappa - 3 * x[1:3]
    across_v = x[4:] + kappa * (across - x[1:3])
    ahead = np.sqrt(x[:3] @ x[:3] - across @ across)
    ahead_v = (x[:3] @ x[3:] - across @ across_v) / ahead
    image = np.array([ahead, *across, ahead_v, *across_v])
    apart = shifts(image, ring("x"))[0] - shifts(x, ring("x"))[0]
    assert ours["x", "which of two images"] == pytest.approx(9 * np.sum((apart / 0.4) ** 2))
    for plane in "zx":
        one, ten = (
            np.linalg.norm((descents(plane, both[plane][:HALF], n) - S.truth[n - 1])[:, :3], axis=1)
            for n in (1, 10)
        )
        # The target moves 7 mm in ten samples; with the exact gradient the starts are the same.
        assert ours[plane, "where"] == pytest.approx(np.median(one - ten), abs=1e-6)


def test_what_a_start_is_worth_is_counted_with_a_plain_filter(found, both, starts):
    end, image = S.truth[-1, :3], S.truth[-1, :3] * [1, 1, -1]

    def final(plane, start):
        z = both[plane][:FEW, 10:]
        return plain_ekf(z, ring(plane), np.broadcast_to(start, (FEW, 6)), S.P0).x[:, -1, :3]

    reported = {"z": starts[:FEW], "x": descents("x", both["x"][:FEW], 10)}
    poor = {plane: final(plane, reported[plane]) for plane in "zx"}
    good = {plane: final(plane, S.truth[9]) for plane in "zx"}

    def off(path, to=end):
        return np.linalg.norm(path - to, axis=1)

    def sufficient(to, accuracy):
        distance = off(poor["z"])
        if to != "the target":
            distance = np.minimum(distance, off(poor["z"], image))
        return (distance < accuracy).mean()

    same(found["start-sufficient"], sufficient)
    same(
        found["start-critical"],
        lambda plane, accuracy: (
            (off(good[plane]) < accuracy).mean() - (off(poor[plane]) < accuracy).mean()
        ),
    )


def test_the_linear_filter_is_written_again(found, both):
    T, G = 0.001, 0.4 * np.repeat([0.001**2 / 2, 0.001], 3)
    F = np.eye(6) + T * np.eye(6, k=3)

    @cache
    def final(plane, tangent):
        place = S.truth[0 if tangent == "at the start" else 500]
        h, H = shifts(place, ring(plane))
        x, P = np.repeat(S.truth[:1], FEW, axis=0), 0.1 * np.eye(6)
        for z in both[plane][:FEW, 1:].swapaxes(0, 1):
            x, P = x @ F.T, F @ P @ F.T + np.outer(G, G)
            K = np.linalg.solve(H @ P @ H.T + 0.16 * np.eye(6), H @ P).T
            x = x + (z - h - (x - place) @ H.T) @ K.T
            P = P - K @ H @ P
        return np.linalg.norm((x - S.truth[-1])[:, :3], axis=1)

    same(
        found["linear"], lambda plane, tangent, statistic: number(final(plane, tangent), statistic)
    )


def test_the_repaired_runs_are_those_of_a_plain_filter(found, both, plain):
    def run(plane, samples):
        array = student.ring_scenario(plane).array
        z = both[plane][:FEW]
        one = ml_initialize(
            z[:, :samples], array, 0.4, 0.001, (START.lower, START.upper), at="last"
        )
        return plain_ekf(z[:, samples:], ring(plane), one.x, one.P).x[:, -1]

    ends = {(p, n): run(p, n) for p in "zx" for n in (10, 30, 100, 200, 300)}
    off = {at: np.linalg.norm((x - S.truth[-1])[:, :3], axis=1) for at, x in ends.items()}
    same(found["limit"], lambda plane, n, statistic: number(off[plane, n], statistic), rel=0.02)
    same(found["feasible"], lambda n, accuracy: (off["x", n] < accuracy).mean())

    def right(which, approach, n):
        x = plain.x[:, -1] if which == "as reported" else ends["x", n]
        rate = x[:, 3] if approach == "v_x" else np.einsum("ri,ri->r", x[:, :3], x[:, 3:])
        return (rate < 0).mean()

    same(found["approaching"], right)


def test_a_record_of_the_fixture_is_what_the_library_has(streams):
    """The shifts that these tests write by hand are those of the library."""
    np.testing.assert_allclose(
        shifts(S.truth, ring("z"))[0], doppler_shift(S.truth, S.array), rtol=1e-12
    )
    assert streams.z.shape == (RUNS, 1000, 6)
