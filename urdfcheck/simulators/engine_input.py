"""The input of the engines: the model as a document, and its numbers as its author typed them."""

from __future__ import annotations

import codecs
import html
import math
import random
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from urdfcheck.core import FactUnavailableError
from urdfcheck.model import Model
from urdfcheck.model.parts import Joint
from urdfcheck.simulators.outcome import EngineDynamics, EngineInput, TypedRobot, Vector
from urdfcheck.source.load import Source
from urdfcheck.source.text.xml import Element, quote_attribute
from urdfcheck.system.files import read_regular

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array

# Number of random configurations that are compared, and their seed, so that they are always the same.
SAMPLES, SEED = 4, 20
# Metres by which a prismatic joint is moved at most; others are moved by up to half a turn.
REACH = 0.5
# No dynamics are computed for more joints, because mass matrices grow too large. Of 100 published robots none has 150.
MOST_JOINTS = 300
# Start position (rad or m) of joints without limits: at 0 a symmetric robot may be balanced by chance.
_START = 0.3
_BLANKS = re.compile(rb"[ \t\r\n]*")
_ROOT = re.compile(rb"<([\w:.-]+)(?=[\s/>])")
# What may precede the first element, with its end.
_SKIPPED = ((b"<?", b"?>"), (b"<!--", b"-->"))
_FILENAME = re.compile(rb"""(\bfilename\s*=\s*)("[^"]*"|'[^']*')""")


def build_input(source: Source, model: Model | None) -> EngineInput | None:
    """Build the input of the engines; None for a model that could not be read or expanded, and for what is no robot.

    MuJoCo and Gazebo go by the root element, and open any file that a model of their own formats includes.
    """
    document = _read_document(source)
    if document is None or find_root_tag(document) != b"robot":
        return None
    if model is None:
        return EngineInput(document=document)
    document = _FILENAME.sub(lambda m: m[1] + _replace_filename(m[2], _resolve_meshes(model)), document)
    children = {joint.child for joint in model.joints if joint.type not in {"fixed", ""}}
    moved = tuple(dict.fromkeys(link.name for link in model.links if link.name in children))
    try:
        order = model.tree.order
    except FactUnavailableError:
        return EngineInput(document=document, moved_links=moved)
    moving = [model.tree.parent_joint[name] for name in order[1:]]
    joints = [joint for joint in moving if _has_one_dof(joint)]
    samples = tuple(_iter_samples(joints))
    start = tuple(_choose_start(joint) for joint in joints)
    robot = EngineInput(
        document=document,
        moved_links=moved,
        joints=tuple(joint.name for joint in joints),
        samples=samples,
        start=start,
    )
    typed = TypedRobot(
        root=model.tree.root,
        heads={name: model.tree.list_body_links(name)[0] for name in order},
        joints=tuple(joint.name for joint in moving),
        masses=_sum_body_masses(model),
        limits={j.name: limits for j in joints if (limits := _get_limits(j)) is not None},
        shapes=sum(len(link.collisions) for link in model.links),
        motion=_compute_dynamics(model, robot) if len(joints) <= MOST_JOINTS else None,
    )
    return replace(robot, typed=typed)


def find_root_tag(document: bytes) -> bytes:
    """Return the name of the first element, as parsers find it that decode nothing (tinyxml2).

    Empty if anything but declarations and comments comes first.
    """
    at, end = len(codecs.BOM_UTF8) if document.startswith(codecs.BOM_UTF8) else 0, 0
    while end >= 0:
        at = _BLANKS.match(document, at).end()  # type: ignore[union-attr]  # it matches nothing too
        opened = next((marks for marks in _SKIPPED if document.startswith(marks[0], at)), None)
        if opened is None:
            found = _ROOT.match(document, at)
            return b"" if found is None else found[1]
        end = document.find(opened[1], at + len(opened[0]))
        at = end + len(opened[1])
    return b""


def _read_document(source: Source) -> bytes | None:
    """Return the bytes of a URDF as they are, or of the expanded xacro."""
    if source.is_xacro:
        if source.root is None:
            return None
        return "".join(('<?xml version="1.0"?>\n', *_iter_xml(source.root))).encode("utf-8", "surrogatepass")
    if not source.finder.can_open(source.path):
        return None
    try:
        return read_regular(source.path)
    except OSError:
        return None


def _iter_xml(element: Element) -> Iterator[str]:
    attributes = "".join(f" {a.name}={quote_attribute(a.value)}" for a in element.attributes.values())
    yield f"<{element.tag}{attributes}>{html.escape(element.text, quote=False)}"
    for child in element.children:
        yield from _iter_xml(child)
    yield f"</{element.tag}>\n"


def _resolve_meshes(model: Model) -> Mapping[str, str]:
    """Map the typed names of meshes that were found to their absolute paths."""
    finder, base = model.source.finder, model.source.path.parent
    typed = {
        s.mesh_filename.value
        for link in model.links
        for s in (*link.visuals, *link.collisions)
        if s.mesh_filename is not None
    }
    found = {text: finder.resolve_resource(text, base) for text in sorted(typed)}
    return {text: str(f.path.absolute()) for text, f in found.items() if f.exists and f.path is not None}


def _replace_filename(literal: bytes, meshes: Mapping[str, str]) -> bytes:
    path = meshes.get(html.unescape(literal[1:-1].decode("utf-8", "replace")))
    return literal if path is None else quote_attribute(path).encode("utf-8", "surrogateescape")


