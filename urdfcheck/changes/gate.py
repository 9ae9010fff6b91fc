"""Whether a difference fails a run: by what it is about, and by how large it is. Standard library only."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

from urdfcheck.core import UrdfcheckError
from urdfcheck.core.model_diff import COSMETIC, IDENTICAL, UNKNOWN, Diff, MechanismChange, MechanismDiff, ModelDiff
from urdfcheck.core.records import dataclass

# What `--fail-on` takes.
KINDS = ("kinematic", "dynamic", "limits", "collision", "seams", "findings", "any", "never")
# Effects by which links collide that did not.
_COLLIDING = frozenset({"pair-collides", "rest-collides"})
# A link that turns farther moves what is fixed to it, however little its own frame does: 1°, in rad.
_MOST_TURN = math.radians(1.0)
_LENGTHS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "µm": 1e-6}
_MASSES = {"kg": 1.0, "g": 1e-3}
_QUANTITY = re.compile(r"\s*([0-9.]+(?:[eE][+-]?[0-9]+)?)\s*([a-zA-Zµ%]+)\s*")


@dataclass(frozen=True, slots=True, kw_only=True)
class Gate:
    """What fails."""

    kinds: frozenset[str] = frozenset()
    """Of `KINDS`."""
    max_tool_shift: float | None = None
    """m; a link that moves farther fails, and the motion of one that moves less does not, unless it turns by more than 1°."""
    max_mass: float | None = None
    """Share (`is_share`) or kg; a total mass that changes by more fails, and one of a body that changes by less does not."""
    is_share: bool = True

    def list_reasons(self, diff: Diff) -> list[str]:
        """Return why a difference fails, by model; nothing where it passes."""
        reasons = [f"{model.after or model.before}: {what}" for model in diff.models for what in self._judge(model)]
        if self.kinds & {"seams", "any"} and diff.seams:
            reasons.append("files around the models change")
        if self.kinds & {"findings", "any"} and diff.findings.new:
            reasons.append("new findings")
        return reasons

    def _judge(self, model: ModelDiff) -> list[str]:
        found = model.mechanism
        if model.verdict in {IDENTICAL, COSMETIC, UNKNOWN}:
            return []
        if found is None:
            return ["a model came or went"] if self.kinds & {"any", "kinematic"} else []
        return list(filter(None, (self._judge_shift(found), self._judge_mass(found), *self._judge_kinds(found))))

    def _judge_shift(self, found: MechanismDiff) -> str:
        limit, farthest = self.max_tool_shift, max((shift.distance for shift in found.shifts), default=0.0)
        return "" if limit is None or farthest <= limit else "a link moves farther than --max-tool-shift"

    def _judge_mass(self, found: MechanismDiff) -> str:
        return "" if self.max_mass is None or self._is_small_mass(found) else "the mass changes by more than --max-mass"

    def _is_small_mass(self, found: MechanismDiff) -> bool:
        before, after = found.mass
        return self._is_allowed_mass(found, after - before)

    def _is_allowed_mass(self, found: MechanismDiff, change: float) -> bool:
        """Whether ``change``, in kg, is at most what the robot's mass may change by."""
        total = found.mass[0] if self.is_share else 1.0
        return self.max_mass is not None and abs(change) <= self.max_mass * total

    def _is_small_in_body(self, found: MechanismDiff, change: MechanismChange) -> bool:
        """Whether one body gained or lost little: mass that goes from one to another leaves the sum as it is."""
        return self._is_allowed_mass(found, change.numbers["after"] - change.numbers["before"])

    def _judge_kinds(self, found: MechanismDiff) -> list[str]:
        """Return the kinds of changes that fail, without motions and masses that the tolerances allow."""
        failing = []
        for change in found.changes:
            if change.category == "kinematic" and self._is_tolerated_motion(found, change.id):
                continue
            if change.id == "mass" and self._is_small_mass(found) and self._is_small_in_body(found, change):
                continue
            kind = "kinematic" if change.category == "structure" else change.category
            if kind in self.kinds or "any" in self.kinds:
                failing.append(f"{kind} change")
        if "collision" in self.kinds and any(effect.id in _COLLIDING for effect in found.effects):
            failing.append("links that collide now")
        return list(dict.fromkeys(failing))

    def _is_tolerated_motion(self, found: MechanismDiff, change: str) -> bool:
        limit = self.max_tool_shift
        if limit is None or change in {"type", "mimic"}:
            return False
        return all(shift.distance <= limit and shift.angle <= _MOST_TURN for shift in found.shifts)


def make_gate(fail_on: Sequence[str], max_tool_shift: str | None, max_mass: str | None) -> Gate:
    """Make the gate of some options.

    :raises UrdfcheckError: for an unknown kind, or a quantity of the wrong form.
    """
    unknown = next((kind for kind in fail_on if kind not in KINDS), None)
    if unknown is not None:
        raise UrdfcheckError(f"--fail-on {unknown}: one or more of {', '.join(KINDS)}")
    shift = None if max_tool_shift is None else _parse_quantity("--max-tool-shift", max_tool_shift, _LENGTHS)
    mass = None if max_mass is None else _parse_quantity("--max-mass", max_mass, {**_MASSES, "%": 0.01})
    return Gate(
        kinds=frozenset(fail_on) - {"never"},
        max_tool_shift=shift,
        max_mass=mass,
        is_share=max_mass is None or "%" in max_mass,
    )


def _parse_quantity(option: str, text: str, units: dict[str, float]) -> float:
    match = _QUANTITY.fullmatch(text)
    try:
        if match is not None and match[2] in units and math.isfinite(number := float(match[1])):
            return number * units[match[2]]
    except ValueError:
        pass
    raise UrdfcheckError(f"{option} {text}: write a number with one of the units {', '.join(units)}")
