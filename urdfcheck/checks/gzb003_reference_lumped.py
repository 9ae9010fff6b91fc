"""GZB003 reports settings of `<gazebo>` blocks that are lost when Gazebo merges links at fixed joints."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import replace

from urdfcheck.core import Edit, Finding, Rule, Severity
from urdfcheck.core.text import format_count, join_names
from urdfcheck.model import Joint, Model
from urdfcheck.model.fixed_joint_lumping import (
    PRESERVE,
    FixedJointReduction,
    MergedShape,
    find_preserved_names,
    is_false_flag,
    is_merged_joint,
    is_true_flag,
    reduce_fixed_joints,
)
from urdfcheck.model.gazebo import find_kinematic_links, is_held_still
from urdfcheck.model.repairs.edits import edit_value
from urdfcheck.source.text.xml import Element

# The settings that sdformat writes into each collision, and into each visual, of the link that a block names.
_COLLISION = frozenset({
    "mu1", "mu2", "fdir1", "kp", "kd", "minDepth", "maxVel", "maxContacts", "laserRetro", "collision",
})  # fmt: skip
_VISUAL = frozenset({"material", "visual"})
# Those of the link itself.
_BODY = frozenset({"turnGravityOff", "gravity", "selfCollide", "self_collide", "dampingFactor"})
# Stiffness and damping of contacts, which authors take for those of a suspension.
_CONTACT_SPRING = frozenset({"kp", "kd"})
_BLOCK = '<gazebo reference="…">'
_SPRING = "; a spring of the joint is <springStiffness> and <springReference>"
# These still matter when the joint is gone; the rest only sets how a moving joint is solved.
_FUNCTIONAL_TAGS = frozenset({"sensor", "plugin"})


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    reduction, preserved = reduce_fixed_joints(model), find_preserved_names(model)
    blocks = [block for block in model.robot.find_children("gazebo") if block.get("reference")]
    collisions, visuals = _group_unreached_shapes(reduction.collisions), _group_unreached_shapes(reduction.visuals)
    lost: dict[str, list[Element]] = {}
    for block in blocks:
        name = block.get("reference")
        joint = model.joint_by_name.get(name)
        yield from _check_preserve_flag(model, rule, block)
        if name in model.link_by_name:
            yield from _check_surface_settings(model, rule, "collision", block, blocks, shapes=collisions[name])
            yield from _check_surface_settings(model, rule, "visual", block, blocks, shapes=visuals[name])
        elif joint is not None:
            tags = {child.tag for child in block.children}.difference(PRESERVE)
            if tags & (_COLLISION | _VISUAL) and tags <= _COLLISION | _VISUAL | _BODY:
                yield _build_surface_finding(model, rule, block, joint=joint, tags=tags)
            elif tags and is_merged_joint(joint, preserved):
                lost.setdefault(_classify_lost_block(block, tags), []).append(block)
    for message, lost_blocks in lost.items():
        yield _build_lost_finding(model, rule, message, blocks=lost_blocks, reduction=reduction)
    yield from _check_gravity_flags(model, rule, blocks, reduction=reduction)
    yield from _check_dropped_links(model, rule, reduction, preserved=preserved)


def _group_unreached_shapes(shapes: tuple[MergedShape, ...]) -> defaultdict[str, tuple[list[MergedShape], int]]:
    """Return the shapes of each link that the settings of its block do not reach, and the number of all its shapes."""
    groups: defaultdict[str, tuple[list[MergedShape], int]] = defaultdict(lambda: ([], 0))
    for shape in shapes:
        lost, count = groups[shape.link]
        if not shape.is_reached_by(shape.link):
            lost.append(shape)
        groups[shape.link] = lost, count + 1
    return groups


def _classify_lost_block(block: Element, tags: set[str]) -> str:
    """Return the message: kept by keeping the joint is a force-torque sensor only; other sensors and plugins are a link's."""
    if not tags & _FUNCTIONAL_TAGS:
        return "joint-settings"
    kinds = {sensor.get("type").strip() for sensor in block.find_children("sensor")}
    return "joint" if kinds <= {"force_torque"} and "plugin" not in tags else "joint-content"


