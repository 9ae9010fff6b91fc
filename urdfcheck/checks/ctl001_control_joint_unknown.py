"""CTL001 reports joints in `<ros2_control>` and `<transmission>` that the robot lacks."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace

from urdfcheck.core import Finding, Location, Rule, Severity
from urdfcheck.core.text import (
    SLIP_LIKENESS,
    compile_names,
    find_nearest_name,
    find_only_near_name,
    format_name_hint,
    join_names,
)
from urdfcheck.model import Model
from urdfcheck.model.gazebo import UNREAD_TRANSMISSIONS, reads_transmissions
from urdfcheck.model.likeness.sibling_robots import package_names
from urdfcheck.model.repairs.edits import edit_value
from urdfcheck.source.text.grammar import UNFILLED
from urdfcheck.source.text.xml import COMMENT, Attribute, Element
from urdfcheck.source.uses_elsewhere import find_other_includers, iter_project_texts

# What becomes of a block whose name the controllers have too: the hardware exports it, and nothing in the robot is called so.
_AGREED = {
    "ros2_control": "refuses the description since 4.13 (Jazzy): joint not found in URDF; older versions run, but RViz shows the "
    "joint standing still"
}
# What becomes of a transmission that has a type only as an attribute, as the PR2's programs read it, and what it lacks.
_SKIPPED = {"gazebo": "skips the transmission before it looks for the joint: it has no <type>"}
_LACK = "; for gazebo_ros_control add a <type> too: it skips a transmission without one"
# What is said of a joint that is commented out, so that nothing else may be meant.
_COMMENTED = "; a joint of this name is commented out"
_RESTORE = "restore the joint from the comment, or comment this out too"
# What the lines of each kind of block are called.
_ENTRIES = {"ros2_control": "entries", "transmission": "transmissions"}
# The interfaces of what moves.
_MOTIONS = frozenset({"position", "velocity", "acceleration", "effort"})
# Files that name the joints of a robot for controllers.
_CONTROLLER_SUFFIXES = frozenset({".yaml", ".yml"})


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    if not model.links and not model.joints:
        return  # the block alone, as a test expands it
    for tag in ("ros2_control", "transmission"):
        is_unread = tag == "transmission" and not reads_transmissions(model)
        told = (Severity.WARNING, UNREAD_TRANSMISSIONS) if is_unread else (None, None)
        foreign: list[Attribute] = []
        devices: list[Attribute] = []
        skipped: list[bool] = []
        taken: set[str] = set()
        free = model.joint_by_name.keys() - _collect_named_joints(model, tag)
        for block in model.robot.find_children(tag):
            is_skipped = tag == "transmission" and not is_unread and not _has_type(block)
            severity, consequences = (Severity.WARNING, _SKIPPED) if is_skipped else told
            for element in block.walk():
                name = element.attributes.get("name")
                if element.tag != "joint" or name is None or not name.value or name.value in model.joint_by_name:
                    continue
                is_commented = _is_commented_out(model, name.value)
                hint = _COMMENTED if is_commented else format_name_hint(name.value, free)
                if not hint and _is_device(element):
                    devices.append(name)
                    continue
                if not hint:
                    foreign.append(name)
                    skipped.append(is_skipped)
                    continue
                meant = None if is_commented else find_only_near_name(name.value, free, SLIP_LIKENESS)
                taken |= {meant or ""}
                others = _find_other_robots(model, name)
                sharing = _list_sharing_files(model, name, meant)
                yield rule.finding(
                    tag,
                    at=name,
                    severity=severity,
                    related=name.collect_definitions(),
                    edits=edit_value(name, meant) if meant is not None and not others and not sharing else (),
                    consequences=_AGREED if sharing and tag == "ros2_control" else consequences,
                    joint=name.value,
                    block=block.get("name"),
                    near=hint,
                    also=f"; {join_names(sharing)} {'names' if len(sharing) == 1 else 'name'} it too"
                    if sharing
                    else "",
                    repair=(is_commented and _RESTORE)
                    or _describe_agreement(name.value, meant, sharing)
                    or _describe_call(name, meant or find_nearest_name(name.value, free), tag)
                    or f"write a joint of the robot{hint} instead of "
                    f"{name.value!r}, or delete the {'transmission' if tag == 'transmission' else 'entry'}",
                    shared=f"; {join_names(others)} {'includes' if len(others) == 1 else 'include'} this file too"
                    if others
                    else "",
                    lack=_LACK if is_skipped else "",
                )
        if devices:
            yield _build_joined_finding(rule, "ros2_control-device", devices, Severity.WARNING)
        if foreign and tag == "ros2_control" and not model.joints:
            yield _build_joined_finding(rule, "ros2_control-lone", foreign, Severity.INFO)
        elif foreign:
            severity, consequences = (Severity.WARNING, _SKIPPED) if all(skipped) else told
            left = [joint.name for joint in model.joints if joint.is_movable and joint.name in free - taken]
            yield _build_foreign_finding(model, rule, tag, foreign, left, severity=severity, consequences=consequences)


def _is_commented_out(model: Model, name: str) -> bool:
    """Whether a joint of this name is in a comment of the model's files: no other joint is meant."""
    typed = re.compile(
        rf"""(?:<|\A\s*)joint\b[^<>]{{0,1000}}?\bname\s*=\s*["']{re.escape(name)}["'][^<>]{{0,1000}}?\btype\b"""
    )
    return any(typed.search(comment) for file in model.source.files.values() for comment in COMMENT.findall(file.text))


