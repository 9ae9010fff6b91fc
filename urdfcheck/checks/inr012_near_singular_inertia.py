"""INR012 reports moving bodies whose mass or inertia is too small to distinguish from zero."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from urdfcheck.core import Finding, Rule
from urdfcheck.facts.inertials.engine_floors import MUJOCO_REFUSAL, is_refused_by_mujoco
from urdfcheck.facts.inertials.inertia_tensor import compute_principal_moments, compute_triangle_excess
from urdfcheck.facts.inertials.placeholders import describe_unknown_mass, is_round
from urdfcheck.model import Model
from urdfcheck.model.rigid_bodies import RigidLinkGroup, compute_body_inertia, list_whole_bodies

# MuJoCo's mjMINVAL, in kg and kg m², and its error message.
LEAST = 1e-15
REFUSED = "refuses to compile: mass and inertia of moving bodies must be larger than mjMINVAL"


def check(model: Model, rule: Rule, *, mass: float, gyration: float, condition: float) -> Iterator[Finding]:
    for body in list_whole_bodies(model):
        inertia = compute_body_inertia(model, body.links) if body.is_movable else None
        if inertia is None:
            continue  # bolted down, without mass, or malformed: other rules
        total, _, tensor = inertia
        masses = [model.mass_by_name[name] for name in body.links if name in model.mass_by_name]
        heaviest = max(masses, key=lambda declared: declared.mass)
        declared_tensor = model.tensor_by_name[heaviest.link.name].element
        smallest, _, largest = compute_principal_moments(tensor)[0].tolist()
        data: dict[str, Any] = {"link": heaviest.link.name, "mass": total, "smallest": smallest, "largest": largest}
        consequences = {"mujoco": _predict_mujoco(model, body, mass=total, smallest=smallest)}
        if total <= mass:
            cause = None if is_round(heaviest.mass) else "unit"  # no conversion leaves a round number
            yield rule.finding(
                "mass",
                at=heaviest.attribute,
                cause=cause,
                consequences=consequences,
                repair=describe_unknown_mass(heaviest.mass) or "write the mass in kilograms",
                **data,
            )
        elif not (largest > 0 and smallest > 1e-9 * largest and compute_triangle_excess(tensor) >= -1e-9):
            continue  # INR003, INR004
        elif math.sqrt(largest / total) < gyration:
            radius = math.sqrt(largest / total) * 1e6
            yield rule.finding(
                "point", at=declared_tensor, cause="unit", consequences=consequences, radius=radius, **data
            )
        elif smallest < condition * largest:
            consequences = {} if consequences["mujoco"] == "loads it" else consequences
            yield rule.finding(
                "condition", at=declared_tensor, consequences=consequences, ratio=smallest / largest, **data
            )


def _predict_mujoco(model: Model, body: RigidLinkGroup, *, mass: float, smallest: float) -> str:
    """Return what MuJoCo does: it checks each link's own tensor, and then the whole body."""
    if any(
        name in model.tensor_by_name and is_refused_by_mujoco(model.tensor_by_name[name].components)
        for name in body.links
    ):
        return MUJOCO_REFUSAL
    return REFUSED if min(mass, smallest) < LEAST else "loads it"
