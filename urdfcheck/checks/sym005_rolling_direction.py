"""SYM005 reports wheels that a positive velocity rolls in opposite directions."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

import numpy as np

from urdfcheck.core import Edit, Finding, Rule, Severity, Span
from urdfcheck.core.text import format_point
from urdfcheck.model import Model
from urdfcheck.model.ground.wheels import LEVEL, DrivenWheel, find_driven_wheels
from urdfcheck.model.motion.controllers import collect_controlled_joints, find_controller_configs
from urdfcheck.model.repairs.edits import edit_all_numbers, locate_text
from urdfcheck.source.ros.controllers import Controller
from urdfcheck.source.text.values import parse_number

# Plugins and controllers that drive straight with velocities of one sign. Other programs may negate one side.
_DRIVES_ALIKE = re.compile(r"diff[-_]?drive|skid[-_]?steer|mecanum[-_]?drive", re.IGNORECASE)

# Of three wheels around a base one may point inwards as well as the other two.
_RING = 4


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    known = find_driven_wheels(model)
    if all(float(wheel.axis @ known[0].axis) > 1 - LEVEL for wheel in known):
        return  # all roll alike
    driven = _list_driven_names(model)
    # What a drive turns is a wheel, even if it hangs in the air by mistake.
    wheels = [wheel for wheel in known if wheel.stands or any(_drives(names, [wheel]) for names in driven)]
    if len(wheels) < 2:
        return
    axis = wheels[0].axis
    # A holonomic base has wheels in several directions.
    if any(abs(float(wheel.axis @ axis)) < 1 - LEVEL for wheel in wheels):
        yield from _check_ring(model, rule, wheels)
        return
    along = [wheel for wheel in wheels if float(wheel.axis @ axis) > 0]
    against = [wheel for wheel in wheels if wheel not in along]
    if not against:
        return
    odd, rest = _pick_outliers(along, against)
    # Of equally many either may be meant, and a controller may negate one side: nothing is edited then. Nor where a wheel is
    # off the ground: it may be the one that makes the numbers equal.
    are_equal = len(odd) == len(rest)
    are_driven_together = any(_drives(names, odd) and _drives(names, rest) for names in driven)
    shared = _list_made_alike(odd, rest)
    neighbour = None if are_driven_together else _find_neighbour(model, odd, rest)
    if are_equal:
        matters = are_driven_together
    else:
        # A wheel that none of those who drive the others names turns freely.
        driven = [*driven, set(collect_controlled_joints(model))]
        matters = not any(_drives(names, rest) for names in driven) or any(_drives(names, odd) for names in driven)
    # Where each side has wheels of both directions, these work against each other.
    is_by_side = are_equal and _are_on_two_sides(model, odd, rest)
    yield rule.finding(
        ("opposed" if is_by_side else "fighting") if are_equal else "minority",
        at=odd[0].joint.axis_location,
        related=[wheel.joint.axis_location for wheel in (*odd[1:], *rest)],
        severity=None if matters else Severity.INFO,
        edits=()
        if are_equal or not matters or neighbour or shared or len(wheels) < len(known)
        else _propose_edits(odd),
        odd=_join_joint_names(odd),
        rest=_join_joint_names(rest),
        remedy=_describe_remedy(odd, shared),
        odd_axis=format_point(odd[0].axis, decimals=3),
        rest_axis=format_point(rest[0].axis, decimals=3),
        otherwise=""
        if neighbour is None
        else f", or that of {neighbour.joint.name} if the two sides are meant to roll oppositely",
    )


def _find_neighbour(model: Model, odd: Sequence[DrivenWheel], rest: Sequence[DrivenWheel]) -> DrivenWheel | None:
    """Return the only other wheel on the side of a single odd one: if that is the wrong one, the sides roll oppositely."""
    if len(odd) != 1:
        return None
    wheels = [*odd, *rest]
    across = np.array([float(model.frames[wheel.joint.child][:3, 3] @ odd[0].axis) for wheel in wheels])
    sides = across > (across.min() + across.max()) / 2
    beside = [wheel for wheel, side in zip(rest, sides[1:], strict=True) if side == sides[0]]
    return beside[0] if len(beside) == 1 else None


def _check_ring(model: Model, rule: Rule, wheels: Sequence[DrivenWheel]) -> Iterator[Finding]:
    """Report the only wheel around a base whose axis points inwards, or outwards."""
    odd = _find_inward_wheel(model, wheels)
    if odd is not None:
        rest = [wheel for wheel in wheels if wheel is not odd]
        shared = _list_made_alike([odd], rest)
        yield rule.finding(
            "ring",
            at=odd.joint.axis_location,
            related=[wheel.joint.axis_location for wheel in rest],
            edits=() if shared else _propose_edits([odd]),
            odd=odd.joint.name,
            rest=_join_joint_names(rest),
            remedy=_describe_remedy([odd], shared),
        )


def _find_inward_wheel(model: Model, wheels: Sequence[DrivenWheel]) -> DrivenWheel | None:
    """Return the only wheel around a holonomic base whose axis points inwards where those of all others point outwards, or the
    other way round; None where an axis is along no spoke, or there are fewer than three others."""
    places = np.array([model.frames[wheel.joint.child][:3, 3] for wheel in wheels])
    spokes = places - places.mean(axis=0)
    along = (spokes * [wheel.axis for wheel in wheels]).sum(axis=1)
    outwards = along > 0
    if len(wheels) < _RING or not (np.abs(along) > (1 - LEVEL) * np.linalg.norm(spokes, axis=1)).all():
        return None
    for odd, is_out in enumerate(outwards):
        if (np.delete(outwards, odd) != is_out).all():
            return wheels[odd]
    return None


def _are_on_two_sides(model: Model, one: Sequence[DrivenWheel], other: Sequence[DrivenWheel]) -> bool:
    """Whether all wheels of one group are left, or right, of those of the other."""
    first, second = (
        [float(model.frames[wheel.joint.child][:3, 3] @ one[0].axis) for wheel in group] for group in (one, other)
    )
    return max(first) < min(second) or max(second) < min(first)


def _drives(names: set[str], wheels: Sequence[DrivenWheel]) -> bool:
    return any(wheel.joint.name in names for wheel in wheels)


def _list_driven_names(model: Model) -> list[set[str]]:
    """List the words of each drive plugin of the model and of each drive controller of its package: joints are among them."""
    named = [
        {element.text.strip() for element in plugin.walk()}
        for block in model.robot.find_children("gazebo")
        for plugin in block.find_children("plugin")
        if _DRIVES_ALIKE.search(plugin.get("filename"))
    ]
    named += [
        {joint.text for joint in controller.joints}
        for config in find_controller_configs(model)
        for controller in config.configuration.controllers
        if _DRIVES_ALIKE.search(controller.type) and not _negates_side(controller)
    ]
    return named


def _negates_side(controller: Controller) -> bool:
    """Whether a controller takes the radius of the wheels of one side as negative: they turn against those of the other."""
    values = (controller.parameters.get(f"{side}_wheel_radius_multiplier") for side in ("left", "right"))
    signs = [number < 0 for value in values if value is not None and (number := parse_number(value.text)) is not None]
    return sum(signs) == 1


def _pick_outliers(
    one: Sequence[DrivenWheel], other: Sequence[DrivenWheel]
) -> tuple[Sequence[DrivenWheel], Sequence[DrivenWheel]]:
    """Return the wheels to invert and the others.

    Fewer wheels are the wrong ones; of equally many, those that do not roll towards +x (or +y).
    """
    if len(one) != len(other):
        return (one, other) if len(one) < len(other) else (other, one)
    # A wheel under the robot that rotates about +y rolls towards +x; one that rotates about -x rolls towards +y.
    axis = one[0].axis
    forward = axis[1] > 0 if abs(axis[1]) > abs(axis[0]) else axis[0] < 0
    return (other, one) if forward else (one, other)


def _list_made_alike(odd: Sequence[DrivenWheel], rest: Sequence[DrivenWheel]) -> list[DrivenWheel]:
    """List the other wheels whose axis is made by the text that makes one of the odd ones': written anew, it inverts both."""
    texts = {_locate_axis_text(wheel) for wheel in odd} - {None}
    return [wheel for wheel in rest if _locate_axis_text(wheel) in texts]


