"""Launch files: which model they load with which arguments, and what they start beside it.

XML launch files of ROS 1 and ROS 2 are read as located XML, with the XML launch files that they include. Python launch
files: see :mod:`urdfcheck.source.launch.python_launch_file`.
"""

from __future__ import annotations

import itertools
import os
import re
import shlex
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from urdfcheck.core import Location, Span
from urdfcheck.source.launch.python_launch_file import (
    LAUNCH_SUFFIXES,
    MAX_LENGTH,
    PythonLaunch,
    may_be_built,
    read_python_launch,
)
from urdfcheck.source.package.finder import Package, PackageFinder, format_path
from urdfcheck.source.reach import OUT_OF_REACH, FileReach
from urdfcheck.source.text.problems import Problem
from urdfcheck.source.text.values import parse_number
from urdfcheck.source.text.xml import Attribute, Element, SourceFile, XmlError, parse_xml
from urdfcheck.system.files import read_regular

# How many times launch files are included before it counts as a circle.
MAX_INCLUDES = 64
_SUBSTITUTION = re.compile(r"\$\(([^()]*)\)")
_NESTED = re.compile(r"\$\([^()]*(?:\([^()]*\)[^()]*)*\)")
_ARGUMENT = re.compile(r"^\s*\$\((?:arg|var)\s+([^\s()]+)\s*\)\s*$")
_COMMAND = re.compile(r"^\$\(command\s+(['\"])(.*?)\1\s*(?:['\"][a-z]+['\"]\s*)?\)$", re.DOTALL)


@dataclass(frozen=True, slots=True)
class UnresolvedReason:
    """Why a path of a launch file could not be resolved.

    ``kind``: package (``name`` is not found) | argument (``name`` has no value) | file (the path ``name`` does not exist) |
    circle (the arguments refer to each other) | launch-time (the substitution ``name`` is only known when it is launched).
    """

    kind: str
    name: str = ""


# The value of an argument, or what stands in its way.
_Value = tuple[str | None, UnresolvedReason | None]


@dataclass(frozen=True, slots=True, eq=False)
class DescriptionSource:
    """Where a launch file, or one that it includes, takes robot_description from.

    ``at`` is the attribute with the command or file, ``words`` the command's words as typed, ``file`` the model's path as
    typed and ``path`` what it resolves to (None: ``unresolved`` says why), ``arguments`` the xacro arguments that could be
    resolved.
    """

    at: Attribute
    words: tuple[str, ...]
    file: str
    path: Path | None
    arguments: Mapping[str, str]
    unresolved: UnresolvedReason | None

    @property
    def uses_xacro(self) -> bool:
        """Whether the command hands the file to xacro."""
        return bool(self.words) and "xacro" in self.words[0]

    @property
    def is_from_include(self) -> bool:
        """Whether an included launch file says so."""
        return bool(self.at.owner.via)


@dataclass(frozen=True, slots=True, eq=False)
class BrokenInclude:
    """An include that leads nowhere: ``at`` is its file attribute, ``obstacle`` (file | argument | circle) says why; of a
    circle, ``name`` is the file that is included once more."""

    at: Attribute
    unresolved: UnresolvedReason


@dataclass(frozen=True, slots=True, eq=False)
class StaticTransform:
    """A static_transform_publisher node: ``parent`` to ``child`` in metres and radians.

    Of ``rpy`` and ``quaternion`` (x y z w) one is set; all three are None where the numbers are not literal.
    """

    node: Element
    at: Attribute
    parent: str
    child: str
    xyz: tuple[float, ...] | None
    rpy: tuple[float, ...] | None
    quaternion: tuple[float, ...] | None


@dataclass(frozen=True, slots=True, eq=False)
class LaunchScope:
    """An XML launch file, with what resolves the substitutions in it as it is launched or included."""

    root: Element
    resolver: SubstitutionResolver


