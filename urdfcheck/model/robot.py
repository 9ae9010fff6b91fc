"""The facade that checks see: a robot with lazy facts. Heavy libraries load when a fact first needs them."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

from urdfcheck.core import FactUnavailableError, Location, Span
from urdfcheck.model.meshes import ModelMeshes
from urdfcheck.model.parts import Joint, Link, Shape
from urdfcheck.model.tree import Tree
from urdfcheck.source.load import Source
from urdfcheck.source.package.finder import Package
from urdfcheck.source.text.xml import Element
from urdfcheck.system.array_cache import Cache

if TYPE_CHECKING:
    from urdfcheck.core.drop_test import DropTest
    from urdfcheck.facts.arrays import Array
    from urdfcheck.facts.inertials.declared_and_drawn import VisualGeometry
    from urdfcheck.facts.inertials.inertia_tensor import Solid
    from urdfcheck.model.ground.wheels import Wheel
    from urdfcheck.model.inertials.inertia_diagnosis import DiagnosedInertial
    from urdfcheck.model.inertials.inertial_hull import EnclosedInertial
    from urdfcheck.model.likeness.identical_parts import PartCopy
    from urdfcheck.model.likeness.mirror_pairs import MirrorPair
    from urdfcheck.model.motion.collisions import SelfCollisions
    from urdfcheck.model.motion.pinocchio_model import ParserVerdict, PinocchioModel
    from urdfcheck.source.ros.srdf import Srdf


@dataclass(frozen=True, eq=False)
class Model:
    """A robot. ``robot`` is its expanded root element; ``tier`` says which facts may be computed, ``samples`` in how many
    configurations facts about motion are looked for, ``cache`` keeps what took long, and ``targets`` are the programs that
    the model is declared to be for; ``simulated``: whether a simulator may be started."""

    source: Source
    robot: Element
    tier: str = "full"
    cache: Cache = field(default_factory=Cache)
    samples: int = 200
    targets: tuple[str, ...] = ()
    may_simulate: bool = False

    @property
    def name(self) -> str:
        return self.robot.get("name")

    @property
    def package(self) -> Package | None:
        return self.source.package

    @property
    def location(self) -> Location:
        return self.robot.location

    @cached_property
    def links(self) -> tuple[Link, ...]:
        return tuple(Link(e) for e in self.robot.find_children("link"))

    @cached_property
    def joints(self) -> tuple[Joint, ...]:
        """The joints of the kinematic tree (not those named inside transmissions or ros2_control)."""
        return tuple(Joint(e) for e in self.robot.find_children("joint"))

    @cached_property
    def link_by_name(self) -> Mapping[str, Link]:
        """The first link of each name, as the reference parser would keep it."""
        found: dict[str, Link] = {}
        for link in self.links:
            found.setdefault(link.name, link)
        return found

    @cached_property
    def joint_by_name(self) -> Mapping[str, Joint]:
        found: dict[str, Joint] = {}
        for joint in self.joints:
            found.setdefault(joint.name, joint)
        return found

    @property
    def tree(self) -> Tree:
        """The kinematic tree.

        :raises Unavailable: when links and joints do not form one tree (the KIN rules say why).
        """
        if isinstance(self._tree, FactUnavailableError):
            raise self._tree.with_traceback(None)
        return self._tree

    @cached_property
    def _tree(self) -> Tree | FactUnavailableError:
        """That there is none is found once as well: every link asks."""
        try:
            return Tree.build(self.links, self.joints)
        except FactUnavailableError as reason:
            return reason

    @property
    def frames(self) -> Mapping[str, Array]:
        """4x4 placement of each link's frame in the root link's frame, all joints at zero.

        :raises Unavailable: when the tree is broken or an origin is malformed.
        """
        if isinstance(self._frames, FactUnavailableError):
            raise self._frames.with_traceback(None)
        return self._frames

    @cached_property
    def _frames(self) -> Mapping[str, Array] | FactUnavailableError:
        from urdfcheck.facts.motion.kinematics import compute_forward_kinematics

        if isinstance(self._tree, FactUnavailableError):
            return self._tree

        order = self.tree.order
        index = {name: i for i, name in enumerate(order)}
        import numpy as np

        parents, placements = [-1], [np.eye(4)]
        for name in order[1:]:
            joint = self.tree.parent_joint[name]
            matrix = joint.origin.matrix
            if matrix is None:
                return FactUnavailableError(f"the origin of joint {joint.name!r} is malformed")
            parents.append(index[joint.parent])
            placements.append(matrix)
        world = compute_forward_kinematics(parents, np.array(placements))
        return dict(zip(order, world, strict=True))

    @cached_property
    def axes(self) -> Mapping[str, Array]:
        """Unit axis in root coordinates of each joint that has one, by joint name, all joints at zero."""
        import numpy as np

        found: dict[str, Array] = {}
        for joint in self.joints:
            axis = joint.axis
            if not joint.has_axis or axis is None:
                continue
            norm = float(np.linalg.norm(axis))
            if norm > 0 and joint.child in self.frames:
                found[joint.name] = self.frames[joint.child][:3, :3] @ (np.array(axis) / norm)
        return found

    @cached_property
    def meshes(self) -> ModelMeshes:
        """Every mesh that the model draws or collides with, resolved, and read once per content."""
        return ModelMeshes.from_links(self.links, self.source, self.cache, read=self.tier != "source")

    def compute_drawn_scale(self, shape: Shape) -> tuple[float, float, float] | None:
        """Metres per file unit along the mesh's axes, as RViz and Gazebo draw it: the URDF scale times COLLADA's unit.

        None when the shape is no mesh that could be read, or its scale is malformed.
        """
        facts, scale = self.meshes.get_facts(shape), shape.size
        if facts is None or scale is None or len(scale) != 3:
            return None
        unit = 1.0 if facts.unit is None else facts.unit
        return scale[0] * unit, scale[1] * unit, scale[2] * unit

    @cached_property
    def verdict(self) -> ParserVerdict:
        """What the reference parser says about the model.

        :raises Unavailable: as :attr:`dynamics`.
        """
        from urdfcheck.model.motion.pinocchio_model import parser_verdict

        return parser_verdict(self)

    @cached_property
    def dynamics(self) -> PinocchioModel:
        """The model in Pinocchio.

        :raises Unavailable: when Pinocchio is not installed (Windows) or the model must not be handed to it.
        """
        from urdfcheck.model.motion.pinocchio_model import pinocchio_model

        return pinocchio_model(self)

    @cached_property
    def collisions(self) -> SelfCollisions:
        """Which links collide with each other.

        :raises Unavailable: when coal is not installed (Windows), or the tree, an origin or an axis is broken.
        """
        from urdfcheck.model.motion.collisions import self_collisions

        return self_collisions(self)

    @property
    def drop(self) -> DropTest:
        """What comes of the robot when it is set on a plane and let go.

        :raises Unavailable: where no simulator may be started, or as `urdfcheck.model.motion.simulated_drop.run_drop_test`.
        """
        if not self.may_simulate:
            raise FactUnavailableError("needs a simulator: urdfcheck drop")
        if isinstance(self._drop, FactUnavailableError):
            raise self._drop.with_traceback(None)
        return self._drop

    @cached_property
    def _drop(self) -> DropTest | FactUnavailableError:
        from urdfcheck.model.motion.simulated_drop import run_drop_test

        try:
            return run_drop_test(self)
        except FactUnavailableError as reason:
            return reason

    @cached_property
    def geometries(self) -> dict[object, VisualGeometry | None]:
        """What `urdfcheck.model.shapes.visual_solid.geometry` has measured of this model."""
        return {}

    @cached_property
    def computed(self) -> dict[tuple[str, Hashable], Any]:
        """What many links share and each of them asks for: by its name, and what it is of."""
        return {}

    @cached_property
    def links_by_inertial_span(self) -> Mapping[Span | None, list[Link]]:
        """The links whose inertials are one text, as a macro makes them."""
        found: dict[Span | None, list[Link]] = {}
        for link in self.links:
            if link.inertial is not None:
                found.setdefault(link.inertial.element.span, []).append(link)
        return found

    @cached_property
    def siblings(self) -> list[tuple[Joint, ...]]:
        """Groups of like joints.

        :raises Unavailable: when the tree is broken.
        """
        from urdfcheck.model.likeness.sibling_joints import sibling_joints

        return sibling_joints(self)

    @cached_property
    def copies(self) -> tuple[tuple[PartCopy, ...], ...]:
        """Groups of links that draw one part.

        :raises Unavailable: when the tree is broken.
        """
        from urdfcheck.model.likeness.identical_parts import part_copies

        return part_copies(self)

    @cached_property
    def wheels(self) -> tuple[Wheel, ...]:
        """All wheels that can stand on the ground.

        :raises Unavailable: when the tree is broken or an origin is malformed.
        """
        from urdfcheck.model.ground.wheels import rolling_wheels

        return rolling_wheels(self)

    @cached_property
    def pairs(self) -> tuple[MirrorPair, ...]:
        """The left and the right of the robot: links that are each other's mirror image.

        :raises Unavailable: when the tree is broken or an origin is malformed.
        """
        from urdfcheck.model.likeness.mirror_pairs import mirror_pairs

        return mirror_pairs(self)

    @cached_property
    def diagnoses(self) -> Mapping[str, DiagnosedInertial]:
        """What is wrong with the inertial of each link, by name."""
        from urdfcheck.model.inertials.inertia_diagnosis import inertial_diagnoses

        return inertial_diagnoses(self)

    @cached_property
    def enclosed(self) -> tuple[EnclosedInertial, ...]:
        """The inertials of links that are bodies, each with all that is drawn round it.

        :raises Unavailable: when the tree is broken or an origin is malformed.
        """
        from urdfcheck.model.inertials.inertial_hull import enclosed_inertials

        return tuple(enclosed_inertials(self))

    @cached_property
    def srdfs(self) -> tuple[Srdf, ...]:
        """The semantic descriptions (SRDF) in reach that are for a robot of this name."""
        from urdfcheck.source.ros.srdf import load_srdfs

        return load_srdfs(self.source, self.name)

    def measure_link_solid(self, link: Link, role: str = "visual") -> Solid | None:
        """Volume, COM and second moments of what a link draws (or collides with), in the link frame.

        None when it has no such shape, or one whose volume is not known (an unread or open mesh).
        """
        from urdfcheck.facts.inertials.inertia_tensor import combine_solids

        shapes = link.visuals if role == "visual" else link.collisions
        solids = [self.measure_shape_solid(shape) for shape in shapes]
        known = [s for s in solids if s is not None]
        return combine_solids(known) if known and len(known) == len(solids) else None

    def measure_shape_solid(self, shape: Shape) -> Solid | None:
        """Like :meth:`measure_link_solid` for one shape."""
        import numpy as np

        from urdfcheck.facts.inertials import inertia_tensor as inertia
        from urdfcheck.facts.mesh.measure import compute_mesh_solid

        size, pose = shape.size, shape.origin.matrix
        if size is None or pose is None or any(s == 0 for s in size):
            return None
        if shape.kind == "mesh":
            facts = self.meshes.get_facts(shape)
            if facts is None or not facts.closed or not np.isfinite(facts.com).all():
                return None
            return compute_mesh_solid(facts, size, pose[:3, :3], pose[:3, 3])
        if any(s < 0 for s in size):
            return None
        made = {
            "box": lambda: inertia.make_box_solid(size),
            "cylinder": lambda: inertia.make_cylinder_solid(*size),
            "sphere": lambda: inertia.make_sphere_solid(*size),
            "capsule": lambda: inertia.make_capsule_solid(*size),
        }[shape.kind or ""]()
        return inertia.transform_solid(made, pose[:3, :3], pose[:3, 3])
