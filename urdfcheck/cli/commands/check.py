"""``urdfcheck [check] PATH…``"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence

from urdfcheck.cli.options import EPILOG, CommandParser, add_options, build_request, ensure_paths
from urdfcheck.cli.standard_input import STDIN, read_given_file
from urdfcheck.cli.terminal import (
    FINDINGS,
    OK,
    compute_exit_code,
    make_progress_printer,
    print_run,
    print_statistics,
    say,
    silence_stdout,
)
from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.output import FORMATS
from urdfcheck.version import __version__

# Type checkers take it for typing's, whose import takes a fifth of the time of --help.
TYPE_CHECKING = False

if TYPE_CHECKING:
    from urdfcheck.cli.report_plan import ReportPlan
    from urdfcheck.core import Finding, Run
    from urdfcheck.fix.fixer import FixResult
    from urdfcheck.output.text import DetailLevel
    from urdfcheck.policy.config import Config
    from urdfcheck.run.jobs import Request
    from urdfcheck.run.pipeline import Execution
    from urdfcheck.system.process_pool import Worker


def build_parser() -> argparse.ArgumentParser:
    """Build the parser of ``urdfcheck check``."""
    p = CommandParser(
        prog="urdfcheck",
        usage="urdfcheck [check] PATH... [options]\n"
        "       urdfcheck [check] - [--stdin-filename FILE] [options]\n"
        "       urdfcheck rule [CODE] | init [FOLDER] | config [PATH] | demo [NAME]\n"
        "       urdfcheck baseline write|check|prune [PATH...] [options]\n"
        "       urdfcheck engines MODEL | drop MODEL | srdf MODEL [options]\n"
        "       urdfcheck repair MODEL -o DIR [options]\n"
        "       urdfcheck audit DATASET... [options]\n"
        "       urdfcheck cache info|clear | completion bash|zsh|fish",
        description="Audit robot models: URDF, xacro, launch files, packages and folders of them.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    p.add_argument(
        "paths", nargs="*", metavar="PATH", help="model, launch file, mesh, package or folder; - for standard input"
    )
    p.add_argument(
        "--stdin-filename",
        metavar="FILE",
        help="name of what comes through standard input (-): packages and configurations are looked for from its folder",
    )
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
    add_options(p, "check")
    p.add_argument(
        "--fix",
        action="store_true",
        help="apply the safe fixes, check again, and report what remains; a fix that makes anything worse is left out",
    )
    p.add_argument(
        "--unsafe-fixes", action="store_true", help="with --fix or --diff: also the fixes that may change the meaning"
    )
    p.add_argument(
        "--diff",
        action="store_true",
        help="print the patch that --fix would apply, and no report; exit 1 when there is one",
    )
    p.add_argument(
        "--watch", action="store_true", help="check again whenever a file of the model is saved, until Ctrl-C"
    )
    _add_detail_options(p)
    p.add_argument(
        "--color", choices=("auto", "always", "never"), default="auto", help="colours (default: on a terminal)"
    )
    p.add_argument("--version", action="version", version=f"urdfcheck {__version__}")
    return p


def _add_detail_options(parser: argparse.ArgumentParser) -> None:
    """Add the options for how much of the findings is printed."""
    detail = parser.add_mutually_exclusive_group()
    detail.add_argument(
        "-v",
        "--verbose",
        action="store_true",
        help="print everything about each finding, also about infos; --fix and --diff then repair these too",
    )
    detail.add_argument(
        "-q", "--quiet", action="store_true", help="a line for each error and warning, failures and the last line only"
    )
    detail.add_argument(
        "--statistics", action="store_true", help="print how often each rule fired instead of the findings"
    )


def main(words: Sequence[str]) -> int:
    """Run the command."""
    options = build_parser().parse_args(words)
    ensure_paths(options)
    _validate_options(options)
    given = read_given_file(options)

    from urdfcheck.cli.report_plan import ReportPlan
    from urdfcheck.cli.unchanged_runs import UnchangedRuns, observe_run

    reports = ReportPlan.from_options(options)
    # Before anything is loaded that an audit needs.
    unchanged = UnchangedRuns.for_options(options, has_texts=bool(given), needs_scene=reports.needs_scene)
    if unchanged is not None and (known := unchanged.recall()) is not None:
        return _report(known[0], options, reports=reports, default_fail_on=known[1])

    from urdfcheck.run.preload import start_warm_worker

    warm_worker = start_warm_worker(options.tier, None if unchanged is None else unchanged.folder)

    from dataclasses import replace

    from urdfcheck.run.pipeline import Execution
    from urdfcheck.system import libraries

    def ask() -> tuple[Request, Config]:
        request, settings = build_request(options, scene=reports.needs_scene)
        return replace(request, options=replace(request.options, texts=given)), settings

    libraries.prefer_own_folders()
    execution = Execution(warm_worker=warm_worker, on_idle=reports.import_formats, on_progress=make_progress_printer())
    if not (options.fix or options.diff or options.watch):
        from urdfcheck.api import run_and_ask

        with observe_run(unchanged) as observations:
            request, settings = ask()
            outcome = run_and_ask(request, execution)
        if unchanged is not None and request.cache is not None:
            unchanged.keep(outcome, settings.fail_on, observations)
        return _report(outcome, options, reports=reports, default_fail_on=settings.fail_on)
    request, settings = ask()
    if options.watch:
        return _watch(options, reports, asked=(request, settings), warm_worker=warm_worker)
    fixes = _compute_fixes(request, execution, include_unsafe=options.unsafe_fixes, are_only_shown=options.diff)
    if options.diff:
        fail_on = options.fail_on or settings.fail_on
        return _print_diff(fixes, fail_on=fail_on, allow_empty=options.allow_empty)
    _write_fixes(fixes)
    return _report(fixes.outcome, options, reports=reports, default_fail_on=settings.fail_on)


def _validate_options(options: argparse.Namespace) -> None:
    """Reject options that contradict each other.

    :raises UrdfcheckError: for the first contradiction.
    """
    if options.unsafe_fixes and not (options.fix or options.diff):
        raise UrdfcheckError("--unsafe-fixes needs --fix or --diff")
    if options.diff and (options.format != "text" or options.output):
        raise UrdfcheckError("--diff prints changes and no report: leave out --format and --output")
    if options.diff and options.statistics:
        raise UrdfcheckError("--diff prints changes and no report: leave out --statistics")
    if options.watch and (options.fix or options.diff):
        raise UrdfcheckError("--watch only reports: leave out --fix and --diff")
    if options.format != "text" and (options.watch or options.statistics):
        option = "--watch" if options.watch else "--statistics"
        raise UrdfcheckError(f"{option} prints text: write -o {options.format}=FILE instead of --format")
    if STDIN in options.paths and (options.fix or options.diff or options.watch):
        option = "--fix" if options.fix else "--diff" if options.diff else "--watch"
        raise UrdfcheckError(f"{option} works on files, not on standard input (-): leave it out")
    if options.stdin_filename is not None and STDIN not in options.paths:
        raise UrdfcheckError("--stdin-filename names what is read from standard input: add - as the path")
    if options.watch and not any(map(os.path.lexists, options.paths)):
        raise UrdfcheckError(f"{', '.join(options.paths)}: does not exist, so there is nothing to watch")


def _report(outcome: Run, options: argparse.Namespace, *, reports: ReportPlan, default_fail_on: str) -> int:
    """Print the outcome, write all reports, and return the exit code. ``default_fail_on``: what the configuration says.

    :raises UrdfcheckError: when reports cannot be written; the others are still written.
    """
    from urdfcheck.cli.job_summary import append_summary
    from urdfcheck.cli.output_files import write_report

    fail_on = options.fail_on or default_fail_on
    try:
        if options.statistics:
            print_statistics(outcome, options.color)
        else:
            print_run(outcome, options.format, options.color, detail=_choose_detail(options), fail_on=fail_on)
        sys.stdout.flush()
    except BrokenPipeError:  # the reader has exited (head, less): the verdict holds, and so do the other reports
        silence_stdout()
    _report_undeclared_arguments(outcome)
    errors = []
    for output_format, file in reports.files:
        try:
            write_report(outcome, output_format, file, checked=reports.checked, as_pages=file in reports.page_folders)
        except UrdfcheckError as error:
            errors.append(str(error))
    if reports.job_summary is not None:
        append_summary(outcome, [str(file) for name, file in reports.files if name == "html"], reports.job_summary)
    if errors:
        raise UrdfcheckError("; ".join(errors))
    return compute_exit_code(outcome, fail_on, allow_empty=options.allow_empty)


def _report_undeclared_arguments(outcome: Run) -> None:
    """Say on standard error which ``--arg`` has no effect."""
    what = "no model that was checked declares this argument"
    if outcome.has_unread_declarations:
        what = "not declared in what was read before the expansion stopped"
    for name, similar in outcome.undeclared_arguments.items():
        hint = f"; did you mean {similar}?" if similar else ""
        say(f"urdfcheck: --arg {name}: {what}{hint}", sys.stderr)


def _choose_detail(options: argparse.Namespace) -> DetailLevel:
    from urdfcheck.output.text import DetailLevel

    return DetailLevel.FULL if options.verbose else DetailLevel.QUIET if options.quiet else DetailLevel.BRIEF


def _watch(
    options: argparse.Namespace, reports: ReportPlan, *, asked: tuple[Request, Config], warm_worker: Worker | None
) -> int:
    from urdfcheck.cli.watch import watch

    return watch(
        asked,
        lambda: build_request(options, scene=reports.needs_scene),
        lambda outcome, settings: _report(outcome, options, reports=reports, default_fail_on=settings.fail_on),
        written=[file for _, file in reports.files],
        warm_worker=warm_worker,
        on_idle=reports.import_formats,
    )


# -- fixes -------------------------------------------------------------------------------------------------------------


def _compute_fixes(request: Request, execution: Execution, *, include_unsafe: bool, are_only_shown: bool) -> FixResult:
    """Apply the fixes in memory and check the result.

    :raises UrdfcheckError: when the user interrupts.
    """
    from urdfcheck.fix.fixer import compute_fixes

    try:
        return compute_fixes(request, execution, include_unsafe=include_unsafe, are_only_shown=are_only_shown)
    except KeyboardInterrupt:
        raise UrdfcheckError("interrupted; no file was changed") from None


def _write_fixes(fixes: FixResult) -> None:
    """Change the files. Standard error says what was done, so that standard output holds the report alone."""
    from urdfcheck.fix import patch

    if fixes.outcome.partial:
        say("interrupted: no file was changed", sys.stderr)
        return
    patch.write_files(fixes.changes)
    _summarise_fixes("fixed", fixes)


def _print_diff(fixes: FixResult, *, fail_on: str, allow_empty: bool) -> int:
    """Print what would be changed; the exit code says whether there is anything, or a model that was not checked.

    Findings do not count.
    """
    from dataclasses import replace

    from urdfcheck.fix import patch
    from urdfcheck.output.shared.verdict.not_checked import GLYPH, describe_unchecked_models

    for path, (before, after) in fixes.changes.items():
        for line in patch.iter_diff_lines(path, before, after):
            say(line)
    sys.stdout.flush()
    for failure in fixes.outcome.failures:
        say(f"not checked: {failure}", sys.stderr)
    _summarise_fixes("would fix", fixes)
    if fixes.outcome.unchecked_models:
        say(f"{GLYPH} {describe_unchecked_models(fixes.outcome)}", sys.stderr)
    code = compute_exit_code(replace(fixes.outcome, findings=()), fail_on, allow_empty=allow_empty)
    return code or (FINDINGS if fixes.changes else OK)


def _summarise_fixes(done: str, fixes: FixResult) -> None:
    """Print the number of fixes, and each reason for which others were not made."""
    from urdfcheck.output.shared.escaping import escape_one_line

    by_reason: dict[str, list[Finding]] = {}
    for finding, reason in fixes.refused:
        by_reason.setdefault(reason, []).append(finding)
    for reason, findings in by_reason.items():
        span = findings[0].location.span
        place = "" if span is None else f"{escape_one_line(span.file)}:{span.line}:{span.col} "
        others = "" if len(findings) == 1 else f" and {len(findings) - 1} more"
        say(f"not fixed: {place}{findings[0].code}{others}: {escape_one_line(reason)}", sys.stderr)
    more = f" ({fixes.unsafe_count} more with --unsafe-fixes)" if fixes.unsafe_count else ""
    say(f"{done} {len(fixes.fixed)}{more}", sys.stderr)
