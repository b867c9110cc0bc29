"""Valid calls that no docstring can show, since they need files: made in a folder of their own."""

import atexit
import functools
import os
import shutil
import tempfile
from pathlib import Path

import numpy as np

from dopplerlib import Scenario
from dopplerlib.replication.claims import read_claims
from dopplerlib.replication.deviations import read_deviations
from dopplerlib.replication.published import read_published
from dopplerlib.signal.recording import Recording, read_sigmf, read_wav, write_sigmf, write_wav
from dopplerlib.systems.mittermaier2016 import write_simulated_iq

RNG = np.random.default_rng(1)
RECORDING = Recording(
    RNG.normal(size=(2, 50)) / 4 + 0.2j * RNG.normal(size=(2, 50)), fs=1000.0, carrier=24e9
)
SCENARIO = """\
[array]
shape = "ring"
n = 6
radius = 0.2
phase = 0.0
wavelength = 0.0125
[target]
x0 = [0.833, 0.111, 0.092, -0.750, -0.125, -0.018]
[sampling]
T = 0.001
samples = 101
sigma_f = 0.4
[tracker]
sigma_a = 0.4
P0_diagonal = [0.1, 0.1, 0.1, 0.1, 0.1, 0.1]
"""
CLAIMS = """\
[[claim]]
id = "peak"
where = "Fig 2"
statement = "The peak lies at 5 Hz."
form = "number"
published = [5.0, 6.0]
unit = "Hz"
rounding = 0.5
verdict = "reproduced"
page = "iq"
cell = "peak"
test = "tests/a.py::test_a"
keys = ["5 Hz"]
[[claim]]
id = "below"
where = "Fig 3"
statement = "The error stays below 1 m."
form = "relation"
relation = "<"
published = 1.0
verdict = "contradicted"
note = "It does not."
page = "iq"
cell = "error"
test = "tests/a.py::test_b"
keys = ["1 m"]
"""
DEVIATIONS = """\
[[deviation]]
id = "wavelength"
where = "Section 2"
kind = "gap"
document = "It is not told."
choice = "0.0125 m."
page = "geometry"
cell = "sensitivity"
claims = ["peak"]
[[deviation]]
id = "letters"
where = "Eq 11"
kind = "misprint"
document = "A hat is missing."
choice = "It is there."
page = "ekf"
cell = "table1"
"""
PUBLISHED = """\
where = "Section 4"
T = 0.1
[filter]
where = "ours: not stated"
windows = [8, 12]
boxes = [[0.0, -1.0], [2.0, 1.0]]
[[path]]
title = "away"
start = [0.0, 5.0]
"""


@functools.cache
def folder():
    """Return a folder with valid files and a FIFO; relative paths lead into it as well."""
    folder = Path(tempfile.mkdtemp(prefix="fuzz-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    write_sigmf(folder / "walk", RECORDING)
    write_wav(folder / "walk.wav", RECORDING)
    for name, text in (
        ("scenario", SCENARIO),
        ("claims", CLAIMS),
        ("deviations", DEVIATIONS),
        ("published", PUBLISHED),
    ):
        (folder / f"{name}.toml").write_text(text, encoding="utf-8")
    (folder / "other").write_text("something else", encoding="utf-8")
    os.mkfifo(folder / "fifo")
    return folder


@functools.cache
def calls():
    """Return {function: a valid call}."""
    here = folder()
    return {
        Scenario.from_toml: {"path": here / "scenario.toml"},
        read_claims: {"path": here / "claims.toml"},
        read_deviations: {"path": here / "deviations.toml"},
        read_published: {"path": here / "published.toml"},
        read_sigmf: {"paths": here / "walk.sigmf-meta"},
        read_wav: {"paths": here / "walk.wav", "carrier": 24e9},
        write_sigmf: {"path": here / "new", "recording": RECORDING},
        write_simulated_iq: {"folder": here},
        write_wav: {"path": here / "new.wav", "recording": RECORDING},
    }
