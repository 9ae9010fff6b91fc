"""How a robot drove in a simulator, against how its controller, its plugin or its wheels say that it should."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

from urdfcheck.core import Located, Location
from urdfcheck.core.drive_test import HALF_TURN
from urdfcheck.core.drop_test import GRAVITY
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import join_names
from urdfcheck.model.ground.wheels import rolling_wheels
from urdfcheck.model.motion.driving.drive_plan import DrivePlan, TypedSize, find_drive_plan
from urdfcheck.model.motion.driving.simulated_drive import read_wheel_friction
from urdfcheck.model.robot import Model

if TYPE_CHECKING:
    from urdfcheck.core.drive_test import DriveTest

# Slips that differ by less are one.
_AS_MUCH = 0.01
# A robot that goes this part of what its wheels do goes with them. Wheels whose friction bears this part of the robot's weight,
# twice what its acceleration needs, have grip.
_AS_FAR, _GRIPPING = 0.9, 0.1
# A robot that turns by more than this part of what half a turn against each other gives, spins.
_SPINS = 0.5
# What is measured is nearer to what the model's sizes give than this part of the difference to what is wanted.
_EXPLAINED = 0.5
# Radii that differ by less, as a share, are one size, and axes (rad) that differ by less are parallel.
_ONE_SIZE, _PARALLEL = 0.002, 0.002


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class DriveDefect:
    """What is wrong with how a robot drives."""

    kind: str
    """slips, spins, backwards, sideways, swapped, drifts, distance or turn."""
    at: Located | Location
    related: tuple[Located | Location, ...]
    data: dict[str, Any]
    is_commanded: bool
    """Whether a controller or plugin says how the wheels are driven."""


def find_drive_defect(
    model: Model, test: DriveTest, *, slip: float, drift: float, rel_tol: float
) -> DriveDefect | None:
    """Find the worst of what a drive shows; None where the robot is sound.

    :param slip: greatest share of a wheel's rotation that may be lost.
    :param drift: degrees by which the heading may change while the robot drives ahead.
    :param rel_tol: share by which distance and angle may differ from what is typed.
    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    plan = find_drive_plan(model)
    if plan is None:
        return None
    return next(_iter_defects(model, test, plan, slip, drift, rel_tol), None)


def _iter_defects(
    model: Model, test: DriveTest, plan: DrivePlan, slip: float, drift: float, rel_tol: float
) -> Iterator[DriveDefect]:
    forward, names = test.forward, (*plan.left, *plan.right)
    most = max(wheel.slip for wheel in test.wheels)
    worst = next(wheel for wheel in test.wheels if wheel.slip > most - _AS_MUCH)
    if most > slip and _creeps(model, test):
        return
    if most > slip:
        data = {"joint": worst.joint, "share": worst.slip, "load": worst.load, "reason": _explain_slip(test)}
        yield _build_defect(model, "slips", plan, (worst.joint,), data)
        return
    if abs(forward.turned) > _SPINS * test.turn:
        odd = _list_backward_joints(model, plan) or names
        data = {"turned": math.degrees(forward.turned), "joint": join_names(odd)}
        yield _build_defect(model, "spins", plan, (*odd, *(name for name in names if name not in odd)), data)
        return
    yield from _iter_direction_defects(model, test, plan)
    if abs(math.degrees(forward.turned)) > drift:
        data = {"turned": math.degrees(forward.turned), "reason": _explain_drift(model, test)}
        yield _build_defect(model, "drifts", plan, names, data)
    yield from _iter_size_defects(model, test, plan, rel_tol)


def _creeps(model: Model, test: DriveTest) -> bool:
    """Whether wheels that have grip lose rotation all alike, and the robot goes as far as they do.

    MuJoCo's contacts are as stiff as the wheel's mass wants: under a robot that weighs hundreds of times as much a wheel creeps.
    """
    slips = [wheel.slip for wheel in test.wheels]
    weight = GRAVITY * sum(declared.mass for declared in model.masses)
    return (
        max(slips) - min(slips) < _AS_MUCH
        and test.forward.distance > _AS_FAR * min(abs(wheel.travelled) for wheel in test.wheels) > 0.0
        and sum(read_wheel_friction(model, wheel.joint) * wheel.load for wheel in test.wheels) > _GRIPPING * weight
    )


def _iter_direction_defects(model: Model, test: DriveTest, plan: DrivePlan) -> Iterator[DriveDefect]:
    """Report a robot that goes elsewhere than what commands it says; a convention of names is no command."""
    if not plan.knows_ahead:
        return
    names = (*plan.left, *plan.right)
    angle = math.degrees(math.atan2(test.forward.aside, test.forward.ahead))
    data = {"distance": 1e3 * test.forward.distance, "angle": angle, "joints": join_names(names)}
    turns_right = plan.knows_sides and test.turning.turned < -_SPINS * test.turn
    if abs(angle) > 135:
        reversed_frame = _is_left_on_right(model, plan)
        reason, repair = _describe_reversal(test, names, reversed_frame=reversed_frame)
        yield _build_defect(model, "backwards", plan, names, {**data, "reason": reason, "repair": repair})
    elif abs(angle) > 45:
        yield _build_defect(model, "sideways", plan, names, data)
    elif turns_right:
        data |= {"turned": -math.degrees(test.turning.turned), "left": join_names(plan.left)}
        yield _build_defect(model, "swapped", plan, names, data)


