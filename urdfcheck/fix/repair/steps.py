"""What a repair is asked to do, and what it did: plain values, because they cross between processes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from urdfcheck.core import Edit

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
    edits: tuple[Edit, ...] = ()
    files: Mapping[str, bytes] = field(default_factory=dict)
    """Path → content of the files that it writes."""
    before: Mapping[str, float] = field(default_factory=dict)
    """What was measured: triangles, volume in m³, mass in kg."""
    after: Mapping[str, float] = field(default_factory=dict)
