"""XML004 reports attributes where no parser reads them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import field, replace
from typing import Any

from urdfcheck.core import Edit, Finding, Location, Rule, Severity, Span
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import format_repetition, join_names
from urdfcheck.model import Model
from urdfcheck.source.text.engine_reactions import describe_engine_reactions, describe_gap_in_yourdfpy, describe_loss
from urdfcheck.source.text.grammar import (
    NUMERIC_ATTRIBUTES,
    REQUIRED_ATTRIBUTES,
    TEXT_ATTRIBUTES,
    get_known_attributes,
    guess_attribute,
    iter_misspelt_contents,
    iter_urdf_elements,
)
from urdfcheck.source.text.tokens import find_name_span
from urdfcheck.source.text.values import parse_number
from urdfcheck.source.text.xml import Attribute, Element, SourceFile

# Labels and notes for people.
_LABELS = frozenset({"name", "id", "comment", "description"})
# Bullet reads group, mask and concave; a link had a type before URDF 1.0.
_EXTENSIONS: Mapping[str, frozenset[str]] = {
    "link": frozenset({"type"}),
    "collision": frozenset({"group", "mask", "concave"}),
}
# A turn that differs from a whole one by less was rounded: 6.2832 is 2 pi.
_ROUNDED = 1e-4
# Nothing reads the axis of these types of joints.
_WITHOUT_AXIS = frozenset({"fixed", "floating"})


@dataclass(frozen=True, slots=True, eq=False)
class _UnreadAttribute:
    """An attribute that no parser reads, and the contents of its finding."""

    attribute: Attribute
    message: str
    data: Mapping[str, Any]
    """The values that the message needs."""
    consequences: Mapping[str, str] = field(default_factory=dict)


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    by_kind: dict[tuple[str, ...], list[_UnreadAttribute]] = {}
    for element in iter_urdf_elements(model.robot):
        for attribute in element.attributes.values():
            unread = _classify_attribute(element, attribute)
            if unread is not None:
                # Attributes that resemble no known one are reported together.
                name = "" if unread.message == "ignored" else attribute.name
                kind = (unread.message, element.tag, name, unread.consequences.get("urdfdom", ""))
                by_kind.setdefault(kind, []).append(unread)
    for around, element in iter_misspelt_contents(model.robot):
        for attribute in element.attributes.values():
            unread = _classify_attribute(element, attribute)
            if unread is not None and "near" in unread.data:
                slip = _UnreadAttribute(attribute, "inside", {"near": unread.data["near"], "around": around.tag})
                by_kind.setdefault((slip.message, element.tag, attribute.name, around.tag), []).append(slip)
    for places in map(_name_useless_repair, _join_slips(by_kind)):
        yield _build_finding(places, rule, model.source.files)


def _join_slips(by_kind: Mapping[tuple[str, ...], list[_UnreadAttribute]]) -> Iterator[list[_UnreadAttribute]]:
    """Join the kinds that the same elements have: ``soft_lower`` and ``soft_upper`` of six joints are one slip."""
    joined: dict[tuple[object, ...], list[_UnreadAttribute]] = {}
    for kind, places in by_kind.items():
        message, tag, _, around = kind
        owners = frozenset(id(place.attribute.owner) for place in places)
        key = (message, tag, around, owners) if "near" in places[0].data else kind
        joined.setdefault(key, []).extend(places)
    yield from joined.values()


def _name_useless_repair(places: list[_UnreadAttribute]) -> list[_UnreadAttribute]:
    """Soft limits of 0 to 0 are what misspelt ones have anyway: with the right names the joint is as locked as before."""
    if all(place.message == "misspelt" and _is_zero_soft_limit(place.attribute) for place in places):
        return [replace(place, message="soft-zero") for place in places]
    return places


def _is_zero_soft_limit(attribute: Attribute) -> bool:
    """Whether all soft limits of a safety controller, however they are spelt, are 0."""
    owner = attribute.owner
    soft = [a for a in owner.attributes.values() if a.name.startswith("soft")]
    return owner.tag == "safety_controller" and attribute in soft and all(parse_number(a.value) == 0 for a in soft)


def _classify_attribute(element: Element, attribute: Attribute) -> _UnreadAttribute | None:
    name, tag = attribute.name, element.tag
    if (
        name in get_known_attributes(tag) | _LABELS | _EXTENSIONS.get(tag, frozenset())
        or ":" in name
        or name == "xmlns"
    ):
        return None
    if tag == "axis" and element.parent is not None and element.parent.get("type") in _WITHOUT_AXIS:
        return None
    near = guess_attribute(element, name)
    if tag == "robot" and near == "name":
        return None  # a robot without a name: XML002
    if near is not None and near in REQUIRED_ATTRIBUTES.get(tag, ()):
        consequences = {
            "urdfdom": describe_loss(element),
            **describe_engine_reactions(element, [near]),
            **describe_gap_in_yourdfpy(element, [near]),
        }
        return _UnreadAttribute(attribute, "required", {"near": near}, consequences=consequences)
    if near is not None:
        return _UnreadAttribute(attribute, "misspelt", {"near": near})
    homes = sorted(
        home for home in NUMERIC_ATTRIBUTES.keys() | TEXT_ATTRIBUTES.keys() if name in get_known_attributes(home)
    )
    if not homes:
        return _UnreadAttribute(attribute, "ignored", {})
    if all(_is_neutral(name, parse_number(word)) for word in attribute.value.split()):
        return None  # rpy="0 0 0" of an axis, scale="1 1 1" of a box: nothing is lost
    return _UnreadAttribute(attribute, "misplaced", {"homes": " or ".join(f"<{home}>" for home in homes)})


def _is_neutral(name: str, number: float | None) -> bool:
    """Whether a number changes nothing: a scale of 1, a whole turn, or else 0."""
    if number is None or name == "scale":
        return number == 1
    return abs(math.remainder(number, math.tau)) < _ROUNDED if name == "rpy" else number == 0


def _build_finding(places: list[_UnreadAttribute], rule: Rule, files: Mapping[str, SourceFile]) -> Finding:
    """Report one mistake in all of its places."""
    first = places[0]
    spans = [find_name_span(place.attribute, files) for place in places]
    locations = [_locate_attribute_name(place.attribute, span) for place, span in zip(places, spans, strict=True)]
    data = dict(first.data)
    if "near" in data:
        data["near"] = " and ".join(dict.fromkeys(place.data["near"] for place in places))
    # A line of a macro is one place, however many elements it makes.
    names = {
        span: (place.attribute.name, place.data.get("near", ""))
        for place, span in zip(places, spans, strict=True)
        if span is not None
    }
    subjects = dict.fromkeys(place.attribute.owner.subject for place in places)
    finding = rule.finding(
        first.message,
        at=locations[0],
        related={place.span: place for place in locations[1:] if place.span != locations[0].span}.values(),
        edits=[Edit(span, *names[span]) for span in names] if "near" in data and first.message != "soft-zero" else (),
        consequences=first.consequences,
        severity={"required": Severity.ERROR, "ignored": Severity.INFO}.get(first.message),
        attribute=join_names(dict.fromkeys(f"`{place.attribute.name}`" for place in places)),
        tag=first.attribute.owner.tag,
        times=format_repetition(len(subjects)),
        **data,
    )
    return replace(finding, subjects=tuple(place.attribute.location.subject for place in places))


def _locate_attribute_name(attribute: Attribute, name: Span | None) -> Location:
    return attribute.location if name is None else replace(attribute.location, span=name)
