"""Launch files: the models that they load, with which arguments, and the static transforms beside them.

XML launch files of ROS 1 and ROS 2 are read as located XML, with the XML launch files that they include; for Python
launch files, see :mod:`urdfcheck.source.launch.python_launch_file`.
"""

from __future__ import annotations

import ast
import os
import re
from collections.abc import Iterator, Mapping
from dataclasses import field, replace
from pathlib import Path

from urdfcheck.core import Location
from urdfcheck.core.records import dataclass
from urdfcheck.source.launch.built_files import find_template, is_git_ignored, may_be_built
from urdfcheck.source.launch.python_launch_file import MAX_PYTHON, PythonLaunch, read_python_launch
from urdfcheck.source.launch.static_transforms import StaticTransform, read_static_transforms
from urdfcheck.source.launch.substitutions import SubstitutionResolver, UnresolvedReason, Value, split_command
from urdfcheck.source.package.build_files import is_only_of_ros2
from urdfcheck.source.package.file_kinds import LAUNCH_SUFFIXES
from urdfcheck.source.package.finder import Package, PackageFinder, format_path, is_kept_aside, is_unnamed_copy
from urdfcheck.source.reach import OUT_OF_REACH, FileReach
from urdfcheck.source.text.problems import Problem, locate_start
from urdfcheck.source.text.python import parse_python
from urdfcheck.source.text.xml import Attribute, Element, SourceFile, XmlError, parse_xml
from urdfcheck.system.files import read_text_or_nothing

_DOCUMENT_FOLDERS = frozenset({"doc", "docs", "documentation"})
# Limit on the launch files that one includes.
MAX_INCLUDES = 64
_COMMAND = re.compile(r"^\$\(command\s+(['\"])(.*?)\1\s*(?:['\"][a-z]+['\"]\s*)?\)$", re.DOTALL)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class DescriptionSource:
    """Where a launch file, or one that it includes, takes robot_description from."""

    at: Attribute
    """The attribute with the command or file."""
    words: tuple[str, ...]
    """The command's words as typed."""
    file: str
    """The model's path as typed."""
    path: Path | None
    """The model's path; None if it is ``unresolved``."""
    arguments: Mapping[str, str]
    """The xacro arguments that could be resolved."""
    unresolved: UnresolvedReason | None
    unknown_arguments: frozenset[str] = frozenset()
    """The names of those that could not."""

    @property
    def uses_xacro(self) -> bool:
        """Whether a command (xacro itself, ``rosrun xacro xacro``) hands the file to xacro; ``cat`` does not."""
        return any("xacro" in word for word in self.words[:3])

    @property
    def is_from_include(self) -> bool:
        """Whether it is in an included launch file."""
        return bool(self.at.owner.via)


@dataclass(frozen=True, slots=True, eq=False)
class BrokenInclude:
    """An include that leads nowhere."""

    at: Attribute
    """The include's file attribute."""
    unresolved: UnresolvedReason
    """``kind`` is file | argument | circle; of a circle, ``name`` is the file that is included again."""
    handed: str = ""
    """The argument of the included file that an unknown one of this file is passed on as; empty where the path names it."""
    file: Path | None = None
    """The included file, if it was found."""

    @property
    def passed_names(self) -> list[str]:
        """The arguments that the include passes, whatever the conditions are."""
        return [element.get("name") for element in self.at.owner.children if element.tag in {"arg", "let"}]


