"""The models of a repository that a file without all its links is a part of, although none includes it."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping
from collections.abc import Set as AbstractSet
from itertools import islice
from pathlib import Path

from urdfcheck.model.fact import fact
from urdfcheck.model.robot import Model
from urdfcheck.source.load import Source
from urdfcheck.source.model_file import compile_includes
from urdfcheck.source.package.package_folders import BUILD_FOLDERS
from urdfcheck.source.project_folders import find_project_folder
from urdfcheck.source.text.values import parse_numbers
from urdfcheck.source.text.xml import COMMENT, Element
from urdfcheck.source.xacro.argument_values import read_included_trees
from urdfcheck.system.files import read_regular, walk

_SUFFIXES = (".urdf", ".xacro")
_ROBOT = re.compile(r"""<robot\s[^<>]*?\bname\s*=\s*(?:"([^"<>]*)"|'([^'<>]*)')""")
# What folders of robot files are called, which may have a folder for each kind of part.
_ROBOT_FOLDERS = frozenset({"urdf", "xacro", "robots"})
_JOINT_END = re.compile(r"""<(?:parent|child)\s[^<>]*?\blink\s*=\s*(?:"([^"<>]*)"|'([^'<>]*)')""")
_LINK_NAME = re.compile(r"""<link\s[^<>]*?\bname\s*=\s*(?:"([^"<>]*)"|'([^'<>]*)')""")
# How the namespace of XInclude ends, of its drafts too.
_XINCLUDE = '/XInclude"'
_LINK = re.compile(r"<link[\s>/]")
_DEFINED_COLOUR = re.compile(
    r"""<material\s+name\s*=\s*["']([^"'<>$]+)["']\s*>\s*<color\s+rgba\s*=\s*["']([^"'<>$]*)["']"""
)
# Limits on files of a repository that are compared, on folders that are searched, and on the size of a file.
_MOST_FILES, _MOST_FOLDERS, _LARGEST = 400, 5_000, 1_000_000
# So many robots that include a file are expanded.
_MOST_EXPANDED = 4


def find_whole_model(model: Model, links: AbstractSet[str]) -> Path | None:
    """Return another model of the repository with the same robot name in which all these links are spelled out, or None.

    It has other links too, at least half as many as the model: a copy with nearly the same links is not what the model lacks.
    """
    name, own = model.robot.get("name"), model.link_by_name.keys()
    if not name:
        return None
    for path in islice(_iter_robot_files(model.source), _MOST_FILES):
        try:
            match = _ROBOT.search(read_regular(path, _LARGEST).decode("utf-8", "replace"))
        except OSError:
            continue
        if match is None or name not in match.groups():
            continue
        trees = read_included_trees(path, model.source.finder)
        spelled = {e.get("name") for tree, _ in trees for e in tree.walk() if e.tag == "link"}
        if links <= spelled and 2 * len(spelled - links - own) >= len(own):
            return path
    return None


def find_including_robot(model: Model, link: str) -> Path | None:
    """Return the robot file in reach that includes this one, itself or by way of others, and has a link of this name, or None."""
    for path, trees in _iter_including_robots(model):
        if link in {e.get("name") for tree in trees for e in tree.walk() if e.tag == "link"}:
            return path
    return None


def list_including_robots(model: Model) -> list[Path]:
    """List the robot files in reach that include this one, themselves or by way of others."""
    return [path for path, _ in _iter_including_robots(model)]


def find_joining_robot(model: Model) -> Path | None:
    """Return the robot file in reach that includes this one and makes one piece of all its links, or None."""
    from urdfcheck.source.xacro.expand import expand_xacro  # loaded only for such a file

    for path in list_including_robots(model)[:_MOST_EXPANDED]:
        root = expand_xacro(path, {}, model.source.finder, extra_environment=model.source.environment).root
        if root is None:
            continue
        links = {e.get("name") for e in root.find_children("link")}
        ends = (end for joint in root.find_children("joint") for end in joint.find_children("child"))
        if links.issuperset(model.link_by_name) and len(links.difference(end.get("link") for end in ends)) == 1:
            return path
    return None


def _iter_including_robots(model: Model) -> Iterator[tuple[Path, list[Element]]]:
    """Yield the robot files in reach that include this one, each with the trees of the files that it includes."""
    source = model.source
    texts: dict[Path, str] = {}
    for path in islice(_iter_robot_files(source, is_in_reach=True), _MOST_FILES):
        try:
            text = COMMENT.sub("", read_regular(path, _LARGEST).decode("utf-8", "replace"))
        except OSError:
            continue
        if "include" in text:
            texts[path] = text
    own = os.path.realpath(source.path)
    names = {source.path.name} if texts else set()
    while names:
        including = compile_includes(names)
        found = [path for path, text in texts.items() if including.search(text)]
        for path in found:
            del texts[path]
            trees = read_included_trees(path, source.finder)
            # A package beside it may have a file of the same name.
            files = {os.path.realpath(folder / Path(e.span.file).name) for e, folder in trees if e.span is not None}
            if own in files:
                yield path, [tree for tree, _ in trees]
        names = {path.name for path in found}