@dataclass(frozen=True, slots=True, eq=False)
class Launch:
    """One launch file. ``dialect``: ros1 | ros2 | python; ``root`` is None for Python and for broken XML.

    ``files`` holds it and those that it includes, ``broken`` the includes that lead nowhere. ``python`` is what could be read
    of one in Python. ``scope`` is this file as
    it is launched with the defaults of its arguments, and ``scopes`` the included ones by their elements.
    """

    path: Path
    name: str
    dialect: str
    root: Element | None
    files: Mapping[str, SourceFile]
    problems: tuple[Problem, ...]
    descriptions: tuple[DescriptionSource, ...]
    transforms: tuple[StaticTransform, ...]
    finder: PackageFinder
    package: Package | None
    python: PythonLaunch | None = None
    broken_includes: tuple[BrokenInclude, ...] = ()
    scope: LaunchScope | None = None
    scopes: Mapping[Element, LaunchScope] = field(default_factory=dict)

    @property
    def location(self) -> Location:
        if self.root is not None:
            return self.root.location
        return Location("launch", Span(self.name, 1, 1, 1, 1, 0, 0))

    @property
    def nodes(self) -> list[Element]:
        """Every ``<node>``, in groups as well."""
        return [] if self.root is None else [e for e in self.root.walk() if e.tag == "node"]

    @property
    def arguments(self) -> list[Element]:
        """Every ``<arg>`` that declares an argument of this file (not those handed to an include)."""
        return [] if self.root is None else list_declared_arguments(self.root)


def get_executable(node: Element) -> str:
    """The executable of a node: ``type`` in ROS 1, ``exec`` in ROS 2."""
    return node.get("type") or node.get("exec")


def list_declared_arguments(root: Element) -> list[Element]:
    """Every ``<arg>`` below ``root`` that declares an argument."""
    return [e for e in root.walk() if e.tag == "arg" and (e.parent is None or e.parent.tag != "include")]


def is_included_by_sibling(path: Path) -> bool:
    """Whether a launch file beside this one mentions it: then that one is where the arguments come from."""
    try:
        reach = FileReach.from_paths([path], [])
        beside = [p for p in path.absolute().parent.iterdir() if p.name != path.name and "launch" in p.name]
        return any(path.name in _read_text(p) for p in beside if reach.can_open(p))
    except OSError:
        return False


def _read_text(path: Path) -> str:
    """The text of a file, none where it cannot be read."""
    try:
        return read_regular(path).decode("utf-8", "replace")
    except OSError:
        return ""


def load_launch(path: Path, finder: PackageFinder) -> Launch:
    """Read a launch file. What is wrong with it becomes a problem of the result, never an exception."""
    name = format_path(path)
    files: dict[str, SourceFile] = {}
    package = finder.find_package_of(path.absolute())
    if path.suffix == ".py":
        python = read_python_launch(path, finder)
        if python.file is not None:
            files[name] = python.file
        problems = () if python.read_problem is None else (python.read_problem,)
        return Launch(path, name, "python", None, files, problems, (), (), finder, package, python)
    try:
        source = SourceFile.read(path, name)
        files[name] = source
        root = parse_xml(source)
    except OSError as error:
        start = Location("launch", Span(name, 1, 1, 1, 1, 0, 0))
        problem = Problem("unreadable", error.strerror or str(error), start)
        return Launch(path, name, "ros1", None, files, (problem,), (), (), finder, package)
    except XmlError as error:
        problem = Problem(error.reason, str(error), Location("launch", error.span), error.data)
        return Launch(path, name, "ros1", None, files, (problem,), (), (), finder, package)
    ros2 = (
        "$(find-pkg-share" in source.text
        or "$(var " in source.text
        or any("exec" in e.attributes for e in root.walk() if e.tag == "node")
    )
    resolver = SubstitutionResolver(root, path, finder, {})
    key: _Key = (os.path.realpath(path), frozenset())
    including = _IncludeState(finder, files, ros2, {key}, [], [], {}, {})
    descriptions = (*_find_descriptions(root, resolver), *_read_includes(root, resolver, including, (key,)))
    return Launch(
        path,
        name,
        "ros2" if ros2 else "ros1",
        root,
        files,
        tuple(including.problems),
        descriptions,
        tuple(_read_static_transforms(root, resolver)),
        finder,
        package,
        broken_includes=tuple(including.broken),
        scope=LaunchScope(root, resolver),
        scopes=including.scopes,
    )


# A launch file, with the arguments that it was handed.
_Key = tuple[str, frozenset[tuple[str, _Value]]]


@dataclass(frozen=True, slots=True)
class _IncludeState:
    """What all launch files that one includes share: the files that were ``seen``, the ``problems`` with those that were not
    opened, the includes that are ``broken``, whether a path that is not there is sure to be ``missing``, and what was read, by
    the element that includes it."""

    finder: PackageFinder
    files: dict[str, SourceFile]
    ros2: bool
    seen: set[_Key]
    problems: list[Problem]
    broken: list[BrokenInclude]
    missing: dict[Path, bool]
    scopes: dict[Element, LaunchScope]


