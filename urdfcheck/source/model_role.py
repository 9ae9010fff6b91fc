"""What a file is once it is expanded: a robot model, a library of macros, or a part of the models that include it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from urdfcheck.core.records import dataclass
from urdfcheck.core.text import SLIP_LIKENESS, find_only_near_name, truncate_text
from urdfcheck.source.load import Source, find_naming_launch
from urdfcheck.source.package.file_kinds import FORMATS_BY_ROOT
from urdfcheck.source.text.xml import Element
from urdfcheck.source.xacro.file_contents import (
    can_have_name,
    can_stand_alone,
    defines_macros,
    has_parts,
    is_include,
    may_make_links,
)
from urdfcheck.source.xacro.usage import collect_macros, find_unprefixed_tags

# A library of macros may include those of a package that is not installed here.
_PACKAGE_MISSING = "package-not-found"
# Why a part cannot be expanded alone: what it uses is defined by the file that includes it, or is told there as well.
_FOR_WANT_OF_CONTEXT = frozenset({"expansion-failed", "argument-missing", "include-cycle", _PACKAGE_MISSING})
# The elements of a semantic description; those in which names of links and joints are grouped, or pairs of links told apart.
_SEMANTIC = frozenset({"group", "group_state", "virtual_joint", "passive_joint", "end_effector", "disable_collisions"})
# A long name is not shown whole.
_LONGEST_NAME = 60
# What chooses which files are included.
_CHOOSING = frozenset({"xacro:if", "xacro:unless", "xacro:property", "xacro:arg"})
# What completes a robot and names its links or joints, or the devices of one that is in a world of Webots.
_COMPLETING = frozenset({"ros2_control", "gazebo", "transmission", "webots"})
# The formats that xacro also makes, by root element: how their files are named before `.xacro`.
_NAMES_OF_FORMATS = {
    "sdf": frozenset({"sdf", "world"}),
    "mujoco": frozenset({"mjcf", "mujoco"}),
    "mujocoinclude": frozenset({"mjcf", "mujoco"}),
}
# What makes nothing of a robot: the definitions of xacro, which some files have without their prefix, and those of colours.
_DEFINITIONS = frozenset({"macro", "property", "arg", "material"})


@dataclass(frozen=True, slots=True)
class ModelRole:
    """What an expanded file is."""

    kind: str
    """model | library (it makes neither link nor joint) | part (it takes the file that includes it to be a robot)."""
    reason: str = ""
    """Why it is a part, or a library."""
    is_doubtful: bool = False
    """Whether it may still be a robot by itself: it has a name, and could not be expanded."""
    has_whole_links: bool = False
    """Whether it makes links, and no joint that needs a link from elsewhere: a mistake or a trick makes it a part."""

    @property
    def must_be_checked(self) -> bool:
        """Whether a part that belongs to no model is a model that was not checked."""
        return self.is_doubtful or self.has_whole_links


MODEL = ModelRole("model")
LIBRARY = ModelRole("library", "only defines macros")
SEMANTIC_DESCRIPTION = ModelRole("library", "describes another robot (SRDF)")
FRAGMENT = ModelRole("library", "holds only what completes another robot")


def find_model_role(
    source: Source, *, is_part: bool, is_tentative: bool = False, launches: Sequence[Path] = ()
) -> ModelRole:
    """Return what a file is.

    ``is_part``: whether another file includes it or may include it; what no file includes is a model, however broken, or a
    library. ``is_tentative``: whether it is not one if it makes neither link nor joint. ``launches``: the launch files that
    lead to it.
    """
    root = source.root
    if root is None:
        return _find_unexpanded_role(source, is_part=is_part)
    if source.find_problems("prefix"):
        return MODEL
    if root.tag != "robot":
        return _find_role_of_another_root(source, root, is_part=is_part, launches=launches)
    if not any(child.tag in {"link", "joint"} for child in root.children):
        if not is_part and has_unprefixed_calls(source, root):
            return MODEL
        if _is_semantic(root):
            return SEMANTIC_DESCRIPTION
        if _is_fragment(source, root):
            return FRAGMENT
        return LIBRARY if is_part or is_tentative or _is_library(source) else MODEL
    if not is_part:
        return FRAGMENT if source.is_xacro and _has_only_joints(source.main_tree) else MODEL
    elsewhere = explain_joint_to_elsewhere(root)
    reason = _explain_incompleteness(root, elsewhere)
    return ModelRole("part", reason, has_whole_links=not elsewhere) if reason else MODEL


def collect_robot_files(source: Source) -> frozenset[str]:
    """Return the names of the files of which a link or joint of the robot was made: typed there, or by a call there.

    Of a file that can make neither, a transmission, a block of Gazebo or what is within a block of ros2_control is enough; of one
    that only chooses what is included, that xacro read it.
    """
    children = () if source.root is None else source.root.children
    completing = _collect_files(e for child in children if child.tag in _COMPLETING for e in child.walk())
    return (
        _collect_files(child for child in children if child.tag in {"link", "joint"})
        | {
            name
            for name in completing
            if (tree := source.trees.get(name)) is not None
            and not any(element.tag == "link" or is_include(element) for element in tree.walk())
        }
        | {name for name, tree in source.trees.items() if name != source.name and _only_includes(tree)}
    )


def _only_includes(tree: Element) -> bool:
    """Whether a file has nothing but includes, the conditions around them and what these read: no element of a robot is of it."""
    inner = [element for element in tree.walk() if element is not tree]
    return any(map(is_include, inner)) and all(is_include(e) or e.tag in _CHOOSING for e in inner)


def _collect_files(elements: Iterable[Element]) -> frozenset[str]:
    """Return the names of the files in which elements are typed, or called."""
    return frozenset(span.file for element in elements for span in (element.span, *element.via) if span is not None)


def _find_unexpanded_role(source: Source, *, is_part: bool) -> ModelRole:
    tree = source.main_tree
    kinds = {problem.kind for problem in source.problems}
    if tree is None or kinds.isdisjoint(_FOR_WANT_OF_CONTEXT):
        return MODEL
    if _has_only_joints(tree):
        return FRAGMENT
    may_have_name = can_stand_alone(tree)
    if not may_have_name and _PACKAGE_MISSING in kinds and defines_macros(tree) and not has_parts(tree):
        return LIBRARY
    return (
        ModelRole("part", "it cannot be expanded without the file that includes it", may_have_name)
        if is_part
        else MODEL
    )


def _has_only_joints(tree: Element | None) -> bool:
    """Whether a file without a robot's name has joints and nothing that could make the links which they join."""
    if tree is None or tree.tag != "robot" or can_have_name(tree):
        return False
    return any(child.tag == "joint" for child in tree.children) and not any(map(may_make_links, tree.walk()))


