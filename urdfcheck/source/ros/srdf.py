"""Semantic descriptions (SRDF) as typed: planning groups, states, and the pairs of links that MoveIt does not check for
collisions."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path

from urdfcheck.core.errors import ModelTimeout
from urdfcheck.core.records import dataclass
from urdfcheck.source.load import Source
from urdfcheck.source.package.file_kinds import SRDF_SUFFIXES, is_model, is_xacro
from urdfcheck.source.package.finder import Package, PackageFinder, format_path, load_package
from urdfcheck.source.package.package_folders import BUILD_FOLDERS, list_subfolders
from urdfcheck.source.ros.yaml_files import read_located_yaml
from urdfcheck.source.text.problems import Problem
from urdfcheck.source.text.xml import COMMENT, Attribute, Element, SourceFile, XmlError, parse_leniently, parse_xml
from urdfcheck.source.text.yaml.values import YamlReadError, YamlValue
from urdfcheck.source.xacro.file_contents import has_only_macros
from urdfcheck.source.xacro.usage import read_argument_defaults
from urdfcheck.system.files import read_regular, remember_large_folders

# The folders of semantic descriptions in a MoveIt configuration. A description package of several robots may have one beside
# each of them (robots/panda_description/srdf): the model's own package is searched, to a depth and a number of folders.
SRDF_FOLDERS = ("", "config", "srdf")
LEVELS_DOWN = 3
# The file in which the MoveIt Setup Assistant keeps what it was told.
SETUP_FILE = ".setup_assistant"
MAX_FOLDERS = 200
# The launch file of MoveIt 1 that loads the model and its description, the element that does, and the model in it.
_PLANNING_CONTEXT = "launch/planning_context.launch"
_PARAMETER = re.compile(r"<param\b[^<>]*>")
_DESCRIPTION = re.compile(r"\bname\s*=\s*[\"'](?:\$\(arg robot_description\)|/?robot_description)[\"']")
_MODEL = re.compile(r"\$\(find\s+([\w.-]+)\s*\)/([^\s\"'<>$]+\.(?:urdf|xacro))(?=[\s\"'])")
# A group that holds no other.
_GROUP = re.compile(r"<group\b(?:(?!<group\b).)*?</group>", re.DOTALL)
# The attributes that name links and joints of the robot, by element and the element around it.
_PART_NAMES = {
    ("link", "group"): {"name": "link"},
    ("chain", "group"): {"base_link": "link", "tip_link": "link"},
    ("end_effector", "robot"): {"parent_link": "link"},
    ("virtual_joint", "robot"): {"child_link": "link"},
    ("joint", "group"): {"name": "joint"},
    ("joint", "group_state"): {"name": "joint"},
    ("passive_joint", "robot"): {"name": "joint"},
}


@dataclass(frozen=True, slots=True, eq=False)
class SrdfPair:
    """A ``<disable_collisions>`` or ``<enable_collisions>``. ``links`` are trimmed as MoveIt does; a missing one is empty."""

    element: Element
    links: tuple[str, str]

    @property
    def reason(self) -> str:
        return self.element.get("reason").strip()

    @property
    def key(self) -> frozenset[str]:
        """The pair without its order."""
        return frozenset(self.links)

    def get_link(self, index: int) -> Attribute | None:
        """Return the attribute that names the first (0) or the second (1) link."""
        return self.element.attributes.get(f"link{index + 1}")


@dataclass(frozen=True, eq=False)
class Srdf:
    """One semantic description, expanded if it is a xacro. ``name`` is the name of its file in findings."""

    path: Path
    name: str
    root: Element
    files: Mapping[str, SourceFile]

    @property
    def robot(self) -> str:
        return self.root.get("name").strip()

    def iter_part_names(self) -> Iterator[tuple[str, Attribute]]:
        """Yield the attributes that name links and joints of the robot, each with its kind; those of pairs are not among them."""
        for element in self.root.walk():
            around = element.parent.tag if element.parent is not None else ""
            for name, kind in _PART_NAMES.get((element.tag, around), {}).items():
                attribute = element.attributes.get(name)
                if attribute is not None and attribute.value.strip():
                    yield kind, attribute

    @cached_property
    def disabled_pairs(self) -> tuple[SrdfPair, ...]:
        return self._read_pairs("disable_collisions")

    @cached_property
    def enabled_pairs(self) -> tuple[SrdfPair, ...]:
        return self._read_pairs("enable_collisions")

    @cached_property
    def default_disabled_links(self) -> frozenset[str]:
        """The links of ``<disable_default_collisions>``: they only collide with links that are enabled for them."""
        return frozenset(e.get("link").strip() for e in self.root.find_children("disable_default_collisions"))

    @cached_property
    def grouped_links(self) -> frozenset[str]:
        """The links that groups, chains, end effectors and virtual joints name."""
        return frozenset(attribute.value.strip() for kind, attribute in self.iter_part_names() if kind == "link")

    @cached_property
    def named_links(self) -> frozenset[str]:
        """All links that it names: those of groups and those of disabled pairs."""
        return self.grouped_links | {name for pair in self.disabled_pairs for name in pair.links}

    @cached_property
    def groups(self) -> Mapping[str, Element]:
        """The planning groups by name; MoveIt reads the first of a name."""
        groups: dict[str, Element] = {}
        for group in self.root.find_children("group"):
            groups.setdefault(group.get("name").strip(), group)
        return groups

    @cached_property
    def virtual_joints(self) -> frozenset[str]:
        return frozenset(e.get("name").strip() for e in self.root.find_children("virtual_joint"))

    def is_pair_disabled(self, first: str, second: str) -> bool:
        """Whether MoveIt ignores this pair. Its AllowedCollisionMatrix applies link defaults, enabled, then disabled pairs."""
        pair = frozenset((first, second))
        if pair in self._disabled_keys:
            return True
        return pair not in self._enabled_keys and not self.default_disabled_links.isdisjoint(pair)

    @cached_property
    def _disabled_keys(self) -> frozenset[frozenset[str]]:
        return frozenset(pair.key for pair in self.disabled_pairs)

    @cached_property
    def _enabled_keys(self) -> frozenset[frozenset[str]]:
        return frozenset(pair.key for pair in self.enabled_pairs)

    def _read_pairs(self, tag: str) -> tuple[SrdfPair, ...]:
        return tuple(
            SrdfPair(e, (e.get("link1").strip(), e.get("link2").strip())) for e in self.root.find_children(tag)
        )


def load_srdfs(source: Source, robot: str) -> tuple[Srdf, ...]:
    """Load the semantic descriptions in reach whose robot has this name; a ``.srdf.xacro`` with the model's arguments and their
    defaults.

    They are beside the model, in its package, in packages that depend on it, and in those called ``*_moveit_config`` that do not
    depend on another package with models.
    """
    return _load_all(_find_srdf_files(source), source, robot)


def load_srdfs_of_parts(source: Source, robot: str) -> tuple[Srdf, ...]:
    """Load the semantic descriptions of a robot of this name that are in other packages whose files the model includes, and in
    those that depend on them: for the same links."""
    own = None if source.package is None else source.package.path
    parts = {
        part.path: part
        for file in source.files.values()
        if (part := source.finder.find_package_of(file.path.absolute())) is not None and part.path != own
    }
    return _load_all(_find_srdfs_of_packages(list(parts.values()), source), source, robot)


def _load_all(paths: Iterable[Path], source: Source, robot: str) -> tuple[Srdf, ...]:
    if not robot:
        return ()
    srdfs: dict[Path, Srdf] = {}
    for path in paths:
        real = Path(os.path.realpath(path))
        if real not in srdfs:
            srdf = _load_with_arguments(path, source, robot)
            if srdf is not None:
                srdfs[real] = srdf
    return tuple(sorted(srdfs.values(), key=lambda srdf: srdf.name))


def _load_with_arguments(path: Path, source: Source, robot: str) -> Srdf | None:
    """Load a semantic description with the arguments that the model has, given or by default: launch files hand both one value.

    If that makes none of the robot, its own defaults count.
    """
    defaults = read_argument_defaults(source.trees) if source.is_xacro and is_xacro(path) else {}
    own = {name: value for name, value in defaults.items() if "$" not in value}
    for arguments in ({**own, **source.arguments}, source.arguments):
        srdf = load_srdf(path, arguments, source.finder, robot=robot, extra_environment=source.environment)
        if srdf is not None or not own:
            return srdf
    return None


def list_srdf_folders(srdfs: Iterable[Srdf]) -> list[Path]:
    """Return the folders of these semantic descriptions: those of their MoveIt configurations."""
    return list(dict.fromkeys(srdf.path.parent for srdf in srdfs))


def is_about_model(srdf: Srdf, source: Source) -> bool:
    """Whether a semantic description is beside the model, in its package, or in one that depends on it.

    Another package may describe another robot of this name.
    """
    package = source.finder.find_package_of(srdf.path.absolute())
    if package is None or source.package is None:
        return srdf.path.absolute().parent == source.path.absolute().parent
    return package.path == source.package.path or source.package.name in package.dependencies


def is_configured_for(srdf: Srdf, source: Source) -> bool:
    """Whether it is about the model itself, and not about one that its package derives from it or that it was set up for."""
    return (
        is_about_model(srdf, source) and not has_derived_model(srdf, source) and not is_set_up_for_another(srdf, source)
    )


def has_derived_model(srdf: Srdf, source: Source) -> bool:
    """Whether a semantic description in another package is beside a model of that package."""
    package = source.finder.find_package_of(srdf.path.absolute())
    is_elsewhere = package is not None and source.package is not None and package.path != source.package.path
    return is_elsewhere and any(
        is_model(Path(name)) and ".urdf" in name.lower() for name in _list_names(srdf.path.parent)
    )


def is_set_up_for_another(srdf: Srdf, source: Source) -> bool:
    """Whether a semantic description is for a file that is neither the model's nor included by it.

    The launch file ``planning_context.launch`` of MoveIt 1 loads both. The MoveIt Setup Assistant notes in ``.setup_assistant``
    in the package that it makes which file it was made for.
    """
    package = source.finder.find_package_of(srdf.path.absolute())
    if package is None or srdf.path.absolute().parent == source.path.absolute().parent:
        return False
    own = {source.path.absolute(), *(file.path.absolute() for file in source.files.values())}
    # A line that leads to no file says nothing about the robot.
    loaded = [_find_place(*named, source) for named in _read_planning_context(srdf, package, source)]
    found = {place for place in loaded if place is not None and source.finder.can_open(place) and place.is_file()}
    if found:
        return own.isdisjoint(found)
    made_for = _read_setup(srdf, package, source)
    if made_for is None:
        return False
    place = _find_place(*made_for, source)
    return place is None or place not in own


def find_original_model(srdf: Srdf, source: Source) -> Path | None:
    """Return the file that a semantic description was set up for where the model is another one beside the description.

    MoveIt's Setup Assistant writes such a copy for Gazebo (``config/gazebo_….urdf``), which nothing makes again.
    """
    package = source.finder.find_package_of(srdf.path.absolute())
    if package is None or srdf.path.absolute().parent != source.path.absolute().parent:
        return None
    made_for = _read_setup(srdf, package, source)
    place = None if made_for is None else _find_place(*made_for, source)
    own = {source.path.absolute(), *(file.path.absolute() for file in source.files.values())}
    is_other = place is not None and place not in own and source.finder.can_open(place) and place.is_file()
    return place if is_other else None


def _find_place(package: str, path: str, source: Source) -> Path | None:
    """Return a path in a package, which may be the model's own; None if the package is not found."""
    is_own = source.package is not None and source.package.name == package
    folder = source.package.path if is_own and source.package is not None else source.finder.find(package)
    return None if folder is None else (folder / path).absolute()


