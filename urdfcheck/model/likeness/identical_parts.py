"""Links that draw one and the same part, and what the others say that each one's inertial should be."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal, InvalidOperation
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.likeness.mirror import InertialDeviation, PartOutline, measure_deviation, measure_outline_mismatch
from urdfcheck.facts.likeness.revolution import find_revolution_axis
from urdfcheck.facts.motion.kinematics import compute_joint_motions
from urdfcheck.model.ground.wheels import NOT_DRIVEN_NAME
from urdfcheck.model.likeness.mirror_pairs import read_declared_inertial
from urdfcheck.model.parts import TENSOR_NAMES, Inertial, Link, Shape
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.bounds import is_dummy_shape
from urdfcheck.model.shapes.visual_solid import measure_link_geometry

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array


# Inertials are one when they differ by less than this share: what three typed digits leave, and a screw.
NOTABLE_SHARE = 0.01
# Shapes of a link are arranged like another link's when they are to within this share of the distances between them.
_ARRANGEMENT_TOLERANCE = 1e-4
# So many members of a group are asked which others agree with them.
_MAX_CANDIDATES = 16
# A part is symmetric when its image under the symmetry differs by less than this share of its size.
_SYMMETRY_TOLERANCE = 0.02


@dataclass(frozen=True, slots=True, eq=False)
class PartCopy:
    """One of several links that draw a part: ``linear x + shift`` is where a point x of the part is in the link's frame (m).

    ``linear`` (3, 3) is orthogonal, and improper where a negative scale mirrors the part."""

    link: Link
    numbers: DeclaredInertial
    linear: Array
    shift: Array


@dataclass(frozen=True, slots=True, eq=False)
class CopyComparison:
    """What like links say about one: ``wanted``, what its inertial should be, in its frame, and in that image under a symmetry of
    the part in which the fewest quantities differ; ``apart``: how far it is from that. ``by``: the links that agree on it."""

    link: Link
    actual: DeclaredInertial
    expected: DeclaredInertial
    deviation: InertialDeviation
    by: tuple[Link, ...]


@dataclass(frozen=True, slots=True, eq=False)
class _Symmetry:
    """What leaves a part as it is, in a link's frame: reflections and half turns ``linear`` (k, 3, 3) about ``centre`` (3,),
    the identity first, and all turns about ``axis`` (3,) where it is a body of revolution."""

    centre: Array
    linear: tuple[Array, ...]
    axis: Array | None


def part_copies(model: Model) -> tuple[tuple[PartCopy, ...], ...]:
    """Groups of two and more links that draw one part, wherever in their frames, with inertials that can be compared.

    A part is the same meshes (by content, in one scale but for signs) and primitives in one arrangement. Its links hang on
    joints of one type with equally many moving joints before them; wheels that roll freely are no copies of those that
    are driven. Primitives alone say less: links that draw nothing else are copies where four and more hang on moving joints.

    :raises Unavailable: when the tree is broken.
    """
    tree = model.tree
    kinds: dict[object, list[list[tuple[PartCopy, tuple[Array, ...]]]]] = {}
    for name in tree.order[1:]:
        link, joint = model.link_by_name[name], tree.parent_joint[name]
        found = _make_part_copy(model, link)
        if found is not None and (joint.is_movable or _has_mesh(found[0])):
            copy, what, arranged = found
            depth = sum(j.is_movable for j in tree.find_path_to(name))
            alike = kinds.setdefault(
                (what, joint.type, depth, bool(NOT_DRIVEN_NAME.search(f"{joint.name} {name}"))), []
            )
            group = next((group for group in alike if _is_same_arrangement(group[0][1], arranged)), None)
            if group is None:
                alike.append([(copy, arranged)])
            else:
                group.append((copy, arranged))
    groups = (tuple(copy for copy, _ in group) for alike in kinds.values() for group in alike)
    return tuple(group for group in groups if len(group) >= (2 if _has_mesh(group[0]) else 4))


def find_odd_copies(model: Model, threshold: float = NOTABLE_SHARE) -> tuple[CopyComparison, ...]:
    """What the majority of each group of three and more says about those that differ from it by more than the share ``note``
    and more than typed digits leave open.

    At most one in four may differ (one of three): more are another kind of part.

    :raises Unavailable: when the tree is broken.
    """
    found: list[CopyComparison] = []
    for group in model.copies:
        if len(group) < 3:
            continue
        members = _GroupComparison(model, group, threshold)
        most = members.find_majority()
        odd = [i for i in range(len(group)) if i not in most]
        if odd and len(odd) <= max(1, len(group) // 4):
            by = tuple(group[i].link for i in most)
            found += [replace(members.compare_members(i, most[0]), by=by) for i in odd]
    return tuple(found)


def find_differing_pairs(
    model: Model, threshold: float = NOTABLE_SHARE, *, excluded: Collection[frozenset[str]] = ()
) -> tuple[tuple[CopyComparison, CopyComparison], ...]:
    """Groups of two whose inertials differ, as `find_odd_copies`: what each says about the other. ``but``: links to leave out, by name.

    :raises Unavailable: when the tree is broken.
    """
    found = []
    for group in model.copies:
        if len(group) == 2 and frozenset(copy.link.name for copy in group) not in excluded:
            members = _GroupComparison(model, group, threshold)
            both = members.compare_members(0, 1), members.compare_members(1, 0)
            if all(threshold < opinion.deviation.worst < math.inf for opinion in both):  # infinite for what is no body
                found.append(both)
    return tuple(found)


def estimate_from_copies(model: Model, *, excluded: Collection[frozenset[str]] = ()) -> Mapping[str, CopyComparison]:
    """For every link with copies what these say that its inertial should be, by name: the majority of a group of three and more,
    the other one of two. Several links in ``by`` agree among themselves. ``but``: groups of two to leave out, by name.

    :raises Unavailable: when the tree is broken.
    """
    found: dict[str, CopyComparison] = {}
    for group in model.copies:
        if frozenset(copy.link.name for copy in group) in excluded:
            continue
        members = _GroupComparison(model, group, NOTABLE_SHARE)
        most = members.find_majority() if len(group) > 2 else [0, 1]
        if 2 * len(most) <= len(group):
            continue
        for i, copy in enumerate(group):
            by = [k for k in most if k != i]
            opinion = members.compare_members(i, by[0])
            if opinion.deviation.worst < math.inf:
                found[copy.link.name] = replace(opinion, by=tuple(group[k].link for k in by))
    return found


class _GroupComparison:
    """The members of a group, compared when asked for."""

    def __init__(self, model: Model, group: Sequence[PartCopy], threshold: float) -> None:
        self._model, self._group, self._note = model, group, threshold
        self._symmetries: dict[int, _Symmetry | None] = {}

    def find_majority(self) -> list[int]:
        """The most members that agree; those of a majority are found whichever of them is asked first."""
        count = len(self._group)
        best: list[int] = []
        # One in a few of a majority belongs to it: of hundreds of links not every one need be compared with every other.
        for index in range(0, count, -(-count // _MAX_CANDIDATES)):
            if index not in best:
                best = max(best, self.find_agreeing(index), key=len)
            if 2 * len(best) > count:
                break
        return best

    def find_agreeing(self, index: int) -> list[int]:
        """The members that have one's inertial, itself first."""
        own = self._group[index].numbers.mass
        # A tenth of the mass apart, no digits and no symmetry make them agree.
        alike = [math.isclose(copy.numbers.mass, own, rel_tol=0.1) for copy in self._group]
        others = (i for i in range(len(self._group)) if i != index and alike[i])
        return [index, *(i for i in others if self.compare_members(i, index).deviation.worst <= self._note)]

    def compare_members(self, index: int, by: int) -> CopyComparison:
        own, other = self._group[index], self._group[by]
        wanted = _transform_to_copy(other, own)
        apart = _measure_beyond_rounding(own, other, wanted)
        if apart.worst > self._note:  # symmetries cost time, and most groups agree
            images = (
                (_measure_beyond_rounding(own, other, image), image) for image in self._generate_images(index, wanted)
            )
            # The image that leaves the fewest quantities to differ; the part as it is drawn when that is as good.
            apart, wanted = min(
                [(apart, wanted), *images], key=lambda one: (self._count_differences(one[0]), one[1] is not wanted)
            )
        return CopyComparison(own.link, own.numbers, _rotate_to_axes_of(own.numbers, wanted), apart, (other.link,))

    def _count_differences(self, apart: InertialDeviation) -> int:
        return sum(share > self._note for share in (apart.mass, apart.com_offset, apart.spread))

    def _generate_images(self, index: int, wanted: DeclaredInertial) -> Iterator[DeclaredInertial]:
        if index not in self._symmetries:
            self._symmetries[index] = _find_symmetry(self._model, self._group[index].link)
        symmetry = self._symmetries[index]
        if symmetry is None:
            return
        for linear in symmetry.linear:
            image = _transform_inertial(wanted, linear, symmetry.centre)
            yield image
            if symmetry.axis is not None:
                for angle in _propose_angles(self._group[index].numbers, image, symmetry.axis, symmetry.centre):
                    turn = compute_joint_motions(symmetry.axis, [angle], rotates=True)[0, :3, :3]
                    yield _transform_inertial(image, turn, symmetry.centre)


