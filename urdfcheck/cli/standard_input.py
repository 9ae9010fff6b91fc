"""A model on standard input (``urdfcheck -``): from a pipe, or from an editor whose buffer is not saved."""

from __future__ import annotations

import argparse
import os
import sys

from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.system.files import MAX_TEXT

STDIN = "-"
# What it is called where no name is given.
_NAME, _XACRO_NAME = "stdin.urdf", "stdin.urdf.xacro"


def read_given_file(options: argparse.Namespace) -> dict[str, bytes]:
    """Read the model where a path is ``-``, and put its name into the paths; nothing where there is none.

    Return its content by real path, for :class:`urdfcheck.run.jobs.AuditOptions`.

    :raises UrdfcheckError: if other paths are given too, or if it is too large or missing.
    """
    if STDIN not in options.paths:
        return {}
    if options.paths != [STDIN]:
        raise UrdfcheckError("standard input (-) is checked alone: leave out the other paths")
    if options.stdin_filename == "" or os.path.isdir(options.stdin_filename or ""):
        raise UrdfcheckError(f"--stdin-filename {options.stdin_filename}: name a file")
    data = b"" if sys.stdin is None else sys.stdin.buffer.read(MAX_TEXT + 1)
    if len(data) > MAX_TEXT:
        raise UrdfcheckError(f"standard input has more than {MAX_TEXT:,} bytes, the limit for a file")
    if not data.strip():
        raise UrdfcheckError("standard input is empty; the command that writes to it has probably failed")
    uses_xacro = b"<xacro:" in data or (b"xmlns:xacro" in data and b"${" in data)
    name = options.stdin_filename or (_XACRO_NAME if uses_xacro else _NAME)
    options.paths = [name]
    return {os.path.realpath(name): data}
