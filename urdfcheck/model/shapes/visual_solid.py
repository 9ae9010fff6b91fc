"""What a link draws, measured for comparison with what its ``<inertial>`` declares."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from urdfcheck.facts.arrays import Array
from urdfcheck.facts.inertials.declared_and_drawn import Primitive, VisualGeometry
from urdfcheck.facts.inertials.inertia_tensor import Solid, combine_solids, make_box_solid, transform_solid
from urdfcheck.facts.mesh.measure import MeshFacts, compute_mesh_solid
from urdfcheck.facts.mesh.moments import MeshMoments, compute_mesh_moments
from urdfcheck.model.fact import fact
from urdfcheck.model.parts import Link, Shape, is_dummy_shape
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.bounds import Z_UP_ROTATIONS, compute_bounding_box, get_up_axis_rotation
from urdfcheck.model.shapes.corners import compute_shape_corners
from urdfcheck.model.shapes.mesh_sizes import get_mesh_scale, has_wrong_size
from urdfcheck.model.shapes.solids import measure_shape_solid

# A shape settles which way up a mesh is meant when its box is nearer to that of one way than to the other's by this ratio.
_NEARER = 0.5
# A convex hull that is so many times as large as what its mesh encloses has little to do with the part.
_LOOSE = 10.0
# What a link is compared with.
DRAWN_PART, OPEN_HULL = "the drawn part", "the convex hull of the open mesh"
# More bodies than this in an assembly, and nobody added up their inertias.
_MOST_PIECES = 40
# Triangles that enclose less than this part of a mesh's volume are a sheet.
_FLAT = 1e-9


@fact
def measure_link_geometry(
    model: Model, link: Link, *, apply_unit: bool = True, apply_up_axis: bool = False
) -> VisualGeometry | None:
    """Measure what the link itself draws, in its frame, as RViz draws it.

    These are the visual shapes, or the collision shapes where only these are closed or there are no visual ones. None when
    there is nothing, or a shape is not known. ``apply_unit`` and ``apply_up_axis``: whether COLLADA's ``<unit>`` and
    ``<up_axis>`` are followed; RViz follows the unit alone.
    """
    drawn = None if _draws_dummies(link) else _measure_role(model, link, "visual", apply_unit, apply_up_axis)
    if drawn is not None and drawn.closed:
        return drawn
    colliding = _measure_role(model, link, "collision", apply_unit, apply_up_axis)
    return colliding if drawn is None or (colliding is not None and colliding.closed) else drawn


def explain_collision_stand_in(model: Model, link: Link) -> str | None:
    """Explain why `measure_link_geometry` returns the collision shapes of a link: visual meshes that are ``open``, ``unread`` or
    of a ``wrong size``, or ``no visual``. None where it returns the visual ones."""
    visible = None if _draws_dummies(link) else measure_role_geometry(model, link, "visual")
    if visible is not None and visible.closed:
        return None
    colliding = measure_role_geometry(model, link, "collision")
    if colliding is None or not (visible is None or colliding.closed):
        return None
    if visible is not None:
        return "open"
    if any(has_wrong_size(model, shape) for shape in link.visuals):
        return "wrong size"
    return "unread" if any(not is_dummy_shape(shape) for shape in link.visuals) else "no visual"


def _draws_dummies(link: Link) -> bool:
    """Whether a link draws nothing but dummies, and collides as a part."""
    return all(map(is_dummy_shape, link.visuals)) and not all(map(is_dummy_shape, link.collisions))


def describe_geometry_source(model: Model, link: Link) -> str:
    """Name what `measure_link_geometry` measures, for a message about the link: numbers of a hull are not those of its part."""
    if explain_collision_stand_in(model, link) is not None:
        return "the collision shape"
    drawn = measure_link_geometry(model, link)
    return DRAWN_PART if drawn is None or drawn.closed else OPEN_HULL


def measure_role_geometry(model: Model, link: Link, role: str, *, apply_unit: bool = True) -> VisualGeometry | None:
    """Measure the shapes of one ``role`` (``visual`` or ``collision``) alone, like `measure_link_geometry`."""
    return _measure_role(model, link, role, apply_unit, False)


@np.errstate(all="ignore")  # of an open mesh nothing need be finite
def integrate_open_meshes(model: Model, link: Link) -> list[Solid]:
    """Integrate the volumes of the visual and of the collision shapes of a link as if their meshes were closed, in its frame:
    next to exact where the holes are small, and meaningless otherwise. Without a role whose meshes are all closed, or flat."""
    solids = []
    for shapes in (link.visuals, link.collisions):
        parts = [_integrate_mesh(model, shape) for shape in shapes if not is_dummy_shape(shape)]
        known = [part for part in parts if part is not None]
        if known and len(known) == len(parts) and not all(closed for _, closed in known):
            solids.append(combine_solids([solid for solid, _ in known]))
    return [solid for solid in solids if np.isfinite(solid.covariance).all() and np.isfinite(solid.com).all()]


def _integrate_mesh(model: Model, shape: Shape) -> tuple[Solid, bool] | None:
    """Return the volume integrals of a mesh in the link's frame, and whether it is closed; None without them."""
    facts, scale, pose = model.meshes.get_facts(shape), get_mesh_scale(model, shape, True), shape.origin.matrix
    if (
        facts is None
        or scale is None
        or pose is None
        or not np.isfinite(facts.com).all()
        or not abs(facts.volume) > 0.0
    ):
        return None
    return compute_mesh_solid(facts, scale.tolist(), rotation=pose[:3, :3], translation=pose[:3, 3]), facts.closed


