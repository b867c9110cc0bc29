"""Time of one sample by itself, beside FilterPy; and a loop at 1 kHz that decides when to stop.

``make bench NAME=online`` prints Markdown. Rounds are interleaved; the first does not count. The
filters agree to 1e-8 before any time is taken. The loop at 1 kHz is an example, too: `live`.
``python benchmarks/online.py live`` runs that alone.
"""

import sys
import time

import numpy as np
import peers
from filterpy.kalman import ExtendedKalmanFilter
from measuring import AGREEMENT, SCENARIO, interleaved, load, progress, spread

from dopplerlib import (
    Scenario,
    constant_velocity,
    doppler_jacobian,
    doppler_shift,
    ekf,
    ekf_online,
    ekf_records_online,
    simulate,
    ukf_online,
)
from dopplerlib.chain.alarm import stop_alarm_online

SECONDS = 10
EARLY = 2e-4  # that the loop wakes up before an arrival, in s
POINT, TOO_NEAR = [0, 0, 0], 0.3  # of the machine that stops, in m


def main():
    scenario = Scenario.from_toml(SCENARIO)
    rng = np.random.default_rng(2016)
    x0 = scenario.x0 + rng.multivariate_normal(np.zeros(6), scenario.P0 / 100)
    z = simulate(scenario, 1, rng=rng)[1][0]
    print(f"Load of the machine (1, 5, 15 minutes): {load()}.\n")
    if "live" not in sys.argv:
        one_sample(scenario, x0, z)
    live(scenario)
    print(f"Load at the end: {load()}.")


def one_sample(s, x0, z):
    """Print the time of a sample, with each filter going on from sample to sample."""
    motion, Q = constant_velocity(s.T, s.sigma_a)
    R = s.sigma_f**2 * np.eye(len(s.array))
    setting = s.array, x0, s.P0, s.T, s.sigma_a, s.sigma_f
    functions = (lambda x: x @ motion.T), (lambda x: doppler_shift(x, s.array))
    jacobians = (lambda x: motion), (lambda x: doppler_jacobian(x, s.array))

    def filterpy():
        sensors = s.array.positions, s.array.doppler_per_speed
        filter_ = ExtendedKalmanFilter(6, len(s.array))
        filter_.x, filter_.P, filter_.F, filter_.Q, filter_.R = x0.copy(), s.P0, motion, Q, R

        def update(sample):
            filter_.predict()
            filter_.update(sample, peers.jacobian, peers.shift, args=sensors, hx_args=sensors)
            return filter_

        return update

    makers = {
        "`ekf_online`, gate": lambda: ekf_online(*setting, gate="upper"),
        "`ekf_online`, gate, `keep=()`": lambda: ekf_online(*setting, gate="upper", keep=()),
        "`ekf` of one sample, gate": lambda: lambda sample: ekf(sample[None], *setting, "shared",
                                                                 "upper"),
        "FilterPy": filterpy,
        "`ekf_records_online`": lambda: ekf_records_online(
            functions[0], jacobians[0], Q, functions[1], jacobians[1], R, x0, s.P0
        ),
        "`ukf_online`": lambda: ukf_online(functions[0], Q, functions[1], R, x0, s.P0),
    }  # fmt: skip
    agree(z, ekf(z, *setting), filterpy())
    updates = {name: make() for name, make in makers.items()}
    samples = list(z[:200])

    def all_samples(update):
        for sample in samples:
            update(sample)

    clocks = {
        name: ((lambda update=update: all_samples(update)), 1) for name, update in updates.items()
    }
    times = interleaved("one sample", clocks, time.process_time)
    print("| | µs a sample, processor time | ÷ `ekf_online`, gate |\n|---|---|---|")
    for name, seconds in times.items():
        ratio = spread(seconds / times["`ekf_online`, gate"])
        print(f"| {name} | {spread(seconds / len(samples) * 1e6)} | {ratio} |")
    print()


def agree(z, track, update):
    """Stop if FilterPy differs from `track`."""
    for k, sample in enumerate(z):
        found = update(sample)
        difference = max(np.abs(found.x - track.x[k]).max(), np.abs(found.P - track.P[k]).max())
        if not difference < AGREEMENT:
            sys.exit(f"FilterPy differs by {difference:.1e} at sample {k}")


def live(s):
    """Filter and decide at 1 kHz for some seconds, and print how long each sample takes.

    The time of a sample is that from its arrival to the decision. Arrivals are those of a clock
    on which the loop waits. What other programs take of the processor counts: a machine that has
    to stop runs this with a priority of its own (on Linux `chrt --fifo 1`), on a processor of its
    own.
    """
    progress(f"{SECONDS} s at 1 kHz")
    count = round(SECONDS / s.T)
    path = s.x0 + np.zeros((count, 6))
    # To and fro before the ring, so that the target stays in sight all the time.
    path[:, 0] = 0.6 + 0.3 * np.cos(np.arange(count) * s.T)
    path[:, 3:] = np.gradient(path[:, :3], s.T, axis=0)
    noise = np.random.default_rng(1).standard_normal((count, len(s.array)))
    z = doppler_shift(path, s.array) + s.sigma_f * noise
    update = ekf_online(s.array, path[0], s.P0 / 100, s.T, s.sigma_a, s.sigma_f, gate="upper")
    decide = stop_alarm_online(POINT, TOO_NEAR)
    latency, alarms = np.empty(count), 0
    for _ in range(100):  # compiled, and warm
        decide(update(np.full(len(s.array), np.nan)))
    begin = time.perf_counter() + 0.01
    for k, sample in enumerate(z):
        arrival = begin + k * s.T
        time.sleep(max(0.0, arrival - time.perf_counter() - EARLY))
        while time.perf_counter() < arrival:
            pass
        alarms += decide(update(sample)).alarm
        latency[k] = time.perf_counter() - arrival
    median, rare = np.quantile(latency, [0.5, 0.999]) * 1e6
    print(
        f"{count} samples at {1 / s.T:.0f} Hz, filter and decision, from arrival: median "
        f"{median:.1f} µs, 99.9 % {rare:.0f} µs, most {latency.max() * 1e6:.0f} µs; "
        f"{np.mean(latency > s.T):.2%} later than the next sample; alarms at {alarms}.\n"
    )


if __name__ == "__main__":
    main()
