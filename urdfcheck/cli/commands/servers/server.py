"""``urdfcheck server``: a language server on standard input and output, for editors."""

from __future__ import annotations

import argparse
import importlib.util
from collections.abc import Sequence

from urdfcheck.cli.options import CommandParser, add_options, read_options
from urdfcheck.cli.terminal import OK
from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.system.installation import name_distribution


def build_parser() -> argparse.ArgumentParser:
    """Build the parser of ``urdfcheck server``."""
    p = CommandParser(
        prog="urdfcheck server",
        description="Speak the Language Server Protocol on standard input and output: what is in an editor's buffers is checked.",
        epilog="ends with its client",
    )
    p.add_argument("--stdio", action="store_true", help="does nothing: there is no other way to speak with it")
    add_options(p, "server")
    return p


def main(words: Sequence[str]) -> int:
    """Run the command."""
    options = build_parser().parse_args(words)
    if importlib.util.find_spec("pygls") is None:
        raise UrdfcheckError(f"the language server needs pygls: pip install '{name_distribution()}[server]'")
    run_options = read_options(options, ())

    from urdfcheck.server.language_server import serve

    serve(run_options)
    return OK