def _read_includes(
    root: Element, resolver: SubstitutionResolver, including: _IncludeState, around: tuple[_Key, ...]
) -> Iterator[DescriptionSource]:
    """The descriptions of the XML launch files that are included here, and by those. ``around``: this file and those that it
    is included by."""
    for element in root.walk():
        if element.tag != "include" or not resolver.is_active(element):
            continue
        file = element.attributes.get("file")
        if file is None:
            continue
        text, obstacle = resolver.resolve_value(file.value)
        if text is None:
            if obstacle is not None and obstacle.kind == "argument" and resolver.has_known_conditions(element):
                including.broken.append(BrokenInclude(file, obstacle))
            continue
        if not including.finder.can_open(Path(text)):
            shown = format_path(Path(text))
            including.problems.append(
                Problem("out-of-reach", f"{shown}: {OUT_OF_REACH}", file.location, {"path": shown})
            )
            continue
        if not os.path.isfile(text):
            if resolver.has_known_conditions(element) and _is_missing(Path(text), including):
                including.broken.append(BrokenInclude(file, UnresolvedReason("file", format_path(Path(text)))))
            continue
        handed = _collect_passed_arguments(
            element, resolver, everything=including.ros2 or element.get("pass_all_args") in {"true", "1"}
        )
        key = (os.path.realpath(text), frozenset(handed.items()))
        if key in around and resolver.has_known_conditions(element):
            including.broken.append(BrokenInclude(file, UnresolvedReason("circle", format_path(Path(text)))))
        if key in including.seen or len(including.seen) > MAX_INCLUDES:
            continue
        including.seen.add(key)
        path = Path(text)
        try:
            source = SourceFile.read(path, format_path(path))
            inner = parse_xml(source)
        except (OSError, XmlError):  # a Python one, or broken: then checking it says so
            continue
        including.files[source.name] = source
        for part in inner.walk():
            part.via = element.via if element.span is None else (*element.via, element.span)
        inside = SubstitutionResolver(inner, path, including.finder, handed)
        including.scopes[element] = LaunchScope(inner, inside)
        yield from _find_descriptions(inner, inside)
        yield from _read_includes(inner, inside, including, (*around, key))


def _is_missing(path: Path, including: _IncludeState) -> bool:
    """Whether a launch file is sure not to be there: its package is known, and no build makes it or installs it there. A
    relative path starts wherever somebody launches it."""
    if path not in including.missing and len(including.missing) < MAX_INCLUDES:
        package = including.finder.find_package_of(path) if path.is_absolute() else None
        elsewhere = including.ros2 and package is not None and may_be_built(path, package.path, LAUNCH_SUFFIXES)
        including.missing[path] = package is not None and not elsewhere
    return including.missing.get(path, False)


def _collect_passed_arguments(
    include: Element, resolver: SubstitutionResolver, *, everything: bool
) -> dict[str, _Value]:
    """The arguments that an included file gets."""
    names = {*resolver.values, *resolver.known} if everything else set()
    handed = {name: resolver.resolve_value(f"$(arg {name})") for name in sorted(names)}
    for element in include.children:
        value = element.attributes.get("value") or element.attributes.get("default")
        if element.tag in {"arg", "let"} and value is not None and resolver.is_active(element):
            handed[element.get("name")] = resolver.resolve_value(value.value)
    return handed


