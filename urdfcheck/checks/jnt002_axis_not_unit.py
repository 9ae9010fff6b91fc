"""JNT002 reports joint axes that are not unit vectors."""

from __future__ import annotations

import math
from collections.abc import Iterator

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.model import Model
from urdfcheck.model.repairs.edits import edit_literal
from urdfcheck.model.repairs.number_text import keep_notation
from urdfcheck.model.use.other_programs import names_bullet


def check(model: Model, rule: Rule, *, tol: float, rounding: float) -> Iterator[Finding]:
    for joint in model.joints:
        axis, element = joint.axis, joint.axis_element
        attribute = None if element is None else element.attributes.get("xyz")
        if not joint.has_axis or axis is None or attribute is None:
            continue
        length = math.hypot(*axis)
        if length < 1e-12 or abs(length - 1) <= tol:
            continue  # no direction at all: JNT001
        unit = keep_notation(attribute.value, " ".join(_format_number(a / length) for a in axis))
        rounded = abs(length - 1) < rounding
        yield rule.finding(
            "rounded" if rounded else "length",
            at=attribute,
            severity=Severity.INFO if rounded or _is_normalised(model) else None,
            related=attribute.collect_definitions(),
            edits=edit_literal(attribute, unit),
            joint=joint.name,
            axis=" ".join(attribute.value.split()),
            length=length,
            excess=length - 1,
            unit=unit,
        )


def _is_normalised(model: Model) -> bool:
    """Whether the programs that load the model are known, and Bullet, which alone does not normalise axes, is none of them."""
    return model.source.package is not None and not names_bullet(model)


def _format_number(value: float) -> str:
    return str(round(value)) if value == round(value) else repr(value)
