"""A file is written whole or not at all, and no other file is touched."""

import os
import signal
import stat
import subprocess
import sys
import threading
import time

import pytest

from dopplerlib import _files
from dopplerlib._files import PARTIAL, replacing, write_text

posix = pytest.mark.skipif(os.name == "nt", reason="Windows has no modes, links and pipes as these")


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def mode(path):
    return stat.S_IMODE(path.stat().st_mode)


def test_all_files_appear_together_and_nothing_else(tmp_path):
    paths = [tmp_path / "a.sigmf-data", tmp_path / "a.sigmf-meta"]
    with replacing(*paths) as new:
        assert [path.suffix for path in new] == [".sigmf-data", ".sigmf-meta"]
        assert all(path.name.startswith(PARTIAL) for path in new)
        for path in new:
            path.write_text(path.suffix)
        assert not any(path.exists() for path in paths)
    assert [path.read_text() for path in paths] == [path.suffix for path in paths]
    assert names(tmp_path) == ["a.sigmf-data", "a.sigmf-meta"]


def test_text_is_stored_in_utf_8_with_lines_as_they_are(tmp_path):
    write_text(tmp_path / "a", "σ\nb\r\n")
    assert (tmp_path / "a").read_bytes() == b"\xcf\x83\nb\r\n"


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt, SystemExit, OSError])
def test_what_stops_half_way_leaves_the_older_file_alone(tmp_path, error):
    write_text(tmp_path / "a", "old")
    with pytest.raises(error), replacing(tmp_path / "a", tmp_path / "b") as (new, _):
        new.write_text("new")
        raise error
    assert names(tmp_path) == ["a"] and (tmp_path / "a").read_text() == "old"


@pytest.mark.parametrize("call", ["open", "chmod"])
def test_an_interrupt_while_a_temporary_file_is_made_leaves_none(tmp_path, monkeypatch, call):
    write_text(tmp_path / "a", "old")
    original = os.open if call == "open" else type(tmp_path).chmod

    def interrupted(*args):
        original(*args)
        raise KeyboardInterrupt

    monkeypatch.setattr(os if call == "open" else type(tmp_path), call, interrupted)
    with pytest.raises(KeyboardInterrupt):
        write_text(tmp_path / "a", "new")
    assert names(tmp_path) == ["a"] and (tmp_path / "a").read_text() == "old"


def test_a_file_that_is_there_is_no_temporary_file(tmp_path, monkeypatch):
    """If chance gave a name that is taken, writing would fail rather than use that file."""
    monkeypatch.setattr(_files.secrets, "token_hex", lambda n: "0")
    taken = tmp_path / f"{PARTIAL}0.wav"
    taken.write_text("mine")
    monkeypatch.setattr(type(tmp_path), "unlink", lambda *args, **kwargs: None)
    with pytest.raises(FileExistsError):
        write_text(tmp_path / "a.wav", "new")
    assert taken.read_text() == "mine"


@posix
def test_a_killed_writer_leaves_a_name_that_git_ignores(tmp_path):
    code = (
        "import sys, time\nfrom dopplerlib._files import replacing\n"
        "with replacing(sys.argv[1]) as (new,):\n    print(flush=True)\n    time.sleep(60)"
    )
    with subprocess.Popen(
        [sys.executable, "-c", code, tmp_path / "a.wav"], stdout=subprocess.PIPE
    ) as writer:
        writer.stdout.readline()
        writer.send_signal(signal.SIGKILL)
    (left,) = names(tmp_path)
    assert left.startswith(PARTIAL) and left.endswith(".wav")


def test_two_writers_and_a_reader_never_meet(tmp_path):
    path, size = tmp_path / "a", 200_000
    write_text(path, "a" * size)
    failed, end = [], time.monotonic() + 0.5

    def write(letter):
        try:
            while time.monotonic() < end:
                write_text(path, letter * size)
        except Exception as error:
            failed.append(error)

    writers = [threading.Thread(target=write, args=(letter,)) for letter in "ab"]
    for writer in writers:
        writer.start()
    while any(writer.is_alive() for writer in writers):
        text = path.read_text()
        assert len(text) == size and len(set(text)) == 1
    assert failed == [] and names(tmp_path) == ["a"]