def _has_type(block: Element) -> bool:
    """Whether a transmission has a ``<type>``, which gazebo_ros_control reads first."""
    return any(child.text.strip() for child in block.find_children("type"))


def _is_device(joint: Element) -> bool:
    """Whether an entry of ros2_control has interfaces, and none of a joint: it is a fan, a light or the like."""
    kinds = {child.get("name").removesuffix("_pid") for child in joint.children if child.tag.endswith("_interface")}
    return bool(kinds) and kinds.isdisjoint(_MOTIONS)


def _find_other_robots(model: Model, name: Attribute) -> list[str]:
    """List the other files that include the one with a name: there it may be right."""
    span, via = name.span, name.location.via
    return find_other_includers(model.source, span.file) if span is not None and via else []


def _find_robots_around(model: Model, name: Attribute) -> list[str]:
    """List the other files that include the one with a name, or the nearest of those that call it which others include too."""
    files = [name.span, *reversed(name.location.via)] if name.location.via else []
    names = dict.fromkeys(span.file for span in files if span is not None)
    return next(filter(None, (find_other_includers(model.source, file) for file in names)), [])


def _find_whole_robots(model: Model, names: list[str]) -> list[str]:
    """List the files that include the model, where other files of the package can have joints of these names, and no launch file
    or other text of it names the model: what is checked then is a part."""
    if not all(package_names(model).can_others_have("joint", name) for name in names):
        return []
    own = compile_names((model.source.path.name,))
    if any(own.search(text) for _, text in iter_project_texts(model.source)):
        return []
    from urdfcheck.model.likeness.whole_models import list_including_robots  # loaded only for such a file

    return sorted(path.name for path in list_including_robots(model))


def _list_sharing_files(model: Model, name: Attribute, meant: str | None) -> list[str]:
    """List the controllers and other files that have an unknown name too, and not the joint that it resembles: there the joint is
    the odd one."""
    if meant is None:
        return []
    file = None if name.span is None else model.source.files.get(name.span.file)
    here = {one.path.absolute() for one in (model.source.files.values())}
    word, other = (compile_names((text,)) for text in (name.value, meant))
    found = dict.fromkeys(
        path.name
        for path, text in iter_project_texts(model.source, None if file is None else file.path)
        if path.suffix in _CONTROLLER_SUFFIXES and path.absolute() not in here
        if word.search(text) and not other.search(text)
    )
    return sorted(found)


def _describe_call(name: Attribute, near: str | None, tag: str) -> str:
    """Say that a call of a macro gives the wrong part of a name; empty where it gives the whole name, which is written there, and
    where what it gives is in the similar joint's name, so that the macro itself has the slip."""
    handed = next((d for d in name.collect_definitions() if d.kind == "parameter"), None)
    if (
        handed is None
        or near is None
        or not handed.value
        or handed.value in near
        or f"{{{handed.name}}}" not in name.typed
        or name.typed == f"${{{handed.name}}}"
    ):
        return ""
    entry = "transmission" if tag == "transmission" else "entry"
    return (
        f"pass another `{handed.name}` to the macro, of which `{name.typed}` makes {near}; or hand the macro the joint's name in "
        f"another parameter, or delete the {entry}"
    )


def _describe_agreement(name: str, meant: str | None, sharing: list[str]) -> str:
    """Say that names disagree, and which files use which; nothing where no other file has the unknown one."""
    if not sharing:
        return ""
    return (
        f"let the names agree: rename the joint {meant} to {name}, as this block and {join_names(sharing)} name it, "
        f"or write {meant} in all of these"
    )


def _collect_named_joints(model: Model, tag: str) -> set[str]:
    """Return the joints that blocks of a kind name: an unknown name beside them means another one."""
    blocks = model.robot.find_children(tag)
    return {element.get("name") for block in blocks for element in block.walk() if element.tag == "joint"}


