"""Variables of the environment on which the outcome of a check may depend: they are read here only, so that it is known which."""

from __future__ import annotations

import os

from urdfcheck.system.observations import note_variable


def read_variable(name: str, default: str | None = None) -> str | None:
    """Return the value of a variable."""
    note_variable(name)
    return os.environ.get(name, default)


def read_folders(name: str) -> list[str]:
    """Return the folders that a variable names, separated as in ``PATH``."""
    return [folder for folder in (read_variable(name) or "").split(os.pathsep) if folder]


def expand_home(path: str) -> str:
    """Return a path with the user's home in place of ``~``."""
    note_variable("HOME")
    return os.path.expanduser(path)