@posix
@pytest.mark.parametrize("umask, expected", [(0o022, 0o644), (0o077, 0o600), (0o002, 0o664)])
def test_a_new_file_has_the_mode_that_the_umask_gives(tmp_path, umask, expected):
    before = os.umask(umask)
    try:
        write_text(tmp_path / "a", "")
    finally:
        os.umask(before)
    assert mode(tmp_path / "a") == expected


@posix
@pytest.mark.parametrize("wanted", [0o600, 0o640, 0o755, 0o666])
def test_a_file_keeps_its_mode_and_is_never_more_open_on_the_way(tmp_path, wanted):
    path = tmp_path / "a"
    path.touch()
    path.chmod(wanted)
    with replacing(path) as (new,):
        assert mode(new) == wanted
    assert mode(path) == wanted


@posix
def test_a_file_keeps_its_owner(tmp_path):
    if os.geteuid():
        pytest.skip("only root can give a file away")
    path = tmp_path / "a"
    path.touch()
    os.chown(path, 1234, 4321)
    write_text(path, "new")
    assert (path.stat().st_uid, path.stat().st_gid) == (1234, 4321)


@posix
@pytest.mark.parametrize("there", [True, False], ids=["a file", "nothing yet"])
def test_a_link_is_followed(tmp_path, there):
    """Also from link to link, and into another folder, where the temporary file is made too."""
    (tmp_path / "other").mkdir()
    target = tmp_path / "other" / "b.bin"
    if there:
        target.write_text("old")
        target.chmod(0o600)
    (tmp_path / "middle").symlink_to(target)
    (tmp_path / "a.wav").symlink_to("middle")
    with replacing(tmp_path / "a.wav") as (new,):
        assert new.parent == target.parent and new.suffix == ".wav"
        new.write_text("new")
    assert (tmp_path / "a.wav").is_symlink() and (tmp_path / "middle").is_symlink()
    assert target.read_text() == "new" and names(target.parent) == ["b.bin"]
    assert not there or mode(target) == 0o600


def fifo(path):
    os.mkfifo(path)


def read_only(path):
    path.touch()
    path.chmod(0o444)


def loop(path):
    path.symlink_to(path.with_name("b"))
    path.with_name("b").symlink_to(path)


def link_to_a_device(path):
    path.symlink_to("/dev/null")


def socket(path):
    os.mknod(path, stat.S_IFSOCK | 0o600)


REFUSED = {
    "folder": (lambda path: path.mkdir(), "path must be that of a file in a folder that exists"),
    "FIFO": (fifo, "path must be an ordinary file"),
    "socket": (socket, "path must be an ordinary file"),
    "device": (link_to_a_device, "path must be an ordinary file"),
    "read-only": (read_only, "path must be a file that may be written to"),
    "loop": (loop, "path must lead to a file"),
}


@posix
@pytest.mark.parametrize("kind", REFUSED)
def test_what_is_no_ordinary_file_is_refused_and_left_alone(tmp_path, kind):
    make, message = REFUSED[kind]
    path = tmp_path / "a.wav"
    make(path)
    before = names(tmp_path), path.lstat()
    with pytest.raises(ValueError, match=f"^{message}, got .*a.wav"):
        write_text(path, "new")
    assert names(tmp_path) == before[0]
    assert (path.lstat().st_ino, path.lstat().st_mode) == (before[1].st_ino, before[1].st_mode)


@pytest.mark.parametrize(
    "path",
    [None, 5, True, b"a", "", "/", ".", "no/such/folder", "a\0b", "a" * 300, __file__ + "/a"],
)
def test_a_path_that_is_none_is_refused(path):
    with pytest.raises(ValueError, match=r"^path must .*, got "):
        write_text(path, "")


@posix
def test_a_folder_that_may_not_be_written_to_is_refused(tmp_path, monkeypatch):
    def refused(*args):
        raise PermissionError(13, "Permission denied", args[0])  # root never meets it

    monkeypatch.setattr(os, "open", refused)
    with pytest.raises(ValueError, match=r"^path must be in a folder that may be written to, got "):
        write_text(tmp_path / "a", "new")


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no device that is always full")
def test_a_full_disk_is_named_with_the_file(tmp_path):
    with pytest.raises(OSError, match=r"No space left on device: '.*a.wav'"):
        with replacing(tmp_path / "a.wav"), open("/dev/full", "w") as full:
            full.write("new")
    assert names(tmp_path) == []
