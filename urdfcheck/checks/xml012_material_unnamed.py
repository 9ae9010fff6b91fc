"""XML012 reports materials without a name, and names with several meanings."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import chain
from pathlib import Path
from typing import Any

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import format_count, join_numbers
from urdfcheck.model import Model
from urdfcheck.source.text.values import read_attribute_numbers
from urdfcheck.source.text.xml import Element
from urdfcheck.source.xacro.usage import iter_elements_by_tag

# Screens show 8 bits per channel: half a step is invisible.
_STEP = 0.5 / 255


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    global_materials = model.robot.find_children("material")
    local_materials = [
        m for link in model.links for shape in link.visuals for m in shape.element.find_children("material")
    ]
    yield from _check_empty_names([*global_materials, *local_materials], rule)
    yield from _check_repeated_materials(global_materials, rule, model)
    yield from _check_conflicting_materials(global_materials, local_materials, rule)


def _check_empty_names(materials: list[Element], rule: Rule) -> Iterator[Finding]:
    names = [material.attributes["name"] for material in materials if "name" in material.attributes]
    empty = [name.location for name in names if not name.value.strip()]
    if empty:
        what = format_count(len(empty), "material has", "materials have")
        finding = rule.finding("empty", at=empty[0], related=empty[1:10], what=what, count=len(empty))
        yield replace(finding, subjects=tuple(location.subject for location in empty))


def _check_repeated_materials(global_materials: list[Element], rule: Rule, model: Model) -> Iterator[Finding]:
    """Report materials that are defined twice."""
    main = Path(model.source.name).name
    first: dict[str, Element] = {}
    for material in global_materials:
        name = material.get("name")
        if not name or first.setdefault(name, material) is material:
            continue
        data: dict[str, Any] = {"severity": Severity.ERROR, "material": name}
        if material.span is None or material.span != first[name].span:
            data["repair"] = _describe_deletion(material, first[name], model.source.name)
            yield rule.finding("repeated", at=material, related=[first[name]], **data)
            continue
        includes = _find_double_include(model, material.span.file)
        repair = f"define the material in {main}, or in a file that only {main} includes"
        if includes and includes[1].span is not None:
            at = includes[1].span
            repair = f"delete the second include of {Path(material.span.file).name}, in line {at.line} of {Path(at.file).name}"
        yield rule.finding("again", at=material, related=[first[name], *includes], main=main, repair=repair, **data)


def _describe_deletion(one: Element, other: Element, main: str) -> str:
    """Say which of two definitions to delete: other models may need that of an included file."""
    files = [None if material.span is None else material.span.file for material in (one, other)]
    if files[0] == files[1]:
        return "delete one of the two definitions"
    return (
        f"delete the definition in {Path(main).name}" if main in files else "delete the one that no other model needs"
    )


def _find_double_include(model: Model, file: str) -> list[Element]:
    """Return the first two includes of a file that are typed in the same way in one other file."""
    typed: dict[tuple[str, str], list[Element]] = {}
    for include in iter_elements_by_tag(model.source.trees, "xacro:include"):
        is_certain = include.parent is not None and include.parent.tag == "robot"  # and under no condition
        if is_certain and include.span is not None and Path(include.get("filename")).name == Path(file).name:
            typed.setdefault((include.span.file, include.get("filename")), []).append(include)
    return next((places[:2] for places in typed.values() if len(places) > 1), [])


def _check_conflicting_materials(
    global_materials: list[Element], local_materials: list[Element], rule: Rule
) -> Iterator[Finding]:
    """Report definitions that have no effect: the first of a name counts, those of the robot before those of its links."""
    first: dict[str, Element] = {}
    others: dict[str, list[Element]] = {}
    for material in chain(global_materials, local_materials):
        name = material.get("name").strip()
        if not name or not material.children:
            continue
        if not _is_same_appearance(first.setdefault(name, material), material) and material not in global_materials:
            others.setdefault(name, []).append(material)
    for name, materials in others.items():
        yield rule.finding(
            "different",
            at=materials[0],
            related=[first[name], *materials[1:10]],
            material=name,
            count=len(materials),
            typed=_describe_appearance(materials[0]),
            counts=_describe_appearance(first[name]),
            owner=_describe_owner(materials[0]),
            first=_describe_owner(first[name]),
        )


def _read_rgba(material: Element) -> tuple[float, ...] | None:
    return read_attribute_numbers(material.find_child("color"), "rgba", 4, default=())


def _get_texture_path(material: Element) -> str:
    texture = material.find_child("texture")
    return "" if texture is None else texture.get("filename")


def _is_same_appearance(a: Element, b: Element) -> bool:
    one, other = _read_rgba(a), _read_rgba(b)
    if not one or not other:
        return bool(one) == bool(other) and _get_texture_path(a) == _get_texture_path(b)
    return _get_texture_path(a) == _get_texture_path(b) and all(
        abs(x - y) <= _STEP for x, y in zip(one, other, strict=True)
    )


def _describe_appearance(material: Element) -> str:
    rgba = _read_rgba(material)
    parts = [join_numbers(rgba or (), separator=" "), _get_texture_path(material)]
    return ", ".join(filter(None, parts)) or "no colour"


def _describe_owner(material: Element) -> str:
    element = material
    while element.parent is not None and element.parent.tag != "robot":
        element = element.parent
    return "the robot" if element is material else f"link {element.get('name')}"
