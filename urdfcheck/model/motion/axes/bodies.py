"""What the rigid bodies of a robot draw, with all joints at zero."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING

from urdfcheck.core.records import dataclass
from urdfcheck.facts.motion.collision_geometry import CollisionGeometry, PlacedGeometry
from urdfcheck.model.meshes import MEASURING_MODULES
from urdfcheck.model.motion.collisions.setup import describe_joint, make_geometry
from urdfcheck.model.parts import Joint, Shape, is_dummy_shape
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.mesh_sizes import is_usable_shape
from urdfcheck.model.shapes.solids import compute_drawn_scale
from urdfcheck.system.installation import compute_code_version, find_library_origin

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Mat4

# The modules and packages that decide a cached result.
_CODE_MODULES = (
    *MEASURING_MODULES,
    "urdfcheck.facts.likeness.round_surfaces",
    "urdfcheck.facts.motion.collision",
    "urdfcheck.facts.motion.collision_geometry",
    "urdfcheck.facts.motion.gaps",
    "urdfcheck.facts.motion.kinematics",
    "urdfcheck.model.shapes",
    "urdfcheck.model.motion.axes",
    "urdfcheck.model.motion.poses",
    "urdfcheck.model.tree",
)


@dataclass(frozen=True, slots=True, eq=False)
class BodyShape:
    """A shape that is known, at ``pose`` (4, 4) in root coordinates."""

    shape: Shape
    pose: Mat4


@dataclass(frozen=True, eq=False)
class DrawnBodies:
    """The rigid bodies of a robot; a body has the name of its first link."""

    model: Model
    roles: tuple[str, ...] = ("visuals", "collisions")
    """Which shapes count; the second ones where a body has none of the first."""

    @cached_property
    def shapes(self) -> dict[str, tuple[BodyShape, ...]]:
        """The shapes of each body; bodies without known shapes are left out."""
        found = {}
        for head in self.model.tree.order:
            if head == self.model.tree.root or self.model.tree.parent_joint[head].type != "fixed":
                shapes = self._collect(head)
                if shapes:
                    found[head] = shapes
        return found

    @cached_property
    def placed(self) -> dict[str, tuple[PlacedGeometry, ...]]:
        """The geometries of each body in root coordinates, owned by its number in `shapes`; equal shapes share one."""
        geometries: dict[str, CollisionGeometry] = {}
        placed: dict[str, tuple[PlacedGeometry, ...]] = {}
        for number, (head, shapes) in enumerate(self.shapes.items()):
            contents = [self._describe(one.shape) for one in shapes]
            for one, content in zip(shapes, contents, strict=True):
                if content not in geometries:
                    geometries[content] = make_geometry(self.model, one.shape)
            placed[head] = tuple(
                PlacedGeometry(geometries[content], number, one.pose)
                for one, content in zip(shapes, contents, strict=True)
            )
        return placed

    def get_parent(self, joint: Joint) -> str:
        """Return the body that holds a joint."""
        return self.model.tree.list_body_links(joint.parent)[0]

    def list_above(self, joint: Joint) -> list[str]:
        """List the bodies with shapes between the root and a joint, without the one that holds it."""
        path = self.model.tree.find_path_to(joint.parent)
        heads = dict.fromkeys(self.model.tree.list_body_links(one.parent)[0] for one in path)
        return [head for head in heads if head in self.shapes and head != self.get_parent(joint)]

    def list_below(self, joint: Joint) -> list[str]:
        """List the bodies with shapes that a joint moves, the nearest first."""
        return [head for head in self.shapes if joint in self.model.tree.find_path_to(head)]

    def is_complete(self, name: str) -> bool:
        """Whether all shapes of the body of a link are known."""
        names = self.model.tree.list_body_links(name)
        links = [self.model.link_by_name[name] for name in names]
        drawn = [shape for link in links for shape in (link.visuals or link.collisions) if not is_dummy_shape(shape)]
        known = {id(one.shape) for one in self.shapes.get(names[0], ())}
        return all(id(shape) in known for shape in drawn)

    def is_undrawn(self, name: str) -> bool:
        """Whether a link is a part that no one drew: a bracket."""
        link = self.model.link_by_name[name]
        return link.inertial is not None and not (link.visuals or link.collisions)

    def compute_key(self) -> str:
        """Return a digest of all that decides how the bodies fit and move."""
        words = [compute_code_version(*_CODE_MODULES, library=find_library_origin("coal"))]
        for head, placed in self.shapes.items():
            words += [f"{head} {self._describe(one.shape)} {one.pose.tolist()}" for one in placed]
        words += [f"{name} {self.is_complete(name)} {self.is_undrawn(name)}" for name in self.model.tree.order]
        words += [describe_joint(self.model.tree.parent_joint[name]) for name in self.model.tree.order[1:]]
        return hashlib.sha256("\0".join(words).encode()).hexdigest()

    def count_faces(self) -> int:
        """Count the triangles of all meshes, each as often as it is used."""
        facts = [
            self.model.meshes.get_facts(one.shape)
            for placed in self.shapes.values()
            for one in placed
            if one.shape.kind == "mesh"
        ]
        return sum(one.n_triangles for one in facts if one is not None)

    def _collect(self, head: str) -> tuple[BodyShape, ...]:
        model = self.model
        names = model.tree.list_body_links(head)
        for role in self.roles:
            found: list[BodyShape] = []
            for name in names:
                shapes: Sequence[Shape] = getattr(model.link_by_name[name], role)
                for shape in shapes:
                    pose = shape.origin.matrix
                    if pose is not None and not is_dummy_shape(shape) and is_usable_shape(model, shape):
                        found.append(BodyShape(shape, model.frames[name] @ pose))
            if found:
                return tuple(found)
        return ()

    def _describe(self, shape: Shape) -> str:
        use = self.model.meshes.by_shape.get(id(shape))
        path = None if use is None else use.resource.path
        file = None if path is None else self.model.meshes.compute_content_key(path)
        return f"{shape.kind} {compute_drawn_scale(self.model, shape) if shape.kind == 'mesh' else shape.size} {file}"
