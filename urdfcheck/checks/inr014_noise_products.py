"""INR014 reports products of inertia that are only the rounding residue of an export."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Applicability, Finding, Rule
from urdfcheck.facts.likeness.typed_numbers import flag_noise_products
from urdfcheck.model import DeclaredTensor, Link, Model
from urdfcheck.model.rigid_bodies import is_point_mass
from urdfcheck.source.text.tokens import build_replacement_edits
from urdfcheck.source.text.xml import Attribute

# The indices of ixy, ixz and iyz among the components.
PRODUCTS = (1, 2, 4)


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    # A computed residue is not the same mistake as a typed one, and each file needs its own edits.
    groups: dict[tuple[str, bool], list[tuple[Link, Attribute]]] = {}
    for declared in model.tensors:
        for attribute in _find_noise_products(declared):
            file = "" if attribute.span is None else attribute.span.file
            groups.setdefault((file, attribute.literal), []).append((declared.link, attribute))
    for places in groups.values():
        attributes = [attribute for _, attribute in places]
        yield rule.finding(
            "noise",
            at=attributes[0],
            related=attributes[1:],
            edits=build_replacement_edits(attributes, "0"),
            applicability=Applicability.SAFE,  # rotates the principal axes by less than the last digit of a moment
            count=len(attributes),
            links=", ".join(dict.fromkeys(link.name for link, _ in places)),
            largest=max(abs(float(a.value)) for a in attributes),
        )


def _find_noise_products(declared: DeclaredTensor) -> list[Attribute]:
    """Return the products of inertia that are not zero but mean zero."""
    if is_point_mass(declared.inertial):
        return []
    noise = flag_noise_products([declared.components[i] for i in PRODUCTS], declared.moments[2])
    return [declared.get_attribute(i) for i, residue in zip(PRODUCTS, noise, strict=True) if residue]