def find_xincluding_file(model: Model) -> Path | None:
    """Return the robot file of the repository that includes this one by XInclude (`xmllint --xinclude`), or None."""
    own = re.compile(
        rf"""<\w+:include\s[^<>]*?\bhref\s*=\s*["'](?:[^"'<>]*/)?{re.escape(model.source.path.name)}["']"""
    )
    for path in islice(_iter_robot_files(model.source), _MOST_FILES):
        try:
            text = read_regular(path, _LARGEST).decode("utf-8", "replace")
        except OSError:
            continue
        if _XINCLUDE in text and own.search(COMMENT.sub("", text)):
            return path
    return None


def is_named_elsewhere(model: Model, link: str) -> bool:
    """Whether another robot file in reach names this link, so that its robot is probably known there."""
    for path in islice(_iter_robot_files(model.source, is_in_reach=True), _MOST_FILES):
        try:
            text = read_regular(path, _LARGEST).decode("utf-8", "replace")
        except OSError:
            continue
        if f'"{link}"' in text or f"'{link}'" in text:
            return True
    return False


def find_defining_file(model: Model, link: str) -> Path | None:
    """Return the nearest other robot file of the model's package, or of its folder without one, that spells out a link of this
    name and none of the model's own, or None: a common name such as ``base_link`` is in files of other robots too."""
    package = model.source.package
    home = model.source.path.absolute().parent if package is None else package.path.absolute()
    near = (path for path in _list_nearest_files(model) if path.absolute().is_relative_to(home))
    spelled = ((path, _read_link_names(model, path)) for path in near)
    return next((path for path, names in spelled if link in names and names.isdisjoint(model.link_by_name)), None)


@fact
def _list_nearest_files(model: Model) -> tuple[Path, ...]:
    """Return the robot files of the repository, those nearest to the model first."""
    files = islice(_iter_robot_files(model.source), _MOST_FILES)
    return tuple(sorted(files, key=lambda path: (-_measure_common_path(model, path), path)))


@fact
def _read_link_names(_model: Model, path: Path) -> frozenset[str]:
    """Return the links that a file spells out; a model with many unknown links asks for those of the same file for each."""
    try:
        text = read_regular(path, _LARGEST).decode("utf-8", "replace")
    except OSError:
        return frozenset()
    return frozenset(a or b for a, b in _LINK_NAME.findall(COMMENT.sub("", text)))


def _measure_common_path(model: Model, path: Path) -> int:
    """Return the length of what a path has in common with that of the model's folder."""
    return len(os.path.commonpath([model.source.path.parent.absolute(), path.absolute()]))


def find_joints_elsewhere(source: Source) -> Path | None:
    """Return the file of the repository with the joints between the links of a file that has links only, or None.

    Such a file has no links, and its joints name no others.
    """
    root = source.root
    links = set() if root is None else {e.get("name") for e in root.find_children("link")}
    if root is None or not source.is_xacro or len(links) < 2 or root.find_children("joint"):
        return None
    for path in islice(_iter_robot_files(source), _MOST_FILES):
        try:
            text = COMMENT.sub("", read_regular(path, _LARGEST).decode("utf-8", "replace"))
        except OSError:
            continue
        ends = [a or b for a, b in _JOINT_END.findall(text)]
        if len(ends) > 1 and links.issuperset(ends) and not _LINK.search(text):
            return path
    return None


def find_colour_elsewhere(model: Model, material: str) -> tuple[Path, str] | None:
    """Return the nearest robot file of the repository that defines a material of this name by a literal colour, and its rgba."""
    return _find_colours_elsewhere(model).get(material)


@fact
def _find_colours_elsewhere(model: Model) -> Mapping[str, tuple[Path, str]]:
    found: dict[str, tuple[int, Path, str]] = {}
    for path in islice(_iter_robot_files(model.source), _MOST_FILES):
        try:
            text = COMMENT.sub("", read_regular(path, _LARGEST).decode("utf-8", "replace"))
        except OSError:
            continue
        shared = _measure_common_path(model, path)
        for name, rgba in _DEFINED_COLOUR.findall(text):
            is_nearest = name not in found or (-shared, path) < found[name][:2]
            if is_nearest and parse_numbers(rgba, count=4) is not None:
                found[name] = -shared, path, " ".join(rgba.split())
    return {name: (path, rgba) for name, (_, path, rgba) in found.items()}


def _iter_robot_files(source: Source, *, is_in_reach: bool = False) -> Iterator[Path]:
    """Yield the robot files of the repository around a model, or of its package, that the model does not use itself.

    ``is_in_reach``: without a repository, those of the folder that the run was given too, which may hold other packages.
    """
    used = {os.path.realpath(file.path) for file in source.files.values()}
    find = source.finder.find_searched_project if is_in_reach else find_project_folder
    top, own = find(source.path), source.path.absolute().parent
    if top.absolute() == own and own.parent.name.lower() in _ROBOT_FOLDERS:  # without a repository and a package
        top = own.parent
    for here, names, files in islice(walk(top), _MOST_FOLDERS):
        names[:] = sorted(n for n in names if not n.startswith(".") and n not in BUILD_FOLDERS)
        for path in (Path(here, name) for name in sorted(files) if name.lower().endswith(_SUFFIXES)):
            if os.path.realpath(path) not in used and source.finder.can_open(path):
                yield path
