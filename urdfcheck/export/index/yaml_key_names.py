"""Where keys of yaml files are typed, and where the expressions of a xacro file name them."""

from __future__ import annotations

import re
from collections.abc import Iterator

from urdfcheck.core import Span
from urdfcheck.export.index.source_index import YAML_KEY, DoubtfulName, NamePlace
from urdfcheck.source.load import Source
from urdfcheck.source.text.yaml.values import make_yaml_value, merge_pairs

# ['key'], .get('key' and .key of an expression.
_LITERAL = re.compile(r"""(?:\[|\.get\()\s*(?:'([^']*)'|"([^"]*)")|(?<=[\w\])])\.([^\W\d]\w*)""")
_DOUBT = "nothing that is read there now has it"


def iter_yaml_key_names(source: Source) -> Iterator[NamePlace]:
    """Yield the keys of each mapping of which a key is read, and the words of expressions that read one."""
    for (text, name), keys in _collect_reads(source).items():
        words = [span for word, span in _iter_literals(source, text) if word == name]
        for place, span in enumerate(words):
            # `${a['x'] + b['x']}` reads one key after the other; otherwise each word may mean each key.
            meant = list(keys)[place : place + 1] if len(words) == len(keys) else keys
            yield NamePlace(YAML_KEY, name, span, False, tuple(meant))
    for read in {id(read.mapping): read for read in source.key_reads}.values():
        around = make_yaml_value("", read.mapping, read.source).span
        for key, _ in merge_pairs(read.mapping):
            yield NamePlace(YAML_KEY, str(key.value), make_yaml_value("", key, read.source).span, True, scope=around)


def iter_unread_keys(source: Source) -> Iterator[DoubtfulName]:
    """Yield the words of expressions that may be keys of yaml files which this robot does not read there."""
    reads = _collect_reads(source)
    names = {name for _, name in reads}
    for tree in source.trees.values() if names else ():
        for element in tree.walk():
            for attribute in element.attributes.values():
                if "$" in attribute.typed and attribute.span is not None:
                    for name, span in _iter_literals(source, attribute.span):
                        if name in names and (attribute.span, name) not in reads:
                            yield DoubtfulName(YAML_KEY, name, span, _DOUBT)


def _collect_reads(source: Source) -> dict[tuple[Span, str], dict[Span, None]]:
    """Return the places of the keys that each text reads by a name."""
    reads: dict[tuple[Span, str], dict[Span, None]] = {}
    for read in source.key_reads:
        key = make_yaml_value("", read.key, read.source)
        reads.setdefault((read.text, key.text), {})[key.span] = None
    return reads


def _iter_literals(source: Source, text: Span) -> Iterator[tuple[str, Span]]:
    """Yield the names of keys in a text that are typed there, with their places."""
    file = source.files[text.file]
    for match in _LITERAL.finditer(file.text, text.start, text.end):
        group = match.lastindex or 0
        yield match[group], file.make_span(*match.span(group))
