"""What Gazebo makes of the links that fixed joints hold together: sdformat merges them into one, and tells the settings of
`<gazebo reference="…">` blocks by the names that their shapes get.

Source: sdformat, parser_urdf.cc (ReduceFixedJoints, CreateCollisions, CreateCollision, InsertSDFExtensionCollision), and the
same for visuals; alike in all versions from 4 (Gazebo Classic) on.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from urdfcheck.model.parts import Joint, Link
from urdfcheck.model.robot import Model
from urdfcheck.source.text.xml import Element

PRESERVE = ("preserveFixedJoint", "disableFixedJointLumping")
_LUMP = "_fixed_joint_lump__"


@dataclass(frozen=True, slots=True, eq=False)
class MergedShape:
    """A shape of ``link`` (its owner in the URDF) under the ``name`` that it has in the SDF link ``body``."""

    element: Element
    link: str
    body: str
    name: str
    suffix: str

    def is_reached_by(self, reference: str) -> bool:
        """Whether the surface settings of a block with this reference arrive at the shape."""
        if reference == self.body:
            return _LUMP not in self.name
        return f"{_LUMP}{reference}{self.suffix}" in self.name


@dataclass(frozen=True, slots=True, eq=False)
class FixedJointReduction:
    """``body`` is the link that each link is a part of in SDF, itself where it stays one. ``collisions`` and ``visuals``:
    every shape under its name in SDF."""

    body_by_link: Mapping[str, str]
    collisions: tuple[MergedShape, ...]
    visuals: tuple[MergedShape, ...]


def reduce_fixed_joints(model: Model) -> FixedJointReduction:
    """:raises Unavailable: when the links are not one tree."""
    tree, kept = model.tree, find_preserved_names(model)
    body: dict[str, str] = {}
    for name in tree.order:
        joint = tree.parent_joint.get(name)
        body[name] = body[joint.parent] if joint is not None and is_merged_joint(joint, kept) else name
    members: dict[str, list[Link]] = {}
    for name in _list_links_outwards(model):
        members.setdefault(body[name], []).append(model.link_by_name[name])
    return FixedJointReduction(body, _name_merged_shapes(members, "collision"), _name_merged_shapes(members, "visual"))


def is_merged_joint(joint: Joint, preserved_names: Mapping[str, Element]) -> bool:
    """Whether sdformat makes its two links one. Below a link called world it does not."""
    return joint.type == "fixed" and joint.name not in preserved_names and joint.parent != "world"


def find_preserved_names(model: Model) -> Mapping[str, Element]:
    """The names that a `<gazebo>` block asks to keep from being merged, with the element that says so."""
    found: dict[str, Element] = {}
    for block in model.robot.find_children("gazebo"):
        for child in block.children:
            if child.tag in PRESERVE and is_true_flag(child):
                found.setdefault(block.get("reference"), child)
    return found


def is_true_flag(element: Element) -> bool:
    """A flag as sdformat reads it: true, yes or 1, as the text or the attribute ``value``."""
    return (element.get("value") or element.text).strip().lower() in {"true", "yes", "1"}


def _list_links_outwards(model: Model) -> list[str]:
    """The links in the order in which sdformat collects their shapes: each before what hangs on it, branch by branch.
    urdfdom keeps joints by name, so that is the order of the branches."""
    found: list[str] = []
    stack = [model.tree.root]
    while stack:
        name = stack.pop()
        found.append(name)
        joints = sorted(model.tree.child_joints[name], key=lambda joint: joint.name, reverse=True)
        stack.extend(joint.child for joint in joints)
    return found


def _name_merged_shapes(members: Mapping[str, Sequence[Link]], role: str) -> tuple[MergedShape, ...]:
    found: list[MergedShape] = []
    for body, links in members.items():
        shapes = [
            (link, shape) for link in links for shape in (link.collisions if role == "collision" else link.visuals)
        ]
        for number, (link, shape) in enumerate(shapes):
            name = (shape.element.get("name") or link.name) + f"_{role}" + (f"_{number}" if number else "")
            full = name if name.startswith(body) else f"{body}{_LUMP}{name}"
            found.append(MergedShape(shape.element, link.name, body, full, f"_{role}"))
    return tuple(found)
