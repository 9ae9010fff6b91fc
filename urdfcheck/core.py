"""Every public type of urdfcheck. Standard library only, so that no import of it costs anything."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from enum import Enum, IntEnum
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

from urdfcheck.errors import Unavailable, UrdfcheckError

if TYPE_CHECKING:
    from urdfcheck.drop import Drop

__all__ = [
    "NEWLINE",
    "Applicability",
    "Cause",
    "Computed",
    "Confidence",
    "Drawing",
    "Edit",
    "Finding",
    "Fix",
    "Located",
    "Location",
    "ModelInfo",
    "Option",
    "Rule",
    "Run",
    "Scene",
    "SceneFrame",
    "SceneGround",
    "SceneInertia",
    "SceneJoint",
    "SceneLaunch",
    "SceneLink",
    "SceneMesh",
    "SceneNode",
    "SceneOverlap",
    "SceneParameter",
    "ScenePort",
    "ScenePreview",
    "SceneShape",
    "Severity",
    "Skip",
    "Span",
    "Suppression",
    "Unavailable",
    "UrdfcheckError",
    "Verdict",
]


# What ends a line for every span: str.splitlines() would also break at form feeds and Unicode separators.
NEWLINE = re.compile(r"\r\n|\n|\r")


class Severity(IntEnum):
    """How bad a finding is. ``error``: a reference parser refuses or drops it, or it is impossible."""

    INFO = 1
    WARNING = 2
    ERROR = 3

    def __str__(self) -> str:
        return self.name.lower()

    @classmethod
    def parse(cls, text: str) -> Severity:
        """:raises ValueError: when ``text`` names no severity."""
        try:
            return cls[text.upper()]
        except KeyError:
            raise ValueError(f"{text!r} is no severity: error, warning or info") from None


class Confidence(str, Enum):
    """How sure a finding is. ``proof``: follows from the file whatever the author meant."""

    PROOF = "proof"
    STRONG = "strong"
    HEURISTIC = "heuristic"

    __str__ = str.__str__


class Applicability(str, Enum):
    """Whether a fix may be applied without asking (``safe``), on request (``unsafe``) or only shown (``display``)."""

    SAFE = "safe"
    UNSAFE = "unsafe"
    DISPLAY = "display"

    __str__ = str.__str__


class Verdict(IntEnum):
    """What a program does with a defect, the worst last, as the sentences of the pages' ``[consumers]`` begin.

    ``loads``: takes the model as it was typed; ``ignores``, ``replaces``, ``swaps``: what it simulates or plans with is not
    what was typed; ``computes NaN``: loads it, and has no number to show for it; ``drops``: a link, a joint or a shape is
    missing, with all below it; ``refuses``: there is no model."""

    LOADS = 0
    IGNORES = 1
    REPLACES = 2
    SWAPS = 3
    NAN = 4
    DROPS = 5
    REFUSES = 6

    def __str__(self) -> str:
        return "computes NaN" if self is Verdict.NAN else self.name.lower()

    @classmethod
    def of(cls, sentence: str) -> Verdict:
        """The verdict that a sentence begins with."""
        first = sentence.partition(" ")[0].rstrip(",:;")
        return cls.NAN if sentence.startswith("computes NaN") else _VERDICTS.get(first, cls.LOADS)


_VERDICTS = {
    "ignores": Verdict.IGNORES,
    "replaces": Verdict.REPLACES,
    "swaps": Verdict.SWAPS,
    "drops": Verdict.DROPS,
    "refuses": Verdict.REFUSES,
}


@dataclass(frozen=True, slots=True, order=True)
class Span:
    """A piece of source text. Lines and columns are 1-based code points, ends exclusive; offsets count code points."""

    file: str
    line: int
    col: int
    end_line: int
    end_col: int
    start: int
    end: int


@dataclass(frozen=True, slots=True)
class Location:
    """Where a finding is: its subject in the model, its text, and the calls that brought the text there.

    ``subject`` reads like ``link[wheel_1]/inertial/inertia@izz``; ``via`` holds macro calls and includes, outermost first.
    """

    subject: str
    span: Span | None
    via: tuple[Span, ...] = ()


class Located(Protocol):
    """Anything that knows where it was typed: an element, an attribute, a link, a joint."""

    @property
    def location(self) -> Location: ...


@runtime_checkable
class Computed(Located, Protocol):
    """A located thing whose text was computed from definitions that stand elsewhere."""

    def related(self) -> Iterable[Located]: ...


@dataclass(frozen=True, slots=True)
class Edit:
    """Replace the text at ``span``, which must still read ``expected``."""

    span: Span
    expected: str
    replacement: str


@dataclass(frozen=True, slots=True)
class Fix:
    """What repairs a finding. Without edits it is advice (``display``)."""

    title: str
    applicability: Applicability = Applicability.DISPLAY
    edits: tuple[Edit, ...] = ()


@dataclass(frozen=True, slots=True)
class Cause:
    """Why it happened: a stable id and a sentence."""

    id: str
    text: str


@dataclass(frozen=True, slots=True)
class Suppression:
    """Why a finding does not count. ``kind``: source (a comment), configuration or baseline."""

    kind: str
    reason: str

    def __str__(self) -> str:
        return "in the baseline" if self.kind == "baseline" else f"suppressed in the {self.kind}: {self.reason}"


@dataclass(frozen=True, slots=True)
class Finding:
    """One defect at its cause. ``subjects`` has more than one entry when one source text made several elements.

    ``variants``: where a xacro was expanded with several sets of arguments, the ids of the models that show it, with its subjects
    there; ``model`` is then the one with the fewest arguments."""

    code: str
    name: str
    severity: Severity
    confidence: Confidence
    message_id: str
    message: str
    location: Location
    subjects: tuple[str, ...]
    related: tuple[Location, ...] = ()
    cause: Cause | None = None
    consequences: Mapping[str, str] = field(default_factory=dict)
    data: Mapping[str, Any] = field(default_factory=dict)
    fix: Fix | None = None
    model: str = ""
    suppressed: Suppression | None = None
    variants: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    @property
    def why(self) -> str | None:
        """What its cause says beyond the message."""
        # A message that says it goes on with a small letter.
        return None if self.cause is None or self.cause.text[1:] in self.message else self.cause.text

    @property
    def fingerprints(self) -> tuple[str, ...]:
        """One per subject; they change neither with lines nor with the working directory."""
        import hashlib  # loads OpenSSL: only outputs that show fingerprints pay for it

        return tuple(
            hashlib.sha256(
                # A file name may be no text in any encoding.
                "\0".join((self.code, self.model, subject, self.message_id)).encode(errors="surrogatepass")
            ).hexdigest()[:32]
            for subject in self.subjects
        )


@dataclass(frozen=True, slots=True)
class Skip:
    """A check that could not run on a model, and why."""

    code: str
    model: str
    reason: str


@dataclass(frozen=True, slots=True)
class Option:
    """A threshold of a rule as its page declares it."""

    name: str
    default: Any
    unit: str
    doc: str


@dataclass(frozen=True, slots=True)
class Rule:
    """A rule as its page in ``rules/`` declares it. ``concerns``: the only programs that mind such a defect, empty where it is
    one whoever reads the model. ``fix``: the best that its findings offer; ``display`` is advice."""

    code: str
    name: str
    severity: Severity
    confidence: Confidence
    status: str
    since: str
    scopes: tuple[str, ...]
    needs: tuple[str, ...]
    tags: tuple[str, ...]
    hidden_by: tuple[str, ...]
    concerns: tuple[str, ...]
    fix: Applicability
    options: Mapping[str, Option]
    messages: Mapping[str, str]
    fixes: Mapping[str, str]
    causes: Mapping[str, str]
    consumers: Mapping[str, Any]
    stem: str
    page: str

    @property
    def summary(self) -> str:
        """The first paragraph under *What it checks*."""
        _, _, rest = self.page.partition("## What it checks")
        return " ".join(rest.strip().split("\n\n")[0].split())

    def finding(
        self,
        message: str,
        *,
        at: Located | Location,
        cause: str | None = None,
        edits: Iterable[Edit] = (),
        applicability: Applicability = Applicability.UNSAFE,
        related: Iterable[Located | Location] = (),
        severity: Severity | None = None,
        confidence: Confidence | None = None,
        consequences: Mapping[str, str] | None = None,
        **data: Any,
    ) -> Finding:
        """A finding of this rule: ``message`` is an id of the page's ``[messages]``, ``data`` fills its templates.

        The repair is the page's ``[fixes]`` template of the same id; ``edits`` make it applicable. ``consequences``: what single
        programs do where that depends on the case; the others do what the page says.

        :raises KeyError: when the page lacks the message, the cause or a value that a template names.
        """
        location = at if isinstance(at, Location) else at.location
        edits = tuple(edits)
        # Where the properties, arguments and yaml keys stand that a computed value was made of.
        definitions: Iterable[Located] = at.related() if isinstance(at, Computed) else ()
        places = [r if isinstance(r, Location) else r.location for r in (*related, *definitions)]
        consumers = {k: v for k, v in self.consumers.items() if isinstance(v, str)}
        consumers.update(self.consumers.get(message, {}))
        return Finding(
            code=self.code,
            name=self.name,
            severity=self.severity if severity is None else severity,
            confidence=self.confidence if confidence is None else confidence,
            message_id=message,
            message=self.messages[message].format_map(data),
            location=location,
            subjects=(location.subject,),
            related=tuple({(p.subject, p.span): p for p in places}.values()),
            cause=None if cause is None else Cause(cause, self.causes[cause].format_map(data)),
            consequences={**{k: v.format_map(data) for k, v in consumers.items()}, **(consequences or {})},
            data=data,
            fix=Fix(self.fixes[message].format_map(data), applicability if edits else Applicability.DISPLAY, edits),
        )


@dataclass(frozen=True, slots=True)
class ModelInfo:
    """What a run knows of one model. ``status``: checked | needs-arguments | failed. ``mass`` in kg."""

    path: str
    robot: str
    args: Mapping[str, str]
    links: int
    joints: int
    mass: float | None
    status: str
    id: str
    seconds: float = 0.0


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
class Drawing:
    """A mesh, or what has one ``color`` of it, to be drawn, as `urdfcheck.facts.mesh_codec` packs it. ``low``, ``high``: its
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
    drawings: tuple[Drawing, ...] = ()


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


