"""What is asked of an engine and what it answers: plain values, because they cross between processes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

# Rows of a matrix; one number for each degree of freedom.
Matrix = tuple[tuple[float, ...], ...]
Vector = tuple[float, ...]
Range = tuple[float, float]


@dataclass(frozen=True, slots=True)
class EngineDynamics:
    """How a robot moves whose root is fixed, in the order of ``joints``, those with one degree of freedom that moves
    (revolute, continuous, prismatic): the mass matrix in kg, kg m or kg m² and the torques in N or N m that hold it against
    gravity, at each configuration of ``Robot.samples``, and the accelerations in m/s² or rad/s² with which it begins to fall
    at ``Robot.start``; empty where other joints have a part in them."""

    joints: tuple[str, ...] = ()
    masses: tuple[Matrix, ...] = ()
    torques: tuple[Vector, ...] = ()
    accelerations: Vector = ()


@dataclass(frozen=True, slots=True)
class TypedRobot:
    """The robot as its author typed it. ``heads``: of each link the one nearest to the root that only fixed joints are
    between, a body's head; ``masses`` in kg by head, None where one cannot be read; ``limits`` in rad or m of the joints that
    have both; ``shapes``: how many collision shapes there are; ``motion``: None where it cannot be had."""

    root: str
    heads: Mapping[str, str]
    joints: tuple[str, ...]
    masses: Mapping[str, float | None]
    limits: Mapping[str, Range]
    shapes: int
    motion: EngineDynamics | None = None


@dataclass(frozen=True, slots=True)
class EngineInput:
    """What an engine gets. ``document``: the model as it is handed to any of them, as URDF whose meshes have absolute paths
    where they were found. ``typed``: None where links and joints do not form a robot; ``moved``: the links that a joint
    moves. ``samples``: configurations of ``joints`` in rad or m, and ``start``, one that is inside of all limits."""

    document: bytes
    typed: TypedRobot | None = None
    moved_links: tuple[str, ...] = ()
    joints: tuple[str, ...] = ()
    samples: tuple[Vector, ...] = ()
    start: Vector = ()


@dataclass(frozen=True, slots=True)
class LoadedRobot:
    """What an engine has after loading. ``links``: their masses in kg by name, as it counts them; ``limits``: None for a
    joint without any; ``shapes``: its collision shapes, None where it does not say; ``motion``: None where it has none."""

    links: Mapping[str, float]
    joints: tuple[str, ...]
    limits: Mapping[str, Range | None]
    shapes: int | None = None
    motion: EngineDynamics | None = None


@dataclass(frozen=True, slots=True)
class LoadOutcome:
    """What became of a model in an engine: ``loaded``, or ``refused`` in its own words; ``messages``: what it printed."""

    engine: str
    loaded: LoadedRobot | None = None
    refused: str = ""
    messages: tuple[str, ...] = field(default=())