def _locate_axis_text(wheel: DrivenWheel) -> Span | None:
    """Return the place of the text to write another axis in; of the joint where it has none."""
    element = wheel.joint.axis_element
    attribute = None if element is None else element.attributes.get("xyz")
    if attribute is not None:
        return locate_text(attribute)
    return wheel.joint.element.span if element is None else element.span


def _describe_remedy(odd: Sequence[DrivenWheel], shared: Sequence[DrivenWheel]) -> str:
    names = _join_joint_names(odd)
    if not shared:
        return f"invert the axis of {names} (all three signs)"
    return (
        f"give the macro a parameter for the axis, and invert it (all three signs) for {names} alone: "
        f"the same line makes {_join_joint_names(shared)}"
    )


def _propose_edits(wheels: Sequence[DrivenWheel]) -> list[Edit]:
    """Return edits that invert the axis of each wheel; nothing unless all axes are typed literally."""
    elements = [wheel.joint.axis_element for wheel in wheels]
    axes = [None if element is None else element.attributes.get("xyz") for element in elements]
    words = ([] if axis is None else axis.value.split() for axis in axes)
    return edit_all_numbers(
        (axis, " ".join(map(_invert_sign, numbers))) for axis, numbers in zip(axes, words, strict=True)
    )


def _invert_sign(word: str) -> str:
    return word if float(word) == 0 else word[1:] if word.startswith("-") else f"-{word.removeprefix('+')}"


def _join_joint_names(wheels: Sequence[DrivenWheel]) -> str:
    return ", ".join(wheel.joint.name for wheel in wheels)
