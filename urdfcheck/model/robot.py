"""The robot that checks see: links, joints, tree and meshes. A `fact` is computed beside the physics that it belongs to."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import field
from functools import cached_property
from typing import TYPE_CHECKING, Any

from urdfcheck.core import FactUnavailableError, Location
from urdfcheck.core.records import dataclass
from urdfcheck.facts.small_matrices import UNMOVED, Placement
from urdfcheck.model.fact import fact
from urdfcheck.model.meshes import ModelMeshes
from urdfcheck.model.parts import CompleteInertial, DeclaredMass, DeclaredTensor, Joint, Link
from urdfcheck.model.tree import Tree
from urdfcheck.source.load import Source
from urdfcheck.source.package.finder import Package
from urdfcheck.source.text.xml import Element
from urdfcheck.system.array_cache import ArrayCache

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array

# Why a check that needs a simulator did not run, where none may be started.
NO_SIMULATOR = "needs a simulator: --target mujoco, or urdfcheck drop"


@dataclass(frozen=True, eq=False, kw_only=True)
class Model:
    """A robot."""

    source: Source
    """The files it was read from."""
    robot: Element
    """The expanded root element."""
    tier: str = "full"
    """Which facts may be computed: source | mesh | full."""
    cache: ArrayCache = field(default_factory=ArrayCache)
    """Keeps between runs what took long to compute."""
    samples: int = 200
    """Number of joint configurations that facts about motion sample."""
    targets: tuple[str, ...] = ()
    """The programs that the model is declared to be for."""
    mesh_limits: Mapping[str, float] = field(default_factory=dict)
    """The options of MSH008 that are configured: from when on a mesh has a wrong size."""
    simulation: str = "none"
    """How long a simulator may run: none | brief, as part of a check | full."""
    base: str = "auto"
    """How a simulator holds the base: auto | fixed | free."""
    memo: dict[Hashable, Any] = field(default_factory=dict, repr=False)
    """What `fact` remembers."""

    @property
    def name(self) -> str:
        return self.robot.get("name")

    @property
    def package(self) -> Package | None:
        return self.source.package

    @property
    def location(self) -> Location:
        return self.robot.location

    @property
    def name_location(self) -> Location:
        """The robot's name, or the robot if it has none."""
        name = self.robot.attributes.get("name")
        return self.location if name is None else name.location

    @cached_property
    def links(self) -> tuple[Link, ...]:
        return tuple(Link(e) for e in self.robot.find_children("link"))

    @cached_property
    def joints(self) -> tuple[Joint, ...]:
        """The joints of the kinematic tree (not those named inside transmissions or ros2_control)."""
        return tuple(Joint(e) for e in self.robot.find_children("joint"))

    @cached_property
    def named_elements(self) -> tuple[Link | Joint, ...]:
        """All links, then all joints."""
        return (*self.links, *self.joints)

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

    @cached_property
    def masses(self) -> tuple[DeclaredMass, ...]:
        """The masses that are typed as numbers, in the order of the links."""
        return tuple(mass for link in self.links if (mass := DeclaredMass.from_link(link)) is not None)

    @cached_property
    def mass_by_name(self) -> Mapping[str, DeclaredMass]:
        """The first of `masses` for each link name."""
        found: dict[str, DeclaredMass] = {}
        for declared in self.masses:
            found.setdefault(declared.link.name, declared)
        return found

    @cached_property
    def tensors(self) -> tuple[DeclaredTensor, ...]:
        """The inertia tensors that are typed as numbers, in the order of the links."""
        return tuple(tensor for link in self.links if (tensor := DeclaredTensor.from_link(link)) is not None)

    @cached_property
    def tensor_by_name(self) -> Mapping[str, DeclaredTensor]:
        """The first of `tensors` for each link name."""
        found: dict[str, DeclaredTensor] = {}
        for declared in self.tensors:
            found.setdefault(declared.link.name, declared)
        return found

    @cached_property
    def inertials(self) -> tuple[CompleteInertial, ...]:
        """The inertials whose mass, pose and tensor are all typed as numbers, in the order of the links."""
        return tuple(
            whole for declared in self.tensors if (whole := CompleteInertial.from_tensor(declared)) is not None
        )

    @property
    def tree(self) -> Tree:
        """The kinematic tree.

        :raises FactUnavailableError: when links and joints do not form one tree (the KIN rules say why).
        """
        return _build_tree(self)

    @property
    def pieces(self) -> Tree:
        """The kinematic tree, or its pieces where joints name links that do not exist or links are in several trees.

        For what can be said of one rigid body alone.

        :raises FactUnavailableError: when the pieces are not trees.
        """
        return _build_pieces(self)

    @property
    def placements(self) -> Mapping[str, Placement]:
        """Placement of each link's frame in the root link's frame, all joints at zero.

        :raises FactUnavailableError: when the tree is broken or an origin is malformed.
        """
        return _compute_placements(self)

    @property
    def piece_placements(self) -> Mapping[str, Placement]:
        """The `placements`; in a robot in pieces those in the root of each link's piece, which place the links of one body.

        :raises FactUnavailableError: when the pieces are not trees or an origin is malformed.
        """
        return _compute_piece_placements(self)

    @property
    def frames(self) -> Mapping[str, Array]:
        """The `placements` as arrays, 4x4.

        :raises FactUnavailableError: as there.
        """
        return _build_frames(self)

    @property
    def piece_frames(self) -> Mapping[str, Array]:
        """The `piece_placements` as arrays, 4x4.

        :raises FactUnavailableError: as there.
        """
        return _build_piece_frames(self)

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


@fact
def _build_tree(model: Model) -> Tree:
    return Tree.build(model.links, model.joints)


@fact
def _build_pieces(model: Model) -> Tree:
    try:
        return model.tree
    except FactUnavailableError:
        return Tree.build_pieces(model.links, model.joints)


@fact
def _compute_placements(model: Model) -> Mapping[str, Placement]:
    return _place_links(model.tree)


@fact
def _compute_piece_placements(model: Model) -> Mapping[str, Placement]:
    try:
        _ = model.tree
    except FactUnavailableError:
        return _place_links(model.pieces)
    return model.placements


@fact
def _build_frames(model: Model) -> Mapping[str, Array]:
    from urdfcheck.facts.motion.kinematics import build_transform

    return {name: build_transform(placement) for name, placement in model.placements.items()}


@fact
def _build_piece_frames(model: Model) -> Mapping[str, Array]:
    from urdfcheck.facts.motion.kinematics import build_transform

    return {name: build_transform(placement) for name, placement in model.piece_placements.items()}


def _place_links(tree: Tree) -> Mapping[str, Placement]:
    """Return the placement of each link in the root of its tree, all joints at zero.

    :raises FactUnavailableError: when an origin is malformed.
    """
    placements: dict[str, Placement] = {}
    for name in tree.order:
        joint = tree.parent_joint.get(name)
        if joint is None:
            placements[name] = UNMOVED
            continue
        origin = joint.origin.placement
        if origin is None:
            raise FactUnavailableError(f"the origin of joint {joint.name} is malformed")
        placements[name] = placements[joint.parent].carry(origin)
    return placements
