"""Where each link of one version is in the other, and which joint moved it there.

An edit of one origin moves everything behind it. Each link is therefore compared with where its parent's new place would take it:
what goes along has not changed. A frame that was moved while all that is given in it stays does not change the robot.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from urdfcheck.core.mechanism import MechanismJoint, MechanismLink, MechanismShape
from urdfcheck.core.records import dataclass
from urdfcheck.facts.arrays import Array, Mat4
from urdfcheck.facts.comparison.home_pose import (
    ANGLE_TOLERANCE,
    LENGTH_TOLERANCE,
    RELATIVE_TOLERANCE,
    HomePose,
    Screw,
    invert_pose,
    is_same_number,
    is_same_pose,
    locate_screw,
    measure_axis_change,
    measure_shift,
)
from urdfcheck.facts.comparison.matching import Correspondence
from urdfcheck.facts.motion.kinematics import compute_axis_angle


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class PlacedPair:
    """Two versions of a robot, and where the parts of the first are in the second."""

    before: HomePose
    after: HomePose
    match: Correspondence
    maps: Mapping[str, Mat4]
    """Of each link of the first version: takes what is given in the first version's anchor frame to the second's, all joints at
    zero."""
    moved: Mapping[str, Mat4]
    """Of the links that their own joint moved: the displacement in the first version's anchor frame."""
    reframed: frozenset[str]
    """The links whose frame was moved while mass, shapes and children stayed."""

    def get_map_above(self, link: str) -> Mat4:
        """Return where the parent of a link takes it."""
        joint = self.before.joint_above.get(link)
        return np.eye(4) if joint is None else self.maps[joint.parent]


def align_links(before: HomePose, after: HomePose, match: Correspondence) -> PlacedPair:
    """Find for each link of the first version where it is in the second."""
    maps: dict[str, Mat4] = {}
    moved: dict[str, Mat4] = {}
    reframed: set[str] = set()
    contents = _Contents(before, after, match, _collect_body_shapes(after))
    for name in before.order:
        joint = before.joint_above.get(name)
        above = np.eye(4) if joint is None else maps[joint.parent]
        new = match.links.get(name)
        if new is None:
            maps[name] = above
            continue
        by_frame = after.frames[new] @ invert_pose(before.frames[name])
        if is_same_pose(above @ before.frames[name], after.frames[new]):
            maps[name] = by_frame  # not `above`: rounding would add up along the chain
        elif contents.are_left_behind(name, above, by_frame):
            maps[name] = above
            reframed.add(name)
        else:
            maps[name] = by_frame
            moved[name] = invert_pose(above) @ by_frame
    return PlacedPair(before=before, after=after, match=match, maps=maps, moved=moved, reframed=frozenset(reframed))


def find_zero_offset(screw: Screw | None, displacement: Mat4, *, rotates: bool) -> float | None:
    """Return by how much the zero of a joint was shifted (rad or m); None for a displacement that is not along its motion."""
    if screw is None:
        return None
    axis, angle = compute_axis_angle(displacement[:3, :3])
    if not rotates:
        shift = displacement[:3, 3]
        along = float(shift @ screw.direction)
        is_pure = (
            angle <= ANGLE_TOLERANCE and float(np.linalg.norm(shift - along * screw.direction)) <= LENGTH_TOLERANCE
        )
        return along if is_pure else None
    if angle <= ANGLE_TOLERANCE or float(np.linalg.norm(np.cross(axis, screw.direction))) > ANGLE_TOLERANCE:
        return None
    off = displacement[:3, :3] @ screw.point + displacement[:3, 3] - screw.point
    if float(np.linalg.norm(off)) > LENGTH_TOLERANCE:
        return None
    return angle if float(axis @ screw.direction) > 0.0 else -angle


@dataclass(frozen=True, slots=True, eq=False)
class _Contents:
    """What is given in the frames of links: mass, shapes and children."""

    before: HomePose
    after: HomePose
    match: Correspondence
    shapes: Mapping[str, list[tuple[MechanismShape, Mat4]]]
    """See `_collect_body_shapes`."""

    def are_left_behind(self, name: str, above: Mat4, by_frame: Mat4) -> bool:
        """Whether the contents of a link are where its parent takes them, or a larger share than is where its frame takes them.

        Where both hold, as for a wheel whose frame is rotated about its axis, nothing but the frame moved either.
        """
        stays = list(self._compare(name, above))
        if not any(stays):
            return False
        goes = list(self._compare(name, by_frame))  # not as many where a child is as a whole where it was
        return all(stays) or sum(stays) * len(goes) > sum(goes) * len(stays)

    def _compare(self, name: str, taken: Mat4) -> Iterator[bool]:
        """Yield for the mass, each shape and each child of a link whether it is where ``taken`` takes it.

        For a child whose frame is elsewhere, and which is fixed, the same of its own contents.
        """
        waiting = [name]
        while waiting:
            link = waiting.pop()
            yield from self._compare_own(link, taken)
            for joint in self.before.joints_below[link]:
                child = self.match.links.get(joint.child)
                if child is None:
                    continue
                is_kept = self._is_child_kept(joint, child, taken)
                if not is_kept and joint.type == "fixed" and self._has_contents(joint.child):
                    waiting.append(joint.child)
                else:
                    yield is_kept

    def _compare_own(self, name: str, taken: Mat4) -> Iterator[bool]:
        new = self.match.links[name]
        old_link, new_link = self.before.links[name], self.after.links[new]
        frame = taken @ self.before.frames[name]
        if old_link.mass and old_link.com and new_link.com:
            if is_same_number(old_link.mass, new_link.mass):
                yield is_same_inertial(old_link, new_link, frame, self.after.frames[new])
            elif _measure_com_distance(old_link, new_link, frame, self.after.frames[new]) <= LENGTH_TOLERANCE:
                yield True  # of another mass nothing more is known
        for shape in old_link.shapes:
            yield any(
                is_same_geometry(shape, other) and is_same_placement(shape, frame, other, there)
                for other, there in self.shapes[new]
                if other.role == shape.role
            )

    def _has_contents(self, name: str) -> bool:
        link = self.before.links[name]
        return bool(link.mass or link.shapes or self.before.joints_below[name])

    def _is_child_kept(self, joint: MechanismJoint, child: str, taken: Mat4) -> bool:
        """Whether a child is where ``taken`` takes it: its frame, or the axis that it moves about."""
        if is_same_pose(taken @ self.before.frames[joint.child], self.after.frames[child]):
            return True
        other = self.after.joint_above.get(child)
        first, second = locate_screw(self.before, joint), None if other is None else locate_screw(self.after, other)
        if first is None or second is None or joint.type == "planar":
            return False
        is_line = joint.type != "prismatic"
        angle, apart, is_reversed = measure_axis_change(carry_screw(first, taken), second, is_line=is_line)
        return angle <= ANGLE_TOLERANCE and apart <= LENGTH_TOLERANCE and not is_reversed


