"""A model as plain values for the outputs that draw it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from urdfcheck.core import FactUnavailableError, Finding
from urdfcheck.core.scene import (
    Scene,
    SceneDrawing,
    SceneFrame,
    SceneGround,
    SceneInertia,
    SceneJoint,
    SceneLink,
    SceneMesh,
    SceneOverlap,
    ScenePreview,
    SceneShape,
)
from urdfcheck.model import Joint, Link, Model, Shape
from urdfcheck.model.ground.wheels import rolling_wheels
from urdfcheck.model.mesh_colors import find_mesh_colors
from urdfcheck.model.motion.collisions.self_collisions import self_collisions
from urdfcheck.model.parts import TENSOR_NAMES, Inertial, Pose
from urdfcheck.model.shapes.solids import compute_drawn_scale, measure_link_solid
from urdfcheck.source.launch.launch_file import Launch
from urdfcheck.source.launch.node_graph import build_launch_scene
from urdfcheck.source.launch.static_transforms import StaticTransform
from urdfcheck.source.package.finder import format_path
from urdfcheck.source.text.values import read_attribute_number, read_attribute_numbers
from urdfcheck.source.text.xml import Element

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array, Indices
    from urdfcheck.facts.mesh.measure import MeshFacts

# Triangles of one model that a report draws; larger meshes are simplified. SO-101 has 320,000 and needs 1.4 MB.
MOST_TRIANGLES = 250_000
# A mesh with a small share of them keeps at least this many.
FEWEST_TRIANGLES = 2_000
# Edges of holes in one mesh that are drawn.
MOST_HOLES = 3_000


def build_scene(model: Model, model_id: str, *, launches: Sequence[Launch], findings: Iterable[Finding] = ()) -> Scene:
    """Build the scene of a model.

    With the static transforms of the launch files that start it, and with what the repairs of its findings make of it. A
    broken tree still gives links and joints: the report shows them without placements.
    """
    try:
        root, order = model.tree.root, model.tree.order
    except FactUnavailableError:
        root, order = "", tuple(model.link_by_name)
    files = {path: place for place, path in enumerate(dict.fromkeys(_list_mesh_files(model)))}
    starts = _compute_start_poses(model)
    return Scene(
        model=model_id,
        root=root,
        links=tuple(_build_link(model, model.link_by_name[name], files, starts.get(name)) for name in order),
        joints=tuple(_build_joint(model, joint) for joint in model.joints),
        frames=tuple(
            SceneFrame(parent=t.parent, child=t.child, pose=_compute_pose(t), span=t.at.span)
            for launch in launches
            for t in launch.transforms
        ),
        meshes=tuple(_build_meshes(model, list(files))),
        overlaps=tuple(_find_overlaps(model)),
        ground=_build_ground(model),
        previews=tuple(_build_previews(model, findings)),
        launches=tuple(map(build_launch_scene, launches)),
    )


def _compute_pose(static: StaticTransform) -> tuple[float, ...]:
    from urdfcheck.facts.motion.kinematics import build_origin_transform, quaternion_to_matrix

    if static.xyz is None or (static.rpy is None and not any(static.quaternion or ())):
        return ()
    pose = build_origin_transform(static.xyz, static.rpy or (0.0, 0.0, 0.0))
    if static.rpy is None and static.quaternion is not None:
        pose[:3, :3] = quaternion_to_matrix(static.quaternion)
    return _flatten_matrix(pose)


# -- links and joints --------------------------------------------------------------------------------------------------


def _build_link(model: Model, link: Link, files: dict[Path, int], start: tuple[float, ...] | None) -> SceneLink:
    from urdfcheck.facts.inertials.inertia_tensor import compute_principal_moments, compute_solid_inertia

    inertial = None if link.inertial is None else _build_inertia(link.inertial)
    solid = measure_link_solid(model, link) if model.tier != "source" else None
    mass = None if inertial is None else inertial.mass
    filled = None if solid is None or mass is None or not solid.volume > 0 else compute_solid_inertia(solid, mass)
    return SceneLink(
        name=link.name,
        inertial=inertial,
        density=None if solid is None or mass is None or not solid.volume > 0 else mass / solid.volume,
        drawn_com=() if solid is None else tuple(map(float, solid.com)),
        drawn_moments=() if filled is None else tuple(map(float, compute_principal_moments(filled)[0])),
        world=_find_world_pose(model, link.name),
        shapes=tuple(_build_shape(model, s, files) for s in (*link.visuals, *link.collisions)),
        span=link.element.span,
        start=start,
    )


def _build_inertia(inertial: Inertial) -> SceneInertia:
    from urdfcheck.facts.inertials.inertia_tensor import compute_principal_frame, list_inertia_components

    mass, com, tensor = inertial.mass, inertial.origin.xyz or (), inertial.tensor_in_link
    if tensor is None:
        return SceneInertia(mass=mass, com=com)
    moments, axes = compute_principal_frame(tensor)
    return SceneInertia(
        mass=mass,
        com=com,
        tensor=tuple(list_inertia_components(tensor)),
        moments=tuple(map(float, moments)),
        axes=_flatten_matrix(axes),
        impossible=_explain_impossible(inertial),
    )


def _explain_impossible(inertial: Inertial) -> str:
    """Explain why no body has an inertia; empty where one can, or where the tensor is not known."""
    from urdfcheck.facts.inertials.inertia_tensor import check_inertia_validity, measure_tensor_rounding

    tensor, mass, element = inertial.tensor, inertial.mass, inertial.tensor_element
    if tensor is None or element is None:
        return ""
    if mass is not None and mass <= 0.0 and tensor.any():
        return "an inertia without a positive mass"
    validity = check_inertia_validity(tensor)
    least, middle, largest = validity.moments
    if not validity.finite or (not validity.positive_definite and tensor.any()):
        return f"the smallest principal moment is {least:.3g} kg m²"
    typed = [element.get(name) for name in TENSOR_NAMES]
    if validity.triangle_inequality or measure_tensor_rounding(typed).explained_by_rounding:
        return ""
    return f"{least:.3g} + {middle:.3g} < {largest:.3g} kg m²: the principal moments break the triangle inequality"


def _find_world_pose(model: Model, link: str) -> tuple[float, ...] | None:
    try:
        return _flatten_matrix(model.frames[link])
    except (FactUnavailableError, KeyError):
        return None


def _compute_start_poses(model: Model) -> dict[str, tuple[float, ...]]:
    """Compute where the links are as the report draws the robot; empty where that is with all joints at zero, or not known."""
    import numpy as np

    from urdfcheck.model.motion.poses import (
        JointConfigurations,
        apply_mimics,
        compute_frames,
        make_neutral_configuration,
    )

    try:
        joints = make_neutral_configuration(model).joints
        starts = np.array([_find_start(joint) for joint in joints]).reshape(1, -1)
        configuration = apply_mimics(JointConfigurations(joints, starts))
        if not configuration.values.any():
            return {}
        frames = compute_frames(model, configuration)
    except FactUnavailableError:
        return {}
    return {name: _flatten_matrix(frame[0]) for name, frame in frames.items() if np.isfinite(frame).all()}


def _build_shape(model: Model, shape: Shape, files: dict[Path, int]) -> SceneShape:
    pose, use = shape.origin.matrix, model.meshes.by_shape.get(id(shape))
    return SceneShape(
        role=shape.role,
        kind=shape.kind or "",
        size=compute_drawn_scale(model, shape) or shape.size or (),
        pose=() if pose is None else _flatten_matrix(pose),
        mesh=shape.mesh_filename.value if shape.mesh_filename is not None else "",
        file=None if use is None or use.resource.path is None else files.get(use.resource.path),
        color=find_color(model, shape),
    )


def find_color(model: Model, shape: Shape) -> tuple[float, ...] | None:
    """Find the colour of the shape's material, or of the robot's material of this name."""
    shape_material = shape.element.find_child("material")
    if shape_material is None:
        return None
    of_this_name = (m for m in model.robot.find_children("material") if m.get("name") == shape_material.get("name"))
    for material in (shape_material, *of_this_name):
        color = read_attribute_numbers(material.find_child("color"), "rgba", count=4, default=())
        if color and all(0.0 <= part <= 1.0 for part in color):
            return color
    return None


def _build_joint(model: Model, joint: Joint) -> SceneJoint:
    import numpy as np

    try:
        axis = model.axes.get(joint.name)
    except FactUnavailableError:
        axis = None
    lower, upper = _get_limits(joint)
    pose, typed = joint.origin.matrix, joint.axis if joint.has_axis else None
    length = 0.0 if typed is None else float(np.linalg.norm(typed))
    mimic, dynamics = joint.mimic, joint.element.find_child("dynamics")
    return SceneJoint(
        name=joint.name,
        type=joint.type,
        parent=joint.parent,
        child=joint.child,
        axis=None if axis is None else tuple(float(round(a, 12)) for a in axis),
        lower=lower,
        upper=upper,
        span=joint.element.span,
        pose=() if pose is None else _flatten_matrix(pose),
        turn=tuple(v / length for v in typed) if typed is not None and length > 0.0 else None,
        start=_find_start(joint),
        mimic=None if mimic is None else _read_mimic(mimic),
        effort=joint.get_limit_value("effort"),
        velocity=joint.get_limit_value("velocity"),
        damping=read_attribute_number(dynamics, "damping"),
        friction=read_attribute_number(dynamics, "friction"),
    )


def _get_limits(joint: Joint) -> tuple[float | None, float | None]:
    if joint.limit is None or joint.type not in {"revolute", "prismatic"}:
        return None, None
    return joint.get_limit_value("lower"), joint.get_limit_value("upper")


def _find_start(joint: Joint) -> float:
    """Return the position nearest to zero that the limits allow."""
    lower, upper = _get_limits(joint)
    return min(max(0.0, lower), upper) if lower is not None and upper is not None and lower <= upper else 0.0


def _read_mimic(mimic: Element) -> tuple[str, float, float]:
    return mimic.get("joint"), _read_number(mimic, "multiplier", 1.0), _read_number(mimic, "offset", 0.0)


def _read_number(element: Element, name: str, default: float) -> float:
    value = read_attribute_number(element, name)
    return default if value is None else value


# -- meshes ------------------------------------------------------------------------------------------------------------


def _list_mesh_files(model: Model) -> Iterator[Path]:
    """Yield the mesh files that the links use and that can be opened, in document order."""
    for use in model.meshes.uses:
        if use.resource.path is not None and use.resource.exists:
            yield use.resource.path


def _build_meshes(model: Model, files: Sequence[Path]) -> Iterator[SceneMesh]:
    facts = model.meshes.facts
    distinct = {model.meshes.digests.get(path, ""): facts[path].n_triangles for path in files if path in facts}
    total = sum(distinct.values())
    share = 1.0 if total <= MOST_TRIANGLES else MOST_TRIANGLES / total
    # Copies of one file may lie beside different colours.
    drawings: dict[tuple[str, bytes], tuple[SceneDrawing, ...]] = {}
    for path in files:
        name, digest, mesh = format_path(path), model.meshes.digests.get(path, ""), facts.get(path)
        if mesh is None:
            error = model.meshes.errors.get(path)
            yield SceneMesh(name=name, digest=digest, problem="" if error is None else error.message)
            continue
        colors = find_mesh_colors(path, mesh, model.source.finder)
        key = digest, b"" if colors is None or mesh.materials is None else b"".join(part.tobytes() for part in colors)
        if key not in drawings:
            drawings[key] = tuple(_build_drawings(mesh, share, colors))
        extents = mesh.bounds[1] - mesh.bounds[0]
        yield SceneMesh(
            name=name,
            digest=digest,
            format=mesh.format,
            bytes=path.stat().st_size,
            triangles=mesh.n_triangles,
            extents=tuple(map(float, extents)),
            unit=mesh.unit,
            watertight=mesh.watertight,
            open_edges=mesh.open_edges,
            drawings=drawings[key],
        )


def _build_drawings(facts: MeshFacts, share: float, colors: tuple[Indices, Array] | None) -> Iterator[SceneDrawing]:
    """Yield the drawings of a mesh, one for each of its colours; the first has the holes of all.

    ``colors``: as of `MeshFacts.colors`.
    """
    import numpy as np

    if colors is None:
        yield _build_drawing(facts, facts.faces, color=None, share=share, holes=_select_hole_edges(facts))
        return
    of_face, rgba = colors
    holes = _select_hole_edges(facts)
    for index in np.unique(of_face):
        color = None if index < 0 else tuple(map(float, rgba[index]))
        yield _build_drawing(facts, facts.faces[of_face == index], color=color, share=share, holes=holes)
        holes = holes[:0]


def _build_drawing(
    facts: MeshFacts,
    faces: Indices,
    *,
    color: tuple[float, ...] | None,
    share: float,
    holes: Array,
) -> SceneDrawing:
    from urdfcheck.facts.mesh.codec import needs_wide_indices, pack_mesh

    packed = pack_mesh(facts.vertices, faces, holes, max_faces=max(FEWEST_TRIANGLES, round(share * len(faces))))
    low, high = (tuple(map(float, ends)) for ends in (packed.low, packed.high))
    return SceneDrawing(
        vertices=packed.n_vertices,
        faces=packed.n_faces,
        holes=packed.n_hole_edges,
        wide=needs_wide_indices(packed.n_vertices),
        low=low,
        high=high,
        data=packed.data,
        color=color,
    )


def _select_hole_edges(facts: MeshFacts) -> Array:
    """Return the ends (n, 2, 3) of its open edges, of the longest where there are many."""
    import numpy as np

    if not facts.open_edges:
        return np.zeros((0, 2, 3))
    lines = facts.open_lines
    if len(lines) > MOST_HOLES:
        lines = lines[np.argsort(-np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1), kind="stable")[:MOST_HOLES]]
    return lines


# -- the whole robot ---------------------------------------------------------------------------------------------------


def _find_overlaps(model: Model) -> Iterator[SceneOverlap]:
    if model.tier != "full":
        return
    try:
        pairs = self_collisions(model).pairs
    except FactUnavailableError:
        return
    for pair in pairs:
        contact = pair.contact
        if pair.relation == "far" and contact is not None and not contact.touching:
            yield SceneOverlap(links=pair.links, point=tuple(map(float, contact.point)), depth=contact.depth)


def _build_ground(model: Model) -> SceneGround | None:
    if model.tier == "source":
        return None
    import numpy as np

    from urdfcheck.facts.motion.contact import SLACK, compute_ground_support
    from urdfcheck.model.ground.support_polygon import (
        collect_robot_corners,
        compute_contact_points,
        is_free_standing,
        list_link_masses,
    )

    try:
        weights = list_link_masses(model)
        if not weights or not is_free_standing(model):
            return None
        points, owners = collect_robot_corners(model, {wheel.joint.child: wheel for wheel in rolling_wheels(model)})
    except FactUnavailableError:
        return None
    if not len(points):
        return None
    com = np.average([w.com for w in weights], axis=0, weights=[w.mass for w in weights])
    support = compute_ground_support(points, parts=owners, com=com)
    return SceneGround(
        height=float(points[:, 2].min()),
        contacts=tuple(
            (name, tuple(map(float, at)))
            for name, at in compute_contact_points(model, points, owners, support=support).items()
        ),
        support=tuple(tuple(map(float, corner)) for corner in support.polygon),
        com=tuple(map(float, com)),
        stands=support.tip_angle >= -SLACK,
    )


def _build_previews(model: Model, findings: Iterable[Finding]) -> Iterator[ScenePreview]:
    """Yield what the repairs of findings make of joints' origins and of inertials."""
    from urdfcheck.model.repairs.edit_preview import preview_edits

    for finding in findings:
        span = finding.location.span
        if span is None or finding.fix is None or not finding.fix.edits:
            continue
        for joint in model.joints:
            origin = joint.element.find_child("origin")
            changed = None if origin is None else preview_edits(origin, finding.fix.edits)
            pose = None if changed is None else Pose(changed).matrix
            if pose is not None:
                yield ScenePreview(
                    code=finding.code,
                    message_id=finding.message_id,
                    at=span,
                    joint=joint.name,
                    pose=_flatten_matrix(pose),
                )
        for link in model.links:
            changed = None if link.inertial is None else preview_edits(link.inertial.element, finding.fix.edits)
            if changed is not None:
                after = _build_inertia(Inertial(changed))
                yield ScenePreview(
                    code=finding.code, message_id=finding.message_id, at=span, link=link.name, inertial=after
                )


def _flatten_matrix(matrix: Array) -> tuple[float, ...]:
    return tuple(float(v) for v in matrix.ravel())