@dataclass(frozen=True, slots=True, eq=False)
class LaunchScope:
    """An XML launch file, and the resolver of its substitutions as it is launched or included."""

    root: Element
    resolver: SubstitutionResolver


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Launch:
    """One launch file. ``root`` is None for a Python file and for malformed XML."""

    path: Path
    name: str
    dialect: str
    """ros1 | ros2 | python."""
    root: Element | None
    files: Mapping[str, SourceFile]
    """This file and those that it includes, by their names in findings."""
    problems: tuple[Problem, ...]
    descriptions: tuple[DescriptionSource, ...]
    transforms: tuple[StaticTransform, ...]
    finder: PackageFinder
    package: Package | None
    python: PythonLaunch | None = None
    """What could be read of a Python launch file."""
    broken_includes: tuple[BrokenInclude, ...] = ()
    scope: LaunchScope | None = None
    """This file as it is launched with the defaults of its arguments."""
    scopes: Mapping[Element, LaunchScope] = field(default_factory=dict)
    """The included files, by the elements that include them."""

    @property
    def location(self) -> Location:
        if self.root is not None:
            return self.root.location
        return locate_start("launch", self.name)

    @property
    def is_left_from_ros1(self) -> bool:
        """Whether it is of ROS 1 in a package of ROS 2: with ``$(find …)`` or a node's ``type``, its own or of a file that it
        includes, nothing starts it."""
        if self.root is None or self.dialect != "ros1" or self.package is None:
            return False
        return is_only_of_ros2(self.package.root) and any(_ROS1_TEXT.search(file.text) for file in self.files.values())

    @property
    def is_in_documents(self) -> bool:
        """Whether it is in a folder of documents of its project: a copy to read, which nothing starts."""
        folders = Path(format_path(self.path)).parts[:-1]
        return not _DOCUMENT_FOLDERS.isdisjoint(folder.lower() for folder in folders)

    @property
    def is_left_over(self) -> bool:
        """Whether nothing starts it: it was left from ROS 1, or is kept and not used."""
        return self.is_left_from_ros1 or self.is_kept_aside

    @property
    def is_kept_aside(self) -> bool:
        """Whether it is in a folder of files that are kept and not used, or is an old copy that no text of the package names."""
        if self.package is None:
            return False
        return is_kept_aside(self.path, self.package) or is_unnamed_copy(self.path, self.package, self.finder.can_open)

    @property
    def nodes(self) -> list[Element]:
        """Every ``<node>``, including those in groups."""
        return [] if self.root is None else [e for e in self.root.walk() if e.tag == "node"]

    @property
    def arguments(self) -> list[Element]:
        """Every ``<arg>`` that declares an argument of this file, without those that are passed to an include."""
        return [] if self.root is None else list_declared_arguments(self.root)


# The folders of the system in which programs and the setup of a robot's computer write files.
_WRITTEN_FOLDERS = frozenset({"dev", "etc", "run", "tmp", "var"})
# What only launch files of ROS 1 have.
_ROS1_TEXT = re.compile(r"\$\(find\s|<node\b[^<>]*\stype\s*=")


def list_declared_arguments(root: Element) -> list[Element]:
    """Return every ``<arg>`` below ``root`` that declares an argument."""
    return [e for e in root.walk() if e.tag == "arg" and (e.parent is None or e.parent.tag != "include")]


def is_included_by_sibling(path: Path) -> bool:
    """Whether a launch file beside this one mentions it: then the arguments come from that one."""
    try:
        reach = FileReach.from_paths([path], [])
        beside = [p for p in path.absolute().parent.iterdir() if p.name != path.name and "launch" in p.name]
        return any(path.name in read_text_or_nothing(p) for p in beside if reach.can_open(p))
    except OSError:
        return False


def _is_script(text: str) -> bool:
    """Whether what is not XML is a program: a line says what runs it, or it is Python."""
    if text.startswith("#!"):
        return True
    if text.lstrip()[:1] == "<" or len(text) > MAX_PYTHON:
        return False
    tree = parse_python(text)
    return tree is not None and any(isinstance(s, (ast.Import, ast.ImportFrom, ast.FunctionDef)) for s in tree.body)


