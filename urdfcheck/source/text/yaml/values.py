"""yaml files as the tree that is typed: each value with its key's path and its span.

PyYAML is loaded with the first file: see `urdfcheck.source.text.yaml.reader`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeGuard

from urdfcheck.core import Edit, Location, Span
from urdfcheck.core.records import dataclass
from urdfcheck.source.text.values import parse_number
from urdfcheck.source.text.xml import SourceFile

if TYPE_CHECKING:
    from yaml.nodes import MappingNode, Node, ScalarNode, SequenceNode


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
        return str(self.node.value) if _is_scalar(self.node) else ""

    @property
    def number(self) -> float | None:
        """The finite number of a plain scalar; None for anything else (a text in quotes, a value with a unit)."""
        return parse_number(self.text) if self.is_plain and self.node.tag.endswith((":int", ":float", ":str")) else None

    @property
    def is_integer(self) -> bool:
        """Whether yaml reads the scalar as an integer."""
        return _is_scalar(self.node) and self.node.tag.endswith(":int")

    @property
    def is_false(self) -> bool:
        """Whether the scalar is one of yaml's words for no."""
        return self.node.tag.endswith(":bool") and self.text.lower() in {"false", "no", "off"}

    @property
    def is_plain(self) -> bool:
        """Whether it is a scalar without quotes."""
        return _is_scalar(self.node) and self.node.style is None

    @property
    def is_mapping(self) -> bool:
        return _is_mapping(self.node)

    @property
    def entries(self) -> tuple[tuple[YamlValue, YamlValue], ...]:
        """The keys of a mapping and their values; entries that ``<<`` merges in have the keys of the other mapping."""
        if not _is_mapping(self.node):
            return ()
        return tuple(
            (self._make_inner(key, str(key.value)), self._make_inner(value, str(key.value)))
            for key, value in merge_pairs(self.node)
            if _is_scalar(key)
        )

    @property
    def overridden_entries(self) -> tuple[tuple[YamlValue, YamlValue], ...]:
        """The entries of a mapping whose key a later one repeats: yaml forgets them, and not every parser of it does."""
        if not _is_mapping(self.node):
            return ()
        last = {str(key.value): key for key, _ in self.node.value}
        return tuple(
            (self._make_inner(key, str(key.value)), self._make_inner(value, str(key.value)))
            for key, value in self.node.value
            if _is_scalar(key) and last[str(key.value)] is not key
        )

    @property
    def items(self) -> tuple[YamlValue, ...]:
        """The values of a list."""
        if not _is_sequence(self.node):
            return ()
        return tuple(self._make_inner(item, f"[{index}]") for index, item in enumerate(self.node.value))

    def get(self, name: str) -> YamlValue | None:
        """Return the value of a key."""
        pairs = merge_pairs(self.node) if _is_mapping(self.node) else []
        return next((self._make_inner(value, name) for key, value in pairs if key.value == name), None)

    def build_edits(self, replacement: str) -> tuple[Edit, ...]:
        """Return the edit that replaces the scalar; none if the file spells it with escapes or over several lines."""
        typed = self.source.text[self.span.start : self.span.end]
        return (Edit(self.span, typed, replacement),) if typed == self.text else ()

    def _make_inner(self, node: Node, name: str) -> YamlValue:
        key = f"{self.key}{name}" if name.startswith("[") else f"{self.key}.{name}".lstrip(".")
        return make_yaml_value(key, node, self.source)


@dataclass(frozen=True, slots=True, eq=False)
class YamlKeyRead:
    """A key of a mapping whose value a text with expressions reads."""

    text: Span
    source: SourceFile
    mapping: MappingNode
    key: ScalarNode


def make_yaml_value(key: str, node: Node, source: SourceFile) -> YamlValue:
    """Return a node as a value; ``key``: its path in the file."""
    start, end = node.start_mark.index, node.end_mark.index
    if _is_scalar(node) and node.style in {"'", '"'}:
        start = source.text.find(node.style, start) + 1  # after a tag or an anchor
        end -= 1
    return YamlValue(key, node, source, span=source.make_span(start, max(start, end)))


def merge_pairs(mapping: MappingNode) -> list[tuple[Any, Any]]:
    """Return the nodes of each key and its value, ``<<`` merges included.

    The mapping's own keys take precedence, then those of the first mapping that is merged in.
    """
    merged: dict[str, tuple[Any, Any]] = {}
    own: dict[str, tuple[Any, Any]] = {}
    for key, value in mapping.value:
        if key.tag == "tag:yaml.org,2002:merge":
            mappings = value.value if _is_sequence(value) else [value]
            for inner in reversed([m for m in mappings if _is_mapping(m)]):
                merged.update((str(pair[0].value), pair) for pair in merge_pairs(inner))
        else:
            own[str(key.value)] = (key, value)
    return list({**merged, **own}.values())


def _is_scalar(node: Node) -> TypeGuard[ScalarNode]:
    return type(node).__name__ == "ScalarNode"


def _is_mapping(node: Node) -> TypeGuard[MappingNode]:
    return type(node).__name__ == "MappingNode"


def _is_sequence(node: Node) -> TypeGuard[SequenceNode]:
    return type(node).__name__ == "SequenceNode"
