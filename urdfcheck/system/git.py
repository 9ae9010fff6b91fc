"""The git program, which only reads here: it starts no other program, opens no connection and writes nothing.

What a repository's own configuration would start (hooks, filters, a file system monitor) and the user's configuration are
switched off. Standard library only.
"""

from __future__ import annotations

import os
import subprocess
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from urdfcheck.core.records import dataclass
from urdfcheck.system.observing.questions import note_ignored, read_variable
from urdfcheck.system.programs import find_program, make_program_environment

# Settings and variables for every command on a repository that may be a stranger's: nothing is started, and in a clone that
# lacks an object git does not fetch it.
SETTINGS = ("core.fsmonitor=false", "safe.bareRepository=explicit", "fetch.bundleURI=")
VARIABLES = {"GIT_ALLOW_PROTOCOL": "", "GIT_NO_LAZY_FETCH": "1", "GIT_TERMINAL_PROMPT": "0"}
# The owner of the folder does not matter where nothing is started: in a container it is often another user.
_MORE_SETTINGS = (f"core.hooksPath={os.devnull}", "core.untrackedCache=false", "core.excludesFile=", "safe.directory=*")
_FLAGS = ("--no-pager", "--no-replace-objects", "--literal-pathspecs", "--no-optional-locks")
# Seconds for one command: reading the names of 80,000 files takes 0.3 s.
PATIENCE = 60.0
# Bytes of an answer: the names of a million files.
MOST_BYTES = 128 * 1024**2
# Seconds for git to list what it ignores: a pipe in the place of one of its files keeps it waiting. It takes 0.3 s for 80,000
# files.
_LISTING_PATIENCE = 5.0


class GitError(Exception):
    """git failed; the text is its message, which may name paths of this machine."""


@dataclass(frozen=True, slots=True)
class Git:
    """The program, at work in a folder."""

    program: str
    folder: str

    @classmethod
    def find(cls, folder: str | os.PathLike[str], *, outside: str | os.PathLike[str]) -> Git | None:
        """Return git for a folder; None where this machine has none outside the folder ``outside``."""
        program = find_program("git", outside=[outside])
        return None if program is None else cls(program, os.path.abspath(folder))

    def read(self, *words: str) -> bytes:
        """Return what a command prints.

        :raises GitError: if it fails, takes longer than `PATIENCE`, or prints more than `MOST_BYTES`.
        """
        with self._start(*words) as process:
            answers, errors = process.stdout, process.stderr
            assert answers is not None
            assert errors is not None
            said: list[bytes] = []
            listener = threading.Thread(target=lambda: said.append(_drain(errors)), daemon=True)
            listener.start()
            timer = threading.Timer(PATIENCE, process.kill)
            timer.start()
            try:
                answer = answers.read(MOST_BYTES + 1)
                if len(answer) > MOST_BYTES:
                    raise GitError(f"git {words[0]} prints more than {MOST_BYTES:,} bytes")
                code = process.wait()
            finally:
                timer.cancel()
                process.kill()
            listener.join(1.0)
        if code != 0:
            raise GitError(b"".join(said).decode(errors="replace").strip() or f"git {words[0]} failed")
        return answer

    @contextmanager
    def open_objects(self) -> Iterator[ObjectReader]:
        """Yield a reader of objects."""
        with self._start("cat-file", "--batch", stdin=subprocess.PIPE, stderr=subprocess.DEVNULL) as process:
            try:
                yield ObjectReader(process)
            finally:
                process.kill()

    def _start(
        self, *words: str, stdin: int = subprocess.DEVNULL, stderr: int = subprocess.PIPE
    ) -> subprocess.Popen[bytes]:
        settings = [word for setting in (*SETTINGS, *_MORE_SETTINGS) for word in ("-c", setting)]
        return subprocess.Popen(
            [self.program, *_FLAGS, *settings, "-C", self.folder, *words],
            cwd=os.path.dirname(self.program),
            env=_make_environment(),
            stdin=stdin,
            stdout=subprocess.PIPE,
            stderr=stderr,
        )


