"""What differs between two versions of a robot: what every output of ``urdfcheck diff`` renders. Standard library only."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import TYPE_CHECKING

from urdfcheck.core.findings import Finding, Span
from urdfcheck.core.mechanism import NO_TRACE, Trace
from urdfcheck.core.records import dataclass

if TYPE_CHECKING:
    from urdfcheck.core.run import Run

# What a change is about, the most important first. The first that a model has is its verdict.
CATEGORIES = ("structure", "kinematic", "limits", "dynamic", "collision", "visual", "extension")
# Verdicts of models without a change: the texts are equal; they differ, and the robot is the same.
IDENTICAL, COSMETIC = "identical", "cosmetic"
# The model cannot be compared, because one side gives no robot.
UNKNOWN = "unknown"
# What the effects of changes are about.
EFFECTS = ("collision", "inertia", "stability")
# No model changes, and a file around them does: an SRDF file, a controller, a launch file, a manifest.
SEAMS = "seams"
# Of steps of a repair: made; taken back because of what the check found then; not tried.
DONE, WITHDRAWN, LEFT = OUTCOMES = ("done", "withdrawn", "left")
VERDICTS = (UNKNOWN, *CATEGORIES, SEAMS, COSMETIC, IDENTICAL)


@dataclass(frozen=True, slots=True, kw_only=True)
class MechanismChange:
    """One difference between two versions of a robot, at the part that was changed."""

    category: str
    """One of `CATEGORIES`."""
    id: str
    """What changed, such as ``mass`` or ``joint-moved``."""
    subject: str
    """The part as the first version names it, ``joint[shoulder]``; as the second does where the part is new."""
    new_name: str = ""
    """What the second version calls the part, where that differs."""
    numbers: Mapping[str, float] = field(default_factory=dict)
    """The sizes, by name: lengths in m, angles in rad, masses in kg; ``before`` and ``after`` in the unit of the value."""
    words: Mapping[str, str] = field(default_factory=dict)
    """Names that belong to it, such as the parent before and after."""
    before: Trace = NO_TRACE
    """Where the first version has it."""
    after: Trace = NO_TRACE
    """Where the second version has it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkShift:
    """How far a link is from where it was, at the same joint positions."""

    link: str
    """Its name in the first version."""
    distance: float
    """The most, in m."""
    angle: float
    """The most, in rad."""
    configuration: Mapping[str, float]
    """Joint positions at which the distance is largest; empty where it is the same in all."""
    branch: str
    """The first link of the branch that it moves with, which hangs on one that stays; its own name where it is that link."""


@dataclass(frozen=True, slots=True, kw_only=True)
class JointTorque:
    """The most that gravity asks of a joint, root upright and fixed."""

    joint: str
    """Its name in the first version."""
    before: float
    """N·m or N."""
    after: float
    """N·m or N."""
    effort: float | None
    """Effort limit of the second version."""
    unit: str
    """``N·m`` or ``N``."""
    main_link: str = ""
    """The link whose mass or place makes most of the difference, as the first version names it; empty where none does."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MechanismEffect:
    """Something that changes because something else was edited, such as two links that collide now."""

    kind: str
    """What it is about, one of `EFFECTS`."""
    id: str
    """What happens, such as ``pair-collides``."""
    subject: str
    """The part as the first version names it, ``link[hand]``; as the second does where the part is new."""
    other: str = ""
    """The second part of a pair."""
    numbers: Mapping[str, float] = field(default_factory=dict)
    """The sizes, by name: lengths in m, angles in rad."""
    words: Mapping[str, str] = field(default_factory=dict)
    """Names and units that belong to it."""
    configuration: Mapping[str, float] = field(default_factory=dict)
    """Joint positions at which it is largest; empty where it is at rest, or the same in all."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CollisionDiff:
    """What was compared of the collisions of pairs of links."""

    samples: int
    """Number of joint configurations that were compared."""
    pairs: int
    """Number of pairs of links with another geometry, relative motion or range."""
    unread: tuple[str, ...] = ()
    """Links that were left out, because a shape of them could not be read."""
    effects: tuple[MechanismEffect, ...] = ()
    """The pairs that collide in one version only."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ChangeCause:
    """The lines that caused one or more changes."""

    before: tuple[tuple[str, int, str], ...]
    """File, line and text in the first version."""
    after: tuple[tuple[str, int, str], ...]
    """File, line and text in the second version."""
    changes: tuple[int, ...]
    """Indices into `ModelDiff.changes`."""
    is_edited: bool
    """Whether these lines differ between the versions; otherwise they are where the value is typed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MechanismDiff:
    """The differences of two mechanisms."""

    changes: tuple[MechanismChange, ...]
    notes: tuple[MechanismChange, ...]
    """What differs in the description and not in the robot: merged links, frames that were moved and compensated."""
    shifts: tuple[LinkShift, ...]
    """The links that move, the largest distance first."""
    torques: tuple[JointTorque, ...]
    """The joints whose worst gravity torque changes, the largest change first."""
    mass: tuple[float, float]
    """Total mass in kg, before and after."""
    com_shift: float
    """How far the COM of the whole robot moves, all joints at zero, in m."""
    samples: int
    """Number of joint configurations in which motion was compared; 0 where none was needed."""
    causes: tuple[ChangeCause, ...] = ()
    collisions: CollisionDiff | None = None
    """What was compared of collisions; None where nothing can have changed, or coal is not installed."""
    effects: tuple[MechanismEffect, ...] = ()
    """What follows from the changes beside shifts and torques, the most important of each kind first."""
    root_pose: tuple[float, ...] = (1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0)
    """Pose of the first version's root in the second's root frame, 4x4 row-major, as the two are laid over each other: they need
    not have the same root."""

    @property
    def new_names(self) -> Mapping[tuple[str, str], str]:
        """Kind (``link`` or ``joint``) and name of each part that has another name in the second version → that name."""
        return {
            (kind, change.subject[len(kind) + 1 : -1]): change.new_name
            for change in self.changes
            for kind in ("link", "joint")
            if change.id == f"{kind}-renamed"
        }


