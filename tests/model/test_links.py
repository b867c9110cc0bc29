"""Shifts of moving sensors obey physics; clocks are what an estimator with all unknowns finds."""

from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest
from scipy.linalg import block_diag

from dopplerlib import (
    DopplerLinks,
    RadarArray,
    constant_velocity,
    crlb,
    doppler_jacobian,
    doppler_shift,
    fisher_information,
)
from dopplerlib.model.links import sample_times

RNG = np.random.default_rng(1842)
N, K = 5, 4
SENDERS, LISTENERS = RNG.normal(size=(2, N, 6))
LISTENERS[:, :3] += 4
WAVES = RNG.uniform(0.01, 0.2, N)
TARGETS = RNG.normal(size=(7, 6)) - [3, 3, 3, 0, 0, 0]
TIMES = np.array([0.0, 0.1, 0.35, 0.4])
LINKS = {
    "one way": DopplerLinks.one_way(LISTENERS, WAVES),
    "two ways": DopplerLinks.two_way(LISTENERS, WAVES),
    "bistatic": DopplerLinks(LISTENERS, SENDERS, WAVES),
}
every = pytest.mark.parametrize("links", LINKS.values(), ids=LINKS)
# Shifts of some hundred Hz, of which a dozen roundings are 1e-13.
ROUNDING = {"rtol": 1e-12, "atol": 1e-11}


def straight(x):
    return x + np.outer(TIMES, [*x[3:6], *np.zeros(len(x) - 3)])


def path_rate(ends, target, t):
    """Return the rate of the length of a path over straight ends, in forty digits."""
    with mp.workdps(40):

        def length(tau):
            p = mp.matrix(target[:3]) + tau * mp.matrix(target[3:])
            return mp.fsum(mp.norm(mp.matrix(e[:3]) + tau * mp.matrix(e[3:]) - p) for e in ends)

        return float(mp.diff(length, t))


@every
def test_the_shift_is_the_rate_of_the_path_over_the_wavelength(links):
    sampled = links.sampled(K, [9.0, *np.diff(TIMES)])
    np.testing.assert_allclose(sampled.times, TIMES, rtol=1e-15)
    x = TARGETS[0]
    path = straight(x)
    expected = [
        [-path_rate([end[n] for end in ends(links)], x, t) / WAVES[n] for n in range(N)]
        for t in TIMES
    ]
    np.testing.assert_allclose(doppler_shift(path, sampled), expected, **ROUNDING)
    np.testing.assert_allclose(doppler_shift(x, links), expected[0], **ROUNDING)


def ends(links):
    """Return the ends of all legs, each of them once."""
    return [links.receivers] + ([] if links.transmitters is None else [links.transmitters])


@every
def test_the_jacobian_is_the_derivative_of_the_shift(links):
    clocked = DopplerLinks(
        links.receivers, links.transmitters, links.wavelength, 3.0, RNG.normal(size=(N, 2)), "drift"
    )
    x = np.concatenate([TARGETS, RNG.normal(size=(7, 4))], axis=1)
    H = doppler_jacobian(x, clocked)
    assert H.shape == (7, N, clocked.n) == (7, N, 10)
    for i in range(10):
        step = np.zeros(10)
        step[i] = h = 1e-5
        difference = (doppler_shift(x + step, clocked) - doppler_shift(x - step, clocked)) / 2 / h
        # Central differences: h^2 of third derivatives, and rounding of 1e-13 over h.
        np.testing.assert_allclose(H[..., i], difference, rtol=1e-6, atol=1e-6)


def test_radars_at_rest_are_an_array_to_the_last_bit():
    array = RadarArray(LISTENERS[:, :3], 0.0125)
    links = DopplerLinks.two_way(array.positions)
    for function in (doppler_shift, doppler_jacobian):
        np.testing.assert_array_equal(function(TARGETS, links), function(TARGETS, array))
    for likelihood in ("stationary", "constant_velocity"):
        ours, theirs = (
            fisher_information(TARGETS[0], each, 0.4, K, 0.1, likelihood) for each in (links, array)
        )
        # One adds all samples up in another order if nothing moves.
        np.testing.assert_allclose(ours, theirs, rtol=1e-14)


@every
def test_a_common_velocity_is_not_seen(links):
    more = np.array([0, 0, 0, 30.0, -20, 7])
    sender = None if links.transmitters is None else links.transmitters + more
    boosted = DopplerLinks(links.receivers + more, sender, links.wavelength)
    np.testing.assert_allclose(
        doppler_shift(TARGETS + more, boosted), doppler_shift(TARGETS, links), **ROUNDING
    )