def _describe_reversal(test: DriveTest, names: Sequence[str], *, reversed_frame: bool) -> tuple[str, str]:
    """Say why it goes backwards, and what reverses that."""
    if reversed_frame:
        reason = f"its left wheels are on the right of the x axis of {test.frame}"
        return reason, f"rotate {test.frame} by half a turn about z, so that its x axis points ahead"
    return f"positive velocities roll the wheels towards -x of {test.frame}", f"reverse the axes of {join_names(names)}"


def _is_left_on_right(model: Model, plan: DrivePlan) -> bool:
    """Whether the left wheels are to the right of the x axis of the frame."""
    centres = {wheel.joint.name: wheel.centre for wheel in rolling_wheels(model)}
    aside = model.frames[plan.frame][:3, 1]
    left, right = (sum(float(centres[name] @ aside) for name in side) / len(side) for side in (plan.left, plan.right))
    return left < right


def _list_backward_joints(model: Model, plan: DrivePlan) -> tuple[str, ...]:
    """List the joints whose velocity, as commanded to go ahead, rolls towards -x of the frame."""
    aside = model.frames[plan.frame][:3, 1]
    return tuple(
        name
        for sign, side in zip(plan.signs, (plan.left, plan.right), strict=True)
        for name in side
        if sign * float(model.axes[name] @ aside) < 0
    )


def _explain_slip(test: DriveTest) -> str:
    loads = ", ".join(f"{wheel.joint} {wheel.load:.3g} N" for wheel in test.wheels)
    return f"loads: {loads}"


def _explain_drift(model: Model, test: DriveTest) -> str:
    """Say which wheels differ: in radius, or in the direction of their axes."""
    radii = [wheel.radius for wheel in test.wheels]
    if max(radii) - min(radii) > _ONE_SIZE * max(radii):
        return "; heights of the axles: " + ", ".join(f"{w.joint} {1e3 * w.radius:.4g} mm" for w in test.wheels)
    first = model.axes[test.left[0]]
    angles = [math.acos(min(1.0, abs(float(first @ model.axes[name])))) for name in test.right]
    if angles and max(angles) > _PARALLEL:
        return f"; the axes of left and right wheels are {math.degrees(max(angles)):.2g}° apart"
    return "; loads of the wheels: " + ", ".join(f"{w.joint} {w.load:.3g} N" for w in test.wheels)


def _iter_size_defects(model: Model, test: DriveTest, plan: DrivePlan, rel_tol: float) -> Iterator[DriveDefect]:
    distance, sizes = test.forward.distance, (plan.radius, plan.separation)
    if sizes[0] is not None and _is_explained(distance, test.expected_distance, HALF_TURN * test.radius, rel_tol):
        data = {"real": 1e3 * distance, "wanted": 1e3 * test.expected_distance, "radius": test.radius}
        yield _build_size_defect(model, "distance", plan, sizes[0], data)
        return
    one_each = len(plan.left) == len(plan.right) == 1  # the track of a skid steer is tuned to the ground
    turned = abs(test.turning.turned)
    if sizes[1] is not None and one_each and _is_explained(turned, test.expected_turn, test.turn, rel_tol):
        real, wanted = math.degrees(turned), math.degrees(test.expected_turn)
        data = {"real": real, "wanted": wanted, "separation": test.separation}
        yield _build_size_defect(model, "turn", plan, sizes[1], data)


def _is_explained(measured: float, wanted: float, rolled: float, rel_tol: float) -> bool:
    """Whether what was measured differs from what is wanted, and is what wheels of the model's sizes do without slip."""
    return abs(measured - wanted) > rel_tol * wanted and abs(measured - rolled) < _EXPLAINED * abs(wanted - rolled)


def _build_size_defect(model: Model, kind: str, plan: DrivePlan, size: TypedSize, data: dict[str, Any]) -> DriveDefect:
    joints = tuple(model.joint_by_name[name] for name in (*plan.left, *plan.right))
    off = abs(data["real"] / data["wanted"] - 1)
    more = {"key": size.key, "value": size.value, "source": plan.source, "off": off}
    return DriveDefect(kind=kind, at=size.at, related=joints, data={**data, **more}, is_commanded=True)


def _build_defect(model: Model, kind: str, plan: DrivePlan, names: Sequence[str], data: dict[str, Any]) -> DriveDefect:
    """Build a defect that shows in joints, the first of which is where it is reported."""
    places = [model.joint_by_name[name].axis_location for name in names]
    data = {**data, "source": plan.source}
    related = tuple(places[1:])
    return DriveDefect(kind=kind, at=places[0], related=related, data=data, is_commanded=plan.knows_ahead)
