"""JNT009 reports mimic joints whose leader is unusable, or whose motion exceeds their own limits."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Located, Rule, Severity
from urdfcheck.core.text import SLIP_LIKENESS, find_only_near_name, format_name_hint
from urdfcheck.model import Model
from urdfcheck.model.parts import Joint
from urdfcheck.source.text.tokens import build_replacement_edits
from urdfcheck.source.text.values import read_attribute_number
from urdfcheck.source.text.xml import Element

_BOUNDED = frozenset({"revolute", "prismatic"})


def check(model: Model, rule: Rule, *, slack: float) -> Iterator[Finding]:
    for joint in model.joints:
        mimic = joint.mimic
        if mimic is None or not mimic.get("joint"):
            continue
        at = mimic.attributes["joint"]
        leader = model.joint_by_name.get(at.value)
        loop = _find_mimic_loop(model, joint)
        if leader is None:
            known = model.joint_by_name.keys() - {joint.name}
            near = find_only_near_name(at.value, known, SLIP_LIKENESS)
            edits = build_replacement_edits([at], near) if near is not None else ()
            told = format_name_hint(at.value, known)
            yield rule.finding("unknown", at=at, edits=edits, joint=joint.name, leader=at.value, near=told)
        elif leader.name == joint.name:
            yield rule.finding("itself", at=at, joint=joint.name)
        elif loop:
            if joint.name == min(loop, key=[j.name for j in model.joints].index):
                yield rule.finding("cycle", at=at, joint=joint.name, loop=" → ".join((*loop, loop[0])))
        elif leader.type == "fixed":
            yield rule.finding("fixed", at=at, joint=joint.name, leader=leader.name, related=[leader])
        else:
            yield from _check_range(rule, joint, leader, mimic, at, slack)


def _find_mimic_loop(model: Model, start: Joint) -> tuple[str, ...]:
    """The joints that follow each other in a circle through ``start``, empty when they do not."""
    seen: list[str] = []
    joint: Joint | None = start
    while joint is not None and joint.name not in seen:
        seen.append(joint.name)
        joint = model.joint_by_name.get("" if joint.mimic is None else joint.mimic.get("joint"))
    return tuple(seen) if joint is not None and joint.name == start.name else ()


def _check_range(
    rule: Rule, joint: Joint, leader: Joint, mimic: Element, at: Located, slack: float
) -> Iterator[Finding]:
    own, led = _get_limits(joint), _get_limits(leader)
    multiplier = _read_coefficient(mimic, "multiplier", 1.0)
    offset = _read_coefficient(mimic, "offset", 0.0)
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


def _get_limits(joint: Joint) -> tuple[float, float] | None:
    lower, upper = joint.get_limit_value("lower"), joint.get_limit_value("upper")
    if joint.type not in _BOUNDED or lower is None or upper is None or lower >= upper:
        return None
    return lower, upper


def _read_coefficient(mimic: Element, name: str, default: float) -> float | None:
    return read_attribute_number(mimic, name) if name in mimic.attributes else default
