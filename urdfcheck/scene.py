"""What outputs that draw need of a model, as plain values."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from urdfcheck.core import Scene, SceneFrame, SceneJoint, SceneLink, SceneShape, Unavailable
from urdfcheck.model import Joint, Link, Model, Shape
from urdfcheck.source.launch import Launch

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


def scene_of(model: Model, model_id: str, launches: Sequence[Launch]) -> Scene:
    """The scene of a model, with the static transforms of the launch files that start it.

    A broken tree still gives links and joints: the report shows them without placements.
    """
    try:
        root, order = model.tree.root, model.tree.order
    except Unavailable:
        root, order = "", tuple(model.link_by_name)
    return Scene(
        model=model_id,
        root=root,
        links=tuple(_link(model, model.link_by_name[name]) for name in order),
        joints=tuple(_joint(model, joint) for joint in model.joints),
        frames=tuple(
            SceneFrame(t.parent, t.child, t.xyz or (), t.rpy or (), t.at.span) for la in launches for t in la.transforms
        ),
    )


def _link(model: Model, link: Link) -> SceneLink:
    from urdfcheck.facts.inertia import principal_moments

    inertial = link.inertial
    mass = None if inertial is None else inertial.mass
    com = None if inertial is None else inertial.origin.xyz
    tensor = None if inertial is None else inertial.tensor_in_link
    moments = None if tensor is None else principal_moments(tensor)[0]
    solid = model.solid(link) if model.tier != "source" else None
    return SceneLink(
        name=link.name,
        mass=mass,
        com=com,
        inertia=None if tensor is None else tuple(float(tensor[i, j]) for i in range(3) for j in range(i, 3)),
        principal=None if moments is None else tuple(map(float, moments)),
        density=mass / solid.volume if mass is not None and solid is not None and solid.volume > 0 else None,
        world=_world(model, link.name),
        shapes=tuple(_shape(model, s) for s in (*link.visuals, *link.collisions)),
        span=link.element.span,
    )


def _world(model: Model, link: str) -> tuple[float, ...] | None:
    try:
        return _flat(model.frames[link])
    except (Unavailable, KeyError):
        return None


def _shape(model: Model, shape: Shape) -> SceneShape:
    facts = model.meshes.facts_of(shape)
    pose = shape.origin.matrix
    return SceneShape(
        role=shape.role,
        kind=shape.kind or "",
        size=shape.size or (),
        pose=() if pose is None else _flat(pose),
        mesh=shape.mesh.value if shape.mesh is not None else "",
        triangles=0 if facts is None else facts.n_triangles,
        watertight=None if facts is None else facts.watertight,
    )


def _joint(model: Model, joint: Joint) -> SceneJoint:
    try:
        axis = model.axes.get(joint.name)
    except Unavailable:
        axis = None
    limited = joint.limit is not None and joint.type in {"revolute", "prismatic"}
    return SceneJoint(
        name=joint.name,
        type=joint.type,
        parent=joint.parent,
        child=joint.child,
        axis=None if axis is None else tuple(float(round(a, 12)) for a in axis),
        lower=joint.limit_value("lower") if limited else None,
        upper=joint.limit_value("upper") if limited else None,
        span=joint.element.span,
    )


def _flat(matrix: NDArray[np.float64]) -> tuple[float, ...]:
    return tuple(float(v) for v in matrix.ravel())
