"""Where the numbers of a joint's origin are typed, and what they are computed from."""

from __future__ import annotations

from collections.abc import Sequence

from urdfcheck.core import Location
from urdfcheck.model.parts import Joint
from urdfcheck.source.text.xml import Definition


def locate_origin_attribute(joint: Joint, name: str) -> Location:
    """Return where the attribute ``xyz`` or ``rpy`` of a joint's origin is; the origin or the joint where it is absent."""
    attribute = joint.origin.get_attribute(name)
    if attribute is not None:
        return attribute.location
    return joint.location if joint.origin.element is None else joint.origin.element.location


def list_definitions(joint: Joint, name: str) -> tuple[Definition, ...]:
    """Return what an attribute of a joint's origin is computed from, nearest first; nothing when it is typed as it is."""
    attribute = joint.origin.get_attribute(name)
    return () if attribute is None or attribute.literal else attribute.collect_definitions()


def describe_definitions(definitions: Sequence[Definition]) -> list[str]:
    """Write ``property wheel_base (line 4 of car.xacro)``, for the end of a sentence."""
    return [
        f"{d.kind} {d.name} (line {d.span.line} of {d.span.file.rpartition('/')[2]})"
        for d in definitions
        if d.span is not None
    ]
