"""``urdfcheck repair MODEL -o DIR``: write a repaired copy of a model."""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Any

from urdfcheck.cli.options import CommandParser, add_options, build_request
from urdfcheck.cli.output_files import CheckedFolders, parse_comparison_outputs, warn_of_size, write_file
from urdfcheck.cli.terminal import compute_exit_code, print_document, say, silence_stdout
from urdfcheck.core.errors import UrdfcheckError

if TYPE_CHECKING:
    from urdfcheck.core import Run
    from urdfcheck.fix.repair.repair_model import RepairResult
    from urdfcheck.fix.repair.steps import RepairStep

# What `--report` writes, of the formats of `urdfcheck diff`: those that draw both versions.
_REPORTS = ("html", "png")
SCHEMA = "urdfcheck-repair/1"
# How steps are marked in the text.
_MARKS = {"done": "✔", "withdrawn": "↶", "left": "·"}
# The choices, as in `urdfcheck.fix.repair.steps`, which is not imported for the help.
_COLLISION = ("none", "primitives", "convex", "decimate")
_INERTIA = ("none", "bad", "all")


def build_parser() -> argparse.ArgumentParser:
    """Build the parser of ``urdfcheck repair``."""
    p = CommandParser(
        prog="urdfcheck repair",
        description="Write a repaired copy of a model: safe edits, meshes, collision geometry and inertials, checked again.",
        epilog="exit codes: 0 nothing at or above --fail-on in the copy, 1 findings, 2 there is no repaired copy",
    )
    p.add_argument("paths", nargs=1, metavar="MODEL", help="a model, or whatever means exactly one")
    p.add_argument(
        *("-o", "--output"), metavar="DIR", required=True, help="a new or empty folder, outside the model's package"
    )
    p.add_argument("--format", choices=("text", "json"), default="text", help="output format (default: text)")
    p.add_argument(
        "--report",
        action="append",
        default=[],
        metavar="FORMAT=FILE",
        help="also show the model before and after (repeatable): html=FILE is a page with both in 3D, the steps, and each edited "
        "line; png=FILE is a picture of both",
    )
    p.add_argument(
        "--meshes",
        choices=("bake", "none"),
        default="bake",
        help="write COLLADA's unit and up-axis into the coordinates (default: bake)",
    )
    p.add_argument(
        "--up-axis",
        choices=("drawn", "upright"),
        default="drawn",
        help="what a COLLADA file with y up becomes: as RViz draws it, or rotated to z up (default: drawn)",
    )
    p.add_argument(
        "--collision",
        choices=_COLLISION,
        default="primitives",
        help="what collision meshes become (default: primitives)",
    )
    p.add_argument(
        "--max-excess",
        type=float,
        default=0.25,
        metavar="SHARE",
        help="most volume that a primitive may add to a mesh's convex hull (default: 0.25)",
    )
    p.add_argument(
        "--triangles", type=int, default=2000, metavar="N", help="most triangles of a decimated mesh (default: 2000)"
    )
    p.add_argument(
        "--inertia", choices=_INERTIA, default="bad", help="links that get inertials from their geometry (default: bad)"
    )
    p.add_argument(
        "--density",
        type=float,
        metavar="KG/M3",
        help="density for these inertials (default: the declared masses are kept)",
    )
    p.add_argument("--unsafe-fixes", action="store_true", help="also make edits that change a value or a name")
    add_options(p, "repair")
    return p


def main(words: Sequence[str]) -> int:
    """Run the command."""
    # All other options have the defaults of a check.
    check = CommandParser()
    add_options(check, "check")
    options = build_parser().parse_args(words, check.parse_args([]))
    _validate_options(options)
    reports = parse_comparison_outputs(options.report, options.paths, _REPORTS, "--report")
    checked = CheckedFolders.around(options.paths)

    from urdfcheck.fix.repair.repair_model import repair_model
    from urdfcheck.fix.repair.steps import RepairOptions
    from urdfcheck.system import libraries

    libraries.prefer_own_folders()
    request, settings = build_request(options)
    wanted = RepairOptions(
        meshes=options.meshes,
        up_axis=options.up_axis,
        collision=options.collision,
        inertia=options.inertia,
        density=options.density,
        triangles=options.triangles,
        max_excess=options.max_excess,
    )
    done = repair_model(request, Path(options.output), wanted, include_unsafe=options.unsafe_fixes)
    try:
        _print_result(done, options.format)
    except BrokenPipeError:  # the reader has exited: the copy is there, and so are the reports
        silence_stdout()
    if reports:
        _write_reports(done, reports, checked)
    return compute_exit_code(done.after, options.fail_on or settings.fail_on, allow_empty=options.allow_empty)