def test_one_way_is_half_of_two_and_a_bistatic_radar_is_the_sum_of_its_legs():
    one, two, bistatic = (doppler_shift(TARGETS, links) for links in LINKS.values())
    np.testing.assert_array_equal(2 * one, two)
    other = doppler_shift(TARGETS, DopplerLinks.one_way(SENDERS, WAVES))
    np.testing.assert_allclose(bistatic, one + other, **ROUNDING)


def test_the_earth_may_turn():
    # Station and satellite in a frame that turns with the earth, and in one that does not.
    omega = np.array([0, 0, 7.2921151467e-5])
    station, satellite = [4.0e6, 1e6, 4.9e6, 0, 0, 0], [1.9e7, -5e6, 1.7e7, 900.0, 2500, -1200]

    def inertial(x):
        x = np.array(x)
        x[3:] += np.cross(omega, x[:3])
        return x

    fixed, turning = (
        doppler_shift(frame(station), DopplerLinks.one_way(frame(satellite), 0.19))
        for frame in (inertial, np.array)
    )
    # 1e3 m/s of 0.19 m, from positions of 1e7 m with sixteen digits.
    np.testing.assert_allclose(fixed, turning, rtol=1e-12)
    assert abs(turning[0]) > 1000


def test_a_platform_that_turns_moves_its_sensors_as_their_places_say():
    array = RadarArray.ring(4, 0.2)
    state, rate = [1.0, 2, 3, 4, 5, 6], [0.3, -0.2, 2.0]
    times = np.linspace(0, 1e-3, 5)
    links = DopplerLinks.on_platform(array, state, rate, times)
    places, velocities = links.receivers[..., :3], links.receivers[..., 3:]
    # A fourth-order difference over 1 ms: (rate * 1e-3)^4 of some m/s.
    slope = np.tensordot([1, -8, 0, 8, -1], places, 1) / 12 / times[1]
    np.testing.assert_allclose(velocities[2], slope, atol=1e-9)
    np.testing.assert_allclose(places[0] - state[:3], array.positions, atol=1e-15)
    straight = DopplerLinks.on_platform(array, state, times=times)
    moved = DopplerLinks.on_platform(array, state).sampled(5, times[1])
    np.testing.assert_allclose(straight.receivers, moved.receivers, rtol=1e-15)


def record(x, links, K, times):
    """Return all measurements of a record, one long vector, from all unknowns at their times."""
    target, offsets, rates = x[:6], x[6:].reshape(-1, links.clocks.shape[1]), 0
    if links.clock_model == "drift":
        offsets, rates = offsets[:1], offsets[1:]
    shifts = []
    for k in range(K):
        t = times[k] - times[0]
        b = offsets[k if len(offsets) > 1 else 0] + t * np.sum(rates, axis=0)
        p = target[:3] + t * target[3:]
        for n in range(N):
            rate = 0
            for end in ends(links.sampled(K, np.diff(times, prepend=-1.0))):
                d = end[k, n, :3] - p
                rate -= d @ (target[3:] - end[k, n, 3:]) / np.sqrt(d @ d)
            shifts.append(-rate / links.wavelength[n] + links.clocks[n] @ b)
    return np.array(shifts)


@pytest.mark.parametrize("model", ["constant", "drift", "epoch"])
@every
def test_information_is_that_of_all_unknowns_by_a_complex_step(links, model):
    C = 2
    clocks = RNG.normal(size=(N, C))
    links = DopplerLinks(links.receivers, links.transmitters, links.wavelength, 0.0, clocks, model)
    sigma = RNG.uniform(0.1, 1.0, (K, N))
    extra = C * {"constant": 1, "drift": 2, "epoch": K}[model]
    unknowns = np.concatenate([TARGETS[0], RNG.normal(size=extra)])
    H = np.empty((K * N, len(unknowns)))
    for i in range(len(unknowns)):
        stepped = unknowns.astype(complex)
        stepped[i] += 1e-100j
        H[:, i] = record(stepped, links, K, TIMES).imag / 1e-100
    full = H.T @ (H / sigma.reshape(-1, 1) ** 2)
    n = links.n
    # Clocks of later samples are eliminated: their Schur complement, and of the inverse a block.
    rest = full[n:, n:]
    expected = full[:n, :n] - full[:n, n:] @ np.linalg.solve(rest, full[n:, :n])
    J = fisher_information(
        unknowns[:n], links, sigma, K, [1.0, *np.diff(TIMES)], "constant_velocity"
    )
    scale = np.sqrt(np.outer(np.diag(J), np.diag(J)))
    np.testing.assert_allclose(J / scale, expected / scale, atol=1e-12)


