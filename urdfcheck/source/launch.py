"""Launch files: which model they load with which arguments, and what they start beside it.

XML launch files of ROS 1 and ROS 2 are read as located XML. Of Python launch files only the literal paths of models are
read; nothing in them is executed.
"""

from __future__ import annotations

import ast
import re
import shlex
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from urdfcheck.core import Location, Span
from urdfcheck.source.packages import Package, PackageFinder, display_name
from urdfcheck.source.problems import Problem
from urdfcheck.source.values import number
from urdfcheck.source.xml import Attribute, Element, SourceFile, XmlError, parse

if TYPE_CHECKING:
    from urdfcheck.model.model import Model

MODEL_SUFFIXES = (".urdf", ".xacro")
_SUBSTITUTION = re.compile(r"\$\(([^()]*)\)")
_COMMAND = re.compile(r"^\$\(command\s+(['\"])(.*)\1\s*(?:'[a-z]+'\s*)?\)$", re.DOTALL)


@dataclass(frozen=True, slots=True)
class Obstacle:
    """Why a path of a launch file could not be resolved.

    ``kind``: package (``name`` is not found) | argument (``name`` has no value) | file (the path ``name`` does not exist) |
    circle (the arguments refer to each other) | launch-time (the substitution ``name`` is only known when it is launched).
    """

    kind: str
    name: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Description:
    """Where a launch file takes robot_description from.

    ``at`` is the attribute with the command or file, ``words`` the command's words as typed, ``file`` the model's path as
    typed and ``path`` what it resolves to (None: ``unresolved`` says why), ``arguments`` the xacro arguments that could be
    resolved.
    """

    at: Attribute
    words: tuple[str, ...]
    file: str
    path: Path | None
    arguments: Mapping[str, str]
    unresolved: Obstacle | None


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
class Launch:
    """One launch file. ``dialect``: ros1 | ros2 | python; ``root`` is None for Python and for broken XML.

    ``model`` is the model that its robot_description leads to, once it is loaded.
    """

    path: Path
    name: str
    dialect: str
    root: Element | None
    files: Mapping[str, SourceFile]
    problems: tuple[Problem, ...]
    descriptions: tuple[Description, ...]
    transforms: tuple[StaticTransform, ...]
    finder: PackageFinder
    package: Package | None
    model: Model | None = None

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
        if self.root is None:
            return []
        return [e for e in self.root.walk() if e.tag == "arg" and (e.parent is None or e.parent.tag != "include")]


def executable(node: Element) -> str:
    """The executable of a node: ``type`` in ROS 1, ``exec`` in ROS 2."""
    return node.get("type") or node.get("exec")


def load_launch(path: Path, finder: PackageFinder) -> Launch:
    """Read a launch file. What is wrong with it becomes a problem of the result, never an exception."""
    name = display_name(path)
    files: dict[str, SourceFile] = {}
    package = finder.package_of(path.absolute())
    if path.suffix == ".py":
        return Launch(path, name, "python", None, files, (), (), (), finder, package)
    try:
        source = SourceFile.read(path, name)
        files[name] = source
        root = parse(source)
    except OSError as error:
        start = Location("launch", Span(name, 1, 1, 1, 1, 0, 0))
        problem = Problem("unreadable", error.strerror or str(error), start)
        return Launch(path, name, "ros1", None, files, (problem,), (), (), finder, package)
    except XmlError as error:
        problem = Problem(error.reason, str(error), Location("launch", error.span))
        return Launch(path, name, "ros1", None, files, (problem,), (), (), finder, package)
    ros2 = (
        "$(find-pkg-share" in source.text
        or "$(var " in source.text
        or any("exec" in e.attributes for e in root.walk() if e.tag == "node")
    )
    resolver = _Resolver(root, path, finder)
    return Launch(
        path,
        name,
        "ros2" if ros2 else "ros1",
        root,
        files,
        (),
        tuple(_descriptions(root, resolver)),
        tuple(_transforms(root, resolver)),
        finder,
        package,
    )


def models_in_python(path: Path, finder: PackageFinder) -> list[Path]:
    """The model files that a Python launch file names by literal paths, found in its own package."""
    try:
        tree = ast.parse(path.read_text(encoding="utf-8", errors="replace"))
    except (OSError, SyntaxError, ValueError, RecursionError, MemoryError):
        return []
    package = finder.package_of(path.absolute())
    base = package.path if package is not None else path.parent
    found: list[Path] = []
    for node in ast.walk(tree):
        if not (isinstance(node, ast.Constant) and isinstance(node.value, str)):
            continue
        literal = node.value.strip()
        if not literal.endswith(MODEL_SUFFIXES) or len(literal) > 300 or any(c in literal for c in "*?[\0"):
            continue
        tail = literal.lstrip("/")
        candidates = [base / tail, base / "urdf" / tail, *sorted(base.glob(f"*/{Path(tail).name}"))]
        hit = next((c for c in candidates if c.is_file()), None)
        if hit is not None and hit not in found:
            found.append(hit)
    return found


