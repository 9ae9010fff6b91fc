"""Input and output of an engine: plain values, because they cross between processes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field

from urdfcheck.core.records import dataclass

# Rows of a matrix; one number for each degree of freedom.
Matrix = tuple[tuple[float, ...], ...]
Vector = tuple[float, ...]
Range = tuple[float, float]


@dataclass(frozen=True, slots=True)
class EngineDynamics:
    """Dynamics of a robot with a fixed root, in the order of its joints with one degree of freedom."""

    joints: tuple[str, ...] = ()
    """Names of the revolute, continuous and prismatic joints."""
    masses: tuple[Matrix, ...] = ()
    """Mass matrix in kg, kg m or kg m² at each configuration of `EngineInput.samples`."""
    torques: tuple[Vector, ...] = ()
    """Torques in N or N m that hold it against gravity at each of these configurations."""
    accelerations: Vector = ()
    """In m/s² or rad/s², released at `EngineInput.start`; empty where other joints contribute."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TypedRobot:
    """The robot as its author typed it."""

    root: str
    heads: Mapping[str, str]
    """Link → head of its body: the link nearest to the root that only fixed joints separate it from."""
    joints: tuple[str, ...]
    masses: Mapping[str, float | None]
    """Mass in kg of each body by its head; None where one cannot be read."""
    limits: Mapping[str, Range]
    """Position limits in rad or m of the joints that have both."""
    shapes: int
    """Number of collision shapes."""
    motion: EngineDynamics | None = None
    """None where it cannot be computed."""
    frames: tuple[Mapping[str, Vector], ...] = ()
    """Link → frame in that of the root (three rows of four, in m) at each configuration of `EngineInput.samples`, where joints
    that mimic others follow them; empty where it cannot be computed."""
    drawn: Mapping[str, Vector] = field(default_factory=dict)
    """Link → least and greatest corner, in m in its frame, of the box around its visuals; of those whose box is known."""


@dataclass(frozen=True, slots=True, kw_only=True)
class EngineInput:
    """The model for all engines, and the configurations in which they are compared."""

    document: bytes
    """URDF; meshes that were found have absolute paths."""
    typed: TypedRobot | None = None
    """None where links and joints do not form a robot."""
    moved_links: tuple[str, ...] = ()
    """Links that a joint moves."""
    joints: tuple[str, ...] = ()
    """Joints with one degree of freedom."""
    samples: tuple[Vector, ...] = ()
    """Configurations of ``joints`` in rad or m."""
    start: Vector = ()
    """A configuration inside all limits, in rad or m."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LoadedRobot:
    """The robot as an engine loaded it."""

    links: Mapping[str, float]
    """Name → mass in kg."""
    joints: tuple[str, ...]
    limits: Mapping[str, Range | None]
    """Position limits in rad or m; None for a joint without any."""
    shapes: int | None = None
    """Number of collision shapes; None where the engine does not report it."""
    motion: EngineDynamics | None = None
    """None where it cannot be computed."""
    frames: tuple[Mapping[str, Vector], ...] | None = None
    """As in `TypedRobot`; None where the engine does not report them."""
    drawn: Mapping[str, Vector] | None = None
    """As in `TypedRobot`, of the links that draw something; None where the engine does not report it."""
    accuracy: float = 0.0
    """Relative accuracy of its numbers, where they are coarser than those of other engines."""


@dataclass(frozen=True, slots=True)
class LoadOutcome:
    """The result of loading a model in an engine."""

    engine: str
    loaded: LoadedRobot | None = None
    """None where the engine rejected the model."""
    refused: str = ""
    """The reason for the rejection, in the engine's words."""
    messages: tuple[str, ...] = ()
    """Lines that the engine printed."""
    stopped: bool = False
    """Whether its process died or was stopped, so that it may do something else the next time."""
