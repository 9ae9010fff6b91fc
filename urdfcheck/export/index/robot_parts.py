"""The links and joints of a robot in the order of the kinematic tree, each with what one wants to know of it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from urdfcheck.core import FactUnavailableError, Span
from urdfcheck.core.text import format_angle, format_point, join_numbers
from urdfcheck.export.index.source_index import JOINT, LINK, RobotPart
from urdfcheck.model import Joint, Link, Model
from urdfcheck.model.shapes.solids import measure_link_solid
from urdfcheck.source.text.tokens import find_element_span
from urdfcheck.source.text.xml import Element, SourceFile


def list_robot_parts(model: Model) -> tuple[RobotPart, ...]:
    """Return all links and joints; those that hang on nothing begin a tree."""
    children: dict[str, list[Joint]] = {}
    for joint in model.joints:
        children.setdefault(joint.parent, []).append(joint)
    hanging = {joint.child for joint in model.joints}
    seen: set[int] = set()
    roots = [link for link in model.links if link.name not in hanging]
    parts = [part for link in (*roots, *model.links) for part in _iter_branch(model, link, children, seen)]
    lost = [joint for joint in model.joints if id(joint) not in seen]
    return (*parts, *(_describe_joint(model, joint, depth=0) for joint in lost))


def _iter_branch(model: Model, link: Link, children: Mapping[str, list[Joint]], seen: set[int]) -> Iterator[RobotPart]:
    """Yield a link and all that hangs on it, each part once."""
    waiting: list[tuple[Link | Joint, int]] = [(link, 0)]
    while waiting:
        part, depth = waiting.pop()
        if id(part) in seen:
            continue
        seen.add(id(part))
        if isinstance(part, Link):
            yield _describe_link(model, part, depth)
            waiting += [(joint, depth + 1) for joint in reversed(children.get(part.name, ()))]
        else:
            yield _describe_joint(model, part, depth)
            below = model.link_by_name.get(part.child)
            waiting += [] if below is None else [(below, depth + 1)]


def _list_places(element: Element, files: Mapping[str, SourceFile]) -> tuple[Span, ...]:
    whole = find_element_span(element, files)
    return tuple(dict.fromkeys(s for s in (whole, element.span, *reversed(element.via)) if s is not None))


# -- links -------------------------------------------------------------------------------------------------------------


def _describe_link(model: Model, link: Link, depth: int) -> RobotPart:
    mass = None if link.inertial is None else link.inertial.mass
    return RobotPart(
        kind=LINK,
        name=link.name,
        detail="" if mass is None else f"{mass:.4g} kg",
        facts=tuple(_iter_link_facts(model, link)),
        depth=depth,
        places=_list_places(link.element, model.source.files),
    )


def _iter_link_facts(model: Model, link: Link) -> Iterator[str]:
    """Yield mass and COM, the inertia, and what the drawn shape would have."""
    inertial = link.inertial
    if inertial is None:
        yield "no inertial"
        return
    mass, com = inertial.mass, inertial.origin.xyz
    parts = ["mass unknown" if mass is None else f"mass {mass:.4g} kg"]
    parts += [] if com is None else [f"COM {format_point(com, decimals=5)} m"]
    yield ", ".join(parts)
    moments = _compute_moments(inertial.tensor_in_link)
    yield f"principal moments {moments} kg m²" if moments else "inertia unknown"
    drawn = _describe_drawing(model, link, mass)
    if drawn:
        yield drawn


def _compute_moments(tensor: object) -> str:
    from urdfcheck.facts.inertials.inertia_tensor import compute_principal_moments  # loads numpy

    if tensor is None:
        return ""
    try:
        return join_numbers(compute_principal_moments(tensor)[0], digits=3, separator=", ")  # type: ignore[arg-type]
    except ValueError:  # not finite
        return ""


def _describe_drawing(model: Model, link: Link, mass: float | None) -> str:
    """Return the volume of what is drawn, and the density and moments of a filled solid of this mass."""
    from urdfcheck.facts.inertials.inertia_tensor import compute_solid_inertia

    if model.tier == "source" and any(shape.kind == "mesh" for shape in link.visuals):
        return ""
    try:
        solid = measure_link_solid(model, link)
    except FactUnavailableError:
        return ""
    if solid is None or mass is None or not solid.volume > 0:
        return ""
    moments = _compute_moments(compute_solid_inertia(solid, mass))
    return (
        f"drawn: {solid.volume:.3g} m³, so {mass / solid.volume:,.0f} kg/m³; filled evenly it has the COM "
        f"{format_point(solid.com, decimals=5)} m and the moments {moments} kg m²"
    )


# -- joints ------------------------------------------------------------------------------------------------------------


def _describe_joint(model: Model, joint: Joint, depth: int) -> RobotPart:
    return RobotPart(
        kind=JOINT,
        name=joint.name,
        detail=joint.type,
        facts=tuple(_iter_joint_facts(joint)),
        depth=depth,
        places=_list_places(joint.element, model.source.files),
    )


def _iter_joint_facts(joint: Joint) -> Iterator[str]:
    """Yield type, links and axis, then the limits in degrees, then the mimicked joint."""
    axis = joint.axis if joint.has_axis else None
    about = "along" if joint.type == "prismatic" else "about"
    moves = "" if axis is None else f", {about} {format_point(axis, decimals=4)}"
    yield f"{joint.type or 'no type'}, from {joint.parent or '?'} to {joint.child or '?'}{moves}"
    limits = [*_iter_limits(joint)]
    if limits:
        yield ", ".join(limits)
    if joint.mimic is not None:
        yield f"mimics {joint.mimic.get('joint')}"


def _iter_limits(joint: Joint) -> Iterator[str]:
    if joint.limit is None or joint.type not in {"revolute", "continuous", "prismatic"}:
        return
    slides = joint.type == "prismatic"
    lower, upper = joint.get_limit_value("lower"), joint.get_limit_value("upper")
    if joint.type != "continuous" and lower is not None and upper is not None:
        ends = (f"{end:.4g} m" if slides else format_angle(end) for end in (lower, upper))
        yield " to ".join(ends)
    effort, velocity = joint.get_limit_value("effort"), joint.get_limit_value("velocity")
    if effort is not None:
        yield f"effort {effort:.4g} {'N' if slides else 'N m'}"
    if velocity is not None:
        yield f"velocity {velocity:.4g} m/s" if slides else f"velocity {math.degrees(velocity):.4g}°/s"
