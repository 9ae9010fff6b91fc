"""``urdfcheck diff A B``: what a change does to the robot."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING

from urdfcheck.cli.options import CommandParser, add_options, build_request
from urdfcheck.cli.terminal import FAILED, FINDINGS, OK, make_progress_printer, print_document
from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.run.preload import start_warm_worker

if TYPE_CHECKING:
    from urdfcheck.run.jobs import Request

EPILOG = """\
exit codes: 0 nothing that --fail-on or a tolerance names, 1 such a change, 2 a version could not be read
"""


def build_parser() -> argparse.ArgumentParser:
    """Build the parser of ``urdfcheck diff``."""
    p = CommandParser(
        prog="urdfcheck diff",
        description="Compare two versions of a robot: structure, motion, limits, mass, shapes and findings, each with the lines "
        "that caused it.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    p.add_argument("before", metavar="A", help="the first version: a model, a package or a folder")
    p.add_argument("after", metavar="B", help="the second version: models are matched by path, name, then structure")
    p.add_argument("--format", choices=("text", "json"), default="text", help="output format (default: text)")
    p.add_argument(
        "--fail-on",
        action="append",
        default=[],
        metavar="KINDS",
        help="exit 1 for these changes: kinematic, dynamic, limits, collision, findings (new ones), any (whatever is not "
        "cosmetic), never (default)",
    )
    p.add_argument(
        "--max-tool-shift", metavar="LENGTH", help="exit 1 if a link moves farther, such as 1mm; less is tolerated"
    )
    p.add_argument(
        "--max-mass", metavar="MASS", help="exit 1 if the mass changes by more, such as 1%% or 50g; less is tolerated"
    )
    p.add_argument("-v", "--verbose", action="store_true", help="list all changes, causes and findings")
    add_options(p, "diff")
    return p


def main(words: Sequence[str]) -> int:
    """Run the command."""
    options = build_parser().parse_args(words)
    from urdfcheck.changes.gate import make_gate
    from urdfcheck.run.request import split_words

    gate = make_gate(split_words(options.fail_on), options.max_tool_shift, options.max_mass)
    if not options.before or not options.after:
        raise UrdfcheckError("a path is empty (urdfcheck diff A B)")
    warm_worker = start_warm_worker()

    from urdfcheck.changes.compare_versions import compare_versions
    from urdfcheck.run.pipeline import Execution
    from urdfcheck.system import libraries

    first, second = (_build_side(options, path) for path in (options.before, options.after))
    libraries.prefer_own_folders()
    diff = compare_versions(first, second, Execution(warm_worker=warm_worker, on_progress=make_progress_printer()))
    if options.format == "json":
        from urdfcheck.output.changes import json

        print_document(json.render(diff))
    else:
        from urdfcheck.output.changes import text

        sys.stdout.write(text.render(diff, show_all=options.verbose))
    if diff.failures:
        return FAILED
    return FINDINGS if gate.list_reasons(diff) else OK


def _build_side(options: argparse.Namespace, path: str) -> Request:
    """Return the request for one version: the options hold for both, the configuration is that of the path."""
    # `fail_on` has other values here than the severities of a check.
    request, _ = build_request(
        argparse.Namespace(**{**vars(options), "paths": [path], "fail_on": None, "verbose": False})
    )
    return request
