"""INR014: products of inertia are numbers or zero, not the residue of an export."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Edit, Finding, Rule
from urdfcheck.facts.inertia import principal_moments
from urdfcheck.facts.literals import product_noise
from urdfcheck.model import Link, Model
from urdfcheck.model.body import is_point
from urdfcheck.source.xml import Attribute

PRODUCTS = {"ixy": 1, "ixz": 2, "iyz": 4}


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    found = {link.name: noise for link in model.links if (noise := _noise(link))}
    attributes = [attribute for noise in found.values() for attribute in noise]
    if attributes:
        largest = max((abs(float(a.value)) for a in attributes), default=0.0)
        yield rule.finding(
            "noise",
            at=attributes[0],
            related=attributes[1:],
            edits=[Edit(a.span, a.typed, "0") for a in attributes if a.literal and a.span is not None],
            count=len(attributes),
            links=", ".join(found),
            largest=largest,
        )


def _noise(link: Link) -> list[Attribute]:
    """The products of inertia of a link that are not zero and mean zero."""
    inertial = link.inertial
    if inertial is None or inertial.tensor is None or inertial.six is None or is_point(inertial):
        return []
    element = inertial.tensor_element
    assert element is not None
    moments, _ = principal_moments(inertial.tensor)
    noise = product_noise([inertial.six[i] for i in PRODUCTS.values()], float(moments[2]))
    return [element.attributes[name] for name, residue in zip(PRODUCTS, noise, strict=True) if residue]
