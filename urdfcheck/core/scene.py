"""A robot as plain values, for the outputs that draw it. Standard library only."""

from __future__ import annotations

from dataclasses import dataclass

from urdfcheck.core.findings import Span


@dataclass(frozen=True, slots=True)
class SceneShape:
    """A drawn or colliding shape. ``kind``: mesh | box | cylinder | sphere | capsule; ``size`` in metres as URDF gives it
    (box x y z, cylinder and capsule r l, sphere r, mesh: metres per file unit along x y z, with COLLADA's unit, as RViz draws
    it); ``pose`` 4x4 row-major in the link frame, empty where it is malformed; ``mesh`` as typed, and ``file`` its place in
    `Scene.meshes`; ``color`` r g b a of its material."""

    role: str
    kind: str
    size: tuple[float, ...]
    pose: tuple[float, ...]
    mesh: str = ""
    file: int | None = None
    color: tuple[float, ...] | None = None


@dataclass(frozen=True, slots=True)
class SceneDrawing:
    """A mesh, or what has one ``color`` of it, to be drawn, as `urdfcheck.facts.mesh.codec` packs it. ``low``, ``high``: its
    bounds in file units; ``vertices``, ``faces``, ``holes``: how many corners, triangles and open edges (those of the file) it
    has; ``wide``: three bytes per index."""

    vertices: int
    faces: int
    holes: int
    wide: bool
    low: tuple[float, ...]
    high: tuple[float, ...]
    data: bytes
    color: tuple[float, ...] | None = None


@dataclass(frozen=True, slots=True)
class SceneMesh:
    """A mesh file, measured in its own units. ``name``: its path as findings call it; ``digest`` of its content; ``extents``
    along x y z; ``unit``: metres per unit where COLLADA declares it; ``problem``: why it could not be read, in words."""

    name: str
    digest: str = ""
    format: str = ""
    bytes: int = 0
    triangles: int = 0
    extents: tuple[float, ...] = ()
    unit: float | None = None
    watertight: bool | None = None
    open_edges: int = 0
    problem: str = ""
    drawings: tuple[SceneDrawing, ...] = ()


@dataclass(frozen=True, slots=True)
class SceneInertia:
    """An inertial: ``mass`` in kg and ``com`` in metres in the link frame, ``tensor`` (ixx ixy ixz iyy iyz izz, kg m²) about
    the COM in the axes of the link frame, ``moments`` principal and ascending, ``axes`` 3x3 row-major with their directions
    as columns; ``impossible``: why no body can be like that, in words. What is malformed is None or empty."""

    mass: float | None = None
    com: tuple[float, ...] = ()
    tensor: tuple[float, ...] = ()
    moments: tuple[float, ...] = ()
    axes: tuple[float, ...] = ()
    impossible: str = ""


@dataclass(frozen=True, slots=True)
class SceneLink:
    """A link: its ``inertial``, None where it has none; ``density`` in kg/m³ of its mass in its drawn geometry, and what that
    geometry, filled with the mass, would have as COM (``drawn_com``, link frame) and principal moments (``drawn_moments``,
    ascending), None or empty where it is not closed; ``world`` 4x4 row-major with all joints at zero."""

    name: str
    inertial: SceneInertia | None
    density: float | None
    drawn_com: tuple[float, ...]
    drawn_moments: tuple[float, ...]
    world: tuple[float, ...] | None
    shapes: tuple[SceneShape, ...]
    span: Span | None


@dataclass(frozen=True, slots=True)
class SceneJoint:
    """A joint: ``pose`` 4x4 row-major of the child's frame in the parent's with the joint at zero, empty where it is malformed;
    ``turn`` the axis in the joint's frame, a unit vector, ``axis`` the same in base coordinates with all joints at zero; limits
    in rad or m, effort in N or Nm, ``velocity`` in rad/s or m/s; ``start`` the position nearest to zero that the limits allow;
    ``mimic``: the joint that it follows, with multiplier and offset."""

    name: str
    type: str
    parent: str
    child: str
    axis: tuple[float, ...] | None
    lower: float | None
    upper: float | None
    span: Span | None
    pose: tuple[float, ...] = ()
    turn: tuple[float, ...] | None = None
    start: float = 0.0
    mimic: tuple[str, float, float] | None = None
    effort: float | None = None
    velocity: float | None = None
    damping: float | None = None
    friction: float | None = None


