"""What the files around a model say about it, as plain statements that can be compared with those of another version."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING

from urdfcheck.core.seams import SeamFact
from urdfcheck.source.text.xml import Element
from urdfcheck.source.xacro.usage import iter_elements_by_tag

if TYPE_CHECKING:
    from urdfcheck.model import Model
    from urdfcheck.source.launch.launch_file import Launch
    from urdfcheck.source.load import Source
    from urdfcheck.source.package.finder import Package
    from urdfcheck.source.ros.controllers import ControllerConfig
    from urdfcheck.source.ros.srdf import Srdf

# Statements that are kept of one model, launch file or package.
_MOST_FACTS = 20_000
# What else a semantic description holds, and the attributes that name links or joints.
_SRDF_PARTS = {
    "end_effector": {"parent_link": "link"},
    "virtual_joint": {"child_link": "link"},
    "passive_joint": {"name": "joint"},
}
_GROUP_PARTS = {
    "link": {"name": "link"},
    "joint": {"name": "joint"},
    "chain": {"base_link": "link", "tip_link": "link"},
}


def list_model_seams(model: Model) -> tuple[SeamFact, ...]:
    """Return what semantic descriptions and controller configurations say about a model, and its arguments."""
    from urdfcheck.model.motion.controllers import find_controller_configs  # these load numpy
    from urdfcheck.model.motion.semantic_descriptions import semantic_descriptions
    from urdfcheck.source.ros.srdf import is_about_model

    def iter_facts() -> Iterator[SeamFact]:
        yield from _iter_arguments(model.source)
        for srdf in semantic_descriptions(model):
            if is_about_model(srdf, model.source):
                yield from _iter_srdf(srdf)
        for associated in find_controller_configs(model):
            yield from _iter_controllers(associated.configuration)

    return tuple(islice(iter_facts(), _MOST_FACTS))


def list_launch_seams(launch: Launch) -> tuple[SeamFact, ...]:
    """Return the arguments of a launch file, and the models that it loads; nothing of the arguments of a Python file."""
    return tuple(islice(_iter_launch(launch), _MOST_FACTS))


def list_package_seams(package: Package) -> tuple[SeamFact, ...]:
    """Return the dependencies of a package."""
    children = () if package.root is None else package.root.children
    return tuple(
        SeamFact(kind="package", file="package.xml", start=f"{e.tag} {e.text.strip()}", span=e.span)
        for e in islice(children, _MOST_FACTS)
        if e.tag.endswith("depend") and e.text.strip()
    )


# -- arguments ---------------------------------------------------------------------------------------------------------


def _iter_arguments(source: Source) -> Iterator[SeamFact]:
    for element in iter_elements_by_tag(source.trees, "xacro:arg") if source.is_xacro else ():
        yield _make_argument("argument", source.path.name, element, "default")


def _make_argument(kind: str, file: str, element: Element, *attributes: str) -> SeamFact:
    given = [f"{name} {element.get(name)!r}" for name in attributes if name in element.attributes]
    start = f"argument {element.get('name')}"
    return SeamFact(kind=kind, file=file, start=start, value=", ".join(given) or "no default", span=element.span)


def _iter_launch(launch: Launch) -> Iterator[SeamFact]:
    for element in () if launch.root is None else launch.root.find_children("arg"):
        yield _make_argument("launch", launch.path.name, element, "default", "value")
    for description in launch.descriptions:
        passed = ", ".join(f"{name}:={value}" for name, value in sorted(description.arguments.items()))
        yield SeamFact(
            kind="launch",
            file=launch.path.name,
            start=f"model {Path(description.file).name}",
            value=passed or "no arguments",
            span=description.at.location.span,
        )


# -- semantic descriptions ---------------------------------------------------------------------------------------------


def _iter_srdf(srdf: Srdf) -> Iterator[SeamFact]:
    file = srdf.path.name
    for state, pairs in (("disabled", srdf.disabled_pairs), ("enabled", srdf.enabled_pairs)):
        for pair in pairs:
            names = tuple(("link", link) for link in pair.links)
            start, span = f"{state} pair", pair.element.span
            yield SeamFact(kind="srdf", file=file, start=start, names=names, are_unordered=True, span=span)
    for name, group in srdf.groups.items():
        for element in group.children:
            if element.tag == "group":
                start, end = f"group {element.get('name').strip()}", f"of group {name}"
                yield SeamFact(kind="srdf", file=file, start=start, end=end, span=element.span)
            elif element.tag in _GROUP_PARTS:
                yield _make_srdf_fact(file, element, element.tag, end=f"of group {name}")
    for state_element in srdf.root.find_children("group_state"):
        state, of_group = state_element.get("name").strip(), state_element.get("group").strip()
        for element in state_element.find_children("joint"):
            value = " ".join(element.get("value").split())
            yield _make_srdf_fact(file, element, "joint", end=f"in state {state} of group {of_group}", value=value)
    for element in srdf.root.children:
        if element.tag in _SRDF_PARTS:
            own = "" if element.tag == "passive_joint" else f" {element.get('name').strip()} of"
            named = {"name", *_SRDF_PARTS[element.tag]}
            others = (f"{key} {a.value.strip()}" for key, a in sorted(element.attributes.items()) if key not in named)
            yield _make_srdf_fact(file, element, f"{element.tag}{own}", value=", ".join(others))


def _make_srdf_fact(file: str, element: Element, start: str, *, end: str = "", value: str = "") -> SeamFact:
    kinds = (_SRDF_PARTS | _GROUP_PARTS)[element.tag]
    names = tuple((kind, element.get(attribute).strip()) for attribute, kind in kinds.items())
    return SeamFact(kind="srdf", file=file, start=start, names=names, end=end, value=value, span=element.span)


# -- controllers -------------------------------------------------------------------------------------------------------


def _iter_controllers(configuration: ControllerConfig) -> Iterator[SeamFact]:
    file = configuration.path.name
    for controller in configuration.controllers:
        whole = f"controller {controller.name}"
        yield SeamFact(kind="controllers", file=file, start=whole, value=controller.type, span=controller.key.span)
        for joint in controller.joints:
            yield SeamFact(
                kind="controllers",
                file=file,
                start="joint",
                names=(("joint", joint.text),),
                end=f"of {whole}",
                span=joint.span,
            )
