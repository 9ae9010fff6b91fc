"""yaml values that remember the line of each key, so that a finding can name where a number came from.

xacro reads the file with its own loader; here the same file is composed once more into nodes with positions, and the
values are wrapped so that each access tells the reader which key it was.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from urdfcheck.source.xml import Definition, SourceFile, XmlError

Read = Callable[[Definition], None]


def traced(value: Any, path: Path, name: str, read: Read) -> Any:
    """``value`` as xacro loaded it from ``path``, in wrappers of xacro's own types that report what is read."""
    import yaml

    try:
        source = SourceFile.read(path, name)
        node = yaml.compose(source.text, Loader=yaml.SafeLoader)
    except (OSError, XmlError, yaml.YAMLError):
        return value
    return _wrap(value, node, "", source, read)


def _wrap(value: Any, node: Any, key: str, source: SourceFile, read: Read) -> Any:
    import yaml
    from xacro import YamlDictWrapper, YamlListWrapper

    if isinstance(value, dict) and isinstance(node, yaml.MappingNode):
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
                if isinstance(value_node, yaml.ScalarNode):
                    span = source.span(value_node.start_mark.index, value_node.end_mark.index)
                    read(Definition("yaml", name, span))
                return _wrap(found, value_node, name, source, read)

        return TracedDict(value)
    if isinstance(value, list) and isinstance(node, yaml.SequenceNode):

        class TracedList(YamlListWrapper):  # type: ignore[misc]
            def __getitem__(self, index: Any) -> Any:
                found = super().__getitem__(index)
                if not isinstance(index, int):
                    return found
                item = node.value[index]
                name = f"{key}[{index}]"
                if isinstance(item, yaml.ScalarNode):
                    read(Definition("yaml", name, source.span(item.start_mark.index, item.end_mark.index)))
                return _wrap(found, item, name, source, read)

            def __iter__(self) -> Iterator[Any]:
                return (self[i] for i in range(len(self)))

        return TracedList(value)
    return value


def _positions(node: Any) -> dict[str, Any]:
    """The node of each key's value, with what ``<<`` merges in: the mapping's own keys go before, then the first merged."""
    import yaml

    positions: dict[str, Any] = {}
    for key, value in node.value:
        if key.tag == "tag:yaml.org,2002:merge":
            merged = value.value if isinstance(value, yaml.SequenceNode) else [value]
            for mapping in reversed(merged):
                positions = {**positions, **_positions(mapping)}
    own = {str(key.value): value for key, value in node.value if key.tag != "tag:yaml.org,2002:merge"}
    return {**positions, **own}
