"""SRD001 reports names in an SRDF that do not exist, and groups that cannot be built."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from collections.abc import Set as AbstractSet

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import find_only_near_name, format_name_hint, join_names
from urdfcheck.model import Model
from urdfcheck.model.likeness.sibling_robots import PackageNames, package_names
from urdfcheck.model.motion.planning_limits import collect_group_joints
from urdfcheck.model.motion.semantic_descriptions import semantic_descriptions
from urdfcheck.model.repairs.edits import edit_literals
from urdfcheck.source.package.finder import format_path
from urdfcheck.source.ros.srdf import (
    Srdf,
    find_original_model,
    has_derived_model,
    is_about_model,
    is_configured_for,
    is_set_up_for_another,
)
from urdfcheck.source.text.tokens import build_replacement_edits
from urdfcheck.source.text.xml import Attribute, Element
from urdfcheck.source.uses_elsewhere import iter_project_texts
from urdfcheck.system.files import read_text_or_nothing

# In a description that may be for a variant of the robot, a name this similar to an unused one is a misspelling of it. Left and
# right fingers have a similarity of 0.79.
MIN_SIMILARITY_ELSEWHERE = 0.85
# Each suggestion compares all names.
MAX_HINTS = 100
# What Pinocchio calls the joint of a floating base: it reads the pose of the base from the states of an SRDF.
_FREE_FLYER = "root_joint"
# A position and a quaternion.
_VALUES_OF_POSE = 7
# The attributes that name groups, by element and the element around it.
_GROUPS = {
    ("group", "group"): ("name",),
    ("group_state", "robot"): ("group",),
    ("end_effector", "robot"): ("group", "parent_group"),
}


@dataclass(frozen=True, slots=True, eq=False)
class _NameUse:
    """An attribute that names a part of the robot or a group."""

    kind: str
    """link | joint | group"""
    attribute: Attribute

    @property
    def name(self) -> str:
        return self.attribute.value.strip()


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    elsewhere = package_names(model)
    srdfs: list[Srdf] = []
    for srdf in semantic_descriptions(model):
        if not is_about_model(srdf, model.source):
            continue
        missing = _find_missing_names(model, srdf)
        if missing and _fits_another_robot(model, srdf, missing=missing, elsewhere=elsewhere):
            continue
        srdfs.append(srdf)
        yield from _check_unknown_names(model, rule, srdf=srdf, missing=missing, elsewhere=elsewhere)
        if not missing or not has_derived_model(srdf, model.source):  # else they are reported for the derived model
            yield from _check_unknown_groups(model, rule, srdf)
            yield from _check_group_cycles(rule, srdf)
    for srdf in srdfs:
        yield from _check_chains(model, rule, srdf)
        yield from _check_virtual_joints(model, rule, srdf)
        yield from _check_state_joints(model, rule, srdf, unknown=_find_partly_unknown_groups(model, srdf))


def _iter_group_uses(srdf: Srdf) -> Iterator[_NameUse]:
    for element in srdf.root.walk():
        around = element.parent.tag if element.parent is not None else ""
        for name in _GROUPS.get((element.tag, around), ()):
            attribute = element.attributes.get(name)
            if attribute is not None and attribute.value.strip():
                yield _NameUse("group", attribute)


# The uses of each name, by its kind (link or joint) and itself.
_Uses = dict[tuple[str, str], list[_NameUse]]


def _collect_uses_by_name(srdf: Srdf) -> _Uses:
    uses: _Uses = {}
    for kind, attribute in srdf.iter_part_names():
        use = _NameUse(kind, attribute)
        if use.name == _FREE_FLYER and len(attribute.owner.get("value").split()) > 1:
            continue  # several values: a pose, not the angle of a joint
        uses.setdefault((kind, use.name), []).append(use)
    return uses


def _list_names_beside(uses: Sequence[_NameUse]) -> set[str]:
    """Return the names in the same groups and states: none of them is meant by another name there."""
    around = [use.attribute.owner.parent for use in uses]
    beside = [
        element for parent in around if parent is not None and parent.tag != "robot" for element in parent.children
    ]
    return {element.get("name").strip() for element in beside} - {use.name for use in uses}


def _find_missing_names(model: Model, srdf: Srdf) -> _Uses:
    """Return the links and joints that a description names and the robot lacks."""
    known = {"link": model.link_by_name.keys(), "joint": model.joint_by_name.keys() | srdf.virtual_joints}
    return {key: like for key, like in _collect_uses_by_name(srdf).items() if key[1] not in known[key[0]]}


def _fits_another_robot(model: Model, srdf: Srdf, *, missing: _Uses, elsewhere: PackageNames) -> bool:
    """Whether a description that does not fit the model is for another robot of this name.

    That is: for the file that the Setup Assistant noted, for a robot of its own package, or for one of the model's package.
    """
    if is_set_up_for_another(srdf, model.source):
        return True
    is_mostly_unknown = 2 * len(missing) > len(_collect_uses_by_name(srdf))
    if has_derived_model(srdf, model.source):
        return is_mostly_unknown
    return all(elsewhere.can_package_have(kind, name) for kind, name in missing)


def _check_unknown_names(
    model: Model, rule: Rule, *, srdf: Srdf, missing: _Uses, elsewhere: PackageNames
) -> Iterator[Finding]:
    """Report each name of a link or joint that the robot and its other variants lack."""
    known = {"link": frozenset(model.link_by_name), "joint": model.joint_by_name.keys() | srdf.virtual_joints}
    uses = _collect_uses_by_name(srdf)
    if 2 * len(missing) > len(uses):
        return  # it is for another robot of this name
    is_certain = is_configured_for(srdf, model.source)
    original = find_original_model(srdf, model.source)
    text = "" if original is None else read_text_or_nothing(original)
    for index, ((kind, name), like) in enumerate(missing.items()):
        candidates = known[kind] - _list_names_beside(like) if index < MAX_HINTS else frozenset[str]()
        if is_certain:
            near = find_only_near_name(name, candidates)
        else:
            used = {other for other_kind, other in uses if other_kind == kind}
            near = find_only_near_name(name, candidates - used, MIN_SIMILARITY_ELSEWHERE)
        if (near is None and not is_certain) or elsewhere.can_package_have(kind, name):
            continue
        attributes = [use.attribute for use in like]
        if original is not None and re.search(rf"<{kind}\s[^<>]*name\s*=\s*[\"']{re.escape(name)}[\"']", text):
            yield rule.finding(
                f"{kind}-of-original",
                at=attributes[0],
                related=attributes[1:],
                where=_describe_element(attributes[0].owner),
                name=name,
                copy=model.source.name,
                original=format_path(original),
            )
            continue
        is_pose = kind == "joint" and all(len(a.owner.get("value").split()) == _VALUES_OF_POSE for a in attributes)
        yield rule.finding(
            "joint-of-base" if is_pose else kind,
            at=attributes[0],
            related=attributes[1:],
            edits=build_replacement_edits(attributes, near) if near is not None and not is_pose else (),
            where=_describe_element(attributes[0].owner),
            name=name,
            near=format_name_hint(name, candidates),
            # A slip loses the value of a joint for Pinocchio too.
            severity=Severity.INFO if near is None and not srdf.groups and all(map(_is_in_state, attributes)) else None,
        )


def _is_in_state(attribute: Attribute) -> bool:
    """Whether a name is that of a state's group or joint. A description of states alone is not for MoveIt: Pinocchio reads their
    joints, and no group."""
    owner = attribute.owner
    return "group_state" in {owner.tag, owner.parent.tag if owner.parent is not None else ""}


def _is_for_moveit(model: Model, srdf: Srdf) -> bool:
    """Whether a text of the packages of a robot and of a description names MoveIt, or neither is in a package.

    Without it Pinocchio reads the description, which has no groups.
    """
    texts = [text for _, text in iter_project_texts(model.source, srdf.path)]
    return not texts or any("moveit" in text.lower() for text in texts)


def _check_unknown_groups(model: Model, rule: Rule, srdf: Srdf) -> Iterator[Finding]:
    """Report names of groups that the description does not define."""
    reported: set[str] = set()
    severity: Severity | None = None
    for use in _iter_group_uses(srdf):
        if use.name not in srdf.groups:
            known = srdf.groups if len(reported) < MAX_HINTS else ()
            reported.add(use.name)
            if not srdf.groups and _is_in_state(use.attribute):
                yield rule.finding(
                    "no-groups",
                    at=use.attribute,
                    severity=Severity.INFO,
                    where=_describe_element(use.attribute.owner),
                    name=use.name,
                )
                continue
            if len(reported) == 1:
                severity = None if _is_for_moveit(model, srdf) else Severity.WARNING
            near = find_only_near_name(use.name, known)
            yield rule.finding(
                "group",
                at=use.attribute,
                severity=severity,
                edits=build_replacement_edits([use.attribute], near) if near is not None else (),
                where=_describe_element(use.attribute.owner),
                name=use.name,
                near=format_name_hint(use.name, known),
            )


def _check_group_cycles(rule: Rule, srdf: Srdf) -> Iterator[Finding]:
    """Report groups that contain each other in a cycle."""
    cycle = _find_group_cycle(_find_incomplete_groups(srdf))
    if cycle:
        element = next(
            e for e in srdf.groups[cycle[0]].find_children("group") if e.get("name").strip() == cycle[1 % len(cycle)]
        )
        path = " → ".join((*cycle[:4], "…") if len(cycle) > 5 else (*cycle, cycle[0]))
        yield rule.finding("cycle", at=element.attributes["name"], path=path)


def _find_incomplete_groups(srdf: Srdf) -> dict[str, set[str]]:
    """Return the groups that srdfdom never completes, each with the incomplete groups in it.

    srdfdom completes a group once all groups in it are complete.
    """
    waiting = {
        name: {e.get("name").strip() for e in group.find_children("group")} & srdf.groups.keys()
        for name, group in srdf.groups.items()
    }
    complete = [name for name, inner in waiting.items() if not inner]
    holders: dict[str, list[str]] = {}
    for name, inner in waiting.items():
        for other in inner:
            holders.setdefault(other, []).append(name)
    while complete:
        done = complete.pop()
        waiting.pop(done)
        for holder in holders.get(done, ()):
            waiting[holder].discard(done)
            if not waiting[holder]:
                complete.append(holder)
    return waiting


def _find_group_cycle(waiting: dict[str, set[str]]) -> list[str]:
    """Return groups that contain each other in a cycle, from the alphabetically first."""
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
            base_attribute, tip_attribute = chain.attributes.get("base_link"), chain.attributes.get("tip_link")
            if base_attribute is None or tip_attribute is None:
                continue
            base, tip = base_attribute.value.strip(), tip_attribute.value.strip()
            if base not in model.link_by_name or tip not in model.link_by_name:
                continue
            message = _classify_chain_problem(model, base, tip)
            edits = edit_literals(((base_attribute, tip), (tip_attribute, base))) if message == "chain-reversed" else []
            if message is not None:
                yield rule.finding(
                    message,
                    at=chain,
                    severity=Severity.WARNING,
                    edits=edits,
                    group=group.get("name").strip(),
                    base=base,
                    tip=tip,
                )


def _classify_chain_problem(model: Model, base: str, tip: str) -> str | None:
    if base == tip:
        return "chain-empty"
    return "chain-reversed" if any(joint.parent == tip for joint in model.tree.find_path_to(base)) else None


def _check_virtual_joints(model: Model, rule: Rule, srdf: Srdf) -> Iterator[Finding]:
    """Report virtual joints that move the robot but do not carry its root: MoveIt ignores them."""
    for joint in srdf.root.find_children("virtual_joint"):
        child = joint.attributes.get("child_link")
        moves = joint.get("type").strip().lower() in {"planar", "floating"}
        if child is None or not moves or child.value.strip() not in model.link_by_name:
            continue
        root, name = model.tree.order[0], child.value.strip()
        if name == root:
            continue
        moving = join_names(j.name for j in model.tree.find_path_to(name) if j.is_movable)
        is_world = root == joint.get("parent_frame").strip()
        repair, write = "delete the virtual joint, and its name in groups", f'write child_link="{root}"'
        if moving and not is_world:
            repair += f", if the robot is to move by {moving}; otherwise {write}"
        elif not is_world:
            repair = f"{write}, or delete the virtual joint if {name} does not move in the world"
        yield rule.finding(
            "virtual-not-root",
            at=child,
            severity=Severity.WARNING,
            edits=() if moving or is_world else build_replacement_edits([child], root),
            consequences={"moveit": f"ignores the virtual joint: {name} moves by {moving} only"} if moving else None,
            joint=joint.get("name"),
            child=name,
            root=root,
            repair=repair,
        )


def _find_partly_unknown_groups(model: Model, srdf: Srdf) -> set[str]:
    """Return the groups of which a part is unknown, or is a group that is unknown or itself one of these."""
    missing = {use.attribute.span for like in _find_missing_names(model, srdf).values() for use in like}
    partly = {
        name
        for name, group in srdf.groups.items()
        if any(attribute.span in missing for part in group.children for attribute in part.attributes.values())
    }
    inner = {
        name: {part.get("name").strip() for part in group.find_children("group")} for name, group in srdf.groups.items()
    }
    while further := {name for name, parts in inner.items() if parts & partly or parts - inner.keys()} - partly:
        partly |= further
    return partly


def _check_state_joints(model: Model, rule: Rule, srdf: Srdf, *, unknown: AbstractSet[str]) -> Iterator[Finding]:
    """Report the joints of each state that are not in its group, unless what belongs to the group is unknown."""
    joints = collect_group_joints(model, srdf)
    for state in srdf.root.find_children("group_state"):
        group = state.get("group").strip()
        if group not in joints or group in unknown:
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
    """Return ``group arm`` or ``state home`` for the part of a description that names something."""
    words = {"group_state": "state", "end_effector": "end effector", "virtual_joint": "virtual joint"}
    named = element if element.tag in words or element.parent is None else element.parent
    if element.tag == "passive_joint":
        return "a passive_joint"
    return f"{words.get(named.tag, named.tag)} {named.get('name')}"