def _make_part_copy(model: Model, link: Link) -> tuple[PartCopy, tuple[object, ...], tuple[Array, ...]] | None:
    """A link as a copy of what it draws, what that is, and how its shapes lie about the first one (4, 4)."""
    numbers = read_declared_inertial(link)
    shapes = next((s for s in (_drop_dummy_shapes(link.visuals), _drop_dummy_shapes(link.collisions)) if s), ())
    known = [(_identify_shape(model, shape), shape) for shape in shapes]
    if numbers is None or not known or any(what is None for what, _ in known):
        return None
    placed = [_compute_placement(shape) for _, shape in known]
    whole = [matrix for matrix in placed if matrix is not None]
    if len(whole) != len(placed):
        return None
    first = whole[0]
    copy = PartCopy(link, numbers, first[:3, :3], first[:3, 3])
    return copy, tuple(what for what, _ in known), tuple(np.linalg.inv(first) @ other for other in whole[1:])


def _has_mesh(copy: PartCopy) -> bool:
    return any(shape.kind == "mesh" for shape in (*copy.link.visuals, *copy.link.collisions))


def _drop_dummy_shapes(shapes: Sequence[Shape]) -> tuple[Shape, ...]:
    return tuple(shape for shape in shapes if not is_dummy_shape(shape))


