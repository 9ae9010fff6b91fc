"""What each program does with a model and with the launch files that start it: a mark for the strip, the table and the cards."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from urdfcheck.core import Finding, Rule, Severity, Verdict
from urdfcheck.output.shared.wording import PROGRAM_NAMES
from urdfcheck.policy.consumers import CONSUMERS, get_verdict, predict_outcomes

VERDICT_TEXTS = {
    Verdict.LOADS: ("ok", "loads it as typed"),
    Verdict.IGNORES: ("warning", "loads it changed: ignores a part"),
    Verdict.REPLACES: ("warning", "loads it changed: replaces values"),
    Verdict.SWAPS: ("warning", "loads it changed: swaps values"),
    Verdict.NAN: ("warning", "loads it and computes NaN"),
    Verdict.DROPS: ("error", "loads it changed: drops a part"),
    Verdict.REFUSES: ("error", "refuses it"),
}
# What a program does, for one program and for several.
VERBS = {
    Verdict.IGNORES: ("ignores a part", "ignore a part"),
    Verdict.REPLACES: ("replaces values", "replace values"),
    Verdict.SWAPS: ("swaps values", "swap values"),
    Verdict.NAN: ("computes NaN", "compute NaN"),
    Verdict.DROPS: ("drops a part", "drop a part"),
    Verdict.REFUSES: ("refuses the model", "refuse the model"),
}
_KINDS = ("ok", "warning", "error")


@dataclass(frozen=True, slots=True)
class ProgramMark:
    """The worst that a program does with a model: ok | warning | error, in words."""

    program: str
    kind: str
    words: str

    @property
    def name(self) -> str:
        """The program by the spelling of its own project."""
        return PROGRAM_NAMES.get(self.program, self.program)


def mark_programs(findings: Iterable[Finding], rules: Mapping[str, Rule]) -> list[ProgramMark]:
    """Return a mark for each program: the worst of what it does with the model and, when launched, with its launch files."""
    findings = list(findings)
    launched = select_launch_findings(findings, rules)
    marks = []
    for program, outcome in predict_outcomes(findings).items():
        kind, words = VERDICT_TEXTS[outcome.verdict]
        for finding in launched:
            effect = mark_effect(finding, program, rules)
            if _KINDS.index(effect) > _KINDS.index(kind):
                kind, words = effect, f"when launched: {finding.consequences[program]}"
        marks.append(ProgramMark(program, kind, words))
    return marks


def mark_effect(finding: Finding, program: str, rules: Mapping[str, Rule]) -> str:
    """Return how bad it is what a program does with one defect: ok | warning | error.

    Sentences about launch files have no verdict; they are as bad as the finding."""
    kind, _ = VERDICT_TEXTS[get_verdict(finding.consequences, program)]
    if kind != "ok" or not is_news(finding, program) or not select_launch_findings([finding], rules):
        return kind
    return "ok" if finding.severity == Severity.INFO else str(finding.severity)


def select_launch_findings(findings: Iterable[Finding], rules: Mapping[str, Rule]) -> list[Finding]:
    """Select the findings about launch files that are not suppressed."""
    return [f for f in findings if f.code in rules and rules[f.code].scopes == ("launch",) and f.suppressed is None]


def is_news(finding: Finding, program: str) -> bool:
    """Whether a program does anything but load what was typed."""
    sentence = finding.consequences.get(program)
    if sentence is None:
        return get_verdict(finding.consequences, program) > Verdict.LOADS
    return not sentence.startswith("loads")


def list_affected_programs(finding: Finding) -> list[str]:
    """List the programs of the strip that do anything but load what was typed."""
    return [program for program in CONSUMERS if is_news(finding, program)]
