"""A scenario file says what it says, all of it, or is refused."""

import json
import re
import tomllib
from dataclasses import FrozenInstanceError, replace
from pathlib import Path

import numpy as np
import pytest

from dopplerlib import RadarArray, Scenario, constant_velocity

DATA = Path(__file__).resolve().parents[2] / "data" / "mittermaier2016"
SHIPPED = DATA / "scenario.toml"


@pytest.fixture
def scenario():
    return Scenario.from_toml(SHIPPED)


@pytest.fixture
def load(tmp_path):
    """Return a function that loads a changed copy of the shipped file."""

    def load(old, new):
        text = SHIPPED.read_text(encoding="utf-8")
        assert text.count(old) == 1, f"{old!r} must be there once"
        path = tmp_path / "changed.toml"
        path.write_text(text.replace(old, new), encoding="utf-8")
        return Scenario.from_toml(path)

    return load


def test_the_shipped_scenario_has_the_numbers_of_the_paper(scenario):
    """They were typed a second time for table2.toml, or read off Fig 6."""
    printed = tomllib.loads((DATA / "table2.toml").read_text(encoding="utf-8"))
    quoted = printed["quoted"]
    assert scenario.x0.tolist() == printed["table2"]["x0"]
    assert scenario.sigma_f == quoted["sigma_f_hz"]
    assert scenario.sigma_a == quoted["sigma_p_m_s2"]
    assert scenario.T == quoted["sampling_interval_s"]
    assert quoted["P0"].startswith("0.1*I6")
    assert scenario.P0.tolist() == (0.1 * np.eye(6)).tolist()
    assert len(scenario.array) == quoted["sensor_count"]
    assert quoted["wavelength_note"].startswith(f"{scenario.array.doppler_per_speed:g} Hz")
    assert scenario.samples == printed["derived_checks"]["nis_count"]
    assert scenario.time[-1] == pytest.approx(quoted["duration_s"], rel=1e-15)


def test_the_shipped_ring_is_the_one_drawn_in_figure_6(scenario):
    drawn = json.loads((DATA / "fig6_geometry.json").read_text(encoding="utf-8"))["sensors"]
    # The file rounds to five decimals; the markers stand on a grid of 4.2 mm, two cells at most.
    np.testing.assert_allclose(scenario.array.positions, drawn["ideal_xyz_m"], atol=5e-6)
    np.testing.assert_allclose(scenario.array.positions[:, 1:], drawn["measured_yz_m"], atol=8.4e-3)


def test_the_truth_is_a_straight_path_from_the_start(scenario):
    F, _ = constant_velocity(scenario.T, 1.0)
    assert scenario.truth.shape == (scenario.samples, 6)
    assert scenario.time[0] == 0
    for k in (0, 1, 500, 1000):
        assert scenario.time[k] == pytest.approx(k * scenario.T, rel=1e-15)
        expected = np.linalg.matrix_power(F, k) @ scenario.x0
        np.testing.assert_allclose(scenario.truth[k], expected, rtol=1e-13)


def test_a_scenario_cannot_be_changed_once_it_is_made(scenario):
    mine = scenario.x0.copy()
    other = replace(scenario, x0=mine)
    mine[0] = 7
    assert other.x0[0] == scenario.x0[0]
    for array in (scenario.x0, scenario.P0):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1
    with pytest.raises(FrozenInstanceError):
        scenario.T = 1.0
    scenario.truth[0] = 7  # a fresh copy each time
    assert (scenario.truth[0] == scenario.x0).all()


@pytest.mark.parametrize("path", [SHIPPED, str(SHIPPED)])
def test_a_path_may_be_text(path):
    assert Scenario.from_toml(path).samples == 1001


RING = """shape = "ring"
n = 6
radius = 0.2
phase = 0.0 # first sensor on +y: not stated; drawn so in Fig 6, within 0.3 degrees
normal = "x"
wavelength = 0.0125"""