def has_loose_hull(model: Model, link: Link) -> bool:
    """Whether the convex hull of an open mesh stands for the part, and is far larger: it says nothing about the part."""
    drawn = measure_link_geometry(model, link)
    if drawn is None or drawn.closed:
        return False
    meshes = [
        facts for shape in (*link.visuals, *link.collisions) if (facts := model.meshes.get_facts(shape)) is not None
    ]
    return any(not facts.closed and facts.hull.volume > _LOOSE * abs(facts.volume) for facts in meshes)


def split_visual_bodies(model: Model, link: Link) -> tuple[Solid, ...]:
    """Split the closed visual meshes of a link into their separate bodies, in its frame: the parts of a CAD assembly.

    Empty where a mesh is open or there is one body, or if there are too many bodies to add up.
    """
    bodies: list[Solid] = []
    for shape in link.visuals:
        facts, scale, pose = model.meshes.get_facts(shape), get_mesh_scale(model, shape, True), shape.origin.matrix
        if facts is None or scale is None or pose is None or not facts.closed or len(facts.components) > _MOST_PIECES:
            return ()
        labels = facts.label_bodies()
        count = int(labels.max()) + 1
        if count > _MOST_PIECES or (len(link.visuals) == 1 and count < 2):
            return ()
        parts = [compute_mesh_moments(facts.vertices, facts.faces[labels == label]) for label in range(count)]
        for part in parts:
            if abs(part.volume) > _FLAT * abs(facts.volume) and np.isfinite(part.com).all():
                bodies.append(transform_solid(_scale_solid(part, scale), pose[:3, :3], pose[:3, 3]))
    return tuple(bodies)


def merge_geometry(model: Model, link: Link, others: Iterable[Link]) -> VisualGeometry | None:
    """Merge what a link draws with what links fixed to it draw, in its frame. None when a shape is not known.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    to_link = np.linalg.inv(model.piece_frames[link.name])
    parts = []
    for one in (link, *others):
        drawn = measure_link_geometry(model, one)
        if drawn is None:
            return None
        parts.append(_transform_geometry(drawn, to_link @ model.piece_frames[one.name]))
    points = np.concatenate([drawn.points for drawn in parts])
    closed = all(drawn.closed for drawn in parts)
    return VisualGeometry(solid=combine_solids([drawn.solid for drawn in parts]), closed=closed, points=points)


def _transform_geometry(drawn: VisualGeometry, placement: Array) -> VisualGeometry:
    turn, place = placement[:3, :3], placement[:3, 3]
    return VisualGeometry(
        solid=transform_solid(drawn.solid, turn, place), closed=drawn.closed, points=drawn.points @ turn.T + place
    )


def has_unit_ambiguity(model: Model, links: Iterable[str]) -> bool:
    """Whether what these links draw has another size in programs that ignore COLLADA's ``<unit>`` (MSH008)."""
    shapes = (s for name in links for link in (model.link_by_name[name],) for s in (*link.visuals, *link.collisions))
    return any((facts := model.meshes.get_facts(s)) is not None and facts.unit not in {None, 1.0} for s in shapes)


def has_up_axis_ambiguity(model: Model, links: Iterable[str]) -> bool:
    """Whether what these links draw may be meant to be turned from how RViz draws it.

    RViz, like some other programs, ignores COLLADA's ``<up_axis>``. Another shape of the link beside such a mesh can settle
    it.
    """
    return any(_is_up_axis_ambiguous(model, model.link_by_name[name]) for name in links)


def _is_up_axis_ambiguous(model: Model, link: Link) -> bool:
    shapes = [s for s in (*link.visuals, *link.collisions) if not is_dummy_shape(s)]
    lying = [s for s in shapes if (facts := model.meshes.get_facts(s)) is not None and facts.up_axis in Z_UP_ROTATIONS]
    others = [box for s in shapes if s not in lying and (box := _measure_shape_box(model, s, False)) is not None]
    for shape in lying:
        drawn, upright = _measure_shape_box(model, shape, False), _measure_shape_box(model, shape, True)
        if drawn is None or upright is None:
            return True
        if not any(np.abs(box - drawn).max() < _NEARER * np.abs(box - upright).max() for box in others):
            return True
    return False


def _measure_shape_box(model: Model, shape: Shape, apply_up_axis: bool) -> Array | None:
    return compute_bounding_box(model, ((shape, np.eye(4)),), apply_up_axis=apply_up_axis)


