"""What each program does with a model and with the launch files that start it: a mark for the strip, the table and the cards."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from urdfcheck.core import Finding, Rule, Severity, Verdict
from urdfcheck.core.records import dataclass
from urdfcheck.output.shared.verdict.effects import describe_verdict
from urdfcheck.output.shared.wording import PROGRAM_NAMES
from urdfcheck.policy.consumers import CONSUMERS, ConsumerOutcome, get_verdict, is_news, predict_outcomes

_KINDS = ("ok", "unchecked", "warning", "error")


@dataclass(frozen=True, slots=True)
class ProgramMark:
    """The worst that a program does with a model: ok | unchecked | warning | error, in words."""

    program: str
    kind: str
    words: str
    is_listed: bool = True
    """Whether the report lists why, if it is not only that the program loads the model."""

    @property
    def name(self) -> str:
        """The program by the spelling of its own project."""
        return PROGRAM_NAMES.get(self.program, self.program)


def mark_programs(
    findings: Iterable[Finding], rules: Mapping[str, Rule], listed: Iterable[Finding] | None = None
) -> list[ProgramMark]:
    """Return a mark for each program: the worst of what it does with the model and, when launched, with its launch files.

    ``listed``: those of the findings that the report lists, if it leaves out notes.
    """
    findings = list(findings)
    shown = predict_outcomes(findings if listed is None else listed)
    launched = select_launch_findings(findings, rules)
    marks = []
    for program, outcome in predict_outcomes(findings).items():
        kind, words = rate_outcome(outcome), describe_outcome(outcome)
        is_listed = shown[program].verdict is outcome.verdict
        for finding in launched:
            effect = mark_effect(finding, program, rules)
            if _KINDS.index(effect) > _KINDS.index(kind):
                kind, words = effect, f"when launched: {finding.consequences[program]}"
                is_listed = True
        marks.append(
            ProgramMark(program, kind, words if is_listed else f"{words} (why is in the notes: -v)", is_listed)
        )
    return marks


def rate_verdict(verdict: Verdict) -> str:
    """Return how bad a verdict is: ok | warning | error."""
    if verdict >= Verdict.DROPS:
        return "error"
    return "ok" if verdict is Verdict.LOADS else "warning"


def rate_outcome(outcome: ConsumerOutcome) -> str:
    """Return how bad it is what a program does with a model: ok | unchecked | warning | error."""
    return "unchecked" if outcome.unproven else rate_verdict(outcome.verdict)


def describe_outcome(outcome: ConsumerOutcome) -> str:
    """Say what happens to a model in a program: ``loads it changed: drops a part``."""
    match verdict := outcome.verdict:
        case Verdict.LOADS:
            return "may lack a mesh that was not checked" if outcome.unproven else "loads it as typed"
        case Verdict.REFUSES:
            return "refuses it"
        case Verdict.NAN:
            return f"loads it and {describe_verdict(verdict)}"
    return f"loads it changed: {describe_verdict(verdict)}"


def mark_effect(finding: Finding, program: str, rules: Mapping[str, Rule]) -> str:
    """Return how bad it is what a program does with one defect: ok | warning | error.

    Sentences about launch files have no verdict; they are as bad as the finding."""
    kind = rate_verdict(get_verdict(finding.consequences, program))
    if kind != "ok" or not is_affected(finding, program) or not select_launch_findings([finding], rules):
        return kind
    return "ok" if finding.severity == Severity.INFO else str(finding.severity)


def select_launch_findings(findings: Iterable[Finding], rules: Mapping[str, Rule]) -> list[Finding]:
    """Select the findings about launch files that are not suppressed."""
    return [f for f in findings if f.code in rules and rules[f.code].scopes == ("launch",) and f.suppressed is None]


def is_affected(finding: Finding, program: str) -> bool:
    """Whether a program does anything but load what was typed."""
    sentence = finding.consequences.get(program)
    if sentence is None:
        return get_verdict(finding.consequences, program) > Verdict.LOADS
    return is_news(sentence)


def list_affected_programs(finding: Finding) -> list[str]:
    """List the programs of the strip that do anything but load what was typed."""
    return [program for program in CONSUMERS if is_affected(finding, program)]