def read_setup_arguments(folder: Path, source: Source) -> tuple[Path, dict[str, str]] | None:
    """Return the file of MoveIt's settings in a package, and the arguments in it; None if it has none for the model.

    ``MoveItConfigsBuilder`` passes them to the copy of the model in its own package, ``config/….urdf.xacro``, and else to the
    model that they name.
    """
    urdf, _ = _read_settings(folder, source)
    words = [word.partition(":=") for word in _get_text(urdf, "xacro_args").split()]
    arguments = {name: value for name, assigned, value in words if assigned and name}
    if not arguments:
        return None
    own = {source.path.absolute(), *(file.path.absolute() for file in source.files.values())}
    is_copy = source.path.absolute().parent == folder.absolute() / "config"
    is_named = _find_place(_get_text(urdf, "package"), _get_text(urdf, "relative_path"), source) in own
    return (folder / SETUP_FILE, arguments) if is_copy or is_named else None


def _read_settings(folder: Path, source: Source) -> tuple[YamlValue | None, YamlValue | None]:
    """Return what MoveIt's settings in the folder of a package say about the model and its description."""
    try:
        settings = read_located_yaml(folder / SETUP_FILE, source.finder)
    except YamlReadError:
        return None, None
    inner = None if settings is None else settings.get("moveit_setup_assistant_config")
    # MoveIt 2 writes the keys in small letters.
    urdf, made = (None if inner is None else inner.get(k) or inner.get(k.lower()) for k in ("URDF", "SRDF"))
    return urdf, made


