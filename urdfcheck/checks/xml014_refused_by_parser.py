"""XML014 reports what urdfdom and Pinocchio report when they load the model."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.model import Model
from urdfcheck.model.motion.pinocchio_model import parser_verdict
from urdfcheck.model.parts import Joint, Link

# Every loader prints these about the root of a model; other rules give details.
_EXPLAINED = ("root link", "has an inertia specified in the URDF")
# Pinocchio says this of each model that urdfdom refuses.
_NO_REASON = "does not contain a valid URDF model"
# How urdfdom and Pinocchio name the part in which they stop.
_NAMED = re.compile(r"\b(joint|link) \[([^\[\]]+)\]")


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    verdict = parser_verdict(model)
    messages = [m for m in verdict.messages if not any(known in m for known in _EXPLAINED)]
    reasons = [m for m in messages if _NO_REASON not in m]
    text = "; ".join(reasons or messages) or "it gives no reason"
    place = _find_named_part(model, messages) or model
    if verdict.refused_by == "urdfdom":
        yield rule.finding("refused", at=place, said=text)
    elif verdict.refused_by == "pinocchio":
        yield rule.finding("pinocchio", at=place, severity=Severity.WARNING, said=text)
    elif messages:
        yield rule.finding("said", at=place, severity=Severity.WARNING, said=text)


def _find_named_part(model: Model, messages: Sequence[str]) -> Joint | Link | None:
    """Return the one joint or link that the messages name; None if they name several or none."""
    named = {match.groups() for message in messages for match in _NAMED.finditer(message)}
    parts = [(model.joint_by_name if kind == "joint" else model.link_by_name).get(name) for kind, name in named]
    return parts[0] if len(parts) == 1 else None
