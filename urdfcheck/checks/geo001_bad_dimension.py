"""GEO001 reports dimensions of shapes that are zero or negative."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from urdfcheck.core import Edit, Finding, Rule, Severity
from urdfcheck.model import Model, Shape
from urdfcheck.source.text.values import parse_numbers
from urdfcheck.source.text.xml import Attribute

# The attributes that hold dimensions, with what each of their numbers is called.
_DIMENSIONS: Mapping[str, Mapping[str, tuple[str, ...]]] = {
    "box": {"size": ("x", "y", "z")},
    "cylinder": {"radius": ("",), "length": ("",)},
    "capsule": {"radius": ("",), "length": ("",)},
    "sphere": {"radius": ("",)},
    "mesh": {"scale": ("x", "y", "z")},
}

# What MuJoCo does with a shape that collides, and with one that is drawn.
REFUSED = "refuses to compile: size must be positive in geom"
FLAT = "refuses to compile: mesh volume is too small"
DRAWN = "loads it: it leaves out what is only drawn"


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    for link in model.links:
        for shape in (*link.visuals, *link.collisions):
            for name, parts in _DIMENSIONS.get(shape.kind or "", {}).items():
                attribute = None if shape.geometry_element is None else shape.geometry_element.attributes.get(name)
                values = None if attribute is None else parse_numbers(attribute.value, len(parts))
                if attribute is not None and values is not None:
                    yield from _check_dimensions(
                        rule, link.name, shape, attribute, dict(zip(parts, values, strict=True))
                    )


def _check_dimensions(
    rule: Rule, link: str, shape: Shape, attribute: Attribute, values: dict[str, float]
) -> Iterator[Finding]:
    mesh = shape.kind == "mesh"  # where a negative scale mirrors, which is no wrong size
    negative = [part for part, value in values.items() if value < 0 and not mesh]
    # A capsule without a cylinder between its caps is a sphere.
    round_ = shape.kind == "capsule" and attribute.name == "length"
    zero = [part for part, value in values.items() if value == 0 and not round_]
    data: dict[str, Any] = {
        "link": link,
        "role": shape.role,
        "kind": shape.kind,
        "dimension": attribute.name,
        "value": attribute.value,
        "consequences": {"mujoco": DRAWN if shape.role == "visual" else FLAT if mesh else REFUSED},
    }
    if negative:
        yield rule.finding("negative", at=attribute, edits=_propose_edits(attribute), **data)
    elif zero and mesh:
        severity = Severity.WARNING if shape.role == "visual" else None
        yield rule.finding("flattened", at=attribute, severity=severity, axes=", ".join(zero), **data)
    elif zero and shape.role == "visual":
        yield rule.finding("drawn", at=attribute, severity=Severity.INFO, **data)
    elif zero:
        yield rule.finding("zero", at=attribute, **data)


def _propose_edits(attribute: Attribute) -> tuple[Edit, ...]:
    """The same numbers without their minus signs, where they are typed as such."""
    if not attribute.literal or attribute.span is None:
        return ()
    positive = " ".join(word.removeprefix("-") for word in attribute.typed.split())
    return (Edit(attribute.span, attribute.typed, positive),)
