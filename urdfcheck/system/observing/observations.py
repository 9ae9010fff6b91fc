"""What the outcome of some work depends on: everything that it asked the file system, the environment and git.

`observe` records each question with its answer while the work is done. As long as all of them have the same answers
(`Recheck`), the work would have the same outcome. Questions about files are seen where Python asks them, in the functions of
:mod:`os`, so that no check needs to say what it reads; the content of a file is noted where it is read.

Imports are not seen: they do not call these functions. What they load is the installation, which has its own stamp
(:mod:`urdfcheck.system.installation`).
"""

from __future__ import annotations

import builtins
import io
import os
import pathlib
import stat
import time
from _thread import allocate_lock
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import field
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from urdfcheck.core.records import dataclass
from urdfcheck.system.observing.questions import SETTLED_NS, compute_sha256, observed

if TYPE_CHECKING:
    from typing_extensions import Self  # of typing since Python 3.11

# Size in bytes, times of the last change of content and of anything in ns, and inode.
FileStamp = tuple[int, int, int, int]
# Stamp and SHA-256, the latter of a folder's names; no stamp where it was too new to trust it, no digest where it is unknown.
Version = tuple[FileStamp | None, str]
# Not files of anybody: what the kernel says of this process and machine.
_KERNEL = ("/proc/", "/sys/", "/dev/")
# Of the mode of a file, what tells a caller more than its content: its type, and for a folder who may write there.
_TYPE = 0o170000
_TABLES_OF_VERSIONS = 3


@dataclass(slots=True)
class Observations:
    """Questions with their answers, by absolute path. A number that is negative is the error that the system gave."""

    contents: dict[str, Version] = field(default_factory=dict)
    """The files that were read."""
    kinds: dict[str, int] = field(default_factory=dict)
    """What is at a path, links followed: the type of its mode."""
    links: dict[str, int] = field(default_factory=dict)
    """The same, links not followed."""
    targets: dict[str, str | int] = field(default_factory=dict)
    """Where links lead."""
    names: dict[str, Version] = field(default_factory=dict)
    """The folders that were listed, or could not be."""
    entries: dict[str, Version] = field(default_factory=dict)
    """The same with the type of each entry."""
    rights: dict[str, bool] = field(default_factory=dict)
    """Answers of `os.access`, by path and mode."""
    variables: dict[str, str] = field(default_factory=dict)
    """Digests of environment variables; empty where one is not set."""
    ignored: dict[str, str] = field(default_factory=dict)
    """Folders of which git was asked what it ignores, with digests of its answers."""
    is_complete: bool = True
    """Whether these are all questions, and none had two answers."""
    apart: tuple[str, ...] = _KERNEL
    """Folders, each with a separator at its end, about which questions do not count."""

    def merge(self, other: Observations) -> None:
        """Add what another piece of work depends on."""
        self.is_complete = self.is_complete and other.is_complete
        for place, (own, more) in enumerate(zip(self.list_tables(), other.list_tables(), strict=True)):
            add = self.add_version if place < _TABLES_OF_VERSIONS else self.add_answer
            for question, answer in more.items():
                add(own, question, answer)

    def add_answer(self, table: dict[str, Any], question: str, answer: object) -> None:
        """Add an answer to one of the tables."""
        if not f"{question}{os.sep}".startswith(self.apart) and table.setdefault(question, answer) != answer:
            self.is_complete = False

    def add_version(self, table: dict[str, Version], question: str, version: Version) -> None:
        """Add the version of a file or folder to one of the tables."""
        if f"{question}{os.sep}".startswith(self.apart):
            return
        known = table.setdefault(question, version)
        if known == version:
            return
        (stamp, digest), (other_stamp, other_digest) = known, version
        if stamp != other_stamp and (digest != other_digest or not digest):
            self.is_complete = False  # it changed meanwhile, as far as is known
        if digest and other_digest and digest != other_digest:
            self.is_complete = False
        table[question] = (stamp if stamp == other_stamp else None), digest or other_digest

    def add_content(self, path: str | Path, status: os.stat_result | None, digest: str) -> None:
        """Add what `note_content` notes."""
        if status is None:
            self.is_complete = False
            return
        name = _complete(path)
        if name.startswith(_KERNEL):
            self.is_complete = False
        self.add_version(self.contents, name, (_make_settled_stamp(status), digest))

    def add_ignored(self, root: str, answer: Iterable[str]) -> None:
        """Add what `note_ignored` notes."""
        self.ignored[_complete(root)] = _digest_names(answer)

    def add_variable(self, name: str) -> None:
        """Add a variable with its value."""
        self.variables[name] = _digest_variable(name)

    def list_tables(self) -> tuple[dict[str, Any], ...]:
        """Return all tables, always in the same order: first those of versions."""
        return (
            *(self.contents, self.names, self.entries),
            *(self.kinds, self.links, self.targets, self.rights, self.variables, self.ignored),
        )


