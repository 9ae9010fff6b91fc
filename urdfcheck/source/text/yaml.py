"""yaml files by values that remember the line of each key, so that a finding can name where a number came from: as xacro
loads them (:func:`read_yaml`), and as the tree that is typed (:func:`parse_located_yaml`).

The loader is PyYAML's safe one with xacro's units. What aliases and merges multiply is counted before anything is built.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml
from yaml.nodes import MappingNode, Node, ScalarNode, SequenceNode

from urdfcheck.core import Edit, Location, Span
from urdfcheck.source.package.finder import PackageFinder, format_path
from urdfcheck.source.text.values import parse_number
from urdfcheck.source.text.xml import Definition, SourceFile, XmlError

ReadCallback = Callable[[Definition], None]
NumberEvaluator = Callable[[str], float]

# The largest yaml file that a published robot loads has 12 kB and 500 nodes; a tenth of a second is spent on each 10 kB.
MAX_CHARACTERS = 1_000_000
MAX_NODES = 100_000
MAX_DEPTH = 100


class _DepthLimitedLoader(yaml.SafeLoader):
    """Ends at once what is nested too deep: the time for a level grows with those around it."""

    depth = 0

    def compose_node(self, parent: Node | None, index: int) -> Node | None:
        self.depth += 1
        if self.depth > MAX_DEPTH:
            mark = self.peek_event().start_mark  # type: ignore[no-untyped-call]
            raise yaml.composer.ComposerError(None, None, f"it is nested more than {MAX_DEPTH} deep", mark)
        node = super().compose_node(parent, index)
        self.depth -= 1
        return node


class YamlReadError(Exception):
    """A file that cannot be read, at the place in it; ``tag`` when this place asks the loader to run Python."""

    def __init__(self, reason: str, span: Span, tag: str = "") -> None:
        super().__init__(reason)
        self.span = span
        self.tag = tag


def read_yaml(source: SourceFile, on_read: ReadCallback, evaluate_number: NumberEvaluator) -> Any:
    """The content in wrappers of xacro's own types that report what is read; ``number`` computes a value with a unit.

    :raises YamlProblem: when it is no yaml, too large or not safe.
    """
    from xacro import ConstructUnits

    class Loader(yaml.SafeLoader):
        """A class of its own, because xacro adds its units to the one that everybody uses."""

    for unit in ConstructUnits:

        def construct_unit(
            loader: yaml.SafeLoader, node: ScalarNode, factor: float = unit.value.conversion_constant
        ) -> float:
            return evaluate_number(str(loader.construct_scalar(node))) * factor

        Loader.add_constructor(unit.value.tag, construct_unit)
    with _convert_yaml_errors(source):
        node = _compose_nodes(source)
        # What is made of the nodes that are there already, instead of parsing the text again.
        value = None if node is None else Loader("").construct_document(node)
        return _wrap_value(value, node, "", source, on_read)


@dataclass(frozen=True, slots=True, eq=False)
class YamlValue:
    """A value of a yaml file as typed. ``key`` is its path in the file (``arm.joints[2]``), ``at`` where it stands, without
    quotes."""

    key: str
    node: Node
    source: SourceFile
    span: Span

    @property
    def location(self) -> Location:
        return Location(f"yaml[{self.key}]", self.span)

    @property
    def text(self) -> str:
        """What a scalar says; empty for anything else."""
        return str(self.node.value) if isinstance(self.node, ScalarNode) else ""

    @property
    def number(self) -> float | None:
        """The finite number that a plain scalar is, None for anything else (a text in quotes, a value with a unit)."""
        return parse_number(self.text) if self.is_plain and self.node.tag.endswith((":int", ":float", ":str")) else None

    @property
    def is_integer(self) -> bool:
        """Whether yaml takes the scalar for an integer."""
        return isinstance(self.node, ScalarNode) and self.node.tag.endswith(":int")

    @property
    def is_false(self) -> bool:
        """Whether the scalar is one of yaml's words for no."""
        return self.node.tag.endswith(":bool") and self.text.lower() in {"false", "no", "off"}

    @property
    def is_plain(self) -> bool:
        """Whether it is a scalar without quotes."""
        return isinstance(self.node, ScalarNode) and self.node.style is None

    @property
    def is_mapping(self) -> bool:
        return isinstance(self.node, MappingNode)

    @property
    def entries(self) -> tuple[tuple[YamlValue, YamlValue], ...]:
        """The keys of a mapping and their values; what ``<<`` merges in comes with the keys of the other mapping."""
        if not isinstance(self.node, MappingNode):
            return ()
        return tuple(
            (self._make_inner(key, str(key.value)), self._make_inner(value, str(key.value)))
            for key, value in _merge_pairs(self.node)
            if isinstance(key, ScalarNode)
        )

    @property
    def items(self) -> tuple[YamlValue, ...]:
        """The values of a list."""
        if not isinstance(self.node, SequenceNode):
            return ()
        return tuple(self._make_inner(item, f"[{index}]") for index, item in enumerate(self.node.value))

    def get(self, name: str) -> YamlValue | None:
        """The value of a key."""
        pairs = _merge_pairs(self.node) if isinstance(self.node, MappingNode) else []
        return next((self._make_inner(value, name) for key, value in pairs if key.value == name), None)

    def build_edits(self, replacement: str) -> tuple[Edit, ...]:
        """The edit that writes another scalar here; none where the file spells it with escapes or over several lines."""
        typed = self.source.text[self.span.start : self.span.end]
        return (Edit(self.span, typed, replacement),) if typed == self.text else ()

    def _make_inner(self, node: Node, name: str) -> YamlValue:
        key = f"{self.key}{name}" if name.startswith("[") else f"{self.key}.{name}".lstrip(".")
        return _make_value(key, node, self.source)


