"""Derive the formulas and print them: kernels, C99 of the firmware, JavaScript of the book."""

import textwrap
from pathlib import Path

import numpy as np
from scipy.special import ndtri

from dopplerlib._files import write_text
from dopplerlib.derive import __main__ as derive
from dopplerlib.derive.firmware import firmware_sources
from dopplerlib.estimation.extended_kalman import gate_bounds
from dopplerlib.systems.mittermaier2016 import reported
from tools import explorables
from tools.command import parser, start

FIRMWARE = Path(__file__).resolve().parents[1] / "firmware"
_NOISE = {
    "shared": "DOPPLER_SHARED",
    "horizontal": "DOPPLER_HORIZONTAL",
    "per_axis": "DOPPLER_PER_AXIS",
}
_SETTING = """\
/* Setting of main.c: {title}.
 *
 * Printed by tools/kernels.py: change it there, or in a copy of your own.
 */
#define SENSORS {sensors}
#define INTERVAL {interval} /* before the first sample, in s */

#define R(number) ((doppler_real)(number))

{arrays}
static const doppler_setting SETTING = {{
    SENSORS, POSITIONS, VARIANCE,
    R({doppler_per_speed}), /* 2 / wavelength */
    R({sigma_a}), /* sigma_a */
    {noise},
    {bounds},
    {point}, /* the point that the target must not come near */
    R({distance}), /* nearer than that, in m */
    R({quantile}) /* with a probability of {probability} */
}};
"""


def firmware_setting(
    scenario, x0, *, title, point, distance, probability=1e-3, gate="two-sided", noise="shared"
):
    """Return the text of ``setting.h`` for a Scenario.

    x0 (6,): State one interval before the first sample.
    point (3,), distance, probability: See `stop_alarm`.
    gate, noise: See `ekf`.
    """
    n = len(scenario.array)
    largest = float(np.finfo(np.float32).max)  # no limit, in both precisions
    arrays = {
        "POSITIONS": ("of the sensors in m: x, y, z", scenario.array.positions),
        "VARIANCE": ("of the shifts in Hz^2", np.full((1, n), scenario.sigma_f**2)),
        "START": ("state one interval before the first sample", np.reshape(x0, (1, 6))),
        "START_COVARIANCE": ("its covariance", scenario.P0),
    }
    if gate:
        lower, upper = (bound.clip(-largest, largest)[None] for bound in gate_bounds(gate, n))
        arrays["LOWER"] = f"of the gate, {gate}, for 0 to {n} sensors", lower
        arrays["UPPER"] = "and above", upper
    text = ""
    for name, (comment, rows) in arrays.items():
        lines = ",\n".join(
            textwrap.fill(_numbers(row), 79, initial_indent="    ", subsequent_indent="    ")
            for row in rows
        )
        text += f"/* {comment} */\nstatic const doppler_real {name}[] = {{\n{lines}\n}};\n"
    return _SETTING.format(
        title=title, sensors=n, interval=float(scenario.T), arrays=text, noise=_NOISE[noise],
        bounds="LOWER, UPPER" if gate else "0, 0",
        doppler_per_speed=scenario.array.doppler_per_speed, sigma_a=scenario.sigma_a,
        point=f"{{{_numbers(point)}}}", distance=distance, probability=probability,
        quantile=float(ndtri(probability)),
    )  # fmt: skip


def _numbers(row):
    return ", ".join(f"R({float(number)!r})" for number in row)


def firmware_files():
    """Return {file name: text} of what is printed for the firmware.

    Its setting is that of Fig 6 of Mittermaier et al. (2016). The alarm is ours.
    """
    scenario, start_at = reported().scenario, reported().table2.x_ml
    before = start_at - scenario.T * np.concatenate([start_at[3:], np.zeros(3)])
    setting = firmware_setting(
        scenario, before, point=(0, 0, 0), distance=0.25,
        title="Fig 6 of Mittermaier et al. (2016), with an alarm of ours",
    )  # fmt: skip
    return firmware_sources() | {"setting.h": setting}


def main(argv=None):
    """Write kernels, firmware and what the explorables compute with."""
    parser(__doc__).parse_args(argv)
    derive.main()
    for name, text in firmware_files().items():
        write_text(FIRMWARE / name, text)
        print(f"firmware/{name}")
    write_text(explorables.FOLDER / explorables.KERNELS, explorables.kernels())
    print(f"book/_explorables/{explorables.KERNELS}")


if __name__ == "__main__":
    start(main)