@dataclass(frozen=True, slots=True)
class SceneOverlap:
    """Two links whose collision shapes overlap at the start: the middle of the region in root coordinates, ``depth`` in m."""

    links: tuple[str, str]
    point: tuple[float, ...]
    depth: float


@dataclass(frozen=True, slots=True)
class SceneGround:
    """A robot set down upright with all joints at zero, in root coordinates: the ``height`` of the ground, where each link
    touches it, the corners of the support polygon in order, and the COM of the whole."""

    height: float
    contacts: tuple[tuple[str, tuple[float, ...]], ...]
    support: tuple[tuple[float, ...], ...]
    com: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class ScenePreview:
    """What the repair of the finding (code, message id, place) makes of a joint (``pose``, as in `SceneJoint`) or of a link's
    ``inertial``."""

    code: str
    message_id: str
    at: Span
    joint: str = ""
    pose: tuple[float, ...] = ()
    link: str = ""
    inertial: SceneInertia | None = None


@dataclass(frozen=True, slots=True)
class SceneFrame:
    """A static transform that a launch file publishes beside the model; ``pose`` 4x4 row-major of the child's frame in the
    parent's, empty where it is malformed."""

    parent: str
    child: str
    pose: tuple[float, ...]
    span: Span | None


@dataclass(frozen=True, slots=True, order=True)
class ScenePort:
    """What a node of a launch file is connected to. ``kind``: topic | service | parameter | file; ``name`` as ROS resolves it,
    with what a launch file alone does not tell left as typed."""

    kind: str
    name: str


@dataclass(frozen=True, slots=True)
class SceneNode:
    """What a launch file starts. ``kind``: node | launch file (one that was not read) | process; ``name`` of a node with its
    namespace, ``program`` as package/executable; ``purpose``: what a well-known program does, empty for any other, whose
    ``reads`` and ``writes`` are unknown; ``condition``: under which it is started, as typed, empty where always; ``off``: not
    with the arguments' defaults; ``facts``: what else is worth knowing of it, name and value; ``spans``: where it is typed."""

    kind: str
    name: str
    program: str
    purpose: str
    reads: tuple[ScenePort, ...]
    writes: tuple[ScenePort, ...]
    condition: str
    off: bool
    facts: tuple[tuple[str, str], ...]
    spans: tuple[Span, ...]


@dataclass(frozen=True, slots=True)
class SceneParameter:
    """A parameter that a launch file sets: the ``port`` that nodes read it by, its ``origin`` (a file, a value or a command) and
    the ``problem``: why that is not known, in words."""

    port: ScenePort
    origin: str
    problem: str
    condition: str
    off: bool
    spans: tuple[Span, ...]


@dataclass(frozen=True, slots=True)
class SceneLaunch:
    """A launch file: what it starts, with what flows between these nodes as far as that is known. ``dialect``: ros1 | ros2 |
    python; ``notes``: what of it could not be read, in words."""

    file: str
    dialect: str
    nodes: tuple[SceneNode, ...]
    parameters: tuple[SceneParameter, ...]
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Scene:
    """What outputs that draw need of a model, as plain values."""

    model: str
    root: str
    links: tuple[SceneLink, ...]
    joints: tuple[SceneJoint, ...]
    frames: tuple[SceneFrame, ...]
    meshes: tuple[SceneMesh, ...] = ()
    overlaps: tuple[SceneOverlap, ...] = ()
    ground: SceneGround | None = None
    previews: tuple[ScenePreview, ...] = ()
    launches: tuple[SceneLaunch, ...] = ()
