"""XML011 reports materials that are not defined, and textures that do not exist."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from urdfcheck.core import Finding, Rule
from urdfcheck.core.text import format_name_hint
from urdfcheck.model import Model
from urdfcheck.source.package.finder import format_path
from urdfcheck.source.resources import ResourceUse, find_machine_path, list_resource_uses
from urdfcheck.source.text.xml import Element


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    yield from _check_undefined_materials(model, rule)
    yield from _check_textures(model, rule)


def _check_undefined_materials(model: Model, rule: Rule) -> Iterator[Finding]:
    """One finding for all shapes that refer to one name."""
    used = [m for link in model.links for shape in link.visuals for m in shape.element.find_children("material")[:1]]
    defined = {m.get("name") for m in model.robot.find_children("material") if _has_appearance(m)}
    everywhere = defined | {m.get("name") for m in used if _has_appearance(m)}
    without: dict[str, list[Element]] = {}
    for material in used:
        name = material.get("name")
        if _has_appearance(material):
            defined.add(name)  # for the shapes that come after it
        elif name.strip() and name not in defined:
            without.setdefault(name, []).append(material)
    for name, materials in without.items():
        names = [material.attributes["name"] for material in materials]
        finding = rule.finding(
            "later" if name in everywhere else "undefined",
            at=names[0],
            related={n.span: n for n in names[1:] if n.span != names[0].span}.values(),
            material=name,
            shapes="1 shape refers" if len(names) == 1 else f"{len(names)} shapes refer",
            near=format_name_hint(name, everywhere),
        )
        yield replace(finding, subjects=tuple(n.location.subject for n in names))


def _has_appearance(material: Element) -> bool:
    return bool(material.find_child("color") or material.find_child("texture"))


def _check_textures(model: Model, rule: Rule) -> Iterator[Finding]:
    """One finding for all materials that name one missing file."""
    missing: dict[str, list[ResourceUse]] = {}
    for use in list_resource_uses(model.source):
        if use.attribute.owner.tag == "texture" and _is_missing(use, model):
            missing.setdefault(format_path(use.resource.path), []).append(use)  # type: ignore[arg-type]
    for path, uses in missing.items():
        related = {use.attribute.span: use for use in uses[1:] if use.attribute.span != uses[0].attribute.span}
        yield rule.finding("texture", at=uses[0], related=related.values(), path=path)


def _is_missing(use: ResourceUse, model: Model) -> bool:
    """Whether nothing at all is there: other spellings of the name and paths of another machine have rules of their own."""
    resource = use.resource
    if resource.path is None or resource.exists or resource.actual_spelling is not None or not resource.allowed:
        return False
    return find_machine_path(use, model.source) is None and not resource.path.exists()
