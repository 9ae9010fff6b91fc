"""``urdfcheck [check] PATH…``"""

from __future__ import annotations

import argparse
import importlib
import sys
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from urdfcheck import __version__
from urdfcheck.cli.options import EPILOG, Parser, add_options, ensure_paths, output_file, requested
from urdfcheck.cli.preload import prepare
from urdfcheck.cli.terminal import FINDINGS, OK, exit_code, progress, say, show, write
from urdfcheck.errors import UrdfcheckError

if TYPE_CHECKING:
    from urdfcheck.core import Finding
    from urdfcheck.fixer import Fixes


def parser() -> argparse.ArgumentParser:
    """The options of ``urdfcheck check``."""
    p = Parser(
        prog="urdfcheck",
        usage="urdfcheck [check] PATH... [options]\n"
        "       urdfcheck rule [CODE] | init [FOLDER] | config [PATH]\n"
        "       urdfcheck baseline write|check|prune [PATH...] [options]\n"
        "       urdfcheck engines MODEL | drop MODEL | srdf MODEL [options]\n"
        "       urdfcheck audit DATASET... [options]\n"
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
        "--fix",
        action="store_true",
        help="apply the safe fixes, check again, and report what remains; a fix that makes anything worse is not made",
    )
    p.add_argument(
        "--unsafe-fixes", action="store_true", help="with --fix or --diff: those that may change what is meant too"
    )
    p.add_argument(
        "--diff",
        action="store_true",
        help="print what --fix would change and change nothing, instead of a report; exit 1 when there is something",
    )
    p.add_argument(
        "--color", choices=("auto", "always", "never"), default="auto", help="colours (default: on a terminal)"
    )
    p.add_argument("--version", action="version", version=f"urdfcheck {__version__}")
    return p


def main(words: Sequence[str]) -> int:
    """Run the command."""
    options = parser().parse_args(words)
    ensure_paths(options)
    if options.unsafe_fixes and not (options.fix or options.diff):
        raise UrdfcheckError("--unsafe-fixes says which fixes are meant: add --fix or --diff")
    if options.diff and (options.format != "text" or options.output):
        raise UrdfcheckError("--diff prints changes and no report: leave out --format and --output")
    from urdfcheck import workers

    # It loads what an audit needs while the job is being worked out here.
    first = workers.Worker.start(prepare) if workers.FORKS else None
    outputs = [output_file(text) for text in options.output]
    formats = {options.format, *(name for name, _ in outputs)}

    from urdfcheck import libraries, output
    from urdfcheck.engine import run

    request, settings = requested(options, scene="html" in formats)
    libraries.prefer_own()

    def meanwhile() -> None:
        for name in formats:
            importlib.import_module(f"urdfcheck.output.{name}")

    fail_on = options.fail_on or settings.fail_on
    if options.fix or options.diff:
        from urdfcheck.fixer import fixes

        try:
            fixed = fixes(request, unsafe=options.unsafe_fixes, first=first, meanwhile=meanwhile, progress=progress())
        except KeyboardInterrupt:
            raise UrdfcheckError("interrupted; no file was changed") from None
        outcome = fixed.outcome
        if options.diff:
            # Of the exit codes only those that are not about findings.
            code = exit_code(replace(outcome, findings=()), fail_on, allow_empty=options.allow_empty)
            return _diff(fixed, code)
        _write(fixed)
    else:
        outcome = run(request, first=first, meanwhile=meanwhile, progress=progress())
    show(outcome, options.format, options.color)
    for output_format, file in outputs:
        write(output.render(outcome, output_format), file)
    return exit_code(outcome, fail_on, allow_empty=options.allow_empty)


def _write(fixed: Fixes) -> None:
    """Change the files. What was done goes to standard error, so that a report stays what it is."""
    from urdfcheck import patch

    if fixed.outcome.partial:
        say("interrupted: no file was changed", sys.stderr)
        return
    patch.write(fixed.changes)
    _tell("fixed", fixed)


def _diff(fixed: Fixes, code: int) -> int:
    """Print what would be changed; the exit code, ``code`` where nothing would be."""
    from urdfcheck import patch

    for path, (before, after) in fixed.changes.items():
        for line in patch.difference(path, before, after):
            say(line)
    sys.stdout.flush()
    for failure in fixed.outcome.failures:
        say(f"urdfcheck failed: {failure}", sys.stderr)
    _tell("would fix", fixed)
    return code or (FINDINGS if fixed.changes else OK)


def _tell(done: str, fixed: Fixes) -> None:
    from urdfcheck.output.inert import one_line

    alike: dict[str, list[Finding]] = {}
    for finding, reason in fixed.refused:
        alike.setdefault(reason, []).append(finding)
    for reason, findings in alike.items():
        span = findings[0].location.span
        place = "" if span is None else f"{one_line(span.file)}:{span.line}:{span.col} "
        others = "" if len(findings) == 1 else f" and {len(findings) - 1} more"
        say(f"not fixed: {place}{findings[0].code}{others}: {one_line(reason)}", sys.stderr)
    more = f" ({fixed.more} more with --unsafe-fixes)" if fixed.more else ""
    say(f"{done} {len(fixed.fixed)}{more}", sys.stderr)