def test_an_eliminated_clock_is_the_information_of_differences_between_links():
    plain = DopplerLinks.one_way(LISTENERS, WAVES, times=TIMES)
    links = replace(plain, clocks="common", clock_model="epoch")
    sigma, difference = 0.3, np.eye(N)[1:] - np.eye(N)[0]
    J = np.linalg.inv(
        np.linalg.inv(
            fisher_information([*TARGETS[0], 0.0], links, sigma, likelihood="constant_velocity")
        )[:6, :6]
    )
    x = straight(TARGETS[0])
    F = np.eye(6) + TIMES[:, None, None] * np.eye(6, k=3)
    H = difference @ (doppler_jacobian(x, plain) @ F)
    R = sigma**2 * difference @ difference.T
    expected = np.einsum("kni,nm,kmj->ij", H, np.linalg.inv(R), H)
    np.testing.assert_allclose(J, expected, rtol=1e-8)


def test_a_missing_measurement_informs_of_nothing():
    links = DopplerLinks.one_way(
        LISTENERS, WAVES, clocks="common", clock_model="epoch", times=TIMES
    )
    x = np.r_[TARGETS[0], 0]
    sigma = RNG.uniform(0.1, 1.0, (K, N))
    sigma[:, 3] = np.nan
    others = np.arange(N) != 3
    fewer = DopplerLinks.one_way(
        LISTENERS[others], WAVES[others], clocks="common", clock_model="epoch", times=TIMES
    )
    # A row of zeros may turn the order of a sum.
    np.testing.assert_allclose(
        fisher_information(x, links, sigma), fisher_information(x, fewer, sigma[:, others]), 1e-9
    )
    assert not fisher_information(x, links, np.nan).any()


def test_a_clock_that_is_known_costs_nothing():
    plain = DopplerLinks.one_way(LISTENERS, WAVES)
    clocked = replace(plain, clocks="common", clock_model="drift")
    x, K_T = np.r_[TARGETS[0], 3.0, -1.0], (50, 0.1, "constant_velocity")
    known = crlb(x, clocked, 0.4, *K_T, free=np.arange(8) < 6)
    np.testing.assert_allclose(known[:6, :6], crlb(x[:6], plain, 0.4, *K_T), rtol=1e-6)
    assert not known[6:].any()
    unknown = crlb(x, clocked, 0.4, *K_T)
    assert (np.diag(unknown)[:6] > np.diag(known)[:6]).all()


def test_an_unknown_clock_of_each_link_leaves_changes_in_time_only():
    links = DopplerLinks.two_way(LISTENERS, clocks="each")
    assert not np.isfinite(np.diag(crlb(np.r_[TARGETS[0], np.zeros(N)], links, 0.1))[:6]).any()


@pytest.mark.parametrize(("sensors", "alike"), [(1, True), (2, False)])
def test_a_wavelength_scales_with_the_scene_before_one_sensor_but_not_before_two(sensors, alike):
    scale, s = 1.1, LISTENERS[:sensors]
    links = DopplerLinks.two_way(s, 0.01, times=TIMES)
    scaled = DopplerLinks.two_way(s, 0.01 * scale, times=TIMES)
    x, other = straight(TARGETS[0]), straight(s[0] + scale * (TARGETS[0] - s[0]))
    shift = doppler_shift(x, links)
    difference = np.abs(doppler_shift(other, scaled) - shift).max()
    assert difference < 1e-10 if alike else difference > 1


def test_motion_is_that_of_the_target_and_of_integrated_clocks():
    T, sigma_clock, sigma_drift = 0.3, 2.0, 5.0
    links = DopplerLinks.one_way(LISTENERS, WAVES, clocks="common", clock_model="drift")
    F, Q = links.motion([T, 2 * T], 0.7, "per_axis", sigma_clock, sigma_drift)
    target, noise = constant_velocity(T, 0.7, "per_axis")
    np.testing.assert_array_equal(F[0], block_diag(target, [[1, T], [0, 1]]))
    np.testing.assert_array_equal(Q[0, :6, :6], noise)
    assert not Q[0, :6, 6:].any()
    # Two steps of T are one of 2 T.
    steps = (F[0] @ Q[0] @ F[0].T + Q[0])[6:, 6:]
    np.testing.assert_allclose(Q[1, 6:, 6:], steps, rtol=1e-13)
    # White noise over T, and its integral: the variance of a straight sum of many small steps.
    many = 2000
    left = T * (np.arange(many) + 0.5) / many
    rows = np.stack([left, np.ones(many)])
    expected = sigma_drift**2 * T / many * rows @ rows.T + np.diag([sigma_clock**2 * T, 0])
    np.testing.assert_allclose(Q[0, 6:, 6:], expected, rtol=1e-6)
    F, Q = DopplerLinks.one_way(LISTENERS, WAVES, clocks="each", clock_model="epoch").motion(
        T, 0.7, sigma_clock=100.0
    )
    assert not F[6:].any() and not F[:, 6:].any()
    np.testing.assert_array_equal(Q[6:, 6:], 1e4 * np.eye(N))


