"""JNT005: the lower limit of a joint lies below the upper one."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Edit, Finding, Rule, Severity
from urdfcheck.model import Model
from urdfcheck.source.xml import Attribute, Definition, Element


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    for joint in model.joints:
        limit, lower, upper = joint.limit, joint.limit_value("lower"), joint.limit_value("upper")
        if joint.type not in {"revolute", "prismatic"} or limit is None or lower is None or upper is None:
            continue
        typed = [limit.attributes[name] for name in ("lower", "upper") if name in limit.attributes]
        if not typed or lower < upper:
            continue  # neither is given: JNT004
        data = {"joint": joint.name, "unit": "rad" if joint.type == "revolute" else "m"}
        if lower == upper:
            yield rule.finding(
                "equal", at=limit, severity=Severity.WARNING, related=_related(typed), value=lower, **data
            )
        else:
            yield rule.finding(
                "inverted", at=limit, edits=_swap(limit), related=_related(typed), lower=lower, upper=upper, **data
            )


def _related(attributes: list[Attribute]) -> list[Definition]:
    return [definition for attribute in attributes for definition in attribute.related()]


def _swap(limit: Element) -> list[Edit]:
    lower, upper = limit.attributes.get("lower"), limit.attributes.get("upper")
    if lower is None or upper is None or not (lower.literal and upper.literal) or not (lower.span and upper.span):
        return []
    return [Edit(lower.span, lower.typed, upper.typed), Edit(upper.span, upper.typed, lower.typed)]