class SubstitutionResolver:
    """Substitutions of launch files, as far as they can be known without running anything."""

    def __init__(self, root: Element, path: Path, finder: PackageFinder, handed: Mapping[str, _Value]) -> None:
        self.path = path
        self.finder = finder
        self.obstacle: UnresolvedReason | None = None
        self.values: dict[str, Attribute] = {}
        self.known: dict[str, _Value] = dict(handed)
        self.pending: list[str] = []
        for element in root.walk():
            if element.tag in {"arg", "let"} and (element.parent is None or element.parent.tag != "include"):
                value = element.attributes.get("value") or element.attributes.get("default")
                if value is not None and element.get("name") not in handed and self.is_active(element):
                    self.values.setdefault(element.get("name"), value)

    def is_active(self, element: Element | None) -> bool:
        """Whether no ``if`` and no ``unless`` on the element and around it says otherwise, as far as they can be known."""
        while element is not None:
            for name, excluded in (("if", {"false", "0"}), ("unless", {"true", "1"})):
                if (self.resolve_text(element.get(name)) or "").strip().lower() in excluded:
                    return False
            element = element.parent
        return True

    def has_known_conditions(self, element: Element | None) -> bool:
        """Whether every ``if`` and ``unless`` on the element and around it can be known."""
        while element is not None:
            if any(self.resolve_text(element.get(name)) is None for name in ("if", "unless")):
                return False
            element = element.parent
        return True

    def resolve_value(self, text: str) -> _Value:
        """The text with its substitutions resolved, or what stood in the way."""
        self.obstacle = None
        value = self.resolve_text(text)
        return value, None if value is not None else self.obstacle

    def find_definition(self, attribute: Attribute) -> Attribute:
        """Where the value is typed of an attribute that only reads an argument."""
        for _ in range(len(self.values)):
            match = _ARGUMENT.match(attribute.value)
            if match is None or match.group(1) not in self.values:
                break
            attribute = self.values[match.group(1)]
        return attribute

    def resolve_text(self, text: str) -> str | None:
        """The text with its substitutions resolved, or None; then ``obstacle`` says what stood in the way."""
        for _ in range(MAX_LENGTH):
            match = _SUBSTITUTION.search(text)
            if match is None or len(text) > MAX_LENGTH:
                break
            value = self._resolve_substitution(match.group(1).split())
            if value is None:
                return None
            text = text[: match.start()] + value + text[match.end() :]
        _, opened, rest = text.partition("$(")
        if opened:  # an expression with parentheses of its own, or a text that grows without end
            self.obstacle = UnresolvedReason("launch-time", rest[:80])
            return None
        return text

    def _resolve_substitution(self, words: list[str]) -> str | None:
        verb, rest = (words[0], words[1:]) if words else ("", [])
        if verb in {"find", "find-pkg-share"} and len(rest) == 1:
            folder = self.finder.find(rest[0])
            if folder is None:
                self.obstacle = UnresolvedReason("package", rest[0])
            return None if folder is None else str(folder)
        if verb in {"arg", "var"} and len(rest) == 1:
            return self._resolve_argument(rest[0])
        if verb == "dirname":
            return str(self.path.absolute().parent)
        self.obstacle = UnresolvedReason("launch-time", " ".join(words))
        return None

    def _resolve_argument(self, name: str) -> str | None:
        if name not in self.values and name not in self.known:
            self.obstacle = UnresolvedReason("argument", name)
            return None
        if name in self.pending:
            self.obstacle = UnresolvedReason("circle")
            return None
        if name not in self.known:  # once each: arguments made of each other several times over would never end
            self.pending.append(name)
            value = self.resolve_text(self.values[name].value)
            self.pending.pop()
            self.known[name] = (value, None if value is not None else self.obstacle)
        value, obstacle = self.known[name]
        self.obstacle = obstacle or self.obstacle
        return value


def _find_descriptions(root: Element, resolver: SubstitutionResolver) -> Iterator[DescriptionSource]:
    for element in root.walk():
        if is_description(element) and resolver.is_active(element):
            found = read_description(element, resolver)
            if found is not None:
                yield found


def is_description(element: Element) -> bool:
    """Whether an element sets robot_description."""
    return element.tag == "param" and element.get("name").split("/")[-1] == "robot_description"


def read_description(element: Element, resolver: SubstitutionResolver) -> DescriptionSource | None:
    """Where a parameter takes robot_description from, None where it names neither file nor command."""
    textfile, command = element.attributes.get("textfile"), element.attributes.get("command")
    value = element.attributes.get("value")
    if textfile is not None:
        return _make_description(textfile, (), textfile.value, {}, resolver)
    if command is not None:
        command = resolver.find_definition(command)
        return _parse_command(command, command.value, resolver) if command.value.strip() else None
    if value is None:
        return None
    value = resolver.find_definition(value)
    match = _COMMAND.match(value.value.strip())
    if match:
        return _parse_command(value, match.group(2), resolver)
    if not value.value.strip().startswith("$("):
        return None
    _, unresolved = resolver.resolve_value(value.value)
    return None if unresolved is None else DescriptionSource(value, (), value.value.strip(), None, {}, unresolved)


