"""The process behind the pytest plugin: lists the models and checks those that the plugin asks for.

The process of pytest has threads, foreign modules and captured streams, so nothing of urdfcheck is loaded there. Both sides
write one line of JSON at a time. The first request is ``{"words": [...], "folder": ..., "width": ..., "color": ...}``, the
words of ``urdfcheck check`` and where it runs; the answer is ``{"units": [...]}`` or ``{"error": ...}``. Each further request
is a list of indices of units; it is answered by a line for each of them, in the order in which they finish. This cannot be done
with :func:`urdfcheck.check`: the units are needed before they are checked, and each result as soon as it is finished.
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
from urdfcheck.output.shared.escaping import escape_for_log, escape_one_line
from urdfcheck.run.preload import preload_modules

if TYPE_CHECKING:
    import argparse

    from urdfcheck.core import Run
    from urdfcheck.run.jobs import Unit

# Options for the report, which pytest prints itself.
_REPORT_OPTIONS = ("fix", "diff", "watch", "statistics", "output", "format", "color", "verbose", "quiet")


def serve() -> None:
    """Answer requests until standard input ends."""
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(FAILED))  # which cleans up
    out = os.fdopen(os.dup(sys.stdout.fileno()), "w", encoding="utf-8", errors="surrogatepass")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # nothing else may write there
    setup = json.loads(sys.stdin.readline())
    os.chdir(setup["folder"])
    try:
        for answer in _iter_answers(setup):
            print(json.dumps(answer), file=out, flush=True)
    except UrdfcheckError as error:
        print(json.dumps({"error": escape_for_log(str(error))}), file=out, flush=True)
    except (BrokenPipeError, KeyboardInterrupt):
        sys.exit(FAILED)


def _iter_answers(setup: dict[str, Any]) -> Iterator[dict[str, Any]]:
    options = _parse_options(setup["words"])
    request, settings = build_request(options)
    from urdfcheck.run.assemble_run import build_run
    from urdfcheck.run.pipeline import audit_session, plan_units, stream_reports
    from urdfcheck.source.model_role import MODEL
    from urdfcheck.system.process_pool import FORKS

    plan, units = plan_units(request)
    for path, reason in plan.missing:
        raise UrdfcheckError(f"{path}: {reason}")
    yield {"units": [_describe_unit(unit) for unit in units]}
    if FORKS:
        preload_modules()  # the worker processes are forked from this one
    fail_on = options.fail_on or settings.fail_on
    with audit_session(request, units, plan) as audit_settings:
        for line in sys.stdin:
            indices = json.loads(line)
            for place, report in stream_reports([units[i] for i in indices], audit_settings, jobs=request.jobs):
                unit = units[indices[place]]
                if report.role != MODEL:
                    reason = report.role.reason or "it defines no link and no joint"
                    result = {"outcome": "skipped", "text": escape_for_log(f"it is not a model: {reason}")}
                else:
                    own_plan = replace(plan, unused=(), config_errors=(), macro_files=())
                    run = build_run(request, own_plan, audited_units=[(unit, report)], seconds=0.0)
                    result = _build_result(run, fail_on=fail_on, setup=setup)
                yield {"unit": indices[place], **result}


def _describe_unit(unit: Unit) -> dict[str, Any]:
    """Return what a test needs to know of a unit: its file, and its arguments, by which those of one file differ."""
    _, _, arguments = unit.id.partition(f"{os.path.basename(unit.path)} ")
    return {"kind": unit.kind, "path": unit.path, "launches": unit.launches, "arguments": escape_one_line(arguments)}


def _parse_options(words: Sequence[str]) -> argparse.Namespace:
    parser = build_parser()
    options = parser.parse_args(words)
    for name in _REPORT_OPTIONS:
        if getattr(options, name) != parser.get_default(name):
            raise UrdfcheckError(f"--{name} has no meaning for tests")
    return options


def _build_result(run: Run, *, fail_on: str, setup: dict[str, Any]) -> dict[str, Any]:
    """Return the outcome of a unit (passed | failed | crashed | skipped) and its report as text."""
    from urdfcheck.core import Severity
    from urdfcheck.output import text
    from urdfcheck.output.shared.verdict.not_checked import explain_unchecked
    from urdfcheck.output.shared.wording import sort_worst_first

    code = compute_exit_code(run, fail_on)
    if code not in {FAILED, FINDINGS} and run.unchecked_models:
        # Accepted, or nothing fails the run: a test that passed would say that the model was checked.
        (info,) = run.unchecked_models
        reason = escape_one_line(f"not checked: {explain_unchecked(info)}")
        how = '--urdfcheck-args="--arg NAME:=VALUE", or [[models]] in urdfcheck.toml'
        hint = f" ({how})" if info.status == "needs-arguments" else ""
        return {"outcome": "skipped", "text": escape_for_log(f"{reason}{hint}")}
    page = text.render(run, width=setup["width"], color=setup["color"], detail=text.DetailLevel.BRIEF, fail_on=fail_on)
    # pytest's summary has room for the first line only.
    worst = sort_worst_first(f for f in run.active_findings if f.severity > Severity.INFO)
    more = f" and {len(worst) - 1} more" if len(worst) > 1 else ""
    head = f"{worst[0].code} {worst[0].headline}{more}\n" if worst else ""
    return {"outcome": {FAILED: "crashed", FINDINGS: "failed"}.get(code, "passed"), "text": head + page}
