"""A model as plain comparable values, to compare two models of one package."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path

from urdfcheck.core import Location
from urdfcheck.core.records import dataclass
from urdfcheck.model import Model
from urdfcheck.source.package.finder import format_path
from urdfcheck.source.text.values import parse_number
from urdfcheck.source.text.xml import Element
from urdfcheck.source.xacro.usage import find_unprefixed_tags

Value = tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelOutline:
    """A model as plain comparable values."""

    model: str
    """The model's id."""
    robot: str
    package: str | None
    path: str
    files: frozenset[str]
    """The names of its files: its own and those that it includes."""
    is_xacro: bool
    location: Location
    links: frozenset[str]
    joints: frozenset[str]
    parts: Mapping[str, Value]
    """``link[wheel_1]/inertial/mass@value`` to its value."""
    extensions: Mapping[str, int]
    """How many elements there are of each other tag, such as ``gazebo``."""
    hardware: Value
    """The plugins of hardware that ros2_control loads."""
    is_output_of_xacro: bool
    is_complete: bool
    """Whether no call of a macro lacks its prefix, so that all parts are known."""


def build_outline(model: Model) -> ModelOutline:
    """Build the outline of a model; the caller fills in ``model``, its id."""
    parts: dict[str, Value] = {}
    extensions: dict[str, int] = {}
    hardware: list[str] = []
    for element in model.robot.children:
        if element.tag == "ros2_control":
            blocks = element.find_children("hardware")
            hardware += [plugin.text.strip() for block in blocks for plugin in block.find_children("plugin")]
        if element.tag in {"link", "joint"}:
            below = [(element, element.subject)]
            while below:
                inner, subject = below.pop()
                below += [(child, f"{subject}/{child.label}") for child in reversed(inner.children)]
                for name, attribute in inner.attributes.items():
                    value = normalize_path(model, attribute.value) if name == "filename" else attribute.value
                    parts[f"{subject}@{name}"] = normalize_value(value)
                if not inner.attributes:
                    parts[subject] = ()
        else:
            extensions[element.tag] = extensions.get(element.tag, 0) + 1
    package = model.package
    return ModelOutline(
        model="",
        robot=model.name,
        package=None if package is None else package.path.as_posix(),
        path=model.source.name,
        files=frozenset(model.source.files),
        is_xacro=model.source.is_xacro,
        location=_locate_robot_name(model.robot),
        links=frozenset(link.name for link in model.links),
        joints=frozenset(joint.name for joint in model.joints),
        parts=parts,
        extensions=extensions,
        hardware=tuple(hardware),
        is_output_of_xacro=model.source.is_output_of_xacro,
        is_complete=not find_unprefixed_tags(model.source.trees, model.robot),
    )


def _locate_robot_name(robot: Element) -> Location:
    name = robot.attributes.get("name")
    return robot.location if name is None else name.location


def normalize_path(model: Model, value: str) -> str:
    """Return an absolute path as one in its package: ``$(find p)/a.stl`` is ``package://p/a.stl``, on whatever machine."""
    path = Path(value.strip().removeprefix("file://"))
    if not path.is_absolute():
        return value
    package = model.source.finder.find_package_of(path)
    if package is None or not path.is_relative_to(package.path):
        return format_path(path)
    return f"package://{package.name}/{path.relative_to(package.path).as_posix()}"


@lru_cache(maxsize=4096)
def normalize_value(value: str) -> Value:
    """Return numbers in one notation (``1`` and ``1.0`` are one value), and everything else as words."""
    words = value.split()
    return tuple(word if parse_number(word) is None else repr(parse_number(word)) for word in words)
