"""JNT021 reports joints whose axis, its sign or its place contradicts the parts on both sides, or leaves them apart."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import format_length, format_point, join_names
from urdfcheck.model import Joint, Model
from urdfcheck.model.motion.axes.apart import do_collisions_touch
from urdfcheck.model.motion.axes.contradicted import find_contradicted_axes
from urdfcheck.model.repairs.origin_edits import locate_origin_attribute

if TYPE_CHECKING:
    from urdfcheck.model.motion.axes.apart import ApartPart
    from urdfcheck.model.motion.axes.bearings import BearingMismatch
    from urdfcheck.model.motion.axes.sunken import SunkenSide
    from urdfcheck.model.motion.axes.sweeps import BlockedSide

# A direction counts as a coordinate axis to within half a degree.
_SQUARE = 4e-5
# Of the surface of the child: with more of it inside other parts on the better side too, no axis frees it (chosen).
_MOST_INSIDE = 0.2
# Joints on both sides of y = 0 are twins if their places mirror each other to this distance (m).
_TWIN = 1e-3


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    found = find_contradicted_axes(model)
    mismatches, blocked, apart = found.bearings, found.sides, found.apart
    # One joint is off by mistake. What several joints show is how the robot is drawn.
    if len(mismatches) == 1 and not _is_bearing_drawn(model, mismatches[0]):
        yield _report_bearing(model, rule, mismatches[0])
    nested = {one.joint for one in found.sunken if one.shares[1] > _MOST_INSIDE}
    sunken = [one for one in found.sunken if one.joint not in nested and not _is_side_drawn(model, one.joint)]
    if len(found.sunken) == 1 and sunken:
        yield _report_sunken(model, rule, sunken[0])
    elif len(blocked) == 1 and blocked[0].joint not in nested and not _is_side_drawn(model, blocked[0].joint):
        yield _report_side(model, rule, blocked[0])
    if apart is not None and not (do_collisions_touch(model, apart) or _is_drawn_in_two_ways(model, apart.joint)):
        yield _report_apart(model, rule, apart)


def _is_bearing_drawn(model: Model, found: BearingMismatch) -> bool:
    """Whether the parts explain why a bearing is not about the axis: the origin has not slipped."""
    has_twin = found.kind == "beside" and bool(_list_twins(model, found.joint))
    return has_twin or _is_drawn_in_two_ways(model, found.joint)


def _is_side_drawn(model: Model, name: str) -> bool:
    """Whether the parts explain why a joint meets more on the side that its limits open: the axis need not be reversed."""
    return _has_free_twin(model, name) or _is_drawn_in_two_ways(model, name)


def _is_drawn_in_two_ways(model: Model, name: str) -> bool:
    """Whether programs draw a part at a joint in different sizes, or turned."""
    from urdfcheck.model.shapes.visual_solid import has_unit_ambiguity, has_up_axis_ambiguity  # few joints get here

    joint = model.joint_by_name[name]
    links = [link for end in (joint.parent, joint.child) for link in model.tree.list_body_links(end)]
    return has_unit_ambiguity(model, links) or has_up_axis_ambiguity(model, links)


def _has_free_twin(model: Model, name: str) -> bool:
    """Whether the joint on the other side has the same axis and limits: it moves alike, and nothing is in its way."""
    joint = model.joint_by_name[name]
    for other in _list_twins(model, name):
        limits = [(one.get_limit_value("lower"), one.get_limit_value("upper")) for one in (joint, other)]
        if limits[0] == limits[1] and float(model.axes[name] @ model.axes[other.name]) > 0.999:
            return True
    return False


def _list_twins(model: Model, name: str) -> list[Joint]:
    """List the joints of the same type at the mirrored place on the other side of y = 0: none of the two origins has slipped."""
    joint = model.joint_by_name[name]
    place = model.frames[joint.child][:3, 3]
    others = [one for one in model.joints if one.type == joint.type and one.name in model.axes]
    is_aside = abs(place[1]) > _TWIN
    return [
        one for one in others if is_aside and np.abs(model.frames[one.child][:3, 3] - place * (1, -1, 1)).max() < _TWIN
    ]


def _report_bearing(model: Model, rule: Rule, found: BearingMismatch) -> Finding:
    joint = model.joint_by_name[found.joint]
    frame = model.frames[joint.parent if found.kind == "beside" else joint.child]
    local = frame[:3, :3].T @ found.vector
    at = {
        "beside": locate_origin_attribute(joint, "xyz"),
        "tilted": locate_origin_attribute(joint, "rpy"),
        "across": joint.axis_location,
    }
    is_length = found.kind == "beside"
    return rule.finding(
        found.kind,
        at=at[found.kind],
        joint=joint.name,
        child=joint.child,
        parent=joint.parent,
        hub=format_length(found.hub),
        bore=format_length(found.radius),
        distance=format_length(found.amount) if is_length else "",
        angle="" if is_length else f"{found.amount:.3g}°",
        line=format_point(local, decimals=5) if is_length else _format_direction(local),
    )


def _report_side(model: Model, rule: Rule, found: BlockedSide) -> Finding:
    joint = model.joint_by_name[found.joint]
    kinds = [joint.parent] if found.by_parent else []
    kinds += [found.by_others] if found.by_others and found.by_others not in kinds else []
    return rule.finding(
        "reversed",
        at=joint.axis_location,
        severity=None if found.by_parent and found.by_others else Severity.INFO,
        related=[joint.location if joint.limit is None else joint.limit.location],
        blocked=" and ".join(kinds),
        **_describe_reversal(joint, found.declared),
    )


def _report_sunken(model: Model, rule: Rule, found: SunkenSide) -> Finding:
    joint = model.joint_by_name[found.joint]
    declared, other = (round(100 * share) for share in found.shares)
    return rule.finding(
        "sunken",
        at=joint.axis_location,
        related=[joint.location if joint.limit is None else joint.limit.location],
        part=found.into[0] if len(found.into) == 1 else "other parts",
        parts=join_names(found.into),
        share=declared,
        other_share=other,
        **_describe_reversal(joint, found.declared),
    )


def _describe_reversal(joint: Joint, declared: float) -> dict[str, Any]:
    """Return what the texts say about a joint with a reversed axis whose declared range ends at ``declared`` (rad)."""
    lower, upper = joint.get_limit_value("lower") or 0.0, joint.get_limit_value("upper") or 0.0
    return {
        "joint": joint.name,
        "child": joint.child,
        "limit": f"{declared:.3g}",
        "other": f"{-declared:.3g}",
        "axis": _format_direction(-np.array(joint.axis, dtype=float)),
        "lower": f"{-upper + 0.0:.6g}",
        "upper": f"{-lower + 0.0:.6g}",
    }


def _report_apart(model: Model, rule: Rule, found: ApartPart) -> Finding:
    joint = model.joint_by_name[found.joint]
    below = (link for link in model.links if joint in model.tree.find_path_to(link.name))
    body = model.tree.list_body_links(joint.child)
    carries = any(link.name not in body and (link.visuals or link.collisions) for link in below)
    return rule.finding(
        "apart",
        at=locate_origin_attribute(joint, "xyz"),
        joint=joint.name,
        child=joint.child,
        moved=f"{joint.child} and all that it carries touch" if carries else f"{joint.child} touches",
        nearest=_name_drawn_link(model, joint, found.nearest),
        gap=format_length(found.gap),
        size=format_length(found.size),
        joints="other joint holds parts" if found.others == 1 else f"{found.others} other joints hold parts",
    )


def _name_drawn_link(model: Model, joint: Joint, head: str) -> str:
    """Name a body by what it draws: the joint's parent, else the first link of it that draws something."""
    links = model.tree.list_body_links(head)
    drawn = [name for name in links if (link := model.link_by_name[name]).visuals or link.collisions]
    return joint.parent if joint.parent in drawn else next(iter(drawn), head)


def _format_direction(vector: np.ndarray) -> str:
    """Write a direction, as a coordinate axis where it is one."""
    unit = vector / math.sqrt(float(vector @ vector))
    largest = int(np.abs(unit).argmax())
    if 1 - abs(float(unit[largest])) < _SQUARE:
        unit = np.sign(unit) * (np.arange(3) == largest)
    return format_point(unit, decimals=4)
