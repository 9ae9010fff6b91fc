"""Compare the model that an engine loaded with the model that its author typed."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from urdfcheck.core import Verdict
from urdfcheck.core.records import dataclass
from urdfcheck.simulators.outcome import EngineDynamics, EngineInput, LoadedRobot, LoadOutcome, Range, TypedRobot

# Mass matrices and torques are equal if they differ by at most this part of their largest element: for the 96 published robots
# that load unchanged they differ by up to 2e-8 in Bullet, which has axes in single precision, and by up to 5e-13 elsewhere.
SAME = 1e-6
# The relative accuracy of an acceleration measured by one step of a simulation.
_SIMULATED = 1e-2
# The relative accuracy of a box around what is drawn: trimesh makes cylinders of 32 sides and spheres of triangles.
_DRAWN = 0.02
# m/s², and the rad/s² or m/s² below which an acceleration counts as zero.
_GRAVITY, _SLOW = 9.81, 1e-3
# Engines without limits write a large number.
_NONE = 1e10


@dataclass(frozen=True, slots=True, kw_only=True)
class EngineJudgement:
    """What an engine did with a model, and how far its numbers differ from the typed ones."""

    verdict: Verdict
    """The worst of it."""
    reasons: tuple[str, ...] = ()
    """All of it in words."""
    matrix: float | None = None
    """Largest difference of the mass matrices divided by the largest element; None where they cannot be compared."""
    torque: float | None = None
    """The same for the gravity torques."""
    has_accelerations: bool = False
    """Whether accelerations were computed."""


def matches_prediction(predicted: Verdict, judgement: EngineJudgement) -> bool:
    """Whether the prediction for an engine is compatible with what it did.

    A rejection is always observed, and NaN where accelerations were computed; of what was replaced or dropped only links,
    joints, collision shapes, inertias, axes and limits are.
    """
    measured = judgement.verdict
    if Verdict.REFUSES in {predicted, measured}:
        return predicted is measured
    if measured is Verdict.LOADS:
        return predicted is not Verdict.NAN or not judgement.has_accelerations
    if measured is Verdict.NAN:
        return predicted in {Verdict.NAN, Verdict.DROPS}  # without its inertial a link has no mass
    return predicted is Verdict.DROPS if measured is Verdict.DROPS else predicted is not Verdict.LOADS


def judge_outcome(robot: EngineInput, outcome: LoadOutcome) -> EngineJudgement:
    """Compare the outcome with the typed model; if that is not a robot, only missing links are detected."""
    loaded = outcome.loaded
    if loaded is None:
        return EngineJudgement(verdict=Verdict.REFUSES, reasons=(outcome.refused,))
    typed = robot.typed
    if typed is None:
        gone = [name for name in robot.moved_links if name not in loaded.links] if loaded.links else []
        if not gone:
            return EngineJudgement(verdict=Verdict.LOADS)
        return EngineJudgement(verdict=Verdict.DROPS, reasons=(f"without {_join_names('link', gone)}",))
    observed = [
        *_iter_dropped(typed, loaded),
        *_iter_mass_differences(typed, loaded),
        *_iter_limit_differences(typed, loaded),
        *_iter_frame_differences(typed, loaded),
        *_iter_drawn_differences(typed, loaded),
    ]
    same = max(SAME, loaded.accuracy)
    matrix, torque = None, None
    if loaded.motion is not None:
        observed += _iter_nan(loaded.motion)
        if typed.motion is not None:
            free = all(lower < upper for lower, upper in typed.limits.values())  # no limit holds a joint
            mass = sum(known for known in typed.masses.values() if known is not None)
            matrix, torque, falls = _compare_dynamics(typed.motion, loaded.motion, mass, free=free)
            if matrix is not None and not matrix <= same:
                observed.append((Verdict.REPLACES, f"the mass matrix differs by {matrix:.1e} of its largest element"))
            if torque is not None and not torque <= same:
                observed.append((Verdict.REPLACES, f"the gravity torques differ by {torque:.1e} of the largest"))
            if falls is not None and not falls <= _SIMULATED and matrix is not None and matrix <= same:
                observed.append((Verdict.REPLACES, f"the accelerations differ by {falls:.1e} of the largest"))
    worst = max((verdict for verdict, _ in observed), default=Verdict.LOADS)
    reasons = tuple(text for _, text in sorted(observed, key=lambda f: -f[0]))
    return EngineJudgement(
        verdict=worst,
        reasons=reasons,
        matrix=matrix,
        torque=torque,
        has_accelerations=loaded.motion is not None and bool(loaded.motion.accelerations),
    )


def _iter_dropped(typed: TypedRobot, loaded: LoadedRobot) -> Iterator[tuple[Verdict, str]]:
    """Yield dropped parts. A link counts as loaded if the head of its body is: engines may merge links across fixed joints."""
    if not loaded.links:
        return
    present = {*loaded.links, typed.root}
    gone = [name for name, head in typed.heads.items() if name not in present and head not in present]
    if gone:
        yield Verdict.DROPS, f"without {_join_names('link', gone)}"
    if loaded.joints and typed.motion is not None:
        joints = [name for name in typed.motion.joints if name not in loaded.joints]
        if joints and not gone:
            yield Verdict.DROPS, f"without {_join_names('joint', joints)}"
    if loaded.shapes is not None and loaded.shapes < typed.shapes and not gone:
        yield Verdict.DROPS, f"without {typed.shapes - loaded.shapes} of {typed.shapes} collision shapes"


def _iter_mass_differences(typed: TypedRobot, loaded: LoadedRobot) -> Iterator[tuple[Verdict, str]]:
    counted: dict[str, float] = {}
    for name, own in loaded.links.items():
        head = typed.heads.get(name, name)
        counted[head] = counted.get(head, 0.0) + own
    for head, mass in typed.masses.items():
        found = counted.get(head)  # of a link that is missing there is another line
        # The mass of what is fixed to the world is of no consequence: some do not count it, or not all of it.
        if found is None or mass is None or (head == typed.root and not loaded.links.get(head)):
            continue
        if not abs(found - mass) <= SAME * max(abs(mass), abs(found)):
            yield Verdict.REPLACES, f"link {head} has {found:g} kg instead of {mass:g} kg"


def _iter_limit_differences(typed: TypedRobot, loaded: LoadedRobot) -> Iterator[tuple[Verdict, str]]:
    for name, (lower, upper) in typed.limits.items():
        if name not in loaded.limits:
            continue
        found = loaded.limits[name]
        if lower <= -_NONE and upper >= _NONE:
            continue
        if found is None or (found[0] <= -_NONE and found[1] >= _NONE):
            yield Verdict.IGNORES, f"joint {name} has no limits"
        elif _is_close(found, (upper, lower)) and not _is_close(found, (lower, upper)):
            yield Verdict.SWAPS, f"the limits of joint {name} are exchanged"
        elif not _is_close(found, (lower, upper)):
            yield Verdict.REPLACES, f"joint {name} has the limits {found[0]:g} and {found[1]:g}"


def _iter_frame_differences(typed: TypedRobot, loaded: LoadedRobot) -> Iterator[tuple[Verdict, str]]:
    """Yield the links whose frames differ, in the order from the root: the first is where it began."""
    if not typed.frames or loaded.frames is None:
        return
    same = max(SAME, loaded.accuracy)
    differing: set[str] = set()
    moved = 0.0
    for expected, found in zip(typed.frames, loaded.frames, strict=True):
        reach = max((abs(frame[i]) for frame in expected.values() for i in (3, 7, 11)), default=0.0)
        for name, frame in expected.items():
            if name not in found:  # another line reports it
                continue
            shift = math.dist(frame[3::4], found[name][3::4])
            turn = max(abs(frame[i] - found[name][i]) for i in (0, 1, 2, 4, 5, 6, 8, 9, 10))
            if not (shift <= same * max(1.0, reach) and turn <= same):
                differing.add(name)
                moved = max(moved, shift)
    if differing:
        names = [name for name in typed.frames[0] if name in differing]
        much = f"by up to {moved:.2g} m" if moved > same * max(1.0, reach) else "in orientation"
        yield Verdict.REPLACES, f"at random configurations the frame of {_join_names('link', names)} differs {much}"


def _iter_drawn_differences(typed: TypedRobot, loaded: LoadedRobot) -> Iterator[tuple[Verdict, str]]:
    if loaded.drawn is None:
        return
    gone = [name for name in typed.drawn if name not in loaded.drawn and name in loaded.links]
    if gone:
        yield Verdict.DROPS, f"without the visuals of {_join_names('link', gone)}"
    for name, box in typed.drawn.items():
        found = loaded.drawn.get(name)
        if found is None:
            continue
        typed_size, found_size = math.dist(box[:3], box[3:]), math.dist(found[:3], found[3:])
        difference = max(abs(a - b) for a, b in zip(box, found, strict=True))
        if difference <= _DRAWN * typed_size:
            continue
        if abs(found_size - typed_size) > _DRAWN * typed_size:
            yield Verdict.REPLACES, f"link {name} is drawn {found_size:.3g} m large instead of {typed_size:.3g} m"
        else:
            yield Verdict.REPLACES, f"what link {name} draws is moved or rotated by up to {difference:.2g} m"


def _is_close(one: Range, other: Range) -> bool:
    return all(abs(a - b) <= SAME * max(1.0, abs(b)) for a, b in zip(one, other, strict=True))


def _iter_nan(motion: EngineDynamics) -> Iterator[tuple[Verdict, str]]:
    values = [x for matrix in motion.masses for row in matrix for x in row]
    values += [x for torque in motion.torques for x in torque]
    if not all(map(math.isfinite, values)):
        yield Verdict.NAN, "the mass matrix or the gravity torques are not a number"
    elif not all(map(math.isfinite, motion.accelerations)):
        yield Verdict.NAN, "the accelerations are not a number"


def _compare_dynamics(
    typed: EngineDynamics, found: EngineDynamics, mass: float, *, free: bool
) -> tuple[float | None, float | None, float | None]:
    if typed.joints != found.joints or not typed.joints:
        return None, None, None
    if len(typed.masses) != len(found.masses):
        return None, None, None
    matrices = [
        ([x for row in m for x in row], [x for row in n for x in row])
        for m, n in zip(typed.masses, found.masses, strict=True)
    ]
    inertia = max((abs(x) for matrix, _ in matrices for x in matrix), default=0.0)
    comparable = free and typed.accelerations and found.accelerations and all(map(math.isfinite, typed.accelerations))
    return (
        _compute_relative_difference(matrices, 0.0),
        # The torque of an upright axis is rounding error: it is measured against what the mass could exert on an arm.
        _compute_relative_difference(
            list(zip(typed.torques, found.torques, strict=True)), _GRAVITY * math.sqrt(inertia * abs(mass))
        ),
        _compute_relative_difference([(typed.accelerations, found.accelerations)], _SLOW) if comparable else None,
    )


def _compute_relative_difference(pairs: Sequence[tuple[Sequence[float], Sequence[float]]], least: float) -> float:
    """Return the largest difference of two numbers, divided by the largest typed one but at least by ``least``."""
    scale = max((abs(x) for typed, _ in pairs for x in typed), default=0.0)
    worst = max((abs(x - y) for typed, found in pairs for x, y in zip(typed, found, strict=True)), default=0.0)
    scale = max(scale, least)
    return 0.0 if worst == 0.0 else worst / scale if scale else math.inf


def _join_names(what: str, names: Sequence[str]) -> str:
    shown = ", ".join(names[:3])
    return f"{what} {shown}" if len(names) <= 3 else f"{what}s {shown} and {len(names) - 3} more"
