"""``urdfcheck engines MODEL``: load a model in all installed simulators and compare the results."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

from urdfcheck.cli.options import CommandParser, add_options, build_access_request
from urdfcheck.cli.terminal import FINDINGS, OK, print_document, report_accepted
from urdfcheck.core.errors import ModelNotCheckedError

if TYPE_CHECKING:
    from urdfcheck.simulators.comparison import EngineComparison, EngineRow

SCHEMA = "urdfcheck-engines/1"
# The columns, and the indices of those that are dropped first where there is no room.
_HEADS = ("engine", "version", "verdict", "links", "mass kg", "max |ΔM|", "max |Δg|")
_DISPENSABLE = (1, 3, 6)


def build_parser() -> argparse.ArgumentParser:
    """Build the parser of ``urdfcheck engines``."""
    p = CommandParser(
        prog="urdfcheck engines",
        description="Load a model in every installed simulator, and compare the results.",
        epilog="exit codes: 0 every engine that should load it does, 1 one does not, 2 urdfcheck or its configuration failed",
    )
    p.add_argument("model", metavar="MODEL", help="a model, or whatever means exactly one")
    p.add_argument("--format", choices=("text", "json"), default="text", help="output format (default: text)")
    add_options(p, "engines")
    return p


def main(words: Sequence[str]) -> int:
    """Run the command."""
    options = build_parser().parse_args(words)

    from urdfcheck.rules import load_rules
    from urdfcheck.simulators.comparison import compare_engines
    from urdfcheck.system import libraries

    libraries.prefer_own_folders()
    request, policy = build_access_request(options, options.model, frozenset(load_rules()))
    try:
        done = compare_engines(request)
    except ModelNotCheckedError as error:
        return report_accepted(error, policy)
    if options.format == "json":
        print_document(json.dumps(_build_document(done), indent=1, ensure_ascii=False, allow_nan=False) + "\n")
    else:
        from urdfcheck.output.shared.escaping import escape_for_log

        for line in _iter_lines(done, _get_width()):
            print(escape_for_log(line))
    failed = any(_is_unexpected_refusal(row, policy.targets) for row in done.rows)
    return FINDINGS if failed else OK


def _is_unexpected_refusal(row: EngineRow, targets: Sequence[str]) -> bool:
    """Whether an engine rejects the model although it is a target, or no finding predicts the rejection."""
    from urdfcheck.core import Verdict

    refused = row.judgement.verdict is Verdict.REFUSES
    return refused and (row.engine in targets or row.predicted is not Verdict.REFUSES)


def _get_width() -> int:
    import shutil

    return shutil.get_terminal_size((100, 24)).columns if sys.stdout.isatty() else 100


def _iter_lines(done: EngineComparison, width: int) -> Iterator[str]:
    import textwrap

    table = [_HEADS, *(_format_cells(row) for row in done.rows)]
    widths = [max(len(line[i]) for line in table) for i in range(len(_HEADS))]
    shown = list(range(len(_HEADS)))
    for dispensable in _DISPENSABLE:
        if sum(widths[i] + 2 for i in shown) - 2 > width:
            shown.remove(dispensable)
    for place, line in enumerate(table):
        yield "  ".join(line[i].ljust(widths[i]) if i < 3 else line[i].rjust(widths[i]) for i in shown).rstrip()
        for note in _iter_notes(done.rows[place - 1]) if place else ():
            yield from textwrap.wrap(note, max(width, 40), initial_indent="    ", subsequent_indent="      ")
    yield ""
    info = done.info
    mass = "" if info.mass is None else f", {info.mass:.4g} kg"
    explained = (
        f"{info.path}: {info.links} links{mass} as typed. ΔM and Δg: mass matrix and gravity torques at random "
        "configurations, the largest difference from what was typed by the largest number. Engines that fix the root to the "
        "world do not count its mass."
    )
    yield from textwrap.wrap(explained, max(width, 40))
    for name, command in done.missing.items():
        yield f"{name} is not installed: {command}"


def _format_cells(row: EngineRow) -> tuple[str, ...]:
    loaded, judgement = row.outcome.loaded, row.judgement
    return (
        row.engine,
        row.version,
        _format_verdict(row.judgement.verdict.name),
        "-" if loaded is None or not loaded.links else str(len(loaded.links)),
        "-" if loaded is None or not loaded.links else f"{sum(loaded.links.values()):.4g}",
        "-" if judgement.matrix is None else f"{judgement.matrix:.1e}",
        "-" if judgement.torque is None else f"{judgement.torque:.1e}",
    )


def _format_verdict(verdict: str) -> str:
    return "NaN" if verdict == "NAN" else verdict.lower()


def _iter_notes(row: EngineRow) -> Iterator[str]:
    yield from row.judgement.reasons
    if row.is_surprise and row.codes:
        yield f"{', '.join(row.codes)} said that it {_format_verdict(row.predicted.name)} it"
    elif row.is_surprise:
        yield "no finding said so"
    elif row.codes:
        yield f"see {', '.join(row.codes)}"
    said = [m for m in row.outcome.messages if not any(m in reason for reason in row.judgement.reasons)]
    if said:
        more = f" (and {len(said) - 1} more)" if len(said) > 1 else ""
        yield f"it prints: {said[0]}{more}"


def _build_document(done: EngineComparison) -> dict[str, Any]:
    return {
        "schema": SCHEMA,
        "model": {"path": done.info.path, "links": done.info.links, "mass": done.info.mass},
        "engines": {row.engine: _build_entry(row) for row in done.rows},
        "missing": dict(done.missing),
    }


def _build_entry(row: EngineRow) -> dict[str, Any]:
    loaded, judgement = row.outcome.loaded, row.judgement
    return {
        "version": row.version,
        "verdict": _format_verdict(judgement.verdict.name),
        "predicted": _format_verdict(row.predicted.name),
        "because": list(row.codes),
        "reasons": list(judgement.reasons),
        "links": None if loaded is None else sorted(loaded.links),
        "mass": None if loaded is None else _keep_finite(sum(loaded.links.values())),
        "matrix": _keep_finite(judgement.matrix),
        "torque": _keep_finite(judgement.torque),
        "messages": list(row.outcome.messages),
    }


def _keep_finite(value: float | None) -> float | None:
    import math

    return value if value is not None and math.isfinite(value) else None
