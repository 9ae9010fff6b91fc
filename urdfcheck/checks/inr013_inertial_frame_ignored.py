"""INR013 reports inertial frames whose rotation changes the tensor, because some programs ignore it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from urdfcheck.core import Edit, Finding, Located, Rule
from urdfcheck.core.text import join_names
from urdfcheck.facts.inertials.inertia_tensor import compute_principal_moments
from urdfcheck.model import Inertial, Link, Model
from urdfcheck.model.inertials.inertia_diagnosis import inertial_diagnoses
from urdfcheck.model.parts import TENSOR_NAMES

# A number that is written anew has the digits of a double, less the two that turning it costs.
DIGITS = 14


@dataclass(frozen=True, slots=True, eq=False)
class _RotatedInertial:
    """A link whose inertial frame is turned. ``change``: how much that changes the tensor, over its largest moment."""

    link: Link
    inertial: Inertial
    relative_change: float


def check(model: Model, rule: Rule, *, rel_tol: float) -> Iterator[Finding]:
    found = [turned for link in model.links if (turned := _measure_rotation_effect(link, rel_tol)) is not None]
    if not found:
        return
    worst = max(found, key=lambda turned: turned.relative_change)
    # Numbers that are wrong in their frame stay wrong in another.
    right = [turned for turned in found if not _has_known_mistake(model, turned.link)]
    edits = {edit.span.start: edit for turned in right for edit in _propose_edits(turned.inertial)}
    yield rule.finding(
        "turned",
        at=_locate(worst),
        related=[_locate(turned) for turned in found if turned is not worst],
        edits=edits.values(),
        count="one link has" if len(found) == 1 else f"{len(found)} links have",
        links=join_names(turned.link.name for turned in found),
        worst=worst.link.name,
        percent=100 * worst.relative_change,
    )


def _measure_rotation_effect(link: Link, rel_tol: float) -> _RotatedInertial | None:
    inertial = link.inertial
    if inertial is None or not inertial.mass or inertial.tensor is None or inertial.tensor_in_link is None:
        return None
    largest = float(np.abs(compute_principal_moments(inertial.tensor)[0]).max())
    change = float(np.abs(inertial.tensor_in_link - inertial.tensor).max())
    return _RotatedInertial(link, inertial, change / largest) if largest > 0 and change > rel_tol * largest else None


def _has_known_mistake(model: Model, link: Link) -> bool:
    judged = inertial_diagnoses(model).get(link.name)
    return judged is not None and judged.diagnosis.decided and judged.diagnosis.cause is not None


def _locate(turned: _RotatedInertial) -> Located:
    origin = turned.inertial.origin
    assert origin.element is not None, "without an origin there is no rotation"
    return origin.get_attribute("rpy") or origin.element


def _propose_edits(inertial: Inertial) -> list[Edit]:
    """The tensor in the link's axes and no rotation; nothing where one of the numbers is computed."""
    element, rpy = inertial.tensor_element, inertial.origin.get_attribute("rpy")
    assert element is not None
    assert inertial.tensor_in_link is not None
    attributes = [rpy, *(element.attributes[name] for name in TENSOR_NAMES)]
    tensor = inertial.tensor_in_link
    residue = 1e-12 * float(np.abs(tensor).max())
    values = [tensor[i, j] if abs(tensor[i, j]) > residue else 0.0 for i in range(3) for j in range(i, 3)]
    texts = ["0 0 0", *(f"{value:.{DIGITS}g}" for value in values)]
    edits = [
        Edit(attribute.span, attribute.typed, text)
        for attribute, text in zip(attributes, texts, strict=True)
        if attribute is not None and attribute.literal and attribute.span is not None
    ]
    return edits if len(edits) == len(texts) else []
