"""DYN004 reports robots that tip over on their wheels or feet."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import format_point, join_names
from urdfcheck.facts.inertials.hull_bounds import measure_extent
from urdfcheck.facts.motion.contact import SLACK, GroundSupport, TipOver
from urdfcheck.model import Model
from urdfcheck.model.gazebo import has_posed_root
from urdfcheck.model.ground.stance import find_stance
from urdfcheck.model.ground.support_polygon import LinkMass, compute_contact_points
from urdfcheck.model.ground.wheels import is_suspended, rolling_wheels
from urdfcheck.model.shapes.corners import has_known_shapes
from urdfcheck.model.shapes.visual_solid import measure_link_geometry
from urdfcheck.policy.consumers import SIMULATORS

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array, Indices


_SIDES = ("+x (ahead)", "+y (to the left)", "-x (to the rear)", "-y (to the right)")
# On two wheels in a line it leans until a third part touches, on any slope.
_FEWEST_SUPPORTS = 3
# Supports whose places are this much nearer to a line than they are apart are on it.
_LINE = 0.01


def check(model: Model, rule: Rule, *, rest: float, slope: float) -> Iterator[Finding]:
    if has_posed_root(model) and (SIMULATORS - {"gazebo"}).isdisjoint(model.targets):
        return
    stance = find_stance(model, rest)
    if stance is None or _lacks_chassis_mass(model):
        return  # without the mass of its body the COM of a robot is not known (INR001)
    weights, com, now = stance.weights, stance.com, stance.now
    touching = compute_contact_points(model, stance.points, stance.owners, support=now)
    wheels = {wheel.joint.child for wheel in rolling_wheels(model)}
    # Legs, with wheels on them or not, need not stand with all joints at zero.
    meant = any(not is_suspended(model, name) for name in stance.supports if name in wheels)
    is_line = _is_line(now.polygon)
    if is_line and not meant:
        return  # wheels on legs, which a controller balances
    severity: Severity | None
    details: dict[str, Any]
    if now.tip_angle >= -SLACK:
        # On a slope the plumb line meets the ground farther down, as if the COM were there on level ground.
        downhill = com + math.tan(math.radians(slope)) * now.height * now.outwards
        if not meant or (len(touching) < _FEWEST_SUPPORTS and not is_line):
            return
        if is_line and sum(name != model.tree.root for name in stance.supports) >= _FEWEST_SUPPORTS:
            return  # it leans on a caster that is a little short
        if math.degrees(stance.measure_rest_tilt(downhill).tilt) <= rest:
            return
        message, severity, details = "slope", Severity.INFO, {"slope": slope}
        if is_line:
            message = "line"
    else:
        end = stance.measure_rest_tilt(com)
        if math.degrees(end.tilt) <= rest:
            return
        message, severity = "tips", None if meant else Severity.INFO
        details = {"outcome": _describe_outcome(model, end, stance.owners)}
    worst = _find_tipping_link(weights, now)
    yield rule.finding(
        message,
        at=model.mass_by_name[worst.link.name].inertial,
        severity=severity,
        supports=join_names(touching),
        contacts={name: _round_point(place) for name, place in touching.items()},
        polygon=[_round_point(corner) for corner in now.polygon],
        **_collect_data(weights, worst=worst, now=now, com=com),
        **details,
    )


def _lacks_chassis_mass(model: Model) -> bool:
    """Whether the largest part of the root's body has no ``<inertial>``, or one of unknown size has none."""
    sizes = {
        name: measure_extent(drawn.points)
        for name in model.tree.list_body_links(model.tree.root)
        if (drawn := measure_link_geometry(model, model.link_by_name[name])) is not None
    }
    base = [model.link_by_name[name] for name in model.tree.list_body_links(model.tree.root)]
    if any(link.inertial is None and not has_known_shapes(model, link) for link in base):
        return True
    return bool(sizes) and model.link_by_name[max(sizes, key=lambda name: sizes[name])].inertial is None


def _is_line(polygon: Array) -> bool:
    """Whether the corners (k, 3) of a support polygon are on one line: two wheels on one axis, and nothing before or behind."""
    spread = np.linalg.svd(polygon[:, :2] - polygon[:, :2].mean(axis=0), compute_uv=False)
    return len(polygon) < 3 or bool(spread[1] <= _LINE * spread[0])


def _find_tipping_link(weights: Sequence[LinkMass], now: GroundSupport) -> LinkMass:
    """Return the link that pulls the most over the nearest edge."""
    return max(weights, key=lambda w: w.mass * float((w.com - now.nearest) @ now.outwards))


def _describe_outcome(model: Model, end: TipOver, owners: Indices) -> str:
    if end.last_contact is None or not math.isfinite(end.tilt):
        return "the robot falls over"
    return f"the robot comes to rest tilted by {math.degrees(end.tilt):.0f}°, on {model.tree.order[owners[end.last_contact]]}"


def _collect_data(weights: Sequence[LinkMass], *, worst: LinkMass, now: GroundSupport, com: Array) -> dict[str, Any]:
    total = sum(weight.mass for weight in weights)
    heaviest = max(weights, key=lambda w: w.mass)
    x, y, _ = now.outwards.tolist()
    return {
        "margin": abs(now.margin) * 1e3,
        "side": _SIDES[round(math.atan2(y, x) / (math.pi / 2)) % 4],
        "angle": max(0.0, math.degrees(now.tip_angle)),
        "height": now.height * 1e3,
        "com": _round_point(com),
        "com_text": format_point(com, decimals=3),
        "mass": total,
        "worst": worst.link.name,
        "worst_mass": worst.mass,
        "worst_com": format_point(worst.com, decimals=3),
        "heaviest": heaviest.link.name,
        "suspects": " and ".join(dict.fromkeys((worst.link.name, heaviest.link.name))),
        "share": heaviest.mass / total,
    }


def _round_point(place: Array) -> list[float]:
    return [round(float(v), 6) + 0.0 for v in place]
