"""``urdfcheck [check] PATH…``"""

from __future__ import annotations

import argparse
import importlib
import os
import sys
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from urdfcheck import __version__
from urdfcheck.cli.commands.job_summary import append_summary, find_summary_file
from urdfcheck.cli.options import (
    EPILOG,
    CommandParser,
    add_options,
    build_request,
    ensure_paths,
    is_folder_output,
    parse_outputs,
)
from urdfcheck.cli.preload import start_warm_worker
from urdfcheck.cli.terminal import (
    FINDINGS,
    OK,
    compute_exit_code,
    make_progress_printer,
    print_run,
    print_statistics,
    say,
    write_report,
)
from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.output import FORMATS

if TYPE_CHECKING:
    from urdfcheck.core import Finding, Run
    from urdfcheck.fix.fixer import Fixes
    from urdfcheck.output.text import DetailLevel
    from urdfcheck.policy.config import Config
    from urdfcheck.run.pipeline import Request


def build_parser() -> argparse.ArgumentParser:
    """The options of ``urdfcheck check``."""
    p = CommandParser(
        prog="urdfcheck",
        usage="urdfcheck [check] PATH... [options]\n"
        "       urdfcheck rule [CODE] | init [FOLDER] | config [PATH]\n"
        "       urdfcheck baseline write|check|prune [PATH...] [options]\n"
        "       urdfcheck engines MODEL | drop MODEL | srdf MODEL [options]\n"
        "       urdfcheck audit DATASET... [options]\n"
        "       urdfcheck cache info|clear | completion bash|zsh|fish",
        description="Audit robot models: URDF, xacro, launch files, packages and folders of them.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    p.add_argument("paths", nargs="*", metavar="PATH", help="model, launch file, mesh, package or folder")
    p.add_argument(
        "--format",
        choices=FORMATS,
        default="text",
        metavar="FORMAT",
        help=f"what goes to standard output: {', '.join(FORMATS)}",
    )
    p.add_argument(
        "-o",
        "--output",
        action="append",
        default=[],
        metavar="FORMAT=FILE",
        help="also write a report to a file (repeatable), e.g. -o html=report.html; html=FOLDER/ has a page for each model",
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
        "--watch", action="store_true", help="check again whenever a file is saved that matters, until Ctrl-C"
    )
    told = p.add_mutually_exclusive_group()
    told.add_argument(
        "-v", "--verbose", action="store_true", help="tell everything about infos too, as about the others"
    )
    told.add_argument(
        "-q", "--quiet", action="store_true", help="errors, warnings, what failed, and one line at the end"
    )
    told.add_argument(
        "--statistics", action="store_true", help="a table of how often each rule fired, not the findings"
    )
    p.add_argument(
        "--color", choices=("auto", "always", "never"), default="auto", help="colours (default: on a terminal)"
    )
    p.add_argument("--version", action="version", version=f"urdfcheck {__version__}")
    return p


def main(words: Sequence[str]) -> int:
    """Run the command."""
    options = build_parser().parse_args(words)
    ensure_paths(options)
    if options.unsafe_fixes and not (options.fix or options.diff):
        raise UrdfcheckError("--unsafe-fixes says which fixes are meant: add --fix or --diff")
    if options.diff and (options.format != "text" or options.output):
        raise UrdfcheckError("--diff prints changes and no report: leave out --format and --output")
    if options.diff and options.statistics:
        raise UrdfcheckError("--diff prints changes and no report: leave out --statistics")
    if options.watch and (options.fix or options.diff):
        raise UrdfcheckError("--watch only looks: leave out --fix and --diff")
    if options.format != "text" and (options.watch or options.statistics):
        option = "--watch" if options.watch else "--statistics"
        raise UrdfcheckError(f"{option} prints text: write -o {options.format}=FILE instead of --format")
    if options.watch and not any(map(os.path.lexists, options.paths)):
        raise UrdfcheckError(f"{', '.join(options.paths)}: does not exist, so there is nothing to watch")
    first = start_warm_worker()
    outputs = parse_outputs(options.output, options.paths)
    folders = {file for text, (_, file) in zip(options.output, outputs, strict=True) if is_folder_output(text)}
    formats = {options.format, *(name for name, _ in outputs)}
    summary = find_summary_file() if "github" in formats else None
    if summary is not None:
        formats.add("markdown")

    from urdfcheck import output
    from urdfcheck.run.pipeline import run
    from urdfcheck.system import libraries

    request, settings = build_request(options, scene=bool(formats & output.DRAWING_FORMATS))
    libraries.prefer_own_folders()

    def meanwhile() -> None:
        for name in formats:
            importlib.import_module(f"urdfcheck.output.{name}")

    def report(outcome: Run, settings: Config) -> int:
        fail_on = options.fail_on or settings.fail_on
        if options.statistics:
            print_statistics(outcome, options.color)
        else:
            print_run(outcome, options.format, options.color, _choose_detail(options), fail_on)
        refused = []
        for output_format, file in outputs:
            try:
                write_report(outcome, output_format, file, as_pages=file in folders)
            except UrdfcheckError as error:  # a report that cannot be written keeps no other from being written
                refused.append(str(error))
        if summary is not None:
            append_summary(outcome, [str(file) for name, file in outputs if name == "html"], summary)
        if refused:
            raise UrdfcheckError("; ".join(refused))
        return compute_exit_code(outcome, fail_on, allow_empty=options.allow_empty)

    if options.watch:
        from urdfcheck.cli.commands.watch import watch

        def ask() -> tuple[Request, Config]:
            return build_request(options, scene=bool(formats & output.DRAWING_FORMATS))

        return watch((request, settings), ask, report, [file for _, file in outputs], first, meanwhile)
    if options.fix or options.diff:
        from urdfcheck.fix.fixer import fixes

        try:
            fixed = fixes(
                request, unsafe=options.unsafe_fixes, first=first, meanwhile=meanwhile, progress=make_progress_printer()
            )
        except KeyboardInterrupt:
            raise UrdfcheckError("interrupted; no file was changed") from None
        outcome = fixed.outcome
        if options.diff:
            # Of the exit codes only those that are not about findings.
            code = compute_exit_code(replace(outcome, findings=()), "never", allow_empty=options.allow_empty)
            return _print_diff(fixed, code)
        _write_fixes(fixed)
    else:
        outcome = run(request, first=first, meanwhile=meanwhile, progress=make_progress_printer())
    return report(outcome, settings)


def _choose_detail(options: argparse.Namespace) -> DetailLevel:
    from urdfcheck.output.text import DetailLevel

    return DetailLevel.FULL if options.verbose else DetailLevel.QUIET if options.quiet else DetailLevel.BRIEF


def _write_fixes(fixed: Fixes) -> None:
    """Change the files. What was done goes to standard error, so that a report stays what it is."""
    from urdfcheck.fix import patch

    if fixed.outcome.partial:
        say("interrupted: no file was changed", sys.stderr)
        return
    patch.write(fixed.changes)
    _report_fixes("fixed", fixed)


def _print_diff(fixed: Fixes, code: int) -> int:
    """Print what would be changed; the exit code, ``code`` where nothing would be."""
    from urdfcheck.fix import patch

    for path, (before, after) in fixed.changes.items():
        for line in patch.difference(path, before, after):
            say(line)
    sys.stdout.flush()
    for failure in fixed.outcome.failures:
        say(f"urdfcheck failed: {failure}", sys.stderr)
    _report_fixes("would fix", fixed)
    return code or (FINDINGS if fixed.changes else OK)


def _report_fixes(done: str, fixed: Fixes) -> None:
    from urdfcheck.output.shared.inert import escape_one_line

    alike: dict[str, list[Finding]] = {}
    for finding, reason in fixed.refused:
        alike.setdefault(reason, []).append(finding)
    for reason, findings in alike.items():
        span = findings[0].location.span
        place = "" if span is None else f"{escape_one_line(span.file)}:{span.line}:{span.col} "
        others = "" if len(findings) == 1 else f" and {len(findings) - 1} more"
        say(f"not fixed: {place}{findings[0].code}{others}: {escape_one_line(reason)}", sys.stderr)
    more = f" ({fixed.more} more with --unsafe-fixes)" if fixed.more else ""
    say(f"{done} {len(fixed.fixed)}{more}", sys.stderr)
