"""A broken file is refused by its name, or read as what it could be; nothing else happens."""

import json
import os
import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from dopplerlib import RadarArray, Scenario
from dopplerlib.chain.setup import EXAMPLE, Setup
from dopplerlib.replication.claims import RELATIONS, read_claims
from dopplerlib.replication.deviations import read_deviations
from dopplerlib.replication.published import Published, read_published
from dopplerlib.signal.recording import read_sigmf, read_wav
from tests.fuzz import valid_files
from tests.fuzz.mutations import bytes_of, json_of, toml_of
from tests.fuzz.oracle import limited
from tests.fuzz.run import bounded_memory
from tests.fuzz.valid_files import CLAIMS, DEVIATIONS, PUBLISHED, SCENARIO


@pytest.fixture(scope="module")
def valid():
    """Return {name of a file: its bytes} of valid ones, written by the library itself."""
    return {path.name: path.read_bytes() for path in valid_files.folder().glob("walk*")}


def read(reader, files, name):
    """Write `files`, read the one called `name`, and return the result, None if it is refused."""
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        for each, data in files.items():
            (folder / each).write_bytes(data)
        handles = os.listdir("/proc/self/fd")
        result = None
        try:
            with limited(20), bounded_memory():
                result = reader(folder / name)
        except ValueError as error:
            # Either of a pair may be named, and what stands in a file may be quoted.
            assert name.partition(".")[0] in str(error), f"no name of the file: {error}"
        assert {path.name: path.read_bytes() for path in folder.iterdir()} == files
        assert len(os.listdir("/proc/self/fd")) == len(handles)
        return result


def sound(recording):
    """Return whether a recording is one that a file could hold."""
    return (
        recording.x.ndim == 2
        and recording.x.size > 0
        and np.isfinite(recording.x[recording.valid]).all()
        and 0 < recording.fs < np.inf
        and 0 < recording.carrier < np.inf
    )


def many(examples, strategy):
    """Try `examples` files that `strategy` makes; broken files are larger than other arguments."""

    def decorate(test):
        options = settings(max_examples=examples, suppress_health_check=list(HealthCheck))
        return options(given(strategy)(test))

    return decorate


@many(220, st.data())
def test_metadata_of_sigmf(valid, data):
    text = valid["walk.sigmf-meta"]
    broken = data.draw(json_of(text.decode()) | bytes_of(text))
    recording = read(read_sigmf, valid | {"walk.sigmf-meta": broken}, "walk.sigmf-meta")
    assert recording is None or sound(recording)


@many(160, st.data())
def test_samples_of_sigmf_have_a_hash(valid, data):
    samples = valid["walk.sigmf-data"]
    broken = data.draw(bytes_of(samples))
    recording = read(read_sigmf, valid | {"walk.sigmf-data": broken}, "walk.sigmf-meta")
    assert broken == samples or recording is None


@many(250, st.data())
def test_wav(valid, data):
    broken = data.draw(bytes_of(valid["walk.wav"][:120]))
    broken += valid["walk.wav"][120 : data.draw(st.sampled_from((None, None, 200, 131)))]
    recording = read(lambda path: read_wav(path, 24e9), {"walk.wav": broken}, "walk.wav")
    assert recording is None or sound(recording)


@many(130, toml_of(SCENARIO) | bytes_of(SCENARIO.encode()))
def test_scenario(broken):
    scenario = read(Scenario.from_toml, {"scenario.toml": broken}, "scenario.toml")
    assert scenario is None or isinstance(scenario.array, RadarArray)


@many(130, toml_of(EXAMPLE) | bytes_of(EXAMPLE.encode()))
def test_setup(broken):
    setup = read(Setup.from_toml, {"room.toml": broken}, "room.toml")
    assert setup is None or isinstance(setup.array, RadarArray)


@many(130, toml_of(CLAIMS) | bytes_of(CLAIMS.encode()))
def test_claims(broken):
    for claim in read(read_claims, {"claims.toml": broken}, "claims.toml") or ():
        texts = (claim.id, claim.where, claim.statement, claim.unit, claim.page, claim.cell)
        assert all(isinstance(text, str) for text in (*texts, claim.test, claim.note))
        assert claim.relation in (None, *RELATIONS)
        assert 0 <= claim.rounding < np.inf
        if claim.published is not None:
            published = np.array(claim.published)
            assert published.dtype.kind in "if"
            assert np.isfinite(published).all()


@many(110, toml_of(DEVIATIONS) | bytes_of(DEVIATIONS.encode()))
def test_deviations(broken):
    deviations = read(read_deviations, {"deviations.toml": broken}, "deviations.toml")
    for entry in deviations.entries if deviations else ():
        texts = (entry.id, entry.where, entry.document, entry.choice, entry.page, entry.cell)
        assert all(isinstance(text, str) for text in (*texts, *entry.claims))


@many(110, toml_of(PUBLISHED) | bytes_of(PUBLISHED.encode()))
def test_published(broken):
    found = read(read_published, {"published.toml": broken}, "published.toml")
    for table in [found, *(found.table.values() if found else ())]:
        assert not isinstance(table, Published) or table.where


def test_what_is_broken_was_sound(valid):
    """The files that the others break are read when they are whole."""
    assert sound(read(read_sigmf, valid, "walk.sigmf-meta"))
    assert sound(read(lambda path: read_wav(path, 24e9), valid, "walk.wav"))
    assert json.loads(valid["walk.sigmf-meta"])["global"]
    for reader, text in (
        (read_claims, CLAIMS),
        (read_deviations, DEVIATIONS),
        (read_published, PUBLISHED),
    ):
        assert read(reader, {"a.toml": text.encode()}, "a.toml")
    assert read(Scenario.from_toml, {"a.toml": SCENARIO.encode()}, "a.toml").samples == 101
    assert read(Setup.from_toml, {"a.toml": EXAMPLE.encode()}, "a.toml").factor == 4