def test_links_may_be_cut_into_samples_and_parts():
    table = RNG.normal(size=(K, N, 6))
    bias = RNG.normal(size=(K, N))
    links = DopplerLinks(table, np.zeros(3), WAVES, bias, "common", times=TIMES)
    x = np.concatenate([TARGETS[:K], np.ones((K, 1))], axis=1) + 5
    together = doppler_shift(x, links)
    assert together.shape == (K, N)
    for k in range(K):
        np.testing.assert_array_equal(doppler_shift(x[k], links.at_sample(k)), together[k])
    part = links.at_sample(slice(1, 3))
    np.testing.assert_array_equal(doppler_shift(x[1:3], part), together[1:3])
    np.testing.assert_array_equal(part.times, TIMES[1:3])
    assert links.sampled(K) is links
    np.testing.assert_array_equal(doppler_shift(x[:1], links), doppler_shift(x[[0] * K], links))


@pytest.mark.parametrize(
    ("clocks", "matrix"),
    [
        (None, np.zeros((3, 0))),
        ("common", [[1], [1], [1]]),
        ("each", np.eye(3)),
        ([7, 2, 7], [[0, 1], [1, 0], [0, 1]]),
        ([[1, -1], [1, 0], [0.5, 2]], [[1, -1], [1, 0], [0.5, 2]]),
    ],
)
def test_clocks_are_a_matrix_of_links_by_offsets(clocks, matrix):
    links = DopplerLinks.one_way(np.eye(3), 0.1, clocks=clocks)
    np.testing.assert_array_equal(links.clocks, matrix)
    assert links.n == 6 + np.shape(matrix)[1]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"receivers": np.zeros((2, 4))}, r"receivers must have shape \(N, 3\), \(N, 6\) or with"),
        ({"receivers": np.zeros((2, 3, 6))}, r"with times \(K, N, 6\), got \(2, 3, 6\)"),
        (
            {"receivers": np.zeros((2, 3, 6)), "times": [0, 1, 2]},
            r"or \(3, N, 6\), got \(2, 3",
        ),
        ({"transmitters": np.zeros((3, 6))}, "receivers, transmitters must have leading axes"),
        ({"wavelength": [1, 2, 3]}, "wavelength must have leading axes that broadcast"),
        ({"wavelength": 0}, "wavelength must be positive"),
        ({"bias": np.nan}, "bias must be finite"),
        ({"clocks": "all"}, "clocks must be one of 'common', 'each'"),
        ({"clocks": [0, 0.5]}, "clocks must be 2 whole numbers or have shape"),
        ({"clocks": [0, 1, 2]}, r"2 whole numbers or have shape \(2, C\), got \(3,\)"),
        ({"clock_model": "white"}, "clock_model must be one of 'constant', 'drift', 'epoch'"),
        ({"times": [0, 1, 1]}, "times must increase"),
    ],
)
def test_what_is_no_link_is_refused(change, message):
    with pytest.raises(ValueError, match=message):
        DopplerLinks(**{"receivers": np.eye(6)[:2], "transmitters": None} | change)


def test_functions_that_take_links_say_what_does_not_fit():
    links = DopplerLinks.two_way(LISTENERS, clocks="common", times=TIMES)
    with pytest.raises(ValueError, match=r"x must have shape \(\.\.\., 7\)"):
        doppler_shift(TARGETS[0], links)
    with pytest.raises(ValueError, match=r"x must have shape \(\.\.\., 4, 7\), a state for each"):
        doppler_shift(np.ones(7), links)
    with pytest.raises(ValueError, match="K must be the number of times of the links, 4, got 5"):
        fisher_information(np.ones(7), links, 0.1, 5)
    with pytest.raises(ValueError, match=r"T must have shape \(3,\)"):
        sample_times(RadarArray([[0, 0, 0]]), 3, np.ones(2))
    on_it = np.r_[links.receivers[2, 3], 0][None]
    with pytest.raises(ValueError, match=r"x must not lie on a sensor, got .* sensor 3"):
        doppler_shift(on_it, links)
    with pytest.raises(ValueError, match="array must be a RadarArray or a DopplerLinks"):
        doppler_shift(TARGETS, LISTENERS)
    with pytest.raises(ValueError, match="k must be a slice or a sample below 4, got 4"):
        links.at_sample(4)
    with pytest.raises(ValueError, match="times must be given"):
        DopplerLinks.on_platform(RadarArray([[0, 0, 0]]), np.zeros(6), [0, 0, 1])