class _Resolver:
    """Substitutions of launch files, as far as they can be known without running anything."""

    def __init__(self, root: Element, path: Path, finder: PackageFinder) -> None:
        self.path = path
        self.finder = finder
        self.obstacle: Obstacle | None = None
        self.values: dict[str, str] = {}
        for element in root.walk():
            if element.tag in {"arg", "let"} and (element.parent is None or element.parent.tag != "include"):
                value = element.attributes.get("value") or element.attributes.get("default")
                if value is not None:
                    self.values.setdefault(element.get("name"), value.value)

    def resolve(self, text: str, depth: int = 0) -> str | None:
        """The text with its substitutions resolved, or None; then ``obstacle`` says what stood in the way."""
        if depth > 20:
            self.obstacle = Obstacle("circle")
            return None
        while match := _SUBSTITUTION.search(text):
            value = self._one(match.group(1).split(), depth)
            if value is None:
                return None
            text = text[: match.start()] + value + text[match.end() :]
        return text

    def _one(self, words: list[str], depth: int) -> str | None:
        verb, rest = (words[0], words[1:]) if words else ("", [])
        if verb in {"find", "find-pkg-share"} and len(rest) == 1:
            folder = self.finder.find(rest[0])
            if folder is None:
                self.obstacle = Obstacle("package", rest[0])
            return None if folder is None else str(folder)
        if verb in {"arg", "var"} and len(rest) == 1:
            if rest[0] in self.values:
                return self.resolve(self.values[rest[0]], depth + 1)
            self.obstacle = Obstacle("argument", rest[0])
            return None
        if verb == "dirname":
            return str(self.path.absolute().parent)
        self.obstacle = Obstacle("launch-time", " ".join(words))
        return None


def _descriptions(root: Element, resolver: _Resolver) -> Iterator[Description]:
    for element in root.walk():
        if element.tag != "param" or element.get("name").split("/")[-1] != "robot_description":
            continue
        textfile, command = element.attributes.get("textfile"), element.attributes.get("command")
        value = element.attributes.get("value")
        if textfile is not None:
            yield _description(textfile, (), textfile.value, {}, resolver)
        elif command is not None:
            yield from _command(command, command.value, resolver)
        elif value is not None:
            match = _COMMAND.match(value.value.strip())
            if match:
                yield from _command(value, match.group(2), resolver)


def _command(at: Attribute, text: str, resolver: _Resolver) -> Iterator[Description]:
    words = _words(text)
    if not words or not re.search(r"xacro|cat$", words[0]):
        return
    arguments: dict[str, str] = {}
    files = []
    for word in words[1:]:
        name, assigned, value = word.partition(":=")
        if assigned:
            resolved = resolver.resolve(value)
            if resolved is not None:
                arguments[name] = resolved
        elif not word.startswith("-"):
            files.append(word)
    if files:
        yield _description(at, words, files[0], arguments, resolver)


def _words(text: str) -> tuple[str, ...]:
    # $(find pkg) contains a blank; keep each substitution together while the shell's quotes are read.
    kept = _SUBSTITUTION.sub(lambda m: m.group(0).replace(" ", "\0"), text)
    try:
        words = shlex.split(kept)
    except ValueError:
        words = kept.split()
    return tuple(w.replace("\0", " ") for w in words)


def _description(
    at: Attribute, words: tuple[str, ...], file: str, arguments: Mapping[str, str], resolver: _Resolver
) -> Description:
    resolver.obstacle = None
    resolved = resolver.resolve(file)
    path = None if resolved is None else Path(resolved)
    unresolved = resolver.obstacle if path is None else None
    if path is not None and not path.is_file():
        unresolved = Obstacle("file", display_name(path))
        path = None
    return Description(at, words, file, path, dict(arguments), unresolved)


def _transforms(root: Element, resolver: _Resolver) -> Iterator[StaticTransform]:
    for node in root.walk():
        if node.tag != "node" or executable(node) != "static_transform_publisher":
            continue
        args = node.attributes.get("args")
        if args is None:
            continue
        resolved = resolver.resolve(args.value)
        words = resolved.split() if resolved is not None else []
        named = _named_transform(words)
        if named is not None:
            parent, child, numbers = named
        elif len(words) >= 8:
            # x y z then yaw pitch roll, or a quaternion, then the frames and, for tf, a period.
            quaternion = number(words[6]) is not None and len(words) >= 9
            count = 7 if quaternion else 6
            parent, child = words[count], words[count + 1]
            numbers = tuple(v for v in map(number, words[:count]) if v is not None)
            numbers = numbers if len(numbers) == count else ()
        else:
            continue
        xyz = numbers[:3] if numbers else None
        rpy = (numbers[5], numbers[4], numbers[3]) if len(numbers) == 6 else None
        quaternion_values = numbers[3:] if len(numbers) == 7 else None
        yield StaticTransform(node, args, parent.lstrip("/"), child.lstrip("/"), xyz, rpy, quaternion_values)


def _named_transform(words: list[str]) -> tuple[str, str, tuple[float, ...]] | None:
    options = dict(zip(words[::2], words[1::2], strict=False))
    parent, child = options.get("--frame-id"), options.get("--child-frame-id")
    if parent is None or child is None:
        return None
    values = [number(options.get(f"--{k}", "0")) for k in ("x", "y", "z", "yaw", "pitch", "roll")]
    if any(v is None for v in values) or any(f"--q{k}" in options for k in "xyzw"):
        return parent, child, ()
    return parent, child, tuple(v for v in values if v is not None)
