"""A recording of six modules that never existed: IQ samples of Table 2's target, with its truth.

The files ``results/simulated_recording.*`` are what `write_simulated_iq` writes.
"""

import os
from contextlib import nullcontext
from os import PathLike
from pathlib import Path

import numpy as np

from ..._data import on_disk, results
from ..._files import write_text
from ..._hints import checked
from ..._typing import FloatArray
from ...chain.baseband import Baseband
from ...chain.simulation import simulate_baseband
from ...signal.recording import Recording, read_sigmf, write_sigmf
from .published import reported

# Everything that the recording depends on, beside the scenario.
SIMULATED = {"seed": 20160907, "fs": 2000.0, "snr_db": 27.0, "amplitude": 0.4, "truth_step": 0.02}
_NAME = "simulated_recording"
_FILES = f"{_NAME}.sigmf-meta", f"{_NAME}.sigmf-data", f"{_NAME}.truth.csv"
_HEAD = "time_s,x_m,y_m,z_m,vx_m_s,vy_m_s,vz_m_s"


def simulated_recording() -> tuple[Recording, FloatArray, FloatArray]:
    """Simulate the recording from its seed.

    Returns recording: Six channels of one second, with the modules' faults in them
        (`MODULE_FAULTS`).
        time (K,): Times in s from the first sample.
        truth (K, 6): True states there.
    """
    s = reported().scenario
    rng = np.random.default_rng(SIMULATED["seed"])
    iq = simulate_baseband(s, 1, rng=rng, fs=SIMULATED["fs"], snr_db=SIMULATED["snr_db"], factor=1)
    carrier = 299_792_458.0 / s.array.wavelength
    time = np.arange(round(s.time[-1] / SIMULATED["truth_step"]) + 1) * SIMULATED["truth_step"]
    truth = np.tile(s.x0, (len(time), 1))
    truth[:, :3] += time[:, None] * s.x0[3:]
    return Recording(SIMULATED["amplitude"] * iq.x[0], SIMULATED["fs"], carrier), time, truth


@checked
def write_simulated_iq(folder: str | PathLike[str]) -> list[Path]:
    """Write the recording as SigMF and its truth as CSV.

    folder: Where to write ``simulated_recording.sigmf-meta``, ``simulated_recording.sigmf-data``
        and ``simulated_recording.truth.csv``. Older ones are replaced.
    Returns: The three files.
    Raises ValueError if `folder` is none that exists.
    """
    if not os.path.isdir(folder):
        raise ValueError(f"folder must be a folder that exists, got {str(folder)!r}")
    folder = Path(folder)
    recording, time, truth = simulated_recording()
    description = (
        "Simulated, not measured: six CW modules on a ring and the target of Table 2 of "
        "doi:10.5194/ars-14-39-2016. See README.md."
    )
    meta = write_sigmf(folder / _NAME, recording, "int16", description)
    rows = np.column_stack([time, truth])
    lines = [_HEAD, *(",".join(f"{value:.6f}" for value in row) for row in rows)]
    _, data, table = (folder / name for name in _FILES)
    write_text(table, "\n".join(lines) + "\n")
    return [meta, data, table]


@checked
def read_simulated_iq(
    folder: str | PathLike[str] | None = None,
) -> tuple[Baseband, FloatArray, FloatArray]:
    """Read the recording and its truth.

    folder: Where the three files are; those that come with the library if None.
    Returns iq: Samples with the leading axis ``runs`` of length 1, as `track_iq` takes them.
        time (K,): Times in s from the first sample.
        truth (K, 6): True states there.
    Raises ValueError if the recording is not sound, or its wavelength is not that of the scenario.
    """
    shipped = on_disk(results(), *_FILES)
    with shipped if folder is None else nullcontext(Path(folder)) as folder:
        meta, _, table = (folder / name for name in _FILES)
        recording = read_sigmf(meta)
        rows = np.genfromtxt(table, delimiter=",", skip_header=1)
    array = reported().scenario.array
    if not np.isclose(recording.wavelength, array.wavelength, rtol=1e-6):
        raise ValueError(
            f"the recording must have the wavelength {array.wavelength} m, "
            f"got {recording.wavelength}"
        )
    iq = Baseband(recording.x[None], recording.fs, array, valid=recording.valid[None])
    return iq, rows[:, 0], rows[:, 1:]