def _print_result(done: RepairResult, output_format: str) -> None:
    if output_format == "json":
        print_document(json.dumps(_build_document(done), indent=1, ensure_ascii=False, allow_nan=False) + "\n")
    else:
        for line in _iter_lines(done):
            say(line)
    sys.stdout.flush()


def _validate_options(options: argparse.Namespace) -> None:
    """Reject numbers that make no sense.

    :raises UrdfcheckError: for the first of them.
    """
    density = options.density
    if density is not None and not (0.0 < density < math.inf):
        raise UrdfcheckError(f"--density {density:g}: a positive number of kg/m³")
    if options.triangles < 4:
        raise UrdfcheckError(f"--triangles {options.triangles}: at least 4")
    if not (0.0 <= options.max_excess < math.inf):
        raise UrdfcheckError(f"--max-excess {options.max_excess:g}: a share of volume, 0 or more")
    if not options.output:
        raise UrdfcheckError("-o: name a new or empty folder")


def _write_reports(done: RepairResult, reports: Sequence[tuple[str, Path]], checked: CheckedFolders) -> None:
    """Compare the model with its copy, and write what shows both.

    :raises UrdfcheckError: if one cannot be written.
    """
    from urdfcheck.changes.compare_repaired import compare_repaired
    from urdfcheck.fix.repair.steps import iter_reported_steps
    from urdfcheck.output.changes import render, render_picture

    diff = compare_repaired(*done.requests, done.before, iter_reported_steps(done.fixed, done.steps))
    for output_format, file in reports:
        document = render(diff, output_format) if output_format == "html" else render_picture(diff)
        write_file(document, file, checked)
        if isinstance(document, str):
            warn_of_size(document, file, "--collision decimate makes meshes smaller")


def _iter_lines(done: RepairResult) -> Iterator[str]:
    from urdfcheck.core.model_diff import DONE
    from urdfcheck.fix.repair.steps import iter_reported_steps
    from urdfcheck.source.package.finder import format_path

    reported = list(iter_reported_steps(done.fixed, done.steps))
    for stage, group in groupby(reported, key=lambda step: step.stage):
        steps = list(group)
        yield f"{stage} ({sum(step.outcome == DONE for step in steps)} of {len(steps)} changed)"
        for step in steps:
            yield f"  {_MARKS[step.outcome]} {step.subject}: {step.text}"
    if not any(step.outcome == DONE for step in reported):
        yield "nothing was changed"
    yield ""
    before, after = _count_findings(done.before), _count_findings(done.after)
    yield "findings  " + ", ".join(f"{name}s {before[name]} → {after[name]}" for name in ("error", "warning", "info"))
    for line, codes in (("gone", _list_gone(done.before, done.after)), ("new", _list_gone(done.after, done.before))):
        if codes:
            yield f"{line:8}  " + ", ".join(codes)
    yield f"{done.files} files copied; the model is {format_path(done.model)}"


def _count_findings(run: Run) -> dict[str, int]:
    counts = Counter(str(finding.severity) for finding in run.active_findings)
    return {name: counts[name] for name in ("error", "warning", "info")}


def _list_gone(before: Run, after: Run) -> list[str]:
    """List the codes that the second run reports less often, with the numbers."""
    old, new = (Counter(finding.code for finding in run.active_findings) for run in (before, after))
    return [f"{code} {old[code]} → {new[code]}" for code in sorted(old) if new[code] < old[code]]


def _build_document(done: RepairResult) -> dict[str, Any]:
    from urdfcheck.source.package.finder import format_path

    return {
        "schema": SCHEMA,
        "model": format_path(done.model),
        "files": done.files,
        "fixed": [{"code": finding.code, "subjects": list(finding.subjects)} for finding in done.fixed],
        "steps": [_build_step(step) for step in done.steps],
        "before": {"summary": _count_findings(done.before), "codes": _count_codes(done.before)},
        "after": {"summary": _count_findings(done.after), "codes": _count_codes(done.after)},
    }


def _build_step(step: RepairStep) -> dict[str, Any]:
    from urdfcheck.source.package.finder import format_path

    return {
        "stage": step.stage,
        "subject": step.subject,
        "done": step.is_done,
        "withdrawn": step.is_withdrawn,
        "text": step.text,
        "before": dict(step.before),
        "after": dict(step.after),
        "files": [format_path(Path(name)) for name in step.files],
    }


def _count_codes(run: Run) -> dict[str, int]:
    return dict(sorted(Counter(finding.code for finding in run.active_findings).items()))