@dataclass(frozen=True, slots=True, kw_only=True)
class SeamChange:
    """One difference in the files around the models."""

    kind: str
    """srdf | controllers | launch | package | argument."""
    id: str
    """removed | added | changed | old-name."""
    subject: str
    """What it is about: ``joint elbow of group arm``."""
    text: str
    """In words."""
    before: Span | None = None
    """Where the first version has it."""
    after: Span | None = None
    """Where the second version has it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FindingsDiff:
    """The findings of two checks, one for each subject."""

    new: tuple[Finding, ...] = ()
    gone: tuple[Finding, ...] = ()
    unchanged: int = 0
    unchecked: int = 0
    """Findings of the first version in models that the second does not check: they may still be there."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelDiff:
    """Two versions of one model."""

    before: str
    """Id of the model in the first version; empty where it is new."""
    after: str
    """Id of the model in the second version; empty where it is gone."""
    verdict: str
    """One of `VERDICTS`."""
    headline: str
    """The verdict in words, with the number that matters."""
    mechanism: MechanismDiff | None
    """None where a side gives no robot."""
    texts: tuple[str, ...] = ()
    """Each change in words, in the order of ``mechanism.changes``."""
    notes: tuple[str, ...] = ()
    """Each note in words."""
    idle_edits: tuple[tuple[str, int, str], ...] = ()
    """File, line and text of edited tags that make no part of the robot in either version: other arguments may use them."""
    effects: tuple[str, ...] = ()
    """Each effect in words, in the order of ``mechanism.effects``."""
    problem: str = ""
    """Why the models cannot be compared."""
    matched_by: str = "path"
    """How the two were found to be one model: named | path | name | structure."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportedStep:
    """A step of ``urdfcheck repair``, which made the second version of the first, for reports."""

    stage: str
    """edits | meshes | collision | inertia."""
    outcome: str
    """One of `OUTCOMES`."""
    subject: str
    """What it is about: a link, a mesh file, or the rule whose edit was made."""
    text: str
    """What was done or tried, or why nothing was, with the numbers."""
    parts: tuple[str, ...] = ()
    """The parts of the robot that it is about, ``link[hand]``."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Diff:
    """What a change does to the robots of two files, packages or folders."""

    before: str
    """The first version as it was named."""
    after: str
    """The second version as it was named."""
    models: tuple[ModelDiff, ...]
    findings: FindingsDiff = field(default_factory=FindingsDiff)
    seams: tuple[SeamChange, ...] = ()
    """What differs in the files around the models."""
    failures: tuple[str, ...] = ()
    """Why a side or a part of it is unknown: they make the exit code 2."""
    notes: tuple[str, ...] = ()
    """What of the versions of a repository was not compared."""
    version: str = ""
    """Version of urdfcheck."""
    files: frozenset[str] = frozenset()
    """The names of the files that the models of both versions are made of."""
    steps: tuple[ReportedStep, ...] = ()
    """The steps that made the second version, where ``urdfcheck repair`` did."""
    runs: tuple[Run, Run] | None = None
    """The checks of both versions with what draws their models; None where no output draws."""

    @property
    def verdict(self) -> str:
        """The most important verdict of all models."""
        found = {model.verdict for model in self.models} | ({SEAMS} if self.seams else set())
        return next((verdict for verdict in VERDICTS if verdict in found), UNKNOWN if self.failures else IDENTICAL)
