"""SRD001 reports names in an SRDF that do not exist, and groups that cannot be built."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import find_only_near_name, format_name_hint
from urdfcheck.model import Model
from urdfcheck.model.likeness.sibling_robots import PackageNames
from urdfcheck.model.motion.planning_limits import collect_group_joints
from urdfcheck.model.motion.semantic_descriptions import semantic_descriptions
from urdfcheck.source.ros.srdf import Srdf, is_about_model, is_configured_for
from urdfcheck.source.text.tokens import build_replacement_edits
from urdfcheck.source.text.xml import Attribute, Element

# How alike a name must be that nothing else in the description means, to be the one that is meant where the description may
# be for a robot that differs: left and right fingers are alike to 0.79.
MIN_SIMILARITY_ELSEWHERE = 0.85
# Each suggestion looks at all names.
MAX_HINTS = 100
# The attributes that name links and joints of the robot: by element, and by the element around it.
_LINKS = {
    ("link", "group"): ("name",),
    ("chain", "group"): ("base_link", "tip_link"),
    ("end_effector", "robot"): ("parent_link",),
    ("virtual_joint", "robot"): ("child_link",),
}
_JOINTS = {("joint", "group"): ("name",), ("joint", "group_state"): ("name",), ("passive_joint", "robot"): ("name",)}
_GROUPS = {
    ("group", "group"): ("name",),
    ("group_state", "robot"): ("group",),
    ("end_effector", "robot"): ("group", "parent_group"),
}


@dataclass(frozen=True, slots=True, eq=False)
class _NameUse:
    kind: str
    attribute: Attribute

    @property
    def name(self) -> str:
        return self.attribute.value.strip()


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    elsewhere = PackageNames(model)
    srdfs = [srdf for srdf in semantic_descriptions(model) if is_about_model(srdf, model.source)]
    for srdf in srdfs:
        yield from _check_unknown_names(model, rule, srdf, elsewhere)
        yield from _check_groups(rule, srdf)
    for srdf in srdfs:
        yield from _check_chains(model, rule, srdf)
        yield from _check_virtual_joints(model, rule, srdf)
        yield from _check_state_joints(model, rule, srdf)


def _collect_name_uses(srdf: Srdf) -> Iterator[_NameUse]:
    for element in srdf.root.walk():
        around = element.parent.tag if element.parent is not None else ""
        for kind, table in (("link", _LINKS), ("joint", _JOINTS), ("group", _GROUPS)):
            for name in table.get((element.tag, around), ()):
                attribute = element.attributes.get(name)
                if attribute is not None and attribute.value.strip():
                    yield _NameUse(kind, attribute)


def _check_unknown_names(model: Model, rule: Rule, srdf: Srdf, elsewhere: PackageNames) -> Iterator[Finding]:
    """One finding for each name of a link or joint that the robot lacks, where no other variant of it can have it."""
    known = {"link": frozenset(model.link_by_name), "joint": model.joint_by_name.keys() | srdf.virtual_joints}
    uses: dict[tuple[str, str], list[_NameUse]] = {}
    for use in _collect_name_uses(srdf):
        if use.kind != "group":
            uses.setdefault((use.kind, use.name), []).append(use)
    missing = {key: found for key, found in uses.items() if key[1] not in known[key[0]]}
    if 2 * len(missing) > len(uses):
        return  # it is for another robot of this name
    surely = is_configured_for(srdf, model.source)
    for index, ((kind, name), found) in enumerate(missing.items()):
        free = known[kind] if index < MAX_HINTS else frozenset[str]()
        if surely:
            near = find_only_near_name(name, free)
        else:
            near = find_only_near_name(
                name, free - {other for of, other in uses if of == kind}, MIN_SIMILARITY_ELSEWHERE
            )
        if (near is None and not surely) or elsewhere.can_package_have(kind, name):
            continue
        attributes = [use.attribute for use in found]
        yield rule.finding(
            kind,
            at=attributes[0],
            related=attributes[1:],
            edits=build_replacement_edits(attributes, near) if near is not None else (),
            where=_describe_element(attributes[0].owner),
            name=name,
            near=format_name_hint(name, free),
        )


def _check_groups(rule: Rule, srdf: Srdf) -> Iterator[Finding]:
    told: set[str] = set()
    for use in _collect_name_uses(srdf):
        if use.kind == "group" and use.name not in srdf.groups:
            known = srdf.groups if len(told) < MAX_HINTS else ()
            told.add(use.name)
            near = find_only_near_name(use.name, known)
            yield rule.finding(
                "group",
                at=use.attribute,
                edits=build_replacement_edits([use.attribute], near) if near is not None else (),
                where=_describe_element(use.attribute.owner),
                name=use.name,
                near=format_name_hint(use.name, known),
            )
    inside = {
        name: {e.get("name").strip() for e in group.find_children("group")} & srdf.groups.keys()
        for name, group in srdf.groups.items()
    }
    # As srdfdom does: a group is complete once all groups in it are.
    waiting = {name: set(inner) for name, inner in inside.items()}
    complete = [name for name, inner in inside.items() if not inner]
    holders: dict[str, list[str]] = {}
    for name, inner in inside.items():
        for other in inner:
            holders.setdefault(other, []).append(name)
    while complete:
        done = complete.pop()
        waiting.pop(done)
        for holder in holders.get(done, ()):
            waiting[holder].discard(done)
            if not waiting[holder]:
                complete.append(holder)
    circle = _find_group_cycle(waiting)
    if circle:
        element = next(
            e for e in srdf.groups[circle[0]].find_children("group") if e.get("name").strip() == circle[1 % len(circle)]
        )
        path = " → ".join((*circle[:4], "…") if len(circle) > 5 else (*circle, circle[0]))
        yield rule.finding("cycle", at=element.attributes["name"], path=path)


def _find_group_cycle(waiting: dict[str, set[str]]) -> list[str]:
    """Groups that contain each other in a circle, from the first in the file's order of names."""
    if not waiting:
        return []
    order: dict[str, int] = {}
    name = min(waiting)
    while name not in order:
        order[name] = len(order)
        name = min(waiting[name])
    return list(order)[order[name] :]