def _format_tags(tags: list[str]) -> str:
    return join_names(dict.fromkeys(tags))


def _build_lost_finding(
    model: Model, rule: Rule, message: str, *, blocks: list[Element], reduction: FixedJointReduction
) -> Finding:
    """Report together all merged joints with their settings."""
    names = [block.get("reference") for block in blocks]
    joint = model.joint_by_name[names[0]]
    lost = [child.tag for block in blocks for child in block.children if child.tag not in PRESERVE]
    of_links = _format_tags([tag for tag in lost if tag in _COLLISION | _VISUAL | _BODY])
    finding = rule.finding(
        message,
        at=blocks[0].attributes["reference"],
        severity=Severity.INFO if message == "joint-settings" else Severity.WARNING,
        related=[block.attributes["reference"] for block in blocks[1:10]],
        edits=_propose_all_edits(model, blocks) if message == "joint" else (),
        blocks=format_count(len(blocks), "<gazebo> block has", "<gazebo> blocks have"),
        count=format_count(len(blocks), "block"),
        place="this block" if len(blocks) == 1 else "the block of each",
        which="joint" if len(blocks) == 1 else "joints",
        outcome=f"{joint.child} becomes part of {reduction.body_by_link[joint.child]}"
        if len(blocks) == 1
        else "the links below them become parts of other links",
        joints=join_names(dict.fromkeys(names)),
        child=joint.child,
        body=reduction.body_by_link[joint.child],
        content=_format_tags(lost),
        repair=_describe_content_repair(model, blocks),
        meant=f"; {of_links} are for a link: write them in its block" if of_links else "",
    )
    return replace(finding, subjects=tuple(dict.fromkeys(block.subject for block in blocks)))


def _describe_content_repair(model: Model, blocks: list[Element]) -> str:
    """Say where plugins and the sensors of links belong; a force-torque sensor among them stays with the joint."""
    links = join_names(dict.fromkeys(model.joint_by_name[block.get("reference")].child for block in blocks))
    sensors = [sensor for block in blocks for sensor in block.find_children("sensor")]
    if any(sensor.get("type").strip() == "force_torque" for sensor in sensors):
        return (
            "keep the joint for the force_torque sensor (<preserveFixedJoint>true</preserveFixedJoint>; the link below needs "
            f"a mass), and move the rest to the block of the link ({links}), "
            "or for a plugin of the whole robot to one without reference"
        )
    return f"write the name of the link instead: {links}, or no reference for a plugin of the whole robot"


def _build_surface_finding(model: Model, rule: Rule, block: Element, *, joint: Joint, tags: set[str]) -> Finding:
    """Report settings of a link and its shapes in the block of a joint, of whatever type."""
    return rule.finding(
        "surface",
        at=block.attributes["reference"],
        related=[joint],
        severity=Severity.WARNING if _COLLISION & tags else Severity.INFO,
        joint=joint.name,
        repair=_describe_surface_repair(model, joint, tags),
        spring=_SPRING if joint.is_movable and tags <= _CONTACT_SPRING else "",
        content=_format_tags([child.tag for child in block.children if child.tag in tags]),
    )


def _describe_surface_repair(model: Model, joint: Joint, tags: set[str]) -> str:
    """Say where settings of a link belong: the link below the joint, unless it has them, or nothing that they could be for."""
    child = model.link_by_name.get(joint.child)
    if child is None or not (child.collisions if tags & _COLLISION else child.visuals):
        return f"delete the block, or write the name of the link that is meant: {joint.child} has no such shape"
    own = {e.tag for b in model.robot.find_children("gazebo") if b.get("reference") == child.name for e in b.children}
    if tags <= own:
        return f"delete the block: the one of {child.name} has these settings"
    return f"write the name of the link: {child.name}"


