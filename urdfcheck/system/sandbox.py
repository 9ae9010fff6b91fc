"""What a worker process gives up before it opens a stranger's file: writing, the network, other programs, memory and time.

None of it is what the checks rely on (an expression of a model is never Python's to run, a path is looked at before it is
opened): it is what still holds when one of them has a hole. What the platform cannot do is left out: Landlock is Linux's
from 5.13 on, its rules about TCP from 6.7 on, the limit of memory is Linux's.
"""

from __future__ import annotations

import contextlib
import errno
import os
import signal
import sys
from collections.abc import Iterable, Iterator, Mapping
from types import FrameType

from urdfcheck.core.errors import ModelTimeout

# Where a Python and the libraries that it loads later lie, beside its own folders.
_SYSTEM = (
    *("/usr", "/lib", "/lib32", "/lib64", "/opt", "/nix/store", "/gnu/store"),
    *("/etc/ld.so.cache", "/etc/ld.so.conf", "/etc/ld.so.conf.d", "/etc/localtime"),
    *("/sys/devices/system/cpu", "/dev/null", "/dev/urandom"),
)
# Audit events of Python (PEP 578) that no check of a model has a use for.
_FORBIDDEN = (
    "socket.",
    "subprocess.",
    "os.system",
    "os.exec",
    "os.posix_spawn",
    "os.fork",
    "os.kill",
    "signal.pthread_kill",
    "pty.",
    "ftplib.",
    "urllib.",
)
# Events that change files or folders, or what is known of them, with the places of the paths among their arguments and of
# the folders that these may start at. Landlock has no rule for some of them (rights, owners, times).
_CHANGES: Mapping[str, tuple[tuple[int, ...], tuple[int, ...]]] = {
    **dict.fromkeys(("os.chflags", "os.removexattr", "os.setxattr", "os.truncate"), ((0,), ())),
    **dict.fromkeys(("os.remove", "os.rmdir"), ((0,), (1,))),
    **dict.fromkeys(("os.chmod", "os.mkdir"), ((0,), (2,))),
    **dict.fromkeys(("os.chown", "os.utime"), ((0,), (3,))),
    **dict.fromkeys(("os.link", "os.rename"), ((0, 1), (2, 3))),
    "os.symlink": ((1,), (2,)),
}
# A check that does not end when it is told to is told again after so many seconds; who still goes on is killed.
AGAIN, PATIENCE = 5.0, 15.0

_confined = False


def confine(readable: Iterable[str], writable: Iterable[str], memory: int) -> None:
    """Give up all but reading below some folders (and Python's own) and writing below others; ``memory`` in MiB.

    Once for a process; it cannot be taken back.
    """
    global _confined
    if _confined:
        return
    _confined = True
    limit_memory(memory)
    libraries = os.environ.get("LD_LIBRARY_PATH", "").split(os.pathsep)
    own = (os.path.dirname(os.path.dirname(__file__)), *sys.path, sys.prefix, sys.base_prefix, *libraries)
    seen = [path for path in dict.fromkeys((*_SYSTEM, *own, *readable)) if os.path.exists(path)]
    if _restrict_by_landlock(seen, list(writable)):
        _watch_changes(tuple({os.path.realpath(path) for path in writable}))
    else:
        _watch_files(seen, list(writable))
    sys.addaudithook(_refuse_event)


def _refuse_event(event: str, _arguments: object) -> None:
    if event.startswith(_FORBIDDEN):
        raise PermissionError(f"the check of a model has no use for {event}")


def _watch_files(readable: list[str], writable: list[str]) -> None:
    """Where the kernel does not: have Python look at each path that it opens."""
    import tempfile

    reading = tuple({os.path.realpath(path) for path in (*readable, *writable)})
    writing = tuple({os.path.realpath(path) for path in (*writable, tempfile.gettempdir())})

    def refuse_path(event: str, arguments: tuple[object, ...]) -> None:
        if event == "open" and isinstance(arguments[0], (str, bytes)):
            flags = arguments[2] if isinstance(arguments[2], int) else 0
            changes = flags & (os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC)
            _ensure_below(arguments[0], writing if changes else reading)
        elif event in {"os.listdir", "os.scandir"} and not isinstance(arguments[0], int):
            _ensure_below(arguments[0] or os.curdir, reading)

    sys.addaudithook(refuse_path)
    _watch_changes(writing)


def _watch_changes(writing: tuple[str, ...]) -> None:
    """Have Python look at each path at which it changes something."""

    def refuse_change(event: str, arguments: tuple[object, ...]) -> None:
        if event in _CHANGES:
            paths, folders = _CHANGES[event]
            for place in paths:
                _ensure_below(arguments[place], writing)
            if any(arguments[place] != -1 for place in folders):
                raise PermissionError(f"the check of a model has no use for {event} in an open folder")

    sys.addaudithook(refuse_change)


def _ensure_below(path: object, folders: tuple[str, ...]) -> None:
    # What is open already (a number) was opened for reading, or is the parent's.
    real = os.path.realpath(os.fsdecode(path)) if isinstance(path, (str, bytes, os.PathLike)) else str(path)
    if not any(real == folder or real.startswith(folder.rstrip(os.sep) + os.sep) for folder in folders):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), real)


def limit_memory(memory: int) -> None:
    """Bound what this process may allocate, in MiB, where the platform can."""
    if sys.platform == "win32":
        return
    import resource

    with contextlib.suppress(ValueError, OSError):  # a stricter limit holds already
        resource.setrlimit(resource.RLIMIT_DATA, (memory * 1024**2, memory * 1024**2))
    with contextlib.suppress(ValueError, OSError):  # what a process held when it crashed is nobody's to keep
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def _restrict_by_landlock(readable: list[str], writable: list[str]) -> bool:
    """Whether the kernel sees to it that nothing else is opened."""
    if sys.platform != "linux":
        return False
    try:
        from py_landlock import AccessFs, Landlock, LandlockError
    except ImportError:
        return False
    rules = Landlock(strict=False)
    try:
        for path in readable:
            both = AccessFs.READ_FILE | AccessFs.READ_DIR
            rules.add_path_rule(path, access=both if os.path.isdir(path) else AccessFs.READ_FILE)
        for path in writable:
            rules.allow_read_write(path)
        rules.apply()
    except (LandlockError, OSError):  # a kernel without it, or with it switched off
        return False
    return True


@contextlib.contextmanager
def enforce_deadline(seconds: float) -> Iterator[None]:
    """Raise `ModelTimeout` in what runs inside when so much time has passed, and again every few seconds if it goes on.

    A loop in compiled code does not hear of it: whoever started the process kills it then, and the kernel does when that one
    has gone (on Windows, nobody does).
    """
    if sys.platform == "win32" or not seconds:
        yield
        return
    import resource

    def raise_timeout(_signal: int, _frame: FrameType | None) -> None:
        raise ModelTimeout

    before = signal.signal(signal.SIGALRM, raise_timeout)
    used = resource.getrusage(resource.RUSAGE_SELF)
    soft, hard = resource.getrlimit(resource.RLIMIT_CPU)
    last = int(used.ru_utime + used.ru_stime + seconds + 2 * PATIENCE) + 1
    try:
        resource.setrlimit(resource.RLIMIT_CPU, (last if hard == resource.RLIM_INFINITY else min(last, hard), hard))
        signal.setitimer(signal.ITIMER_REAL, seconds, AGAIN)
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
        resource.setrlimit(resource.RLIMIT_CPU, (soft, hard))
