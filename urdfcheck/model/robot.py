"""The facade that checks see: a robot with lazy facts. Heavy libraries load when a fact first needs them."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

from urdfcheck.core import Location, Span, Unavailable
from urdfcheck.model.meshes import Meshes
from urdfcheck.model.parts import Joint, Link, Shape
from urdfcheck.model.tree import Tree
from urdfcheck.source.load import Source
from urdfcheck.source.package.finder import Package
from urdfcheck.source.text.xml import Element
from urdfcheck.system.array_cache import Cache

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from urdfcheck.core.drop_test import Drop
    from urdfcheck.facts.inertials.diagnosis import Geometry
    from urdfcheck.facts.inertials.inertia_tensor import Solid
    from urdfcheck.model.ground.wheels import Wheel
    from urdfcheck.model.inertials.inertia_diagnosis import Judged
    from urdfcheck.model.inertials.inertial_hull import Enclosed
    from urdfcheck.model.likeness.identical_parts import Copy
    from urdfcheck.model.likeness.mirror_pairs import Pair
    from urdfcheck.model.motion.collisions import Collisions
    from urdfcheck.model.motion.pinocchio_model import Dynamics, Verdict
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
    simulated: bool = False

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
        return tuple(Link(e) for e in self.robot.all("link"))

    @cached_property
    def joints(self) -> tuple[Joint, ...]:
        """The joints of the kinematic tree (not those named inside transmissions or ros2_control)."""
        return tuple(Joint(e) for e in self.robot.all("joint"))

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
        if isinstance(self._tree, Unavailable):
            raise self._tree.with_traceback(None)
        return self._tree

    @cached_property
    def _tree(self) -> Tree | Unavailable:
        """That there is none is found once as well: every link asks."""
        try:
            return Tree.build(self.links, self.joints)
        except Unavailable as reason:
            return reason

    @property
    def frames(self) -> Mapping[str, NDArray[np.float64]]:
        """4x4 placement of each link's frame in the root link's frame, all joints at zero.

        :raises Unavailable: when the tree is broken or an origin is malformed.
        """
        if isinstance(self._frames, Unavailable):
            raise self._frames.with_traceback(None)
        return self._frames

    @cached_property
    def _frames(self) -> Mapping[str, NDArray[np.float64]] | Unavailable:
        from urdfcheck.facts.motion.kinematics import forward

        if isinstance(self._tree, Unavailable):
            return self._tree

        order = self.tree.order
        index = {name: i for i, name in enumerate(order)}
        import numpy as np

        parents, placements = [-1], [np.eye(4)]
        for name in order[1:]:
            joint = self.tree.parent_joint[name]
            matrix = joint.origin.matrix
            if matrix is None:
                return Unavailable(f"the origin of joint {joint.name!r} is malformed")
            parents.append(index[joint.parent])
            placements.append(matrix)
        world = forward(parents, np.array(placements))
        return dict(zip(order, world, strict=True))

    @cached_property
    def axes(self) -> Mapping[str, NDArray[np.float64]]:
        """Unit axis in root coordinates of each joint that has one, by joint name, all joints at zero."""
        import numpy as np

        found: dict[str, NDArray[np.float64]] = {}
        for joint in self.joints:
            axis = joint.axis
            if not joint.has_axis or axis is None:
                continue
            norm = float(np.linalg.norm(axis))
            if norm > 0 and joint.child in self.frames:
                found[joint.name] = self.frames[joint.child][:3, :3] @ (np.array(axis) / norm)
        return found

    @cached_property
    def meshes(self) -> Meshes:
        """Every mesh that the model draws or collides with, resolved, and read once per content."""
        return Meshes.of(self.links, self.source, self.cache, read=self.tier != "source")

    def drawn_scale(self, shape: Shape) -> tuple[float, float, float] | None:
        """Metres per file unit along the mesh's axes, as RViz and Gazebo draw it: the URDF scale times COLLADA's unit.

        None when the shape is no mesh that could be read, or its scale is malformed.
        """
        facts, scale = self.meshes.facts_of(shape), shape.size
        if facts is None or scale is None or len(scale) != 3:
            return None
        unit = 1.0 if facts.unit is None else facts.unit
        return scale[0] * unit, scale[1] * unit, scale[2] * unit

    @cached_property
    def verdict(self) -> Verdict:
        """What the reference parser says about the model.

        :raises Unavailable: as :attr:`dynamics`.
        """
        from urdfcheck.model.motion.pinocchio_model import verdict

        return verdict(self)

    @cached_property
    def dynamics(self) -> Dynamics:
        """The model in Pinocchio.

        :raises Unavailable: when Pinocchio is not installed (Windows) or the model must not be handed to it.
        """
        from urdfcheck.model.motion.pinocchio_model import build

        return build(self)

    @cached_property
    def collisions(self) -> Collisions:
        """Which links collide with each other.

        :raises Unavailable: when coal is not installed (Windows), or the tree, an origin or an axis is broken.
        """
        from urdfcheck.model.motion.collisions import build

        return build(self)

    @property
    def drop(self) -> Drop:
        """What comes of the robot when it is set on a plane and let go.

        :raises Unavailable: where no simulator may be started, or as `urdfcheck.model.motion.simulated_drop.dropped`.
        """
        if not self.simulated:
            raise Unavailable("needs a simulator: urdfcheck drop")
        if isinstance(self._drop, Unavailable):
            raise self._drop.with_traceback(None)
        return self._drop

    @cached_property
    def _drop(self) -> Drop | Unavailable:
        from urdfcheck.model.motion.simulated_drop import dropped

        try:
            return dropped(self)
        except Unavailable as reason:
            return reason

    @cached_property
    def geometries(self) -> dict[object, Geometry | None]:
        """What `urdfcheck.model.shapes.visual_solid.geometry` has measured of this model."""
        return {}

    @cached_property
    def computed(self) -> dict[tuple[str, Hashable], Any]:
        """What many links share and each of them asks for: by its name, and what it is of."""
        return {}

    @cached_property
    def written_alike(self) -> Mapping[Span | None, list[Link]]:
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
        from urdfcheck.model.likeness.sibling_joints import siblings

        return siblings(self)

    @cached_property
    def copies(self) -> tuple[tuple[Copy, ...], ...]:
        """Groups of links that draw one part.

        :raises Unavailable: when the tree is broken.
        """
        from urdfcheck.model.likeness.identical_parts import copies

        return copies(self)

    @cached_property
    def wheels(self) -> tuple[Wheel, ...]:
        """All wheels that can stand on the ground.

        :raises Unavailable: when the tree is broken or an origin is malformed.
        """
        from urdfcheck.model.ground.wheels import rolling

        return rolling(self)

    @cached_property
    def pairs(self) -> tuple[Pair, ...]:
        """The left and the right of the robot: links that are each other's mirror image.

        :raises Unavailable: when the tree is broken or an origin is malformed.
        """
        from urdfcheck.model.likeness.mirror_pairs import pairs

        return pairs(self)

    @cached_property
    def diagnoses(self) -> Mapping[str, Judged]:
        """What is wrong with the inertial of each link, by name."""
        from urdfcheck.model.inertials.inertia_diagnosis import diagnoses

        return diagnoses(self)

    @cached_property
    def enclosed(self) -> tuple[Enclosed, ...]:
        """The inertials of links that are bodies, each with all that is drawn round it.

        :raises Unavailable: when the tree is broken or an origin is malformed.
        """
        from urdfcheck.model.inertials.inertial_hull import enclosed

        return tuple(enclosed(self))

    @cached_property
    def srdfs(self) -> tuple[Srdf, ...]:
        """The semantic descriptions (SRDF) in reach that are for a robot of this name."""
        from urdfcheck.source.ros.srdf import srdfs_of

        return srdfs_of(self.source, self.name)

    def solid(self, link: Link, role: str = "visual") -> Solid | None:
        """Volume, COM and second moments of what a link draws (or collides with), in the link frame.

        None when it has no such shape, or one whose volume is not known (an unread or open mesh).
        """
        from urdfcheck.facts.inertials.inertia_tensor import combine

        shapes = link.visuals if role == "visual" else link.collisions
        solids = [self.shape_solid(shape) for shape in shapes]
        known = [s for s in solids if s is not None]
        return combine(known) if known and len(known) == len(solids) else None

    def shape_solid(self, shape: Shape) -> Solid | None:
        """Like :meth:`solid` for one shape."""
        import numpy as np

        from urdfcheck.facts.inertials import inertia_tensor as inertia
        from urdfcheck.facts.mesh.measure import transformed_moments

        size, pose = shape.size, shape.origin.matrix
        if size is None or pose is None or any(s == 0 for s in size):
            return None
        if shape.kind == "mesh":
            facts = self.meshes.facts_of(shape)
            if facts is None or not facts.closed or not np.isfinite(facts.com).all():
                return None
            return transformed_moments(facts, size, pose[:3, :3], pose[:3, 3])
        if any(s < 0 for s in size):
            return None
        made = {
            "box": lambda: inertia.box_solid(size),
            "cylinder": lambda: inertia.cylinder_solid(*size),
            "sphere": lambda: inertia.sphere_solid(*size),
            "capsule": lambda: inertia.capsule_solid(*size),
        }[shape.kind or ""]()
        return inertia.placed(made, pose[:3, :3], pose[:3, 3])
