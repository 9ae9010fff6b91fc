"""One model's source: the files that were read, the expanded tree, and the problems on the way."""

from __future__ import annotations

import errno
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from urdfcheck.core import Location, Span
from urdfcheck.source.package.finder import Package, PackageFinder, format_path
from urdfcheck.source.reach import OUT_OF_REACH
from urdfcheck.source.text.problems import Problem, locate_start
from urdfcheck.source.text.xml import Element, SourceFile, XmlError, find_unbound_prefix, parse_xml

_USES_XACRO = re.compile(r"<xacro:|\$\{|\$\((?:find|arg|eval|env|optenv|dirname)\b")


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Source:
    """What was read for one model."""

    path: Path
    name: str
    """The name of the file in findings."""
    is_xacro: bool
    arguments: Mapping[str, str]
    """The arguments that the model was expanded with: those that were given, and those that were found."""
    root: Element | None
    """The expanded root element (``<robot>`` in a robot model); None if nothing could be expanded."""
    files: Mapping[str, SourceFile]
    """Each file reached, by its name in findings; the model's own file is the first."""
    trees: Mapping[str, Element]
    """The trees of these files as typed."""
    problems: tuple[Problem, ...]
    finder: PackageFinder
    package: Package | None
    """The package that the file belongs to."""
    explicit: bool = True
    """Whether the user named this file on the command line."""
    arguments_read: frozenset[str] = field(default_factory=frozenset)
    environment: frozenset[str] = frozenset()
    """Environment variables that xacro may read besides those of ROS."""
    found_arguments: Mapping[str, Location] = field(default_factory=dict)
    """The arguments that were not given, with the places in launch files that they were found at."""

    @property
    def main_tree(self) -> Element | None:
        """The tree of the model's own file as typed; None if it could not be parsed."""
        return self.trees.get(self.name)

    @property
    def file_location(self) -> Location:
        """The model's file as a whole: its root tag, or else its first character."""
        root = self.main_tree
        if root is None or root.span is None:
            return locate_start("robot" if root is None else root.subject, self.name)
        return Location(root.subject, root.span)

    def find_problems(self, *kinds: str) -> list[Problem]:
        """Return the recorded problems of these kinds."""
        return [p for p in self.problems if p.kind in kinds]


def load_source(
    path: Path,
    arguments: Mapping[str, str],
    finder: PackageFinder,
    *,
    explicit: bool = True,
    xacro: bool = False,
    environment: frozenset[str] = frozenset(),
    launches: Sequence[Path] = (),
) -> Source:
    """Read a model. A defect of the file becomes a problem of the result, never an exception.

    ``xacro``: the file is handed to xacro although its name does not end in ``.xacro``; ``environment``: variables that the
    file may read besides those of ROS; ``launches``: launch files that start the model, whose values of arguments count first.
    """
    name = format_path(path)
    package = finder.find_package_of(path.absolute())  # before the expansion brings more folders into reach
    files: dict[str, SourceFile] = {}
    trees: dict[str, Element] = {}
    problems: list[Problem] = []
    root: Element | None = None
    is_xacro = path.suffix == ".xacro"
    try:
        if not finder.can_open(path):
            raise OSError(errno.EACCES, OUT_OF_REACH, str(path))
        file = SourceFile.read(path, name)
        files[name] = file
        root = trees[name] = parse_xml(file)
    except (OSError, XmlError) as error:
        problems.append(Problem.from_read_error(error, "robot", name))
    else:
        is_xacro = is_xacro or ((xacro or path.suffix == "") and bool(_USES_XACRO.search(file.text)))
        problems += _find_plain_text_problems(file, root, is_xacro=is_xacro, for_xacro=is_xacro or xacro)
    arguments_read: frozenset[str] = frozenset()
    found_arguments: dict[str, Location] = {}
    if root is not None and is_xacro:
        from urdfcheck.source.found_arguments import expand_with_found_arguments

        complete = expand_with_found_arguments(path, arguments, finder, environment=environment, launches=launches)
        expansion, arguments = complete.expansion, complete.arguments
        found_arguments = {name: argument.location for name, argument in complete.found.items()}
        root, problems = expansion.root, [*problems, *expansion.problems]
        files.update(expansion.files)
        trees.update(expansion.trees)
        arguments_read = expansion.arguments_read
    return Source(
        path=path,
        name=name,
        is_xacro=is_xacro,
        arguments=dict(arguments),
        root=root,
        files=files,
        trees=trees,
        problems=tuple(problems),
        finder=finder,
        package=package,
        explicit=explicit,
        arguments_read=arguments_read,
        environment=environment,
        found_arguments=found_arguments,
    )


def _find_plain_text_problems(file: SourceFile, root: Element, *, is_xacro: bool, for_xacro: bool) -> list[Problem]:
    """Return what parsers of plain URDF reject in well-formed XML; xacro writes it anew."""
    problems: list[Problem] = []
    if file.encoding.startswith("utf-16") and not for_xacro:
        problems.append(Problem(kind="utf-16", message="the text is UTF-16", location=root.location))
    if file.instruction is not None and not for_xacro:
        message = "a processing instruction (<?…?>) does not stand first"
        at = Location(root.subject, file.instruction)
        problems.append(Problem(kind="instruction", message=message, location=at))
    unbound = None if is_xacro else find_unbound_prefix(root)
    if unbound is not None:
        element, prefix = unbound
        message = f"the prefix {prefix!r} is not declared (xmlns:{prefix}=…)"
        problems.append(Problem(kind="prefix", message=message, location=element.location))
    return problems


def select_own_trees(source: Source) -> dict[str, Element]:
    """Return the trees of the files in the model's own package; without a package, only the model's file."""
    package = source.package
    return {
        name: tree
        for name, tree in source.trees.items()
        if name == source.name or (package is not None and package.path in source.files[name].path.absolute().parents)
    }


def locate_expression(source: Source, problem: Problem, expression: str) -> Location:
    """Return where the failed expression was typed: the problem's place, or a definition that is read there."""

    def has_expression(span: Span | None) -> bool:
        file = None if span is None else source.files.get(span.file)
        return span is not None and file is not None and expression in file.text[span.start : span.end]

    at = problem.location
    if not expression or has_expression(at.span):
        return at
    return next((Location(r.subject, r.span, at.via) for r in problem.related if has_expression(r.span)), at)