def _check_surface_settings(
    model: Model, rule: Rule, role: str, block: Element, blocks: list[Element], *, shapes: tuple[list[MergedShape], int]
) -> Iterator[Finding]:
    """Report settings that do not reach all collisions, or all visuals, of a link."""
    lost, count = shapes
    settings = [
        child
        for child in block.children
        if child.tag in (_COLLISION if role == "collision" else _VISUAL) and not _is_set_by_body(child, blocks, lost)
    ]
    if settings and lost:
        first = lost[0]
        merged = first.body != first.link
        named = not first.name.startswith(f"{first.link}_{role}")
        yield rule.finding(
            "named" if named else "prefix",
            at=settings[0],
            severity=Severity.WARNING if role == "collision" else Severity.INFO,
            related=[shape.element for shape in lost[:10]],
            link=first.link,
            body=first.body,
            content=_format_tags([child.tag for child in settings]),
            role=role,
            name=first.name,
            names=f"the name of the {role}" if len(lost) == 1 else f"the names of its {len(lost)} {role}s",
            users=_describe_users(model, lost),
            some="" if len(lost) == count else f" for {len(lost)} of {count}",
            merged=f" is merged into {first.body} and" if merged else "",
        )


def _describe_users(model: Model, shapes: list[MergedShape]) -> str:
    """Say which sensors name shapes by their names in SDF, which a repair changes."""
    names = {shape.name for shape in shapes}
    users = [
        element
        for block in model.robot.find_children("gazebo")
        for element in block.walk()
        if element.text.strip().rpartition("::")[2] in names
    ]
    if not users:
        return ""
    parents = [_find_named_parent(user) for user in users]
    whose = join_names(dict.fromkeys(f"{one.tag} {one.get('name')}" for one in parents if one is not None))
    return f"; then write the new name of the shape also in the <{users[0].tag}> of {whose}" if whose else ""


def _find_named_parent(element: Element) -> Element | None:
    above = element.parent
    while above is not None and not (above.tag in _FUNCTIONAL_TAGS and above.get("name")):
        above = above.parent
    return above


def _is_set_by_body(setting: Element, blocks: list[Element], shapes: list[MergedShape]) -> bool:
    """Whether the shapes that a setting does not reach get the same value from the blocks of their body: then nothing is lost."""
    values = [
        [
            child.text.split()
            for block in blocks
            if block.get("reference") == shape.body
            for child in block.find_children(setting.tag)
        ]
        if shape.is_reached_by(shape.body)
        else []
        for shape in shapes
    ]
    return not setting.children and all(found and all(v == setting.text.split() for v in found) for found in values)


def _check_gravity_flags(
    model: Model, rule: Rule, blocks: list[Element], *, reduction: FixedJointReduction
) -> Iterator[Finding]:
    """Report gravity switched off for a small part of a body: the whole body loses it."""
    off: dict[str, dict[str, Element]] = {}
    for block in blocks:
        flags = [child for child in block.find_children("turnGravityOff") if is_true_flag(child)]
        body = reduction.body_by_link.get(block.get("reference"))
        if flags and body is not None:
            off.setdefault(body, {}).setdefault(block.get("reference"), flags[0])
    # Gravity moves none of these, with its flag or without.
    unmoved = {reduction.body_by_link.get(name) for name in find_kinematic_links(model.robot)}
    # sdformat overrides this one, but it says that the body is to float.
    floating = {block.get("reference") for block in blocks if any(map(is_false_flag, block.find_children("gravity")))}
    masses: dict[str, float] = {}
    for name, body in reduction.body_by_link.items():
        masses[body] = masses.get(body, 0.0) + _get_mass(model, name)
    for body, flagged in off.items():
        own = sum(_get_mass(model, name) for name in flagged)
        if body in flagged or body in unmoved or body in floating or own >= 0.5 * masses[body]:
            continue
        if not _is_fixed_to_world(model, body) and not is_held_still(model.robot):
            first, *others = flagged.values()
            links = join_names(flagged, 3)
            yield rule.finding("gravity", at=first, related=others, links=links, body=body, own=own, total=masses[body])