def measure_shape_volume(model: Model, shape: Shape) -> float | None:
    """Measure the volume of a shape (m³), or of its convex hull where it is not closed; None when that is not known."""
    facts, scale = model.meshes.get_facts(shape), get_mesh_scale(model, shape, True)
    if facts is None or scale is None:
        solid = None if shape.kind == "mesh" else measure_shape_solid(model, shape)
        return None if solid is None else solid.volume
    return abs(float(scale.prod()) * (facts.volume if facts.closed else facts.hull.volume))


def measure_links_volume(model: Model, links: Iterable[Link]) -> float | None:
    """Measure the volume in m³ that some links draw in all; None when it is not known.

    Collision shapes count where a link has no visual ones.
    """
    shapes = [s for link in links for s in (link.visuals or link.collisions) if not is_dummy_shape(s)]
    volumes = [measure_shape_volume(model, shape) for shape in shapes]
    known = [v for v in volumes if v is not None]
    return sum(known) if known and len(known) == len(volumes) else None


@fact
@np.errstate(all="ignore")  # other rules report numbers that no robot has
def _measure_role(model: Model, link: Link, role: str, apply_unit: bool, apply_up_axis: bool) -> VisualGeometry | None:
    shapes = link.visuals if role == "visual" else link.collisions
    parts = [
        _measure_shape(model, shape, apply_unit=apply_unit, apply_up_axis=apply_up_axis)
        for shape in tuple(s for s in shapes if not is_dummy_shape(s)) or shapes
    ]
    known = [part for part in parts if part is not None]
    solids = tuple(part.solid for part in known if part.solid.volume > 0.0)
    if len(known) != len(parts) or not solids:
        return None
    solid = combine_solids(solids)
    if not (np.isfinite(solid.volume) and np.isfinite(solid.com).all() and np.isfinite(solid.covariance).all()):
        return None
    points = np.concatenate([part.points for part in known])
    low, high = points.min(axis=0), points.max(axis=0)
    box = transform_solid(make_box_solid(high - low), np.eye(3), (low + high) / 2)
    hulls = [part.hull for part in known if part.hull is not None and part.hull.volume > 0.0]
    shells = [part.shell for part in known if part.shell is not None]
    return VisualGeometry(
        solid=solid,
        closed=all(part.closed for part in known),
        points=points,
        hull=combine_solids(hulls) if hulls else None,
        shell=combine_solids(shells) if len(shells) == len(known) else None,
        box=box if box.volume > 0.0 else None,
        pieces=solids,
        primitive=known[0].primitive if len(known) == 1 else None,
    )


def _measure_shape(model: Model, shape: Shape, *, apply_unit: bool, apply_up_axis: bool) -> VisualGeometry | None:
    """Measure one shape by itself, without ``box`` and ``pieces``."""
    points, pose = (
        compute_shape_corners(model, shape, apply_unit=apply_unit, apply_up_axis=apply_up_axis),
        shape.origin.matrix,
    )
    if points is None or pose is None:
        return None
    turn, place = pose[:3, :3], pose[:3, 3]
    facts, scale = model.meshes.get_facts(shape), get_mesh_scale(model, shape, apply_unit)
    if facts is None or scale is None:
        solid = measure_shape_solid(model, shape)
        if solid is None:
            return None
        primitive = Primitive(shape.kind or "", shape.size or (), turn)
        return VisualGeometry(solid=solid, closed=True, points=points, hull=solid, primitive=primitive)
    upright = get_up_axis_rotation(facts, apply_up_axis)
    turn, scale = turn @ upright, np.abs(upright.T) @ scale
    integrals = facts.hull_moments
    hull = Solid(0.0, np.zeros(3), np.zeros((3, 3)))
    if integrals.volume > 0.0:
        hull = transform_solid(_scale_solid(integrals, scale), turn, place)
    closed = facts.closed and bool(np.isfinite(facts.com).all()) and not facts.has_mixed_orientation
    solid = compute_mesh_solid(facts, scale.tolist(), rotation=turn, translation=place) if closed else hull
    if not closed and (filled := facts.filled_moments) is not None and not facts.has_mixed_orientation:
        solid, closed = transform_solid(_scale_solid(filled, scale), turn, place), True
    return VisualGeometry(
        solid=solid,
        closed=closed or hull.volume == 0.0,  # flat drawings have no volume to be wrong about
        points=points,
        hull=hull,
        shell=_measure_shell(facts, scale, turn=turn, place=place),
    )


def _measure_shell(facts: MeshFacts, scale: Array, *, turn: Array, place: Array) -> Solid | None:
    if not facts.area > 0.0:
        return None
    sizes = np.abs(scale)
    if np.ptp(sizes) <= 1e-9 * sizes.max():
        grown = float(sizes[0]) ** 2
        local = Solid(
            grown * facts.area, scale * facts.surface_centroid, facts.surface_covariance * np.outer(scale, scale)
        )
    else:  # triangles grow differently
        surface = compute_mesh_moments(facts.vertices * scale, facts.faces)
        local = Solid(surface.area, surface.surface_centroid, surface.surface_covariance)
    return transform_solid(local, turn, place)


def _scale_solid(moments: MeshMoments, scale: Array) -> Solid:
    volume = abs(moments.volume * float(scale.prod()))
    return Solid(volume, scale * moments.com, moments.covariance * np.outer(scale, scale))
