"""Links, joints, inertials and shapes: thin located views of the expanded elements.

A value that the file spells wrongly, or that nothing can be computed with, is None here: the rule about numbers reports it,
every other rule abstains.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from urdfcheck.core import Location
from urdfcheck.source.text.values import LARGEST, attribute_number, attribute_numbers, computable
from urdfcheck.source.text.xml import Attribute, Element

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

MOVING_TYPES = frozenset({"revolute", "continuous", "prismatic", "floating", "planar"})
_ZERO = (0.0, 0.0, 0.0)
TENSOR = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
SHAPES = ("mesh", "box", "cylinder", "sphere", "capsule")


@dataclass(frozen=True, eq=False)
class Pose:
    """An ``<origin>``: ``xyz`` in metres, ``rpy`` in radians (fixed axes roll, pitch, yaw). Absent means identity."""

    element: Element | None

    @property
    def xyz(self) -> tuple[float, ...] | None:
        return _quantities(self.element, "xyz", 3, _ZERO)

    @property
    def rpy(self) -> tuple[float, ...] | None:
        return _quantities(self.element, "rpy", 3, _ZERO)

    def attribute(self, name: str) -> Attribute | None:
        return None if self.element is None else self.element.attributes.get(name)

    @cached_property
    def matrix(self) -> NDArray[np.float64] | None:
        """4x4, child to parent; None when a number is malformed. ``quat_xyzw`` counts where the rpy is absent."""
        from urdfcheck.facts.motion.kinematics import quaternion_to_matrix, transform

        xyz, rpy = self.xyz, self.rpy
        if xyz is None or rpy is None:
            return None
        placed = transform(xyz, rpy)
        if self.attribute("quat_xyzw") is not None and self.attribute("rpy") is None:
            quaternion = _quantities(self.element, "quat_xyzw", 4, ())
            if quaternion is None or not any(quaternion):
                return None
            placed[:3, :3] = quaternion_to_matrix(quaternion)
        return placed


@dataclass(frozen=True, eq=False)
class Inertial:
    """An ``<inertial>``: mass in kg, COM in metres in the link frame, inertia tensor in kg m² about the COM."""

    element: Element

    @cached_property
    def origin(self) -> Pose:
        return Pose(self.element.child("origin"))

    @property
    def mass(self) -> float | None:
        value = attribute_number(self.element.child("mass"), "value")
        return value if value is not None and computable(value) else None

    @property
    def mass_attribute(self) -> Attribute | None:
        mass = self.element.child("mass")
        return None if mass is None else mass.attributes.get("value")

    @property
    def tensor_element(self) -> Element | None:
        return self.element.child("inertia")

    @cached_property
    def six(self) -> tuple[float, ...] | None:
        """ixx ixy ixz iyy iyz izz as typed, None unless all six are numbers."""
        values = [_quantity(self.tensor_element, name) for name in TENSOR]
        return None if any(v is None for v in values) else tuple(v for v in values if v is not None)

    @cached_property
    def tensor(self) -> NDArray[np.float64] | None:
        """3x3 about the COM in the axes of the inertial frame (before its rpy)."""
        import numpy as np

        if self.six is None:
            return None
        xx, xy, xz, yy, yz, zz = self.six
        return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])

    @cached_property
    def tensor_in_link(self) -> NDArray[np.float64] | None:
        """3x3 about the COM in the axes of the link frame (after the inertial frame's rpy)."""
        if self.tensor is None or self.origin.matrix is None:
            return None
        rotation = self.origin.matrix[:3, :3]
        turned: NDArray[np.float64] = rotation @ self.tensor @ rotation.T
        return turned

    @property
    def location(self) -> Location:
        return self.element.location


@dataclass(frozen=True, eq=False)
class Shape:
    """A ``<visual>`` or ``<collision>``. ``kind`` is the tag inside ``<geometry>``, None when there is none that is known."""

    element: Element
    role: str

    @cached_property
    def origin(self) -> Pose:
        return Pose(self.element.child("origin"))

    @cached_property
    def shape(self) -> Element | None:
        """The element inside ``<geometry>``."""
        geometry = self.element.child("geometry")
        if geometry is None:
            return None
        return next((c for c in geometry.children if c.tag in SHAPES), None)

    @property
    def kind(self) -> str | None:
        return None if self.shape is None else self.shape.tag

    @cached_property
    def size(self) -> tuple[float, ...] | None:
        """Metres: box x y z; cylinder, capsule radius length; sphere radius; mesh: its scale. None when malformed."""
        if self.shape is None:
            return None
        if self.kind == "box":
            return _quantities(self.shape, "size", 3, ()) or None
        if self.kind == "mesh":
            return _quantities(self.shape, "scale", 3, (1.0, 1.0, 1.0))
        names = ("radius",) if self.kind == "sphere" else ("radius", "length")
        values = [_quantity(self.shape, n) for n in names]
        return None if any(v is None for v in values) else tuple(v for v in values if v is not None)

    @property
    def mesh(self) -> Attribute | None:
        """The ``filename`` of a mesh."""
        return self.shape.attributes.get("filename") if self.shape is not None and self.kind == "mesh" else None

    @property
    def location(self) -> Location:
        return self.element.location


@dataclass(frozen=True, eq=False)
class Link:
    """A ``<link>``."""

    element: Element

    @property
    def name(self) -> str:
        return self.element.get("name")

    @cached_property
    def inertial(self) -> Inertial | None:
        found = self.element.child("inertial")
        return None if found is None else Inertial(found)

    @cached_property
    def visuals(self) -> tuple[Shape, ...]:
        return tuple(Shape(e, "visual") for e in self.element.all("visual"))

    @cached_property
    def collisions(self) -> tuple[Shape, ...]:
        return tuple(Shape(e, "collision") for e in self.element.all("collision"))

    @property
    def location(self) -> Location:
        return self.element.location


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
    def moves(self) -> bool:
        return self.type in MOVING_TYPES

    @property
    def has_axis(self) -> bool:
        """Whether this type of joint has an axis at all."""
        return self.type in {"revolute", "continuous", "prismatic", "planar"}

    @property
    def parent(self) -> str:
        found = self.element.child("parent")
        return "" if found is None else found.get("link")

    @property
    def child(self) -> str:
        found = self.element.child("child")
        return "" if found is None else found.get("link")

    @cached_property
    def origin(self) -> Pose:
        return Pose(self.element.child("origin"))

    @property
    def axis_element(self) -> Element | None:
        return self.element.child("axis")

    @cached_property
    def axis(self) -> tuple[float, ...] | None:
        """As typed in the joint frame; (1, 0, 0) when absent; None when malformed."""
        return _quantities(self.axis_element, "xyz", 3, (1.0, 0.0, 0.0))

    @property
    def axis_location(self) -> Location:
        """Where the axis is typed; the joint where it is not."""
        element = self.axis_element
        if element is None:
            return self.location
        attribute = element.attributes.get("xyz")
        return element.location if attribute is None else attribute.location

    @property
    def limit(self) -> Element | None:
        return self.element.child("limit")

    def limit_value(self, name: str) -> float | None:
        """``lower``, ``upper`` (default 0), ``effort`` or ``velocity`` of ``<limit>``; None without it or malformed."""
        if self.limit is not None and name not in self.limit.attributes and name in {"lower", "upper"}:
            return 0.0
        return attribute_number(self.limit, name)

    @property
    def is_driven(self) -> bool:
        """Whether it moves by a motor of its own and has a ``<limit>``; a follower's motor is its leader's."""
        return self.type in {"revolute", "continuous", "prismatic"} and self.limit is not None and self.mimic is None

    @property
    def mimic(self) -> Element | None:
        return self.element.child("mimic")

    @property
    def location(self) -> Location:
        return self.element.location


def _quantities(element: Element | None, name: str, count: int, default: tuple[float, ...]) -> tuple[float, ...] | None:
    """The numbers of an attribute that is computed with, see `_computable`."""
    values = attribute_numbers(element, name, count, default)
    known = [_computable(v) for v in values or ()]
    return None if values is None or None in known else tuple(v for v in known if v is not None)


def _quantity(element: Element | None, name: str) -> float | None:
    """The number of an attribute that is computed with, see `_computable`."""
    value = attribute_number(element, name)
    return None if value is None else _computable(value)


def _computable(value: float) -> float | None:
    """None for a number that is too large, 0 for one that is too small to tell from it (residues of an export)."""
    if computable(value):
        return value
    return None if abs(value) > LARGEST else 0.0