def load_launch(path: Path, finder: PackageFinder) -> Launch:
    """Read a launch file. A defect of the file becomes a problem of the result, never an exception."""
    if path.suffix == ".py":
        return _load_python_launch(path, finder)
    name = format_path(path)
    package = finder.find_package_of(path.absolute())
    files: dict[str, SourceFile] = {}
    try:
        source = SourceFile.read(path, name)
        files[name] = source
        root = parse_xml(source)
    except (OSError, XmlError) as error:
        problem = Problem.from_read_error(error, "launch", name)
        if name in files and _is_script(files[name].text):
            problem = replace(problem, kind="script")
        return Launch(
            path=path,
            name=name,
            dialect="ros1",
            root=None,
            files=files,
            problems=(problem,),
            descriptions=(),
            transforms=(),
            finder=finder,
            package=package,
        )
    is_ros2 = (
        "$(find-pkg-share" in source.text
        or "$(var " in source.text
        or any("exec" in e.attributes for e in root.walk() if e.tag == "node")
    )
    resolver = SubstitutionResolver(root, path, finder, passed={})
    key: _Key = (os.path.realpath(path), frozenset())
    includes = _IncludeReader(files, finder, key, is_ros2=is_ros2)
    descriptions = (*_find_descriptions(root, resolver), *includes.read(root, resolver, (key,)))
    return Launch(
        path=path,
        name=name,
        dialect="ros2" if is_ros2 else "ros1",
        root=root,
        files=files,
        problems=tuple(includes.problems),
        descriptions=descriptions,
        transforms=tuple(read_static_transforms(root, resolver)),
        finder=finder,
        package=package,
        broken_includes=tuple(includes.broken),
        scope=LaunchScope(root, resolver),
        scopes=includes.scopes,
    )


def _load_python_launch(path: Path, finder: PackageFinder) -> Launch:
    name = format_path(path)
    package = finder.find_package_of(path.absolute())
    python = read_python_launch(path, finder)
    return Launch(
        path=path,
        name=name,
        dialect="python",
        root=None,
        files={} if python.file is None else {name: python.file},
        problems=() if python.read_problem is None else (python.read_problem,),
        descriptions=(),
        transforms=(),
        finder=finder,
        package=package,
        python=python,
    )


# A launch file, with the arguments that are passed to it.
_Key = tuple[str, frozenset[tuple[str, Value]]]


