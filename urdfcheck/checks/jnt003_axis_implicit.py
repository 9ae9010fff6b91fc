"""JNT003 reports joints that need an `<axis>` and have none."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from urdfcheck.core import Finding, Rule
from urdfcheck.core.text import join_names
from urdfcheck.model import Model


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    joints = [joint for joint in model.joints if joint.has_axis and joint.axis_element is None]
    if joints:
        finding = rule.finding(
            "implicit",
            at=joints[0],
            related={j.element.span: j for j in joints[1:] if j.element.span != joints[0].element.span}.values(),
            joints=join_names(joint.name for joint in joints),
            count="1 joint has" if len(joints) == 1 else f"{len(joints)} joints have",
        )
        yield replace(finding, subjects=tuple(joint.location.subject for joint in joints))
