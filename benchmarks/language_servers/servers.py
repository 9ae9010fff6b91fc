"""The language servers that are compared; ``python benchmarks/language_servers/servers.py FOLDER`` installs the other one.

It gets an environment of its own in the folder, and is never a dependency of urdfcheck.
"""

from __future__ import annotations

import subprocess
import sys
import venv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from urdfcheck.version import __version__

OWN = "urdfcheck"
OTHER = "pyros-lsp"


@dataclass(frozen=True, slots=True, kw_only=True)
class Server:
    """A language server, ready to be started."""

    name: str
    command: tuple[str, ...]
    options: Mapping[str, Any]
    """Initialization options."""
    end_command: str = ""
    """The command that answers when everything is checked; without one the server logs a line about each document at the end."""


# What the other server expands xacro with is an extra of it: without this package it has no physics of a xacro file.
REQUIREMENTS = ("pyros-robotics==2.1.0", "xacro==2.1.1")


def make_own_server(arguments: Mapping[str, str], folders: Sequence[Path] = ()) -> Server:
    """Describe urdfcheck's server.

    :param arguments: values of xacro arguments.
    :param folders: folders that it may read beside that of the file.
    """
    words = [word for name, value in arguments.items() for word in ("--arg", f"{name}:={value}")]
    words += [word for folder in folders for word in ("--allow-read", str(folder))]
    command = (sys.executable, "-m", OWN, "server", "--isolated", *words)
    return Server(name=OWN, command=command, options={}, end_command="urdfcheck.check")


def make_other_server(environments: Path, entry: Path, arguments: Mapping[str, str]) -> Server:
    """Describe pyros-lsp.

    :param environments: the folder that `main` filled.
    :param entry: the file to which the xacro arguments belong.
    """
    command = (str(environments / OTHER / "bin" / OTHER),)
    options = {"xacro_args": {str(entry): dict(arguments)}} if arguments else {}
    return Server(name=OTHER, command=command, options=options)


def list_versions() -> dict[str, str]:
    """Return the version of each server that is compared."""
    return {OWN: __version__, OTHER: REQUIREMENTS[0].partition("==")[2]}


def main() -> None:
    """Make the environment."""
    place = Path(sys.argv[1]) / OTHER
    venv.create(place, with_pip=True)
    subprocess.run([place / "bin" / "pip", "install", "--quiet", *REQUIREMENTS], check=True)


if __name__ == "__main__":
    main()