def _is_fixed_to_world(model: Model, body: str) -> bool:
    joint = model.tree.parent_joint.get(body)
    return joint is not None and joint.type == "fixed" and joint.parent == "world"


def _get_mass(model: Model, link: str) -> float:
    """Return the mass of a link in kg, 0 if it is missing, malformed or negative."""
    declared = model.mass_by_name.get(link)
    return 0.0 if declared is None or declared.mass < 0 else declared.mass


def _check_preserve_flag(model: Model, rule: Rule, block: Element) -> Iterator[Finding]:
    """Report a request to keep a joint whose subject is not a fixed joint."""
    reference = block.attributes["reference"]
    link, joint = model.link_by_name.get(reference.value), model.joint_by_name.get(reference.value)
    flag = next((child for child in block.children if child.tag in PRESERVE and is_true_flag(child)), None)
    if flag is None or (joint is not None and joint.type == "fixed"):
        return
    if joint is not None:
        yield rule.finding("moving", at=flag, severity=Severity.INFO, flag=flag.tag, joint=joint.name, type=joint.type)
    elif link is not None:
        above = model.tree.parent_joint.get(link.name)
        fixed = above is not None and above.type == "fixed"
        # Kept above a link without a mass, the joint makes sdformat drop the link.
        has_mass = _get_mass(model, link.name) > 0.0
        massless = "" if has_mass else f"; {link.name} needs a mass then"
        alone = fixed and block.children == [flag] and has_mass
        yield rule.finding(
            "link",
            at=reference,
            edits=edit_value(reference, above.name) if above is not None and alone else (),
            flag=flag.tag,
            # Without a fixed joint above, nothing merges the link into another one.
            severity=None if fixed else Severity.INFO,
            link=link.name,
            repair=f"move it to a separate block for joint {above.name}: {_BLOCK}{massless}"
            if above is not None and fixed
            else f"delete it, or move it to a block for the fixed joint that is meant: {_BLOCK}",
        )


def _check_dropped_links(
    model: Model, rule: Rule, reduction: FixedJointReduction, *, preserved: Mapping[str, Element]
) -> Iterator[Finding]:
    """Report preserved joints whose link below has no mass: sdformat drops such a link with everything below it."""
    heavy = {body for name, body in reduction.body_by_link.items() if _get_mass(model, name) > 0.0}
    above: dict[str, Joint] = {}  # the uppermost such joint of each link that is dropped
    hanging: dict[str, int] = {}
    for link in model.tree.order[1:]:
        joint = model.tree.parent_joint[link]
        first = above.get(joint.parent)
        if first is not None:
            hanging[first.name] += 1
        elif joint.type == "fixed" and joint.name in preserved and link not in heavy:
            first = joint
            hanging[joint.name] = 0
        if first is not None:
            above[link] = first
    for name, count in hanging.items():
        yield rule.finding(
            "dropped",
            at=preserved[name],
            related=[model.joint_by_name[name]],
            flag=preserved[name].tag,
            joint=name,
            link=model.joint_by_name[name].child,
            others=f" and {format_count(count, 'link')} below it" if count else "",
        )


def _propose_all_edits(model: Model, blocks: list[Element]) -> list[Edit]:
    """Return the edits that keep all joints; nothing where one of them cannot be kept by an edit."""
    each = [_propose_edits(model, block) for block in blocks]
    return list(dict.fromkeys(edit for edits in each for edit in edits)) if all(each) else []


def _propose_edits(model: Model, block: Element) -> list[Edit]:
    """Return the edit that asks sdformat, first thing in the block, to keep the joint.

    Nothing if its link has no mass: sdformat would drop the link.
    """
    span, joint = block.span, model.joint_by_name[block.get("reference")]
    if span is None or span.file not in model.source.files or _get_mass(model, joint.child) == 0.0:
        return []
    text = model.source.files[span.file].text[span.start : span.end]
    if text.endswith("/>") or "$" in text:
        return []
    return [Edit(span, text, f"{text}\n    <preserveFixedJoint>true</preserveFixedJoint>")]