def _read_setup(srdf: Srdf, package: Package, source: Source) -> tuple[str, str] | None:
    """Return the package and the path in it of the file that Setup Assistant made this description for; None if unknown."""
    urdf, made = _read_settings(package.path, source)
    if _get_text(made, "relative_path") != srdf.path.absolute().relative_to(package.path).as_posix():
        return None
    name, path = _get_text(urdf, "package"), _get_text(urdf, "relative_path")
    return (name, path) if name and path else None


def _read_planning_context(srdf: Srdf, package: Package, source: Source) -> list[tuple[str, str]]:
    """Return the packages and the paths in them of the models that the launch file loads with this description: of several
    groups, that of the description decides."""
    place = package.path / _PLANNING_CONTEXT
    try:
        text = read_regular(place).decode("utf-8-sig", "replace") if source.finder.can_open(place) else ""
    except OSError:
        return []
    text = COMMENT.sub("", text)
    named = f"/{srdf.path.name}"
    if named not in text:
        return []
    groups = [group for group in _GROUP.findall(text) if named in group and _DESCRIPTION.search(group)]
    text = groups[0] if groups else text
    loaded = (tag for tag in _PARAMETER.findall(text) if _DESCRIPTION.search(tag))
    return [found for tag in loaded for found in _MODEL.findall(tag)]


