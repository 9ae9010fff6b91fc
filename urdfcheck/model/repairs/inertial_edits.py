"""Edits that write other numbers into an ``<inertial>``, as its author would."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping

import numpy as np

from urdfcheck.core import Edit
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import COMPUTED_NUMBERS
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.inertials.engine_floors import is_refused_by_mujoco
from urdfcheck.facts.inertials.inertia_tensor import build_inertia_tensor, check_inertia_validity
from urdfcheck.facts.motion.kinematics import matrix_to_rpy
from urdfcheck.model.parts import TENSOR_NAMES, Inertial
from urdfcheck.model.repairs.edits import edit_value, locate_text, read_typed_text
from urdfcheck.model.repairs.number_text import NEGLIGIBLE_DIFFERENCE, write_number, write_numbers
from urdfcheck.source.text.xml import Attribute, Element

# A repair of more numbers is not spelled in a sentence where a diff shows it.
_MOST_SPELLED = 3
# What is written where fewer digits leave a tensor that no body can have.
_MORE_DIGITS = (9, 12)
_ANGLE_DIGITS = 6


@dataclass(frozen=True, slots=True, eq=False)
class InertialRepair:
    """Other numbers for an inertial."""

    edits: tuple[Edit, ...]
    """What changes the numbers where they were typed; empty where a number is computed, or an element to write it in is
    missing.
    """
    text: str
    """What the edits say, for a person: ``ixy="…" iyz="…"``."""
    places: tuple[Attribute | Element | None, ...] = ()
    """The attributes in question, or the elements that lack them."""
    where: str = ""
    """The end of the words where the numbers do not belong at these places, starting with a space."""

    @property
    def words(self) -> str:
        """What to write, for a sentence: the text, or a reference to the edits where they write many numbers.

        Edits of values that a macro hands on are withdrawn where others read the values too, so these are spelled.
        """
        is_sure = self.edits and all(isinstance(place, Attribute) and place.literal for place in self.places)
        return COMPUTED_NUMBERS if is_sure and len(self.places) > _MOST_SPELLED else self.text + self.where


def have_one_text(places: Iterable[Attribute | Element | None], inertial: Inertial, other: Inertial) -> bool:
    """Whether the text of one of these ``places`` of an inertial also makes another one: what is written there changes both.

    A macro may make both, and take the numbers from its calls. The texts of what an inertial lacks would be in its element.
    """
    texts = {locate_text(attribute) for attribute in list_number_attributes(other)} - {None}
    return any(
        locate_text(place) in texts if isinstance(place, Attribute) else inertial.element.span == other.element.span
        for place in places
    )


def list_number_attributes(inertial: Inertial) -> list[Attribute]:
    """List the attributes that hold the numbers of an inertial."""
    tensor, origin = inertial.tensor_element, inertial.origin
    attributes = [inertial.mass_attribute, origin.get_attribute("xyz"), origin.get_attribute("rpy")]
    attributes += [] if tensor is None else [tensor.attributes.get(name) for name in TENSOR_NAMES]
    return [attribute for attribute in attributes if attribute is not None]


def build_inertial_repair(inertial: Inertial, expected: DeclaredInertial, digits: int = 6) -> InertialRepair:
    """Build what to change for an inertial to say ``expected``, with so many significant digits or more.

    Only what differs is changed; a sign or a power of ten keeps its digits. There are no edits where no body can have the tensor
    that would then be written.
    """
    for places in (digits, *_MORE_DIGITS):
        every = _list_changes(inertial, expected, places)
        changes = [change for change in every if not _is_already_written(change[0], change[2])]
        is_possible = _writes_possible_tensor(inertial, {name: new for _, name, new in changes})
        if is_possible:
            break
    edits = [edit for attribute, _, new in changes if (edit := _make_edit(attribute, new)) is not None]
    text = " ".join(f'{name}="{" ".join(new.split())}"' for _, name, new in changes)
    targets = tuple(place for place, _, _ in changes)
    return InertialRepair(tuple(edits) if is_possible and len(edits) == len(changes) else (), text, targets)


def _writes_possible_tensor(inertial: Inertial, texts: Mapping[str, str]) -> bool:
    """Whether a body can have the tensor with these numbers, or it is not changed; MuJoCo must take it as well."""
    if not texts.keys() & set(TENSOR_NAMES):
        return True
    typed = inertial.inertia_components or (math.nan,) * 6
    components = [float(texts.get(name, old)) for name, old in zip(TENSOR_NAMES, typed, strict=True)]
    validity = check_inertia_validity(build_inertia_tensor(components), 0.0)
    return validity.positive_definite and validity.triangle_inequality and not is_refused_by_mujoco(components)


def _list_changes(
    inertial: Inertial, expected: DeclaredInertial, digits: int
) -> Iterator[tuple[Attribute | Element | None, str, str]]:
    """Yield the attribute (or the element that lacks it), its name and its new text, for each that has to change."""
    if inertial.mass is None or not math.isclose(inertial.mass, expected.mass, rel_tol=NEGLIGIBLE_DIFFERENCE):
        attribute = inertial.mass_attribute
        typed = "" if attribute is None else read_typed_text(attribute)
        yield attribute, "mass value", write_number(typed, expected.mass, digits=digits)
    xyz = inertial.origin.xyz
    reach = max(float(np.abs(expected.com).max()), *map(abs, xyz or ()), 1e-12)
    if xyz is None or float(np.abs(np.array(xyz) - expected.com).max()) > NEGLIGIBLE_DIFFERENCE * reach:
        com = np.where(np.abs(expected.com) > NEGLIGIBLE_DIFFERENCE * reach, expected.com, 0.0)
        text = write_numbers(_read_attribute(inertial, "xyz"), com.tolist(), digits)
        yield _locate_attribute(inertial, "xyz"), "xyz", text
    matrix = inertial.origin.matrix
    if matrix is None or float(np.abs(matrix[:3, :3] - expected.rotation).max()) > NEGLIGIBLE_DIFFERENCE:
        angles = np.array(matrix_to_rpy(expected.rotation))
        angles[np.abs(angles) < 1e-12] = 0.0
        text = write_numbers(_read_attribute(inertial, "rpy"), angles.tolist(), max(digits, _ANGLE_DIGITS))
        yield _locate_attribute(inertial, "rpy"), "rpy", text
    yield from _list_tensor_changes(inertial, expected, digits)


def _list_tensor_changes(
    inertial: Inertial, expected: DeclaredInertial, digits: int
) -> Iterator[tuple[Attribute | Element | None, str, str]]:
    components = inertial.inertia_components or (math.nan,) * 6
    values = [float(expected.tensor[i, j]) for i in range(3) for j in range(i, 3)]
    largest = max(map(abs, values))
    attributes = {} if inertial.tensor_element is None else inertial.tensor_element.attributes
    typed = [read_typed_text(attributes[name]) if name in attributes else "" for name in TENSOR_NAMES]
    for i, (name, old, new) in enumerate(zip(TENSOR_NAMES, components, values, strict=True)):
        if not abs(old - new) <= NEGLIGIBLE_DIFFERENCE * max(abs(new), 1e-3 * largest):
            value = new if abs(new) > 1e-9 * largest else 0.0
            yield attributes.get(name), name, write_number(typed[i], value, typed, digits)


def _is_already_written(attribute: Attribute | Element | None, text: str) -> bool:
    """Whether an attribute says so already, to the digits that it has."""
    return isinstance(attribute, Attribute) and attribute.value.split() == text.split()


def _locate_attribute(inertial: Inertial, name: str) -> Attribute | Element | None:
    element = inertial.origin.element
    return None if element is None else element.attributes.get(name, element)


def _read_attribute(inertial: Inertial, name: str) -> str:
    attribute = inertial.origin.get_attribute(name)
    return "" if attribute is None else read_typed_text(attribute)


def _make_edit(attribute: Attribute | Element | None, text: str) -> Edit | None:
    return next(iter(edit_value(attribute, text)), None) if isinstance(attribute, Attribute) else None
