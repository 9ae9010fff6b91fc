"""Sizes of meshes: which are drawn in a wrong one, because of their unit or scale, and which shapes can be measured."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core import FactUnavailableError
from urdfcheck.core.records import dataclass
from urdfcheck.facts.inertials.materials import is_part_density
from urdfcheck.model.fact import fact
from urdfcheck.model.meshes import MeshUse
from urdfcheck.model.parts import Joint, Shape
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.primitive_boxes import compute_half_extents
from urdfcheck.model.shapes.solids import compute_drawn_scale, measure_shape_solid

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array

# The units of CAD systems, in metres.
_UNITS = {"millimetres": 0.001, "inches": 0.0254, "centimetres": 0.01}
# The defaults of MSH008's options, whose page says what they are from: m, 1, m.
DEFAULT_LIMITS = {"largest": 5.0, "ratio": 10.0, "smallest": 0.001}
# A declared unit this close to the metre is the metre.
_UNIT_TOLERANCE = 1e-3
# A scale below this was meant to convert millimetres, centimetres or inches to metres.
_MAX_CONVERSION_SCALE = 0.03
# What a robot stands on is of any size; a ground_robot or a floor_cleaner is a robot.
_GROUND = re.compile(
    r"(?<![a-z])(?<!all[_-])(?:ground|floor|terrain)(?:[_-]?(?:plane|link|mesh|visual|collision|\d))*(?:\.\w+)?$",
    re.IGNORECASE,
)
# Four times the largest part (m) that published robots have.
_ENLARGED = 20.0
# A part that measures more than this in all three directions (m) is not a ground plane or a wall.
_MIN_ENLARGED = 1.0
# The rail of a gantry, and the hall around it, are as long as what the gantry travels, which is not in its reach. Chosen: as many
# times as any mesh of a published robot is as long as its reach (MSH008).
_LIKE_GANTRY = 2.2
# A limit beyond this (m) is a number that stands for none (chosen).
_LONGEST_TRAVEL = 100.0


@dataclass(frozen=True, slots=True)
class SizeLimits:
    """The sizes that a part of a robot can have."""

    reach: float
    """The greatest distance of a link from the root (m)."""
    smallest: float
    """m"""
    largest: float
    """m"""

    def is_too_large(self, size: float) -> bool:
        """Whether a part is too large; never in a model without extent, which may be a table, a terrain or a building."""
        return self.reach > 0 and size > self.largest

    def is_plausible(self, size: float) -> bool:
        return self.smallest <= size <= self.largest

    def list_plausible_units(self, size: float) -> dict[str, float]:
        """Return the units that give a part of this many file units a plausible size."""
        return {name: unit for name, unit in _UNITS.items() if self.is_plausible(size * unit)}


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class MeasuredMesh:
    """A use of a mesh whose size is known."""

    use: MeshUse
    size: float
    """Of the longest edge of its box as RViz and Gazebo draw it (m)."""
    in_file: float
    """Of the same edge, in file units."""
    unit: float | None
    """The unit (m) that a COLLADA file declares, None for the metre."""
    mistake: str | None
    """What is wrong with its size, if something is.

    ``large``: it was not converted to metres. ``small``: it was, and is in metres. ``enlarged``: it is in metres, and the
    inverse of a conversion makes it a building. ``twice``: its scale is not the usual one, with which it has a plausible size:
    the robot's other meshes say more about its unit than a file that would be as large as a part in metres, too.
    """


@dataclass(frozen=True, slots=True, eq=False)
class MeshSizes:
    """The sizes of all meshes of a robot."""

    limits: SizeLimits
    usual: float
    """The scale that most uses of meshes have along all axes, whatever its signs; 1 where none has."""
    meshes: tuple[MeasuredMesh, ...]


@fact
def measure_mesh_sizes(model: Model, *, largest: float, ratio: float, smallest: float) -> MeshSizes:
    """Measure every use of a mesh, and find what is wrong with its size."""
    reach = _measure_reach(model)
    most = max(largest, ratio * reach)
    travel = _measure_gantry(model)
    if travel > 0 and _draws_part_within(model, most):
        most = max(most, _LIKE_GANTRY * travel)
    limits, usual = SizeLimits(reach, smallest, most), _find_usual_scale(model)
    meshes = (_measure_mesh(model, use, limits, usual=usual) for use in model.meshes.uses)
    return MeshSizes(limits, usual, tuple(mesh for mesh in meshes if mesh is not None))


def has_wrong_size(model: Model, shape: Shape) -> bool:
    """Whether a mesh is drawn in a wrong size (MSH008): what is measured on it says nothing about the part."""
    return id(shape) in _index_mistakes(model)


def is_usable_shape(model: Model, shape: Shape) -> bool:
    """Whether it is known where a shape is, what it looks like, and how large it is."""
    size: Array | tuple[float, ...] | None = shape.size if shape.kind != "mesh" else get_mesh_scale(model, shape, True)
    if size is None or shape.origin.matrix is None or shape.kind is None:
        return False
    return all(size) if shape.kind == "mesh" else min(size) > 0


def get_mesh_scale(model: Model, shape: Shape, apply_unit: bool) -> Array | None:
    """Return metres per file unit along a mesh's axes (3,), with or without COLLADA's unit.

    None for a mesh that could not be read or is drawn in a wrong size, and for other shapes.
    """
    drawn = compute_drawn_scale(model, shape) if shape.kind == "mesh" else None
    if drawn is None or has_wrong_size(model, shape):
        return None
    return np.array(drawn if apply_unit else shape.size)


@fact
def _index_mistakes(model: Model) -> Mapping[int, str]:
    # With the same thresholds, MSH008 reports what no other rule measures.
    sizes = measure_mesh_sizes(model, **{**DEFAULT_LIMITS, **model.mesh_limits})
    return {id(mesh.use.shape): mesh.mistake for mesh in sizes.meshes if mesh.mistake is not None}


def _measure_mesh(model: Model, use: MeshUse, limits: SizeLimits, *, usual: float) -> MeasuredMesh | None:
    """Measure a mesh; None if its size is unknown or not finite."""
    facts, scale = model.meshes.get_facts(use.shape), compute_drawn_scale(model, use.shape)
    if facts is None or scale is None or use.shape.size is None:
        return None
    with np.errstate(over="ignore", invalid="ignore"):
        edges = np.ptp(facts.bounds, axis=0)
        size = float((edges * np.abs(scale)).max())
    if not np.isfinite(size):
        return None
    in_file = float(edges.max())
    if facts.unit is not None and abs(facts.unit - 1.0) > _UNIT_TOLERANCE and size > 0:
        return MeasuredMesh(use=use, size=size, in_file=in_file, unit=facts.unit, mistake=None)
    least = float((edges * np.abs(scale)).min())
    mistake = _find_mistake(model, use, limits, usual=usual, least=least, size=size, in_file=in_file)
    return MeasuredMesh(use=use, size=size, in_file=in_file, unit=None, mistake=mistake)


def _list_other_scales(model: Model, use: MeshUse) -> set[float]:
    """List the scales, other than that of a use and none, which other uses by its link give the same file along all axes."""
    name = use.filename.value
    named = (other.shape.size for other in model.meshes.uses if other.link is use.link and other.filename.value == name)
    scales = {abs(size[0]) for size in named if size is not None and len(set(map(abs, size))) == 1}
    return scales - {1.0, *map(abs, use.shape.size or ())}


def _find_mistake(
    model: Model, use: MeshUse, limits: SizeLimits, *, usual: float, least: float, size: float, in_file: float
) -> str | None:
    """Return what is wrong with the size of a mesh, whose box has edges from ``least`` to ``size`` (m)."""
    scales = np.abs(use.shape.size or (1.0,))
    if limits.is_too_large(size) and limits.list_plausible_units(size):
        return None if any(map(_GROUND.search, (use.link.name, use.name))) else "large"
    # In a robot whose joints are as far apart, the rest of it has the same mistake, so its reach shows nothing.
    is_enlarged = limits.reach > 0 and scales.min() * _MAX_CONVERSION_SCALE >= 1.0
    if is_enlarged and size > _ENLARGED and least > _MIN_ENLARGED and limits.smallest <= in_file <= _ENLARGED:
        return "enlarged"
    if size >= limits.smallest or scales.max() >= _MAX_CONVERSION_SCALE or _weighs_as_drawn(model, use):
        return None
    if usual != 1.0 and limits.is_plausible(in_file * usual):
        return "twice"
    if any(limits.is_plausible(in_file * scale) for scale in _list_other_scales(model, use)):
        return None  # neither is it in metres, nor was it converted: GEO003 compares the two
    return "small" if limits.is_plausible(in_file) else None


def _weighs_as_drawn(model: Model, use: MeshUse) -> bool:
    """Whether the mass of the link is that of a part as small as the mesh, such as a letter of a logo."""
    solid, inertial = measure_shape_solid(model, use.shape), use.link.inertial
    if solid is None or not solid.volume > 0 or inertial is None or inertial.mass is None:
        return False
    return is_part_density(inertial.mass / solid.volume)


def _find_usual_scale(model: Model) -> float:
    """Return the scale that most uses of meshes have along all axes, whatever its signs, if it converts a unit: any other is that
    of parts that were made longer, and says nothing about a unit; else 1."""
    scales = [tuple(abs(part) for part in use.shape.size) for use in model.meshes.uses if use.shape.size is not None]
    counts = Counter(scale[0] for scale in scales if len(set(scale)) == 1)
    usual, count = max(counts.items(), key=lambda item: (item[1], item[0]), default=(1.0, 0))
    return usual if 2 * count > len(scales) and usual < _MAX_CONVERSION_SCALE else 1.0


def _measure_reach(model: Model) -> float:
    """Return the greatest distance of a link frame from the root (m), all joints at zero; 0 if unknown."""
    try:
        return max((float(np.linalg.norm(frame[:3, 3])) for frame in model.frames.values()), default=0.0)
    except FactUnavailableError:
        return 0.0


def _measure_gantry(model: Model) -> float:
    """Return the greatest distance of a link frame from the root (m) with what the joints of a gantry travel; 0 if unknown.

    These are prismatic joints between drawn bodies that carry other joints which move: neither fingers, whose limits may be in
    millimetres as the meshes are, nor the joints that stand for the motion of a mobile base.
    """
    try:
        tree, frames = model.tree, model.frames
    except FactUnavailableError:
        return 0.0
    carrying = {joint.name for one in model.joints if one.is_movable for joint in tree.find_path_to(one.parent)}
    farthest = dict.fromkeys(tree.order, 0.0)
    for name in tree.order[1:]:
        joint = tree.parent_joint[name]
        is_rail = joint.type == "prismatic" and joint.name in carrying
        is_rail = is_rail and all(_is_drawn(model, link) for link in (joint.parent, name))
        farthest[name] = farthest[joint.parent] + (_get_travel(joint) if is_rail else 0.0)
    return max(
        (travel + float(np.linalg.norm(frames[name][:3, 3])) for name, travel in farthest.items() if travel),
        default=0.0,
    )


def _draws_part_within(model: Model, most: float) -> bool:
    """Whether some shape is not longer than this (m), or of unknown size: a robot whose meshes and limits are all in millimetres
    has none."""
    shapes = (shape for link in model.links for shape in (*link.visuals, *link.collisions))
    return any(not _measure_length(model, shape) > most for shape in shapes)


def _measure_length(model: Model, shape: Shape) -> float:
    """Measure the longest edge of the box of a shape (m); NaN if unknown."""
    if shape.kind is None or shape.size is None:
        return math.nan
    if shape.kind != "mesh":
        return 2.0 * max(compute_half_extents(shape.kind, shape.size, np.eye(3).tolist()))
    facts, scale = model.meshes.get_facts(shape), compute_drawn_scale(model, shape)
    if facts is None or scale is None:
        return math.nan
    with np.errstate(over="ignore", invalid="ignore"):
        return float((np.ptp(facts.bounds, axis=0) * np.abs(scale)).max())


def _is_drawn(model: Model, link: str) -> bool:
    """Whether a link of the rigid body of a ``link`` has a shape."""
    body = [model.link_by_name[name] for name in model.tree.list_body_links(link)]
    return any(one.visuals or one.collisions for one in body)


def _get_travel(joint: Joint) -> float:
    """Return how far a prismatic joint takes what it carries from its origin (m); 0 if nothing says so."""
    limits = [abs(joint.get_limit_value(side) or 0.0) for side in ("lower", "upper")]
    return max(limits) if max(limits) <= _LONGEST_TRAVEL else 0.0
