"""DYN002 reports joints whose effort limit is too small to hold what they carry."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.drop_test import GRAVITY
from urdfcheck.core.merging import build_group_finding
from urdfcheck.core.text import join_names
from urdfcheck.facts.inertials.hull_bounds import measure_extent, measure_hull_distance
from urdfcheck.facts.inertials.placeholders import is_round
from urdfcheck.model import Joint, Link, Model
from urdfcheck.model.inertials.inertial_hull import enclosed_inertials
from urdfcheck.model.motion.buoyancy import find_submersible_name
from urdfcheck.model.motion.joint_loads import Overload, find_overloads, list_carried_links
from urdfcheck.model.motion.rotors import carries_rotors
from urdfcheck.model.parts import has_drawn_shape
from urdfcheck.model.shapes.bounds import compute_bounding_box
from urdfcheck.source.text.values import parse_number, read_attribute_number
from urdfcheck.source.text.xml import COMMENT

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array

# An effort that this many joints or more have, and all that have one, does not come from their drives.
_PLACEHOLDER_JOINTS = 3
# A mass that so many links have is a placeholder.
_PLACEHOLDER_LINKS = 4
# What exporters write where the field of their dialog was empty.
_EXPORTED_EFFORT = 1.0
# kg/m³: no link is denser than a block of steel as large as its bounding box.
_MAX_BOX_DENSITY = 7900.0
# A COM is outside its part beyond this share of the part's size, as for INR006; then the torque is not known if the way back into
# the parts may change it by more than this share.
_OUTSIDE, _MISPLACED_SHARE = 0.1, 0.1
# The share of the mass behind a joint whose links are drawn that says enough about all of it.
_KNOWN_SHARE = 0.9
# The most poses, as a share, in which a documented limit may be too small for the robot: chosen.
_MOST_POSES = 0.5
_EFFORT_WITH_UNIT = re.compile(r"(?<![\w.])(\d+(?:\.\d+)?)\s*(?:Nm?|N[·.*]m)\b")


def check(model: Model, rule: Rule, *, rare: float, far: float, buoyant: float) -> Iterator[Finding]:
    groups: dict[tuple[float, bool], list[Overload]] = {}
    for load in find_overloads(model):
        if (
            _is_held_by_friction(load)
            or _is_load_of_misplaced_coms(model, load)
            or _is_load_of_placeholders(model, load)
            or _is_load_of_heavier_side(model, load)
        ):
            continue
        effort = load.joint.get_limit_value("effort") or 0.0
        is_exported = _is_placeholder(model, effort) and effort == _EXPORTED_EFFORT
        groups.setdefault((effort, load.joint.type == "prismatic" and not is_exported), []).append(load)
    # Joints with the same effort limit are one finding: it was written for all of them.
    for (effort, _), loads in groups.items():
        # Equal arms stay in the file's order, whatever their last digits.
        worst_first = sorted(loads, key=lambda load: -float(f"{load.torque:.3g}"))
        times = worst_first[0].torque / effort
        afloat = find_submersible_name(model) if times < buoyant else None
        is_placeholder = (
            _is_placeholder(model, effort)
            and (times > far or effort == _EXPORTED_EFFORT)
            and not _is_load_of_impossible_masses(model, worst_first[0])
        )
        message = "placeholder" if is_placeholder else "weak" if times <= far else "far"
        most = max(load.count for load in loads)
        # A robot that cannot hold half of its poses may have wrong masses, whatever its limits.
        if (
            message == "weak"
            and most < _MOST_POSES * model.samples
            and all(_is_documented(model, one) for one in loads)
        ):
            message = "documented"
        # Only the thrust, which no file states, says what is left for the motors of an arm that propellers hold.
        is_held = message == "weak" and all(carries_rotors(model, one.joint) for one in loads)
        is_of_mass = message == "weak" and _is_load_of_impossible_masses(model, worst_first[0])
        is_minor = is_held or is_of_mass or afloat is not None or message == "documented" or most < rare * model.samples
        yield _build_overload_finding(
            model,
            rule,
            message if afloat is None else "afloat",
            severity=Severity.INFO if is_minor else None,
            effort=effort,
            loads=worst_first,
            afloat=afloat,
        )


def _are_masses_plausible(model: Model, joint: Joint) -> bool:
    """Whether what a joint carries is drawn, and no heavier than steel: then its masses and COMs do not explain the load."""
    known = total = 0.0
    for name in list_carried_links(model, joint):
        link = model.link_by_name[name]
        inertial = link.inertial
        if inertial is None or not inertial.mass:
            continue
        total += inertial.mass
        box = _measure_box(model, link)
        if box is None or inertial.origin.xyz is None:
            continue
        if _is_denser_than_steel(inertial.mass, box):
            return False
        outside = np.maximum(0.0, np.maximum(box[0] - inertial.origin.xyz, inertial.origin.xyz - box[1]))
        if np.linalg.norm(outside) > np.linalg.norm(box[1] - box[0]):
            return False
        known += inertial.mass
    return known >= _KNOWN_SHARE * total > 0.0


def _is_load_of_impossible_masses(model: Model, load: Overload) -> bool:
    """Whether most of the mass that a joint carries is in links denser than steel: then the torque does not judge the limit."""
    dense = 0.0
    for name in list_carried_links(model, load.joint):
        link = model.link_by_name[name]
        mass = 0.0 if link.inertial is None else link.inertial.mass or 0.0
        box = _measure_box(model, link) if mass else None
        dense += mass if box is not None and _is_denser_than_steel(mass, box) else 0.0
    return 2 * dense > _sum_masses(model, load.joint)


def _measure_box(model: Model, link: Link) -> Array | None:
    """Return the corners of the box around what is drawn of a link; None where nothing of it is known."""
    return compute_bounding_box(model, [(shape, np.eye(4)) for shape in link.visuals or link.collisions])


def _is_denser_than_steel(mass: float, box: Array) -> bool:
    return mass > _MAX_BOX_DENSITY * float((box[1] - box[0]).prod())


def _is_documented(model: Model, load: Overload) -> bool:
    """Whether a comment in the joint has its effort limit with the unit, as copied from a data sheet: ``270Nm``."""
    span = load.joint.element.span
    file = None if span is None else model.source.files.get(span.file)
    if span is None or file is None:
        return False
    end = file.text.find("</joint", span.start)
    comments = " ".join(COMMENT.findall(file.text, span.start, max(end, span.start)))
    effort = load.joint.get_limit_value("effort")
    return any(parse_number(typed) == effort for typed in _EFFORT_WITH_UNIT.findall(comments))


def _is_held_by_friction(load: Overload) -> bool:
    """Whether the friction of a joint, which simulators apply at rest too, holds what its drive cannot."""
    friction = read_attribute_number(load.joint.element.find_child("dynamics"), "friction") or 0.0
    return friction + (load.joint.get_limit_value("effort") or 0.0) >= load.torque


def _is_load_of_misplaced_coms(model: Model, load: Overload) -> bool:
    """Whether COMs outside their drawn parts, which INR006 reports, may make a good part of what a turning joint holds."""
    if load.joint.type == "prismatic":
        return False
    carried = set(list_carried_links(model, load.joint))
    moment = 0.0
    for part in enclosed_inertials(model):
        if part.link.name not in carried or not has_drawn_shape(part.link):
            continue
        outside = min((measure_hull_distance(points, part.com), measure_extent(points)) for points in part.readings)
        moment += part.mass * outside[0] if outside[0] > _OUTSIDE * outside[1] else 0.0
    return GRAVITY * moment > _MISPLACED_SHARE * load.torque


def _is_load_of_placeholders(model: Model, load: Overload) -> bool:
    """Whether most of the mass that a joint carries is in links that have one round mass, which no scale showed: many of the
    robot's links have it, with one tensor, or all links that the joint carries."""
    links = [model.link_by_name[name] for name in list_carried_links(model, load.joint)]
    carried = Counter(link.inertial.mass for link in links if link.inertial is not None and link.inertial.mass)
    if len(carried) == 1 and carried.total() >= _PLACEHOLDER_LINKS and is_round(*carried):
        return True
    typed = Counter((tensor.inertial.mass, tensor.components) for tensor in model.tensors)
    placeholders = {
        mass for (mass, _), count in typed.items() if count >= _PLACEHOLDER_LINKS and mass and is_round(mass)
    }
    held = sum(mass * count for mass, count in carried.items() if mass in placeholders)
    return 2 * held > sum(mass * count for mass, count in carried.items())


