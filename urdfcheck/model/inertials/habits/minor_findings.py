"""Findings about inertials that are worth a note on request: of links whose mass is lost in the rounding of the robot's, so that
whatever they say moves nothing, and of links beside which a comment gives the reason for the numbers."""

from __future__ import annotations

import math
import re
from collections.abc import Container, Iterable, Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core import FactUnavailableError, Finding, Fix, Rule, Severity
from urdfcheck.core.text import join_names
from urdfcheck.facts.inertials.inertia_tensor import compute_parallel_axis_term, compute_solid_inertia
from urdfcheck.model.fact import fact
from urdfcheck.model.inertials.habits.stated_purposes import has_scaled_tensor, has_stated_purpose
from urdfcheck.model.parts import Joint, Link
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.visual_solid import measure_link_geometry
from urdfcheck.model.stated_reasons import has_commented_child

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array

# A robot that was weighed to three digits weighs half a unit of the last one more or less: at least this share of its mass.
LOST_SHARE = 5e-4
# A link counts for what feels it from this share of the mass or of a moment there (chosen: below what the friction of a joint and
# the weight of its cable hide).
_FELT = 0.02
# Axes are parallel within 1°, as a cosine.
_PARALLEL = 1 - 1.5e-4
# A link of a gram (kg) marks a place, wherever its COM is, however it is moved.
_MARK = 1e-3
_LINK = re.compile(r"link\[(.*?)\](?=[/@]|$)", re.DOTALL)
_OF_INERTIAL = re.compile(r"link\[.*\]/inertial\b", re.DOTALL)
_SLIDING, _TURNING = frozenset({"prismatic"}), frozenset({"revolute", "continuous"})


def is_lost(model: Model, link: Link) -> bool:
    """Whether the mass of a link is lost in the rounding of the robot's, and nothing feels the link: neither the joint that moves
    it, about its axis, nor the body of all that this joint moves, or of the base where none does.

    That holds for the numbers that are written and for those of what the link draws, at its mass: the tensor of a light part may
    be so large that it rules its body, and a finger or a wheel that a joint moves by itself is felt, however light it is. A joint
    without room to move, as Gazebo's models have it to keep a sensor apart, moves nothing.
    """
    return link.name in _find_lost_links(model)


def are_absorbed(model: Model, links: Sequence[Link]) -> bool:
    """Whether each of some links is a small part of what moves with it, on the base the whole robot, which has about the same
    moments with the tensors that the links draw at their masses, or has them about all axes about which it can turn. The others
    count with the smaller one of the tensors that are written and drawn: theirs may be as wrong."""
    names = {link.name for link in links}
    try:
        return all(_is_absorbed(model, link, names) or _turns_as_drawn(model, link, names) for link in links)
    except FactUnavailableError:
        return False


def _is_absorbed(model: Model, link: Link, wrong: set[str]) -> bool:
    joint, moved = _find_moved_links(model, link.name)
    numbers = _list_numbers(model, link)
    if len(numbers) != 2:
        return False  # nothing is drawn, or nothing can be read
    if joint is None:  # the wheels of a base turn with it
        moved = [one.name for one in model.links]
    rest = _list_least(model, moved, wrong, numbers[1])
    whole = _add_up(rest)
    written, drawn = (own for _, _, own in numbers)  # where the COM is, is another matter
    share = 1.0 / len(wrong & set(moved))
    if not _is_small((written - drawn) / share, whole):
        return False
    is_turned = joint is not None and joint.type in _TURNING
    return joint is None or not (is_turned and _is_felt_about(model, joint, [numbers[0]], rest, share))


