"""XML011 reports materials that are not defined, and textures that do not exist."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import replace
from pathlib import Path

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.merging import build_group_finding
from urdfcheck.core.text import find_nearest_name, format_count, format_name_hint
from urdfcheck.model import Model
from urdfcheck.model.parts import Shape
from urdfcheck.model.use.gazebo_starts import is_only_for_gazebo
from urdfcheck.model.use.project_texts import list_project_texts
from urdfcheck.source.package.finder import format_path, is_kept_aside
from urdfcheck.source.resources import ResourceUse, find_missing_path, list_resource_uses
from urdfcheck.source.text.xml import Element
from urdfcheck.source.uses_elsewhere import is_named_nowhere

# What makes something of what it holds, or nothing.
_TEMPLATES = frozenset({"xacro:macro", "xacro:if", "xacro:unless"})
# The largest size of a shape that is there for its frame (m). Chosen in a gap: published robots draw shapes of up to 2 mm, and
# then of 10 mm and more.
_SPECK = 0.005
# The colours of plain names; those of others are not known.
_COLOURS = {
    "black": "0 0 0 1",
    "blue": "0 0 1 1",
    "brown": "0.6 0.4 0.2 1",
    "cyan": "0 1 1 1",
    "gray": "0.5 0.5 0.5 1",
    "green": "0 1 0 1",
    "grey": "0.5 0.5 0.5 1",
    "magenta": "1 0 1 1",
    "orange": "1 0.5 0 1",
    "purple": "0.5 0 0.5 1",
    "red": "1 0 0 1",
    "white": "1 1 1 1",
    "yellow": "1 1 0 1",
}


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    yield from _check_undefined_materials(model, rule)
    yield from _check_textures(model, rule)


def _check_undefined_materials(model: Model, rule: Rule) -> Iterator[Finding]:
    """Report all shapes that refer to one undefined name together."""
    shapes = {id(shape.element): (link.name, shape) for link in model.links for shape in link.visuals}
    used = [m for _, shape in shapes.values() for m in shape.element.find_children("material")[:1]]
    defined = {m.get("name") for m in model.robot.find_children("material") if _has_appearance(m)}
    everywhere = defined | {m.get("name") for m in used if _has_appearance(m)}
    without: dict[str, list[Element]] = {}
    for material in used:
        name = material.get("name")
        if _has_appearance(material):
            defined.add(name)  # for the shapes after it
        elif name.strip() and name not in defined:
            without.setdefault(name, []).append(material)
    for name, materials in without.items():
        if name not in everywhere and (model.source.is_part or _hangs_on_another_robot(model)):
            continue  # the file that includes this one may define it, and is checked as well
        names = [material.attributes["name"] for material in materials]
        unused = None if name in everywhere else _find_unused_definition(model, name)
        finding = build_group_finding(
            rule,
            "later" if name in everywhere else "undefined",
            names,
            material=name,
            shapes=format_count(len(names), "shape refers", "shapes refer"),
            where="no file of this model defines" if unused is None else _describe_place(unused),
            near="" if unused is not None else format_name_hint(name, everywhere),
            repair="" if name in everywhere else _describe_repair(model, name, everywhere, unused),
        )
        # What no program loads looks like nothing, nor does what is too small, or what only a simulator draws in its own colour.
        links, drawn = zip(*(shapes[id(material.parent)] for material in materials), strict=True)
        is_unseen = all(map(_is_speck, drawn)) or _are_coloured_by_gazebo(model, links) or _is_only_for_mujoco(model)
        is_note = _is_left_aside(model) or (is_unseen and not _is_for_drake(model))
        yield replace(finding, severity=Severity.INFO) if is_note else finding


def _is_for_drake(model: Model) -> bool:
    """Whether Drake, which refuses the file, is a target, or a file of the project names it."""
    return "drake" in model.targets or any("drake" in text for text in list_project_texts(model))


def _is_speck(shape: Shape) -> bool:
    """Whether a shape is too small to be seen: it stands for a frame."""
    kind, size = shape.kind, shape.size
    if kind in {None, "mesh"} or not size:
        return False
    return (max(size) if kind == "box" else 2 * size[0] if kind == "sphere" else max(2 * size[0], size[1])) <= _SPECK


def _are_coloured_by_gazebo(model: Model, links: Collection[str]) -> bool:
    """Whether blocks of Gazebo colour all these links, and nothing else draws the robot."""
    coloured = {
        block.get("reference")
        for block in model.robot.find_children("gazebo")
        if any(element.tag == "material" for element in block.walk())
    }
    return coloured.issuperset(links) and is_only_for_gazebo(model)


def _is_only_for_mujoco(model: Model) -> bool:
    """Whether the file has settings of MuJoCo, which draws the shape anyway, and no launch file names it."""
    from urdfcheck.source.launch.loaded_files import is_named_by_launch  # few models have such settings

    source = model.source
    return model.robot.find_child("mujoco") is not None and not is_named_by_launch(source.path, source.finder)


def _is_left_aside(model: Model) -> bool:
    """Whether the file is kept in a folder of files that are not used, and no file of its project names it."""
    return is_kept_aside(model.source.path, model.source.package) and is_named_nowhere(model.source)


def _hangs_on_another_robot(model: Model) -> bool:
    """Whether all links of a xacro hang on a link that it has not, so that a robot elsewhere includes it (KIN002)."""
    links, children = {link.name for link in model.links}, {joint.child for joint in model.joints}
    return model.source.is_xacro and links <= children and any(joint.parent not in links for joint in model.joints)


def _find_unused_definition(model: Model, name: str) -> Element | None:
    """Return the element of xacro around a definition that the files of the model have and the expanded robot has not."""
    materials = (e for tree in model.source.trees.values() for e in tree.walk() if e.tag == "material")
    defining = (e for e in materials if e.get("name") == name and _has_appearance(e))
    around = (_find_template(material) for material in defining)
    return next((element for element in around if element is not None), None)


def _find_template(element: Element) -> Element | None:
    """Return the macro or the condition around an element."""
    while element.parent is not None:
        element = element.parent
        if element.tag in _TEMPLATES:
            return element
    return None


def _describe_place(template: Element) -> str:
    file = "" if template.span is None else f"{Path(template.span.file).name} "
    if template.tag == "xacro:macro":
        return f"{file}defines only in the macro {template.get('name')}, which is not called here"
    return f"{file}defines only under a condition that is false here"


def _describe_repair(model: Model, name: str, known: Collection[str], unused: Element | None) -> str:
    if unused is not None and unused.tag == "xacro:macro" and {child.tag for child in unused.children} == {"material"}:
        needed = [word for word in unused.get("params").split() if "=" not in word]
        call = f"<xacro:{unused.get('name').removeprefix('xacro:')}{' …' if needed else ''}/>"
        return f"write `{call}` {'in place of this <material>' if len(unused.children) == 1 else 'at the start of <robot>'}"
    define = f"define it as a child of <robot>: {_propose_definition(model, name)}"
    near = find_nearest_name(name, known)
    # A second spelling of a colour that the robot has would be a second material.
    return f"{define}, or correct the name" if near is None else f"write `{near}` if that is meant; else {define}"


def _propose_definition(model: Model, name: str) -> str:
    """Return the element that defines the material: with its colour in another file of the repository, or else a usual one."""
    from urdfcheck.model.likeness.whole_models import find_colour_elsewhere  # loaded only for such a file

    elsewhere = find_colour_elsewhere(model, name)
    colour = _COLOURS.get(name.strip().lower(), "…") if elsewhere is None else elsewhere[1]
    element = f'`<material name="{name}"><color rgba="{colour}"/></material>`'
    return element if elsewhere is None else f"{element} (its colour in {format_path(elsewhere[0])})"


def _has_appearance(material: Element) -> bool:
    return bool(material.find_child("color") or material.find_child("texture"))


def _check_textures(model: Model, rule: Rule) -> Iterator[Finding]:
    """Report all materials that name one missing file together; a folder in its place is not reported."""
    missing: dict[str, list[ResourceUse]] = {}
    for use in list_resource_uses(model.source):
        path = find_missing_path(use, model.source) if use.attribute.owner.tag == "texture" else None
        if path is not None and not path.exists():
            missing.setdefault(format_path(path), []).append(use)
    for missing_path, uses in missing.items():
        related = {use.attribute.span: use for use in uses[1:] if use.attribute.span != uses[0].attribute.span}
        yield rule.finding("texture", at=uses[0], related=related.values(), path=missing_path)
