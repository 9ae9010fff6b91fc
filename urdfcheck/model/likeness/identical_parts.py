"""Links that draw one and the same part, and what the others say about each one's inertial."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from decimal import Decimal, InvalidOperation
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.likeness.mirror import InertialDeviation, PartOutline, measure_deviation, measure_outline_mismatch
from urdfcheck.facts.likeness.revolution import find_revolution_axis
from urdfcheck.facts.motion.kinematics import compute_joint_motions
from urdfcheck.model.fact import fact
from urdfcheck.model.likeness.declared_inertials import read_declared_inertial, turn_inertial
from urdfcheck.model.parts import TENSOR_NAMES, Inertial, Link, Shape, is_dummy_shape
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.repeated_drawings import find_stand_in_drawings
from urdfcheck.model.shapes.visual_solid import measure_link_geometry
from urdfcheck.model.wheel_names import NOT_DRIVEN_NAME

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array


# Inertials are equal when they differ by less than this share: what three typed digits leave, and a screw.
NOTABLE_SHARE = 0.01
# Shapes of two links are arranged alike when their placements agree to within this share of the distances between them.
_ARRANGEMENT_TOLERANCE = 1e-4
# What links draw is placed by hand to this length (m).
_SAME_PLACE = 1e-3
# Drawings that are turned by less (rad) are only shifted.
_SAME_AXES = 1e-6
# This many members of a group are compared with all others.
_MAX_CANDIDATES = 16
# A part is symmetric when its image under the symmetry differs by less than this share of its size.
_SYMMETRY_TOLERANCE = 0.02


@dataclass(frozen=True, slots=True, eq=False)
class PartCopy:
    """One of several links that draw a part: ``linear x + shift`` is where a point x of the part is in the link's frame (m)."""

    link: Link
    numbers: DeclaredInertial
    linear: Array
    """(3, 3), orthogonal; improper where a negative scale mirrors the part."""
    shift: Array
    rounding: tuple[float, float, float]
    """Half a unit of the last typed digits: of the mass (kg), the COM (m) and the tensor (kg m², Frobenius norm)."""


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class CopyComparison:
    """What like links say about one."""

    link: Link
    actual: DeclaredInertial
    expected: DeclaredInertial
    """What its inertial should be, in its frame, and in that image under a symmetry of the part in which the fewest
    quantities differ.
    """
    deviation: InertialDeviation
    """How far it is from that."""
    by: tuple[Link, ...]
    """The links that agree on it."""
    is_image: bool = False
    """Whether ``expected`` is an image under a symmetry of the part: then its numbers are in none of the links, and only as exact
    as the drawn part's centre and axes.
    """


@dataclass(frozen=True, slots=True, eq=False)
class _Symmetry:
    """What maps a part onto itself, in a link's frame."""

    centre: Array
    """(3,)"""
    linear: tuple[Array, ...]
    """Reflections and half turns (k, 3, 3) about ``centre``, the identity first."""
    axis: Array | None
    """(3,): all turns about it, where the part is a body of revolution."""


@fact
def part_copies(model: Model) -> tuple[tuple[PartCopy, ...], ...]:
    """Group two and more links that draw one part, wherever in their frames, with inertials that can be compared.

    A part is the same meshes (by content, in one scale but for signs) and primitives in one arrangement. Its links hang on
    joints of one type with equally many moving joints before them; wheels that roll freely are not copies of those that are
    driven. Primitives alone say less: links that draw nothing else are copies where four and more hang on moving joints.

    :raises FactUnavailableError: when the tree is broken.
    """
    tree = model.tree
    kinds: dict[object, list[list[tuple[PartCopy, tuple[Array, ...]]]]] = {}
    for name in tree.order[1:]:
        link, joint = model.link_by_name[name], tree.parent_joint[name]
        part = _make_part_copy(model, link)
        is_known = part is not None and name not in find_stand_in_drawings(model)
        if part is not None and is_known and (joint.is_movable or _has_mesh(part[0])):
            copy, content, arranged = part
            depth = sum(j.is_movable for j in tree.find_path_to(name))
            groups_of_kind = kinds.setdefault(
                (content, joint.type, depth, bool(NOT_DRIVEN_NAME.search(f"{joint.name} {name}"))), []
            )
            group = next((group for group in groups_of_kind if _is_same_arrangement(group[0][1], arranged)), None)
            if group is None:
                groups_of_kind.append([(copy, arranged)])
            else:
                group.append((copy, arranged))
    groups = (tuple(copy for copy, _ in group) for groups_of_kind in kinds.values() for group in groups_of_kind)
    return tuple(group for group in groups if len(group) >= (2 if _has_mesh(group[0]) else 4))


