"""GZB001: `<gazebo reference>` names a link or a joint of the model."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.model import Model
from urdfcheck.model.names import hint


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    known = {*model.link_by_name, *model.joint_by_name}
    for element in model.robot.all("gazebo"):
        reference = element.attributes.get("reference")
        if reference is None or not reference.value or reference.value in known:
            continue
        yield rule.finding(
            "unknown",
            at=reference,
            related=reference.related(),
            reference=reference.value,
            near=hint(reference.value, known),
            content=", ".join(dict.fromkeys(child.tag for child in element.children)) or "nothing",
        )