def _turns_as_drawn(model: Model, link: Link, wrong: set[str]) -> bool:
    """Whether a link is fixed to what a joint turns, which has about the same moment about its axis with the tensor that the link
    draws: a toe at the end of a leg adds what its mass does at that distance.

    Joints before it whose axes have another direction turn the link about other axes, and so does a base that moves: what they
    turn has about the same moments about any axis.
    """
    numbers, (joint, moved) = _list_numbers(model, link), _find_moved_links(model, link.name)
    if len(numbers) != 2 or joint is None or joint.type not in _TURNING or joint.child == link.name:
        return False
    change = numbers[0][2] - numbers[1][2]
    first = _place_axis(model, joint)
    while joint is not None:
        rest = _list_least(model, moved, wrong, numbers[1])
        share = 1.0 / len(wrong & set(moved))
        place, axis = _place_axis(model, joint)
        is_parallel = joint.type in _TURNING and abs(float(axis @ first[1])) > _PARALLEL
        if is_parallel and not abs(float(axis @ change @ axis)) < share * _FELT * _compute_moment(rest, place, axis):
            return False
        if not is_parallel and joint.type not in _SLIDING and not _is_small(change / share, _add_up(rest)):
            return False
        joint, moved = _find_moved_links(model, joint.parent)
    everything = [one.name for one in model.links]
    rest, share = _list_least(model, everything, wrong, numbers[1]), 1.0 / len(wrong)
    return _is_small(change / share, _add_up(rest))


def compute_turned_share(model: Model, links: Sequence[Link]) -> float:
    """Compute the largest share by which the tensors of some links change what a joint turns about its axis, compared with those
    that the links draw at their masses. Infinite where it is not known, or no joint turns one of them."""
    wrong, shares = {link.name for link in links}, []
    try:
        for link in links:
            numbers, own = _list_numbers(model, link), []
            joint, moved = _find_moved_links(model, link.name)
            while joint is not None and len(numbers) == 2:
                if joint.type in _TURNING:
                    place, axis = _place_axis(model, joint)
                    rest = _compute_moment(_list_least(model, moved, wrong, numbers[1]), place, axis)
                    change = abs(float(axis @ (numbers[0][2] - numbers[1][2]) @ axis))
                    own.append(len(wrong & set(moved)) * change / max(rest, 1e-300))
                joint, moved = _find_moved_links(model, joint.parent)
            shares.append(max(own, default=math.inf))
    except FactUnavailableError:
        return math.inf
    return max(shares, default=math.inf)


def _list_least(
    model: Model, names: Sequence[str], wrong: set[str], own: tuple[float, Array, Array]
) -> list[tuple[float, Array, Array]]:
    """List the ``own`` numbers, and those of some links but the ``wrong`` ones: the smaller of what is written and drawn."""
    others = [_list_numbers(model, model.link_by_name[name]) for name in names if name not in wrong]
    return [own, *(min(some, key=_get_size) for some in others if np.isfinite(some[0][2]).all())]


def _add_up(parts: Sequence[tuple[float, Array, Array]]) -> Array:
    """Return the tensor (3, 3) of several bodies about their common COM."""
    total = sum(mass for mass, _, _ in parts)
    com = sum((mass * place for mass, place, _ in parts), np.zeros(3)) / total
    return sum((own + compute_parallel_axis_term(mass, at - com) for mass, at, own in parts), np.zeros((3, 3)))


def _get_size(numbers: tuple[float, Array, Array]) -> float:
    return float(np.trace(numbers[2]))


def is_mark(model: Model, link: Link) -> bool:
    """Whether a link weighs a gram or less, and its mass is lost in the rounding of the robot's: then it only marks a place."""
    return 0.0 < _get_mass(link) <= min(_MARK, LOST_SHARE * _compute_robot_mass(model))


def set_lost_aside(
    model: Model, rule: Rule, findings: Iterable[Finding], *, is_about_com: bool = False
) -> Iterator[Finding]:
    """Make notes of the findings that are about links with a lost mass alone, with the message ``lost`` of the rule's page.

    ``is_about_com``: they are about places of COMs, which make no difference for a mark that moves by itself either.
    """
    for finding in findings:
        links = _list_links(model, finding)
        if links and all(is_lost(model, link) or (is_about_com and is_mark(model, link)) for link in links):
            heaviest = max(links, key=_get_mass)
            yield _make_note(
                rule,
                finding,
                "lost",
                lost_mass=_get_mass(heaviest),
                robot_mass=_compute_robot_mass(model),
                lost_links=join_names([link.name for link in links]),
            )
        else:
            yield finding


