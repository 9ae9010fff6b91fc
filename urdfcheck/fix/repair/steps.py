"""What a repair is asked to do, and what it did: plain values, because they cross between processes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field

from urdfcheck.core import Edit, Finding, Fix
from urdfcheck.core.model_diff import DONE, LEFT, OUTCOMES, WITHDRAWN, ReportedStep
from urdfcheck.core.records import dataclass

COLLISION_CHOICES = ("none", "primitives", "convex", "decimate")
INERTIA_CHOICES = ("none", "bad", "all")
UP_AXIS_CHOICES = ("drawn", "upright")
MESH_CHOICES = ("bake", "none")
STAGES = ("meshes", "collision", "inertia")


@dataclass(frozen=True, slots=True, kw_only=True)
class RepairOptions:
    """What is repaired, and how."""

    meshes: str = "bake"
    """One of `MESH_CHOICES`: whether COLLADA's unit and up-axis are written into the coordinates."""
    up_axis: str = "drawn"
    """One of `UP_AXIS_CHOICES`: what the coordinates are, if COLLADA's up-axis is not Z."""
    collision: str = "primitives"
    """One of `COLLISION_CHOICES`."""
    inertia: str = "bad"
    """One of `INERTIA_CHOICES`: which links get an inertial from their geometry."""
    density: float | None = None
    """kg/m³; None: the declared masses are kept."""
    triangles: int = 2000
    """The most triangles that a decimated mesh keeps."""
    max_excess: float = 0.25
    """The share of volume that a primitive may add to the convex hull of its mesh."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RepairStep:
    """What was done about one element or file, or why nothing was."""

    stage: str
    subject: str
    """The link, or the path of a mesh."""
    text: str
    is_done: bool = True
    is_withdrawn: bool = False
    """Whether it was made and taken back."""
    edits: tuple[Edit, ...] = ()
    files: Mapping[str, bytes] = field(default_factory=dict)
    """Path → content of the files that it writes."""
    before: Mapping[str, float] = field(default_factory=dict)
    """What was measured: triangles, volume in m³, mass in kg."""
    after: Mapping[str, float] = field(default_factory=dict)


# A longer text is not quoted.
_LONGEST_QUOTE = 60


def iter_reported_steps(fixed: Sequence[Finding], steps: Sequence[RepairStep]) -> Iterator[ReportedStep]:
    """Yield a step for reports for each finding whose edit was made, then for each step; stage by stage, in order.

    Of each stage the steps that were made come first, then those that were withdrawn.
    """
    for finding in sorted(fixed, key=lambda finding: finding.code):
        text = f"{finding.headline or finding.message}{_describe_edits(finding.fix)}"
        yield ReportedStep(stage="edits", outcome=DONE, subject=finding.code, text=text, parts=finding.subjects)
    reported = [
        ReportedStep(
            stage=step.stage,
            outcome=DONE if step.is_done else WITHDRAWN if step.is_withdrawn else LEFT,
            subject=step.subject,
            text=step.text,
            # A mesh file is no part; what names a link that the robot does not have leads nowhere.
            parts=(f"link[{step.subject}]",),
        )
        for step in steps
    ]
    stages = list(dict.fromkeys(step.stage for step in reported))
    yield from sorted(reported, key=lambda step: (stages.index(step.stage), OUTCOMES.index(step.outcome)))


def _describe_edits(fix: Fix | None) -> str:
    """Return the old and the new text of a repair that changes one short text, else its title."""
    if fix is None:
        return ""
    if len(fix.edits) == 1:
        old, new = fix.edits[0].expected, fix.edits[0].replacement
        if all(text.strip() and "\n" not in text and len(text) <= _LONGEST_QUOTE for text in (old, new)):
            return f": {old} → {new}"
    return f": {fix.title}"
