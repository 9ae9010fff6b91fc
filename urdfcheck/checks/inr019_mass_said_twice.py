"""INR019 reports inertia tensors that a xacro computes from another mass than the one beside them."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.core.records import dataclass
from urdfcheck.facts.inertials.formulas.polynomials import divide_by_common_factor, measure_degree
from urdfcheck.model import CompleteInertial, Model
from urdfcheck.model.inertials.typed_tensors import MOMENTS, parse_formula
from urdfcheck.model.parts import TENSOR_NAMES
from urdfcheck.source.text.values import parse_number
from urdfcheck.source.text.xml import Attribute, Definition, flatten_definitions

# The names that are multiplied in a moment of inertia: a mass and two lengths.
_DEGREE = 3
# `m`, `m3`, `mass`, `wheel_mass`, `wheelMass`, `mass_left`; not `m_per_s`, nor the moment `mass_ixx`.
_MASS_NAME = re.compile(r"(?:.*_)?m\d*|.*mass\d*|mass_.*", re.IGNORECASE)
_MOMENT_NAME = re.compile(rf".*({'|'.join(TENSOR_NAMES)})", re.IGNORECASE)


@dataclass(frozen=True, slots=True, eq=False)
class _OtherMass:
    """The mass that a tensor is computed from, where it is not the one beside it."""

    at: Attribute
    """The value of the ``<mass>``."""
    definition: Definition
    """Where the mass of the tensor is typed."""
    given: float
    """kg"""


def check(model: Model, rule: Rule, *, rel_tol: float) -> Iterator[Finding]:
    for declared in model.inertials:
        other = _find_other_mass(declared, rel_tol)
        if other is not None:
            yield rule.finding(
                "differs",
                at=other.at,
                related=[other.definition],
                link=declared.link.name,
                name=other.definition.name,
                mass=declared.mass,
                given=other.given,
                factor=other.given / declared.mass,
                remedy=_describe_remedy(other),
            )


def _describe_remedy(other: _OtherMass) -> str:
    name = other.definition.name
    if other.definition.kind == "parameter":
        return f"correct {name} in the call of the macro, or the <mass>"
    own = {one.name for one in other.at.collect_definitions() if _is_mass_name(one.name)} - {name}
    if own:  # each of the two names may be that of another link, whose numbers were copied
        return f"use {' or '.join((*sorted(own), name))}, whichever is the mass of this link, for both"
    return f"correct {name} or the <mass>, and use {name} for both if it is meant for this part"


def _find_other_mass(declared: CompleteInertial, rel_tol: float) -> _OtherMass | None:
    """Find the one mass that a tensor is computed from; None where the link's is the same, or is computed from it too."""
    at, definition = declared.inertial.mass_attribute, _find_mass_of_tensor(declared)
    if at is None or definition is None or not declared.mass > 0.0:
        return None
    given, origins = parse_number(definition.value), flatten_definitions([definition])
    if given is None or not given > 0.0 or math.isclose(given, declared.mass, rel_tol=rel_tol):
        return None
    own = {one.span for one in at.collect_definitions()}
    if any(origin.span in own for origin in origins):
        return None
    # The number is typed where the last of the names for it is defined.
    typed = [origin for origin in origins if _is_mass_name(origin.name) and parse_number(origin.value) == given]
    return _OtherMass(at, typed[-1], given)


def _find_mass_of_tensor(declared: CompleteInertial) -> Definition | None:
    """Find the name that multiplies all moments that are computed, and is a mass by that and by its name; None if there is none,
    or several."""
    computed = [
        (attribute, formula)
        for name in MOMENTS
        if (attribute := declared.element.attributes.get(name)) is not None
        and (formula := parse_formula(attribute)) is not None
    ]
    # A mass times squares of lengths; a density comes with their cubes.
    if not computed or not all(formula and measure_degree(formula) <= _DEGREE for _, formula in computed):
        return None
    _, factor = divide_by_common_factor([formula for _, formula in computed])
    masses = {name for name, power in factor if power == 1 and _is_mass_name(name)}
    read = [one for attribute, _ in computed for one in attribute.reads if one.name in masses]
    return read[0] if len(masses) == 1 and read else None


def _is_mass_name(name: str) -> bool:
    return _MASS_NAME.fullmatch(name) is not None and _MOMENT_NAME.fullmatch(name) is None