def set_chosen_aside(
    model: Model,
    rule: Rule,
    findings: Iterable[Finding],
    causes: Container[str] = (),
    *,
    by_replaced: bool = False,
    by_scaled: bool = False,
) -> Iterator[Finding]:
    """Make notes of the findings about links beside whose numbers a comment gives the reason, with the message ``chosen``.

    ``causes``: those of mistakes that no reason excuses; ``by_replaced``: a comment that holds another tensor, which the author
    replaced, is one too; ``by_scaled``: so is the name of a factor in the tensor, unless the finding is an error.
    """
    for finding in findings:
        links = [] if finding.cause is not None and finding.cause.id in causes else _list_links(model, finding)
        is_scalable = by_scaled and finding.severity < Severity.ERROR
        if links and all(
            has_stated_purpose(model, link)
            or (is_scalable and has_scaled_tensor(link))
            or (by_replaced and _has_replaced_tensor(model, link))
            for link in links
        ):
            yield _make_note(rule, finding, "chosen")
        else:
            yield finding


def _has_replaced_tensor(model: Model, link: Link) -> bool:
    return link.inertial is not None and has_commented_child(model, link.inertial.element, "inertia")


def _list_links(model: Model, finding: Finding) -> list[Link]:
    """List the links whose inertials a finding is about; empty where it is about anything else, too, such as a drawing."""
    if not all(map(_OF_INERTIAL.match, finding.subjects)):
        return []
    others = [place.subject for place in finding.related if _OF_INERTIAL.match(place.subject)]
    names = [_LINK.match(subject) for subject in (*finding.subjects, *others, *finding.data.get("between", ()))]
    if not all(names):
        return []
    found = [model.link_by_name.get(name[1]) for name in names if name is not None]
    return [] if None in found else [link for link in dict.fromkeys(found) if link is not None]


def _make_note(rule: Rule, finding: Finding, message: str, **numbers: object) -> Finding:
    remedy = "" if finding.fix is None else finding.fix.title
    data = {"told": finding.headline, "evidence": finding.message, "remedy": remedy, **numbers}
    title = rule.fixes[message].format_map(data)
    return replace(
        finding,
        message_id=message,
        severity=Severity.INFO,
        headline=rule.headlines[message].format_map(data),
        message=rule.messages[message].format_map(data),
        consequences=dict.fromkeys(finding.consequences, "loads it") if message == "lost" else finding.consequences,
        data={**finding.data, **data},
        fix=Fix(title) if finding.fix is None else replace(finding.fix, title=title),
    )


def _get_mass(link: Link) -> float:
    return 0.0 if link.inertial is None else link.inertial.mass or 0.0


@fact
def _compute_robot_mass(model: Model) -> float:
    """Compute the mass (kg) of a robot, without masses below zero."""
    return float(sum(max(declared.mass, 0.0) for declared in model.masses))


@fact
def _find_lost_links(model: Model) -> frozenset[str]:
    most = LOST_SHARE * _compute_robot_mass(model)
    light = [link for link in model.links if 0.0 < _get_mass(link) <= most]
    if not light:
        return frozenset()
    try:
        names = {link.name for link in light}
        return frozenset(link.name for link in light if not _is_felt(model, link, light=names))
    except FactUnavailableError:
        return frozenset()


def _is_felt(model: Model, link: Link, *, light: set[str]) -> bool:
    """Whether a link counts for what it moves with; the other ``light`` links do not count, for their tensors may be as wrong."""
    joint, moved = _find_moved_links(model, link.name)
    rest = [numbers for name in moved if name not in light and (numbers := _place_inertial(model, name)) is not None]
    total = sum(mass for mass, _, _ in rest)
    if not total > 0.0:
        return True
    com = sum((mass * place for mass, place, _ in rest), np.zeros(3)) / total
    whole = sum((own + compute_parallel_axis_term(mass, at - com) for mass, at, own in rest), np.zeros((3, 3)))
    for mass, place, own in _list_numbers(model, link):
        part = own + compute_parallel_axis_term(mass, place - com)
        if mass >= _FELT * total or not _is_small(part, whole):
            return True
        if joint is not None and joint.type in _TURNING and _is_felt_about(model, joint, [(mass, place, own)], rest):
            return True
    return False


