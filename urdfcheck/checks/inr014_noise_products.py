"""INR014: products of inertia are numbers or zero, not the residue of an export."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Applicability, Finding, Rule
from urdfcheck.facts.inertials.inertia_tensor import principal_moments
from urdfcheck.facts.likeness.typed_numbers import product_noise
from urdfcheck.model import Link, Model
from urdfcheck.model.rigid_bodies import is_point
from urdfcheck.source.text.tokens import replacing
from urdfcheck.source.text.xml import Attribute

PRODUCTS = {"ixy": 1, "ixz": 2, "iyz": 4}


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    # What is computed is another mistake than what is typed, and each file is edited for itself.
    found: dict[tuple[str, bool], list[tuple[Link, Attribute]]] = {}
    for link in model.links:
        for attribute in _noise(link):
            file = "" if attribute.span is None else attribute.span.file
            found.setdefault((file, attribute.literal), []).append((link, attribute))
    for places in found.values():
        attributes = [attribute for _, attribute in places]
        yield rule.finding(
            "noise",
            at=attributes[0],
            related=attributes[1:],
            edits=replacing(attributes, "0"),
            applicability=Applicability.SAFE,  # it turns the principal axes by less than the last digit of a moment
            count=len(attributes),
            links=", ".join(dict.fromkeys(link.name for link, _ in places)),
            largest=max(abs(float(a.value)) for a in attributes),
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