def _get_text(mapping: YamlValue | None, key: str) -> str:
    value = None if mapping is None else mapping.get(key)
    return "" if value is None else value.text.strip()


def load_srdf(
    path: Path,
    arguments: Mapping[str, str],
    finder: PackageFinder,
    *,
    robot: str,
    extra_environment: frozenset[str] = frozenset(),
) -> Srdf | None:
    """Load the semantic description in a file; None if it is for another robot, or cannot be read or expanded.

    :raises ModelTimeout: if the model's time is used up.
    """
    name = format_path(path)
    if not finder.can_open(path):
        return None
    try:
        file = SourceFile.read(path, name)
        tree = parse_xml(file) if is_xacro(path) else parse_leniently(file)[0]
    except (OSError, XmlError):
        return None
    if tree.tag != "robot" or ("$" not in tree.get("name") and tree.get("name").strip() != robot):
        return None
    root: Element | None = tree
    files: Mapping[str, SourceFile] = {name: file}
    if is_xacro(path):
        from urdfcheck.source.xacro.expand import expand_xacro

        expansion = expand_xacro(path, arguments, finder, extra_environment=extra_environment)
        if any(problem.kind == "time-limit" for problem in expansion.problems):
            raise ModelTimeout  # the time limit is the model's, not the SRDF's: no time is left for anything
        root, files = expansion.root, expansion.files
        if root is not None and not root.children and has_only_macros(tree):
            return None
    if root is None or root.get("name").strip() != robot:
        return None
    return Srdf(path, name, root=root, files=files)