def _build_joined_finding(rule: Rule, message: str, names: list[Attribute], severity: Severity) -> Finding:
    """Report names of joints together: those of a description without joints, which a controller manager reads for the hardware
    while another description has the robot; or devices that are listed as joints."""
    places = {name.span: name for name in names}
    typed = list(dict.fromkeys(name.value for name in names))
    finding = rule.finding(
        message,
        at=names[0],
        severity=severity,
        related=list(places.values())[1:],
        joints=join_names(typed),
        which="a joint" if len(typed) == 1 else f"{len(typed)} joints",
        them="it" if len(typed) == 1 else "them",
    )
    return replace(finding, subjects=tuple(dict.fromkeys(name.location.subject for name in names)))


def _build_foreign_finding(
    model: Model,
    rule: Rule,
    tag: str,
    names: list[Attribute],
    left: list[str],
    *,
    severity: Severity | None,
    consequences: Mapping[str, str] | None,
) -> Finding:
    """Report together all names unlike any of the robot's: those of another robot, or of a part that is left out."""
    places = {name.span: name for name in names}
    typed = list(dict.fromkeys(name.value for name in names))
    others = _find_robots_around(model, names[0])
    whole = [] if others else _find_whole_robots(model, typed)
    finding = rule.finding(
        f"{tag}-strange",
        # The numbers of a file that other robots include may be right for them.
        at=Location(names[0].location.subject, names[0].location.via[0]) if others else names[0],
        severity=Severity.INFO if whole else severity,
        consequences=consequences,
        related=[*names[0].collect_definitions(), *list(places.values())[1:]],
        joints=join_names(typed),
        which="a joint" if len(typed) == 1 else f"{len(typed)} joints",
        repair=f"nothing if this file is only loaded through {join_names(whole, 3)}, which may have the joints; otherwise "
        f"move the {_ENTRIES[tag]} there"
        if whole
        else _describe_repair(model, tag, typed, left, others),
        lack=_LACK if consequences is _SKIPPED else "",
    )
    return replace(finding, subjects=tuple(dict.fromkeys(name.location.subject for name in names)))


def _describe_repair(model: Model, tag: str, names: list[str], left: list[str], others: list[str]) -> str:
    """Say what to write for names unlike any of the robot's.

    ``left``: its joints that no block names; ``others``: the other files that include the one with the names.
    """
    unfilled = UNFILLED.search(names[0])
    if unfilled is not None and all(map(UNFILLED.search, names)):
        return f"write ${unfilled[0]} instead of {unfilled[0]} where xacro expands the file; otherwise fill the template in"
    entries = _ENTRIES[tag]
    respelled = _list_respelled(names, model.joint_by_name)
    blocks = _list_blocks_with(model, tag, respelled)
    if blocks:
        pairs = join_names((f"{joint!r} to {name!r}" for name, joint in zip(names, respelled, strict=True)), 3)
        return (
            f"let the names agree: rename the joints in the robot and in {tag} {join_names(blocks, 3)} ({pairs}); or delete "
            f"the {entries} here"
        )
    meant = respelled or _pair_shortened_names(names, left)
    if others and not meant:
        return (
            f"leave out these {entries} here, or make their names arguments; they may be right for {join_names(others)}"
        )
    if meant:
        return f"write {join_names(meant)} for {join_names(names)}"
    # Without a joint that is left, no name of the robot can be written.
    return (
        f"write the joints of this robot, or delete the {entries}"
        if left
        else f"delete the {entries}, or move them to the part that has these joints"
    )


def _list_respelled(names: list[str], joints: Collection[str]) -> list[str]:
    """Return for each name the only joint that differs from it in nothing but blanks, marks between words and case; nothing if
    one has none."""
    found = [[joint for joint in joints if _squeeze(joint) == _squeeze(name)] for name in names]
    return [same[0] for same in found if len(same) == 1] if all(len(same) == 1 for same in found) else []


def _list_blocks_with(model: Model, tag: str, joints: Collection[str]) -> list[str]:
    """List the names of the blocks of a kind that name one of these joints."""
    blocks = model.robot.find_children(tag)
    return [b.get("name") for b in blocks if any(e.tag == "joint" and e.get("name") in joints for e in b.walk())]


def _squeeze(name: str) -> str:
    return re.sub(r"[\W_]+", "", name).lower()


def _pair_shortened_names(names: list[str], left: list[str]) -> list[str]:
    """Return for each name the only joint left of which it is a short form, as FLK is of FL_KFE; nothing if one has none."""
    pairs = [[joint for joint in left if _is_shortened(name, joint)] for name in names]
    found = [joints[0] for joints in pairs if len(joints) == 1]
    return found if len({*found}) == len(names) == len(left) else []


def _is_shortened(short: str, name: str) -> bool:
    """Whether the letters of a name are in another one, in their order."""
    letters = iter(name.lower())
    return all(letter in letters for letter in short.lower())
