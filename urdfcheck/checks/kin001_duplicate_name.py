"""KIN001 reports links and joints that share a name."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from urdfcheck.core import Finding, Location, Rule, Severity
from urdfcheck.core.text import join_names
from urdfcheck.model import Joint, Link, Model

# MuJoCo needs a joint's name only where something refers to it.
MUJOCO = {"link": "refuses the file: repeated name", "joint": "replaces the second name by an empty one"}


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    yield from _check_repeated_names(model.links, "link", rule)
    yield from _check_repeated_names(model.joints, "joint", rule)
    # Converters merge the two links of a fixed joint: its name disappears before it can clash.
    shared = [j for j in model.joint_by_name.values() if j.name in model.link_by_name and j.name and j.type != "fixed"]
    if shared:
        names = [joint.name for joint in shared]
        links = [_locate_name(model.link_by_name[name]) for name in names]
        finding = rule.finding(
            "shared",
            at=_locate_name(shared[0]),
            severity=Severity.WARNING,
            related=links[:10],
            who="a link and a joint share the name" if len(names) == 1 else "links and joints share the names",
            names=join_names(names),
            first=names[0],
        )
        yield replace(finding, subjects=tuple(_locate_name(joint).subject for joint in shared))


def _check_repeated_names(parts: Sequence[Link] | Sequence[Joint], kind: str, rule: Rule) -> Iterator[Finding]:
    first: dict[str, Link | Joint] = {}
    for part in parts:
        if part.name and first.setdefault(part.name, part) is not part:
            yield rule.finding(
                "repeated",
                at=_locate_name(part),
                related=[_locate_name(first[part.name])],
                consequences={"mujoco": MUJOCO[kind]},
                kind=kind,
                called=part.name,
            )


def _locate_name(part: Link | Joint) -> Location:
    attribute = part.element.attributes.get("name")
    return part.location if attribute is None else attribute.location
