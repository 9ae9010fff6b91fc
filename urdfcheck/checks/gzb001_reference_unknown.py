"""GZB001: `<gazebo reference>` names a link or a joint of the model."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.model import Model
from urdfcheck.model.names import hint
from urdfcheck.source.xml import Attribute


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    known = {*model.link_by_name, *model.joint_by_name}
    unknown: dict[str, list[Attribute]] = {}
    for element in model.robot.all("gazebo"):
        reference = element.attributes.get("reference")
        if reference is not None and reference.value and reference.value not in known:
            unknown.setdefault(reference.value, []).append(reference)
    for name, uses in unknown.items():
        content = dict.fromkeys(child.tag for use in uses for child in use.owner.children)
        yield rule.finding(
            "unknown",
            at=uses[0],
            related=[*uses[0].related(), *uses[1:]],
            reference=name,
            near=hint(name, known),
            content=", ".join(content) or "content",
        )
