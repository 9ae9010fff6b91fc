"""What a worker process gives up before it opens an untrusted file: writing, the network, other programs, memory and time.

This is the second line of defence. The checks do not rely on it (Python never runs an expression of a model, and a path is
examined before it is opened); it holds if one of them has a vulnerability. What the platform does not support is left out:
Landlock needs Linux 5.13, its TCP rules Linux 6.7, and the memory limit Linux.
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
from urdfcheck.core.records import dataclass

# Where Python and the libraries that it loads later are installed, besides its own folders.
_SYSTEM = (
    *("/usr", "/lib", "/lib32", "/lib64", "/opt", "/nix/store", "/gnu/store"),
    *("/etc/ld.so.cache", "/etc/ld.so.conf", "/etc/ld.so.conf.d", "/etc/localtime"),
    *("/sys/devices/system/cpu", "/dev/null", "/dev/urandom"),
)
# Audit events of Python (PEP 578) that no check of a model needs.
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
# Audit events that change files, folders or their metadata, with the argument indices of their paths and of the folder
# descriptors that the paths may be relative to. Landlock has no rule for some of them (permissions, owners, times).
_CHANGES: Mapping[str, tuple[tuple[int, ...], tuple[int, ...]]] = {
    **dict.fromkeys(("os.chflags", "os.removexattr", "os.setxattr", "os.truncate"), ((0,), ())),
    **dict.fromkeys(("os.remove", "os.rmdir"), ((0,), (1,))),
    **dict.fromkeys(("os.chmod", "os.mkdir"), ((0,), (2,))),
    **dict.fromkeys(("os.chown", "os.utime"), ((0,), (3,))),
    **dict.fromkeys(("os.link", "os.rename"), ((0, 1), (2, 3))),
    "os.symlink": ((1,), (2,)),
}
# Seconds after which a check that ignores the deadline is interrupted again, and after which it is killed.
AGAIN, PATIENCE = 5.0, 15.0


@dataclass(slots=True)
class _ProcessState:
    """What this process has given up."""

    confined: bool = False


_state = _ProcessState()


def confine(readable: Iterable[str], writable: Iterable[str], memory: int) -> None:
    """Give up everything but reading below some folders (and Python's own) and writing below others; ``memory`` in MiB.

    Takes effect once per process and cannot be undone.
    """
    if _state.confined:
        return
    _state.confined = True
    limit_memory(memory)
    libraries = os.environ.get("LD_LIBRARY_PATH", "").split(os.pathsep)
    own = (os.path.dirname(os.path.dirname(__file__)), *sys.path, sys.prefix, sys.base_prefix, *libraries)
    visible = [path for path in dict.fromkeys((*_SYSTEM, *own, *readable)) if os.path.exists(path)]
    if _restrict_by_landlock(visible, list(writable)):
        _watch_changes(tuple({os.path.realpath(path) for path in writable}))
    else:
        _watch_files(visible, list(writable))
    sys.addaudithook(_refuse_event)


def _refuse_event(event: str, _arguments: object) -> None:
    if event.startswith(_FORBIDDEN):
        raise PermissionError(f"the check of a model has no use for {event}")


def _watch_files(readable: list[str], writable: list[str]) -> None:
    """Check each path that Python opens, where the kernel does not."""
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
    """Check each path at which Python changes something."""

    def refuse_change(event: str, arguments: tuple[object, ...]) -> None:
        if event in _CHANGES:
            paths, folders = _CHANGES[event]
            for place in paths:
                _ensure_below(arguments[place], writing)
            if any(arguments[place] != -1 for place in folders):
                raise PermissionError(f"the check of a model has no use for {event} in an open folder")

    sys.addaudithook(refuse_change)


def _ensure_below(path: object, folders: tuple[str, ...]) -> None:
    # A descriptor (a number) was opened for reading, or by the parent.
    real = os.path.realpath(os.fsdecode(path)) if isinstance(path, (str, bytes, os.PathLike)) else str(path)
    if not any(real == folder or real.startswith(folder.rstrip(os.sep) + os.sep) for folder in folders):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), real)


def limit_memory(memory: int) -> None:
    """Limit what this process may allocate, in MiB, where the platform supports it."""
    if sys.platform == "win32":
        return
    import resource

    with contextlib.suppress(ValueError, OSError):  # a stricter limit is set already
        resource.setrlimit(resource.RLIMIT_DATA, (memory * 1024**2, memory * 1024**2))
    with contextlib.suppress(ValueError, OSError):  # no core dump, which would keep the contents of the memory
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def limit_file_size(size: int) -> None:
    """Limit each file that this process writes to ``size`` MiB, where the platform supports it."""
    if sys.platform == "win32":
        return
    import resource

    with contextlib.suppress(ValueError, OSError):  # a stricter limit is set already
        resource.setrlimit(resource.RLIMIT_FSIZE, (size * 1024**2, size * 1024**2))


def _restrict_by_landlock(readable: list[str], writable: list[str]) -> bool:
    """Restrict file access with Landlock; return whether the kernel supports it."""
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
    except (LandlockError, OSError):  # the kernel lacks it, or it is disabled
        return False
    return True


@contextlib.contextmanager
def enforce_deadline(seconds: float) -> Iterator[None]:
    """Raise `ModelTimeout` inside the context after so many seconds, and again every few seconds while it continues.

    A loop in compiled code cannot be interrupted: the parent kills the process then, or the kernel does if the parent has
    exited (on Windows, nothing does).
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