def _identify_shape(model: Model, shape: Shape) -> tuple[object, ...] | None:
    """The content and size of a shape; None when they are not known."""
    size = shape.size
    if size is None or shape.kind is None or not all(size):
        return None
    what: str | None = shape.kind
    if shape.kind == "mesh":
        use = model.meshes.by_shape.get(id(shape))
        what = None if use is None or use.resource.path is None else model.meshes.compute_content_key(use.resource.path)
    return None if what is None else (what, *(float(f"{abs(s):.9g}") for s in size))


def _compute_placement(shape: Shape) -> Array | None:
    """(4, 4): from the shape, unscaled but for the signs of a mesh's scale, to the link's frame."""
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
    """The inertial of one copy as that of another, in the other's frame."""
    linear = target.linear @ source.linear.T
    numbers = source.numbers
    com = linear @ (numbers.com - source.shift) + target.shift
    return DeclaredInertial(numbers.mass, com, numbers.tensor, _make_proper_rotation(linear) @ numbers.rotation)


def _transform_inertial(numbers: DeclaredInertial, linear: Array, centre: Array) -> DeclaredInertial:
    com = linear @ (numbers.com - centre) + centre
    return DeclaredInertial(numbers.mass, com, numbers.tensor, _make_proper_rotation(linear) @ numbers.rotation)


def _make_proper_rotation(linear: Array) -> Array:
    """-1 turns an improper rotation into a proper one, and leaves every tensor as it is."""
    return linear if np.linalg.det(linear) > 0 else -linear


def _rotate_to_axes_of(own: DeclaredInertial, wanted: DeclaredInertial) -> DeclaredInertial:
    """The same inertial with its tensor in the axes that the link's author chose."""
    return DeclaredInertial(wanted.mass, wanted.com, own.rotation.T @ wanted.inertia @ own.rotation, own.rotation)


