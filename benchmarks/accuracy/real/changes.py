"""A robot as it is typed, its links and joints, and changes of literal values in its text."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from injections import Array, Numbers

from real.robots import RealRobot
from urdfcheck.core import Edit, Span
from urdfcheck.model.parts import Joint, Link, Shape
from urdfcheck.model.robot import Model
from urdfcheck.source.load import Source, load_source
from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.source.text.xml import Attribute, Element
from urdfcheck.system.files import overlay_files

SIX = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
# Digits of a number that is written: as many as CAD programs print, so that nothing is lost by the change itself.
_DIGITS = 9

Texts = Mapping[Path, str]


@dataclass(frozen=True, slots=True)
class Change:
    """A new text for the value of an attribute, or for another piece of a file."""

    span: Span
    text: str


@dataclass(frozen=True, eq=False)
class ReadRobot:
    """A robot with the model that was made of it."""

    robot: RealRobot
    source: Source
    model: Model

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """All links, each with the joint that carries it."""
        carriers = {joint.child: joint for joint in reversed(self.model.joints)}
        return tuple(Part(self, link, carriers.get(link.name)) for link in self.model.links)

    def list_subjects(self, span: Span) -> set[str]:
        """List the links and joints that a piece of text is part of: one, or all that a macro made of it."""
        values = self._values_by_file.get(span.file, [])
        return {subject for start, end, subject in values if start <= span.end and span.start <= end}

    @cached_property
    def _values_by_file(self) -> dict[str, list[tuple[int, int, str]]]:
        """Start and end of the value of each attribute, and the link or joint that has it."""
        found: dict[str, list[tuple[int, int, str]]] = {}
        for part in self.model.named_elements:
            for element in part.element.walk():
                for attribute in element.attributes.values():
                    span = attribute.span
                    if span is not None:
                        found.setdefault(span.file, []).append((span.start, span.end, part.element.subject))
        return found

    def apply(self, changes: Iterable[Change]) -> Texts:
        """Return the texts of the changed files."""
        by_file: dict[str, list[Change]] = {}
        for change in changes:
            by_file.setdefault(change.span.file, []).append(change)
        texts = {}
        for name, some in by_file.items():
            file = self.source.files[name]
            text = file.text
            for change in sorted(some, key=lambda one: one.span.start, reverse=True):
                text = text[: change.span.start] + change.text + text[change.span.end :]
            texts[file.path] = text
        return texts


@dataclass(frozen=True, eq=False)
class Part:
    """A link and the joint that carries it (None for a root)."""

    owner: ReadRobot
    link: Link
    joint: Joint | None

    @property
    def subjects(self) -> set[str]:
        """The labels of link and joint as subjects of findings begin with them."""
        return {f"link[{self.link.name}]"} | ({f"joint[{self.joint.name}]"} if self.joint is not None else set())

    @cached_property
    def numbers(self) -> Numbers | None:
        """The ten numbers and the rpy of the inertial; None unless mass, COM and tensor are typed as numbers, and the mass is
        positive."""
        inertial = self.link.inertial
        if inertial is None or inertial.mass is None or inertial.mass <= 0 or inertial.inertia_components is None:
            return None
        xyz, rpy = inertial.origin.xyz, inertial.origin.rpy
        if xyz is None or rpy is None or inertial.origin.get_attribute("quat_xyzw") is not None:
            return None
        if not all(is_literal(a) for a in (inertial.mass_attribute, *self._tensor_attributes)):
            return None
        return Numbers(inertial.mass, np.array(xyz), np.array(inertial.inertia_components), np.array(rpy))

    @property
    def _tensor_attributes(self) -> list[Attribute | None]:
        element = None if self.link.inertial is None else self.link.inertial.tensor_element
        return [None if element is None else element.attributes.get(name) for name in SIX]

    def write(self, new: Numbers) -> list[Change] | None:
        """Write other numbers into the inertial; None if one that changes is not typed."""
        old, inertial = self.numbers, self.link.inertial
        if old is None or inertial is None:
            return None
        pairs = [(inertial.mass_attribute, [old.mass], [new.mass])]
        pairs += [(a, [b], [c]) for a, b, c in zip(self._tensor_attributes, old.six, new.six, strict=True)]
        pairs.append((inertial.origin.get_attribute("xyz"), list(old.com), list(new.com)))
        return write_all(pairs)


def is_literal(attribute: Attribute | None) -> bool:
    """Whether the value of an attribute is typed as it is."""
    return attribute is not None and attribute.literal and attribute.span is not None


def write_all(pairs: Iterable[tuple[Attribute | None, Sequence[float], Sequence[float]]]) -> list[Change] | None:
    """Write numbers where they differ from the old ones; None if there is no literal text for one, or none differs."""
    changes = []
    for attribute, old, new in pairs:
        if np.array_equal(old, new):
            continue
        if attribute is None or not is_literal(attribute):
            return None
        changes.append(replace_value(attribute, format_numbers(new, attribute.value.split())))
    return changes or None


def replace_value(attribute: Attribute, text: str) -> Change:
    """Replace the value of a literal attribute."""
    assert attribute.span is not None
    return Change(attribute.span, text)


def format_numbers(values: Iterable[float], typed: Sequence[str] = ()) -> str:
    """Write numbers, separated by blanks; those that did not change as they were ``typed``."""
    words = [f"{float(value):.{_DIGITS}g}" for value in values]
    return " ".join(
        old if index < len(typed) and _is_same(old, new) else new
        for index, (old, new) in enumerate(zip([*typed, *words[len(typed) :]], words, strict=False))
    )


def _is_same(old: str, new: str) -> bool:
    try:
        return float(old) == float(new) or f"{float(old):.{_DIGITS}g}" == new
    except ValueError:
        return False


def read_numbers(element: Element | None, name: str) -> Array | None:
    """Read the numbers of an attribute; None if it is absent or malformed."""
    attribute = None if element is None else element.attributes.get(name)
    try:
        return None if attribute is None else np.array([float(word) for word in attribute.value.split()])
    except ValueError:
        return None


def read_robot(robot: RealRobot, texts: Texts | None = None) -> ReadRobot | None:
    """Read a robot; None if nothing can be made of it, or if a file of it is not in UTF-8.

    :param texts: contents of files that count instead of what is on the disk.
    """
    contents = {str(path.resolve()): text.encode("utf-8") for path, text in (texts or {}).items()}
    with overlay_files(contents):
        finder = PackageFinder(robot.entry, {}, list(robot.package_roots))
        source = load_source(robot.entry, robot.arguments, finder)
    if source.root is None or source.root.tag != "robot":
        return None
    if any(file.encoding.lower() not in ("utf-8", "utf8", "ascii", "us-ascii") for file in source.files.values()):
        return None
    return ReadRobot(robot, source, Model(source=source, robot=source.root))


def list_shapes(part: Part, role: str) -> tuple[Shape, ...]:
    """List the shapes of a link: ``visual`` or ``collision``."""
    return part.link.visuals if role == "visual" else part.link.collisions


def change_edits(edits: Iterable[Edit]) -> list[Change]:
    """Return the edits of a repair as changes."""
    return [Change(edit.span, edit.replacement) for edit in edits]