def find_broken_srdfs(package: Path) -> Iterator[tuple[Problem, SourceFile | None]]:
    """Yield the problems of a package's semantic descriptions that cannot be read, each with the file if it is text."""
    for path in _find_srdfs_below(package):
        name, file = format_path(path), None
        try:
            file = SourceFile.read(path, name)
            parse_xml(file)
        except (OSError, XmlError) as error:
            yield Problem.from_read_error(error, "robot", name), file


def _find_srdf_files(source: Source) -> Iterator[Path]:
    """Yield every file in reach that is named like a semantic description."""
    yield from _list_srdfs(source.path.absolute().parent)
    package = source.package
    if package is not None:
        yield from _find_srdfs_below(package.path)
    packages = source.finder.list_workspace_packages()
    for name, folder in sorted(packages.items()):
        if package is None or folder != package.path:
            files = [file for place in _list_srdf_places(folder) for file in _list_srdfs(place)]
            is_dependent = bool(files) and package is not None and has_dependency(folder, package.name)
            if is_dependent or (
                files and name.endswith("_moveit_config") and not _configures_another(folder, packages, package)
            ):
                source.finder.find(name)  # then it counts as found, and its files are in reach
                yield from files


def _find_srdfs_of_packages(parts: Sequence[Package], source: Source) -> Iterator[Path]:
    """Yield the semantic descriptions in some packages of the workspace, and in those that depend on one of them."""
    if not parts:
        return
    inside = {part.path for part in parts}
    for name, folder in sorted(source.finder.list_workspace_packages().items()):
        files = [file for place in _list_srdf_places(folder) for file in _list_srdfs(place)]
        if files and (folder in inside or any(has_dependency(folder, part.name) for part in parts)):
            source.finder.find(name)  # then it counts as found, and its files are in reach
            yield from files


def _list_srdf_places(folder: Path) -> list[Path]:
    """Return the folders of a package in which semantic descriptions are; a configuration of several robots has one for each."""
    named = [folder / inner for inner in SRDF_FOLDERS if inner]
    return [folder, *named, *(inner for place in named for inner in list_subfolders(place))]


def _configures_another(folder: Path, packages: Mapping[str, Path], package: Package | None) -> bool:
    """Whether the MoveIt configuration at a folder depends on another package of the workspace that has models."""
    config = load_package(folder)
    own = None if package is None else package.path
    names = () if config is None else sorted(packages.keys() & config.dependencies)
    return any(packages[name] not in {own, folder} and _has_models(packages[name]) for name in names)


def _has_models(folder: Path) -> bool:
    """Whether a package has models at its top or in one of its folders."""
    return any(is_model(Path(name)) for place in (folder, *list_subfolders(folder)) for name in _list_names(place))


def has_dependency(folder: Path, name: str) -> bool:
    """Whether the package at a folder depends on the one of this name."""
    package = load_package(folder)
    return package is not None and name in package.dependencies


def _find_srdfs_below(folder: Path) -> Iterator[Path]:
    """Yield the semantic descriptions in a folder and below it, near ones first."""
    level, left = [folder], MAX_FOLDERS
    for _ in range(LEVELS_DOWN):
        for here in level:
            yield from _list_srdfs(here)
        left -= len(level)
        level = [inner for here in level for inner in list_subfolders(here) if inner.name not in BUILD_FOLDERS][
            : max(left, 0)
        ]
    for here in level:
        yield from _list_srdfs(here)


def _list_srdfs(folder: Path) -> Iterator[Path]:
    """Yield the semantic descriptions directly in a folder."""
    try:
        names = _read_srdf_names(folder)
    except OSError:
        return
    yield from (path for name in names if (path := folder / name).is_file())


@remember_large_folders
def _read_srdf_names(folder: str) -> Sequence[str]:
    # A path for each name takes longer.
    return sorted(name for name in os.listdir(folder) if name.lower().endswith(SRDF_SUFFIXES))


def _list_names(folder: Path) -> list[str]:
    try:
        return sorted(os.listdir(folder))
    except OSError:
        return []
