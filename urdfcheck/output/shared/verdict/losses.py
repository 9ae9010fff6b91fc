"""Which programs refuse a model or lose a part of it, and where a report says why: among its errors and warnings, or elsewhere.

A sentence joins what a program loses to counts of findings only if these cause it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import field, replace
from enum import IntEnum

from urdfcheck.core import Finding, Run, Severity, Verdict
from urdfcheck.core.records import dataclass
from urdfcheck.output.shared.verdict.effects import drops_only_data
from urdfcheck.output.shared.verdict.engine_answers import list_answers
from urdfcheck.output.shared.wording import PROGRAM_NAMES, format_count, join_with_and
from urdfcheck.policy.consumers import CONSUMERS, get_verdict, predict_outcomes

# Programs that a clause names.
_MOST_NAMED = 3


class Reason(IntEnum):
    """Where a report says why a program loses something, the most prominent place first."""

    ERROR = 0
    WARNING = 1
    NOTE = 2
    UNLISTED = 3
    """A note on request."""
    SUPPRESSED = 4
    NONE = 5
    """Nowhere: an engine refused the model here, and the rule that reports it is not selected."""


_WHERE = {
    Reason.NOTE: ": the notes say why",
    Reason.UNLISTED: ": why is in the notes (-v)",
    Reason.SUPPRESSED: ": what says why is suppressed",
    Reason.NONE: "",
}


@dataclass(frozen=True, slots=True)
class Losses:
    """What programs do not load, in clauses without a full stop; empty where they are not known to lose anything."""

    by_problems: str = ""
    """Because of errors and warnings: ``MuJoCo and Drake refuse this model, Gazebo drops a part``. Empty for several models: the
    report counts those with errors."""
    by_others: str = ""
    """Because of anything else: ``Drake refuses this model: the notes say why``."""
    needs_warnings: bool = False
    """Whether the errors alone do not explain ``by_problems``."""
    is_any: bool = False
    """Whether a program loses something of a model, for whatever reason: then a tick would contradict it."""


@dataclass(frozen=True, slots=True)
class _Loss:
    """What one program loses of a model. ``version``: of the engine that refused it here."""

    program: str
    verdict: Verdict
    reason: Reason
    is_data: bool
    version: str = ""


@dataclass(slots=True)
class _Programs:
    """The names of the programs that lose something for reasons in one place."""

    refused: list[str] = field(default_factory=list)
    refusing: list[str] = field(default_factory=list)
    dropping: list[str] = field(default_factory=list)
    without_data: list[str] = field(default_factory=list)

    def add(self, loss: _Loss) -> None:
        name = PROGRAM_NAMES.get(loss.program, loss.program)
        if loss.version:
            self.refused.append(f"{name} {loss.version}")
        elif loss.verdict is Verdict.REFUSES:
            self.refusing.append(name)
        else:
            (self.without_data if loss.is_data else self.dropping).append(name)

    def describe(self) -> str:
        """Return ``MuJoCo and Drake refuse this model, Gazebo drops a part``."""
        said = [f"{join_with_and(self.refused, _MOST_NAMED)} refused this model here"] if self.refused else []
        if self.refusing:
            said.append(f"{_join_with_verb(self.refusing, 'refuse')} this model")
        if self.dropping:
            said.append(f"{_join_with_verb(self.dropping, 'drop')} a part{'' if said else ' of this model'}")
        if self.without_data:
            said.append(f"{_join_with_verb(self.without_data, 'drop')} the data of a sensor")
        return ", ".join(said)


def describe_losses(run: Run) -> Losses:
    """Say what the targets lose of the models, or all programs where there are no targets, and where the report says why."""
    if len(run.models) > 1:
        return _summarize_losses(run)
    known, unlisted = [*run.findings, *run.unrequested], _collect_unlisted(run)
    losses = [loss for info in run.models for loss in _iter_losses(run, info.id, known, unlisted)]
    groups: dict[Reason, _Programs] = {}
    for loss in sorted(losses, key=lambda loss: loss.reason):
        # Errors and warnings are counted beside each other.
        reason = Reason.ERROR if loss.reason is Reason.WARNING else loss.reason
        groups.setdefault(reason, _Programs()).add(loss)
    problems = groups.pop(Reason.ERROR, _Programs())
    return Losses(
        by_problems=problems.describe(),
        by_others=" · ".join(f"{programs.describe()}{_WHERE[reason]}" for reason, programs in groups.items()),
        needs_warnings=any(loss.reason is Reason.WARNING for loss in losses),
        is_any=bool(losses),
    )


def list_refusing_notes(run: Run) -> Run:
    """Return the run with the notes on request among its findings that say why a program refuses a model or drops a part of it.

    Where there are targets, notes about other programs stay out, and so do those about models of which errors alone are listed.
    """
    quiet = run.set_aside
    listed = [
        note
        for note in run.unrequested
        if note.model not in quiet
        and any(get_verdict(note.consequences, name) >= Verdict.DROPS for name in _list_programs(run, note.model))
    ]
    if not listed:
        return run
    ids = {id(note) for note in listed}
    rest = tuple(note for note in run.unrequested if id(note) not in ids)
    return replace(run, findings=(*run.findings, *listed), unrequested=rest)


def _collect_unlisted(run: Run) -> set[int]:
    """Collect the identities of the notes on request, which a run may have many of: they are the same for all its models."""
    return {id(note) for note in run.unrequested}


def _classify(finding: Finding, is_unlisted: bool) -> Reason:
    """Return where a report has a finding."""
    if finding.suppressed is not None:
        return Reason.SUPPRESSED
    if is_unlisted:
        return Reason.UNLISTED
    return {Severity.ERROR: Reason.ERROR, Severity.WARNING: Reason.WARNING}.get(finding.severity, Reason.NOTE)


def _iter_losses(run: Run, model: str, findings: Sequence[Finding], unlisted: set[int]) -> Iterator[_Loss]:
    """Yield what each program loses of a model; ``findings`` are those that may be about it, notes on request included.

    ``unlisted``: see `_collect_unlisted`.
    """
    known = [finding for finding in findings if model in finding.subjects_by_model]
    answers, wanted = list_answers(run, model), _list_programs(run, model)
    for name, outcome in predict_outcomes(known).items():
        verdict, version = outcome.verdict, ""
        if name in answers and Verdict.REFUSES in (verdict, answers[name].verdict):
            if answers[name].verdict is not Verdict.REFUSES:
                continue  # it loaded the model here
            verdict, version = Verdict.REFUSES, answers[name].version
        elif name not in wanted:
            continue
        if verdict >= Verdict.DROPS:
            causes = [finding for finding in known if get_verdict(finding.consequences, name) is verdict]
            is_data = all(drops_only_data(finding.consequences.get(name, "")) for finding in causes)
            reason = min((_classify(finding, id(finding) in unlisted) for finding in causes), default=Reason.NONE)
            yield _Loss(name, verdict, reason, is_data, version)


def _summarize_losses(run: Run) -> Losses:
    """Say ``MuJoCo refuses 2 of 4 models: why is in the notes (-v)`` of models that lose nothing because of errors and warnings,
    but because of anything else."""
    by_model: dict[str, list[Finding]] = {info.id: [] for info in run.models if info.status == "checked"}
    for finding in (*run.findings, *run.unrequested):
        for model in finding.subjects_by_model:
            if model in by_model:
                by_model[model].append(finding)
    reasons: dict[Reason, list[list[_Loss]]] = {}
    is_any, unlisted = False, _collect_unlisted(run)
    for model, findings in by_model.items():
        losses = list(_iter_losses(run, model, findings, unlisted))
        is_any |= bool(losses)
        if losses and min(loss.reason for loss in losses) > Reason.WARNING:
            verdict = max(loss.verdict for loss in losses)
            worst = [loss for loss in losses if loss.verdict is verdict]
            reasons.setdefault(min(loss.reason for loss in worst), []).append(worst)
    clauses = []
    for reason, models in sorted(reasons.items()):
        clauses.append(
            f"{_describe_loss(models)} {len(models)} of {format_count(len(run.models), 'model')}{_WHERE[reason]}"
        )
    return Losses(by_others=" · ".join(clauses), is_any=is_any)


def _describe_loss(models: Sequence[Sequence[_Loss]]) -> str:
    """Say what programs lose of models, whose number follows: ``MuJoCo and Drake refuse``; ``MuJoCo or Drake refuses`` where not
    all of these models are lost in the same programs."""
    by_model = [{PROGRAM_NAMES.get(loss.program, loss.program): None for loss in losses} for losses in models]
    names = list({name: None for some in by_model for name in some})
    verdicts = {loss.verdict for losses in models for loss in losses}
    if all(len(some) == len(names) for some in by_model):
        subject, ending = join_with_and(names, _MOST_NAMED), "s" if len(names) == 1 else ""
    else:
        *first, last = names if len(names) <= _MOST_NAMED + 1 else [*names[:_MOST_NAMED], "another program"]
        subject, ending = f"{', '.join(first)} or {last}", "s"
    if verdicts == {Verdict.REFUSES}:
        return f"{subject} refuse{ending}"
    if Verdict.REFUSES not in verdicts:
        return f"{subject} drop{ending} a part of"
    return f"{subject} refuse{ending}, or drop{ending} a part of,"


def _list_programs(run: Run, model: str) -> Sequence[str]:
    """List the targets of a model; without targets, all programs whose behaviour is predicted."""
    return run.get_targets(model) or CONSUMERS


def _join_with_verb(names: Sequence[str], verb: str) -> str:
    return f"{join_with_and(names, _MOST_NAMED)} {verb}{'s' if len(names) == 1 else ''}"