# -- answers ---------------------------------------------------------------------------------------------------------


def _complete(path: str | Path) -> str:
    """Return an absolute path that means the same; ``..`` stays, for a link before it may lead elsewhere."""
    name = os.fspath(path)
    return name if os.path.isabs(name) else os.path.join(os.getcwd(), name)


def _make_stamp(status: os.stat_result) -> FileStamp:
    return status.st_size, status.st_mtime_ns, status.st_ctime_ns, status.st_ino


def _make_settled_stamp(status: os.stat_result) -> FileStamp | None:
    """Return the stamp of a file that was just read; None if the file may change without changing it."""
    newest = max(status.st_mtime_ns, status.st_ctime_ns)
    return _make_stamp(status) if time.time_ns() - newest > SETTLED_NS else None


def _classify(status: os.stat_result) -> int:
    writable = stat.S_IWOTH if stat.S_ISDIR(status.st_mode) else 0
    return status.st_mode & (_TYPE | writable)


def _digest_names(names: Iterable[str]) -> str:
    return compute_sha256("\0".join(sorted(names)).encode("utf-8", "surrogatepass"))


def _digest_variable(name: str) -> str:
    value = os.environ.get(name)
    return "" if value is None else compute_sha256(value.encode("utf-8", "surrogatepass"))


def _describe_entry(entry: os.DirEntry[str]) -> str:
    kind = "l" if entry.is_symlink() else "d" if entry.is_dir(follow_symlinks=False) else "f"
    return f"{kind}{entry.name}"


# -- observing ---------------------------------------------------------------------------------------------------------

# The functions that ask the system, as they are where nothing is observed.
_system: dict[str, Any] = {name: getattr(os, name, None) for name in ("stat", "lstat", "listdir", "scandir", "access")}
_system |= {"readlink": getattr(os, "readlink", None), "open": builtins.open}


# Whoever observes while another thread does takes part in the same replacement of the functions.
_lock = allocate_lock()
_replaced: list[tuple[Any, str, Any]] = []
_observers = [0]


@contextmanager
def observe(apart: Iterable[str | Path] = ()) -> Iterator[Observations]:
    """Record what is asked inside the context, by this thread. ``apart``: urdfcheck's own folders, such as the cache."""
    own = (f"{form(folder)}{os.sep}" for folder in apart for form in (os.path.abspath, os.path.realpath))
    observations = Observations(apart=(*own, *_KERNEL))
    token = observed.set(observations)
    _replace_functions()
    try:
        observations.is_complete = _can_observe()
        yield observations
    finally:
        _restore_functions()
        observed.reset(token)
        for table in observations.list_tables():
            table.pop(_PROBE, None)


@contextmanager
def pause_observing() -> Iterator[None]:
    """Do work inside the context of which nothing is recorded: the caller adds what the outcome depends on."""
    token = observed.set(None)
    try:
        yield
    finally:
        observed.reset(token)


def _replace_functions() -> None:
    with _lock:
        _observers[0] += 1
        if _observers[0] > 1:
            return
        _system.update({name: getattr(os, name) for name in _system if hasattr(os, name)}, open=builtins.open)
        for place, name, function in _list_places():
            _replaced.append((place, name, place.__dict__[name]))
            setattr(place, name, function)


def _restore_functions() -> None:
    with _lock:
        _observers[0] -= 1
        if not _observers[0]:
            while _replaced:
                place, name, function = _replaced.pop()
                setattr(place, name, function)


def _get_current() -> Observations | None:
    """Return the observations that are being made."""
    current = observed.get()
    assert current is None or isinstance(current, Observations)
    return current


# A file that nobody has.
_PROBE = f"{os.sep}.urdfcheck-probe"


@cache
def _can_observe() -> bool:
    """Whether the questions of Python's own modules are seen, which another version may ask in another way, as on Windows."""
    seen, probe = _get_current(), Path(_PROBE)
    assert seen is not None
    asked: tuple[tuple[Callable[[], object], dict[str, Any]], ...] = (
        (probe.exists, seen.kinds),
        (probe.is_file, seen.kinds),
        (probe.is_dir, seen.kinds),
        (probe.is_symlink, seen.links),
        (probe.resolve, seen.links),
        (lambda: os.path.exists(probe), seen.kinds),
        (lambda: os.path.isdir(probe), seen.kinds),
        (lambda: os.path.isfile(probe), seen.kinds),
        (lambda: os.path.lexists(probe), seen.links),
        (lambda: os.path.islink(probe), seen.links),
    )
    for ask, table in asked:
        table.pop(_PROBE, None)
        ask()
        if _PROBE not in table:
            return False
    return True


