"""XML005 reports missing child elements and attributes that the reference parser requires."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.model import Model
from urdfcheck.model.use.gazebo_starts import is_only_for_classic
from urdfcheck.source.text.engine_reactions import describe_engine_reactions, describe_gap_in_yourdfpy, describe_loss
from urdfcheck.source.text.grammar import (
    CHILDREN,
    NUMERIC_ATTRIBUTES,
    REQUIRED_ATTRIBUTES,
    guess_attribute,
    is_attribute_missing,
    iter_first_elements,
)
from urdfcheck.source.text.values import parse_numbers
from urdfcheck.source.text.xml import Element
from urdfcheck.source.xacro.usage import ANY_TAG, collect_lost_tags, is_inserted

# Other rules check a limit's effort and velocity, a joint's type and a safety controller's k_velocity.
_CHILDREN = {
    "joint": ("parent", "child"),
    "inertial": ("mass", "inertia"),
    "visual": ("geometry",),
    "collision": ("geometry",),
}
# Only the attributes of these tags are checked.
_CHECKED_TAGS = frozenset({
    "link", "parent", "child", "mass", "inertia", "mesh", "box", "cylinder", "capsule", "sphere", "mimic", "material",
    "color",
})  # fmt: skip


_SHAPED = frozenset({"visual", "collision"})
_DELETABLE = frozenset({"mimic", "material", "color"})


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    for element in iter_first_elements(model.robot):
        yield from _check_children(model, element, rule)
        yield from _check_attributes(model, element, rule)
        if element.tag == "geometry" and not element.children:
            yield rule.finding(
                "shape",
                at=element,
                consequences=_describe_consequences(element, "shape"),
                owner=_describe_owner(element),
            )
        elif (
            element.tag == "dynamics"
            and is_attribute_missing(element, "damping")
            and is_attribute_missing(element, "friction")
        ):
            yield rule.finding(
                "dynamics", at=element, consequences=_describe_consequences(element), owner=_describe_owner(element)
            )
    for joint in model.joints:
        axis = joint.axis_element
        if axis is not None and joint.has_axis and is_attribute_missing(axis, "xyz"):
            yield rule.finding("axis", at=axis, owner=_describe_owner(axis))
        elif axis is not None and joint.type in {"fixed", "floating"} and "xyz" not in axis.attributes:
            slip = next((name for name in axis.attributes if guess_attribute(axis, name) == "xyz"), None)
            repair = "delete the <axis>, or write " + ("its xyz" if slip is None else f"`xyz` for `{slip}`")
            yield rule.finding("idle-axis", at=axis, severity=Severity.INFO, owner=_describe_owner(axis), repair=repair)


def _check_children(model: Model, element: Element, rule: Rule) -> Iterator[Finding]:
    missing = [tag for tag in _CHILDREN.get(element.tag, ()) if element.find_child(tag) is None]
    lost = _collect_lost(model, element) if missing else set()
    missing = [] if ANY_TAG in lost else [tag for tag in missing if tag not in lost]
    if missing:
        tags = [f"<{tag}>" for tag in missing]
        yield rule.finding(
            "child",
            at=element,
            consequences=_describe_consequences(element, *missing),
            severity=_grade(model, element),
            tag=element.tag,
            missing=" and no ".join(tags),
            repair=_describe_repair(model, element, _describe_addition(element, tags)),
            owner=_describe_owner(element),
        )


def _grade(model: Model, element: Element) -> Severity | None:
    """Return the severity where it is not the usual one. An object with a density outside packages is for Isaac Gym alone:
    nothing of ROS finds it by name."""
    if _has_density(element):
        return Severity.INFO if model.source.package is None and len(model.links) == 1 else Severity.WARNING
    return Severity.WARNING if _is_placeholder(element) else None


def _is_placeholder(element: Element) -> bool:
    """Whether an element holds no shape, and the reference parser has none to drop: it stops at the first part that fails, and
    reads the visuals of a link before its collisions."""
    if element.tag not in _SHAPED or element.parent is None:
        return False
    read_later = _SHAPED if element.tag == "visual" else {"collision"}
    return not any(
        child.tag != "origin"
        for shape in element.parent.children
        if shape.tag in read_later
        for child in shape.children
    )


def _has_density(element: Element) -> bool:
    """Whether an inertial has a density in place of a mass, as objects for Isaac Gym do: they are made for that program."""
    return element.tag == "inertial" and element.find_child("density") is not None


def _describe_repair(model: Model, element: Element, added: str) -> str:
    """Say how what is missing comes in; the block that a call must hand over cannot be deleted."""
    if _has_density(element):
        return f"add {added}: urdfdom does not read <density>, which objects for Isaac Gym have"
    parent = element.parent
    if parent is not None and model.source.is_xacro and is_inserted(model.source.trees, parent, element):
        return f"add {added} to the block that the call hands over"
    return f"add {added}, or delete the <{element.tag}> if it is left over"


def _describe_addition(element: Element, tags: Sequence[str]) -> str:
    """Say what to add; a shape that is typed directly in a visual or collision belongs in what is missing."""
    shapes = [f"<{child.tag}>" for child in element.children if child.tag in CHILDREN["geometry"]]
    if element.tag in _SHAPED and len(shapes) == 1:
        return f"<geometry> around the {shapes[0]}"
    return " and ".join(tags)


def _collect_lost(model: Model, element: Element) -> set[str]:
    """Return the tags that calls and blocks in the element would make if they had their prefix (XAC007)."""
    is_known = all(child.tag in CHILDREN.get(element.tag, ()) for child in element.children)
    return set() if is_known or not model.source.is_xacro else collect_lost_tags(model.source.trees, element)


def _check_attributes(model: Model, element: Element, rule: Rule) -> Iterator[Finding]:
    required = REQUIRED_ATTRIBUTES[element.tag] if element.tag in _CHECKED_TAGS else ()
    if element.tag == "joint":
        required = ("name",)
    missing = [name for name in required if is_attribute_missing(element, name)]
    data: dict[str, Any] = {"tag": element.tag, "owner": _describe_owner(element)}
    if missing:
        consequences = {**_describe_consequences(element, *missing), **describe_engine_reactions(element, missing)}
        listed = ", ".join(missing)
        yield rule.finding(
            "attribute",
            at=element,
            consequences=consequences,
            # Classic does not read the colours of URDF.
            severity=Severity.WARNING if element.tag == "color" and is_only_for_classic(model) else None,
            missing=listed,
            wanted=_describe_wanted(element, missing),
            **data,
        )
    elif element.tag in {"parent", "child"} and "link" in element.attributes and not element.get("link"):
        at = element.attributes["link"]
        yield rule.finding("empty", at=at, consequences=_describe_consequences(element, "link"), missing="link", **data)
    elif element.tag == "mesh" and "filename" in element.attributes and not element.get("filename").strip():
        yield rule.finding("file", at=element.attributes["filename"], **data)


def _describe_wanted(element: Element, missing: Sequence[str]) -> str:
    """Return what to write; a tag that its parent requires cannot be deleted instead."""
    if element.tag == "inertia" and not set(missing) & {"ixx", "iyy", "izz"}:
        zeros = " ".join(f'{name}="0"' for name in missing)
        return f"{zeros} if the axes of the inertial are the part's principal axes, else its products of inertia"
    if len(missing) == 1 and parse_numbers(element.text, NUMERIC_ATTRIBUTES.get(element.tag, {}).get(missing[0], 0)):
        return f'`{missing[0]}="{" ".join(element.text.split())}"`: the number is typed between the tags'
    inside = _read_children(element, missing)
    if inside is not None:
        as_typed = "the number is typed" if len(missing) == 1 else "the numbers are typed"
        return f"`{inside}`: {as_typed} in child elements, as in SDF"
    noun = "attributes" if len(missing) > 1 else "attribute"
    return f"the {noun} {', '.join(missing)}" + (
        f", or delete the <{element.tag}>" if element.tag in _DELETABLE else ""
    )


def _read_children(element: Element, missing: Sequence[str]) -> str | None:
    """Return the attributes that are missing with the numbers of the child elements of their names; None unless all have them."""
    attributes = []
    for name in missing:
        child = element.find_child(name)
        count = NUMERIC_ATTRIBUTES.get(element.tag, {}).get(name, 0)
        if child is None or not parse_numbers(child.text, count):
            return None
        attributes.append(f'{name}="{" ".join(child.text.split())}"')
    return " ".join(attributes)


def _describe_consequences(element: Element, *missing: str) -> dict[str, str]:
    return {"urdfdom": describe_loss(element), **describe_gap_in_yourdfpy(element, missing)}


def _describe_owner(element: Element) -> str:
    """Return ``link arm`` or ``joint hinge``, the named part around an element, or the robot."""
    inner = element
    while inner.parent is not None and inner.parent.tag != "robot":
        inner = inner.parent
    name = inner.get("name")
    return f"{inner.tag} {name}" if name else f"{inner.tag} without a name" if inner is not element else "the robot"
