"""``urdfcheck drop MODEL``: drop a model on the ground in a simulator."""

from __future__ import annotations

import argparse
import importlib.util
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING

from urdfcheck.cli.options import CommandParser, add_options, build_request
from urdfcheck.cli.output_files import CheckedFolders, parse_run_outputs, write_file
from urdfcheck.cli.terminal import OK, compute_exit_code, make_progress_printer, print_run, say
from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.run.preload import start_warm_worker

if TYPE_CHECKING:
    from urdfcheck.core import Run

# The fall, and the drive of a robot that stands.
RULE, DRIVE_RULE = "DYN005", "DYN007"


def build_parser() -> argparse.ArgumentParser:
    """Build the parser of ``urdfcheck drop``."""
    p = CommandParser(
        prog="urdfcheck drop",
        description="Set a robot on the ground in MuJoCo, let go for two seconds, drive it, and report how it moves.",
        epilog="exit codes: 0 nothing at or above --fail-on, 1 findings (warnings), 2 the robot could not be dropped",
    )
    p.add_argument(
        "paths", nargs=1, metavar="MODEL", help="a model, or a launch file, package or folder that has models"
    )
    p.add_argument("--format", choices=("text", "json", "html"), default="text", help="what goes to standard output")
    p.add_argument(
        *("-o", "--output"),
        action="append",
        default=[],
        metavar="FORMAT=FILE",
        help="also write the result to a file (repeatable); html writes the model's whole report",
    )
    add_options(p, "drop")
    p.add_argument(
        "--base",
        choices=("auto", "fixed", "free"),
        default="auto",
        help="whether the base is bolted down (auto: arms, hands and roots without mass are; default: auto)",
    )
    p.add_argument(
        "--color", choices=("auto", "always", "never"), default="auto", help="colours (default: on a terminal)"
    )
    return p


def main(words: Sequence[str]) -> int:
    """Run the command."""
    # All other options have the defaults of a check.
    check = CommandParser()
    add_options(check, "check")
    options = build_parser().parse_args(words, check.parse_args(["--tier=full"]))
    outputs = parse_run_outputs(options.output, options.paths)
    if importlib.util.find_spec("mujoco") is None:
        raise UrdfcheckError("a drop test needs MuJoCo: pip install 'urdfcheck[engines]'")

    from dataclasses import replace

    from urdfcheck import output
    from urdfcheck.core import Severity
    from urdfcheck.rules import load_rules
    from urdfcheck.run.pipeline import Execution, run
    from urdfcheck.system import libraries

    first = start_warm_worker()
    # The findings about the file explain why there is no model.
    wanted = {RULE, DRIVE_RULE, *(code for code, rule in load_rules().items() if "file" in rule.scopes)}
    formats = {options.format, *(name for name, _ in outputs)}
    if "html" not in formats:
        options.select = [",".join(sorted(wanted))]
    request, settings = build_request(options, scene="html" in formats)
    libraries.prefer_own_folders()
    request = replace(request, options=replace(request.options, drop=True, base=options.base))
    outcome = run(request, Execution(warm_worker=first, on_progress=make_progress_printer()))
    if outcome.models and not outcome.drops:
        reason = f"{options.paths[0]}: {_explain_no_drop(outcome)}"
        if outcome.failures or not all(info.unchecked_severity == Severity.WARNING for info in outcome.models):
            raise UrdfcheckError(reason)
        say(f"urdfcheck: {reason} (accepted)", sys.stderr)
        return OK
    # Whatever reports are written, the command prints the same: findings of the drop, and errors of the file.
    findings = (
        f
        for f in outcome.findings
        if f.code in {RULE, DRIVE_RULE} or (f.code in wanted and f.severity == Severity.ERROR)
    )
    drop_outcome = replace(outcome, findings=tuple(findings), scenes=())
    print_run(outcome if options.format == "html" else drop_outcome, options.format, options.color)
    checked = CheckedFolders.around(options.paths)
    for output_format, file in outputs:
        write_file(output.render(outcome if output_format == "html" else drop_outcome, output_format), file, checked)
    return compute_exit_code(drop_outcome, options.fail_on or settings.fail_on, allow_empty=options.allow_empty)


def _explain_no_drop(outcome: Run) -> str:
    """Return why no model could be dropped."""
    from urdfcheck.core import Severity

    reasons = [*outcome.failures, *(skip.reason for skip in outcome.skipped if skip.code in {RULE, "ALL"})]
    for finding in outcome.findings:
        span = finding.location.span
        if finding.severity == Severity.ERROR or finding.blocks_check:
            place = "" if span is None else f" ({span.file}:{span.line}:{span.col})"
            return f"{finding.message}{place}"
    return reasons[0] if reasons else "the robot could not be set down"