def has_unprefixed_calls(source: Source, root: Element) -> bool:
    """Whether a file calls macros that make links or joints, or includes files as a robot with a name, and only forgets the
    prefix: xacro copies the tags. The calls of a robot with a name may be in a file that it includes."""
    return bool(list_unprefixed_calls(source, root))


def list_unprefixed_calls(source: Source, root: Element) -> list[Element]:
    """Return the calls and includes that only lack the prefix to make links or joints, as they are left in the robot."""
    if not source.is_xacro:
        return []
    macros, has_name = collect_macros(source.trees), "name" in root.attributes
    return [
        call
        for call in find_unprefixed_tags(source.trees, root)
        if call.parent is root
        and call.span is not None
        and (has_name or call.span.file == source.name)
        and (
            has_name and call.span.file == source.name
            if is_include(call)
            else call.tag in macros and any(e.tag in {"link", "joint"} for e in macros[call.tag].element.walk())
        )
    ]


def _is_library(source: Source) -> bool:
    tree = source.main_tree
    return source.is_xacro and (defines_macros(tree) or not has_parts(tree))


def _is_semantic(root: Element) -> bool:
    """Whether a robot without links and joints is the semantic description of another one."""
    return any(child.tag in _SEMANTIC for child in root.children)


def _is_fragment(source: Source, root: Element) -> bool:
    """Whether a robot without links and joints completes another one: no file that was read could make a link."""
    if not any(child.tag in _COMPLETING for child in root.children):
        return False
    # An include under a condition may be one that was not read.
    return not any(
        element.tag == "link" or (element.tag in {"xacro:if", "xacro:unless"} and any(map(is_include, element.walk())))
        for tree in source.trees.values()
        for element in tree.walk()
    )


