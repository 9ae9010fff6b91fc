"""One model's source: the files that were read, the expanded tree, and what went wrong on the way."""

from __future__ import annotations

import errno
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from urdfcheck.core import Location, Span
from urdfcheck.source.package.finder import Package, PackageFinder, format_path
from urdfcheck.source.reach import OUT_OF_REACH
from urdfcheck.source.text.problems import Problem
from urdfcheck.source.text.xml import Element, SourceFile, XmlError, find_unbound_prefix, parse_xml

_USES_XACRO = re.compile(r"<xacro:|\$\{|\$\((?:find|arg|eval|env|optenv|dirname)\b")


@dataclass(frozen=True, slots=True, eq=False)
class Source:
    """What was read for one model.

    ``root`` is the expanded ``<robot>`` (or whatever the root element is), None when nothing could be expanded.
    ``files`` and ``trees`` hold each file reached, by display name, as typed; ``main`` is the first of them.
    ``explicit`` says that the user named this file on the command line; ``environment`` names the variables that xacro may
    read beside those of ROS.
    """

    path: Path
    name: str
    is_xacro: bool
    arguments: Mapping[str, str]
    root: Element | None
    files: Mapping[str, SourceFile]
    trees: Mapping[str, Element]
    problems: tuple[Problem, ...]
    finder: PackageFinder
    package: Package | None
    explicit: bool = True
    arguments_read: frozenset[str] = field(default_factory=frozenset)
    environment: frozenset[str] = frozenset()

    @property
    def main_tree(self) -> Element | None:
        """The tree of the model's own file as typed, None when it could not be parsed."""
        return self.trees.get(self.name)

    @property
    def file_location(self) -> Location:
        """The model's file as a whole: its first character."""
        root = self.main_tree
        span = root.span if root is not None else Span(self.name, 1, 1, 1, 1, 0, 0)
        return Location(root.subject if root is not None else "robot", span)

    def find_problems(self, *kinds: str) -> list[Problem]:
        """The recorded problems of these kinds."""
        return [p for p in self.problems if p.kind in kinds]


def load_source(
    path: Path,
    arguments: Mapping[str, str],
    finder: PackageFinder,
    *,
    explicit: bool = True,
    xacro: bool = False,
    environment: frozenset[str] = frozenset(),
) -> Source:
    """Read a model. What is wrong with the file becomes a problem of the result, never an exception.

    ``xacro`` says that the file is handed to xacro although its name does not end in ``.xacro``; ``environment`` names the
    variables that it may read beside those of ROS.
    """
    name = format_path(path)
    package = finder.find_package_of(path.absolute())
    files: dict[str, SourceFile] = {}
    trees: dict[str, Element] = {}
    problems: list[Problem] = []
    root: Element | None = None
    is_xacro = path.suffix == ".xacro"
    try:
        if not finder.can_open(path):
            raise OSError(errno.EACCES, OUT_OF_REACH, str(path))
        source = SourceFile.read(path, name)
        files[name] = source
        root = trees[name] = parse_xml(source)
    except OSError as error:
        start = Span(name, 1, 1, 1, 1, 0, 0)
        problems.append(Problem("unreadable", error.strerror or str(error), Location("robot", start)))
    except XmlError as error:
        problems.append(Problem(error.reason, str(error), Location("robot", error.span), error.data))
    else:
        is_xacro = is_xacro or ((xacro or path.suffix == "") and bool(_USES_XACRO.search(source.text)))
        if source.encoding.startswith("utf-16") and not (is_xacro or xacro):
            problems.append(Problem("utf-16", "the text is UTF-16", root.location))
        if source.instruction is not None and not (is_xacro or xacro):
            at = Location(root.subject, source.instruction)
            problems.append(Problem("instruction", "a processing instruction (<?…?>) does not stand first", at))
        prefixed = find_unbound_prefix(root)
        if prefixed is not None and not is_xacro:
            element, prefix = prefixed
            problems.append(
                Problem("prefix", f"the prefix {prefix!r} is not declared (xmlns:{prefix}=…)", element.location)
            )
    arguments_read: frozenset[str] = frozenset()
    if root is not None and is_xacro:
        from urdfcheck.source.xacro.expand import expand_xacro

        expansion = expand_xacro(path, arguments, finder, environment)
        root, problems = expansion.root, [*problems, *expansion.problems]
        files.update(expansion.files)
        trees.update(expansion.trees)
        arguments_read = expansion.arguments_read
    return Source(
        path,
        name,
        is_xacro,
        dict(arguments),
        root,
        files,
        trees,
        tuple(problems),
        finder,
        package,
        explicit,
        arguments_read,
        environment,
    )