class _IncludeReader:
    """Reads the launch files that one includes, directly or through others."""

    def __init__(self, files: dict[str, SourceFile], finder: PackageFinder, key: _Key, *, is_ros2: bool) -> None:
        self.files = files
        self.finder = finder
        self.is_ros2 = is_ros2
        self.problems: list[Problem] = []
        self.broken: list[BrokenInclude] = []
        self.scopes: dict[Element, LaunchScope] = {}
        self._visited: set[_Key] = {key}
        self._missing: dict[Path, bool] = {}

    def read(
        self, root: Element, resolver: SubstitutionResolver, around: tuple[_Key, ...]
    ) -> Iterator[DescriptionSource]:
        """Yield the descriptions of the XML launch files that are included here, and by those.

        ``around``: this file and those that include it.
        """
        for element in root.walk():
            if element.tag != "include" or not resolver.is_active(element):
                continue
            path = self._resolve_file(element, resolver)
            if path is None:
                continue
            passed = self._collect_passed_arguments(element, resolver, path)
            key = (os.path.realpath(path), frozenset(passed.items()))
            if key in around and resolver.has_known_conditions(element):
                self._add_broken(element, UnresolvedReason("circle", format_path(path)))
            if key in self._visited or len(self._visited) > MAX_INCLUDES:
                continue
            self._visited.add(key)
            inner = self._parse(path, element)
            if inner is not None:
                inside = SubstitutionResolver(inner, path, self.finder, passed=passed)
                self.scopes[element] = LaunchScope(inner, inside)
                yield from _find_descriptions(inner, inside)
                yield from self.read(inner, inside, (*around, key))

    def _resolve_file(self, include: Element, resolver: SubstitutionResolver) -> Path | None:
        """Return the file of an include; None if it leads nowhere, which is noted with the reason."""
        file = include.attributes.get("file")
        if file is None:
            return None
        text, unresolved = resolver.resolve_value(file.value)
        if text is None:
            if unresolved is not None and unresolved.kind == "argument" and resolver.has_known_conditions(include):
                self._add_broken(include, unresolved)
            return None
        path = Path(text)
        if not self.finder.can_open(path):
            shown = format_path(path)
            message = f"{shown}: {OUT_OF_REACH}"
            data = {"path": shown}
            self.problems.append(Problem(kind="out-of-reach", message=message, location=file.location, data=data))
            return None
        path = self.finder.find_source(path)
        if not os.path.isfile(path):
            if resolver.has_known_conditions(include) and self._is_missing(path) and not _may_be_written(include):
                self._add_broken(include, UnresolvedReason("file", format_path(path)))
            return None
        return path

    def _add_broken(
        self, include: Element, unresolved: UnresolvedReason, *, handed: str = "", file: Path | None = None
    ) -> None:
        self.broken.append(BrokenInclude(include.attributes["file"], unresolved, handed, file))

    def _parse(self, path: Path, include: Element) -> Element | None:
        try:
            source = SourceFile.read(path, format_path(path))
            root = parse_xml(source)
        except (OSError, XmlError):  # a Python file, or malformed: reported when it is checked itself
            return None
        self.files[source.name] = source
        for element in root.walk():
            element.via = include.via if include.span is None else (*include.via, include.span)
        return root

    def _is_missing(self, path: Path) -> bool:
        """Whether a launch file certainly does not exist: its package is known, and its build does not make or install it.

        A relative path depends on the folder in which the launch file is started.
        """
        if path not in self._missing and len(self._missing) < MAX_INCLUDES:
            package = self.finder.find_package_of(path) if path.is_absolute() else None
            self._missing[path] = package is not None and not self._may_be_built(path, package)
        return self._missing.get(path, False)

    def _may_be_built(self, path: Path, package: Package) -> bool:
        """Whether the build puts a file there. roslaunch finds what is in the sources, and what is made of a template there."""
        if self.is_ros2:
            return may_be_built(path, package.path, LAUNCH_SUFFIXES)
        reach = FileReach.from_paths([package.path], [])
        return is_git_ignored(path, reach) or find_template(path, package.path) is not None

    def _collect_passed_arguments(
        self, include: Element, resolver: SubstitutionResolver, file: Path
    ) -> dict[str, Value]:
        """Return the arguments that an included file gets."""
        passes_all = self.is_ros2 or include.get("pass_all_args") in {"true", "1"}
        names = {*resolver.values, *resolver.known} if passes_all else set()
        passed = {name: _detach_value(resolver.resolve_value(f"$(arg {name})")) for name in sorted(names)}
        for element in include.children:
            value = element.attributes.get("value") or element.attributes.get("default")
            if element.tag in {"arg", "let"} and value is not None and resolver.is_active(element):
                text, unresolved = resolver.resolve_value(value.value)
                passed[element.get("name")] = _detach_value((text, unresolved))
                # A launch file of ROS 2 also reads what those that include it have set.
                if (
                    unresolved is not None
                    and unresolved.kind == "argument"
                    and not self.is_ros2
                    and resolver.has_known_conditions(element)
                ):
                    self._add_broken(include, unresolved, handed=element.get("name"), file=file)
        return passed


def _detach_value(value: Value) -> Value:
    """Return a value for an included file, where the name of an unresolved argument has no meaning."""
    text, unresolved = value
    if unresolved is None or unresolved.kind != "argument":
        return value
    return text, UnresolvedReason("launch-time", f"arg {unresolved.name}")


def _may_be_written(include: Element) -> bool:
    """Whether a program that this launch file starts, perhaps with other arguments, may write the file of an include.

    It is then given a launch file with which the name of the missing one begins.
    """
    root, missing = include, include.get("file")
    while root.parent is not None:
        root = root.parent
    nodes = (element for element in root.walk() if element.tag == "node")
    named = (word.rpartition(".launch")[0] for node in nodes for word in split_command(node.get("args")))
    return any(name and missing.startswith(name) for name in named)


def _find_descriptions(root: Element, resolver: SubstitutionResolver) -> Iterator[DescriptionSource]:
    for element in root.walk():
        if is_description(element) and resolver.is_active(element):
            description = read_description(element, resolver)
            if description is not None:
                yield description


