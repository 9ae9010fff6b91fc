"""Edits that put other numbers into an ``<inertial>``, as its author would write them."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core import Edit, Span
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.inertials.inertia_tensor import check_inertia_validity, compute_solid_inertia
from urdfcheck.facts.motion.kinematics import matrix_to_rpy
from urdfcheck.model.fact import fact
from urdfcheck.model.inertials.inertia_diagnosis import inertial_diagnoses
from urdfcheck.model.parts import TENSOR_NAMES, Inertial, Link
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.visual_solid import measure_link_geometry
from urdfcheck.source.text.xml import Attribute, Element

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array

# A flat part's tensor that was typed with three digits may miss the triangle inequality by so much of its largest moment.
TRIANGLE_SLACK = 5e-3
# Numbers are the same when they agree to what a file's digits can tell.
_SAME = 1e-6
_DIGITS = 6


@dataclass(frozen=True, slots=True, eq=False)
class InertialRepair:
    """``edits`` that change the numbers where they were typed, and ``text``, what they say, for a person: ``ixy="…" iyz="…"``;
    ``places``: the attributes in question, or the elements that lack them.

    Without edits where a number is computed, or an element to write it in is missing.
    """

    edits: tuple[Edit, ...]
    text: str
    places: tuple[Attribute | Element | None, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class InertialProposal:
    """The repair of an inertial that cannot be right. ``found``: what a message says of it, from its semicolon on; ``remedy``:
    how the advice begins. Both empty, and no ``edits``, where nothing is known."""

    edits: tuple[Edit, ...] = ()
    message: str = ""
    remedy: str = ""


def propose_repair(model: Model, link: Link) -> InertialProposal:
    """The single edit that makes an inertial possible and that of the drawn part or of its twin, where there is one; else the
    inertia of the drawn part."""
    judged = inertial_diagnoses(model).get(link.name)
    change = propose_undo(model, link)
    if judged is not None and change is not None and judged.diagnosis.mended is not None:
        diagnosis, possible = judged.diagnosis, check_inertia_validity(judged.diagnosis.mended.tensor, TRIANGLE_SLACK)
        if possible.positive_definite and possible.triangle_inequality:
            reference = (
                "the part that is drawn" if diagnosis.judged_by == "mesh" else f"its twin {', '.join(judged.twins)}"
            )
            mistake = (diagnosis.cause or "").replace("_", " ")
            found = f"undoing one mistake ({mistake}) makes it possible and brings it near to that of {reference}"
            if diagnosis.unique:
                found = f"one edit ({mistake}) makes it that of {reference}, and no other single edit does"
            return InertialProposal(change.edits, f"; {found}: {change.text}", f"write {change.text}; or ")
    drawn = propose_from_geometry(model, link)
    if drawn is None or not drawn.text:
        return InertialProposal()
    return InertialProposal(
        drawn.edits, "", f"write {drawn.text}, which is the drawn part's at this mass and uniform density; or "
    )


def propose_undo(model: Model, link: Link) -> InertialRepair | None:
    """What undoes the mistake that was found in a link's inertial; None where none is certain, or it is not in the inertial.

    Without edits where a macro wrote the same text for other links, in which this mistake was not found.
    """
    judged, inertial = inertial_diagnoses(model).get(link.name), link.inertial
    if judged is None or inertial is None or judged.diagnosis.mended is None:
        return None
    change = build_inertial_repair(inertial, judged.diagnosis.mended)
    if not change.text:
        return None
    return change if _is_same_for_all(model, inertial, _identify_mistake) else replace(change, edits=())


def build_inertial_repair(inertial: Inertial, expected: DeclaredInertial) -> InertialRepair:
    """What to change for an inertial to say ``wanted``. Only what differs is changed; a sign or a power of ten keeps its
    digits."""
    changes = [change for change in _list_changes(inertial, expected) if not _is_already_written(change[0], change[2])]
    edits = [edit for attribute, _, text in changes if (edit := _make_edit(attribute, text)) is not None]
    told = " ".join(f'{name}="{text}"' for _, name, text in changes)
    places = tuple(place for place, _, _ in changes)
    return InertialRepair(tuple(edits) if len(edits) == len(changes) else (), told, places)


def propose_from_geometry(model: Model, link: Link) -> InertialRepair | None:
    """The COM and the inertia tensor of what the link draws, at its declared mass and uniform density.

    None when that is not known, or there is no mass. Without edits where a macro wrote the same text for links that draw or
    weigh something else.
    """
    change = _compute_from_geometry(model, link)
    if change is None or link.inertial is None:
        return None
    return change if _is_same_for_all(model, link.inertial, _format_drawn_inertial) else replace(change, edits=())


def _is_same_for_all(model: Model, inertial: Inertial, describe: Callable[[Model, Link], Hashable]) -> bool:
    """Whether ``describe`` returns the same for all links whose inertials are one text."""
    return len(_describe_all(model, inertial.element.span, describe)) == 1


@fact
def _describe_all(model: Model, text: Span | None, describe: Callable[[Model, Link], Hashable]) -> frozenset[Hashable]:
    return frozenset(describe(model, link) for link in _links_by_inertial_text(model)[text])


@fact
def _links_by_inertial_text(model: Model) -> Mapping[Span | None, Sequence[Link]]:
    """The links whose inertials are one text, as a macro makes them."""
    found: dict[Span | None, list[Link]] = {}
    for link in model.links:
        if link.inertial is not None:
            found.setdefault(link.inertial.element.span, []).append(link)
    return found


def _identify_mistake(model: Model, link: Link) -> Hashable:
    judged = inertial_diagnoses(model).get(link.name)
    return None if judged is None else (judged.diagnosis.cause, judged.diagnosis.detail)


def _format_drawn_inertial(model: Model, link: Link) -> str | None:
    change = _compute_from_geometry(model, link)
    return None if change is None else change.text


def _compute_from_geometry(model: Model, link: Link) -> InertialRepair | None:
    inertial, drawn = link.inertial, measure_link_geometry(model, link)
    if inertial is None or drawn is None or inertial.mass is None or not inertial.mass > 0:
        return None
    size = float(np.trace(drawn.solid.covariance))
    if not size > 0.0:  # a surface that is no solid, or numbers that no computer can square
        return None
    matrix = inertial.origin.matrix
    rotation = np.eye(3) if matrix is None else matrix[:3, :3]  # the axes that the author chose are kept
    tensor = rotation.T @ compute_solid_inertia(drawn.solid, inertial.mass) @ rotation
    # What a mesh of single precision leaves of a zero is no number to write.
    com = np.where(np.abs(drawn.solid.com) > _SAME * size**0.5, drawn.solid.com, 0.0)
    tensor = np.where(np.abs(tensor) > _SAME * np.abs(tensor).max(), tensor, 0.0)
    return build_inertial_repair(inertial, DeclaredInertial(inertial.mass, com, tensor, rotation))


def _list_changes(
    inertial: Inertial, wanted: DeclaredInertial
) -> Iterator[tuple[Attribute | Element | None, str, str]]:
    """The attribute (or the element that lacks it), its name and its new text, for each that has to change."""
    if inertial.mass is None or not math.isclose(inertial.mass, wanted.mass, rel_tol=_SAME):
        attribute = inertial.mass_attribute
        yield attribute, "mass value", _format_numbers([] if attribute is None else [attribute.value], [wanted.mass])
    xyz = inertial.origin.xyz
    reach = max(float(np.abs(wanted.com).max()), *map(abs, xyz or ()), 1e-12)
    if xyz is None or float(np.abs(np.array(xyz) - wanted.com).max()) > _SAME * reach:
        com = np.where(np.abs(wanted.com) > _SAME * reach, wanted.com, 0.0)
        yield _locate_attribute(inertial, "xyz"), "xyz", _format_numbers(_split_attribute(inertial, "xyz"), com)
    matrix = inertial.origin.matrix
    if matrix is None or float(np.abs(matrix[:3, :3] - wanted.rotation).max()) > _SAME:
        angles = np.array(matrix_to_rpy(wanted.rotation))
        angles[np.abs(angles) < 1e-12] = 0.0
        yield _locate_attribute(inertial, "rpy"), "rpy", _format_numbers(_split_attribute(inertial, "rpy"), angles)
    six = inertial.inertia_components or (math.nan,) * 6
    values = [float(wanted.tensor[i, j]) for i in range(3) for j in range(i, 3)]
    largest = max(map(abs, values))
    written = {} if inertial.tensor_element is None else inertial.tensor_element.attributes
    typed = [written[name].value if name in written else "" for name in TENSOR_NAMES]
    for i, (name, old, new) in enumerate(zip(TENSOR_NAMES, six, values, strict=True)):
        if not abs(old - new) <= _SAME * max(abs(new), 1e-3 * largest):
            yield (
                written.get(name),
                name,
                _format_like_typed(typed[i], new if abs(new) > 1e-9 * largest else 0.0, typed),
            )


def _is_already_written(attribute: Attribute | Element | None, text: str) -> bool:
    """Whether an attribute says so already, to the digits that it has."""
    return isinstance(attribute, Attribute) and attribute.value.split() == text.split()


def _locate_attribute(inertial: Inertial, name: str) -> Attribute | Element | None:
    element = inertial.origin.element
    return None if element is None else element.attributes.get(name, element)


def _split_attribute(inertial: Inertial, name: str) -> list[str]:
    attribute = inertial.origin.get_attribute(name)
    return [] if attribute is None else attribute.value.split()


def _make_edit(attribute: Attribute | Element | None, text: str) -> Edit | None:
    if not isinstance(attribute, Attribute) or not attribute.literal or attribute.span is None:
        return None
    return Edit(attribute.span, attribute.typed, text)


def _format_numbers(typed: Sequence[str], values: Sequence[float] | Array) -> str:
    words = typed if len(typed) == len(values) else [""] * len(values)
    return " ".join(_format_like_typed(word, float(value), words) for word, value in zip(words, values, strict=True))


def _format_like_typed(typed: str, value: float, others: Iterable[str] = ()) -> str:
    """A number as it was typed where only its sign or a power of ten changes, or as one of its neighbours ``others`` where
    they changed places; else with six digits."""
    for word, powers in ((typed, True), *((other, False) for other in others)):
        try:
            old = Decimal(word.strip())
        except ArithmeticError:
            continue
        if old and value and old.is_finite() and abs(old.adjusted()) < 300:
            shift = round(math.log10(abs(value)) - math.log10(abs(float(old)))) if powers else 0
            scaled = old.scaleb(shift).copy_sign(Decimal(value))
            if math.isclose(float(scaled), value, rel_tol=_SAME):
                return word.strip() if scaled == old else _format_decimal(scaled)
    return f"{value:.{_DIGITS}g}" if value else "0"


def _format_decimal(value: Decimal) -> str:
    text = format(value, "f")
    return text if len(text) <= len(str(value)) + 6 else str(value).replace("E", "e")
