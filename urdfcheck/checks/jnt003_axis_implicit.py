"""JNT003 reports joints that need an `<axis>` and have none."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.core.merging import build_group_finding
from urdfcheck.core.text import format_count, join_names
from urdfcheck.model import Model


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    joints = [joint for joint in model.joints if joint.has_axis and joint.axis_element is None]
    if joints:
        yield build_group_finding(
            rule,
            "implicit",
            joints,
            joints=join_names(joint.name for joint in joints),
            count=format_count(len(joints), "joint has", "joints have"),
        )