def _is_load_of_heavier_side(model: Model, load: Overload) -> bool:
    """Whether a joint of a robot that floats carries more than half of it: nothing holds the lighter side while it is lifted."""
    floating = [one for one in model.tree.find_path_to(load.joint.parent) if one.type == "floating"]
    if not floating:
        return False
    carried, total = (_sum_masses(model, joint) for joint in (load.joint, floating[-1]))
    return carried > total / 2


def _sum_masses(model: Model, joint: Joint) -> float:
    """Return the mass (kg) of the links behind a joint."""
    links = (model.link_by_name[name] for name in list_carried_links(model, joint))
    return sum(link.inertial.mass or 0.0 for link in links if link.inertial is not None)


def _list_efforts(model: Model) -> list[float]:
    """List the effort limits of all joints that have one."""
    efforts = (joint.get_limit_value("effort") for joint in model.joints)
    return [effort for effort in efforts if effort]


def _is_placeholder(model: Model, effort: float) -> bool:
    """Whether all joints have one effort, and a power of ten, as exporters write it: 1 for any drive."""
    efforts = _list_efforts(model)
    return len(efforts) >= _PLACEHOLDER_JOINTS and set(efforts) == {effort} and f"{effort:e}".startswith("1.000000e")


def _build_overload_finding(
    model: Model,
    rule: Rule,
    message: str,
    *,
    severity: Severity | None,
    effort: float,
    loads: list[Overload],
    afloat: str | None,
) -> Finding:
    worst = loads[0]
    unit = _get_unit(worst)
    others = [f"{load.joint.name} ({load.torque:.3g} {_get_unit(load)})" for load in loads[1:]]
    suspects = (
        ""
        if message != "far" or _are_masses_plausible(model, worst.joint)
        else (f"check the masses and COMs that {worst.joint.name} carries (kg, m); if they are right, ")
    )
    return build_group_finding(
        rule,
        message,
        [load.joint.limit.attributes["effort"] for load in loads if load.joint.limit is not None],
        severity=severity,
        joint=worst.joint.name,
        torque=worst.torque,
        effort=effort,
        times=worst.torque / effort,
        unit=unit,
        count=max(load.count for load in loads),
        samples=model.samples,
        afloat=afloat or "",
        suspects=suspects,
        limited=len(_list_efforts(model)),
        others=f"; the same limit is too small for {join_names(others)}" if others else "",
        passes=_round_up(worst.torque),
        pose=worst.joint_values,
        joints={load.joint.name: {"torque": load.torque, "passes": _round_up(load.torque)} for load in loads},
    )


def _get_unit(load: Overload) -> str:
    return "N" if load.joint.type == "prismatic" else "N·m"


def _round_up(torque: float) -> float:
    """Return the next number with three digits."""
    step = 10.0 ** (math.floor(math.log10(torque)) - 2)
    return float(f"{math.ceil(torque / step) * step:.3g}")
