"""The verdict on a run as one claim: how many errors, which programs refuse the model, or why it was not checked."""

from __future__ import annotations

from collections.abc import Sequence

from urdfcheck.core import Finding, Run, Severity, Verdict
from urdfcheck.core.text import join_names
from urdfcheck.output.shared.verdict.effects import drops_only_data
from urdfcheck.output.shared.verdict.engine_answers import list_answers
from urdfcheck.output.shared.verdict.not_checked import describe_not_checked, explain_unchecked, is_accepted
from urdfcheck.output.shared.verdict.verdict import summarize_verdict
from urdfcheck.output.shared.wording import PROGRAM_NAMES, format_count, get_base_name, join_with_and
from urdfcheck.policy.consumers import get_verdict, predict_outcomes

# Models that were not checked and programs that a claim names.
_MOST_NAMED = 3


def state_claim(run: Run) -> tuple[str, str]:
    """Return the claim: error | unchecked | warning | ok, and a sentence without its full stop.

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
    if errors:
        said, found = "error", format_count(errors, "error") + _describe_models_with_errors(run)
    elif warnings:
        said, found = "ok", f"No errors, {format_count(warnings, 'warning')}"
    else:
        return kind, sentence if not run.unchecked_models else f"{_name_unchecked(run)}. No errors and no warnings"
    if losses := describe_losses(run):
        said, found = "warning" if said == "ok" else said, f"{found}: {losses}"
    if unchecked := describe_not_checked(run):
        said = "unchecked" if run.unchecked_models or said == "ok" else said
        found = f"{_name_unchecked(run) if run.unchecked_models else unchecked}. {found}"
    return said, found


def describe_losses(run: Run) -> str:
    """Return ``MuJoCo and Drake refuse this model, Gazebo drops a part``, of the targets if there are any.

    Empty for several models, and if no program is known to.
    """
    if len(run.models) != 1:
        return ""
    targets = run.get_targets(run.models[0].id)
    names: dict[Verdict, list[str]] = {}
    answers = list_answers(run, run.models[0].id)
    without_data: list[str] = []
    findings = [*run.findings, *run.unrequested]
    for name, outcome in predict_outcomes(findings).items():
        if name in answers and Verdict.REFUSES in (outcome.verdict, answers[name].verdict):
            continue  # its own answer counts
        if not targets or name in targets:
            alike = names.setdefault(outcome.verdict, [])
            is_data = outcome.verdict is Verdict.DROPS and _loses_only_data(findings, name)
            (without_data if is_data else alike).append(PROGRAM_NAMES.get(name, name))
    refusing, dropping = names.get(Verdict.REFUSES, []), names.get(Verdict.DROPS, [])
    said = (
        [f"{join_with_and(refusing, _MOST_NAMED)} {'refuses' if len(refusing) == 1 else 'refuse'} this model"]
        if refusing
        else []
    )
    refused = [f"{PROGRAM_NAMES[n]} {a.version}" for n, a in answers.items() if a.verdict is Verdict.REFUSES]
    if refused:
        said.insert(0, f"{join_with_and(refused, _MOST_NAMED)} refused this model here")
    if dropping:
        verb = "drops" if len(dropping) == 1 else "drop"
        said.append(f"{join_with_and(dropping, _MOST_NAMED)} {verb} a part{'' if said else ' of this model'}")
    if without_data:
        verb = "drops" if len(without_data) == 1 else "drop"
        said.append(f"{join_with_and(without_data, _MOST_NAMED)} {verb} the data of a sensor")
    return ", ".join(said)


def _loses_only_data(findings: Sequence[Finding], program: str) -> bool:
    """Whether what a program drops is never a part of the model, but what a sensor measures."""
    dropped = [f for f in findings if get_verdict(f.consequences, program) is Verdict.DROPS]
    return all(drops_only_data(f.consequences.get(program, "")) for f in dropped)


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
