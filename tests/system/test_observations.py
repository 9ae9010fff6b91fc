"""What the outcome of some work depends on is seen where Python asks the system, and asked again."""

from __future__ import annotations

import contextlib
import os
import shutil
import sys
import threading
from collections.abc import Callable
from pathlib import Path

import pytest

from urdfcheck.system.files import read_regular, read_start
from urdfcheck.system.observing import observations
from urdfcheck.system.observing.observations import Observations, Recheck, observe
from urdfcheck.system.observing.questions import add_observations, compute_sha256, expand_home, read_variable

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="nothing is kept where Python asks in other ways")

Action = Callable[[Path], object]


@pytest.fixture(name="folder")
def make_folder(tmp_path: Path) -> Path:
    (tmp_path / "file").write_bytes(b"old")
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "inner").write_bytes(b"inner")
    (tmp_path / "link").symlink_to("file")
    (tmp_path / "folder" / "away").symlink_to("../file")
    return tmp_path


def is_unchanged(seen: Observations) -> bool:
    return Recheck(lambda path: compute_sha256(path.read_bytes()), lambda _: ()).is_unchanged(seen)


def watch(question: Action, folder: Path) -> Observations:
    with observe() as seen, contextlib.suppress(OSError):
        question(folder)
    return seen


def replace_by_folder(path: Path) -> None:
    path.unlink()
    path.mkdir()


def turn_link(path: Path, target: str) -> None:
    path.unlink()
    path.symlink_to(target)


def list_types(path: Path) -> list[bool]:
    with os.scandir(path) as entries:
        return [entry.is_dir() for entry in entries]


QUESTIONS: dict[str, tuple[Action, Action]] = {
    "the content of a file": (lambda f: read_regular(f / "file"), lambda f: (f / "file").write_bytes(b"new")),
    "its start": (lambda f: read_start(f / "file", 2), lambda f: (f / "file").write_bytes(b"new")),
    "a file opened by Python": (lambda f: (f / "file").read_bytes(), lambda f: (f / "file").write_bytes(b"new")),
    "a file that is missing": (lambda f: read_regular(f / "none"), lambda f: (f / "none").write_bytes(b"")),
    "one opened by Python": (lambda f: (f / "none").read_bytes(), lambda f: (f / "none").write_bytes(b"")),
    "whether a path exists": (lambda f: (f / "none").exists(), lambda f: (f / "none").mkdir()),
    "whether it is a file": (lambda f: (f / "file").is_file(), lambda f: replace_by_folder(f / "file")),
    "whether it is a folder": (lambda f: os.path.isdir(f / "file"), lambda f: replace_by_folder(f / "file")),
    "whether it is a link": (lambda f: os.path.islink(f / "none"), lambda f: (f / "none").symlink_to("nowhere")),
    "where a link leads": (lambda f: os.path.realpath(f / "link"), lambda f: turn_link(f / "link", "folder")),
    "what is behind a link": (lambda f: (f / "link").is_file(), lambda f: turn_link(f / "link", "folder")),
    "the names in a folder": (lambda f: os.listdir(f / "folder"), lambda f: (f / "folder" / "new").mkdir()),
    "the names that pathlib gives": (lambda f: [*(f / "folder").iterdir()], lambda f: (f / "folder/inner").unlink()),
    "the entries of a folder": (lambda f: list_types(f / "folder"), lambda f: replace_by_folder(f / "folder/inner")),
    "an entry behind a link": (lambda f: list_types(f / "folder"), lambda f: replace_by_folder(f / "file")),
    "a folder that is missing": (lambda f: os.listdir(f / "none"), lambda f: (f / "none").mkdir()),
    "one whose types are asked": (lambda f: list_types(f / "none"), lambda f: (f / "none").mkdir()),
    "all below a folder": (lambda f: [*os.walk(f)], lambda f: (f / "folder" / "new").write_bytes(b"")),
    "the rights": (lambda f: os.access(f / "none", os.R_OK), lambda f: (f / "none").write_bytes(b"")),
    "who may write to a folder": (lambda f: (f / "folder").stat(), lambda f: (f / "folder").chmod(0o777)),
    "a variable": (lambda _: read_variable("SOME"), lambda _: os.environ.update(SOME="set")),
    "the home": (lambda _: expand_home("~"), lambda _: os.environ.update(HOME="/nowhere")),
}


