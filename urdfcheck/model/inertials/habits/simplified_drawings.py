"""Inertials with the digits of a CAD program on links whose drawing stands for less than the part."""

from __future__ import annotations

from urdfcheck.facts.inertials.hull_bounds import measure_extent, measure_hull_distance
from urdfcheck.model.inertials.inertial_hull import EnclosedInertial
from urdfcheck.model.robot import Model
from urdfcheck.source.text.handed_values import find_typed_value

_PRIMITIVES = frozenset({"box", "cylinder", "sphere", "capsule"})
# A number that was typed by guess has three digits at most (chosen).
_DIGITS = 4
# A COM so far beyond the drawing (as a share of its diagonal) is that of a part with pieces that are not drawn; one that is
# farther away is wrong itself. Chosen: 0.015 where pieces were left out, 0.035 and more where the tensor was about other axes.
_BEYOND = 0.02


def is_simplified(model: Model, part: EnclosedInertial) -> bool:
    """Whether an inertial comes from CAD, and the drawing around it does not show the whole part: it consists of primitives,
    whose own tensor would have no such products of inertia, or ends right before the COM."""
    tensor, xyz = model.tensor_by_name[part.link.name], part.inertial.origin.xyz
    if xyz is None or sum(_has_digits(value) for value in xyz) < 2:
        return False
    moments = [tensor.get_attribute(i) for i in range(6)]
    if any(find_typed_value(moment) is None for moment in moments):
        return False  # a formula has as many digits
    exact = [_has_digits(value) for value in tensor.components]
    if all(exact) and _is_of_primitives(model, part):
        return True
    if not (exact[0] and exact[3] and exact[5]):
        return False
    return all(0.0 < measure_hull_distance(p, part.com) <= _BEYOND * measure_extent(p) for p in part.readings)


def _is_of_primitives(model: Model, part: EnclosedInertial) -> bool:
    links = [model.link_by_name[name] for name in model.pieces.list_body_links(part.link.name)]
    shapes = [shape for link in links for shape in link.visuals] or [s for link in links for s in link.collisions]
    return bool(shapes) and all(shape.kind in _PRIMITIVES for shape in shapes)


def _has_digits(value: float) -> bool:
    return float(f"{value:.{_DIGITS - 2}e}") != value