@dataclass(frozen=True, slots=True)
class Run:
    """The whole outcome, immutable: what every output renders. ``sources`` holds the text of files with findings;
    ``rules`` are those that were selected, ``tier`` how much was computed (source | mesh | full), ``units`` counts the
    models, launch files and packages that were looked at, ``ids`` names them, ``targets`` names who will read the models,
    ``judged`` has the rules by the id of a unit whose findings this run could not have missed there,
    ``homes`` how each baseline (its file and the folder of its names; None for the run's own) calls the units, by their ids;
    ``partial`` says that the run was interrupted, ``fail_on`` from which severity on the findings of a model fail the run, by
    its id; ``drops``: the drop tests, where they were asked for; ``baselines``: the files that say which findings are known."""

    models: tuple[ModelInfo, ...]
    findings: tuple[Finding, ...]
    skipped: tuple[Skip, ...]
    rules: Mapping[str, Rule]
    versions: Mapping[str, str]
    sources: Mapping[str, str]
    scenes: tuple[Scene, ...] = ()
    drops: tuple[Drop, ...] = ()
    seconds: float = 0.0
    failures: tuple[str, ...] = ()
    units: int = 0
    ids: frozenset[str] = frozenset()
    judged: Mapping[str, frozenset[str]] = field(default_factory=dict)
    homes: Mapping[tuple[str, str] | None, Mapping[str, str]] = field(default_factory=dict)
    tier: str = "full"
    targets: tuple[str, ...] = ()
    partial: bool = False
    fail_on: Mapping[str, str] = field(default_factory=dict)
    baselines: frozenset[str] = frozenset()

    def count(self, severity: Severity) -> int:
        """Findings of exactly this severity that are not suppressed."""
        return sum(f.severity == severity for f in self.active)

    def arguments_of(self, finding: Finding) -> Mapping[str, str]:
        """The arguments that it takes to see a finding of a model with several variants."""
        if not finding.variants:
            return {}
        return next((info.args for info in self.models if info.id == finding.model), {})

    @property
    def active(self) -> tuple[Finding, ...]:
        """The findings that nobody knows yet."""
        return tuple(f for f in self.findings if f.suppressed is None)

    @property
    def suppressed(self) -> Mapping[str, int]:
        """How many findings are known, by who says so: source, configuration, baseline."""
        counts = dict.fromkeys(("source", "configuration", "baseline"), 0)
        for finding in self.findings:
            if finding.suppressed is not None:
                counts[finding.suppressed.kind] += 1
        return counts