def _is_small(part: Array, whole: Array) -> bool:
    """Whether a tensor adds less than its share to the moment of the ``whole`` about any axis."""
    moments, axes = np.linalg.eigh(whole)
    if not moments[0] > 0.0:
        return False
    white = axes / np.sqrt(moments) @ axes.T
    shares = white @ part @ white
    # A malformed inertial counts as infinitely large.
    return bool(np.isfinite(shares).all()) and bool(np.abs(np.linalg.eigvalsh(shares)).max() < _FELT)


def _is_felt_about(
    model: Model,
    joint: Joint,
    part: list[tuple[float, Array, Array]],
    rest: list[tuple[float, Array, Array]],
    share: float = 1.0,
) -> bool:
    """Whether a part has its share of the moment about the axis of a joint; ``share``: of what it may have there."""
    place, axis = _place_axis(model, joint)
    return not _compute_moment(part, place, axis) < share * _FELT * _compute_moment(rest, place, axis)


def _place_axis(model: Model, joint: Joint) -> tuple[Array, Array]:
    """Return a point (3,) on the axis of a joint, and its direction (3,), which is zero for an axis of zeros."""
    frame = model.piece_frames[joint.child]
    axis = frame[:3, :3] @ np.array(joint.axis or (1.0, 0.0, 0.0))
    return frame[:3, 3], axis / max(float(np.linalg.norm(axis)), 1e-300)


def _compute_moment(numbers: Sequence[tuple[float, Array, Array]], place: Array, axis: Array) -> float:
    """Compute the moment of some bodies about an ``axis`` (3,) through a ``place`` (3,)."""
    return sum(float(axis @ (own + compute_parallel_axis_term(mass, at - place)) @ axis) for mass, at, own in numbers)


def _find_moved_links(model: Model, name: str) -> tuple[Joint | None, list[str]]:
    """Find the joint that moves a link, and all links that move with it; of a base all that is fixed to it."""
    pieces = model.pieces
    head, joint = name, pieces.parent_joint.get(name)
    while joint is not None and not joint.has_room:
        head, joint = joint.parent, pieces.parent_joint.get(joint.parent)
    moved, queue = [], [head]
    while queue:
        moved.append(queue.pop())
        queue += [one.child for one in pieces.child_joints[moved[-1]] if joint is not None or not one.has_room]
    return joint, moved


def _place_inertial(model: Model, name: str) -> tuple[float, Array, Array] | None:
    """Return mass (kg), COM (3,) and tensor (3, 3) of a link in the axes of the root; None without them."""
    inertial, frame = model.link_by_name[name].inertial, model.piece_frames[name]
    if inertial is None or inertial.mass is None or not inertial.mass > 0.0:
        return None
    matrix, tensor = inertial.origin.matrix, inertial.tensor_in_link
    if matrix is None or tensor is None:
        return None
    turn = frame[:3, :3]
    return inertial.mass, turn @ matrix[:3, 3] + frame[:3, 3], turn @ tensor @ turn.T


def _list_numbers(model: Model, link: Link) -> list[tuple[float, Array, Array]]:
    """List what a link may be: as it is written, and as it is drawn, at its mass. A malformed inertial is infinitely large."""
    written, drawn = _place_inertial(model, link.name), measure_link_geometry(model, link)
    if written is None:
        return [(_get_mass(link), np.zeros(3), np.full((3, 3), np.inf))]
    if drawn is None:
        return [written]
    frame, mass = model.piece_frames[link.name], written[0]
    turn = frame[:3, :3]
    own = turn @ compute_solid_inertia(drawn.solid, mass) @ turn.T
    return [written, (mass, turn @ drawn.solid.com + frame[:3, 3], own)]
