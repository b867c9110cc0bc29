"""Write the files of this folder again: ``python tests/signal/writers/make.py``.

All of them hold the same samples (`values`), as each writer stores them.
"""

import json
import struct
import subprocess
import tempfile
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
FS, CARRIER = 8000, 24.125e9
_RAW = "-f s16le -ar 8000 -ac 4"
_SOX = "sox -D -t raw -r 8000 -e signed -b 16 -c 4"
_ALSA = "pcm.cap {{ type file slave.pcm null file /dev/null infile {0}/in.raw format raw }}"

# What is run in a folder with the samples as in.raw, by the file that it writes.
COMMANDS = {
    "arecord.wav": "arecord -q -D cap -f S16_LE -c 4 -r 8000 -s 160 arecord.wav",
    "arecord_stream.wav": (
        "arecord -q -D cap -f S16_LE -c 4 -r 8000 -t wav - | head -c 1324 > arecord_stream.wav"
    ),
    "ffmpeg.wav": f"ffmpeg -loglevel error {_RAW} -i in.raw ffmpeg.wav",
    "ffmpeg_24.wav": f"ffmpeg -loglevel error {_RAW} -i in.raw -c:a pcm_s24le ffmpeg_24.wav",
    "ffmpeg_bext.wav": f"ffmpeg -loglevel error {_RAW} -i in.raw -write_bext 1 ffmpeg_bext.wav",
    "ffmpeg_rf64.wav": f"ffmpeg -loglevel error {_RAW} -i in.raw -rf64 always ffmpeg_rf64.wav",
    "ffmpeg_stream.wav": f"ffmpeg -loglevel error {_RAW} -i in.raw -f wav - > ffmpeg_stream.wav",
    "sox.wav": f"{_SOX} in.raw sox.wav",
    "sox_32.wav": f"{_SOX} in.raw -b 32 sox_32.wav",
    "sox_big_endian.wav": f"{_SOX} in.raw -B sox_big_endian.wav",
    "sox_float.wav": f"{_SOX} in.raw -e floating-point -b 32 sox_float.wav",
    "sox_stream.wav": f"cat in.raw | {_SOX} - -t wav - | cat > sox_stream.wav",
    "sox.flac": f"{_SOX} in.raw sox.flac",
}


def values():
    """Return 160 samples of two sensors as 16-bit numbers: I and Q of each in turn."""
    rng = np.random.default_rng(11)
    k = np.arange(160)
    x = 0.5 * np.exp(2j * np.pi * np.array([[900.0], [-1300.0]]) / FS * k)
    x += 0.02 * (rng.standard_normal(x.shape) + 1j * rng.standard_normal(x.shape))
    return np.round(np.ascontiguousarray(x.T).view(float) * 2**15).astype("<i2")


def run_tools():
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        (folder / "in.raw").write_bytes(values().tobytes())
        (folder / "alsa").write_text(_ALSA.format(folder))
        alsa = {"ALSA_CONFIG_PATH": f"/usr/share/alsa/alsa.conf:{folder}/alsa"}
        for name, command in COMMANDS.items():
            env = {"PATH": "/usr/bin:/bin", **alsa}
            subprocess.run(command, shell=True, check=True, cwd=folder, env=env)
            (HERE / name).write_bytes((folder / name).read_bytes())


def run_libsndfile():
    import soundfile

    x = values() / 2**15
    for name, options in {
        "libsndfile_float.wav": {"subtype": "FLOAT"},
        "libsndfile_double.wav": {"subtype": "DOUBLE"},
        "libsndfile_24.wav": {"subtype": "PCM_24"},
        "libsndfile_wavex.wav": {"subtype": "PCM_16", "format": "WAVEX"},
        "libsndfile_rf64.wav": {"subtype": "PCM_16", "format": "RF64"},
        "libsndfile_24.flac": {"subtype": "PCM_24"},
    }.items():
        soundfile.write(HERE / name, x, FS, **options)


def run_scipy():
    import wave

    from scipy.io import wavfile

    wavfile.write(HERE / "scipy_float64.wav", FS, values() / 2**15)
    with wave.open(str(HERE / "python.wav"), "wb") as file:
        file.setnchannels(4)
        file.setsampwidth(2)
        file.setframerate(FS)
        file.writeframes(values().tobytes())


def chunk(name, content, length=None):
    length = len(content) if length is None else length
    return name + struct.pack("<I", length) + content + bytes(len(content) % 2)


