"""The files of data/gnss are what the tool makes: of files with more in them, the same."""

from pathlib import Path

import pytest

from tools import gnss

DATA = Path(__file__).parents[2] / "data" / "gnss"


def fuller(text):
    """Return an observation file with another system, another carrier, and flags of strength.

    Thus a converter writes it.
    """
    head, body = text.split("END OF HEADER\n")
    head = head.replace("G    4 C1C L1C D1C S1C    ", "G    5 C2W C1C L1C D1C S1C")
    out = []
    for line in body.splitlines():
        if line[0] == "G":
            values = f"{line[3:]:64}"
            values = values[:15] + "7" + values[16:]
            out.append(f"{line[:3]}{20213929.547:14.3f} 6{values}")
        elif line[0] == ">":
            out += [f"{line[:32]}{int(line[32:]) + 1:3d}", "R14  19271851.070"]
    return "\n".join([head + "END OF HEADER", *out, ""])


@pytest.mark.parametrize("name", ["javad", "novatel", "ublox"])
def test_what_is_left_out_changes_nothing(name):
    text = (DATA / f"{name}.obs").read_text(encoding="ascii")
    again, names = gnss.observations(fuller(text))
    assert again == text
    elements = (DATA / f"{name}.nav").read_text(encoding="ascii")
    assert gnss.navigation(elements, names) == elements
    assert gnss.navigation(elements, names - {"G11", "G26"}).count("\nG") < elements.count("\nG")


def test_the_command_writes_both_files(tmp_path, monkeypatch):
    monkeypatch.setattr(gnss, "TARGET", tmp_path)
    gnss.main([str(DATA)])
    for path in DATA.glob("*.[on]??"):
        assert (tmp_path / path.name).read_bytes() == path.read_bytes()