def _collect_body_shapes(home: HomePose) -> dict[str, list[tuple[MechanismShape, Mat4]]]:
    """Return for each link the shapes of all links that only fixed joints connect to it, with the frames of their links."""
    found: dict[str, list[tuple[MechanismShape, Mat4]]] = {}
    for name, link in home.links.items():
        joint = home.joint_above.get(name)
        found[name] = [] if joint is None or joint.type != "fixed" else found[joint.parent]
        found[name] += [(shape, home.frames[name]) for shape in link.shapes]
    return found


def _measure_com_distance(first: MechanismLink, second: MechanismLink, here: Mat4, there: Mat4) -> float:
    places = [frame[:3, :3] @ np.array(link.com) + frame[:3, 3] for link, frame in ((first, here), (second, there))]
    return float(np.linalg.norm(places[1] - places[0]))


def carry_screw(screw: Screw, taken: Mat4) -> Screw:
    """Return a screw where a transform takes it."""
    return Screw(taken[:3, :3] @ screw.direction, taken[:3, :3] @ screw.point + taken[:3, 3])


def build_tensor(link: MechanismLink, frame: Mat4) -> Array:
    """Return the inertia tensor (3, 3) of a link about its COM, in the axes that ``frame`` is given in."""
    xx, xy, xz, yy, yz, zz = link.tensor
    tensor = np.array(((xx, xy, xz), (xy, yy, yz), (xz, yz, zz)))
    turned: Array = frame[:3, :3] @ tensor @ frame[:3, :3].T
    return turned


def is_same_inertial(first: MechanismLink, second: MechanismLink, here: Mat4, there: Mat4) -> bool:
    """Whether two links have the same mass distribution, their frames being at ``here`` and ``there``."""
    if not is_same_number(first.mass, second.mass) or len(first.tensor) != len(second.tensor):
        return False
    if bool(first.com) != bool(second.com):
        return False
    if first.com and _measure_com_distance(first, second, here, there) > LENGTH_TOLERANCE:
        return False
    return not first.tensor or is_same_tensor(build_tensor(first, here), build_tensor(second, there))


def is_same_tensor(first: Array, second: Array) -> bool:
    """Whether two tensors (3, 3) differ by no more than digits."""
    size = max(float(np.abs(first).max()), float(np.abs(second).max()))
    # A rotation that is off by the tolerance turns a tensor by twice as much.
    return float(np.abs(second - first).max()) <= 4.0 * RELATIVE_TOLERANCE * size


def is_same_geometry(first: MechanismShape, second: MechanismShape) -> bool:
    """Whether two shapes have one form and one size; a mesh that could not be read is known by its name."""
    if first.kind != second.kind or len(first.size) != len(second.size):
        return False
    if not all(map(is_same_number, first.size, second.size)):
        return False
    if first.kind != "mesh":
        return True
    if first.digest and second.digest:
        return first.digest == second.digest
    return not first.digest and not second.digest and first.mesh == second.mesh


def is_same_placement(first: MechanismShape, here: Mat4, second: MechanismShape, there: Mat4) -> bool:
    """Whether two shapes of one geometry cover the same space, their links' frames being at ``here`` and ``there``."""
    if not first.pose or not second.pose:
        return first.pose == second.pose
    one, two = here @ np.array(first.pose).reshape(4, 4), there @ np.array(second.pose).reshape(4, 4)
    distance, angle = measure_shift(one, two)
    if distance > LENGTH_TOLERANCE:
        return False
    if angle <= ANGLE_TOLERANCE or first.kind == "sphere":
        return True
    if first.kind not in {"cylinder", "capsule"}:
        return False
    return float(np.linalg.norm(np.cross(one[:3, 2], two[:3, 2]))) <= ANGLE_TOLERANCE
