"""CTL001: `<ros2_control>` and `<transmission>` name joints of the model."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.model import Model
from urdfcheck.model.names import hint


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    for tag in ("ros2_control", "transmission"):
        for block in model.robot.all(tag):
            for element in block.walk():
                name = element.attributes.get("name")
                if element.tag != "joint" or name is None or not name.value or name.value in model.joint_by_name:
                    continue
                yield rule.finding(
                    tag,
                    at=name,
                    related=name.related(),
                    joint=name.value,
                    block=block.get("name"),
                    near=hint(name.value, model.joint_by_name),
                )
