"""Inertials computed from geometry, with a stated density or the declared mass."""

from __future__ import annotations

from collections.abc import Iterator
from collections.abc import Set as AbstractSet

import numpy as np

from urdfcheck.core import Edit, Span
from urdfcheck.facts.arrays import Array
from urdfcheck.facts.inertials.engine_floors import is_refused_by_mujoco
from urdfcheck.facts.inertials.inertia_tensor import (
    build_inertia_tensor,
    check_inertia_validity,
    compute_solid_inertia,
    list_inertia_components,
)
from urdfcheck.fix.repair.steps import RepairOptions, RepairStep
from urdfcheck.fix.repair.texts import ElementText, write_numbers
from urdfcheck.model import Model
from urdfcheck.model.parts import TENSOR_NAMES, Link
from urdfcheck.model.shapes.visual_solid import measure_link_geometry

# Six digits write most tensors; those that rounding makes impossible get more.
_DIGITS = (6, 9, 12, 17)
# kg/m³ of aerogel, and of osmium: beyond these what a link draws is not what has its mass.
_LIGHTEST, _DENSEST = 1.0, 22_600.0
# A number below this share of the link's size or largest moment is what a mesh leaves of a zero.
_NOISE = 1e-4


def plan_inertials(model: Model, options: RepairOptions, bad_links: AbstractSet[str]) -> Iterator[RepairStep]:
    """Yield a step for each link whose inertial is computed anew, or cannot be."""
    if options.inertia == "none":
        return
    groups: dict[Span | None, list[tuple[Link, str | None, str, dict[str, float]]]] = {}
    for link in model.links:
        if options.inertia == "bad" and link.name not in bad_links:
            continue
        text, words, after = _compute_inertial(model, link, options)
        at = link.element.span if link.inertial is None else link.inertial.element.span
        groups.setdefault(at, []).append((link, text, words, after))
    for same in groups.values():
        texts = {text for _, text, _, _ in same}
        text = next(iter(texts))
        edit = None if len(texts) != 1 or text is None else _write_inertial(model, same[0][0], text)
        for place, (link, own, words, after) in enumerate(same):
            reason = words
            if own is not None and edit is None:
                shared = f"the same text makes {len(same)} links, which need different ones"
                reason = f"not written: {shared if len(texts) > 1 else 'it is typed elsewhere'}"
            before = None if link.inertial is None else link.inertial.mass
            yield RepairStep(
                stage="inertia",
                subject=link.name,
                text=reason,
                is_done=own is not None and edit is not None,
                edits=(edit,) if edit is not None and place == 0 else (),
                before={} if before is None else {"mass": before},
                after=after if edit is not None else {},
            )


def _compute_inertial(model: Model, link: Link, options: RepairOptions) -> tuple[str | None, str, dict[str, float]]:
    """Return the text of an ``<inertial>``, what it is in words, and its numbers; None for no text."""
    drawn = measure_link_geometry(model, link)
    if drawn is None or not drawn.solid.volume > 0.0 or not np.trace(drawn.solid.covariance) > 0.0:
        return None, "kept: it has no geometry that has a volume", {}
    declared = None if link.inertial is None else link.inertial.mass
    if options.density is not None:
        mass = options.density * drawn.solid.volume
    elif declared is not None and declared > 0.0:
        mass = declared
    else:
        return None, "kept: it has no mass (--density)", {}
    density = mass / drawn.solid.volume
    if not _LIGHTEST <= density <= _DENSEST:
        return None, f"kept: the mass {mass:.3g} kg of what it draws would have {density:.3g} kg/m³", {}
    tensor = compute_solid_inertia(drawn.solid, mass)
    size = float(np.sqrt(np.trace(drawn.solid.covariance)))
    com, tensor = _drop_noise(drawn.solid.com, size), _drop_noise(tensor, float(np.abs(tensor).max()))
    text = _format_inertial(mass, com, tensor)
    if text is None:
        return None, "kept: its geometry gives a tensor that MuJoCo refuses", {}
    source = "closed geometry" if drawn.closed else "convex hull of its open meshes"
    return text, f"{mass:.4g} kg at {density:.4g} kg/m³, from the {source}", {"mass": mass, "density": density}


def _drop_noise(numbers: Array, size: float) -> Array:
    kept: Array = np.where(np.abs(numbers) > _NOISE * size, numbers, 0.0)
    return kept


def _format_inertial(mass: float, com: Array, tensor: Array) -> str | None:
    for digits in _DIGITS:
        words = [write_numbers((value,), digits) for value in list_inertia_components(tensor)]
        components = [float(word) for word in words]
        validity = check_inertia_validity(build_inertia_tensor(components), 0.0)
        if validity.positive_definite and validity.triangle_inequality and not is_refused_by_mujoco(components):
            moments = " ".join(f'{name}="{word}"' for name, word in zip(TENSOR_NAMES, words, strict=True))
            place = write_numbers(com.tolist())
            origin = "" if place == "0 0 0" else f'\n<origin xyz="{place}"/>'
            return f'<inertial>{origin}\n<mass value="{write_numbers((mass,))}"/>\n<inertia {moments}/>\n</inertial>'
    return None


def _write_inertial(model: Model, link: Link, text: str) -> Edit | None:
    """Return the edit that writes an inertial instead of the typed one, or at the beginning of the link."""
    if link.inertial is not None:
        source = ElementText(model, link.inertial.element)
        return source.build_edit(_indent(model, source.span, text)) if source.span is not None else None
    span = link.element.span
    file = None if span is None else model.source.files.get(span.file)
    if span is None or file is None or not file.text.startswith("<link", span.start):
        return None
    line = file.text[file.text.rfind("\n", 0, span.start) + 1 : span.start]
    margin = line if not line.strip() else ""
    body = "\n".join(f"{margin}  {row}" for row in _indent_rows(text))
    if file.text.endswith("/>", span.start, span.end):
        place = file.make_span(span.end - 2, span.end)
        return Edit(place, "/>", f">\n{body}\n{margin}</link>")
    return Edit(file.make_span(span.end, span.end), "", f"\n{body}")


def _indent(model: Model, span: Span | None, text: str) -> str:
    rows = _indent_rows(text)
    if span is None:
        return "\n".join(rows)
    whole = model.source.files[span.file].text
    line = whole[whole.rfind("\n", 0, span.start) + 1 : span.start]
    margin = line if not line.strip() else ""
    return ("\n" + margin).join(rows)


def _indent_rows(text: str) -> list[str]:
    rows = text.split("\n")
    return [rows[0], *(f"  {row}" for row in rows[1:-1]), rows[-1]] if len(rows) > 1 else rows
