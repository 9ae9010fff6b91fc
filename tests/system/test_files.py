"""Files of strangers: only regular ones are read, never more than may be, and nothing is waited for."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from urdfcheck.system import files
from urdfcheck.system.files import FileTooLargeError, overlay_files, read_regular, read_start, walk
from urdfcheck.system.observing.observations import observe

needs_unix = pytest.mark.skipif(sys.platform == "win32", reason="no such files there")


@pytest.mark.parametrize("content", [b"", b"\r\n\0\x1a", b"x" * 5000])
def test_a_regular_file_is_read_as_it_is(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "file"
    path.write_bytes(content)
    assert read_regular(path) == content
    assert read_start(path, 2) == content[:2]


def test_a_file_of_just_the_limit_is_read_and_one_byte_more_is_not(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_bytes(b"12345")
    assert read_regular(path, 5) == b"12345"
    with pytest.raises(FileTooLargeError) as caught:
        read_regular(path, 4)
    assert (caught.value.limit, caught.value.found) == (4, 5)
    assert caught.value.message == "the file has 5 bytes, more than 4"


@pytest.mark.skipif(not Path("/proc/self/status").is_file(), reason="no /proc")
def test_a_file_that_says_it_is_empty_is_read_up_to_the_limit() -> None:
    path = Path("/proc/self/status")
    assert path.stat().st_size == 0
    assert read_regular(path).startswith(b"Name:")
    with pytest.raises(FileTooLargeError):
        read_regular(path, 10)


def test_a_file_that_grows_while_it_is_read_is_bounded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "file"
    path.write_bytes(b"1")
    status = path.stat()
    path.write_bytes(b"12345")
    monkeypatch.setattr(os, "fstat", lambda _: status)
    assert read_regular(path, 5) == b"12345"
    with pytest.raises(FileTooLargeError):
        read_regular(path, 4)


@needs_unix
def test_a_pipe_a_device_and_a_socket_are_refused_at_once(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")  # nobody writes: to open it would wait for ever
    with socket.socket(socket.AF_UNIX) as server:
        here = os.getcwd()
        os.chdir(tmp_path)  # the name of a socket is short
        server.bind("socket")
        os.chdir(here)
        for path in (tmp_path / "pipe", tmp_path / "socket", Path("/dev/zero")):
            for read in (read_regular, lambda p: read_start(p, 9)):
                with pytest.raises(OSError, match="Is not a regular file"):
                    read(path)


@needs_unix
def test_what_becomes_a_pipe_after_it_was_looked_at_is_refused_too(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_bytes(b"1")
    status = (tmp_path / "file").stat()
    os.mkfifo(tmp_path / "pipe")
    monkeypatch.setattr(os, "stat", lambda *_, **__: status)
    with pytest.raises(OSError, match="Is not a regular file"):
        read_regular(tmp_path / "pipe")


@pytest.mark.parametrize("name", ["", "nowhere", "a\0b", "\ud800"])
def test_a_folder_and_what_is_no_file_are_an_os_error(tmp_path: Path, name: str) -> None:
    with pytest.raises(OSError, match=r"\[Errno \d+\]"):
        read_regular(tmp_path / name)


@pytest.mark.slow
@needs_unix
def test_folders_are_walked_however_deep_and_through_no_link(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("a", ".b"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "file").touch()
    (tmp_path / "a" / "up").symlink_to("..")
    (tmp_path / "a" / "round").symlink_to("round")
    found = list(walk(tmp_path))
    assert [(os.path.relpath(folder, tmp_path), names, files) for folder, names, files in found] == [
        (".", [".b", "a"], []),
        (".b", [], ["file"]),
        ("a", ["up"], ["file", "round"]),
    ]
    monkeypatch.chdir(tmp_path / "a")
    for _ in range(1_100):
        os.mkdir("d")
        os.chdir("d")
    os.chdir(tmp_path)
    try:
        assert len(list(walk(tmp_path))) == 1_103
    finally:
        subprocess.run(["rm", "-rf", str(tmp_path / "a" / "d")], check=True)


def test_a_file_is_overlaid_by_each_of_its_names_and_others_are_not(tmp_path: Path) -> None:
    file, other, link = tmp_path / "file", tmp_path / "other", tmp_path / "link"
    file.write_text("disk")
    other.write_text("other")
    link.symlink_to(file)
    missing = tmp_path / "missing"
    with overlay_files({os.path.realpath(file): b"edited", os.path.realpath(missing): b"new"}):
        contents = [read_regular(path) for path in (file, link, tmp_path / "." / "file", other, missing)]
        with pytest.raises(FileNotFoundError):
            read_regular(tmp_path / "nowhere")
    assert contents == [b"edited", b"edited", b"edited", b"other", b"new"]
    assert read_regular(file) == b"disk"


def test_names_of_a_large_folder_are_read_again_only_after_a_change(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(files, "_LARGE_FOLDER", 0)
    monkeypatch.setattr(files, "SETTLED_NS", -1)
    reads = []

    @files.remember_large_folders
    def list_names(folder: str) -> list[str]:
        reads.append(folder)
        return sorted(os.listdir(folder))

    (tmp_path / "a.urdf").touch()
    assert list_names(tmp_path) == list_names(tmp_path) == ["a.urdf"]
    assert len(reads) == 1
    (tmp_path / "b.urdf").touch()
    os.utime(tmp_path, ns=(0, 10**18))  # a clock may be too coarse to tell the two apart
    assert list_names(tmp_path) == ["a.urdf", "b.urdf"]
    with observe() as seen:
        assert list_names(tmp_path) == ["a.urdf", "b.urdf"]
    assert str(tmp_path) in seen.names


def test_a_folder_that_changed_just_now_is_not_remembered(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(files, "_LARGE_FOLDER", 0)
    list_names = files.remember_large_folders(lambda folder: sorted(os.listdir(folder)))
    assert list_names(tmp_path) == []
    stamp = tmp_path.stat()
    (tmp_path / "a.urdf").touch()
    os.utime(tmp_path, ns=(stamp.st_atime_ns, stamp.st_mtime_ns))
    assert list_names(tmp_path) == ["a.urdf"]
