"""Make data/gnss from RINEX 3 files: of GPS only, and of each satellite only what L1 C/A gives."""

from pathlib import Path

from dopplerlib._files import write_text
from tools.command import parser, start

# Code range in m, phase in cycles, Doppler shift in Hz, C/N0 in dB-Hz; and how many characters of
# each: 14 are the number, and one more tells of the phase whether the receiver lost it.
KEPT = {"C1C": 14, "L1C": 15, "D1C": 14, "S1C": 14}
WIDTH = 16  # of a column
TARGET = Path(__file__).parents[1] / "data" / "gnss"
LABELS = (
    "PGM / RUN BY / DATE",
    "COMMENT",
    "APPROX POSITION XYZ",
    "TIME OF FIRST OBS",
    "TIME OF LAST OBS",
)


def split(text):
    """Return the lines of the header, and those behind it."""
    lines = text.splitlines()
    end = next(i for i, line in enumerate(lines) if line[60:].startswith("END OF HEADER"))
    return lines[:end], lines[end + 1 :]


def header(lines, more=()):
    """Return the header with what is left in the file."""
    first = f"{lines[0][:40]}{'G: GPS':20}{lines[0][60:]}"
    kept = [line for line in lines[1:] if line[60:].strip() in LABELS and line[:60].strip()]
    return [first, *kept, *more, f"{'':60}END OF HEADER"]


def observations(text):
    """Return an observation file of `KEPT` alone, and the names of its satellites."""
    head, body = split(text)
    types, system = [], None
    for line in head:
        if line[60:].startswith("SYS / # / OBS TYPES"):
            system = line[0].strip() or system
            types += line[6:60].split() if system == "G" else []
    places = [(3 + WIDTH * types.index(kind), width) for kind, width in KEPT.items()]
    kinds = f"G  {len(KEPT):3d} {' '.join(KEPT)}"
    out = header(head, [f"{kinds:60}SYS / # / OBS TYPES"])
    names, rows, epoch = set(), [], None
    for line in [*body, ">"]:
        if line[0] == "G":
            names.add(line[:3])
            parts = (f"{line[place : place + width]:{WIDTH}}" for place, width in places)
            rows.append((line[:3] + "".join(parts)).rstrip())
        elif line[0] == ">":
            out += [f"{epoch[:32]}{len(rows):3d}", *sorted(rows)] if rows else []
            epoch, rows = line, []
    return "\n".join(out) + "\n", names


def navigation(text, names):
    """Return a navigation file with the records of these satellites, in their order."""
    head, body = split(text)
    records = [body[i : i + 8] for i, line in enumerate(body) if line[:3] in names]
    records = [line.rstrip() for one in sorted(records) for line in one]
    return "\n".join([*header(head), *records]) + "\n"


def main(argv=None):
    """Write the files."""
    arguments = parser(__doc__)
    arguments.add_argument("folder", type=Path, help="with NAME.obs and NAME.nav, RINEX 3")
    folder = arguments.parse_args(argv).folder
    for path in sorted(folder.glob("*.obs")):
        text, names = observations(path.read_text(encoding="ascii"))
        write_text(TARGET / path.name, text)
        source = path.with_suffix(".nav").read_text(encoding="ascii")
        write_text(TARGET / f"{path.stem}.nav", navigation(source, names))


if __name__ == "__main__":
    start(main)
