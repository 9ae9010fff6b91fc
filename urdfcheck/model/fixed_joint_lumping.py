"""How Gazebo merges links that fixed joints connect.

sdformat makes them one link, and applies the settings of `<gazebo reference="…">` blocks by the names that it gives their
shapes.

Source: sdformat, parser_urdf.cc (ReduceFixedJoints, CreateCollisions, CreateCollision, InsertSDFExtensionCollision), and
the same for visuals; alike in all versions from 4 (Gazebo Classic) on.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from urdfcheck.core import FactUnavailableError
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import split_name_words
from urdfcheck.facts.inertials.engine_floors import GAZEBO_MERGES, GAZEBO_REFUSES
from urdfcheck.model.fact import fact
from urdfcheck.model.parts import Joint, Link
from urdfcheck.model.rigid_bodies import MergedBody, weigh_body
from urdfcheck.model.robot import Model
from urdfcheck.source.text.xml import Element

PRESERVE = ("preserveFixedJoint", "disableFixedJointLumping")
_LUMP = "_fixed_joint_lump__"


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class MergedShape:
    """A shape as sdformat names it after the merge."""

    element: Element
    link: str
    """Its owner in the URDF."""
    body: str
    """The SDF link that it becomes a part of."""
    name: str
    """Its name in that SDF link."""
    suffix: str
    """``_collision`` or ``_visual``."""

    def is_reached_by(self, reference: str) -> bool:
        """Whether the surface settings of a block with this reference reach the shape."""
        if reference == self.body:
            return _LUMP not in self.name
        return f"{_LUMP}{reference}{self.suffix}" in self.name


@dataclass(frozen=True, slots=True, eq=False)
class FixedJointReduction:
    """What the merge makes of the links and of their shapes."""

    body_by_link: Mapping[str, str]
    """The SDF link that each link becomes a part of; itself where it stays one."""
    collisions: tuple[MergedShape, ...]
    """Every collision shape under its name in SDF."""
    visuals: tuple[MergedShape, ...]
    """Every visual shape under its name in SDF."""


@fact
def reduce_fixed_joints(model: Model) -> FixedJointReduction:
    """Merge links as sdformat does.

    :raises FactUnavailableError: when the links are not one tree.
    """
    tree, preserved = model.tree, find_preserved_names(model)
    body: dict[str, str] = {}
    for name in tree.order:
        joint = tree.parent_joint.get(name)
        body[name] = body[joint.parent] if joint is not None and is_merged_joint(joint, preserved) else name
    members: dict[str, list[Link]] = {}
    for name in _list_links_outwards(model):
        members.setdefault(body[name], []).append(model.link_by_name[name])
    return FixedJointReduction(body, _name_merged_shapes(members, "collision"), _name_merged_shapes(members, "visual"))


def is_merged_joint(joint: Joint, preserved_names: Mapping[str, Element]) -> bool:
    """Whether sdformat merges its two links. Below a link called world it does not."""
    return joint.type == "fixed" and joint.name not in preserved_names and joint.parent != "world"


def find_preserved_names(model: Model) -> Mapping[str, Element]:
    """Return the names that a `<gazebo>` block asks to keep from being merged, with the element that says so."""
    preserved: dict[str, Element] = {}
    for block in model.robot.find_children("gazebo"):
        for child in block.children:
            if child.tag in PRESERVE and is_true_flag(child):
                preserved.setdefault(block.get("reference"), child)
    return preserved


def predict_gazebo(model: Model, link: Link, whole: MergedBody | None, rel_tol: float) -> str:
    """Predict whether Gazebo loads a link with an impossible tensor.

    :param whole: the body of all links that are fixed to it, of which Gazebo keeps some apart: those below a fixed joint with
        ``preserveFixedJoint`` or ``disableFixedJointLumping``.
    """
    if whole is None:
        return GAZEBO_REFUSES
    try:
        bodies = reduce_fixed_joints(model).body_by_link
        merged = weigh_body(model, tuple(name for name, body in bodies.items() if body == bodies[link.name]))
    except FactUnavailableError:  # the robot is in pieces, which other rules report
        return GAZEBO_MERGES if whole.is_physically_valid(rel_tol) else GAZEBO_REFUSES
    is_possible = merged is not None and MergedBody("", merged.moments, False, False).is_physically_valid(rel_tol)
    return GAZEBO_MERGES if is_possible else GAZEBO_REFUSES


def names_fixed_part(name: str, joint: Joint) -> bool:
    """Whether a name is that of a fixed joint or of its link, but for the words that say what is named: ``foot_joint``."""
    words = _strip_kind_words(name)
    return (
        joint.type == "fixed"
        and bool(words)
        and words in (_strip_kind_words(joint.name), _strip_kind_words(joint.child))
    )


def _strip_kind_words(name: str) -> list[str]:
    return [word.lower() for word in split_name_words(name) if word.lower() not in {"link", "joint", "fixed", "frame"}]


def is_true_flag(element: Element) -> bool:
    """Read a flag as sdformat does: true, yes or 1, as the text or the attribute ``value``."""
    return (element.get("value") or element.text).strip().lower() in {"true", "yes", "1"}


def is_false_flag(element: Element) -> bool:
    """Whether an element of SDF says false: false or 0."""
    return element.text.strip().lower() in {"false", "0"}


def _list_links_outwards(model: Model) -> list[str]:
    """Return the links in the order in which sdformat collects their shapes.

    Each comes before what hangs on it, branch by branch. urdfdom keeps joints by name, which gives the order of the
    branches.
    """
    names: list[str] = []
    stack = [model.tree.root]
    while stack:
        name = stack.pop()
        names.append(name)
        joints = sorted(model.tree.child_joints[name], key=lambda joint: joint.name, reverse=True)
        stack.extend(joint.child for joint in joints)
    return names


def _name_merged_shapes(members: Mapping[str, Sequence[Link]], role: str) -> tuple[MergedShape, ...]:
    merged: list[MergedShape] = []
    for body, links in members.items():
        shapes = [
            (link, shape) for link in links for shape in (link.collisions if role == "collision" else link.visuals)
        ]
        for number, (link, shape) in enumerate(shapes):
            name = (shape.element.get("name") or link.name) + f"_{role}" + (f"_{number}" if number else "")
            full = name if name.startswith(body) else f"{body}{_LUMP}{name}"
            merged.append(MergedShape(element=shape.element, link=link.name, body=body, name=full, suffix=f"_{role}"))
    return tuple(merged)
