"""NAM005 reports links called left that are on the right, and the reverse."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import replace

from urdfcheck.core import Finding, Rule
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import join_names
from urdfcheck.facts.small_matrices import IDENTITY, Matrix, measure_change, rotate, subtract, transpose
from urdfcheck.model import Joint, Model

# The words of a name and the text between them.
_WORDS = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|[^A-Za-z]+")
_RIGHT = {"left": "right", "Left": "Right", "LEFT": "RIGHT"}
# Left with a letter for front, rear, back or the like: fl, rl, lf, lb, bl, lh, hl.
_SHORT_LEFT = re.compile(r"l|[fbrhmFBRHM]?[lL]|[lL][fbrhmFBRHM]")
# Frames are aligned to within this rotation (entries of the matrix).
_ALIGNMENT_TOLERANCE = 1e-3
# What programs do where a swapped part moves; of cameras and other fixed parts, only the images are swapped.
_MOVING = {
    "ros2_control": "moves the joint on the other side than the one that a command names",
    "moveit": "plans for the named part, which is on the other side",
}
# No real name is longer, and each word costs a comparison.
_MAX_NAME_LENGTH = 200


@dataclass(frozen=True, slots=True)
class _LimbPair:
    """The joints that hold a left and a right limb of one body, and the links on the limbs whose names differ in the side."""

    left: Joint
    right: Joint
    named: tuple[str, str]
    offset: float
    """The distance (m) by which the link named left is left of the other in the frame of the body (its y axis points left)."""

    @property
    def moves(self) -> bool:
        return self.left.type != "fixed" or self.right.type != "fixed"


def check(model: Model, rule: Rule, *, least: int, apart: float) -> Iterator[Finding]:
    sides = list(_find_limb_pairs(model, apart))
    usual = [side for side in sides if side.offset > 0]
    odd = [side for side in sides if side.offset < 0]
    if len(usual) < len(odd):
        # The robot's y axis may point to its right. Fixed parts alone do not show that: they may be turned round.
        usual, odd = [side for side in odd if side.moves], usual
    if odd and len(usual) >= least * len(odd):
        joints = [model.tree.parent_joint[name] for side in odd for name in side.named]
        finding = rule.finding(
            "swapped",
            at=joints[0].child_location,
            related=joints[1:10],
            left=odd[0].named[0],
            right=odd[0].named[1],
            offset=abs(odd[0].offset),
            others=join_names(side.named[0] for side in usual),
            count=len(usual),
            consequences=_MOVING if any(_is_driven(model, side) for side in odd) else None,
            more="" if len(odd) == 1 else f" (likewise {join_names(side.named[0] for side in odd[1:])})",
            repair=_describe_repair(model, odd, usual),
        )
        yield replace(finding, subjects=tuple(f"link[{joint.child}]" for joint in joints))


def _describe_repair(model: Model, odd: list[_LimbPair], usual: list[_LimbPair]) -> str:
    """Say what to swap: where the names of the joints agree with the places, only their children are wrong."""
    parents = model.tree.parent_joint
    right_places = {parents[name].element.span for side in usual for name in side.named}
    if any(parents[name].element.span in right_places for side in odd for name in side.named):
        # To swap what a macro types would swap the others too.
        return (
            "the same macro names other pairs right: give it a parameter for the sides of its names if the places are right, "
            "else correct what this call passes"
        )
    holders = [(parents[side.named[0]].name, parents[side.named[1]].name) for side in odd]
    if all(left in _generate_right_names(right) for left, right in holders):
        pairs = join_names(f"{left} and {right}" for left, right in holders)
        named = "swap the names of the links" if len(odd) == 1 else "swap the names of the links of each pair"
        return f"{named}; if each is drawn for the other side, swap the children of the joints {pairs} instead"
    # Of limbs that are named otherwise, or not at all, only the names farther out are in question.
    are_limbs = all(side.named == (side.left.child, side.right.child) for side in odd)
    return "swap the names" + (
        " if the places are right, else the y of the origins of their joints" if are_limbs else ""
    )


def _is_driven(model: Model, pair: _LimbPair) -> bool:
    """Whether a joint of either limb moves."""
    ends = {pair.left.child, pair.right.child}
    return any(
        joint.type != "fixed" and not ends.isdisjoint(step.child for step in model.tree.find_path_to(joint.child))
        for joint in model.joints
    )


def _find_limb_pairs(model: Model, apart: float) -> Iterator[_LimbPair]:
    """Yield each pair of limbs whose names differ in the side and which are ``apart`` (m) across the body, not along it."""
    tree, placements = model.tree, model.placements
    yielded: set[tuple[str, str]] = set()
    for name in tree.order:
        for other in _generate_right_names(name):
            if other not in placements:
                continue
            paths = tree.find_path_to(name), tree.find_path_to(other)
            shared = _count_shared_joints(*paths)
            if shared in {len(paths[0]), len(paths[1])}:  # one carries the other
                continue
            left, right = paths[0][shared], paths[1][shared]
            body = placements[left.parent].rotation
            distance = rotate(transpose(body), subtract(placements[name].place, placements[other].place))
            across = abs(distance[1]) >= max(apart, 0.5 * math.hypot(*distance))
            if across and (left.name, right.name) not in yielded and _can_tell_sides(body, left, right):
                yielded.add((left.name, right.name))
                yield _LimbPair(left, right, (name, other), distance[1])


def _can_tell_sides(body: Matrix, left: Joint, right: Joint) -> bool:
    """Whether left and right can only be those of the robot.

    Not on a body that is rotated against the root, not for the fingers of a gripper, which can be mounted either way, and not
    for fixed parts that face backwards or upside down.
    """
    if measure_change(body, IDENTITY) > _ALIGNMENT_TOLERANCE or left.type == right.type == "prismatic":
        return False
    fixed = [joint.origin.placement for joint in (left, right) if joint.type == "fixed"]
    return all(one is not None and one.rotation[0][0] > 0.0 and one.rotation[2][2] > 0.0 for one in fixed)


def _count_shared_joints(one: tuple[Joint, ...], other: tuple[Joint, ...]) -> int:
    """Count the joints with which both paths begin."""
    for number, (a, b) in enumerate(zip(one, other, strict=False)):
        if a is not b:
            return number
    return min(len(one), len(other))


def _generate_right_names(name: str) -> Iterator[str]:
    """Yield the name with one word for left replaced by the word for right."""
    words = _WORDS.findall(name) if len(name) <= _MAX_NAME_LENGTH else []
    for place, word in enumerate(words):
        swapped = _RIGHT.get(word)
        if swapped is None and len(word) <= 2 and _SHORT_LEFT.fullmatch(word):
            swapped = word.replace("l", "r").replace("L", "R")
        if swapped is not None:
            yield "".join((*words[:place], swapped, *words[place + 1 :]))
