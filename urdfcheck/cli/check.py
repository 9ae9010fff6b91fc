"""``urdfcheck [check] PATH…``"""

from __future__ import annotations

import argparse
import importlib
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from urdfcheck import __version__
from urdfcheck.cli.options import EPILOG, Parser, add_options, ensure_paths, requested
from urdfcheck.cli.preload import prepare
from urdfcheck.cli.terminal import exit_code, progress, show_document, write
from urdfcheck.errors import UrdfcheckError

if TYPE_CHECKING:
    from urdfcheck.core import Run


def parser() -> argparse.ArgumentParser:
    """The options of ``urdfcheck check``."""
    p = Parser(
        prog="urdfcheck",
        usage="urdfcheck [check] PATH... [options]\n       urdfcheck rule [CODE]\n"
        "       urdfcheck audit DATASET... [options]\n       urdfcheck srdf MODEL [options]\n"
        "       urdfcheck cache info|clear",
        description="Audit robot models: URDF, xacro, launch files, packages and folders of them.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    p.add_argument("paths", nargs="*", metavar="PATH", help="model, launch file, mesh, package or folder")
    p.add_argument("--format", choices=("text", "json", "html"), default="text", help="what goes to standard output")
    p.add_argument(
        "-o",
        "--output",
        action="append",
        default=[],
        metavar="FORMAT=FILE",
        help="also write a report to a file (repeatable), e.g. -o html=report.html",
    )
    add_options(p)
    p.add_argument(
        "--color", choices=("auto", "always", "never"), default="auto", help="colours (default: on a terminal)"
    )
    p.add_argument("--version", action="version", version=f"urdfcheck {__version__}")
    return p


def main(words: Sequence[str]) -> int:
    """Run the command."""
    options = parser().parse_args(words)
    ensure_paths(options)
    from urdfcheck import workers

    # It loads what an audit needs while the job is being worked out here.
    first = workers.Worker.start(prepare) if workers.FORKS else None
    outputs = [_output(text) for text in options.output]
    formats = {options.format, *(name for name, _ in outputs)}

    from urdfcheck import libraries, output
    from urdfcheck.engine import run

    request, settings = requested(options, scene="html" in formats)
    libraries.prefer_own()
    outcome = run(
        request,
        first=first,
        meanwhile=lambda: [importlib.import_module(f"urdfcheck.output.{name}") for name in formats],
        progress=progress(),
    )
    _show(outcome, options.format, options.color)
    for output_format, file in outputs:
        write(output.render(outcome, output_format), file)
    return exit_code(outcome, options.fail_on or settings.fail_on, allow_empty=options.allow_empty)


def _show(run: Run, output_format: str, color: str) -> None:
    from urdfcheck import output

    if output_format != "text":
        show_document(output.render(run, output_format))
        return
    from urdfcheck.output import text

    width, colored = text.WIDTH, color == "always"  # a CI log has no width of its own
    if sys.stdout.isatty() or os.environ.keys() & {"COLUMNS", "FORCE_COLOR", "TTY_COMPATIBLE"}:
        from rich.console import Console

        # rich knows terminals, NO_COLOR and the window's width.
        terminal = Console()
        colored = colored or (color == "auto" and terminal.is_terminal and not terminal.no_color)
        width = terminal.width if terminal.is_terminal or "COLUMNS" in os.environ else width
    sys.stdout.write(text.render(run, width=width, color=colored))


def _output(text: str) -> tuple[str, Path]:
    from urdfcheck.output import FORMATS

    output_format, assigned, file = text.partition("=")
    if not assigned or not file or output_format not in FORMATS:
        raise UrdfcheckError(f"--output {text}: write FORMAT=FILE with one of the formats {', '.join(FORMATS)}")
    return output_format, Path(file)
