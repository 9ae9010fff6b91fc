"""A robot as bodies, joints and shapes in plain values, whatever format it was typed in. Standard library only.

Poses are 4x4 row-major; lengths are in m, masses in kg, angles in rad. A value that is missing or malformed is None or empty.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import field, replace

from urdfcheck.core.findings import Span
from urdfcheck.core.records import dataclass


@dataclass(frozen=True, slots=True)
class Trace:
    """Where a value comes from."""

    places: tuple[Span, ...] = ()
    """Its own text first, then the definitions that it was computed from, nearest first."""
    calls: tuple[Span, ...] = ()
    """The macro calls and includes that brought it in, innermost first."""

    @property
    def start(self) -> Span | None:
        """Where it is typed."""
        return self.places[0] if self.places else None


NO_TRACE = Trace()


@dataclass(frozen=True, slots=True, kw_only=True)
class MechanismShape:
    """A drawn or colliding shape of a link."""

    role: str
    """visual | collision."""
    kind: str
    """mesh | box | cylinder | sphere | capsule; empty where it is unknown."""
    size: tuple[float, ...]
    """Box x y z, cylinder and capsule r l, sphere r; of a mesh the scale along x y z."""
    pose: tuple[float, ...]
    """In the link frame."""
    mesh: str = ""
    """The mesh file as typed."""
    digest: str = ""
    """Digest of the content of the mesh file, if it was read."""
    file: str = ""
    """Path of the mesh file on this machine, if it was read."""
    low: tuple[float, ...] = ()
    """Lower bound of the mesh along x y z, scaled, in m."""
    high: tuple[float, ...] = ()
    """Upper bound of the mesh along x y z, scaled, in m."""
    volume: float | None = None
    """m³; None where the shape is not closed or could not be read."""
    closed: bool | None = None
    """Whether the mesh is closed; None where it could not be read, and for other shapes."""
    color: tuple[float, ...] = ()
    """r g b a of its material."""
    texture: str = ""
    """The texture of its material as typed."""
    traces: Mapping[str, Trace] = field(default_factory=dict)
    """``shape``, ``pose``, ``geometry`` and ``material``: where each was typed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MechanismLink:
    """A link: a named frame with the mass and the shapes that are given in it."""

    name: str
    mass: float | None
    """None where it has no inertial, or a malformed one."""
    com: tuple[float, ...] = ()
    """In the link frame."""
    tensor: tuple[float, ...] = ()
    """ixx ixy ixz iyy iyz izz in kg m², about the COM in the axes of the link frame."""
    has_inertial: bool = False
    shapes: tuple[MechanismShape, ...] = ()
    """In the order of the text."""
    traces: Mapping[str, Trace] = field(default_factory=dict)
    """``link``, ``mass``, ``com`` and ``tensor``: where each was typed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MechanismJoint:
    """A joint."""

    name: str
    type: str
    """fixed | revolute | continuous | prismatic | planar | floating."""
    parent: str
    child: str
    pose: tuple[float, ...]
    """Pose of the child's frame in the parent's with the joint at zero."""
    axis: tuple[float, ...]
    """Unit vector in the child's frame; empty for a joint without axis."""
    lower: float | None = None
    """Lower limit in rad or m; None where the motion is not limited."""
    upper: float | None = None
    """Upper limit in rad or m; None where the motion is not limited."""
    effort: float | None = None
    """N or N·m."""
    velocity: float | None = None
    """m/s or rad/s."""
    damping: float = 0.0
    friction: float = 0.0
    mimic: tuple[str, float, float] | None = None
    """The joint that it follows, the multiplier and the offset."""
    traces: Mapping[str, Trace] = field(default_factory=dict)
    """``joint``, ``type``, ``parent``, ``child``, ``pose``, ``axis``, ``mimic`` and each limit and friction value by its name."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MechanismExtra:
    """Anything else that the description holds, such as a plugin or a transmission: compared as it is written."""

    label: str
    """What it is: ``gazebo[base]``, ``transmission[t]``."""
    content: str
    """Its elements, attributes and texts in one notation."""
    trace: Trace = NO_TRACE


@dataclass(frozen=True, slots=True, kw_only=True)
class MechanismCondition:
    """An ``xacro:if`` or ``xacro:unless``."""

    tag: Span
    end: int
    """The last line of what it may leave out."""
    definitions: tuple[Span, ...] = ()
    """The tags of the properties and arguments that it reads, itself or by way of others."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MechanismStance:
    """How a robot stands that is meant to, upright on level ground with all joints at zero."""

    margin: float
    """Distance from the COM's plumb line to the nearest edge of the support polygon in m, negative outside."""
    tip_angle: float
    """Angle in rad by which the ground can be tilted before the robot tips over; negative if it tips over on level ground."""
    tilt: float
    """Angle in rad by which the robot leans at rest; infinite if it falls over."""
    polygon: tuple[tuple[float, ...], ...]
    """Corners of the support polygon, x y z in root coordinates, anticlockwise from above."""
    supports: tuple[str, ...]
    """The links that touch the ground."""
    com: tuple[float, ...]
    """Of the whole robot, in root coordinates."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotMechanism:
    """A robot that is one tree of links."""

    model: str
    """Id of the model."""
    name: str
    """Name of the robot."""
    root: str
    """Name of the root link."""
    name_trace: Trace = NO_TRACE
    """Where the name of the robot is typed."""
    links: tuple[MechanismLink, ...]
    """From the root outwards."""
    joints: tuple[MechanismJoint, ...]
    """In the order of their children in `links`."""
    is_grounded: bool = False
    """Whether the root is the ground itself, to which simulators hold what is fixed to it."""
    stance: MechanismStance | None = None
    """None for a robot that is not meant to stand by itself, or of which that is not known."""
    extras: tuple[MechanismExtra, ...] = ()
    main_file: str = ""
    """Name of the file that the model was read from, as spans call it."""
    digests: Mapping[str, str] = field(default_factory=dict)
    """Digest of the text of each file that makes up the model, by name."""
    idle_lines: Mapping[str, frozenset[int]] = field(default_factory=dict)
    """Lines of xacro files, by name, with tags that make no part of the robot: of branches that its arguments leave out, and
    of macros that nothing calls."""
    conditions: tuple[MechanismCondition, ...] = ()
    """What decides whether a part is in it."""

    def compute_digest(self) -> str:
        """Return a digest of everything that is compared: robots with one digest are the same, whatever files they are from."""
        links = [
            replace(link, traces={}, shapes=tuple(replace(shape, file="", traces={}) for shape in link.shapes))
            for link in self.links
        ]
        joints = [replace(joint, traces={}) for joint in self.joints]
        extras = sorted((extra.label, extra.content) for extra in self.extras)
        values = (self.name, self.root, links, joints, self.is_grounded, self.stance, extras)
        return hashlib.sha256(repr(values).encode("utf-8", "surrogatepass")).hexdigest()

    @property
    def mesh_files(self) -> set[str]:
        """The paths of the mesh files that were read."""
        return {shape.file for link in self.links for shape in link.shapes if shape.file}

    @property
    def trace_files(self) -> set[str]:
        """The names of the files that the traces point into."""
        shapes = (shape for link in self.links for shape in link.shapes)
        parts = [part.traces for part in self.links] + [part.traces for part in self.joints]
        traces = [self.name_trace] + [
            trace for part in (*parts, *(shape.traces for shape in shapes)) for trace in part.values()
        ]
        return {span.file for t in (*traces, *(e.trace for e in self.extras)) for span in (*t.places, *t.calls)}
