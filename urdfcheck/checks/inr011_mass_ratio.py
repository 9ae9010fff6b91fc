"""INR011: bodies that a joint connects have masses of one order."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from urdfcheck.core import Finding, Rule
from urdfcheck.model import Joint, Model
from urdfcheck.model.body import bodies, body_mass
from urdfcheck.model.names import listed


@dataclass(frozen=True, slots=True, eq=False)
class _Pair:
    """A joint, with the masses (kg) of the bodies before and behind it."""

    joint: Joint
    parent: float
    child: float

    @property
    def ratio(self) -> float:
        return self.child / self.parent


def check(model: Model, rule: Rule, *, light: float, heavy: float) -> Iterator[Finding]:
    pairs = _pairs(model)
    root = model.tree.body(model.tree.root)
    # 1/1000 itself, in decimals, is not below 1/1000.
    lighter = [pair for pair in pairs if pair.ratio < light * (1 - 1e-9)]
    # The root may be bolted to the world, whatever it weighs.
    heavier = [pair for pair in pairs if pair.ratio > heavy * (1 + 1e-9) and pair.joint.parent not in root]
    if lighter:
        yield _finding(rule, "light", sorted(lighter, key=lambda pair: pair.ratio))
    if heavier:
        yield _finding(rule, "heavy", sorted(heavier, key=lambda pair: -pair.ratio))


def _pairs(model: Model) -> list[_Pair]:
    """The joints between two bodies with mass."""
    found = bodies(model)
    mass = {name: body_mass(model, body.links) or 0.0 for body in found for name in body.links}
    joints = [model.tree.parent_joint[body.links[0]] for body in found if body.moves]
    return [
        _Pair(joint, mass[joint.parent], mass[joint.child])
        for joint in joints
        if mass[joint.parent] > 0 and mass[joint.child] > 0
    ]


def _finding(rule: Rule, message: str, pairs: list[_Pair]) -> Finding:
    """One finding of all joints, at the most extreme."""
    worst = pairs[0]
    finding = rule.finding(
        message,
        at=worst.joint,
        related=[pair.joint for pair in pairs[1:]],
        joint=worst.joint.name,
        child=worst.joint.child,
        parent=worst.joint.parent,
        child_mass=worst.child,
        parent_mass=worst.parent,
        times=max(worst.ratio, 1 / worst.ratio),
        also="" if len(pairs) == 1 else f" (so do {listed(pair.joint.name for pair in pairs[1:])})",
    )
    return replace(finding, subjects=tuple(pair.joint.location.subject for pair in pairs))
