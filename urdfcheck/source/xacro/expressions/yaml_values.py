"""yaml files as xacro loads them: values in xacro's own wrappers, which record each value that is read.

The loader is PyYAML's safe one with xacro's units.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import yaml
from yaml.nodes import MappingNode, ScalarNode, SequenceNode

from urdfcheck.source.text.xml import Definition, SourceFile
from urdfcheck.source.text.yaml.reader import compose_nodes, convert_yaml_errors
from urdfcheck.source.text.yaml.values import merge_pairs

ReadCallback = Callable[[Definition], None]
NumberEvaluator = Callable[[str], float]
KeyCallback = Callable[[SourceFile, MappingNode, ScalarNode], None]


def read_yaml(source: SourceFile, on_read: ReadCallback, evaluate_number: NumberEvaluator, on_key: KeyCallback) -> Any:
    """Return the content of a file in xacro's wrappers.

    ``on_read`` is called with each scalar that is read, and ``on_key`` with the mapping and the key of each value;
    ``evaluate_number`` computes a value with a unit.

    :raises YamlReadError: if it is not yaml, too large or not safe.
    """
    with convert_yaml_errors(source):
        node = compose_nodes(source)
        # Built from the nodes that are already there, instead of parsing the text again.
        value = None if node is None else _make_loader(evaluate_number)("").construct_document(node)
        return _ValueWrapper(source, on_read, on_key).wrap(value, node, "")


def _make_loader(evaluate_number: NumberEvaluator) -> type[yaml.SafeLoader]:
    """Return a loader with xacro's units: a new class, because xacro adds its units to the loader that all code shares."""
    from xacro import ConstructUnits

    class Loader(yaml.SafeLoader):
        pass

    for unit in ConstructUnits:

        def construct_unit(
            loader: yaml.SafeLoader, node: ScalarNode, factor: float = unit.value.conversion_constant
        ) -> float:
            return evaluate_number(str(loader.construct_scalar(node))) * factor

        Loader.add_constructor(unit.value.tag, construct_unit)
    return Loader


class _ValueWrapper:
    """Wraps the values of one file so that reading a scalar is recorded with its key and place."""

    def __init__(self, source: SourceFile, on_read: ReadCallback, on_key: KeyCallback) -> None:
        self.source = source
        self.on_read = on_read
        self.on_key = on_key

    def wrap(self, value: Any, node: Any, key: str) -> Any:
        """Wrap a mapping or list; return anything else as it is. ``key``: its path in the file."""
        if isinstance(value, dict) and isinstance(node, MappingNode):
            return self._wrap_mapping(value, node, key)
        if isinstance(value, list) and isinstance(node, SequenceNode):
            return self._wrap_list(value, node, key)
        return value

    def _read_value(self, value: Any, node: Any, key: str) -> Any:
        """Record the read of a scalar, and wrap anything else."""
        if isinstance(node, ScalarNode):
            span = self.source.make_span(node.start_mark.index, node.end_mark.index)
            self.on_read(Definition("yaml", key, span, text=self.source.text[span.start : span.end]))
        return self.wrap(value, node, key)

    def _wrap_mapping(self, mapping: Any, node: MappingNode, key: str) -> Any:
        from xacro import YamlDictWrapper

        pairs = {str(name.value): (name, value) for name, value in merge_pairs(node)}
        read_value, source, on_key = self._read_value, self.source, self.on_key

        class TracedDict(YamlDictWrapper):  # type: ignore[misc]
            def __getattr__(self, item: Any) -> Any:
                return self._record(item, super().__getattr__(item))

            def __getitem__(self, item: Any) -> Any:
                return self._record(item, super().__getitem__(item))

            def get(self, item: Any, default: Any = None) -> Any:
                return self._record(item, super().get(item, default))

            def _record(self, item: Any, value: Any) -> Any:
                if str(item) not in pairs:
                    return value
                name, value_node = pairs[str(item)]
                on_key(source, node, name)
                return read_value(value, value_node, f"{key}.{item}".lstrip("."))

        return TracedDict(mapping)

    def _wrap_list(self, values: Any, node: SequenceNode, key: str) -> Any:
        from xacro import YamlListWrapper

        read_value = self._read_value

        class TracedList(YamlListWrapper):  # type: ignore[misc]
            def __getitem__(self, index: Any) -> Any:
                value = super().__getitem__(index)
                if not isinstance(index, int):
                    return value
                return read_value(value, node.value[index], f"{key}[{index}]")

            def __iter__(self) -> Iterator[Any]:
                return (self[i] for i in range(len(self)))

        return TracedList(values)