def write_by_layout():
    """Write what programs that do not run here are known to write."""
    form = chunk(b"fmt ", struct.pack("<HHIIHH", 1, 4, FS, 8 * FS, 8, 16))
    raw = values().tobytes()
    data = chunk(b"data", raw)
    moment = struct.pack("<8H", 2016, 9, 3, 28, 12, 0, 0, 0)
    auxi = moment + moment + struct.pack("<5I", 24_125_000, FS, 0, FS, 0) + bytes(112)
    bext = b"zoom".ljust(256, b"\0") + bytes(346)
    ixml = b'<?xml version="1.0" encoding="UTF-8"?><BWFXML><TAKE>1</TAKE></BWFXML>'
    cue = struct.pack("<I", 1) + struct.pack("<II4sIII", 1, 40, b"data", 0, 0, 40)
    labels = b"adtl" + chunk(b"labl", struct.pack("<I", 1) + b"door")
    id3 = b"ID3\x04\0\0\0\0\0\x0b" + b"TIT2" + bytes(7)
    long = struct.pack("<QQQI", 0, len(raw), 160, 0)
    axml = chunk(b"axml", b"<ebuCoreMain/>")
    files = {
        "sdr_auxi.wav": [form, chunk(b"auxi", auxi), data],
        "recorder_bext_ixml.wav": [chunk(b"bext", bext), chunk(b"iXML", ixml), form, data],
        "editor_cue_list_id3.wav": [
            form, data, chunk(b"cue ", cue), chunk(b"LIST", labels), chunk(b"id3 ", id3)
        ],
        "editor_smpl_pad.wav": [form, chunk(b"smpl", bytes(36)), chunk(b"PAD ", bytes(99)), data],
        "mac_fllr.wav": [form, chunk(b"FLLR", bytes(200)), data],
        "odd_without_padding.wav": [form, chunk(b"iXML", ixml)[: 8 + len(ixml)], data],
        "stream_0.wav": [form, chunk(b"data", raw, 0)],
        "studio_bw64.wav": [chunk(b"ds64", long), form, chunk(b"data", raw, 2**32 - 1), axml],
    }  # fmt: skip
    for name, parts in files.items():
        body = b"WAVE" + b"".join(parts)
        magic, size = b"RIFF", len(body)
        if name == "studio_bw64.wav":
            magic, size = b"BW64", 2**32 - 1
        elif name == "stream_0.wav":
            size = 0
        (HERE / name).write_bytes(magic + struct.pack("<I", size) + body)


def run_sigmf():
    import sigmf
    from sigmf.convert.wav import wav_to_sigmf

    info = {"core:datatype": "ci16_le", "core:sample_rate": float(FS), "core:num_channels": 2}
    capture = {"core:frequency": CARRIER, "core:datetime": "2016-09-28T12:00:00.000000Z"}
    raw = HERE / "sigmf_python.sigmf-data"
    raw.write_bytes(values().tobytes())
    file = sigmf.SigMFFile(data_file=raw, global_info=info)
    file.add_capture(0, metadata=capture)
    file.add_annotation(40, 20, metadata={"core:label": "door"})
    file.tofile(HERE / "sigmf_python", overwrite=True)
    file.archive(HERE / "sigmf_python_archive.sigmf", overwrite=True)
    for end in (".gz", ".zip"):
        file.archive(HERE / f"sigmf_python_archive.sigmf{end}", overwrite=True)
    wav_to_sigmf(HERE / "python.wav", HERE / "sigmf_from_wav", overwrite=True)


def pair(name, info, captures, content, version="1.2.0"):
    text = {
        "global": {"core:version": version, "core:sample_rate": FS, **info},
        "captures": captures,
        "annotations": [],
    }
    (HERE / f"{name}.sigmf-meta").write_text(json.dumps(text, indent=1) + "\n")
    (HERE / f"{name}.sigmf-data").write_bytes(content)


def write_sigmf_by_layout():
    """Write what recorders that do not run here are known to write."""
    v = values()
    one = (v[:, :2] / 2**15).astype("<f4")
    pair(
        "gnuradio",
        {"core:datatype": "cf32_le", "core:recorder": "GNU Radio 3.10", "core:hw": "none"},
        [{"core:sample_start": 0, "core:frequency": CARRIER, "core:global_index": 0,
          "core:datetime": "2016-09-28T12:00:00.000000Z"}],
        one.tobytes(),
    )  # fmt: skip
    pair(
        "gnuradio_old",
        {"core:datatype": "cf32_le", "core:description": "", "core:author": ""},
        [{"core:sample_start": 0, "core:frequency": CARRIER, "core:time": "2016-09-28T12:00:00Z"}],
        one.tobytes(),
        "0.0.2",
    )
    pair(
        "captures",
        {"core:datatype": "ci16_le", "core:num_channels": 2},
        [{"core:sample_start": first, "core:frequency": CARRIER, "core:datetime":
          f"2016-09-28T12:00:00.{first * 125:06}"} for first in (0, 60, 100)],
        v.tobytes(),
    )  # fmt: skip
    pair(
        "second_part",
        {"core:datatype": "ci16_le", "core:num_channels": 2, "core:offset": 1000},
        [{"core:sample_start": 1000}],
        v.tobytes(),
    )
    pair(
        "real",
        {"core:datatype": "ri16_le", "core:num_channels": 4},
        [{"core:sample_start": 0, "core:frequency": CARRIER}],
        v.tobytes(),
    )


if __name__ == "__main__":
    run_tools()
    run_libsndfile()
    run_scipy()
    write_by_layout()
    run_sigmf()
    write_sigmf_by_layout()