def parse_located_yaml(source: SourceFile) -> YamlValue | None:
    """The content of a file as it is typed, None for an empty one.

    :raises YamlProblem: when it is no yaml, too large or not safe.
    """
    with _convert_yaml_errors(source):
        node = _compose_nodes(source)
    return None if node is None else _make_value("", node, source)


def read_located_yaml(path: Path, finder: PackageFinder) -> YamlValue | None:
    """The content of a file; None where it may not be read or cannot be, or is empty.

    :raises YamlProblem: as :func:`parse_located_yaml`.
    """
    if not finder.can_open(path) or not os.path.isfile(path):
        return None
    try:
        return parse_located_yaml(SourceFile.read(path, format_path(path)))
    except (OSError, XmlError):  # XmlError: of its encoding or size
        return None


def find_yaml_error(path: Path, finder: PackageFinder) -> YamlReadError | None:
    """Why a file is no yaml, None where it is or may not be read."""
    try:
        read_located_yaml(path, finder)
    except YamlReadError as problem:
        return problem
    return None


def _make_value(key: str, node: Node, source: SourceFile) -> YamlValue:
    start, end = node.start_mark.index, node.end_mark.index
    if isinstance(node, ScalarNode) and node.style in {"'", '"'}:
        start = source.text.find(node.style, start) + 1  # a tag or an anchor may stand before it
        end -= 1
    return YamlValue(key, node, source, source.make_span(start, max(start, end)))


def _compose_nodes(source: SourceFile) -> Node | None:
    """The nodes of a file, none of them out of bounds."""
    if len(source.text) > MAX_CHARACTERS:
        message = f"it has {len(source.text):,} characters, more than {MAX_CHARACTERS:,}"
        raise YamlReadError(message, source.make_span(MAX_CHARACTERS, MAX_CHARACTERS + 1))
    node: Node | None = yaml.compose(source.text, Loader=_DepthLimitedLoader)
    _ensure_bounded(node, source)
    return node


@contextmanager
def _convert_yaml_errors(source: SourceFile) -> Iterator[None]:
    """What yaml raises, as a problem at its place."""
    try:
        yield
    except yaml.reader.ReaderError as error:
        raise YamlReadError(error.reason, source.make_span(error.position, error.position + 1)) from error
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        reason = ", ".join(part for part in (error.context, error.problem) if part)
        index = 0 if mark is None else mark.index
        raise YamlReadError(reason, source.make_span(index, index + 1)) from error


