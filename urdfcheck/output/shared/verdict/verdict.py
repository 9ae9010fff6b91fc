"""The verdict on a run, in one sentence that all formats share."""

from __future__ import annotations

from urdfcheck.core import Run, Severity
from urdfcheck.output.shared.verdict.not_checked import describe_not_checked
from urdfcheck.output.shared.wording import format_count


def describe_checked_units(run: Run) -> str:
    """Return ``2 models``, ``2 models, 1 set aside``; ``1 file`` if all were launch files and packages."""
    if run.units and not run.models:
        return format_count(run.units, "file")
    aside = f", {len(run.set_aside)} set aside" if run.set_aside else ""
    return format_count(len(run.models), "model") + aside


def summarize_verdict(run: Run) -> tuple[str, str]:
    """Return the verdict on a run: error | unchecked | warning | ok, and a sentence without its full stop.

    What was not checked comes first: whatever else is said holds for the rest only.
    """
    errors, warnings = run.count_findings(Severity.ERROR), run.count_findings(Severity.WARNING)
    if run.failures:
        return "error", "Not finished: a part of urdfcheck itself failed, so this verdict is incomplete"
    if not run.models and not run.units and not run.findings:
        return "warning", "Nothing was checked"
    unchecked = describe_not_checked(run)
    if errors:
        kind, sentence = "error", f"{format_count(errors, 'error')} to repair"
    elif warnings:
        kind, sentence = "warning", f"No errors, {format_count(warnings, 'warning')}"
    elif not set(run.rules) - {"URC900"}:  # it reports crashes, whatever is selected
        kind, sentence = "warning", "Nothing was looked for: no rule is selected"
    else:
        kind, sentence = "ok", "No errors and no warnings"
    if not unchecked:
        return kind, sentence
    return "unchecked" if run.unchecked_models or kind == "ok" else kind, f"{unchecked}. {sentence}"
