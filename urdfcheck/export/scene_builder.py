"""What outputs that draw need of a model, as plain values."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from urdfcheck.core import Finding, Unavailable
from urdfcheck.core.scene import (
    Drawing,
    Scene,
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
from urdfcheck.model.parts import TENSOR, Inertial, Pose
from urdfcheck.source.launch.launch_file import Launch, StaticTransform
from urdfcheck.source.launch.node_graph import launch_scene
from urdfcheck.source.package.finder import display_name
from urdfcheck.source.text.values import attribute_number, attribute_numbers
from urdfcheck.source.text.xml import Element

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from urdfcheck.facts.mesh.measure import MeshFacts

# Triangles of one model that a report draws; more are made fewer. SO-101 has 320,000 and needs 1.4 MB.
MOST_TRIANGLES = 250_000
# A mesh that has a small part of them keeps at least so many.
FEWEST_TRIANGLES = 2_000
# Edges of holes in one mesh that are drawn.
MOST_HOLES = 3_000


def scene_of(model: Model, model_id: str, launches: Sequence[Launch], findings: Iterable[Finding] = ()) -> Scene:
    """The scene of a model, with the static transforms of the launch files that start it, and what the repairs of its findings
    make of it.

    A broken tree still gives links and joints: the report shows them without placements.
    """
    try:
        root, order = model.tree.root, model.tree.order
    except Unavailable:
        root, order = "", tuple(model.link_by_name)
    files = {path: place for place, path in enumerate(dict.fromkeys(_files(model)))}
    return Scene(
        model=model_id,
        root=root,
        links=tuple(_link(model, model.link_by_name[name], files) for name in order),
        joints=tuple(_joint(model, joint) for joint in model.joints),
        frames=tuple(SceneFrame(t.parent, t.child, _placed(t), t.at.span) for la in launches for t in la.transforms),
        meshes=tuple(_meshes(model, list(files))),
        overlaps=tuple(_overlaps(model)),
        ground=_ground(model),
        previews=tuple(_previews(model, findings)),
        launches=tuple(map(launch_scene, launches)),
    )


def _placed(static: StaticTransform) -> tuple[float, ...]:
    from urdfcheck.facts.motion.kinematics import quaternion_to_matrix, transform

    if static.xyz is None or (static.rpy is None and not any(static.quaternion or ())):
        return ()
    pose = transform(static.xyz, static.rpy or (0.0, 0.0, 0.0))
    if static.rpy is None and static.quaternion is not None:
        pose[:3, :3] = quaternion_to_matrix(static.quaternion)
    return _flat(pose)


# -- links and joints --------------------------------------------------------------------------------------------------


def _link(model: Model, link: Link, files: dict[Path, int]) -> SceneLink:
    from urdfcheck.facts.inertials.inertia_tensor import inertia_of, principal_moments

    inertial = None if link.inertial is None else _inertial(link.inertial)
    solid = model.solid(link) if model.tier != "source" else None
    mass = None if inertial is None else inertial.mass
    filled = None if solid is None or mass is None or not solid.volume > 0 else inertia_of(solid, mass)
    return SceneLink(
        name=link.name,
        inertial=inertial,
        density=None if solid is None or mass is None or not solid.volume > 0 else mass / solid.volume,
        drawn_com=() if solid is None else tuple(map(float, solid.com)),
        drawn_moments=() if filled is None else tuple(map(float, principal_moments(filled)[0])),
        world=_world(model, link.name),
        shapes=tuple(_shape(model, s, files) for s in (*link.visuals, *link.collisions)),
        span=link.element.span,
    )


def _inertial(inertial: Inertial) -> SceneInertia:
    from urdfcheck.facts.inertials.inertia_tensor import principal_frame, six_of

    mass, com, tensor = inertial.mass, inertial.origin.xyz or (), inertial.tensor_in_link
    if tensor is None:
        return SceneInertia(mass, com)
    moments, axes = principal_frame(tensor)
    return SceneInertia(
        mass, com, tuple(six_of(tensor)), tuple(map(float, moments)), _flat(axes), _impossible(inertial, mass)
    )


def _impossible(inertial: Inertial, mass: float | None) -> str:
    from urdfcheck.facts.inertials.inertia_tensor import digits_needed, validity

    assert inertial.tensor is not None
    if mass is not None and mass <= 0.0 and inertial.tensor.any():
        return "an inertia without a positive mass"
    found = validity(inertial.tensor)
    first, second, third = found.moments
    if not found.finite or (not found.positive_definite and inertial.tensor.any()):
        return f"the smallest principal moment is {first:.3g} kg m²"
    element = inertial.tensor_element
    if found.triangle or element is None or digits_needed([element.get(name) for name in TENSOR]).explained:
        return ""
    return f"{first:.3g} + {second:.3g} < {third:.3g} kg m²: the principal moments break the triangle inequality"


def _world(model: Model, link: str) -> tuple[float, ...] | None:
    try:
        return _flat(model.frames[link])
    except (Unavailable, KeyError):
        return None


def _shape(model: Model, shape: Shape, files: dict[Path, int]) -> SceneShape:
    pose, use = shape.origin.matrix, model.meshes.by_shape.get(id(shape))
    return SceneShape(
        role=shape.role,
        kind=shape.kind or "",
        size=model.drawn_scale(shape) or shape.size or (),
        pose=() if pose is None else _flat(pose),
        mesh=shape.mesh.value if shape.mesh is not None else "",
        file=None if use is None or use.resource.path is None else files.get(use.resource.path),
        color=_color(model, shape),
    )


def _color(model: Model, shape: Shape) -> tuple[float, ...] | None:
    """Of the shape's material, or of the robot's material of this name."""
    own = shape.element.child("material")
    if own is None:
        return None
    named = (m for m in model.robot.all("material") if m.get("name") == own.get("name"))
    for material in (own, *named):
        color = attribute_numbers(material.child("color"), "rgba", 4, ())
        if color and all(0.0 <= part <= 1.0 for part in color):
            return color
    return None


def _joint(model: Model, joint: Joint) -> SceneJoint:
    import numpy as np

    try:
        axis = model.axes.get(joint.name)
    except Unavailable:
        axis = None
    limited = joint.limit is not None and joint.type in {"revolute", "prismatic"}
    lower, upper = (joint.limit_value(name) if limited else None for name in ("lower", "upper"))
    pose, typed = joint.origin.matrix, joint.axis if joint.has_axis else None
    length = 0.0 if typed is None else float(np.linalg.norm(typed))
    mimic, dynamics = joint.mimic, joint.element.child("dynamics")
    return SceneJoint(
        name=joint.name,
        type=joint.type,
        parent=joint.parent,
        child=joint.child,
        axis=None if axis is None else tuple(float(round(a, 12)) for a in axis),
        lower=lower,
        upper=upper,
        span=joint.element.span,
        pose=() if pose is None else _flat(pose),
        turn=tuple(v / length for v in typed) if typed is not None and length > 0.0 else None,
        start=min(max(0.0, lower), upper) if lower is not None and upper is not None and lower <= upper else 0.0,
        mimic=None
        if mimic is None
        else (mimic.get("joint"), _number(mimic, "multiplier", 1.0), _number(mimic, "offset", 0.0)),
        effort=joint.limit_value("effort"),
        velocity=joint.limit_value("velocity"),
        damping=attribute_number(dynamics, "damping"),
        friction=attribute_number(dynamics, "friction"),
    )


def _number(element: Element, name: str, default: float) -> float:
    value = attribute_number(element, name)
    return default if value is None else value


# -- meshes ------------------------------------------------------------------------------------------------------------


def _files(model: Model) -> Iterator[Path]:
    """The mesh files that the links use and that can be looked at, in the order of the document."""
    for use in model.meshes.uses:
        if use.resource.path is not None and use.resource.exists:
            yield use.resource.path


def _meshes(model: Model, files: Sequence[Path]) -> Iterator[SceneMesh]:
    facts = model.meshes.facts
    distinct = {model.meshes.digests.get(path, ""): facts[path].n_triangles for path in files if path in facts}
    total = sum(distinct.values())
    share = 1.0 if total <= MOST_TRIANGLES else MOST_TRIANGLES / total
    drawings: dict[str, tuple[Drawing, ...]] = {}
    for path in files:
        name, digest, found = display_name(path), model.meshes.digests.get(path, ""), facts.get(path)
        if found is None:
            error = model.meshes.errors.get(path)
            yield SceneMesh(name, digest, problem="" if error is None else error.message)
            continue
        if digest not in drawings:
            drawings[digest] = tuple(_drawings(found, share))
        extents = found.bounds[1] - found.bounds[0]
        yield SceneMesh(
            name=name,
            digest=digest,
            format=found.format,
            bytes=path.stat().st_size,
            triangles=found.n_triangles,
            extents=tuple(map(float, extents)),
            unit=found.unit,
            watertight=found.watertight,
            open_edges=found.open_edges,
            drawings=drawings[digest],
        )


def _drawings(facts: MeshFacts, share: float) -> Iterator[Drawing]:
    """What is drawn of a mesh, one for each of its colours; the first has the holes of all."""
    import numpy as np

    colors = facts.colors
    if colors is None:
        yield _drawing(facts, facts.faces, None, share, _holes(facts))
        return
    of_face, rgba = colors
    holes = _holes(facts)
    for place in np.unique(of_face):
        color = None if place < 0 else tuple(map(float, rgba[place]))
        yield _drawing(facts, facts.faces[of_face == place], color, share, holes)
        holes = holes[:0]


def _drawing(
    facts: MeshFacts,
    faces: NDArray[np.int64],
    color: tuple[float, ...] | None,
    share: float,
    holes: NDArray[np.float64],
) -> Drawing:
    from urdfcheck.facts.mesh.codec import pack, wide

    packed = pack(facts.vertices, faces, holes, most=max(FEWEST_TRIANGLES, round(share * len(faces))))
    low, high = (tuple(map(float, ends)) for ends in (packed.low, packed.high))
    size = packed.vertices, packed.faces, packed.holes, wide(packed.vertices)
    return Drawing(*size, low, high, packed.data, color)


def _holes(facts: MeshFacts) -> NDArray[np.float64]:
    """The ends (n, 2, 3) of its open edges, of the longest where there are many."""
    import numpy as np

    if not facts.open_edges:
        return np.zeros((0, 2, 3))
    lines = facts.open_lines
    if len(lines) > MOST_HOLES:
        lines = lines[np.argsort(-np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1), kind="stable")[:MOST_HOLES]]
    return lines


# -- the whole robot ---------------------------------------------------------------------------------------------------


def _overlaps(model: Model) -> Iterator[SceneOverlap]:
    if model.tier != "full":
        return
    try:
        pairs = model.collisions.pairs
    except Unavailable:
        return
    for pair in pairs:
        contact = pair.contact
        if pair.relation == "far" and contact is not None and not contact.touching:
            yield SceneOverlap(pair.links, tuple(map(float, contact.point)), contact.depth)


def _ground(model: Model) -> SceneGround | None:
    if model.tier == "source":
        return None
    import numpy as np

    from urdfcheck.facts.motion.contact import stand
    from urdfcheck.model.ground.support_polygon import contacts, corners, is_free, masses

    try:
        weights = masses(model)
        if not weights or not is_free(model):
            return None
        points, owners = corners(model, {wheel.joint.child: wheel for wheel in model.wheels})
    except Unavailable:
        return None
    if not len(points):
        return None
    com = np.average([w.com for w in weights], axis=0, weights=[w.mass for w in weights])
    now = stand(points, owners, com)
    return SceneGround(
        height=float(points[:, 2].min()),
        contacts=tuple((name, tuple(map(float, at))) for name, at in contacts(model, points, owners, now).items()),
        support=tuple(tuple(map(float, corner)) for corner in now.polygon),
        com=tuple(map(float, com)),
    )


def _previews(model: Model, findings: Iterable[Finding]) -> Iterator[ScenePreview]:
    """What the repairs of findings make of joints' origins and of inertials."""
    from urdfcheck.model.repairs.edit_preview import edited

    for finding in findings:
        span = finding.location.span
        if span is None or finding.fix is None or not finding.fix.edits:
            continue
        for joint in model.joints:
            origin = joint.element.child("origin")
            changed = None if origin is None else edited(origin, finding.fix.edits)
            pose = None if changed is None else Pose(changed).matrix
            if pose is not None:
                yield ScenePreview(finding.code, finding.message_id, span, joint=joint.name, pose=_flat(pose))
        for link in model.links:
            changed = None if link.inertial is None else edited(link.inertial.element, finding.fix.edits)
            if changed is not None:
                after = _inertial(Inertial(changed))
                yield ScenePreview(finding.code, finding.message_id, span, link=link.name, inertial=after)


def _flat(matrix: NDArray[np.float64]) -> tuple[float, ...]:
    return tuple(float(v) for v in matrix.ravel())