def find_odd_copies(model: Model, threshold: float = NOTABLE_SHARE) -> tuple[CopyComparison, ...]:
    """Compare each group of three and more with its majority, and return those that differ.

    They differ by more than the share ``threshold``, and by more than typed digits leave open. At most one in four may
    differ (one of three): more are another kind of part.

    :raises FactUnavailableError: when the tree is broken.
    """
    odd_copies: list[CopyComparison] = []
    for group in part_copies(model):
        if len(group) < 3:
            continue
        members = _GroupComparison(model, group, threshold)
        majority = members.find_majority()
        if 2 * len(majority) <= len(group):
            continue
        odd = [i for i in range(len(group)) if i not in majority]
        # Two copies may agree with a third and not with each other: by the symmetry of a part, which is only found nearly.
        odd = [i for i in odd if not any(members.do_agree(i, k) for k in majority)]
        if odd and len(odd) <= max(1, len(group) // 4):
            by = tuple(group[i].link for i in majority)
            odd_copies += [replace(members.expect_typed_numbers(i, majority[0]), by=by) for i in odd]
    return tuple(odd_copies)


def compare_copies(model: Model, link: Link, by: Link, threshold: float = NOTABLE_SHARE) -> CopyComparison | None:
    """Compare a link with one of its copies; None where it is not one of them.

    :raises FactUnavailableError: when the tree is broken.
    """
    for group in part_copies(model):
        places = {copy.link.name: index for index, copy in enumerate(group)}
        if link.name in places and by.name in places:
            return _GroupComparison(model, group, threshold).expect_typed_numbers(places[link.name], places[by.name])
    return None


def find_differing_pairs(
    model: Model, threshold: float = NOTABLE_SHARE, *, excluded: Collection[frozenset[str]] = ()
) -> tuple[tuple[CopyComparison, CopyComparison], ...]:
    """Find the groups of two whose inertials differ, as `find_odd_copies`, with what each says about the other.

    ``excluded``: pairs of links to leave out, by name.

    :raises FactUnavailableError: when the tree is broken.
    """
    differing = []
    for group in part_copies(model):
        if len(group) == 2 and frozenset(copy.link.name for copy in group) not in excluded:
            members = _GroupComparison(model, group, threshold)
            both = []
            for index in (0, 1):  # most agree, so that the second is not asked
                opinion = members.expect_typed_numbers(index, 1 - index)
                if not threshold < opinion.deviation.worst < math.inf:  # infinite where one is not a possible body
                    break
                both.append(opinion)
            else:
                differing.append((both[0], both[1]))
    return tuple(differing)


def estimate_from_copies(model: Model, *, excluded: Collection[frozenset[str]] = ()) -> Mapping[str, CopyComparison]:
    """Return what the copies of each link say that its inertial should be, by name.

    Of a group of three and more the majority says it, of two the other one. Several links in ``by`` agree among themselves.
    ``excluded``: groups of two to leave out, by name.

    :raises FactUnavailableError: when the tree is broken.
    """
    estimates: dict[str, CopyComparison] = {}
    for group in part_copies(model):
        if frozenset(copy.link.name for copy in group) in excluded:
            continue
        members = _GroupComparison(model, group, NOTABLE_SHARE)
        majority = members.find_majority() if len(group) > 2 else [0, 1]
        if 2 * len(majority) <= len(group):
            continue
        for i, copy in enumerate(group):
            by = [k for k in majority if k != i]
            opinion = members.compare_members(i, by[0])
            if opinion.deviation.worst < math.inf:
                estimates[copy.link.name] = replace(opinion, by=tuple(group[k].link for k in by))
    return estimates


class _GroupComparison:
    """The members of a group, compared when needed."""

    def __init__(self, model: Model, group: Sequence[PartCopy], threshold: float) -> None:
        self._model, self._group, self._threshold = model, group, threshold

    def find_majority(self) -> list[int]:
        """Return the most members that agree; those of a majority are found whichever of them is compared first."""
        count = len(self._group)
        best: list[int] = []
        # Among a few members one of the majority is found: of hundreds of links not all need be compared with all.
        for index in range(0, count, -(-count // _MAX_CANDIDATES)):
            if index not in best:
                best = max(best, self.find_agreeing(index), key=len)
            if 2 * len(best) > count:
                break
        return best

    def find_agreeing(self, index: int) -> list[int]:
        """Return the members that have one's inertial, itself first."""
        mass = self._group[index].numbers.mass
        # With masses a tenth apart, neither digits nor symmetry make them agree.
        alike = [math.isclose(copy.numbers.mass, mass, rel_tol=0.1) for copy in self._group]
        others = (i for i in range(len(self._group)) if i != index and alike[i])
        return [index, *(i for i in others if self.do_agree(i, index))]

    def do_agree(self, index: int, by: int) -> bool:
        """Whether one member has the inertial of another."""
        return self.compare_members(index, by).deviation.worst <= self._threshold

    def compare_members(self, index: int, by: int) -> CopyComparison:
        """Compare the inertial of one member with what that of another says it should be."""
        member, other = self._group[index], self._group[by]
        as_drawn = self._compare_as_drawn(index, by)
        if as_drawn.deviation.worst <= self._threshold:  # symmetries cost time, and most groups agree without
            return as_drawn
        images = (
            (_measure_beyond_rounding(member, other, image), image)
            for image in self._generate_images(index, _transform_to_copy(other, member))
        )
        # The image that leaves the fewest quantities to differ; the part as it is drawn when that is as good.
        deviation, expected = min(images, key=lambda choice: self._count_differences(choice[0]), default=(None, None))
        if (
            deviation is None
            or expected is None
            or self._count_differences(deviation) >= self._count_differences(as_drawn.deviation)
        ):
            return as_drawn
        expected = _rotate_to_axes_of(member.numbers, expected)
        return replace(as_drawn, expected=expected, deviation=deviation, is_image=True)

    def expect_typed_numbers(self, index: int, by: int) -> CopyComparison:
        """Compare as `compare_members`, but those that draw the part in one place and differ expect each other's own numbers."""
        comparison = self.compare_members(index, by)
        if not comparison.is_image or comparison.deviation.worst <= self._threshold:
            return comparison
        member, other = self._group[index], self._group[by]
        in_one_place = np.allclose(member.linear, other.linear, atol=1e-9) and np.allclose(
            member.shift, other.shift, atol=1e-9
        )
        return self._compare_as_drawn(index, by) if in_one_place else comparison

    def _compare_as_drawn(self, index: int, by: int) -> CopyComparison:
        member, other = self._group[index], self._group[by]
        expected = _transform_to_copy(other, member)
        return CopyComparison(
            link=member.link,
            actual=member.numbers,
            expected=_rotate_to_axes_of(member.numbers, expected),
            deviation=_measure_beyond_rounding(member, other, expected),
            by=(other.link,),
        )

    def _count_differences(self, deviation: InertialDeviation) -> int:
        return sum(share > self._threshold for share in (deviation.mass, deviation.com_offset, deviation.spread))

    def _generate_images(self, index: int, expected: DeclaredInertial) -> Iterator[DeclaredInertial]:
        """Yield the images of an inertial under the symmetries of the part."""
        member = self._group[index]
        symmetry = _find_symmetry(self._model, member.link)
        if symmetry is None:
            return
        for linear in symmetry.linear:
            image = _transform_about(expected, linear, symmetry.centre)
            yield image
            if symmetry.axis is not None:
                for angle in _propose_angles(member.numbers, image, axis=symmetry.axis, centre=symmetry.centre):
                    turn = compute_joint_motions(symmetry.axis, [angle], rotates=True)[0, :3, :3]
                    yield _transform_about(image, turn, symmetry.centre)


def _make_part_copy(model: Model, link: Link) -> tuple[PartCopy, tuple[object, ...], tuple[Array, ...]] | None:
    """Make a link a copy of what it draws; return also what that is, and how its shapes lie relative to the first one (4, 4)."""
    inertial, numbers = link.inertial, read_declared_inertial(link)
    shapes = next((s for s in (_drop_dummy_shapes(link.visuals), _drop_dummy_shapes(link.collisions)) if s), ())
    known = [(_identify_shape(model, shape), shape) for shape in shapes]
    if inertial is None or numbers is None or not known or any(content is None for content, _ in known):
        return None
    placed = [_compute_placement(shape) for _, shape in known]
    placements = [matrix for matrix in placed if matrix is not None]
    if len(placements) != len(placed):
        return None
    reference = placements[0]
    copy = PartCopy(
        link=link,
        numbers=numbers,
        linear=reference[:3, :3],
        shift=reference[:3, 3],
        rounding=_compute_inertial_rounding(inertial),
    )
    return (
        copy,
        tuple(content for content, _ in known),
        tuple(np.linalg.inv(reference) @ other for other in placements[1:]),
    )


def _has_mesh(copy: PartCopy) -> bool:
    return any(shape.kind == "mesh" for shape in (*copy.link.visuals, *copy.link.collisions))


def _drop_dummy_shapes(shapes: Sequence[Shape]) -> tuple[Shape, ...]:
    return tuple(shape for shape in shapes if not is_dummy_shape(shape))


def _identify_shape(model: Model, shape: Shape) -> tuple[object, ...] | None:
    """Return the content and size of a shape; None when they are not known."""
    size = shape.size
    if size is None or shape.kind is None or not all(size):
        return None
    what: str | None = shape.kind
    if shape.kind == "mesh":
        use = model.meshes.by_shape.get(id(shape))
        what = None if use is None or use.resource.path is None else model.meshes.compute_content_key(use.resource.path)
    return None if what is None else (what, *(float(f"{abs(s):.9g}") for s in size))


def _compute_placement(shape: Shape) -> Array | None:
    """Compute (4, 4): from the shape, unscaled except for the signs of a mesh's scale, to the link's frame."""
    pose, size = shape.origin.matrix, shape.size
    if pose is None or size is None:
        return None
    signs = np.sign(size) if shape.kind == "mesh" else np.ones(3)
    placed: Array = pose @ np.diag([*signs, 1.0])
    return placed


def _is_same_arrangement(one: Sequence[Array], other: Sequence[Array]) -> bool:
    size = max((float(np.linalg.norm(a[:3, 3])) for a in one), default=0.0)
    tolerance = np.array([[_ARRANGEMENT_TOLERANCE] * 3 + [max(_ARRANGEMENT_TOLERANCE * size, 1e-9)]] * 4)
    return all(bool((np.abs(a - b) <= tolerance).all()) for a, b in zip(one, other, strict=True))


def _transform_to_copy(source: PartCopy, target: PartCopy) -> DeclaredInertial:
    """Return the inertial of one copy as that of another, in the other's frame.

    One COM in both frames stays where it is in three cases: it is 0 0 0, a default rather than a measured place; the drawings are
    only shifted, or apart by no more than a hand measures; or the tensor is one too. Then where a drawing was put shows nothing.
    """
    linear, own = target.linear @ source.linear.T, source.numbers.com
    com = linear @ (own - source.shift) + target.shift
    moved = turn_inertial(source.numbers, linear, com=com)
    is_copied = np.array_equal(own, target.numbers.com) and (
        not own.any()
        or bool(np.allclose(linear, np.eye(3), atol=_SAME_AXES))
        or float(np.linalg.norm(com - own)) <= _SAME_PLACE
        or _have_one_tensor(moved, target.numbers)
    )
    return turn_inertial(source.numbers, linear, com=own) if is_copied else moved


def _have_one_tensor(one: DeclaredInertial, other: DeclaredInertial) -> bool:
    """Whether two tensors agree in the frame of the link, to the last digits that a turn leaves."""
    return bool(np.allclose(one.inertia, other.inertia, rtol=1e-9, atol=1e-9 * float(np.abs(other.inertia).max())))


def _transform_about(numbers: DeclaredInertial, linear: Array, centre: Array) -> DeclaredInertial:
    """Turn or mirror an inertial about a point of its link's frame."""
    return turn_inertial(numbers, linear, com=linear @ (numbers.com - centre) + centre)


def _rotate_to_axes_of(declared: DeclaredInertial, expected: DeclaredInertial) -> DeclaredInertial:
    """Return the expected inertial with its tensor in the axes that the link's author chose."""
    rotation = declared.rotation
    return DeclaredInertial(
        mass=expected.mass, com=expected.com, tensor=rotation.T @ expected.inertia @ rotation, rotation=rotation
    )


def _measure_beyond_rounding(copy: PartCopy, other: PartCopy, expected: DeclaredInertial) -> InertialDeviation:
    """Measure how far a copy is from what another expects; zero where rounding one to the digits of the other explains it."""
    deviation = measure_deviation(copy.numbers, expected)
    mass, place, spread = map(max, copy.rounding, other.rounding)
    return InertialDeviation(
        mass=0.0 if abs(copy.numbers.mass - expected.mass) <= mass else deviation.mass,
        com_offset=0.0 if np.linalg.norm(copy.numbers.com - expected.com) <= place else deviation.com_offset,
        spread=0.0 if np.linalg.norm(copy.numbers.inertia - expected.inertia) <= spread else deviation.spread,
    )


def _compute_inertial_rounding(inertial: Inertial) -> tuple[float, float, float]:
    """Compute half a unit of the last typed digits, see `PartCopy`."""
    mass, xyz = inertial.mass_attribute, inertial.origin.get_attribute("xyz")
    place = [_compute_number_rounding(word) for word in (xyz.value.split() if xyz is not None else ())]
    element = inertial.tensor_element
    tensor = {name: _compute_number_rounding(element.get(name) if element is not None else "") for name in TENSOR_NAMES}
    twice = math.sqrt(2.0)  # each product is in the tensor twice
    return (
        _compute_number_rounding(mass.value if mass is not None else ""),
        math.hypot(*place),
        math.hypot(*(half if name in {"ixx", "iyy", "izz"} else twice * half for name, half in tensor.items())),
    )


def _compute_number_rounding(text: str) -> float:
    """Compute half a unit of a number's last typed digit; 0 for zeros, which are exact."""
    try:
        value = Decimal(text.strip())
    except InvalidOperation:
        return 0.0
    exponent = value.as_tuple().exponent
    return 0.5 * 10.0**exponent if value and isinstance(exponent, int) and exponent < 0 else 0.0


@fact
def _find_symmetry(model: Model, link: Link) -> _Symmetry | None:
    """Find the symmetry of what a link draws; None when it is not known, or has no extent."""
    drawn = measure_link_geometry(model, link)
    if drawn is None:
        return None
    solid = drawn.solid if drawn.hull is None else drawn.hull
    outline = PartOutline(solid.com, solid.covariance, drawn.points)
    if not outline.radius > 0.0:
        return None

    def is_symmetry(linear: Array) -> bool:
        shift = solid.com - linear @ solid.com
        return measure_outline_mismatch(outline, outline, linear=linear, shift=shift) < _SYMMETRY_TOLERANCE

    _, axes = np.linalg.eigh(solid.covariance)
    flips = (axes @ np.diag(signs) @ axes.T for signs in product((1.0, -1.0), repeat=3))
    axis = find_revolution_axis(solid.covariance)
    if axis is not None and not all(
        is_symmetry(turn[:3, :3]) for turn in compute_joint_motions(axis, (0.3, 0.7, 1.1), rotates=True)
    ):
        axis = None
    return _Symmetry(solid.com, tuple(flip for flip in flips if is_symmetry(flip)), axis)


def _propose_angles(own: DeclaredInertial, image: DeclaredInertial, *, axis: Array, centre: Array) -> Iterator[float]:
    """Propose turns about an axis of revolution that may carry an inertial onto another.

    They carry COM onto COM, and main axis onto main axis.
    """
    across = np.linalg.svd(axis[None])[2][1:]
    across[1] = np.cross(axis, across[0])
    places = [across @ (numbers.com - centre) for numbers in (own, image)]
    yield math.atan2(places[0][1], places[0][0]) - math.atan2(places[1][1], places[1][0])
    plane = [across @ numbers.inertia @ across.T for numbers in (own, image)]
    mains = [math.atan2(2.0 * p[0, 1], p[0, 0] - p[1, 1]) / 2.0 for p in plane]
    yield mains[0] - mains[1]
    yield mains[0] - mains[1] + math.pi
