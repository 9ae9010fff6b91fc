"""``urdfcheck baseline write|check|prune [PATH…]``: the findings that are known, so that only new ones are seen."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from urdfcheck.cli.options import EPILOG, Parser, add_options, baseline_file, requested
from urdfcheck.cli.terminal import FAILED, NOTHING, OK, exit_code, progress, say, show, write
from urdfcheck.core.errors import UrdfcheckError


def parser() -> argparse.ArgumentParser:
    """The options of ``urdfcheck baseline``."""
    p = Parser(
        prog="urdfcheck baseline",
        description="Write down the findings of today, so that a check shows only those that are new.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    p.add_argument(
        "action",
        choices=("write", "check", "prune"),
        help="write: all findings are known from now on; check: like urdfcheck check, and what is gone from the baseline is an "
        "error; prune: take out what is gone",
    )
    p.add_argument("paths", nargs="*", default=["."], metavar="PATH", help="what check takes (default: this folder)")
    add_options(p)
    return p


def main(words: Sequence[str]) -> int:
    """Run the command."""
    options = parser().parse_args(words)

    from urdfcheck.policy import baseline
    from urdfcheck.run.pipeline import Execution, run
    from urdfcheck.source.package.finder import format_path
    from urdfcheck.system import libraries

    request, settings = requested(options)
    file = baseline_file(options, settings)
    if options.action == "check" and options.isolated and options.baseline is None:
        raise UrdfcheckError("--isolated heeds no baseline that lies in the repository: name one with --baseline")
    if request.baseline is None and file.is_file():
        request = replace(request, baseline=baseline.read_baseline(file, settings.root))
    before = request.baseline
    if before is None and options.action != "write":
        raise UrdfcheckError(f"{format_path(file)}: there is no baseline; urdfcheck baseline write makes one")
    libraries.prefer_own_folders()
    outcome = run(request, Execution(on_progress=progress()))
    if options.action == "check":
        show(outcome, "text", "auto")
        return exit_code(outcome, options.fail_on or settings.fail_on, allow_empty=options.allow_empty)
    for failure in outcome.failures:
        say(f"urdfcheck failed: {failure}", sys.stderr)
    if outcome.partial:
        raise UrdfcheckError("interrupted: the baseline is as it was")
    if not outcome.units:
        say("nothing to check: no model, launch file or package was found there")
        return OK if options.allow_empty else NOTHING
    seen = baseline.BaselineView(
        findings=outcome.findings,
        models=outcome.models,
        complete_rules=outcome.complete_rules,
        skipped=outcome.skipped,
        tier=outcome.tier,
    )
    for home, names in sorted(outcome.baseline_unit_names.items(), key=lambda item: item[0] or ("", "")):
        own = seen.select_models(names)
        at, root = (file, settings.root) if home is None else (Path(home[0]), Path(home[1]))
        old = before if home is None else baseline.read_baseline(at, root) if at.is_file() else None
        if options.action == "write":
            after = baseline.renew_entries(old or baseline.Baseline(at, root), own)
            write(baseline.render_baseline(after), at)
            known = sum(baseline.is_baseline_candidate(finding) for finding in own.findings)
            say(f"{format_path(at)}: {known:,} {'finding is' if known == 1 else 'findings are'} known from now on")
        elif old is not None:
            gone = baseline.find_stale_entries(old, own)
            write(baseline.render_baseline(baseline.remove_stale_entries(old, gone)), at)
            number = sum(sum(entries.values()) for entries in gone.values())
            done = f"took out {_entries(number, 'stale ')}" if number else "no entry is stale"
            say(f"{format_path(at)}: {done}, {_entries(old.size - number)} remain{'s' * (old.size - number == 1)}")
    return FAILED if outcome.failures else OK


def _entries(number: int, kind: str = "") -> str:
    return f"{number:,} {kind}{'entry' if number == 1 else 'entries'}"
