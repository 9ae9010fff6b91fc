"""INR019 reports inertia tensors that a xacro computes from another mass than the one beside them."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator

from urdfcheck.core import Finding, Rule, Span
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import join_names
from urdfcheck.model import CompleteInertial, Model
from urdfcheck.model.parts import TENSOR_NAMES
from urdfcheck.source.text.values import parse_number
from urdfcheck.source.text.xml import Attribute, Definition, flatten_definitions

# `m`, `m3`, `mass`, `wheel_mass`, `wheelMass`, `mass_left`; not `m_per_s`, nor the moment `mass_ixx`.
_MASS_NAME = re.compile(r"(?:.*_)?m\d*|.*mass\d*|mass_.*", re.IGNORECASE)
_MOMENT_NAME = re.compile(rf".*({'|'.join(TENSOR_NAMES)})", re.IGNORECASE)


@dataclass(frozen=True, slots=True, eq=False)
class _OtherMass:
    """A link whose tensor is computed from a mass that is not the one beside it."""

    link: str
    at: Attribute
    """The value of the ``<mass>``."""
    mass: float
    definition: Definition
    """Where the mass of the tensor is typed."""
    given: float


def check(model: Model, rule: Rule, *, rel_tol: float) -> Iterator[Finding]:
    groups: dict[tuple[Span | None, float], list[_OtherMass]] = {}
    for declared in model.inertials:
        other = _find_other_mass(declared, rel_tol)
        if other is not None:
            groups.setdefault((other.definition.span, other.mass), []).append(other)
    for same in groups.values():
        first = same[0]
        yield rule.finding(
            "differs",
            at=first.at,
            related=[*(other.at for other in same[1:]), first.definition],
            link=first.link,
            links=join_names(other.link for other in same),
            name=first.definition.name,
            mass=first.mass,
            given=first.given,
            factor=first.given / first.mass,
            remedy=_describe_remedy(first.definition),
        )


def _describe_remedy(definition: Definition) -> str:
    if definition.kind == "parameter":
        return f"correct {definition.name} in the call of the macro, or the <mass>"
    return f"correct {definition.name} or the <mass>, and use {definition.name} for both"


def _find_other_mass(declared: CompleteInertial, rel_tol: float) -> _OtherMass | None:
    """Find the one mass that a tensor is computed from; None where the link's is the same, or is computed from it too."""
    at, tensor = declared.inertial.mass_attribute, declared.inertial.tensor_element
    if at is None or tensor is None or not declared.mass > 0.0:
        return None
    reads = [read for name in TENSOR_NAMES if name in tensor.attributes for read in tensor.attributes[name].reads]
    masses = {
        definition: value
        for definition in flatten_definitions(reads)
        if _is_mass_name(definition.name) and (value := parse_number(definition.value)) is not None
    }
    own = {definition.span for definition in at.collect_definitions()}
    if len(set(masses.values())) != 1 or any(d.span in own for d in flatten_definitions(masses)):
        return None
    definition, given = list(masses.items())[-1]
    if not given > 0.0 or math.isclose(given, declared.mass, rel_tol=rel_tol):
        return None
    return _OtherMass(declared.link.name, at, declared.mass, definition, given)


def _is_mass_name(name: str) -> bool:
    return _MASS_NAME.fullmatch(name) is not None and _MOMENT_NAME.fullmatch(name) is None