def _list_places() -> list[tuple[Any, str, Any]]:
    """Return the modules and classes that hold functions of the system, with the names and what takes their place."""
    functions: dict[str, Any] = {
        "stat": _observing_stat,
        "lstat": _observing_lstat,
        "listdir": _observing_listdir,
        "scandir": _ObservedFolder,
        "access": _observing_access,
    }
    if _system["readlink"] is not None:
        functions["readlink"] = _observing_readlink
    places = [(os, name, function) for name, function in functions.items()]
    places += [(module, "open", _observing_open) for module in (builtins, io)]
    accessor = getattr(pathlib, "_NormalAccessor", None)  # of Python 3.10, which keeps the functions
    if accessor is not None:
        functions["open"] = _observing_open
        places += [(accessor, name, staticmethod(f)) for name, f in functions.items() if name in accessor.__dict__]
    return places


def _name_path(path: Any) -> str | None:
    """Return the absolute path that a function of the system was asked about; None for an open file."""
    if isinstance(path, int):
        return None
    name = os.fsdecode(path)
    return _complete(name) if name and "\0" not in name else None


def _ask_kind(table: str, function: Callable[..., os.stat_result], path: Any, options: Mapping[str, Any]) -> Any:
    """Call a function of the system, and note the type of what is there, or the error."""
    seen = _get_current()
    name = None if seen is None or options.get("dir_fd") is not None else _name_path(path)
    if seen is None or name is None:
        return function(path, **options)
    answers: dict[str, int] = getattr(seen, table)
    try:
        status = function(path, **options)
    except OSError as error:
        seen.add_answer(answers, name, -(error.errno or 1))
        raise
    seen.add_answer(answers, name, _classify(status))
    return status


def _observing_stat(path: Any, **options: Any) -> os.stat_result:
    table = "kinds" if options.get("follow_symlinks", True) else "links"
    status: os.stat_result = _ask_kind(table, _system["stat"], path, options)
    return status


def _observing_lstat(path: Any, **options: Any) -> os.stat_result:
    status: os.stat_result = _ask_kind("links", _system["lstat"], path, options)
    return status


def _observing_readlink(path: Any, **options: Any) -> Any:
    seen = _get_current()
    name = None if seen is None or options else _name_path(path)
    if seen is None or name is None:
        return _system["readlink"](path, **options)
    try:
        target = _system["readlink"](path)
    except OSError as error:
        seen.add_answer(seen.targets, name, -(error.errno or 1))
        raise
    seen.add_answer(seen.targets, name, os.fsdecode(target))
    return target


def _observing_access(path: Any, mode: int, **options: Any) -> bool:
    may = bool(_system["access"](path, mode, **options))
    seen = _get_current()
    name = None if seen is None else _name_path(path)
    if seen is not None and name is not None:
        seen.add_answer(seen.rights, f"{name} {mode}", may)
    return may


def _observing_listdir(path: Any = None) -> Any:
    path = os.curdir if path is None else path
    seen = _get_current()
    name = None if seen is None else _name_path(path)
    if seen is None or name is None:
        return _system["listdir"](path)
    stamp = _stamp_folder(name)
    try:
        names = _system["listdir"](path)
    except OSError:
        _note_unlisted(seen, seen.names, name, stamp)
        raise
    seen.add_version(seen.names, name, (stamp, _digest_names(map(os.fsdecode, names))))
    return names


class _ObservedFolder:
    """What `os.scandir` returns."""

    def __init__(self, path: Any = None) -> None:
        path = os.curdir if path is None else path
        seen = _get_current()
        name = None if seen is None else _name_path(path)
        if seen is None or name is None:
            with _system["scandir"](path) as found:
                self._entries = iter(list(found))
            return
        stamp = _stamp_folder(name)
        try:
            with _system["scandir"](path) as found:
                entries = list(found)
        except OSError:
            _note_unlisted(seen, seen.entries, name, stamp)
            raise
        seen.add_version(seen.entries, name, (stamp, _digest_names(map(_describe_entry, entries))))
        for entry in entries:
            if entry.is_symlink():  # the entry itself asks what the link leads to without these functions
                _probe(entry.path)
        self._entries = iter(entries)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __iter__(self) -> Iterator[os.DirEntry[str]]:
        return self._entries

    def __next__(self) -> os.DirEntry[str]:
        return next(self._entries)

    def close(self) -> None:
        """Do nothing: the folder is closed already."""


