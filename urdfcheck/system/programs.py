"""Find a program of this machine, and not one that lies in what is checked."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Mapping

from urdfcheck.system.files import is_inside


def find_program(name: str, *, outside: Iterable[str | os.PathLike[str]]) -> str | None:
    """Return the absolute path of a program; None where there is none.

    It is looked for in the absolute folders of ``PATH`` that lie outside the folders ``outside``: an empty or relative entry
    means the working directory, which Windows searches before all others even so.
    """
    refused = [os.path.realpath(folder) for folder in outside]
    file = f"{name}.exe" if sys.platform == "win32" else name
    for folder in _list_absolute_folders():
        path = os.path.join(folder, file)
        places = (os.path.realpath(folder), os.path.realpath(path))
        if any(is_inside(place, root) for place in places for root in refused):
            continue
        if os.path.isfile(path) and os.access(path, os.X_OK):
            return path
    return None


def make_program_environment(**variables: str) -> Mapping[str, str]:
    """Return the environment for such a program, which looks for others in absolute folders only."""
    return {
        **os.environ,
        "PATH": os.pathsep.join(_list_absolute_folders()),
        "NoDefaultCurrentDirectoryInExePath": "1",
        **variables,
    }


def _list_absolute_folders() -> list[str]:
    return [folder for folder in os.environ.get("PATH", os.defpath).split(os.pathsep) if os.path.isabs(folder)]