def _check_chains(model: Model, rule: Rule, srdf: Srdf) -> Iterator[Finding]:
    for group in srdf.groups.values():
        for chain in group.find_children("chain"):
            ends = chain.attributes.get("base_link"), chain.attributes.get("tip_link")
            if ends[0] is None or ends[1] is None:
                continue
            base, tip = (end.value.strip() for end in ends if end is not None)
            if base not in model.link_by_name or tip not in model.link_by_name:
                continue
            message = _classify_chain_problem(model, base, tip)
            if message is not None:
                swaps = (
                    [*build_replacement_edits([ends[0]], tip), *build_replacement_edits([ends[1]], base)]
                    if message == "chain-reversed"
                    else []
                )
                yield rule.finding(
                    message,
                    at=chain,
                    severity=Severity.WARNING,
                    edits=swaps if len(swaps) == 2 else (),
                    group=group.get("name").strip(),
                    base=base,
                    tip=tip,
                )


def _classify_chain_problem(model: Model, base: str, tip: str) -> str | None:
    if base == tip:
        return "chain-empty"
    return "chain-reversed" if any(joint.parent == tip for joint in model.tree.find_path_to(base)) else None


def _check_virtual_joints(model: Model, rule: Rule, srdf: Srdf) -> Iterator[Finding]:
    """Virtual joints that move the robot but do not carry its root: MoveIt skips them."""
    for joint in srdf.root.find_children("virtual_joint"):
        child = joint.attributes.get("child_link")
        moves = joint.get("type").strip().lower() in {"planar", "floating"}
        if child is None or not moves or child.value.strip() not in model.link_by_name:
            continue
        root = model.tree.order[0]
        if child.value.strip() != root:
            yield rule.finding(
                "virtual-not-root",
                at=child,
                severity=Severity.WARNING,
                edits=build_replacement_edits([child], root),
                joint=joint.get("name"),
                child=child.value.strip(),
                root=root,
            )


def _check_state_joints(model: Model, rule: Rule, srdf: Srdf) -> Iterator[Finding]:
    """Joints of a state that are not in its group: one finding for each state."""
    joints = collect_group_joints(model, srdf)
    for state in srdf.root.find_children("group_state"):
        group = state.get("group").strip()
        if group not in joints:
            continue
        foreign = [
            name
            for element in state.find_children("joint")
            if (name := element.attributes.get("name")) is not None
            and name.value.strip() in model.joint_by_name
            and name.value.strip() not in joints[group]
        ]
        if foreign:
            yield rule.finding(
                "state-foreign",
                at=foreign[0],
                related=foreign[1:],
                severity=Severity.WARNING,
                state=state.get("name"),
                group=group,
                joints=", ".join(name.value.strip() for name in foreign[:6]),
            )


def _describe_element(element: Element) -> str:
    """``group arm``, ``state home``: what of the description names something."""
    words = {"group_state": "state", "end_effector": "end effector", "virtual_joint": "virtual joint"}
    named = element if element.tag in words or element.parent is None else element.parent
    if element.tag == "passive_joint":
        return "a passive_joint"
    return f"{words.get(named.tag, named.tag)} {named.get('name')}"
