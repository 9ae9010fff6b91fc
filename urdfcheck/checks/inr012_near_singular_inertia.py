"""INR012 reports moving bodies whose mass or inertia is too small to distinguish from zero."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.facts.inertials.engine_floors import MUJOCO_REFUSAL, is_refused_by_mujoco
from urdfcheck.facts.inertials.materials import guess_mass_unit, is_part_density
from urdfcheck.facts.inertials.placeholders import describe_unknown_mass, is_round
from urdfcheck.facts.small_matrices import compute_excess
from urdfcheck.model import Link, Model
from urdfcheck.model.rigid_bodies import RigidLinkGroup, list_whole_bodies, weigh_body
from urdfcheck.model.use.other_programs import is_weighed_by_bullet
from urdfcheck.model.use.simulators import has_elements

# MuJoCo's mjMINVAL, in kg and kg m², and its error message.
LEAST = 1e-15
REFUSED = "refuses to compile: mass and inertia of moving bodies must be larger than mjMINVAL"
# What is left out where a tensor is converted once too often, as powers of ten, and the moments of a part with a motor in it, to
# those of its uniform solid.
_POWERS, _LIKE_TENSOR = (3, 6, 9), 2.0
_LOADS = "loads it"
_HELD = "loads it: the limits of its joint leave no room to move"
_TOGETHER = (
    "compute mass and tensor together, in kg and kg·m²; a link that only marks a place needs neither on a fixed joint"
)


def check(model: Model, rule: Rule, *, mass: float, gyration: float, condition: float) -> Iterator[Finding]:
    for body in list_whole_bodies(model):
        whole = weigh_body(model, body.links) if body.is_movable else None
        if whole is None:
            continue  # bolted down, without mass, or malformed: other rules
        masses = [model.mass_by_name[name] for name in body.links if name in model.mass_by_name]
        heaviest = max(masses, key=lambda declared: declared.mass)
        declared_tensor = model.tensor_by_name[heaviest.link.name].element
        total, smallest, largest = whole.mass, whole.moments[0], whole.moments[2]
        data: dict[str, Any] = {"link": heaviest.link.name, "mass": total, "smallest": smallest, "largest": largest}
        consequences = {"mujoco": _predict_mujoco(model, body, mass=total, smallest=smallest)}
        if total <= mass:
            unit = _guess_unit(model, heaviest.link, heaviest.mass)
            yield rule.finding(
                "mass",
                at=heaviest.attribute,
                cause="unit" if unit else None,
                unit=unit,
                consequences=consequences,
                repair=describe_unknown_mass(heaviest.mass) or "write the mass of the part, in kilograms",
                **data,
            )
        elif not (largest > 0 and smallest > 1e-9 * largest and compute_excess(whole.moments) >= -1e-9):
            continue  # INR003, INR004
        elif math.sqrt(largest / total) < gyration:
            data |= {"radius": math.sqrt(largest / total) * 1e6, **_explain_point(model, body, heaviest.link)}
            severity, message = None, "point"
            if _is_held_mark(model, body):
                severity, consequences = Severity.INFO, {**consequences, "gazebo": _HELD}
                message = "held" if consequences["mujoco"] == _LOADS else message
            elif not has_elements(model) and is_weighed_by_bullet(model):
                severity, message = Severity.INFO, "unread"
            yield rule.finding(message, at=declared_tensor, severity=severity, consequences=consequences, **data)
        elif smallest < condition * largest:
            consequences = {} if consequences["mujoco"] == _LOADS else consequences
            yield rule.finding(
                "condition", at=declared_tensor, consequences=consequences, ratio=smallest / largest, **data
            )


def _is_held_mark(model: Model, body: RigidLinkGroup) -> bool:
    """Whether a body marks a place, on a joint whose limits leave no room, as Gazebo's models have it to keep a frame apart."""
    from urdfcheck.model.inertials.habits.minor_findings import is_lost

    joint = model.pieces.parent_joint.get(body.links[0])
    held = joint is not None and not joint.has_room
    return held and all(is_lost(model, model.link_by_name[name]) for name in body.links if name in model.mass_by_name)


def _guess_unit(model: Model, link: Link, mass: float) -> str:
    """Return the unit in which a ``mass`` is that of what the link draws; empty where none is, or several are."""
    from urdfcheck.model.shapes.visual_solid import measure_link_geometry

    drawn = measure_link_geometry(model, link)
    if is_round(mass) or drawn is None or not drawn.closed or not drawn.solid.volume > 0.0:
        return ""  # no conversion leaves a round number
    density = mass / drawn.solid.volume
    unit = None if is_part_density(density) else guess_mass_unit(density)
    return "" if unit is None else unit[0]


def _explain_point(model: Model, body: RigidLinkGroup, link: Link) -> dict[str, Any]:
    """Return the data of what made the tensor of a body too small, where what its one link with a mass draws shows it."""
    import numpy as np

    from urdfcheck.facts.inertials.certainty import EXACT
    from urdfcheck.facts.inertials.inertia_tensor import compute_solid_inertia
    from urdfcheck.facts.median import compute_median
    from urdfcheck.model.likeness.declared_inertials import read_declared_inertial
    from urdfcheck.model.shapes.visual_solid import measure_link_geometry

    generic = {"cause": None, "repair": _TOGETHER}
    declared, drawn = read_declared_inertial(link), measure_link_geometry(model, link)
    is_alone = sum(name in model.mass_by_name for name in body.links) == 1
    if declared is None or drawn is None or not drawn.closed or not drawn.solid.volume > 0.0 or not is_alone:
        return generic
    # What the tensor says that the mass is, three times.
    masses = np.linalg.eigvalsh(declared.inertia) / np.linalg.eigvalsh(compute_solid_inertia(drawn.solid, 1.0))
    mass = compute_median(masses.tolist())
    if is_part_density(declared.mass / drawn.solid.volume):
        power = round(math.log10(declared.mass / mass))
        if power in _POWERS and np.abs(np.log(masses * 10.0**power / declared.mass)).max() < math.log(_LIKE_TENSOR):
            return {"cause": "factor", "factor": f"1e{power}", "repair": f"multiply the tensor by 1e{power}"}
    elif is_part_density(mass / drawn.solid.volume) and np.abs(masses / mass - 1.0).max() < EXACT:
        times = f"{declared.mass / mass:.4g}"
        repair = f"multiply the tensor by {times}: then it is that of {declared.mass:.3g} kg, as typed"
        return {"cause": "other_mass", "own": f"{mass:.3g}", "repair": repair}
    return generic


def _predict_mujoco(model: Model, body: RigidLinkGroup, *, mass: float, smallest: float) -> str:
    """Return what MuJoCo does: it checks each link's own tensor, and then the whole body."""
    if any(
        name in model.tensor_by_name and is_refused_by_mujoco(model.tensor_by_name[name].components)
        for name in body.links
    ):
        return MUJOCO_REFUSAL
    return REFUSED if min(mass, smallest) < LEAST else _LOADS
