"""CTL001: `<ros2_control>` and `<transmission>` name joints of the model."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from urdfcheck.core import Finding, Rule
from urdfcheck.core.text import SLIP, hint, listed, only_near
from urdfcheck.model import Model
from urdfcheck.source.text.tokens import replacing
from urdfcheck.source.text.xml import Attribute


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    for tag in ("ros2_control", "transmission"):
        strange: list[Attribute] = []
        for block in model.robot.all(tag):
            for element in block.walk():
                name = element.attributes.get("name")
                if element.tag != "joint" or name is None or not name.value or name.value in model.joint_by_name:
                    continue
                near = hint(name.value, model.joint_by_name)
                if near:
                    yield _misspelt(model, rule, tag, block.get("name"), name, near)
                else:
                    strange.append(name)
        if strange:
            yield _strange(rule, tag, strange)


def _misspelt(model: Model, rule: Rule, tag: str, block: str, name: Attribute, near: str) -> Finding:
    meant = only_near(name.value, model.joint_by_name, SLIP)
    edits = replacing([name], meant) if meant is not None else ()
    return rule.finding(tag, at=name, related=name.related(), edits=edits, joint=name.value, block=block, near=near)


def _strange(rule: Rule, tag: str, names: list[Attribute]) -> Finding:
    """One finding for all names that are like none of the robot: they belong to another one, or to a part that is left out."""
    places = {name.span: name for name in names}
    finding = rule.finding(
        f"{tag}-strange",
        at=names[0],
        related=[*names[0].related(), *list(places.values())[1:]],
        joints=listed(dict.fromkeys(name.value for name in names)),
        which="a joint" if len(names) == 1 else f"{len(names)} joints",
    )
    return replace(finding, subjects=tuple(dict.fromkeys(name.location.subject for name in names)))