def _has_one_dof(joint: Joint) -> bool:
    """Whether a joint has one degree of freedom that moves."""
    return joint.type in {"revolute", "continuous", "prismatic"}


def _sum_body_masses(model: Model) -> Mapping[str, float | None]:
    found: dict[str, float | None] = {}
    for name in model.tree.order:
        head, inertial = model.tree.list_body_links(name)[0], model.link_by_name[name].inertial
        mass, known = (0.0 if inertial is None else inertial.mass), found.get(head, 0.0)
        found[head] = None if mass is None or known is None else known + mass
    return found


def _get_limits(joint: Joint) -> tuple[float, float] | None:
    if joint.type == "continuous" or joint.limit is None:
        return None
    lower, upper = joint.get_limit_value("lower"), joint.get_limit_value("upper")
    return None if lower is None or upper is None else (lower, upper)


def _iter_samples(joints: Sequence[Joint]) -> Iterator[Vector]:
    chance = random.Random(SEED)
    for _ in range(SAMPLES):
        yield tuple(chance.uniform(-1.0, 1.0) * (REACH if j.type == "prismatic" else math.pi) for j in joints)


def _choose_start(joint: Joint) -> float:
    lower, upper = _get_limits(joint) or (0.0, 2 * _START)
    middle = (lower + upper) / 2
    return middle if abs(middle) <= math.pi else 0.0


def _compute_dynamics(model: Model, robot: EngineInput) -> EngineDynamics | None:
    """Compute the dynamics of the typed numbers with Pinocchio; None where one is missing or malformed."""
    import numpy as np
    import pinocchio as pin

    built = pin.Model()
    supports: dict[str, tuple[int, Array]] = {model.tree.root: (0, np.eye(4))}
    waiting = list(model.tree.child_joints[model.tree.root])
    while waiting:  # depth first: Pinocchio requires the descendants of a joint to follow it directly
        joint = waiting.pop()
        waiting += model.tree.child_joints[joint.child]
        base, before = supports[joint.parent]
        origin, axis = joint.origin.matrix, joint.axis
        if origin is None or (joint.has_axis and (axis is None or not any(axis))):
            return None
        placed = before @ origin
        if joint.type == "fixed":
            supports[joint.child] = base, placed
            continue
        kind = _make_joint_model(joint)
        if kind is None:
            return None
        supports[joint.child] = built.addJoint(base, kind, pin.SE3(placed), joint.name), np.eye(4)
    for name, (index, placed) in supports.items():
        inertial = model.link_by_name[name].inertial
        if inertial is None:
            continue
        centre, tensor, mass = inertial.origin.matrix, inertial.tensor_in_link, inertial.mass
        if centre is None or tensor is None or mass is None:
            return None
        built.appendBodyToJoint(index, make_inertia(mass, centre[:3, 3], tensor), pin.SE3(placed))
    return compute_dynamics(built, robot)


def _make_joint_model(joint: Joint) -> Any:
    """Make Pinocchio's model of a joint; None for an unknown type."""
    import numpy as np
    import pinocchio as pin

    if joint.type == "floating":
        return pin.JointModelFreeFlyer()
    if joint.type == "planar":
        return pin.JointModelPlanar()
    if not _has_one_dof(joint) or joint.axis is None:
        return None
    axis = np.array(joint.axis) / np.linalg.norm(joint.axis)
    return (
        pin.JointModelPrismaticUnaligned(axis) if joint.type == "prismatic" else pin.JointModelRevoluteUnaligned(axis)
    )


def make_inertia(mass: float, centre: Array, tensor: Array) -> Any:
    """Make a ``pinocchio.Inertia``, also an impossible one: its constructor validates, its setters do not."""
    import pinocchio as pin

    body = pin.Inertia.Zero()
    body.mass, body.lever, body.inertia = mass, centre, tensor
    return body


def compute_dynamics(built: Any, robot: EngineInput) -> EngineDynamics | None:
    """Compute the dynamics of a ``pinocchio.Model``; None where it lacks a joint."""
    import numpy as np
    import pinocchio as pin

    if not all(built.existJointName(name) for name in robot.joints):
        return None
    parts = [built.joints[built.getJointId(name)] for name in robot.joints]
    rows = [part.idx_v for part in parts]
    data = built.createData()
    masses, torques = [], []
    for values in robot.samples:
        q = _make_configuration(built, parts, values)
        matrix = pin.crba(built, data, q)
        matrix = np.triu(matrix) + np.triu(matrix, 1).T
        masses.append(tuple(map(tuple, matrix[np.ix_(rows, rows)].tolist())))
        torques.append(tuple(pin.computeGeneralizedGravity(built, data, q)[rows].tolist()))
    falls: Vector = ()
    if built.nv == len(rows):
        zero = np.zeros(built.nv)
        falls = tuple(pin.aba(built, data, _make_configuration(built, parts, robot.start), zero, zero)[rows].tolist())
    return EngineDynamics(joints=robot.joints, masses=tuple(masses), torques=tuple(torques), accelerations=falls)


def _make_configuration(built: Any, parts: Sequence[Any], values: Vector) -> Array:
    import pinocchio as pin

    q: Array = pin.neutral(built)
    for part, value in zip(parts, values, strict=True):
        # A continuous joint is represented by cosine and sine.
        q[part.idx_q : part.idx_q + part.nq] = value if part.nq == 1 else (math.cos(value), math.sin(value))
    return q