def _measure_beyond_rounding(own: PartCopy, other: PartCopy, wanted: DeclaredInertial) -> InertialDeviation:
    """How far a copy is from what another wants; what rounding one to the digits of the other explains counts as nothing."""
    apart = measure_deviation(own.numbers, wanted)
    halves = [_compute_inertial_rounding(copy.link.inertial) for copy in (own, other) if copy.link.inertial is not None]
    mass, place, spread = (max(half[i] for half in halves) for i in range(3))
    return InertialDeviation(
        mass=0.0 if abs(own.numbers.mass - wanted.mass) <= mass else apart.mass,
        com_offset=0.0 if np.linalg.norm(own.numbers.com - wanted.com) <= place else apart.com_offset,
        spread=0.0 if np.linalg.norm(own.numbers.inertia - wanted.inertia) <= spread else apart.spread,
    )


def _compute_inertial_rounding(inertial: Inertial) -> tuple[float, float, float]:
    """Half a unit of the last typed places: of the mass (kg), the COM (m) and the tensor (kg m², Frobenius norm)."""
    mass, xyz = inertial.mass_attribute, inertial.origin.get_attribute("xyz")
    place = [_compute_number_rounding(word) for word in (xyz.value.split() if xyz is not None else ())]
    element = inertial.tensor_element
    six = {name: _compute_number_rounding(element.get(name) if element is not None else "") for name in TENSOR_NAMES}
    twice = math.sqrt(2.0)  # products stand in the tensor twice
    return (
        _compute_number_rounding(mass.value if mass is not None else ""),
        math.hypot(*place),
        math.hypot(*(half if name in {"ixx", "iyy", "izz"} else twice * half for name, half in six.items())),
    )


def _compute_number_rounding(text: str) -> float:
    """Half a unit of a number's last typed place; 0 of zeros, which are exact."""
    try:
        value = Decimal(text.strip())
    except InvalidOperation:
        return 0.0
    exponent = value.as_tuple().exponent
    return 0.5 * 10.0**exponent if value and isinstance(exponent, int) and exponent < 0 else 0.0


def _find_symmetry(model: Model, link: Link) -> _Symmetry | None:
    """None when the part is not known, or has no extent."""
    drawn = measure_link_geometry(model, link)
    if drawn is None:
        return None
    solid = drawn.solid if drawn.hull is None else drawn.hull
    outline = PartOutline(solid.com, solid.covariance, drawn.points)
    if not outline.radius > 0.0:
        return None

    def is_symmetry(linear: Array) -> bool:
        return (
            measure_outline_mismatch(outline, outline, linear=linear, shift=solid.com - linear @ solid.com)
            < _SYMMETRY_TOLERANCE
        )

    _, axes = np.linalg.eigh(solid.covariance)
    flips = (axes @ np.diag(signs) @ axes.T for signs in product((1.0, -1.0), repeat=3))
    axis = find_revolution_axis(solid.covariance)
    if axis is not None and not all(
        is_symmetry(turn[:3, :3]) for turn in compute_joint_motions(axis, (0.3, 0.7, 1.1), rotates=True)
    ):
        axis = None
    return _Symmetry(solid.com, tuple(flip for flip in flips if is_symmetry(flip)), axis)


def _propose_angles(own: DeclaredInertial, image: DeclaredInertial, axis: Array, centre: Array) -> Iterator[float]:
    """Turns about an axis of revolution that may carry an inertial onto another: COM onto COM, and main axis onto main axis."""
    across = np.linalg.svd(axis[None])[2][1:]
    across[1] = np.cross(axis, across[0])
    places = [across @ (numbers.com - centre) for numbers in (own, image)]
    yield math.atan2(places[0][1], places[0][0]) - math.atan2(places[1][1], places[1][0])
    plane = [across @ numbers.inertia @ across.T for numbers in (own, image)]
    mains = [math.atan2(2.0 * p[0, 1], p[0, 0] - p[1, 1]) / 2.0 for p in plane]
    yield mains[0] - mains[1]
    yield mains[0] - mains[1] + math.pi
