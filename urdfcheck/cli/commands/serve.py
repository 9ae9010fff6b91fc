"""What the plugin for pytest asks, in a process of its own: which models there are, and how they fare.

pytest's process has threads, other people's modules and captured streams; nothing of ours is loaded there. Both sides write a
line of JSON at a time. The first line asked is ``{"words": [...], "folder": ..., "width": ..., "color": ...}``, the words of
``urdfcheck check`` and where it runs; it is answered by ``{"units": [...]}`` or ``{"error": ...}``. Each further line is a list
of numbers of units, and is answered by a line for each of them, in the order in which they are finished.
"""

from __future__ import annotations

import json
import os
import signal
import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from urdfcheck.cli.commands.check import build_parser
from urdfcheck.cli.options import build_request
from urdfcheck.cli.terminal import FAILED, FINDINGS, compute_exit_code
from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.output.shared.inert import escape_for_log, escape_one_line
from urdfcheck.run.preload import preload_modules

if TYPE_CHECKING:
    import argparse

    from urdfcheck.run.jobs import Request, Unit, UnitReport
    from urdfcheck.source.discover import Plan

# Options of a command that prints a report, which pytest does itself.
_OTHERS = ("fix", "diff", "watch", "statistics", "output", "format", "color", "verbose", "quiet")


def serve() -> None:
    """Answer until nobody asks any more."""
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(FAILED))  # and clean up on the way out
    out = os.fdopen(os.dup(sys.stdout.fileno()), "w", encoding="utf-8", errors="surrogatepass")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # nobody else writes there
    asked = json.loads(sys.stdin.readline())
    os.chdir(asked["folder"])
    try:
        for answer in _iter_answers(asked):
            print(json.dumps(answer), file=out, flush=True)
    except UrdfcheckError as error:
        print(json.dumps({"error": escape_for_log(str(error))}), file=out, flush=True)
    except (BrokenPipeError, KeyboardInterrupt):
        sys.exit(FAILED)


def _iter_answers(asked: dict[str, Any]) -> Iterator[dict[str, Any]]:
    options = _parse_options(asked["words"])
    request, settings = build_request(options)
    from urdfcheck.run.pipeline import audit_session, plan_units, stream_reports
    from urdfcheck.system.process_pool import FORKS

    found, units = plan_units(request)
    for path, reason in found.missing:
        raise UrdfcheckError(f"{path}: {reason}")
    yield {"units": [_describe_unit(unit) for unit in units]}
    if FORKS:
        preload_modules()  # the processes for the models are copies of this one
    with audit_session(request, units, found.reach or request.reach) as held:
        for line in sys.stdin:
            numbers = json.loads(line)
            for place, report in stream_reports([units[n] for n in numbers], held, request.jobs):
                unit = units[numbers[place]]
                yield {
                    "unit": numbers[place],
                    **_build_result(request, found, unit, report, options.fail_on or settings.fail_on, asked),
                }


def _describe_unit(unit: Unit) -> dict[str, Any]:
    """What a test needs to know of a unit: where it is, and what tells it from others of the same file."""
    _, _, arguments = unit.id.partition(f"{os.path.basename(unit.path)} ")
    return {"kind": unit.kind, "path": unit.path, "launches": unit.launches, "arguments": escape_one_line(arguments)}


def _parse_options(words: Sequence[str]) -> argparse.Namespace:
    made = build_parser()
    options = made.parse_args(words)
    for name in _OTHERS:
        if getattr(options, name) != made.get_default(name):
            raise UrdfcheckError(f"--{name} has no meaning for tests")
    return options


def _build_result(
    request: Request, found: Plan, unit: Unit, report: UnitReport, fail_on: str, asked: dict[str, Any]
) -> dict[str, Any]:
    """How a unit fared (passed | failed | crashed | skipped), and what there is to say about it."""
    from urdfcheck.core import Severity
    from urdfcheck.output import text
    from urdfcheck.run.pipeline import is_empty_candidate
    from urdfcheck.run.summary import build_run

    if is_empty_candidate(unit, report, found):
        return {"outcome": "skipped", "text": "it makes neither link nor joint: it is no model"}
    run = build_run(request, replace(found, unused=(), config_errors=()), [(unit, report)], 0.0)
    code = compute_exit_code(run, fail_on)
    if code not in {FAILED, FINDINGS} and report.info is not None and report.info.status == "needs-arguments":
        reason = max(report.findings, key=lambda f: f.severity).message if report.findings else "it needs arguments"
        how = '--urdfcheck-args="--arg NAME:=VALUE", or [[models]] in urdfcheck.toml'
        return {"outcome": "skipped", "text": escape_for_log(f"{escape_one_line(reason)} ({how})")}
    page = text.render(run, width=asked["width"], color=asked["color"], detail=text.DetailLevel.QUIET, fail_on=fail_on)
    # Its first line is what pytest's summary has room for.
    worst = sorted((f for f in run.active_findings if f.severity > Severity.INFO), key=lambda f: -f.severity)
    more = f" and {len(worst) - 1} more" if len(worst) > 1 else ""
    head = f"{worst[0].code} {worst[0].name}{more}\n" if worst else ""
    return {"outcome": {FAILED: "crashed", FINDINGS: "failed"}.get(code, "passed"), "text": head + page}
