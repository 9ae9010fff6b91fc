"""yaml files as xacro loads them, by values that remember the line of each key, so that a finding can name where a number
came from.

The loader is PyYAML's safe one with xacro's units. What aliases and merges multiply is counted before anything is built.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import yaml
from yaml.nodes import MappingNode, Node, ScalarNode, SequenceNode

from urdfcheck.core import Span
from urdfcheck.source.xml import Definition, SourceFile

Read = Callable[[Definition], None]
Number = Callable[[str], float]

# The largest yaml file that a published robot loads has 12 kB and 500 nodes; a tenth of a second is spent on each 10 kB.
MAX_CHARACTERS = 1_000_000
MAX_NODES = 100_000
MAX_DEPTH = 100


class _Shallow(yaml.SafeLoader):
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


class YamlProblem(Exception):
    """A file that cannot be read, at the place in it; ``tag`` when this place asks the loader to run Python."""

    def __init__(self, reason: str, span: Span, tag: str = "") -> None:
        super().__init__(reason)
        self.span = span
        self.tag = tag


def read_yaml(source: SourceFile, read: Read, number: Number) -> Any:
    """The content in wrappers of xacro's own types that report what is read; ``number`` computes a value with a unit.

    :raises YamlProblem: when it is no yaml, too large or not safe.
    """
    from xacro import ConstructUnits

    class Loader(yaml.SafeLoader):
        """A class of its own, because xacro adds its units to the one that everybody uses."""

    for unit in ConstructUnits:

        def construct(
            loader: yaml.SafeLoader, node: ScalarNode, factor: float = unit.value.conversion_constant
        ) -> float:
            return number(str(loader.construct_scalar(node))) * factor

        Loader.add_constructor(unit.value.tag, construct)
    if len(source.text) > MAX_CHARACTERS:
        message = f"it has {len(source.text):,} characters, more than {MAX_CHARACTERS:,}"
        raise YamlProblem(message, source.span(MAX_CHARACTERS, MAX_CHARACTERS + 1))
    try:
        node = yaml.compose(source.text, Loader=_Shallow)
        _ensure_bounded(node, source)
        return _wrap(yaml.load(source.text, Loader=Loader), node, "", source, read)
    except yaml.reader.ReaderError as error:
        raise YamlProblem(error.reason, source.span(error.position, error.position + 1)) from error
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        reason = ", ".join(part for part in (error.context, error.problem) if part)
        index = 0 if mark is None else mark.index
        raise YamlProblem(reason, source.span(index, index + 1)) from error


def _ensure_bounded(root: Node | None, source: SourceFile) -> None:
    """That no tag of the file asks for Python, and that it is not endless when every alias is written out."""
    sizes: dict[int, int] = {}

    def size(node: Node) -> int:
        at = source.span(node.start_mark.index, node.start_mark.index + 1)
        if id(node) in sizes:
            if not sizes[id(node)]:
                raise YamlProblem("an alias stands for what it is itself a part of: a recursion without end", at)
            return sizes[id(node)]
        if node.tag.startswith("tag:yaml.org,2002:python/"):
            tag = "!!" + node.tag.removeprefix("tag:yaml.org,2002:")
            raise YamlProblem(f"its tag {tag} asks the loader to run Python", at, tag)
        sizes[id(node)] = 0
        total = 1
        if isinstance(node, (SequenceNode, MappingNode)):
            for item in node.value:
                for part in item if isinstance(item, tuple) else (item,):
                    total += size(part)
                    if total > MAX_NODES:
                        raise YamlProblem(f"with its aliases it has more than {MAX_NODES:,} values", at)
        sizes[id(node)] = total
        return total

    if root is not None:
        size(root)


def _wrap(value: Any, node: Any, key: str, source: SourceFile, read: Read) -> Any:
    from xacro import YamlDictWrapper, YamlListWrapper

    if isinstance(value, dict) and isinstance(node, MappingNode):
        positions = _positions(node)

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
                    span = source.span(value_node.start_mark.index, value_node.end_mark.index)
                    read(Definition("yaml", name, span))
                return _wrap(found, value_node, name, source, read)

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
                    read(Definition("yaml", name, source.span(item.start_mark.index, item.end_mark.index)))
                return _wrap(found, item, name, source, read)

            def __iter__(self) -> Iterator[Any]:
                return (self[i] for i in range(len(self)))

        return TracedList(value)
    return value


def _positions(node: Any) -> dict[str, Any]:
    """The node of each key's value, with what ``<<`` merges in: the mapping's own keys go before, then the first merged."""
    positions: dict[str, Any] = {}
    for key, value in node.value:
        if key.tag == "tag:yaml.org,2002:merge":
            merged = value.value if isinstance(value, SequenceNode) else [value]
            for mapping in reversed(merged):
                positions = {**positions, **_positions(mapping)}
    own = {str(key.value): value for key, value in node.value if key.tag != "tag:yaml.org,2002:merge"}
    return {**positions, **own}