def is_description(element: Element) -> bool:
    """Whether an element sets robot_description."""
    return element.tag == "param" and element.get("name").split("/")[-1] == "robot_description"


def read_description(element: Element, resolver: SubstitutionResolver) -> DescriptionSource | None:
    """Return where a parameter takes robot_description from; None if it names neither file nor command."""
    textfile, command = element.attributes.get("textfile"), element.attributes.get("command")
    value = element.attributes.get("value")
    if textfile is not None:
        return _make_description(textfile, textfile.value, resolver)
    if command is not None:
        command = resolver.find_definition(command)
        return _parse_command(command, command.value, resolver) if command.value.strip() else None
    if value is None:
        return None
    value = resolver.find_definition(value)
    match = _COMMAND.match(value.value.strip())
    if match:
        # In the quotes of a substitution, its own kind of quote is escaped.
        return _parse_command(value, match.group(2).replace("\\'", "'").replace('\\"', '"'), resolver)
    if not value.value.strip().startswith("$("):
        return None
    _, unresolved = resolver.resolve_value(value.value)
    return (
        None
        if unresolved is None
        else DescriptionSource(
            at=value, words=(), file=value.value.strip(), path=None, arguments={}, unresolved=unresolved
        )
    )


def _parse_command(at: Attribute, text: str, resolver: SubstitutionResolver) -> DescriptionSource:
    words = split_command(resolver.inline_words(text))
    command = words
    for runner in (("rosrun", "xacro"), ("ros2", "run", "xacro")):
        if words[: len(runner)] == runner:
            command = words[len(runner) :]
    arguments: dict[str, str] = {}
    unknown: set[str] = set()
    files = []
    for word in command[1:]:
        name, assigned, value = word.partition(":=")
        if assigned:
            resolved = resolver.resolve_text(value)
            if resolved is not None:
                arguments[name] = resolved
            else:
                unknown.add(name)
        elif not word.startswith("-"):
            files.append(word)
    if not files or not re.search(r"xacro|cat$", command[0]):  # another program generates the model
        return DescriptionSource(
            at=at, words=words, file=text, path=None, arguments={}, unresolved=UnresolvedReason("launch-time", text)
        )
    made = _make_description(at, files[0], resolver, words=words, arguments=arguments)
    return replace(made, unknown_arguments=frozenset(unknown - arguments.keys()))


def _make_description(
    at: Attribute,
    file: str,
    resolver: SubstitutionResolver,
    *,
    words: tuple[str, ...] = (),
    arguments: Mapping[str, str] | None = None,
) -> DescriptionSource:
    resolved, unresolved = resolver.resolve_value(file)
    path = None if resolved is None else resolver.finder.find_source(Path(resolved))
    # The existence of a file out of reach is not probed: reading it is refused later.
    allowed = path is not None and resolver.finder.can_open(path)
    if path is not None and not (allowed and os.path.isfile(path)):
        empty = resolver.find_empty_argument(file) if _has_no_name(resolved or "") else None
        if empty is not None:
            unresolved = UnresolvedReason("empty", empty)
        elif not path.is_absolute() and _is_beside(path, resolver):
            unresolved = UnresolvedReason("relative", path.as_posix())
        elif allowed or not path.is_absolute():
            unresolved = UnresolvedReason("file", format_path(path))
        elif path.parts[1:2] and path.parts[1] in _WRITTEN_FOLDERS:
            unresolved = UnresolvedReason("written", path.as_posix())
        path = path if unresolved is None else None
    return DescriptionSource(
        at=at, words=words, file=file, path=path, arguments=dict(arguments or {}), unresolved=unresolved
    )


def _is_beside(path: Path, resolver: SubstitutionResolver) -> bool:
    """Whether a relative path leads to a file from the folder of the launch file."""
    place = resolver.path.absolute().parent / path
    return resolver.finder.can_open(place) and place.is_file()


def _has_no_name(path: str) -> bool:
    """Whether a path ends where the name of a file begins, or has only the suffixes of one."""
    return os.path.basename(path.strip())[:1] in {"", "."}