@pytest.mark.parametrize(
    ("table", "array"),
    [
        ('shape = "ring"\nn = 3\nradius = 0.1', RadarArray.ring(3, 0.1)),
        (
            'shape = "ring"\nn = 3\nradius = 0.1\nphase = 1\nnormal = "z"\nwavelength = 0.01',
            RadarArray.ring(3, 0.1, 1.0, "z", 0.01),
        ),
        ('shape = "linear"\nn = 5\nlength = 0.4', RadarArray.linear(5, 0.4)),
        ('shape = "linear"\nn = 2\nlength = 1\naxis = "z"', RadarArray.linear(2, 1, "z")),
        (
            'shape = "positions"\npositions = [[0, 0, 0], [0.1, 0, 0]]\nwavelength = 0.01',
            RadarArray([[0, 0, 0], [0.1, 0, 0]], 0.01),
        ),
    ],
)
def test_every_shape_of_array_can_be_described(load, table, array):
    assert load(RING, table).array == array


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        # missing, misspelt, unknown
        ("radius = 0.2\n", "", r"\[array\] must have radius, got only"),
        ("radius =", "radus =", r"\[array\] must have radius, got only n, radus"),
        ("phase =", "fase =", r"\[array\] must have nothing but n, radius, phase, .*got fase"),
        ('shape = "ring"\n', "", r"\[array\] must have shape, got only n"),
        ('"ring"', '"disc"', r"shape in \[array\] must be one of 'ring', .* got 'disc'"),
        ("[target]", "[taget]", "the file must have target, got only array, taget"),
        ("[target]", "[gate]\n[target]", "the file must have nothing but array, .*, got gate"),
        ("[array]", "seed = 1\n[array]", "the file must have nothing but array, .*, got seed"),
        ("x0 =", "x_0 =", r"\[target\] must have x0, got only x_0"),
        ("sigma_f =", "sigma_F =", r"\[sampling\] must have sigma_f, got only T, samples, sigma_F"),
        ("sigma_f =", "jitter = 1\nsigma_f =", r"\[sampling\] must have nothing but .*got jitter"),
        ("sigma_a =", "gate = 'upper'\nsigma_a =", r"\[tracker\] must have nothing but .*got gate"),
        # a wrong value
        ("T = 0.001", 'T = "fast"', "T must be an array of real numbers, got 'fast'"),
        ("T = 0.001", 'T = "0.001"', "T must be an array of real numbers, got '0.001'"),
        ("T = 0.001", "T = true", "T must be an array of real numbers, got True"),
        ("T = 0.001", "T = 2020-01-01", "T must be an array of real numbers, got"),
        ("T = 0.001", "T = -0.001", "T must be positive, got -0.001"),
        ("T = 0.001", "T = nan", "T must be finite, got nan"),
        ("T = 0.001", "T = [0.001, 0.002]", "T must be one number"),
        ("T = 0.001", "T = {}", "T must be an array of real numbers, got {}"),
        ("samples = 1001", "samples = 1001.0", "samples must be a whole number .*got 1001.0"),
        ("samples = 1001", "samples = 0", "samples must be a whole number of at least 1, got 0"),
        ("n = 6", 'n = "six"', "n must be a whole number of at least 1, got 'six'"),
        ("radius = 0.2", "radius = 0", "radius must be positive, got 0"),
        ('normal = "x"', 'normal = "w"', "normal must be one of 'x', 'y', 'z', got 'w'"),
        ("-0.018]", "]", r"x0 must have shape \(\.\.\., 6\), got \(5,\)"),
        ("[0.833, 0.111, 0.092", "[0, 0.2, 0", "x0 must not lie on a sensor"),
        ("[0.1, 0.1", "[0.1", r"P0_diagonal must have shape \(\.\.\., 6\), got \(5,\)"),
        ("[0.1, 0.1", "[0.1, 0.0", "P0_diagonal must be positive, got 0.0"),
        # no tables, no TOML
        ("[tracker]", "[sampling.tracker]", "the file must have tracker"),
        ("[target]", "[[target]]", r"\[target\] must be a table, got \[{"),
        ("[array]", "[[array]]", r"\[array\] must be a table, got \[{"),
        ("[array]", "[array", "line 4"),
    ],
)
def test_a_file_with_something_wrong_is_refused_by_file_and_entry(load, old, new, message):
    with pytest.raises(ValueError, match=rf"(?s)^\S*changed\.toml: .*{message}"):
        load(old, new)


def test_a_file_that_is_no_text_is_refused_by_name(tmp_path):
    path = tmp_path / "picture.toml"
    path.write_bytes(b"\x89PNG")
    with pytest.raises(ValueError, match=f"^{re.escape(str(path))}: .*utf-8"):
        Scenario.from_toml(path)


def test_a_file_that_does_not_exist_is_said_not_to_exist(tmp_path):
    with pytest.raises(ValueError, match=r"path must be a file that exists, got '.*nowhere\.toml'"):
        Scenario.from_toml(tmp_path / "nowhere.toml")


@pytest.mark.parametrize(
    ("field", "value", "message"),
    [
        ("x0", np.ones((1, 6)), r"x0 must have shape \(6,\), got \(1, 6\)"),
        ("P0", np.zeros((6, 6)), "P0 must be positive definite"),
        ("P0", np.eye(6) + np.eye(6, k=1) / 4, "P0 must be symmetric"),
        ("P0", np.stack([np.eye(6)] * 2), r"P0 must have shape \(6, 6\), got \(2, 6, 6\)"),
        ("sigma_f", [0.4, 0.4], "sigma_f must be one number"),
        ("sigma_a", 0.0, "sigma_a must be positive, got 0"),
        ("samples", True, "samples must be a whole number"),
        ("array", [[0, 0, 0]], r"array must be a RadarArray, got \[\[0, 0, 0\]\]"),
    ],
)
def test_a_scenario_made_by_hand_is_held_to_the_same(scenario, field, value, message):
    with pytest.raises(ValueError, match=message):
        replace(scenario, **{field: value})