def _probe(path: str) -> None:
    """Note what is at a path."""
    try:
        _observing_stat(path)
    except (OSError, ValueError):
        return


def _stamp_folder(name: str) -> FileStamp | None:
    """Return the stamp of a folder, taken before it is listed."""
    try:
        return _make_settled_stamp(_system["stat"](name))
    except OSError:
        return None


def _note_unlisted(seen: Observations, table: dict[str, Version], name: str, stamp: FileStamp | None) -> None:
    """Note that a folder could not be listed: most often because it does not exist."""
    _probe(name)
    if _read_kind(_system["stat"], name) > 0:
        seen.add_version(table, name, (stamp, ""))


def _observing_open(file: Any, mode: str = "r", *words: Any, **options: Any) -> Any:
    """Open a file with Python's own function; what is read through `urdfcheck.system.files` has its digest too."""
    seen = _get_current()
    name = None if seen is None else _name_path(file)
    if seen is None or name is None or set(mode) & set("wax+"):
        return _system["open"](file, mode, *words, **options)
    try:
        opened = _system["open"](file, mode, *words, **options)
    except OSError as error:
        seen.add_answer(seen.kinds, name, -(error.errno or 1))
        raise
    if not name.startswith(_KERNEL):
        seen.add_content(name, os.fstat(opened.fileno()), "")
    return opened


# -- checking again ----------------------------------------------------------------------------------------------------


class Recheck:
    """Asks again. Each question is asked once, for many observations; so an object holds for a moment only."""

    def __init__(self, digest_file: Callable[[Path], str], list_ignored: Callable[[str], Iterable[str]]) -> None:
        """``digest_file``: returns the SHA-256 of a file; ``list_ignored``: asks git."""
        self._digest_file = digest_file
        self._list_ignored = list_ignored
        self._known: dict[tuple[str, str, object], bool] = {}

    def is_unchanged(self, observations: Observations) -> bool:
        """Whether every question has the same answer as it had."""
        questions: tuple[tuple[str, Mapping[str, Any], Callable[[str, Any], bool]], ...] = (
            ("contents", observations.contents, self._has_content),
            ("kinds", observations.kinds, lambda path, kind: _read_kind(_system["stat"], path) == kind),
            ("links", observations.links, lambda path, kind: _read_kind(_system["lstat"], path) == kind),
            ("targets", observations.targets, _leads_to),
            ("names", observations.names, _has_names),
            ("entries", observations.entries, _has_entries),
            ("rights", observations.rights, _has_right),
            ("variables", observations.variables, lambda name, digest: _digest_variable(name) == digest),
            ("ignored", observations.ignored, self._is_ignored_alike),
        )
        known = self._known
        for table, answers, is_same in questions:
            for question, answer in answers.items():
                key = table, question, answer
                same = known.get(key)
                if same is None:
                    same = known[key] = is_same(question, answer)
                if not same:
                    return False
        return observations.is_complete

    def _has_content(self, path: str, answer: Version) -> bool:
        stamp, digest = answer
        try:
            if stamp is not None and _make_stamp(_system["stat"](path)) == stamp:
                return True
            return bool(digest) and self._digest_file(Path(path)) == digest
        except (OSError, ValueError):
            return False

    def _is_ignored_alike(self, root: str, digest: str) -> bool:
        return _digest_names(self._list_ignored(root)) == digest


def _read_kind(function: Callable[[str], os.stat_result], path: str) -> int:
    try:
        return _classify(function(path))
    except OSError as error:
        return -(error.errno or 1)


def _leads_to(path: str, target: str | int) -> bool:
    try:
        return os.fsdecode(_system["readlink"](path)) == target
    except OSError as error:
        return -(error.errno or 1) == target


def _has_right(question: str, may: bool) -> bool:
    path, _, mode = question.rpartition(" ")
    return bool(_system["access"](path, int(mode))) == may


def _has_names(path: str, answer: Version) -> bool:
    return _has_listing(path, answer, lambda: _digest_names(_system["listdir"](path)))


def _has_entries(path: str, answer: Version) -> bool:
    def list_again() -> str:
        with _system["scandir"](path) as entries:
            return _digest_names(map(_describe_entry, entries))

    return _has_listing(path, answer, list_again)


def _has_listing(path: str, answer: Version, list_again: Callable[[], str]) -> bool:
    stamp, digest = answer
    try:
        if stamp is not None and _make_stamp(_system["stat"](path)) == stamp:
            return True
        return bool(digest) and list_again() == digest
    except OSError:
        return False