def _ensure_bounded(root: Node | None, source: SourceFile) -> None:
    """That no tag of the file asks for Python, and that it is not endless when every alias is written out."""
    sizes: dict[int, int] = {}

    def count_values(node: Node) -> int:
        at = source.make_span(node.start_mark.index, node.start_mark.index + 1)
        if id(node) in sizes:
            if not sizes[id(node)]:
                raise YamlReadError("an alias stands for what it is itself a part of: a recursion without end", at)
            return sizes[id(node)]
        if node.tag.startswith("tag:yaml.org,2002:python/"):
            tag = "!!" + node.tag.removeprefix("tag:yaml.org,2002:")
            raise YamlReadError(f"its tag {tag} asks the loader to run Python", at, tag)
        sizes[id(node)] = 0
        total = 1
        if isinstance(node, (SequenceNode, MappingNode)):
            for item in node.value:
                for part in item if isinstance(item, tuple) else (item,):
                    total += count_values(part)
                    if total > MAX_NODES:
                        raise YamlReadError(f"with its aliases it has more than {MAX_NODES:,} values", at)
        sizes[id(node)] = total
        return total

    if root is not None:
        count_values(root)


def _wrap_value(value: Any, node: Any, key: str, source: SourceFile, read: ReadCallback) -> Any:
    from xacro import YamlDictWrapper, YamlListWrapper

    if isinstance(value, dict) and isinstance(node, MappingNode):
        positions = _map_value_nodes(node)

        class TracedDict(YamlDictWrapper):  # type: ignore[misc]
            def __getattr__(self, item: Any) -> Any:
                return self._get(item, super().__getattr__(item))

            def __getitem__(self, item: Any) -> Any:
                return self._get(item, super().__getitem__(item))

            def get(self, item: Any, default: Any = None) -> Any:
                return self._get(item, super().get(item, default))

            def _get(self, item: Any, found: Any) -> Any:
                if str(item) not in positions:
                    return found
                value_node = positions[str(item)]
                name = f"{key}.{item}".lstrip(".")
                if isinstance(value_node, ScalarNode):
                    span = source.make_span(value_node.start_mark.index, value_node.end_mark.index)
                    read(Definition("yaml", name, span))
                return _wrap_value(found, value_node, name, source, read)

        return TracedDict(value)
    if isinstance(value, list) and isinstance(node, SequenceNode):

        class TracedList(YamlListWrapper):  # type: ignore[misc]
            def __getitem__(self, index: Any) -> Any:
                found = super().__getitem__(index)
                if not isinstance(index, int):
                    return found
                item = node.value[index]
                name = f"{key}[{index}]"
                if isinstance(item, ScalarNode):
                    read(Definition("yaml", name, source.make_span(item.start_mark.index, item.end_mark.index)))
                return _wrap_value(found, item, name, source, read)

            def __iter__(self) -> Iterator[Any]:
                return (self[i] for i in range(len(self)))

        return TracedList(value)
    return value


def _map_value_nodes(node: Any) -> dict[str, Any]:
    """The node of each key's value, with what ``<<`` merges in."""
    return {str(key.value): value for key, value in _merge_pairs(node)}


def _merge_pairs(node: Any) -> list[tuple[Any, Any]]:
    """The nodes of each key and its value, with what ``<<`` merges in: the mapping's own keys go before, then the first
    merged."""
    pairs: dict[str, tuple[Any, Any]] = {}
    for key, value in node.value:
        if key.tag == "tag:yaml.org,2002:merge":
            merged = value.value if isinstance(value, SequenceNode) else [value]
            for mapping in reversed([m for m in merged if isinstance(m, MappingNode)]):
                pairs.update((str(inner.value), (inner, found)) for inner, found in _merge_pairs(mapping))
    own = {str(key.value): (key, value) for key, value in node.value if key.tag != "tag:yaml.org,2002:merge"}
    return list({**pairs, **own}.values())