class ObjectReader:
    """Reads objects by their ids, one after the other."""

    def __init__(self, process: subprocess.Popen[bytes]) -> None:
        assert process.stdin is not None
        assert process.stdout is not None
        self._process = process
        self._asked: IO[bytes] = process.stdin
        self._answers: IO[bytes] = process.stdout

    def read_blob(self, oid: str, limit: int) -> bytes | None:
        """Return the bytes of a file, unfiltered; None if the clone does not have the object, or it has more than ``limit``.

        :raises GitError: if git ends or takes longer than `PATIENCE`.
        """
        timer = threading.Timer(PATIENCE, self._process.kill)
        timer.start()
        try:
            self._asked.write(f"{oid}\n".encode())
            self._asked.flush()
            head = self._answers.readline(1000).split()
            if len(head) == 2 and head[1] == b"missing":
                return None
            if len(head) != 3 or head[1] != b"blob":
                raise GitError("git cat-file failed")
            size = int(head[2])
            if size > limit:
                self._skip(size + 1)
                return None
            data = self._answers.read(size)
            if len(data) != size or self._answers.read(1) != b"\n":
                raise GitError("git cat-file ended too early")
            return data
        except (OSError, ValueError) as error:
            raise GitError("git cat-file failed") from error
        finally:
            timer.cancel()

    def _skip(self, count: int) -> None:
        while count > 0 and (piece := self._answers.read(min(count, 1024**2))):
            count -= len(piece)


def list_ignored(root: str, *, outside: str) -> set[str]:
    """Return the files and folders below a folder that git ignores; none outside a work tree or without git.

    ``outside``: git is searched outside this folder, which may be a stranger's. Whatever the folder's own git configuration
    would start is switched off. In a clone that lacks an object, git would fetch it with any command that this configuration
    names.
    """
    if not _may_be_in_work_tree(root):  # git would look for it in the same places, in a process of its own
        return set()
    names = _list_ignored_names(root, outside)
    # A link counts by its own place, not by its target.
    places = [os.path.split(os.path.join(root, name.rstrip("/"))) for name in names]
    found = {os.path.join(os.path.realpath(folder), name) for folder, name in places}
    note_ignored(root, found)
    return found


def _may_be_in_work_tree(root: str) -> bool:
    """Whether a repository is around a folder, or the environment names one elsewhere."""
    real = Path(os.path.realpath(root))
    named = read_variable("GIT_DIR") is not None
    return named or any(os.path.lexists(folder / ".git") for folder in (real, *real.parents))


def _list_ignored_names(root: str, outside: str) -> list[str]:
    git = find_program("git", outside=[outside])
    if git is None:
        return []
    safe = [word for setting in SETTINGS for word in ("-c", setting)]
    listing = ["ls-files", "-z", "--others", "--ignored", "--exclude-standard", "--directory"]
    try:
        done = subprocess.run(
            [git, *safe, "-C", os.path.abspath(root), *listing],
            cwd=os.path.dirname(git),
            env=make_program_environment(**VARIABLES),
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=_LISTING_PATIENCE,
            check=True,
        )
    except (OSError, subprocess.SubprocessError):
        return []
    names = [os.fsdecode(n) for n in done.stdout.split(b"\0") if n]
    return [] if "./" in names else names  # git ignores the given folder itself, but the user asked for it


def _make_environment() -> Mapping[str, str]:
    """Return the environment of git: none of the caller's variables that lead it elsewhere, as those of a hook do."""
    around = {name: value for name, value in make_program_environment().items() if not name.upper().startswith("GIT_")}
    return {
        **around,
        **VARIABLES,
        "GIT_ATTR_NOSYSTEM": "1",
        "GIT_CONFIG_GLOBAL": os.devnull,
        "GIT_CONFIG_NOSYSTEM": "1",
        "GIT_GRAFT_FILE": os.devnull,
        "GIT_NO_REPLACE_OBJECTS": "1",
        "GIT_OPTIONAL_LOCKS": "0",
        "LC_ALL": "C",
    }


def _drain(stream: IO[bytes]) -> bytes:
    """Return the start of a stream, and read the rest, so that its writer does not wait."""
    start = stream.read(4000)
    while stream.read(65536):
        pass
    return start
