"""JNT009: a mimic joint follows a joint that can be followed, within its own limits."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Located, Rule, Severity
from urdfcheck.core.text import SLIP, hint, only_near
from urdfcheck.model import Model
from urdfcheck.model.parts import Joint
from urdfcheck.source.text.tokens import replacing
from urdfcheck.source.text.values import attribute_number
from urdfcheck.source.text.xml import Element

_BOUNDED = frozenset({"revolute", "prismatic"})


def check(model: Model, rule: Rule, *, slack: float) -> Iterator[Finding]:
    for joint in model.joints:
        mimic = joint.mimic
        if mimic is None or not mimic.get("joint"):
            continue
        at = mimic.attributes["joint"]
        leader = model.joint_by_name.get(at.value)
        loop = _loop(model, joint)
        if leader is None:
            known = model.joint_by_name.keys() - {joint.name}
            near = only_near(at.value, known, SLIP)
            edits = replacing([at], near) if near is not None else ()
            told = hint(at.value, known)
            yield rule.finding("unknown", at=at, edits=edits, joint=joint.name, leader=at.value, near=told)
        elif leader.name == joint.name:
            yield rule.finding("itself", at=at, joint=joint.name)
        elif loop:
            if joint.name == min(loop, key=[j.name for j in model.joints].index):
                yield rule.finding("cycle", at=at, joint=joint.name, loop=" → ".join((*loop, loop[0])))
        elif leader.type == "fixed":
            yield rule.finding("fixed", at=at, joint=joint.name, leader=leader.name, related=[leader])
        else:
            yield from _range(rule, joint, leader, mimic, at, slack)


def _loop(model: Model, start: Joint) -> tuple[str, ...]:
    """The joints that follow each other in a circle through ``start``, empty when they do not."""
    seen: list[str] = []
    joint: Joint | None = start
    while joint is not None and joint.name not in seen:
        seen.append(joint.name)
        joint = model.joint_by_name.get("" if joint.mimic is None else joint.mimic.get("joint"))
    return tuple(seen) if joint is not None and joint.name == start.name else ()


def _range(rule: Rule, joint: Joint, leader: Joint, mimic: Element, at: Located, slack: float) -> Iterator[Finding]:
    own, led = _limits(joint), _limits(leader)
    multiplier = _coefficient(mimic, "multiplier", 1.0)
    offset = _coefficient(mimic, "offset", 0.0)
    if own is None or led is None or multiplier is None or offset is None:
        return
    low, high = sorted(multiplier * q + offset for q in led)
    beyond = max(own[0] - low, high - own[1])
    if beyond > slack:
        limit = joint.limit
        yield rule.finding(
            "range",
            at=at,
            severity=Severity.WARNING,
            related=[x for x in (limit, leader.limit) if x is not None],
            joint=joint.name,
            leader=leader.name,
            low=low,
            high=high,
            lower=own[0],
            upper=own[1],
            beyond=beyond,
            unit="rad" if joint.type == "revolute" else "m",
        )


def _limits(joint: Joint) -> tuple[float, float] | None:
    lower, upper = joint.limit_value("lower"), joint.limit_value("upper")
    if joint.type not in _BOUNDED or lower is None or upper is None or lower >= upper:
        return None
    return lower, upper


def _coefficient(mimic: Element, name: str, default: float) -> float | None:
    return attribute_number(mimic, name) if name in mimic.attributes else default
