"""The verdict on a run as one claim: how many errors, which programs refuse the model, or why it was not checked."""

from __future__ import annotations

from urdfcheck.core import Run, Severity
from urdfcheck.core.text import join_names
from urdfcheck.output.shared.verdict.losses import Losses, describe_losses
from urdfcheck.output.shared.verdict.not_checked import describe_not_checked, explain_unchecked, is_accepted
from urdfcheck.output.shared.verdict.verdict import summarize_verdict
from urdfcheck.output.shared.wording import format_count, get_base_name

# Models that were not checked that a claim names.
_MOST_NAMED = 3


def state_claim(run: Run) -> tuple[str, str]:
    """Return the claim: error | unchecked | warning | info | ok, and a sentence without its full stop.

    What was not checked comes first: whatever else is said holds for the rest only.
    """
    kind, sentence = summarize_verdict(run)
    errors, warnings = run.count_findings(Severity.ERROR), run.count_findings(Severity.WARNING)
    if run.failures:
        return "error", f"Not finished: {format_count(len(run.failures), 'failure')}, so this verdict is incomplete"
    if kind == "unchecked" and len(run.models) == 1 and run.unchecked_models:
        (info,) = run.unchecked_models
        accepted = " (accepted)" if is_accepted(info) else ""
        return "unchecked", f"Not checked{accepted}: {explain_unchecked(info)}"
    losses = describe_losses(run)
    if errors:
        said, found = "error", format_count(errors, "error") + _describe_models_with_errors(run)
        found += f", {format_count(warnings, 'warning')}" if losses.needs_warnings and warnings else ""
    elif warnings:
        said = "warning" if losses.is_any else "ok"
        found = f"No errors, {format_count(warnings, 'warning')}"
    else:
        found = sentence if not run.unchecked_models else f"{_name_unchecked(run)}. No errors and no warnings"
        return grade_by_losses(kind, losses), _append_losses(found, losses)
    found = _append_losses(found, losses)
    if unchecked := describe_not_checked(run):
        said = "unchecked" if run.unchecked_models or said == "ok" else said
        found = f"{_name_unchecked(run) if run.unchecked_models else unchecked}. {found}"
    return said, found


def grade_by_losses(kind: str, losses: Losses) -> str:
    """Return the kind of a verdict: ``info`` where nothing else is wrong than what programs lose because of notes.

    A tick beside it would contradict that they refuse the model.
    """
    return "info" if kind == "ok" and losses.is_any else kind


def _append_losses(found: str, losses: Losses) -> str:
    """Append to counts of findings what programs lose because of them, after a colon, and because of anything else."""
    caused = f"{found}: {losses.by_problems}" if losses.by_problems else found
    return f"{caused} · {losses.by_others}" if losses.by_others else caused


def _name_unchecked(run: Run) -> str:
    names = [get_base_name(info.path) for info in run.unchecked_models]
    return f"{describe_not_checked(run)} ({join_names(list(dict.fromkeys(names)), _MOST_NAMED)})"


def _describe_models_with_errors(run: Run) -> str:
    """Return `` in 2 of 4 models``; empty for a single model."""
    if len(run.models) < 2:
        return ""
    ids = {info.id for info in run.models}
    bad = {m for f in run.active_findings if f.severity == Severity.ERROR for m in (f.model, *f.subjects_by_model)}
    return f" in {len(ids & bad)} of {format_count(len(run.models), 'model')}" if ids & bad else ""
