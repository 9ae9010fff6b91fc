"""Shapes whose mesh has a path that only Gazebo and those that follow it read (``model://``)."""

from __future__ import annotations

import re
from collections.abc import Sequence

from urdfcheck.source.load import Source
from urdfcheck.source.resources import ResourceUse
from urdfcheck.source.text.xml import Element
from urdfcheck.source.uses_elsewhere import read_project_texts

# Programs that do not read `model://`.
_OTHER_READERS = re.compile(r"rviz|moveit", re.IGNORECASE)


def names_gazebo_model(use: ResourceUse) -> bool:
    """Whether a path starts at a model of Gazebo, which is not a package of ROS."""
    return use.resource.text.lower().startswith("model://")


def is_lost_to_others(uses: Sequence[ResourceUse], source: Source) -> bool:
    """Whether a program that does not read ``model://`` is named in the project, and finds no other shape in place of one of
    these."""
    own = {use.attribute.owner for use in uses}
    shapes = [_find_shape(use.attribute.owner) for use in uses]
    lacking = any(
        shape is not None
        and shape.parent is not None
        and all(own.intersection(other.walk()) for other in shape.parent.find_children(shape.tag))
        for shape in shapes
    )
    return lacking and any(map(_OTHER_READERS.search, read_project_texts(source)))


def _find_shape(element: Element) -> Element | None:
    """Return the visual or collision that an element is in."""
    above: Element | None = element
    while above is not None and above.tag not in {"visual", "collision"}:
        above = above.parent
    return above
