"""Links, joints, inertials and shapes: thin located views of the expanded elements.

A value that the file misspells, or that is too large to compute with, is None here: the rule about numbers reports it, and
every other rule abstains.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, TypeVar

from urdfcheck.core import Location
from urdfcheck.core.records import dataclass
from urdfcheck.facts.small_matrices import (
    Placement,
    Vector,
    compute_moments,
    make_quaternion_rotation,
    make_rotation,
    make_tensor,
)
from urdfcheck.source.text.values import MAX_MAGNITUDE, is_computable, read_attribute_number, read_attribute_numbers
from urdfcheck.source.text.xml import Attribute, Element

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array

_T = TypeVar("_T")

MOVING_TYPES = frozenset({"revolute", "continuous", "prismatic", "floating", "planar"})
_ZERO = (0.0, 0.0, 0.0)
TENSOR_NAMES = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
# A root of one of these names is the ground itself.
GROUND_NAMES = frozenset({"world", "map"})
# A joint with less room stands still (chosen): half a degree, a tenth of a millimetre.
_HELD_RANGE = {"rad": 0.01, "m": 1e-4}
# A primitive of at most 5 mm is a dummy: published models write one where some parser wants a shape (boxes of 1 mm in PR2 and
# the Shadow hand, of 5 mm in RotorS).
MAX_DUMMY_SIZE = 0.005
GEOMETRY_TAGS = ("mesh", "box", "cylinder", "sphere", "capsule")


@dataclass(frozen=True, eq=False)
class Pose:
    """An ``<origin>``: ``xyz`` in metres, ``rpy`` in radians (fixed axes roll, pitch, yaw); the identity where it is absent."""

    element: Element | None

    @property
    def xyz(self) -> tuple[float, ...] | None:
        return _read_numbers(self.element, "xyz", count=3, default=_ZERO)

    @property
    def rpy(self) -> tuple[float, ...] | None:
        return _read_numbers(self.element, "rpy", count=3, default=_ZERO)

    def get_attribute(self, name: str) -> Attribute | None:
        return None if self.element is None else self.element.attributes.get(name)

    @cached_property
    def placement(self) -> Placement | None:
        """Child to parent; None when a number is malformed. ``quat_xyzw`` applies where ``rpy`` is absent."""
        xyz, rpy = self.xyz, self.rpy
        if xyz is None or rpy is None:
            return None
        x, y, z = xyz
        if self.get_attribute("quat_xyzw") is None or self.get_attribute("rpy") is not None:
            return Placement(make_rotation(rpy), (x, y, z))
        quaternion = _read_numbers(self.element, "quat_xyzw", count=4, default=())
        if quaternion is None or not any(quaternion):
            return None
        return Placement(make_quaternion_rotation(quaternion), (x, y, z))

    @cached_property
    def matrix(self) -> Array | None:
        """The `placement` as an array, 4x4."""
        from urdfcheck.facts.motion.kinematics import build_transform

        return None if self.placement is None else build_transform(self.placement)


@dataclass(frozen=True, eq=False)
class Inertial:
    """An ``<inertial>``: mass in kg, COM in metres in the link frame, inertia tensor in kg m² about the COM."""

    element: Element

    @cached_property
    def origin(self) -> Pose:
        return Pose(self.element.find_child("origin"))

    @property
    def mass(self) -> float | None:
        value = read_attribute_number(self.element.find_child("mass"), "value")
        return value if value is not None and is_computable(value) else None

    @property
    def mass_attribute(self) -> Attribute | None:
        mass = self.element.find_child("mass")
        return None if mass is None else mass.attributes.get("value")

    @property
    def tensor_element(self) -> Element | None:
        return self.element.find_child("inertia")

    @cached_property
    def inertia_components(self) -> tuple[float, ...] | None:
        """ixx ixy ixz iyy iyz izz as typed; None unless all six are numbers."""
        values = [_read_number(self.tensor_element, name) for name in TENSOR_NAMES]
        return None if any(v is None for v in values) else tuple(v for v in values if v is not None)

    @cached_property
    def moments(self) -> Vector | None:
        """The principal moments, ascending."""
        return None if self.inertia_components is None else compute_moments(make_tensor(self.inertia_components))

    @cached_property
    def tensor(self) -> Array | None:
        """3x3 about the COM in the axes of the inertial frame (before its rpy)."""
        import numpy as np

        if self.inertia_components is None:
            return None
        xx, xy, xz, yy, yz, zz = self.inertia_components
        return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])

    @cached_property
    def tensor_in_link(self) -> Array | None:
        """3x3 about the COM in the axes of the link frame (after the inertial frame's rpy)."""
        if self.tensor is None or self.origin.matrix is None:
            return None
        rotation = self.origin.matrix[:3, :3]
        turned: Array = rotation @ self.tensor @ rotation.T
        return turned

    @property
    def location(self) -> Location:
        return self.element.location


@dataclass(frozen=True, eq=False)
class Shape:
    """A ``<visual>`` or ``<collision>``."""

    element: Element
    role: str

    @cached_property
    def origin(self) -> Pose:
        return Pose(self.element.find_child("origin"))

    @cached_property
    def geometry_element(self) -> Element | None:
        """The element inside ``<geometry>``."""
        geometry = self.element.find_child("geometry")
        if geometry is None:
            return None
        return next((c for c in geometry.children if c.tag in GEOMETRY_TAGS), None)

    @property
    def kind(self) -> str | None:
        """The tag inside ``<geometry>``; None when it holds no known one."""
        return None if self.geometry_element is None else self.geometry_element.tag

    @cached_property
    def size(self) -> tuple[float, ...] | None:
        """Metres: box x y z; cylinder, capsule radius length; sphere radius; mesh: its scale. None when malformed."""
        if self.geometry_element is None:
            return None
        if self.kind == "box":
            return _read_numbers(self.geometry_element, "size", count=3, default=()) or None
        if self.kind == "mesh":
            return _read_numbers(self.geometry_element, "scale", count=3, default=(1.0, 1.0, 1.0))
        names = ("radius",) if self.kind == "sphere" else ("radius", "length")
        values = [_read_number(self.geometry_element, n) for n in names]
        return None if any(v is None for v in values) else tuple(v for v in values if v is not None)

    @property
    def mesh_filename(self) -> Attribute | None:
        """The ``filename`` of a mesh."""
        return (
            self.geometry_element.attributes.get("filename")
            if self.geometry_element is not None and self.kind == "mesh"
            else None
        )

    @property
    def location(self) -> Location:
        return self.element.location


def is_dummy_shape(shape: Shape) -> bool:
    """Whether a shape is a primitive too small to be meant as a part."""
    size = shape.size
    return shape.kind != "mesh" and size is not None and max(map(abs, size)) <= MAX_DUMMY_SIZE


def locate_geometry(shape: Shape) -> Location:
    """Return where the geometry of a shape is typed: the name of its mesh, or the primitive."""
    return (
        shape.mesh_filename.location
        if shape.mesh_filename is not None
        else (shape.geometry_element or shape.element).location
    )


@dataclass(frozen=True, eq=False)
class Link:
    """A ``<link>``."""

    element: Element

    @property
    def name(self) -> str:
        return self.element.get("name")

    @cached_property
    def inertial(self) -> Inertial | None:
        element = self.element.find_child("inertial")
        return None if element is None else Inertial(element)

    @cached_property
    def visuals(self) -> tuple[Shape, ...]:
        return tuple(Shape(e, "visual") for e in self.element.find_children("visual"))

    @cached_property
    def collisions(self) -> tuple[Shape, ...]:
        return tuple(Shape(e, "collision") for e in self.element.find_children("collision"))

    @property
    def location(self) -> Location:
        return self.element.location


def has_drawn_shape(link: Link) -> bool:
    """Whether a link has a shape that is meant as a part."""
    return any(not is_dummy_shape(shape) for shape in (*link.visuals, *link.collisions))


@dataclass(frozen=True, slots=True, eq=False)
class DeclaredMass:
    """The mass of a link that is typed as a number."""

    link: Link
    inertial: Inertial
    mass: float
    """kg, possibly zero or negative."""
    attribute: Attribute
    """The ``value`` of ``<mass>``."""

    @classmethod
    def from_link(cls, link: Link) -> DeclaredMass | None:
        """Return the mass of a link, or None if it is missing or malformed."""
        inertial = link.inertial
        if inertial is None or inertial.mass is None or inertial.mass_attribute is None:
            return None
        return cls(link=link, inertial=inertial, mass=inertial.mass, attribute=inertial.mass_attribute)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class DeclaredTensor:
    """The inertia tensor of a link whose six components are typed as numbers."""

    link: Link
    inertial: Inertial
    element: Element
    """The ``<inertia>``."""
    components: tuple[float, ...]
    """ixx ixy ixz iyy iyz izz in kg m²."""

    @property
    def tensor(self) -> Array:
        """(3, 3) in kg m² about the COM, in the axes of the inertial frame."""
        return _get_known(self.inertial.tensor)

    @property
    def moments(self) -> Vector:
        """The principal moments in kg m², ascending."""
        return _get_known(self.inertial.moments)

    @property
    def texts(self) -> list[str]:
        """The six components as typed."""
        return [self.element.get(name) for name in TENSOR_NAMES]

    def get_attribute(self, index: int) -> Attribute:
        """Return the attribute of a component."""
        return self.element.attributes[TENSOR_NAMES[index]]

    @classmethod
    def from_link(cls, link: Link) -> DeclaredTensor | None:
        """Return the tensor of a link, or None if a component is missing or malformed."""
        inertial = link.inertial
        if inertial is None or inertial.tensor_element is None or inertial.inertia_components is None:
            return None
        return cls(
            link=link,
            inertial=inertial,
            element=inertial.tensor_element,
            components=inertial.inertia_components,
        )


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class CompleteInertial(DeclaredTensor):
    """The inertial of a link whose mass, pose and tensor are all typed as numbers."""

    mass: float
    """kg, possibly zero or negative."""
    placement: Placement
    """From the inertial frame to the link frame: the COM in m and the axes."""

    @property
    def pose(self) -> Array:
        """(4, 4), the `placement`."""
        return _get_known(self.inertial.origin.matrix)

    @property
    def tensor_in_link(self) -> Array:
        """(3, 3) in kg m² about the COM, in the axes of the link frame."""
        return _get_known(self.inertial.tensor_in_link)

    @classmethod
    def from_tensor(cls, declared: DeclaredTensor) -> CompleteInertial | None:
        """Complete a tensor by mass and pose; None if one of them is missing or malformed."""
        inertial = declared.inertial
        if inertial.mass is None or inertial.origin.placement is None:
            return None
        return cls(
            link=declared.link,
            inertial=inertial,
            element=declared.element,
            components=declared.components,
            mass=inertial.mass,
            placement=inertial.origin.placement,
        )


@dataclass(frozen=True, eq=False)
class Joint:
    """A ``<joint>`` that is a child of ``<robot>``."""

    element: Element

    @property
    def name(self) -> str:
        return self.element.get("name")

    @property
    def type(self) -> str:
        return self.element.get("type")

    @property
    def is_movable(self) -> bool:
        return self.type in MOVING_TYPES

    @property
    def has_axis(self) -> bool:
        """Whether this type of joint has an axis at all."""
        return self.type in {"revolute", "continuous", "prismatic", "planar"}

    @cached_property
    def parent(self) -> str:
        element = self.element.find_child("parent")
        return "" if element is None else element.get("link")

    @cached_property
    def child(self) -> str:
        element = self.element.find_child("child")
        return "" if element is None else element.get("link")

    @property
    def child_attribute(self) -> Attribute | None:
        """The ``link`` of ``<child>``."""
        element = self.element.find_child("child")
        return None if element is None else element.attributes.get("link")

    @property
    def child_location(self) -> Location:
        """Where the child is named; the joint if it names none."""
        return self.location if self.child_attribute is None else self.child_attribute.location

    @cached_property
    def origin(self) -> Pose:
        return Pose(self.element.find_child("origin"))

    @property
    def axis_element(self) -> Element | None:
        return self.element.find_child("axis")

    @cached_property
    def axis(self) -> tuple[float, ...] | None:
        """As typed in the joint frame; (1, 0, 0) when absent; None when malformed."""
        return _read_numbers(self.axis_element, "xyz", count=3, default=(1.0, 0.0, 0.0))

    @property
    def axis_location(self) -> Location:
        """Where the axis is typed; the joint where it is absent."""
        element = self.axis_element
        if element is None:
            return self.location
        attribute = element.attributes.get("xyz")
        return element.location if attribute is None else attribute.location

    @cached_property
    def limit(self) -> Element | None:
        return self.element.find_child("limit")

    def get_limit_value(self, name: str) -> float | None:
        """Return ``lower``, ``upper`` (default 0), ``effort`` or ``velocity`` of ``<limit>``; None without it or malformed."""
        if self.limit is not None and name not in self.limit.attributes and name in {"lower", "upper"}:
            return 0.0
        return read_attribute_number(self.limit, name)

    @property
    def has_room(self) -> bool:
        """Whether it moves: not where it is fixed, where its limits leave no room, or where it is held."""
        lower, upper = self.get_limit_value("lower"), self.get_limit_value("upper")
        is_limited = self.type in {"revolute", "prismatic"} and self.limit is not None and lower is not None
        return self.is_movable and not (is_limited and lower == upper) and not self.is_held

    @property
    def position_range(self) -> tuple[float, float] | None:
        """Lower and upper limit of a revolute (rad) or prismatic (m) joint; None if malformed, or if lower is not below upper."""
        lower, upper = self.get_limit_value("lower"), self.get_limit_value("upper")
        if self.type not in {"revolute", "prismatic"} or lower is None or upper is None or lower >= upper:
            return None
        return lower, upper

    @property
    def is_held(self) -> bool:
        """Whether a range leaves about no room, as that of a joint that is locked where it stands."""
        span = self.position_range
        return span is not None and span[1] - span[0] < _HELD_RANGE[self.position_unit]

    @property
    def position_unit(self) -> str:
        """The unit of the joint's position: ``m`` or ``rad``."""
        return "m" if self.type == "prismatic" else "rad"

    @property
    def is_driven(self) -> bool:
        """Whether its own motor moves it and it has a ``<limit>``; a follower's motor is its leader's."""
        return self.type in {"revolute", "continuous", "prismatic"} and self.limit is not None and self.mimic is None

    @property
    def mimic(self) -> Element | None:
        return self.element.find_child("mimic")

    @property
    def mimic_coefficients(self) -> tuple[float, float] | None:
        """Multiplier and offset of ``<mimic>``; None without it or malformed."""
        mimic = self.mimic
        values = [
            read_attribute_number(mimic, name) if mimic is not None and name in mimic.attributes else default
            for name, default in (("multiplier", 1.0), ("offset", 0.0))
        ]
        return None if mimic is None or values[0] is None or values[1] is None else (values[0], values[1])

    @property
    def location(self) -> Location:
        return self.element.location


def _get_known(value: _T | None) -> _T:
    """Return what `DeclaredTensor.from_link` or `CompleteInertial.from_tensor` found to be known."""
    assert value is not None
    return value


def _read_numbers(
    element: Element | None, name: str, *, count: int, default: tuple[float, ...]
) -> tuple[float, ...] | None:
    """Read the numbers of an attribute to compute with, see `_filter_computable`."""
    values = read_attribute_numbers(element, name, count=count, default=default)
    known = [_filter_computable(v) for v in values or ()]
    return None if values is None or None in known else tuple(v for v in known if v is not None)


def _read_number(element: Element | None, name: str) -> float | None:
    """Read the number of an attribute to compute with, see `_filter_computable`."""
    value = read_attribute_number(element, name)
    return None if value is None else _filter_computable(value)


def _filter_computable(value: float) -> float | None:
    """Return None for a number that is too large, 0 for one too small to distinguish from it (residues of an export)."""
    if is_computable(value):
        return value
    return None if abs(value) > MAX_MAGNITUDE else 0.0
