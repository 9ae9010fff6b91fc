"""``urdfcheck mcp [FOLDER]``: the tools for language models, on standard input and output."""

from __future__ import annotations

import argparse
import importlib.util
import os
from collections.abc import Sequence
from pathlib import Path

from urdfcheck.cli.options import CommandParser
from urdfcheck.cli.terminal import OK
from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.system.installation import name_distribution


def build_parser() -> argparse.ArgumentParser:
    """Build the parser of ``urdfcheck mcp``."""
    p = CommandParser(
        prog="urdfcheck mcp",
        description="Serve the checks to a language model by the Model Context Protocol, on standard input and output. Paths "
        "stay in the folder; files are written only where the model asks for it.",
    )
    p.add_argument(
        "folder", nargs="?", default=".", type=Path, help="where the models are (default: the working directory)"
    )
    return p


def main(words: Sequence[str]) -> int:
    """Run the server until its client ends."""
    folder = build_parser().parse_args(words).folder
    if not folder.is_dir():
        raise UrdfcheckError(f"{folder} is not a folder")
    if importlib.util.find_spec("mcp") is None:
        raise UrdfcheckError(f'the server needs the package mcp: pip install "{name_distribution()}[mcp]"')
    from urdfcheck.mcp.server import build_server

    os.chdir(folder)  # paths are named from there
    build_server(Path()).run("stdio")
    return OK
