"""``urdfcheck baseline write|check|prune [PATH…]``: accept the findings of today, so that only new ones are reported."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from urdfcheck.cli.options import EPILOG, CommandParser, add_options, build_request, read_options
from urdfcheck.cli.output_files import CheckedFolders, write_file
from urdfcheck.cli.terminal import (
    FAILED,
    FINDINGS,
    NOTHING,
    OK,
    compute_exit_code,
    make_progress_printer,
    print_run,
    say,
)
from urdfcheck.core.errors import UrdfcheckError

if TYPE_CHECKING:
    from urdfcheck.core import Run
    from urdfcheck.policy.baseline import Baseline, BaselineView
    from urdfcheck.policy.config import Config
    from urdfcheck.run.jobs import Request


def build_parser() -> argparse.ArgumentParser:
    """Build the parser of ``urdfcheck baseline``."""
    p = CommandParser(
        prog="urdfcheck baseline",
        description="Record today's findings, so that a check reports only new ones.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    p.add_argument(
        "action",
        choices=("write", "check", "prune"),
        help="write: accept all current findings; check: like urdfcheck check, with a baseline that must exist; "
        "prune: remove stale entries",
    )
    p.add_argument("paths", nargs="*", default=["."], metavar="PATH", help="what check takes (default: this folder)")
    add_options(p, "baseline")
    return p


def main(words: Sequence[str]) -> int:
    """Run the command."""
    options = build_parser().parse_args(words)

    from urdfcheck.run.pipeline import Execution, run
    from urdfcheck.system import libraries

    request, settings = build_request(options)
    file, request = _add_previous_baseline(options, request, settings)
    libraries.prefer_own_folders()
    outcome = run(request, Execution(on_progress=make_progress_printer()))
    if options.action == "check":
        print_run(outcome, "text", "auto")
        return compute_exit_code(outcome, options.fail_on or settings.fail_on, allow_empty=options.allow_empty)
    for failure in outcome.failures:
        say(f"not checked: {failure}", sys.stderr)
    if outcome.partial:
        raise UrdfcheckError("interrupted: the baseline was not changed")
    if not outcome.units:
        say("nothing to check: no model, launch file or package was found there")
        return OK if options.allow_empty else NOTHING
    _update_baselines(
        outcome,
        previous=request.baseline,
        file=file,
        root=settings.root,
        prune=options.action == "prune",
        checked=CheckedFolders.around(options.paths),
    )
    return FAILED if outcome.failures else _report_unchecked(outcome)


def _report_unchecked(outcome: Run) -> int:
    """Say how many models the baseline knows nothing of; return the exit code: that of an error unless they are accepted."""
    from urdfcheck.core import Severity
    from urdfcheck.output.shared.verdict.not_checked import GLYPH, describe_unchecked_models

    if outcome.unchecked_models:
        them = "it" if len(outcome.unchecked_models) == 1 else "them"
        text = f"{GLYPH} {describe_unchecked_models(outcome)}: the baseline has no entries for {them}"
        say(text, sys.stderr)
    is_error = any(info.unchecked_severity == Severity.ERROR for info in outcome.models)
    return FINDINGS if is_error else OK


def _add_previous_baseline(options: argparse.Namespace, request: Request, settings: Config) -> tuple[Path, Request]:
    """Return the file of the run's baseline, and the request with its content.

    :raises UrdfcheckError: if the action needs a baseline and there is none.
    """
    from urdfcheck.policy.baseline import read_baseline, read_found_baseline
    from urdfcheck.run.request import find_baseline_file
    from urdfcheck.source.package.finder import format_path

    file = find_baseline_file(read_options(options, options.paths), settings)
    if options.action == "check" and options.isolated and options.baseline is None:
        raise UrdfcheckError("--isolated ignores the baseline of the repository: name one with --baseline")
    if request.baseline is None and file.is_file():
        read = read_found_baseline if options.baseline is None else read_baseline
        request = replace(request, baseline=read(file, settings.root))
    if request.baseline is None and options.action != "write":
        raise UrdfcheckError(f"{format_path(file)}: there is no baseline; urdfcheck baseline write creates one")
    return file, request


def _update_baselines(
    outcome: Run, *, previous: Baseline | None, file: Path, root: Path, prune: bool, checked: CheckedFolders
) -> None:
    """Write the baseline of the run (``previous``, ``file`` and ``root``) and those of folders with a configuration."""
    from urdfcheck.policy import baseline

    view = baseline.BaselineView(
        findings=outcome.findings,
        models=outcome.models,
        complete_rules=outcome.complete_rules,
        skipped=outcome.skipped,
        tier=outcome.tier,
    )
    for home, names in sorted(outcome.baseline_unit_names.items(), key=lambda item: item[0] or ("", "")):
        unit_view = view.select_models(names)
        at, folder = (file, root) if home is None else (Path(home[0]), Path(home[1]))
        old = previous if home is None else baseline.read_found_baseline(at, folder)
        if not prune:
            _renew_baseline(old or baseline.Baseline(path=at, root=folder), unit_view, checked)
        elif old is not None:
            _prune_baseline(old, unit_view, checked)


def _renew_baseline(old: Baseline, view: BaselineView, checked: CheckedFolders) -> None:
    """Write a baseline that accepts all findings of today."""
    from urdfcheck.policy import baseline
    from urdfcheck.source.package.finder import format_path

    text = baseline.render_baseline(baseline.renew_entries(old, view), baseline.renew_excesses(old, view))
    write_file(text, old.path, checked)
    count = sum(baseline.is_baseline_candidate(finding) for finding in view.findings)
    say(f"{format_path(old.path)}: {count:,} {'finding' if count == 1 else 'findings'} accepted")


def _prune_baseline(old: Baseline, view: BaselineView, checked: CheckedFolders) -> None:
    """Write a baseline without the entries that no finding matches."""
    from urdfcheck.policy import baseline
    from urdfcheck.source.package.finder import format_path

    stale = baseline.find_stale_entries(old, view)
    write_file(baseline.render_baseline(baseline.remove_stale_entries(old, stale), old.excesses), old.path, checked)
    count = sum(sum(entries.values()) for entries in stale.values())
    done = f"removed {_format_entry_count(count, 'stale ')}" if count else "no entry is stale"
    rest = old.size - count
    say(f"{format_path(old.path)}: {done}, {_format_entry_count(rest)} remain{'s' * (rest == 1)}")


def _format_entry_count(number: int, kind: str = "") -> str:
    return f"{number:,} {kind}{'entry' if number == 1 else 'entries'}"
