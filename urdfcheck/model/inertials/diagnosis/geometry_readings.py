"""What a link may be meant to draw: its mesh in another unit or with another axis upwards, and with its covers."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import FactUnavailableError
from urdfcheck.facts.inertials.declared_and_drawn import VisualGeometry
from urdfcheck.model.parts import Link, has_drawn_shape
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.visual_solid import (
    has_unit_ambiguity,
    has_up_axis_ambiguity,
    measure_link_geometry,
    merge_geometry,
)


def list_geometry_readings(model: Model, link: Link) -> Iterator[VisualGeometry]:
    """Yield what a link may be meant to draw.

    Its own shapes, without COLLADA's ``<unit>`` and with its ``<up_axis>`` where that matters, and together with those of links
    that are fixed to it and have no mass, such as covers.
    """
    as_drawn = measure_link_geometry(model, link)
    if as_drawn is None:
        return
    yield as_drawn
    if has_unit_ambiguity(model, [link.name]):
        unscaled = measure_link_geometry(model, link, apply_unit=False)
        if unscaled is not None:
            yield unscaled
    if has_up_axis_ambiguity(model, [link.name]):
        upright = measure_link_geometry(model, link, apply_up_axis=True)
        if upright is not None:
            yield upright
    covers = list_massless_covers(model, link)
    if covers and (with_covers := merge_geometry(model, link, covers)) is not None:
        yield with_covers


def list_massless_covers(model: Model, link: Link) -> list[Link]:
    """Return the links that are fixed to one, have no inertial, and draw something; none where their placement is not known."""
    try:
        tree, _ = model.pieces, model.piece_frames
    except FactUnavailableError:
        return []
    covers = []
    queue = [link.name]
    while queue:
        for joint in tree.child_joints[queue.pop()]:
            child = model.link_by_name[joint.child]
            if joint.type == "fixed" and child.inertial is None:
                queue.append(child.name)
                if has_drawn_shape(child):
                    covers.append(child)
    return covers
