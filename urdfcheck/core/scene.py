"""A robot as plain values, for the outputs that draw it. Standard library only.

Poses are 4x4 row-major and empty where they are malformed; lengths are in m, masses in kg, angles in rad.
"""

from __future__ import annotations

from urdfcheck.core.findings import Span
from urdfcheck.core.records import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class SceneShape:
    """A drawn or colliding shape."""

    role: str
    kind: str
    """mesh | box | cylinder | sphere | capsule."""
    size: tuple[float, ...]
    """As URDF gives it: box x y z, cylinder and capsule r l, sphere r; of a mesh the metres per file unit along x y z, with
    COLLADA's unit, as RViz draws it."""
    pose: tuple[float, ...]
    """In the link frame."""
    mesh: str = ""
    """The mesh file as typed."""
    file: int | None = None
    """Index of the mesh file in `Scene.meshes`."""
    color: tuple[float, ...] | None = None
    """r g b a of its material."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SceneDrawing:
    """A mesh, or the part of it that has one color, as `urdfcheck.facts.mesh.codec` packs it."""

    vertices: int
    """Number of corners."""
    faces: int
    """Number of triangles."""
    holes: int
    """Number of open edges of the file."""
    wide: bool
    """Whether an index has three bytes."""
    low: tuple[float, ...]
    """Lower bound of the corners in file units."""
    high: tuple[float, ...]
    """Upper bound of the corners in file units."""
    data: bytes
    color: tuple[float, ...] | None = None
    """r g b a."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SceneMesh:
    """A mesh file, measured in its own units."""

    name: str
    """Its path as findings write it."""
    digest: str = ""
    """Digest of its content."""
    format: str = ""
    bytes: int = 0
    triangles: int = 0
    extents: tuple[float, ...] = ()
    """Along x y z."""
    unit: float | None = None
    """Metres per unit where COLLADA declares it."""
    watertight: bool | None = None
    open_edges: int = 0
    problem: str = ""
    """Why it could not be read, in words."""
    drawings: tuple[SceneDrawing, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class SceneInertia:
    """An inertial; malformed values are None or empty."""

    mass: float | None = None
    com: tuple[float, ...] = ()
    """In the link frame."""
    tensor: tuple[float, ...] = ()
    """ixx ixy ixz iyy iyz izz in kg m², about the COM in the axes of the link frame."""
    moments: tuple[float, ...] = ()
    """Principal moments, ascending."""
    axes: tuple[float, ...] = ()
    """3x3 row-major with the directions of the principal moments as columns."""
    impossible: str = ""
    """Why no body can have these values, in words."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SceneLink:
    """A link."""

    name: str
    inertial: SceneInertia | None
    """None where the link has none."""
    density: float | None
    """kg/m³ of its mass in its drawn geometry."""
    drawn_com: tuple[float, ...]
    """COM of the drawn geometry filled with the mass, in the link frame; empty where that geometry is not closed."""
    drawn_moments: tuple[float, ...]
    """Principal moments of the drawn geometry filled with the mass, ascending; empty where it is not closed."""
    world: tuple[float, ...] | None
    """Pose in root coordinates with all joints at zero."""
    shapes: tuple[SceneShape, ...]
    span: Span | None
    start: tuple[float, ...] | None = None
    """Pose in root coordinates with every joint at its start and followers where ``<mimic>`` puts them, as the report draws the
    robot; None where that is ``world``."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SceneJoint:
    """A joint."""

    name: str
    type: str
    parent: str
    child: str
    axis: tuple[float, ...] | None
    """Unit vector in base coordinates with all joints at zero."""
    lower: float | None
    """Lower limit in rad or m."""
    upper: float | None
    """Upper limit in rad or m."""
    span: Span | None
    pose: tuple[float, ...] = ()
    """Pose of the child's frame in the parent's with the joint at zero."""
    turn: tuple[float, ...] | None = None
    """The axis as a unit vector in the joint's frame."""
    start: float = 0.0
    """The position nearest to zero that the limits allow."""
    mimic: tuple[str, float, float] | None = None
    """The joint that it follows, the multiplier and the offset."""
    effort: float | None = None
    """N or Nm."""
    velocity: float | None = None
    """rad/s or m/s."""
    damping: float | None = None
    friction: float | None = None


@dataclass(frozen=True, slots=True)
class SceneOverlap:
    """Two links whose collision shapes overlap at the start."""

    links: tuple[str, str]
    point: tuple[float, ...]
    """Middle of the region in root coordinates."""
    depth: float


@dataclass(frozen=True, slots=True)
class SceneGround:
    """A robot on a plane, upright and with all joints at zero, in root coordinates."""

    height: float
    """Height of the plane."""
    contacts: tuple[tuple[str, tuple[float, ...]], ...]
    """Each link that touches the plane, and where."""
    support: tuple[tuple[float, ...], ...]
    """Corners of the support polygon in order."""
    com: tuple[float, ...]
    """COM of the whole robot."""
    stands: bool = True
    """Whether the COM is above the polygon, to within the slack that DYN004 allows."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ScenePreview:
    """What the repair of a finding changes in a joint or in the inertial of a link."""

    code: str
    message_id: str
    at: Span
    """Place of the finding, which code, message id and place identify."""
    joint: str = ""
    pose: tuple[float, ...] = ()
    """Pose of the repaired joint, as in `SceneJoint`."""
    link: str = ""
    inertial: SceneInertia | None = None
    """Repaired inertial of the link."""


@dataclass(frozen=True, slots=True)
class SceneFrame:
    """A static transform that a launch file publishes beside the model."""

    parent: str
    child: str
    pose: tuple[float, ...]
    """Pose of the child's frame in the parent's."""
    span: Span | None


@dataclass(frozen=True, slots=True, order=True)
class ScenePort:
    """A connection of a node of a launch file."""

    kind: str
    """topic | service | parameter | file."""
    name: str
    """As ROS resolves it; parts that the launch file alone does not determine remain as typed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SceneNode:
    """A program that a launch file starts."""

    kind: str
    """node | launch file (one that was not read) | process."""
    name: str
    """Name with its namespace."""
    program: str
    """package/executable."""
    purpose: str
    """What a well-known program does; empty for any other, whose ``reads`` and ``writes`` are unknown."""
    reads: tuple[ScenePort, ...]
    writes: tuple[ScenePort, ...]
    condition: str
    """Condition of its start as typed, empty where it always starts."""
    off: bool
    """Whether it does not start with the arguments' defaults."""
    facts: tuple[tuple[str, str], ...]
    """Further facts, by name and value."""
    spans: tuple[Span, ...]
    """Where it is typed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SceneParameter:
    """A parameter that a launch file sets."""

    port: ScenePort
    """The port by which nodes read it."""
    origin: str
    """A file, a value or a command."""
    problem: str
    """Why the origin is unknown, in words."""
    condition: str
    """As in `SceneNode`."""
    off: bool
    """As in `SceneNode`."""
    spans: tuple[Span, ...]
    """Where it is typed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SceneLaunch:
    """A launch file: what it starts, and the known connections between these nodes."""

    file: str
    dialect: str
    """ros1 | ros2 | python."""
    nodes: tuple[SceneNode, ...]
    parameters: tuple[SceneParameter, ...]
    notes: tuple[str, ...] = ()
    """Parts that could not be read, in words."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Scene:
    """A model as outputs that draw it need it."""

    model: str
    root: str
    """Name of the root link."""
    links: tuple[SceneLink, ...]
    joints: tuple[SceneJoint, ...]
    frames: tuple[SceneFrame, ...]
    meshes: tuple[SceneMesh, ...] = ()
    overlaps: tuple[SceneOverlap, ...] = ()
    ground: SceneGround | None = None
    previews: tuple[ScenePreview, ...] = ()
    launches: tuple[SceneLaunch, ...] = ()
