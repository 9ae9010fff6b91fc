"""KIN001 reports links and joints that share a name."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from urdfcheck.core import Finding, Location, Rule, Severity
from urdfcheck.core.text import join_names
from urdfcheck.model import Joint, Link, Model
from urdfcheck.model.link_graph import KinematicGraph

# MuJoCo needs a joint's name only where something refers to it.
MUJOCO = {"link": "refuses the file: repeated name", "joint": "replaces the second name by an empty one"}


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    yield from _check_repeated_names(model.links, "link", rule)
    yield from _check_joints(model, rule)
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


def _check_joints(model: Model, rule: Rule) -> Iterator[Finding]:
    """Report joints of one name; where they have one child too, another name alone would leave it with two parents."""
    declared = Counter(link.name for link in model.links)
    copies = [j for j in model.joints if j.name and _is_copy(model.joint_by_name[j.name], j, declared)]
    copied = set(map(id, copies))
    yield from _check_repeated_names([j for j in model.joints if id(j) not in copied], "joint", rule)
    for joint in copies:
        meant = _find_meant_child(model, joint) if len(copies) == 1 else ""
        is_explained = meant and len(KinematicGraph.from_model(model).find_components()) == 2
        yield rule.finding(
            "copied",
            at=_locate_name(joint),
            related=[_locate_name(model.joint_by_name[joint.name])],
            explains=[f"KIN005 link[{link.name}]" for link in model.links] if is_explained else [],
            called=joint.name,
            child=joint.child,
            meant=f" (perhaps {meant}, which has no joint)" if meant else "",
        )


def _is_copy(first: Joint, joint: Joint, declared: Mapping[str, int]) -> bool:
    """Whether a joint has the child of the first one of its name, and is not that of a second link of the child's name."""
    return first is not joint and first.child == joint.child != "" and declared[joint.child] == 1


def _find_meant_child(model: Model, joint: Joint) -> str:
    """Return the link that is declared just before a joint and has none, or nothing: the copy may be meant for it."""
    parts = [child for child in model.robot.children if child.tag in {"link", "joint"}]
    before = parts[parts.index(joint.element) - 1]
    name = before.get("name") if before.tag == "link" else ""
    return "" if any(other.child == name for other in model.joints) else name


def _locate_name(part: Link | Joint) -> Location:
    attribute = part.element.attributes.get("name")
    return part.location if attribute is None else attribute.location
