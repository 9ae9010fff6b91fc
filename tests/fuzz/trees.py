"""XML as a tree that may be wrong in any way, and mutations of it."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from random import Random
from xml.parsers import expat

from fuzz import nasty
from fuzz.texts import some, utf8

_ESCAPED = str.maketrans({"&": "&amp;", "<": "&lt;", '"': "&quot;", "\n": "&#10;", "\r": "&#13;", "\t": "&#9;"})
_NUMBERS = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")


@dataclass(slots=True)
class Node:
    """An element; attributes may be there twice. ``raw`` is written as it is, in the place of an element."""

    tag: str
    attributes: list[tuple[str, str]] = field(default_factory=list)
    children: list[Node] = field(default_factory=list)
    text: str = ""
    raw: str = ""

    def copy(self) -> Node:
        return Node(self.tag, list(self.attributes), [c.copy() for c in self.children], self.text, self.raw)

    def walk(self) -> Iterator[Node]:
        stack = [self]
        while stack:
            node = stack.pop()
            yield node
            stack += node.children

    def write(self) -> str:
        """The element as text."""
        parts: list[str] = []
        stack: list[Node | str] = [self]
        while stack:
            node = stack.pop()
            if isinstance(node, str):
                parts.append(node)
                continue
            if node.raw:
                parts.append(node.raw)
                continue
            written = "".join(f' {name}="{value.translate(_ESCAPED)}"' for name, value in node.attributes)
            if not node.children and not node.text:
                parts.append(f"<{node.tag}{written}/>\n")
                continue
            parts.append(f"<{node.tag}{written}>{node.text.replace('&', '&amp;').replace('<', '&lt;')}")
            stack.append(f"</{node.tag}>\n")
            stack += reversed(node.children)
        return "".join(parts)


def read(text: str | bytes) -> Node:
    """A well-formed text as a tree."""
    parser = expat.ParserCreate()
    top = Node("")
    stack = [top]

    def start(tag: str, values: dict[str, str]) -> None:
        node = Node(tag, list(values.items()))
        stack[-1].children.append(node)
        stack.append(node)

    def characters(data: str) -> None:
        stack[-1].text += data.strip()

    parser.StartElementHandler = start
    parser.EndElementHandler = lambda _: stack.pop()
    parser.CharacterDataHandler = characters
    parser.Parse(text, True)
    return top.children[0]


@dataclass(frozen=True, slots=True)
class Words:
    """What the documents of one kind say: their tags, attributes, values of each attribute, and elements to plant."""

    tags: tuple[str, ...]
    attributes: tuple[str, ...]
    values: dict[str, tuple[str, ...]]
    elements: tuple[Node, ...]


def words_of(trees: Sequence[Node]) -> Words:
    """The words of well-formed documents."""
    nodes = [node for tree in trees for node in tree.walk()]
    values: dict[str, dict[str, None]] = {}
    for node in nodes:
        for name, value in node.attributes:
            values.setdefault(name, {})[value] = None
    return Words(
        tuple(dict.fromkeys(node.tag for node in nodes)),
        tuple(values),
        {name: tuple(known) for name, known in values.items()},
        tuple(node for node in nodes if len(list(node.walk())) < 30),
    )


Insert = Callable[[Random], str]


def mutated(tree: Node, rng: Random, words: Words, planted: Insert | None = None, value: Insert | None = None) -> bytes:
    """The text of a tree after some mutations. ``planted`` writes elements of the language that are put anywhere, ``value``
    texts of it that are put in attributes."""
    tree = tree.copy()
    for _ in range(some(rng)):
        if planted is not None and rng.random() < 0.5:
            _somewhere(tree, rng).children.append(Node("", raw=planted(rng)))
        elif value is not None and rng.random() < 0.4:
            _set(_somewhere(tree, rng), rng, value(rng))
        else:
            rng.choice(_MUTATIONS)(tree, rng, words)
    return utf8('<?xml version="1.0"?>\n' + tree.write())


def _somewhere(tree: Node, rng: Random) -> Node:
    return rng.choice([node for node in tree.walk() if not node.raw])


def _set(node: Node, rng: Random, value: str) -> None:
    """Put a value in an attribute, or for one of the numbers in it, or in the text."""
    if not node.attributes:
        node.text = value
        return
    at = rng.randrange(len(node.attributes))
    name, old = node.attributes[at]
    numbers = list(_NUMBERS.finditer(old))
    if numbers and rng.random() < 0.6:
        match = rng.choice(numbers)
        value = old[: match.start()] + value + old[match.end() :]
    node.attributes[at] = name, value


def _number(tree: Node, rng: Random, _: Words) -> None:
    with_numbers = [n for n in tree.walk() if any(_NUMBERS.search(value) for _, value in n.attributes)]
    if with_numbers:
        _set(rng.choice(with_numbers), rng, rng.choice(nasty.NUMBERS))


def _scale(tree: Node, rng: Random, _: Words) -> None:
    """A number that is wrong, not malformed: another power of ten, another sign, the digits cut."""
    found = [(n, i) for n in tree.walk() for i, (_, value) in enumerate(n.attributes) if _NUMBERS.search(value)]
    if not found:
        return
    node, at = rng.choice(found)
    name, old = node.attributes[at]

    def wrong(match: re.Match[str]) -> str:
        number = float(match.group())
        return repr(number * rng.choice((-1.0, 0.0, 1e-3, 1e3, 1e-9, 1e9, 1e-30, 1e30, 1.000001, 2.0)))

    node.attributes[at] = name, _NUMBERS.sub(wrong, old, count=rng.choice((0, 1, 2)))


def _arity(tree: Node, rng: Random, _: Words) -> None:
    node = _somewhere(tree, rng)
    numbers = " ".join(rng.choice(("0", "1", "-1", *nasty.NUMBERS)) for _ in range(rng.choice((0, 1, 2, 3, 4, 6, 50))))
    _set(node, rng, numbers)


def _name(tree: Node, rng: Random, _: Words) -> None:
    """A nasty name for an attribute; sometimes wherever the same name stands, so that references still meet."""
    named = [n for n in tree.walk() if n.attributes]
    if not named:
        return
    node = rng.choice(named)
    at = rng.randrange(len(node.attributes))
    old = node.attributes[at][1]
    new = nasty.HUGE_NAME if rng.random() < 0.005 else rng.choice(nasty.NAMES)
    if rng.random() < 0.5:
        node.attributes[at] = node.attributes[at][0], new
        return
    for other in named:
        other.attributes[:] = [(name, new if value == old else value) for name, value in other.attributes]


def _path(tree: Node, rng: Random, _: Words) -> None:
    with_paths = [n for n in tree.walk() if any("/" in v or "." in v for _, v in n.attributes)]
    if with_paths:
        node = rng.choice(with_paths)
        at = rng.randrange(len(node.attributes))
        node.attributes[at] = node.attributes[at][0], rng.choice(nasty.PATHS)


def _known_value(tree: Node, rng: Random, words: Words) -> None:
    node = _somewhere(tree, rng)
    if not node.attributes:
        return
    at = rng.randrange(len(node.attributes))
    name = node.attributes[at][0]
    known = words.values.get(name, ()) if rng.random() < 0.7 else rng.choice(list(words.values.values()))
    node.attributes[at] = name, rng.choice(known or ("",))


def _drop_attribute(tree: Node, rng: Random, _: Words) -> None:
    node = _somewhere(tree, rng)
    if node.attributes:
        del node.attributes[rng.randrange(len(node.attributes))]


def _add_attribute(tree: Node, rng: Random, words: Words) -> None:
    name = rng.choice((*words.attributes, "xmlns", "xmlns:x", "xml:lang", "x:y", "é", "a" * 1000))
    value = rng.choice((*words.values.get(name, ("",)), rng.choice(nasty.NAMES)))
    _somewhere(tree, rng).attributes.append((name, value))


def _many_attributes(tree: Node, rng: Random, _: Words) -> None:
    _somewhere(tree, rng).attributes += [(f"a{i}", str(i)) for i in range(rng.choice((20, 300)))]


def _rename_attribute(tree: Node, rng: Random, words: Words) -> None:
    node = _somewhere(tree, rng)
    if node.attributes:
        at = rng.randrange(len(node.attributes))
        node.attributes[at] = rng.choice(words.attributes), node.attributes[at][1]


def _swap_values(tree: Node, rng: Random, _: Words) -> None:
    named = [n for n in tree.walk() if n.attributes]
    if named:
        a, b = rng.choice(named), rng.choice(named)
        i, j = rng.randrange(len(a.attributes)), rng.randrange(len(b.attributes))
        first, second = a.attributes[i], b.attributes[j]
        a.attributes[i] = first[0], second[1]
        b.attributes[j] = second[0], first[1]


def _drop(tree: Node, rng: Random, _: Words) -> None:
    parent = _parent(tree, rng)
    if parent is not None:
        del parent.children[rng.randrange(len(parent.children))]


def _double(tree: Node, rng: Random, _: Words) -> None:
    parent = _parent(tree, rng)
    if parent is not None:
        child = rng.choice(parent.children)
        few = len(list(child.walk())) > 20
        copies = [child.copy() for _ in range(1 if few else rng.choice((1, 1, 1, 2, 5, 40)))]
        at = rng.randint(0, len(parent.children))
        parent.children[at:at] = copies


def _move(tree: Node, rng: Random, _: Words) -> None:
    parent = _parent(tree, rng)
    if parent is not None:
        child = parent.children.pop(rng.randrange(len(parent.children)))
        target = _somewhere(tree, rng)
        target.children.insert(rng.randint(0, len(target.children)), child)


def _swap(tree: Node, rng: Random, _: Words) -> None:
    a, b = _parent(tree, rng), _parent(tree, rng)
    if a is not None and b is not None:
        i, j = rng.randrange(len(a.children)), rng.randrange(len(b.children))
        a.children[i], b.children[j] = b.children[j].copy(), a.children[i].copy()


def _rename(tree: Node, rng: Random, words: Words) -> None:
    _somewhere(tree, rng).tag = rng.choice((*words.tags, "x", "x:y", "Robot", "é", "a" * 500))


def _wrap(tree: Node, rng: Random, words: Words) -> None:
    parent = _parent(tree, rng)
    if parent is not None:
        at = rng.randrange(len(parent.children))
        parent.children[at] = Node(rng.choice(words.tags), children=[parent.children[at]])


def _plant(tree: Node, rng: Random, words: Words) -> None:
    """An element of another document."""
    target = _somewhere(tree, rng)
    target.children.insert(rng.randint(0, len(target.children)), rng.choice(words.elements).copy())


def _text(tree: Node, rng: Random, _: Words) -> None:
    node = _somewhere(tree, rng)
    node.text += rng.choice((*nasty.NAMES, *nasty.NUMBERS))


def _raw(tree: Node, rng: Random, _: Words) -> None:
    written = rng.choice(
        (*nasty.TEXTS, "<!-- a -- b -->", "<a>", "</a>", "<a b=c/>", "<a b='1' b='2'/>", "<![CDATA[<a>]]>")
    )
    _somewhere(tree, rng).children.append(Node("", raw=written))


def _deep(tree: Node, rng: Random, words: Words) -> None:
    tag, depth = rng.choice(words.tags), rng.choice((10, 100, 250, 257, 400, 3000))
    _somewhere(tree, rng).children.append(Node("", raw=f"<{tag}>" * depth + f"</{tag}>" * depth))


def _parent(tree: Node, rng: Random) -> Node | None:
    parents = [node for node in tree.walk() if node.children]
    return rng.choice(parents) if parents else None


_MUTATIONS = (
    *(_number, _number, _number, _number, _scale, _scale, _scale, _arity, _name, _name, _name, _path, _path),
    *(_known_value, _known_value, _known_value, _drop_attribute, _drop_attribute, _add_attribute, _rename_attribute),
    *(_swap_values, _swap_values, _drop, _drop, _drop, _double, _double, _move, _move, _swap, _swap, _rename, _rename),
    *(_wrap, _plant, _plant, _text, _raw, _deep, _many_attributes),
)
