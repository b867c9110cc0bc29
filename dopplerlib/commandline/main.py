"""The command ``python -m dopplerlib``: arguments, files, exit codes."""

import argparse
import sys
import warnings
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np

from .._files import replacing, write_text
from ..chain.alarm import stop_alarm
from ..chain.setup import EXAMPLE, Setup, example
from ..chain.simulation import simulate_recording
from ..estimation.initial_estimate import ImplausibleStart
from ..evaluation.symptoms import symptoms
from . import report

_HEAD = "Written by python -m dopplerlib"
_ABOUT = """\
Track a target in a recording of Doppler modules, and check the track.

RECORDING is a WAV, FLAC, SigMF or .npy file with all modules, or one file for each of them, in the
order of the positions in ARRAY.toml. The folder that is written holds spectrogram.png, shifts.png,
residuals.png, track.png, shifts.csv, track.csv and summary.txt, which is also printed.
"""
_CODES = """\
exit code: 0 if a track was found and all checks passed, 1 if not, 2 if something was refused.
A first try:  python -m dopplerlib --example trial
"""


def main(argv: Iterable[str] | None = None) -> int:
    """Run the command.

    Parameters
    ----------
    argv : iterable of str, optional
        Arguments; those of the process if None.

    Returns
    -------
    int
        Exit code: 0 if a track was found and all checks passed, 1 if not, 2 if something was
        refused, 130 if the command was interrupted.
    """
    options = _parser().parse_args(None if argv is None else list(argv))
    try:
        if options.example is not None:
            return _write_example(Path(options.example))
        return _run(options)
    except KeyboardInterrupt:
        print("\ninterrupted; what was written is whole", file=sys.stderr)
        return 130
    except (ValueError, ModuleNotFoundError) as error:
        print(f"error: {error}", file=sys.stderr)
    except OSError as error:
        where = f": {error.filename}" if error.filename else ""
        print(f"error: {error.strerror or error}{where}", file=sys.stderr)
    return 2


def _parser():
    parser = argparse.ArgumentParser(
        prog="python -m dopplerlib",
        description=_ABOUT,
        epilog=_CODES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add = parser.add_argument
    add("recording", metavar="RECORDING", nargs="*", help="file, or one file for each module")
    add("--array", metavar="ARRAY.toml", help="positions, carrier, place and tracker")
    add("--out", metavar="FOLDER", help="by default the name of the first file, with -track")
    add("--layout", choices=("iq", "qi", "real"), help="order of the channels")
    add("--fs", type=float, metavar="HZ", help="sampling rate of .npy")
    add("--first", type=int, default=0, metavar="N", help="first sample that is read")
    add("--count", type=int, metavar="N", help="number of samples that are read")
    add("--force", action="store_true", help="write into a folder that something else made")
    add("--quiet", action="store_true", help="say nothing of what is being done")
    add("--example", metavar="FOLDER", help="write an ARRAY.toml and a simulated recording")
    return parser


def _run(options):
    if not options.recording:
        raise ValueError(
            "RECORDING must be at least one file, got none; for a first try: "
            "python -m dopplerlib --example trial"
        )
    if options.array is None:
        raise ValueError(
            "--array must be given: a file with positions, carrier, place and tracker, of which "
            "python -m dopplerlib --example trial writes one, got none"
        )
    if not Path(options.array).is_file():
        raise ValueError(f"--array must be a file that exists, got {options.array!r}")
    setup = Setup.from_toml(options.array)
    given = {name: getattr(options, name) for name in ("layout", "fs")}
    setup = replace(setup, **{name: value for name, value in given.items() if value is not None})
    paths = [Path(path) for path in options.recording]
    folder = Path(options.out or f"{paths[0].name.partition('.')[0]}-track")
    _check_folder(folder, options.force)
    say = _silent if options.quiet else _progress
    say(f"reading {', '.join(path.name for path in paths)}")
    recording = setup.read(paths, first=options.first, count=options.count)
    iq = setup.baseband(recording)
    say("tracking")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ImplausibleStart)  # the summary has it
        found = setup.track(iq)
    say("looking for mistakes")
    seen = symptoms(recording, setup)
    tracked = bool(seen.checks)
    alarm = None
    if tracked and setup.point is not None:
        alarm = stop_alarm(found, setup.point, setup.distance)
    text = report.summary(recording, setup, found if tracked else None, seen, alarm)
    title = f"{_HEAD}: {', '.join(path.name for path in paths)} with {Path(options.array).name}"
    files = {"summary.txt": f"{title}\n\n{text}", "shifts.csv": report.shifts_csv(found)}
    if tracked:
        files["track.csv"] = report.track_csv(found, alarm)
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in files.items():
        write_text(folder / name, content)
    say("drawing")
    _draw(folder, recording, setup, found if tracked else None, alarm)
    print(text, end="")
    print(f"written     {folder}")
    return 0 if tracked and seen.cause == "none found" else 1


def _draw(folder, *shown):
    """Write the pictures, or say which extra they need."""
    try:
        figures = _drawings(*shown)
    except ModuleNotFoundError as error:
        print(f"no pictures: {error}", file=sys.stderr)
        return
    for name, figure in figures.items():
        with replacing(folder / f"{name}.png") as (new,):
            figure.savefig(new, dpi=120)


def _drawings(recording, setup, found, alarm):
    """Return {name: figure}, of a recording alone if there is no track."""
    from ..figures import own_recording as draw
    from ..signal.spectrogram import spectrogram

    top = min(setup.speed_limit * setup.array.doppler_per_speed, recording.fs / 2)
    window = max(2, round(2 * setup.window * recording.fs))
    seen = spectrogram(recording.x, recording.fs, window, valid=recording.valid)
    figures = {"spectrogram": draw.spectrogram(seen, setup.array.wavelength, (-top, top))}
    if found is not None:
        figures["shifts"] = draw.shifts(found, setup)
        figures["residuals"] = draw.residuals(found)
        figures["track"] = draw.views(found, setup, alarm=alarm)
    return figures


def _check_folder(folder, force):
    """Raise if a folder holds something that this command did not write."""
    if folder.exists() and not folder.is_dir():
        raise ValueError(f"--out must be a folder, got {str(folder)!r}, which is a file")
    ours = folder / "summary.txt"
    if force or not folder.exists() or not any(folder.iterdir()):
        return
    if not (ours.is_file() and ours.read_text("utf-8", errors="replace").startswith(_HEAD)):
        raise ValueError(
            f"--out must be a new folder or one that this command made, got {str(folder)!r}: "
            "choose another one, or add --force"
        )


def _write_example(folder):
    _check_folder(folder, False)
    setup = example()
    time = np.arange(round(2 * setup.fs)) / setup.fs
    path = [4.8, 1.5, 1.2] + time[:, None] * [-1.4, 0.4, 0]
    rng = np.random.default_rng(1)
    recording = simulate_recording(path, setup.array, setup.fs, rng=rng)
    folder.mkdir(parents=True, exist_ok=True)
    write_text(folder / "room.toml", EXAMPLE)
    with replacing(folder / "room.npy") as (new,):
        with new.open("wb") as file:
            np.save(file, recording.x.astype("complex64"))
    print(
        f"written: {folder / 'room.toml'}, {folder / 'room.npy'} (simulated). Now\n"
        f"python -m dopplerlib {folder / 'room.npy'} --array {folder / 'room.toml'}"
    )
    return 0


def _progress(text):
    print(f"{text} ...", file=sys.stderr, flush=True)


def _silent(text):
    pass
