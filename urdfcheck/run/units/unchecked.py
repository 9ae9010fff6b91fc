"""Models of which nothing is known: why, as a finding at the cause and as a line of the report."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

from urdfcheck.core import Finding, Location, NotChecked, Span
from urdfcheck.policy.policy import Policy
from urdfcheck.rules import load_rules
from urdfcheck.run.jobs import AuditSettings, Unit, UnitReport
from urdfcheck.source.package.finder import format_path
from urdfcheck.source.text.problems import Problem


def mark_cause(finding: Finding, policy: Policy) -> Finding:
    """Return a finding as the reason why its model cannot be checked.

    A check that says itself that it blocks the model says how bad that is too: the model may be right, and only this machine
    lacks a package.
    """
    severity = min(finding.severity, policy.unchecked) if finding.blocks_check else policy.unchecked
    return replace(finding, severity=severity, blocks_check=True)


def explain_unchecked(findings: Iterable[Finding], policy: Policy, reading: Iterable[str] = ()) -> NotChecked:
    """Return why a model could not be checked, by the worst of these findings that is a cause.

    :param reading: the options that the run was given for what it reads, without which the remedy leads to another cause.
    """
    cause = max((f for f in findings if f.blocks_check), key=lambda f: f.severity, default=None)
    if cause is None:
        return NotChecked("the model could not be read, for no known reason")
    remedy = str(cause.data.get("remedy", ""))
    return NotChecked(cause.message, " ".join((*reading, remedy)) if remedy else "", policy.accepts_unchecked)


def report_stopped_unit(
    unit: Unit, settings: AuditSettings, message: str, *, problem: Problem | None = None
) -> Finding:
    """Return the finding that the check of a unit was stopped (``message``: time | memory | killed).

    With ``problem`` its expansion was stopped there.
    """
    limits, policy = settings.options.limits, unit.policy or settings.policy
    at = locate_unit(unit) if problem is None else problem.location
    related, reason = ((), "") if problem is None else (problem.related, problem.message)
    finding = load_rules()["URC906"].finding(
        message,
        at=at,
        related=related,
        seconds=limits.seconds,
        memory=limits.memory,
        reason=reason,
        remedy="--memory MIB" if message.endswith("memory") else "--timeout SECONDS",
    )
    return mark_cause(replace(finding, model=unit.id), policy)


def build_stopped_report(unit: Unit, settings: AuditSettings, message: str) -> UnitReport:
    """Return the report on a unit of which nothing is known, because its check was stopped."""
    finding = report_stopped_unit(unit, settings, message)
    cause = explain_unchecked([finding], unit.policy or settings.policy, settings.options.reading)
    return UnitReport(info=unit.describe_unread(cause), findings=(finding,))


def locate_unit(unit: Unit) -> Location:
    """Return the start of the unit's file."""
    return Location("robot", Span(format_path(Path(unit.path)), 1, 1, 1, 1, 0, 0))
