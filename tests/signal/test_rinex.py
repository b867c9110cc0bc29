"""RINEX of every version is read alike; what cannot be read is refused by name."""

from pathlib import Path

import numpy as np
import pytest

from dopplerlib._data import data
from dopplerlib.signal.rinex import SatelliteShifts, read_rinex, recorded_receiver

SHIPPED = data("gnss")
# The first two epochs of the NovAtel's log, and the first two satellites' elements, written in
# version 2.11 by RTKLIB's convbin: other systems beside GPS, two lines a satellite, some of them
# blank, and more satellites than a line has names for.
OLD = Path(__file__).with_name("rinex")


@pytest.fixture
def pair(tmp_path):
    """Copies of the NovAtel's files that may be changed."""

    def changed(observations=str, navigation=str):
        made = []
        for name, change in (("novatel.obs", observations), ("novatel.nav", navigation)):
            made.append(tmp_path / name)
            made[-1].write_text(change((SHIPPED / name).read_text(encoding="ascii")), "latin-1")
        return made

    return changed


def test_the_columns_are_those_of_the_file():
    """Read off the file by eye: the first epoch, satellite G03."""
    recording, _ = recorded_receiver("novatel")
    s = recording.satellites.index("G03")
    assert recording.doppler[0, s] == -1140.227
    assert recording.cn0[0, s] == 51.0
    assert recording.pseudorange[0, s] == 20213930.641
    assert np.isnan(recording.count[0]).all()
    assert recording.count[1, s] == pytest.approx(106224932.512 - 106226073.008, abs=1e-6)
    assert recording.times[0] == 1562 * 604800 + 515220  # GPS week 1562, as RTKLIB has it
    np.testing.assert_array_equal(np.diff(recording.times), 1.0)
    assert recording.position[0] == -3869295.978


def test_the_phase_is_the_integral_of_the_shift():
    """Mean of the shifts at both ends, less what is common: errors are noise of the shift."""
    for name in ("ublox", "novatel", "javad"):
        recording, _ = recorded_receiver(name)
        mean = (recording.doppler[1:] + recording.doppler[:-1]) / 2
        left = recording.count[1:] - mean
        left -= np.nanmedian(left, axis=1, keepdims=True)
        assert np.nanstd(left) < 0.3


def test_a_lost_count_is_missing():
    """The u-blox loses the phase of G26 (the flag behind it is odd) six times."""
    recording, _ = recorded_receiver("ublox")
    missing = np.isnan(recording.count[1:]).sum(axis=0)
    assert dict(zip(recording.satellites, missing, strict=True)) == {
        name: 6 if name == "G26" else 0 for name in recording.satellites
    }


def test_version_2_gives_the_same():
    new, _ = recorded_receiver("novatel")
    old = read_rinex(OLD / "novatel.09o", OLD / "novatel.09n")
    assert old.satellites == new.satellites
    for field in ("times", "doppler", "cn0", "pseudorange", "count"):
        np.testing.assert_array_equal(getattr(old, field), getattr(new, field)[:2])
    for satellite, row in zip(old.orbits.satellites, old.orbits.elements, strict=True):
        (place,) = (i for i, name in enumerate(new.orbits.satellites) if name == satellite)
        np.testing.assert_array_equal(row, new.orbits.elements[place])


def test_version_4_gives_the_same(pair):
    """Each message has a line before it that names its kind; those of other kinds are skipped."""

    def newer(text):
        head, body = text.replace("     3.02 ", "     4.00 ").split("END OF HEADER\n")
        lines = body.splitlines()
        out = []
        for i in range(0, len(lines), 8):
            out += [f"> EPH {lines[i][:3]} LNAV", *lines[i : i + 8]]
            out += [f"> EPH {lines[i][:3]} CNAV", *lines[i : i + 8], "     .0"]
        return "\n".join([head + "END OF HEADER", *out])

    def observations(text):
        return text.replace("     3.02 ", "     4.00 ")

    assert read_rinex(*pair(observations, newer)) == recorded_receiver("novatel")[0]


def test_events_and_other_systems_are_skipped(pair):
    def change(text):
        event = "> 2009 12 18 23 07 01.5000000  4  2\n" + f"{'moved':60}COMMENT\n" * 2
        first, second = text.split("> 2009 12 18 23 07 02", maxsplit=1)
        first = first.replace("00.0000000  0  9\n", "00.0000000  0 10\nR01  20213930.641\n")
        return f"{first}{event}> 2009 12 18 23 07 02{second}\n\n"

    assert read_rinex(*pair(change)) == recorded_receiver("novatel")[0]


def test_a_week_that_starts_anew_and_a_blank_health_change_nothing(pair):
    """The third number of the sixth line of a record is the week, the second of the next health."""

    def change(text):
        assert text.count(" .156200000000D+04") == 9 and text.count("\n      .280000000000D+01") > 0
        text = text.replace(" .156200000000D+04", " .538000000000D+03")
        lines = text.splitlines()
        for i in range(5 + 6, len(lines), 8):
            lines[i] = lines[i][:23] + " " * 19 + lines[i][42:]
        return "\n".join(lines)

    assert read_rinex(*pair(navigation=change)) == recorded_receiver("novatel")[0]