def _find_role_of_another_root(source: Source, root: Element, *, is_part: bool, launches: Sequence[Path]) -> ModelRole:
    """Return what a file is whose root is not ``<robot>``: xacro ignores the root of what it includes."""
    is_as_named = source.is_xacro and _is_named_as_its_format(source, root)
    # A launch file that makes it robot_description has the wrong file.
    if is_as_named and find_naming_launch(source.path, launches, source.finder) is None:
        return ModelRole("library", f"it is {FORMATS_BY_ROOT[root.tag]}, as its name says")
    if not source.is_xacro or root.tag in FORMATS_BY_ROOT:
        return MODEL
    if only_defines(source.main_tree) and all(map(_is_definition, root.children)):
        return LIBRARY
    tag = truncate_text(root.tag, _LONGEST_NAME)
    if makes_another_format(source, root):
        return ModelRole("library", f"its root is <{tag}>: xacro makes something else than URDF of it")
    return ModelRole("part", f"its root is <{tag}>, not <robot>") if is_part else MODEL


def makes_another_format(source: Source, root: Element) -> bool:
    """Whether an expanded xacro is of another format, such as a scenario of a simulator: its name does not say URDF, and its
    root has another tag and neither link nor joint."""
    is_named_urdf = ".urdf" in source.path.name.lower()
    has_parts = any(child.tag in {"link", "joint"} for child in root.children)
    is_of_robot = root.tag in _COMPLETING or root.tag.lower() == "robot"
    return source.is_xacro and not (is_of_robot or is_named_urdf or has_parts)


def _is_named_as_its_format(source: Source, root: Element) -> bool:
    """Whether the name of a xacro file says the format that it makes: `room.sdf.xacro`, `room.world.xacro`."""
    words = source.path.name.lower().split(".")[1:]
    return "urdf" not in words and not _NAMES_OF_FORMATS.get(root.tag, frozenset()).isdisjoint(words)


def only_defines(tree: Element | None) -> bool:
    """Whether a file only gives others its macros, properties, arguments and materials, of which no robot can be made: its
    root may have any name."""
    return tree is not None and bool(tree.children) and all(map(_is_definition, tree.children))


def _is_definition(element: Element) -> bool:
    """Whether an element at the root is of xacro, a definition that lacks its prefix (XAC007), or a material."""
    return element.tag.startswith("xacro:") or element.tag in _DEFINITIONS


def _explain_incompleteness(root: Element, elsewhere: str) -> str:
    """Return why a robot is not complete by itself; empty if it has a name and its joints join its links to one tree."""
    if "name" not in root.attributes:
        return "its <robot> has no name"
    children = _collect_children(root)
    children |= {link for name in children if (link := _find_meant_link(root, name))}
    return elsewhere or ("" if len(_collect_links(root) - children) == 1 else "its links are not one tree")


def explain_joint_to_elsewhere(root: Element) -> str:
    """Return which joint names a link that the robot has not, and of whose name it is not a misspelling; empty if none does."""
    links = _collect_links(root)
    for joint in root.find_children("joint"):
        for end in ("parent", "child"):
            name = _get_end(joint, end)
            if name not in links and not (end == "child" and _find_meant_link(root, name)):
                shown = truncate_text(joint.get("name"), _LONGEST_NAME), truncate_text(name, _LONGEST_NAME)
                return f"joint {shown[0]!r} names the link {shown[1]!r}, which is elsewhere"
    return ""


def _find_meant_link(root: Element, child: str) -> str | None:
    """Return the only link, beside the root, that no joint carries and that an unknown child misspells; else None."""
    links = _collect_links(root)
    loose = links - _collect_children(root)
    return find_only_near_name(child, loose, SLIP_LIKENESS) if child not in links and len(loose) > 1 else None


def _collect_children(root: Element) -> set[str]:
    return {_get_end(joint, "child") for joint in root.find_children("joint")}


def _collect_links(root: Element) -> set[str]:
    return {link.get("name").strip() for link in root.find_children("link")}


def _get_end(joint: Element, end: str) -> str:
    """Return the link that a joint names as its ``end``: parent | child."""
    element = joint.find_child(end)
    return "" if element is None else element.get("link").strip()
