"""XML014 reports what urdfdom and Pinocchio report when they load the model."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.model import Model
from urdfcheck.model.motion.pinocchio_model import parser_verdict

# Every loader prints these about the root of a model; other rules give details.
_EXPLAINED = ("root link", "has an inertia specified in the URDF")


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    verdict = parser_verdict(model)
    messages = [m for m in verdict.messages if not any(known in m for known in _EXPLAINED)]
    text = "; ".join(messages) or "it gives no reason"
    if verdict.refused_by == "urdfdom":
        yield rule.finding("refused", at=model, said=text)
    elif verdict.refused_by == "pinocchio":
        yield rule.finding("pinocchio", at=model, severity=Severity.WARNING, said=text)
    elif messages:
        yield rule.finding("said", at=model, severity=Severity.WARNING, said=text)