def _parse_command(at: Attribute, text: str, resolver: SubstitutionResolver) -> DescriptionSource:
    words = split_command(text)
    command = words
    for starter in (("rosrun", "xacro"), ("ros2", "run", "xacro")):
        if words[: len(starter)] == starter:
            command = words[len(starter) :]
    arguments: dict[str, str] = {}
    files = []
    for word in command[1:]:
        name, assigned, value = word.partition(":=")
        if assigned:
            resolved = resolver.resolve_text(value)
            if resolved is not None:
                arguments[name] = resolved
        elif not word.startswith("-"):
            files.append(word)
    if not files or not re.search(r"xacro|cat$", command[0]):  # another program makes the model
        return DescriptionSource(at, words, text, None, {}, UnresolvedReason("launch-time", text))
    return _make_description(at, words, files[0], arguments, resolver)


def split_command(text: str) -> tuple[str, ...]:
    """The words of a command line, each substitution in one."""
    # $(find pkg) contains a blank; keep each substitution together while the shell's quotes are read.
    kept = _NESTED.sub(lambda m: m.group(0).replace(" ", "\0"), text)
    try:
        words = shlex.split(kept)
    except ValueError:
        words = kept.split()
    return tuple(w.replace("\0", " ") for w in words)


def _make_description(
    at: Attribute, words: tuple[str, ...], file: str, arguments: Mapping[str, str], resolver: SubstitutionResolver
) -> DescriptionSource:
    resolved, unresolved = resolver.resolve_value(file)
    path = None if resolved is None else Path(resolved)
    # Whether there is a file out of reach is nobody's to know: reading it is refused later.
    allowed = path is not None and resolver.finder.can_open(path)
    if path is not None and (allowed or not path.is_absolute()) and not (allowed and os.path.isfile(path)):
        unresolved = UnresolvedReason("file", format_path(path))
        path = None
    return DescriptionSource(at, words, file, path, dict(arguments), unresolved)


def _read_static_transforms(root: Element, resolver: SubstitutionResolver) -> Iterator[StaticTransform]:
    for node in root.walk():
        if node.tag != "node" or get_executable(node) != "static_transform_publisher" or not resolver.is_active(node):
            continue
        args = node.attributes.get("args")
        if args is None:
            continue
        words = [resolver.resolve_text(word) or "" for word in split_command(args.value)]
        placed = parse_transform_arguments(words)
        if placed is None or not all(placed[:2]):
            continue  # frames that are only known when it is launched
        parent, child, numbers = placed
        xyz = numbers[:3] if numbers else None
        rpy = (numbers[5], numbers[4], numbers[3]) if len(numbers) == 6 else None
        quaternion_values = numbers[3:] if len(numbers) == 7 else None
        yield StaticTransform(node, args, parent.lstrip("/"), child.lstrip("/"), xyz, rpy, quaternion_values)


def parse_transform_arguments(words: Sequence[str]) -> tuple[str, str, tuple[float, ...]] | None:
    """Parent, child and six or seven numbers (none where one is not literal) of the arguments of a static_transform_publisher."""
    named = _parse_named_arguments(words)
    if named is not None or len(words) < 8:
        return named
    # x y z then yaw pitch roll, or a quaternion, then the frames and, for tf, a period.
    count = 7 if parse_number(words[6]) is not None and len(words) >= 9 else 6
    numbers = tuple(v for v in map(parse_number, words[:count]) if v is not None)
    return words[count], words[count + 1], numbers if len(numbers) == count else ()


def _parse_named_arguments(words: Sequence[str]) -> tuple[str, str, tuple[float, ...]] | None:
    options = {word: value for word, value in itertools.pairwise(words) if word.startswith("--")}
    if "--frame-id" not in options or "--child-frame-id" not in options:
        return None
    turn = {"qx": "0", "qy": "0", "qz": "0", "qw": "1"}
    if not any(f"--{name}" in options for name in turn):
        turn = {"yaw": "0", "pitch": "0", "roll": "0"}
    defaults = {"x": "0", "y": "0", "z": "0", **turn}
    values = [parse_number(options.get(f"--{name}", default)) for name, default in defaults.items()]
    known = tuple(v for v in values if v is not None)
    return options["--frame-id"], options["--child-frame-id"], known if len(known) == len(values) else ()
