"""Masses that were edited by hand, with the older one in a comment beside them: the tensors are still those of that one."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from urdfcheck.facts.inertials.inertial_fit import measure_inertial_mismatch
from urdfcheck.facts.inertials.mistakes.mistake import EFFECT
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.visual_solid import measure_link_geometry
from urdfcheck.source.text.values import parse_number
from urdfcheck.source.text.xml import COMMENT

if TYPE_CHECKING:
    from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
    from urdfcheck.facts.inertials.diagnosis import Diagnosis
    from urdfcheck.model.parts import Link

_MASS = re.compile(r"""<mass\s+value\s*=\s*["']([^"'<>]+)["']""")
_INERTIA = re.compile(r"<inertia\b")
# How the mass of a comment is marked in the detail of a cause.
COMMENTED = ", as a comment says"
# The older mass has to leave no more than this part of the mismatch.
_REMAINING = 0.5


def name_commented_masses(
    model: Model, numbers: Mapping[str, DeclaredInertial], found: Mapping[str, Diagnosis]
) -> dict[str, Diagnosis]:
    """Return the verdicts with the cause ``other_mass`` for each link whose tensor is that of the drawn part at a mass which a
    comment in its ``<inertial>`` holds."""
    named = dict(found)
    for name, one in found.items():
        link, declared = model.link_by_name[name], numbers[name]
        masses = [] if one.sound or one.judged_by != "mesh" else [*_list_commented_masses(model, link)]
        drawn = measure_link_geometry(model, link) if masses else None
        if drawn is None:
            continue
        for mass in masses:
            mended = replace(declared, tensor=declared.tensor * (declared.mass / mass))
            left, _ = measure_inertial_mismatch(mended, drawn.solid.com, drawn.solid.covariance)
            if left > EFFECT or left > _REMAINING * one.tensor_mismatch:
                continue
            named[name] = replace(
                one,
                cause="other_mass",
                detail=f"{mass:g} kg{COMMENTED}",
                mended=mended,
                mended_tensor_mismatch=left,
                ruled_out=tuple(cause for cause in one.ruled_out if cause != "other_mass"),
                unique=False,
            )
            break
    return named


def _list_commented_masses(model: Model, link: Link) -> Iterator[float]:
    """Yield the masses (kg) in the comments of a link's ``<inertial>`` that hold no tensor."""
    span = None if link.inertial is None else link.inertial.element.span
    file = None if span is None else model.source.files.get(span.file)
    if span is None or file is None:
        return
    end = file.text.find("</inertial", span.start)
    for comment in COMMENT.findall(file.text, span.start, max(end, span.start)):
        if _INERTIA.search(comment) is None:
            for typed in _MASS.findall(comment):
                if (mass := parse_number(typed)) is not None and mass > 0.0:
                    yield mass
