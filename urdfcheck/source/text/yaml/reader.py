"""Reading yaml files: PyYAML's safe loader composes their nodes.

The values that aliases and merges multiply are counted before anything is built from them.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache

import yaml
from yaml.nodes import MappingNode, Node, SequenceNode

from urdfcheck.source.text.xml import SourceFile
from urdfcheck.source.text.yaml.values import YamlReadError, YamlValue, make_yaml_value

# The largest yaml file that a published robot loads has 12 kB and 500 nodes; reading takes 0.1 s per 10 kB.
MAX_CHARACTERS = 1_000_000
MAX_NODES = 100_000
MAX_DEPTH = 100
# Characters of a file whose nodes are kept for the next time that it is read.
_LONGEST_KEPT = 100_000


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


def parse_located_yaml(source: SourceFile) -> YamlValue | None:
    """Return the content of a file as typed; None for an empty file.

    :raises YamlReadError: if it is not yaml, too large or not safe.
    """
    with convert_yaml_errors(source):
        node = compose_nodes(source)
    return None if node is None else make_yaml_value("", node, source)


def compose_nodes(source: SourceFile) -> Node | None:
    """Return the nodes of a file, within the limits on their number and depth.

    :raises YamlReadError: if a limit is exceeded, or a tag asks for Python.
    """
    if len(source.text) > MAX_CHARACTERS:
        message = f"it has {len(source.text):,} characters, more than {MAX_CHARACTERS:,}"
        raise YamlReadError(message, source.make_span(MAX_CHARACTERS, MAX_CHARACTERS + 1))
    # PyYAML writes merged keys into the nodes that it constructs values of: those are not shared.
    is_shared = len(source.text) <= _LONGEST_KEPT and "<<" not in source.text
    node = (_compose_known_text if is_shared else _compose_text)(source.text)
    if node is not None:
        _SizeCounter(source).count_values(node)
    return node


def _compose_text(text: str) -> Node | None:
    node: Node | None = yaml.compose(text, Loader=_DepthLimitedLoader)
    return node


# Most models of a package read the same files, and an editor reads them again after each key.
_compose_known_text = lru_cache(maxsize=32)(_compose_text)


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
