"""CTL001 reports joints in `<ros2_control>` and `<transmission>` that the robot lacks."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from urdfcheck.core import Finding, Rule
from urdfcheck.core.text import SLIP_LIKENESS, find_only_near_name, format_name_hint, join_names
from urdfcheck.model import Model
from urdfcheck.source.text.tokens import build_replacement_edits
from urdfcheck.source.text.xml import Attribute


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    for tag in ("ros2_control", "transmission"):
        strange: list[Attribute] = []
        for block in model.robot.find_children(tag):
            for element in block.walk():
                name = element.attributes.get("name")
                if element.tag != "joint" or name is None or not name.value or name.value in model.joint_by_name:
                    continue
                near = format_name_hint(name.value, model.joint_by_name)
                if near:
                    yield _build_misspelt_finding(model, rule, tag, block.get("name"), name, near)
                else:
                    strange.append(name)
        if strange:
            yield _build_foreign_finding(rule, tag, strange)


def _build_misspelt_finding(model: Model, rule: Rule, tag: str, block: str, name: Attribute, near: str) -> Finding:
    meant = find_only_near_name(name.value, model.joint_by_name, SLIP_LIKENESS)
    edits = build_replacement_edits([name], meant) if meant is not None else ()
    return rule.finding(
        tag, at=name, related=name.collect_definitions(), edits=edits, joint=name.value, block=block, near=near
    )


def _build_foreign_finding(rule: Rule, tag: str, names: list[Attribute]) -> Finding:
    """One finding for all names that are like none of the robot: they belong to another one, or to a part that is left out."""
    places = {name.span: name for name in names}
    finding = rule.finding(
        f"{tag}-strange",
        at=names[0],
        related=[*names[0].collect_definitions(), *list(places.values())[1:]],
        joints=join_names(dict.fromkeys(name.value for name in names)),
        which="a joint" if len(names) == 1 else f"{len(names)} joints",
    )
    return replace(finding, subjects=tuple(dict.fromkeys(name.location.subject for name in names)))