def test_phases_alone_are_read(pair):
    recording = read_rinex(*pair(lambda text: text.replace("L1C D1C S1C", "L1C D2W S1C")))
    assert np.isnan(recording.doppler).all()
    np.testing.assert_array_equal(recording.count, recorded_receiver("novatel")[0].count)


def test_unhealthy_satellites_and_unknown_places_are_left_out(pair):
    def sick(text):
        """The second number of the seventh line of a record is the health."""
        lines = text.splitlines()
        lines[5 + 6] = lines[5 + 6][:23] + " .630000000000D+02" + " " + lines[5 + 6][42:]
        return "\n".join(lines)

    def nowhere(text):
        place = text[text.index(" -3869295") :][:42]
        return text.replace(place, f"{0:14.4f}" * 3)

    recording = read_rinex(*pair(nowhere, sick))
    assert recording.orbits.satellites == recorded_receiver("novatel")[0].orbits.satellites[1:]
    assert np.isnan(recording.position).all()


@pytest.mark.parametrize(
    ("observations", "message"),
    [
        (lambda text: "", "observations must be an observation file in RINEX"),
        (lambda text: text.replace("OBSERVATION", "NAVIGATION "), "be an observation file"),
        (lambda text: text.replace("     3.02", "     1.00"), "have RINEX version 2 to 4"),
        (lambda text: "\x1f\x8b" + text, "be plain text"),
        (lambda text: text.replace("END OF HEADER", "END OF"), "have a header that ends"),
        (lambda text: text.replace(" GPS         TIME", " GLO         TIME"), "have GPS time"),
        (lambda text: text.replace("L1C D1C S1C", "L5X D2W S1C"), "phases of GPS on L1, got"),
        (lambda text: text.replace("-1140.227", "-11x0.227"), "have the columns of RINEX"),
        (lambda text: text.replace("> 2009", "  2009"), "begin an epoch with '>'"),
        (lambda text: text[:-100], "be complete"),
    ],
)
def test_what_is_no_observation_file_is_refused(pair, observations, message):
    with pytest.raises(ValueError, match=f"observations must .*{message[-20:]}"):
        read_rinex(*pair(observations))


def test_what_is_no_navigation_file_is_refused(pair):
    observations, navigation = pair()
    with pytest.raises(ValueError, match="navigation must be a navigation file in RINEX"):
        read_rinex(observations, observations)
    with pytest.raises(ValueError, match="navigation must be complete"):
        read_rinex(*pair(navigation=lambda text: text[:-200]))
    with pytest.raises(ValueError, match="navigation must hold elements of healthy GPS"):
        read_rinex(*pair(navigation=lambda text: text.split("END OF HEADER")[0] + "END OF HEADER"))
    for path in (navigation.with_name("no"), navigation.parent, 3, "\0"):
        with pytest.raises(ValueError, match="navigation must be"):
            read_rinex(observations, path)


def test_parts_of_a_recording_are_its_rows_and_columns():
    """The mean shift over five seconds is the cycles at both ends over five."""
    whole, _ = recorded_receiver("novatel")
    part = whole.part(40, 10)
    np.testing.assert_array_equal(part.times, whole.times[40:])
    np.testing.assert_array_equal(part.doppler, whole.doppler[40:])
    fewer = whole.without(["G03", "G22"])
    assert fewer.satellites == whole.satellites[1:-1]
    np.testing.assert_array_equal(fewer.cn0, whole.cn0[:, 1:-1])
    counted = whole.counted(5)
    np.testing.assert_array_equal(counted.times, whole.times[0] + 2.5 + 5 * np.arange(9))
    cycles = 106224932.512 - 106230637.852  # of G03, read off the file at 0 and 5 s
    assert counted.doppler[0, 0] == pytest.approx(cycles / 5, abs=1e-6)
    for call, message in (
        (lambda: whole.part(46, 1), "first must be below 46"),
        (lambda: whole.counted(46), "epochs must be at most 45"),
        (lambda: whole.without(["G01"]), "satellites must be one of"),
        (lambda: whole.without("G03"), "satellites must be an iterable"),
    ):
        with pytest.raises(ValueError, match=message):
            call()


def test_a_recording_is_checked():
    good, _ = recorded_receiver("novatel")
    fields = {name: getattr(good, name) for name in SatelliteShifts.__annotations__}
    for change, message in (
        ({"times": good.times[::-1]}, "times must increase"),
        ({"satellites": ("G01",) * 9}, "satellites must differ"),
        (dict.fromkeys(("doppler", "count"), np.full((46, 9), np.nan)), "doppler must hold a s"),
        ({"cn0": good.cn0[1:]}, "cn0 must have shape"),
        ({"orbits": None}, "orbits must be a BroadcastOrbits"),
        ({"position": [0.0]}, "position must have shape"),
    ):
        with pytest.raises(ValueError, match=message):
            SatelliteShifts(**fields | change)
