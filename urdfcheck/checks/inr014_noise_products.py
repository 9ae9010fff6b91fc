"""INR014 reports products of inertia that are only the rounding residue of an export."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Applicability, Finding, Rule
from urdfcheck.facts.inertials.inertia_tensor import compute_principal_moments
from urdfcheck.facts.likeness.typed_numbers import flag_noise_products
from urdfcheck.model import Link, Model
from urdfcheck.model.rigid_bodies import is_point_mass
from urdfcheck.source.text.tokens import build_replacement_edits
from urdfcheck.source.text.xml import Attribute

PRODUCTS = {"ixy": 1, "ixz": 2, "iyz": 4}


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    # What is computed is another mistake than what is typed, and each file is edited for itself.
    found: dict[tuple[str, bool], list[tuple[Link, Attribute]]] = {}
    for link in model.links:
        for attribute in _find_noise_products(link):
            file = "" if attribute.span is None else attribute.span.file
            found.setdefault((file, attribute.literal), []).append((link, attribute))
    for places in found.values():
        attributes = [attribute for _, attribute in places]
        yield rule.finding(
            "noise",
            at=attributes[0],
            related=attributes[1:],
            edits=build_replacement_edits(attributes, "0"),
            applicability=Applicability.SAFE,  # it turns the principal axes by less than the last digit of a moment
            count=len(attributes),
            links=", ".join(dict.fromkeys(link.name for link, _ in places)),
            largest=max(abs(float(a.value)) for a in attributes),
        )


def _find_noise_products(link: Link) -> list[Attribute]:
    """The products of inertia of a link that are not zero and mean zero."""
    inertial = link.inertial
    if inertial is None or inertial.tensor is None or inertial.inertia_components is None or is_point_mass(inertial):
        return []
    element = inertial.tensor_element
    assert element is not None
    moments, _ = compute_principal_moments(inertial.tensor)
    noise = flag_noise_products([inertial.inertia_components[i] for i in PRODUCTS.values()], float(moments[2]))
    return [element.attributes[name] for name, residue in zip(PRODUCTS, noise, strict=True) if residue]
