"""XML005: child elements and attributes without which the reference parser gives up."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from urdfcheck.core import Finding, Rule
from urdfcheck.model import Model
from urdfcheck.model.parts import TENSOR
from urdfcheck.source.grammar import elements, loss
from urdfcheck.source.xml import Element

# A limit's effort and velocity, a joint's type and a safety controller's k_velocity have rules of their own.
_CHILDREN = {
    "joint": ("parent", "child"),
    "inertial": ("mass", "inertia"),
    "visual": ("geometry",),
    "collision": ("geometry",),
}
_ATTRIBUTES = {
    "link": ("name",),
    "joint": ("name",),
    "parent": ("link",),
    "child": ("link",),
    "mass": ("value",),
    "inertia": TENSOR,
    "mesh": ("filename",),
    "box": ("size",),
    "cylinder": ("radius", "length"),
    "capsule": ("radius", "length"),
    "sphere": ("radius",),
    "mimic": ("joint",),
    "material": ("name",),
    "color": ("rgba",),
}


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    for element in elements(model.robot):
        yield from _children(element, rule)
        yield from _attributes(element, rule)
        if element.tag == "geometry" and not element.children:
            yield rule.finding("shape", at=element, owner=_owner(element), loss=loss(element))
        elif element.tag == "dynamics" and not {"damping", "friction"} & set(element.attributes):
            yield rule.finding("dynamics", at=element, owner=_owner(element), loss=loss(element))
    for joint in model.joints:
        axis = joint.axis_element
        if joint.has_axis and axis is not None and "xyz" not in axis.attributes:
            yield rule.finding("axis", at=axis, owner=_owner(axis), loss=loss(axis))


def _children(element: Element, rule: Rule) -> Iterator[Finding]:
    missing = [tag for tag in _CHILDREN.get(element.tag, ()) if element.child(tag) is None]
    if missing:
        listed = " and no ".join(f"<{tag}>" for tag in missing)
        yield rule.finding(
            "child", at=element, tag=element.tag, missing=listed, owner=_owner(element), loss=loss(element)
        )


def _attributes(element: Element, rule: Rule) -> Iterator[Finding]:
    wanted = _ATTRIBUTES.get(element.tag, ())
    missing = [name for name in wanted if name not in element.attributes]
    data: dict[str, Any] = {"tag": element.tag, "owner": _owner(element), "loss": loss(element)}
    if missing:
        yield rule.finding("attribute", at=element, missing=", ".join(missing), **data)
    elif element.tag in {"parent", "child"} and not element.get("link"):
        yield rule.finding("empty", at=element.attributes["link"], missing="link", **data)
    elif element.tag == "mesh" and not element.get("filename").strip():
        yield rule.finding("file", at=element.attributes["filename"], **data)


def _owner(element: Element) -> str:
    """``link arm`` or ``joint hinge``: the named part around an element, or the robot."""
    inner = element
    while inner.parent is not None and inner.parent.tag != "robot":
        inner = inner.parent
    name = inner.get("name")
    return f"{inner.tag} {name}" if name else f"{inner.tag} without a name" if inner is not element else "the robot"
