"""INR012 reports moving bodies whose mass or inertia is too small to be told from zero."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from urdfcheck.core import Finding, Located, Rule
from urdfcheck.facts.inertials.inertia_tensor import compute_principal_moments, compute_triangle_excess
from urdfcheck.model import Link, Model
from urdfcheck.model.rigid_bodies import compute_body_inertia, list_rigid_bodies

# MuJoCo's mjMINVAL, in kg and kg m², and what it says.
LEAST = 1e-15
REFUSED = "refuses to compile: mass and inertia of moving bodies must be larger than mjMINVAL"


def check(model: Model, rule: Rule, *, mass: float, gyration: float, condition: float) -> Iterator[Finding]:
    for body in list_rigid_bodies(model):
        found = compute_body_inertia(model, body.links) if body.is_movable else None
        if found is None:
            continue  # bolted down, without mass, or malformed: other rules
        total, _, tensor = found
        link = _find_heaviest_link(model, body.links)
        first, _, third = compute_principal_moments(tensor)[0].tolist()
        data: dict[str, Any] = {"link": link.name, "mass": total, "smallest": first, "largest": third}
        told = {"mujoco": REFUSED if min(total, first) < LEAST else "loads it"}
        if total <= mass:
            yield rule.finding("mass", at=_locate_mass(link), cause="unit", consequences=told, **data)
        elif not (third > 0 and first > 1e-9 * third and compute_triangle_excess(tensor) >= -1e-9):
            continue  # INR003, INR004
        elif math.sqrt(third / total) < gyration:
            radius = math.sqrt(third / total) * 1e6
            at = _locate_tensor(link)
            yield rule.finding("point", at=at, cause="unit", consequences=told, radius=radius, **data)
        elif first < condition * third:
            yield rule.finding("condition", at=_locate_tensor(link), ratio=first / third, **data)


def _find_heaviest_link(model: Model, names: tuple[str, ...]) -> Link:
    links = [model.link_by_name[name] for name in names]
    return max(links, key=lambda link: (link.inertial.mass or 0.0) if link.inertial else -1.0)


def _locate_mass(link: Link) -> Located:
    assert link.inertial is not None
    return link.inertial.mass_attribute or link.inertial.element


def _locate_tensor(link: Link) -> Located:
    assert link.inertial is not None
    return link.inertial.tensor_element or link.inertial.element