@pytest.mark.parametrize("settled", [True, False], ids=["settled", "just written"])
@pytest.mark.parametrize("name", QUESTIONS)
def test_another_answer_is_noticed(folder: Path, name: str, settled: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    for variable in ("SOME", "HOME"):
        monkeypatch.setenv(variable, "before")  # and it is put back
    monkeypatch.setattr(observations, "SETTLED_NS", -1 if settled else 2_000_000_000)
    ask, edit = QUESTIONS[name]
    seen = watch(ask, folder)
    assert seen.is_complete
    # Of a file that is new nothing is trusted but its content, and the start is not all of it.
    assert is_unchanged(seen) == (settled or name not in {"its start", "a file opened by Python"})
    edit(folder)
    assert not is_unchanged(seen)


def test_what_was_not_asked_may_change(folder: Path) -> None:
    seen = watch(lambda f: (read_regular(f / "file"), (f / "folder").is_dir(), (f / "folder/inner").exists()), folder)
    (folder / "folder" / "inner").write_bytes(b"other")
    (folder / "folder" / "new").write_bytes(b"")
    assert is_unchanged(seen)


def test_the_same_content_at_another_time_is_the_same(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(observations, "SETTLED_NS", -1)
    seen = watch(lambda f: (read_regular(f / "file"), os.listdir(f / "folder")), folder)
    os.utime(folder / "file", (1, 1))
    (folder / "folder" / "passing").write_bytes(b"")
    (folder / "folder" / "passing").unlink()
    assert is_unchanged(seen)


def test_a_change_that_keeps_size_and_time_is_noticed(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(observations, "SETTLED_NS", -1)
    file = folder / "file"
    seen = watch(lambda _: read_regular(file), folder)
    times = file.stat()
    file.write_bytes(b"new")
    os.utime(file, ns=(times.st_atime_ns, times.st_mtime_ns))
    assert not is_unchanged(seen)


def test_what_changes_while_it_is_looked_at_is_not_kept(folder: Path) -> None:
    def read_twice(folder: Path) -> None:
        read_regular(folder / "file")
        (folder / "file").write_bytes(b"longer than before")
        read_regular(folder / "file")

    assert not watch(read_twice, folder).is_complete
    shutil.rmtree(folder / "folder")
    with observe() as whole:
        (folder / "folder").exists()
        with observe() as part:
            (folder / "folder").mkdir()
            (folder / "folder").exists()
        add_observations(part)
    assert not whole.is_complete


def test_work_done_elsewhere_counts_and_folders_of_our_own_do_not(folder: Path) -> None:
    part = watch(lambda f: read_regular(f / "file"), folder)
    with observe(apart=[folder / "folder"]) as whole:
        add_observations(part)
        os.listdir(folder / "folder")
        (folder / "folder" / "inner").read_bytes()
    assert whole.contents == part.contents
    assert not whole.names
    with observe() as unknown:
        add_observations(None)
    assert not unknown.is_complete


def test_two_threads_observe_apart_and_both_to_the_end(folder: Path) -> None:
    first_ended, seen = threading.Event(), []

    def observe_longer() -> None:
        with observe() as longer:
            assert first_ended.wait(10)
            (folder / "none").exists()
        seen.append(longer)

    thread = threading.Thread(target=observe_longer)
    with observe() as shorter:
        thread.start()
        (folder / "file").exists()
    first_ended.set()
    thread.join()
    assert [str(folder / "file")] == [path for path in shorter.kinds if path.startswith(str(folder))]
    assert [str(folder / "none")] == [path for path in seen[0].kinds if path.startswith(str(folder))]
    assert os.stat.__module__ != observations.__name__


def test_variables_are_read_where_they_are_noted() -> None:
    package = Path(observations.__file__).parent.parent.parent
    rooms = ("source", "model", "policy", "checks", "export", "run")
    texts = {path: path.read_text(encoding="utf-8") for room in rooms for path in (package / room).rglob("*.py")}
    own = ("os.environ", "getenv", "expanduser", "Path.home")
    assert [str(path) for path, text in texts.items() if any(word in text for word in own)] == []


def test_the_system_is_asked_directly_again_afterwards() -> None:
    before = os.stat, os.lstat, os.listdir, os.scandir, open
    with observe():
        assert os.stat is not before[0]
    assert (os.stat, os.lstat, os.listdir, os.scandir, open) == before
