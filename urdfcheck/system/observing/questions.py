"""Questions on whose answers the outcome of a check may depend: the code that asks them says so here.

What is noted, and how all other questions about files are seen, is in :mod:`urdfcheck.system.observing.observations`. Every
start loads this module, and few observe.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from contextvars import ContextVar

# Type checkers take it for typing's, whose import takes a fifth of that of the command.
TYPE_CHECKING = False

if TYPE_CHECKING:
    from pathlib import Path
    from typing import Any, Protocol

    class Observer(Protocol):
        """What `urdfcheck.system.observing.observations.Observations` does for this module."""

        is_complete: bool

        def add_content(self, path: str | Path, status: os.stat_result | None, digest: str) -> None: ...
        def add_ignored(self, root: str, answer: Iterable[str]) -> None: ...
        def add_variable(self, name: str) -> None: ...
        def merge(self, other: Any) -> None: ...


# What was modified this recently may be modified again without a change of its timestamp (git's index has the same precaution).
SETTLED_NS = 2_000_000_000

observed: ContextVar[Observer | None] = ContextVar("observed", default=None)


def is_observing() -> bool:
    """Whether observations are being made."""
    return observed.get() is not None


def note_content(path: str | Path, status: os.stat_result | None, digest: str = "") -> None:
    """Note that the outcome depends on the content of a file; ``digest``: the SHA-256 of all of it, if that is known.

    ``status``: None where another content took its place.
    """
    observations = observed.get()
    if observations is not None:
        observations.add_content(path, status, digest)


def note_ignored(root: str, answer: Iterable[str]) -> None:
    """Note what git ignores in a folder: see `urdfcheck.system.git.list_ignored`."""
    observations = observed.get()
    if observations is not None:
        observations.add_ignored(root, answer)


def add_observations(other: Observer | None) -> None:
    """Add what a part of the work depends on that was done elsewhere; None: that is not known."""
    observations = observed.get()
    if observations is None:
        return
    if other is None:
        observations.is_complete = False
    else:
        observations.merge(other)


def read_variable(name: str, default: str | None = None) -> str | None:
    """Return the value of a variable of the environment."""
    _note_variable(name)
    return os.environ.get(name, default)


def read_folders(name: str) -> list[str]:
    """Return the folders that a variable names, separated as in ``PATH``."""
    return [folder for folder in (read_variable(name) or "").split(os.pathsep) if folder]


def expand_home(path: str) -> str:
    """Return a path with the user's home in place of ``~``."""
    _note_variable("HOME")
    return os.path.expanduser(path)


def _note_variable(name: str) -> None:
    observations = observed.get()
    if observations is not None:
        observations.add_variable(name)


def compute_sha256(data: bytes) -> str:
    """Return a digest in hex."""
    import hashlib  # loads OpenSSL: a start that reads nothing does not pay for it

    return hashlib.sha256(data).hexdigest()
