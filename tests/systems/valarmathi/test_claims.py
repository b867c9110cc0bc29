"""Every statement of the document has its claim, and the choices are those that were computed."""

from dopplerlib.replication.documents import read_document
from dopplerlib.systems.valarmathi import fusion_sweep, reported

DOCUMENT = read_document("valarmathi")


def test_every_statement_of_abstract_results_and_conclusion_is_there():
    names = {claim.id for claim in DOCUMENT.claims}
    abstract = {"low-snr", "adaptive-maneuver", "fusion-maneuver", "kalman-fails", "cost"}
    results = {
        "fusion-delay",
        "fusion-every-snr",
        "constant",
        "limit-fused",
        "limit-single",
        "paths",
    }
    conclusion = {"fusion-fast", "smoothing", "trade-off", "adaptive-delay", "same", "fighter"}
    windows = {"window-acceleration", "window-snr", "window-short", "window-long"}
    windows |= {"window-linear", "window-interpolation", "quantization", "padding", "redundancy"}
    assert abstract | results | conclusion | windows <= names


def test_the_sweep_was_made_for_every_value_of_the_choices():
    fixed, grid, sensors, snr, q, path, gentle, low = DOCUMENT.choice(
        "fixed", "grid", "sensors", "snr", "q", "path", "gentle", "low-snr"
    )
    assert fixed.values + fixed.beyond == fusion_sweep.WINDOWS
    assert grid.values == tuple(fusion_sweep.GRIDS)
    assert sensors.values == fusion_sweep.SENSORS
    assert q.values == fusion_sweep.INTENSITIES
    assert {*snr.values, *low.values} == set(fusion_sweep.SNRS_DB)
    assert set(path.values) <= set(fusion_sweep.PATHS)
    assert {f"path 1, {a} m/s²" for a in gentle.values} < set(fusion_sweep.PATHS)


def test_the_intensity_of_the_jerk_follows_its_rule():
    """The modeled acceleration wanders as far in a maneuver as that of the target."""
    said, (q,) = reported().stated, DOCUMENT.choice("q")
    for a, value in zip((5.0, said.acceleration), (q.values[0], q.values[-1]), strict=True):
        assert abs(a**2 / said.maneuver / value - 1) < 0.02
