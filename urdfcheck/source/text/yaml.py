"""yaml files as the tree that is typed: each value with its key's path and its span.

PyYAML's safe loader reads them. The values that aliases and merges multiply are counted before anything is built from them.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import yaml
from yaml.nodes import MappingNode, Node, ScalarNode, SequenceNode

from urdfcheck.core import Edit, Location, Span
from urdfcheck.source.text.values import parse_number
from urdfcheck.source.text.xml import SourceFile

# The largest yaml file that a published robot loads has 12 kB and 500 nodes; reading takes 0.1 s per 10 kB.
MAX_CHARACTERS = 1_000_000
MAX_NODES = 100_000
MAX_DEPTH = 100


class _DepthLimitedLoader(yaml.SafeLoader):
    """Rejects deep nesting before it is read: the time for a level grows with the number of levels around it."""

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
    """A file that cannot be read, and the place in it; ``tag`` is set if this place asks the loader to run Python."""

    def __init__(self, reason: str, span: Span, tag: str = "") -> None:
        super().__init__(reason)
        self.span = span
        self.tag = tag


@dataclass(frozen=True, slots=True, eq=False)
class YamlValue:
    """A value of a yaml file as typed. ``key`` is its path in the file (``arm.joints[2]``), ``span`` its place without quotes."""

    key: str
    node: Node
    source: SourceFile
    span: Span

    @property
    def location(self) -> Location:
        return Location(f"yaml[{self.key}]", self.span)

    @property
    def text(self) -> str:
        """The text of a scalar; empty for anything else."""
        return str(self.node.value) if isinstance(self.node, ScalarNode) else ""

    @property
    def number(self) -> float | None:
        """The finite number of a plain scalar; None for anything else (a text in quotes, a value with a unit)."""
        return parse_number(self.text) if self.is_plain and self.node.tag.endswith((":int", ":float", ":str")) else None

    @property
    def is_integer(self) -> bool:
        """Whether yaml reads the scalar as an integer."""
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
        """The keys of a mapping and their values; entries that ``<<`` merges in have the keys of the other mapping."""
        if not isinstance(self.node, MappingNode):
            return ()
        return tuple(
            (self._make_inner(key, str(key.value)), self._make_inner(value, str(key.value)))
            for key, value in merge_pairs(self.node)
            if isinstance(key, ScalarNode)
        )

    @property
    def items(self) -> tuple[YamlValue, ...]:
        """The values of a list."""
        if not isinstance(self.node, SequenceNode):
            return ()
        return tuple(self._make_inner(item, f"[{index}]") for index, item in enumerate(self.node.value))

    def get(self, name: str) -> YamlValue | None:
        """Return the value of a key."""
        pairs = merge_pairs(self.node) if isinstance(self.node, MappingNode) else []
        return next((self._make_inner(value, name) for key, value in pairs if key.value == name), None)

    def build_edits(self, replacement: str) -> tuple[Edit, ...]:
        """Return the edit that replaces the scalar; none if the file spells it with escapes or over several lines."""
        typed = self.source.text[self.span.start : self.span.end]
        return (Edit(self.span, typed, replacement),) if typed == self.text else ()

    def _make_inner(self, node: Node, name: str) -> YamlValue:
        key = f"{self.key}{name}" if name.startswith("[") else f"{self.key}.{name}".lstrip(".")
        return _make_value(key, node, self.source)


def parse_located_yaml(source: SourceFile) -> YamlValue | None:
    """Return the content of a file as typed; None for an empty file.

    :raises YamlReadError: if it is not yaml, too large or not safe.
    """
    with convert_yaml_errors(source):
        node = compose_nodes(source)
    return None if node is None else _make_value("", node, source)


def _make_value(key: str, node: Node, source: SourceFile) -> YamlValue:
    start, end = node.start_mark.index, node.end_mark.index
    if isinstance(node, ScalarNode) and node.style in {"'", '"'}:
        start = source.text.find(node.style, start) + 1  # after a tag or an anchor
        end -= 1
    return YamlValue(key, node, source, span=source.make_span(start, max(start, end)))


def compose_nodes(source: SourceFile) -> Node | None:
    """Return the nodes of a file, within the limits on their number and depth.

    :raises YamlReadError: if a limit is exceeded, or a tag asks for Python.
    """
    if len(source.text) > MAX_CHARACTERS:
        message = f"it has {len(source.text):,} characters, more than {MAX_CHARACTERS:,}"
        raise YamlReadError(message, source.make_span(MAX_CHARACTERS, MAX_CHARACTERS + 1))
    node: Node | None = yaml.compose(source.text, Loader=_DepthLimitedLoader)
    if node is not None:
        _SizeCounter(source).count_values(node)
    return node


@contextmanager
def convert_yaml_errors(source: SourceFile) -> Iterator[None]:
    """Raise the errors of yaml as :class:`YamlReadError` with their place."""
    try:
        yield
    except yaml.reader.ReaderError as error:
        raise YamlReadError(error.reason, source.make_span(error.position, error.position + 1)) from error
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        reason = ", ".join(part for part in (error.context, error.problem) if part)
        index = 0 if mark is None else mark.index
        raise YamlReadError(reason, source.make_span(index, index + 1)) from error


class _SizeCounter:
    """Counts the values of a file with every alias written out; rejects recursion and tags that ask for Python."""

    def __init__(self, source: SourceFile) -> None:
        self.source = source
        self.sizes: dict[int, int] = {}  # by the node's id; 0 while its parts are counted

    def count_values(self, node: Node) -> int:
        """Return the number of values of a node.

        :raises YamlReadError: if it is more than :data:`MAX_NODES`, endless, or a tag asks for Python.
        """
        place = self.source.make_span(node.start_mark.index, node.start_mark.index + 1)
        if id(node) in self.sizes:
            if not self.sizes[id(node)]:
                raise YamlReadError("an alias stands for what it is itself a part of: a recursion without end", place)
            return self.sizes[id(node)]
        if node.tag.startswith("tag:yaml.org,2002:python/"):
            tag = "!!" + node.tag.removeprefix("tag:yaml.org,2002:")
            raise YamlReadError(f"its tag {tag} asks the loader to run Python", place, tag)
        self.sizes[id(node)] = 0
        total = 1
        for part in _list_parts(node):
            total += self.count_values(part)
            if total > MAX_NODES:
                raise YamlReadError(f"with its aliases it has more than {MAX_NODES:,} values", place)
        self.sizes[id(node)] = total
        return total


def _list_parts(node: Node) -> list[Node]:
    """Return the items of a list, or the keys and values of a mapping."""
    if isinstance(node, MappingNode):
        return [part for pair in node.value for part in pair]
    return list(node.value) if isinstance(node, SequenceNode) else []


def merge_pairs(mapping: MappingNode) -> list[tuple[Any, Any]]:
    """Return the nodes of each key and its value, ``<<`` merges included.

    The mapping's own keys take precedence, then those of the first mapping that is merged in.
    """
    merged: dict[str, tuple[Any, Any]] = {}
    own: dict[str, tuple[Any, Any]] = {}
    for key, value in mapping.value:
        if key.tag == "tag:yaml.org,2002:merge":
            mappings = value.value if isinstance(value, SequenceNode) else [value]
            for inner in reversed([m for m in mappings if isinstance(m, MappingNode)]):
                merged.update((str(pair[0].value), pair) for pair in merge_pairs(inner))
        else:
            own[str(key.value)] = (key, value)
    return list({**merged, **own}.values())
