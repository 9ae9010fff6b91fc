"""The files that a launch file writes itself, with xacro in a shell or in Python, before it loads them."""

from __future__ import annotations

import ast
import itertools
import re
from collections.abc import Iterable, Iterator, Sequence

from urdfcheck.source.launch.python_texts import PythonTexts, find_call_argument, get_function_name
from urdfcheck.source.text.xml import Element

# What stands before the file that a command writes, and such words alone.
_BEFORE_OUTPUT = re.compile(r"(?:>|\s-o|--output)[\s=]*[\"']?$")
_OUTPUT_WORDS = frozenset({"-o", "--output", ">"})
_PLACE = re.compile(r"%[rs]|\{[^{}]*\}")
_WRITING_METHODS = frozenset({"write_bytes", "write_text"})


def list_written_expressions(nodes: Iterable[ast.AST], texts: PythonTexts) -> list[ast.expr]:
    """Return the paths that a Python launch file writes: ``f"xacro {model} > {path}"``, ``["xacro", model, "-o", path]``,
    ``open(path, "w")``."""
    found: list[ast.expr] = []
    for node in nodes:
        if isinstance(node, ast.Call):
            found += _list_opened(node, texts)
        if isinstance(node, (ast.List, ast.Tuple)):
            pairs = itertools.pairwise(node.elts)
            found += [path for word, path in pairs if (texts.evaluate(word) or "").strip() in _OUTPUT_WORDS]
        parts = _split_text(node)
        before = itertools.pairwise(parts)
        found += [
            path
            for text, path in before
            if isinstance(text, str) and isinstance(path, ast.expr) and _BEFORE_OUTPUT.search(text)
        ]
    return [followed for path in found if (followed := texts.follow_name(path)) is not None]


def _list_opened(call: ast.Call, texts: PythonTexts) -> Iterator[ast.expr]:
    name, owner = get_function_name(call), call.func
    if name == "open":
        mode = find_call_argument(call, 1, "mode")
        if mode is not None and set(texts.evaluate(mode) or "") & set("wxa"):
            yield from call.args[:1]
    elif name in _WRITING_METHODS and isinstance(owner, ast.Attribute):
        yield owner.value


def _split_text(node: ast.AST) -> Sequence[str | ast.expr]:
    """Return the literal texts and the expressions between them of which a text is made."""
    if isinstance(node, ast.JoinedStr):
        return [part.value if isinstance(part, ast.FormattedValue) else _get_text(part) for part in node.values]
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add):
        sides = [_split_text(side) or [_get_text(side)] for side in (node.left, node.right)]
        return [part for side in sides for part in side]
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mod):
        given = node.right.elts if isinstance(node.right, ast.Tuple) else [node.right]
        return _fill_in(_get_text(node.left), given)
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == "format":
        return _fill_in(_get_text(node.func.value), node.args)
    return []


def _fill_in(text: str | ast.expr, given: Sequence[ast.expr]) -> Sequence[str | ast.expr]:
    """Return a text with what is put in its places; nothing where their numbers differ."""
    literals = _PLACE.split(text) if isinstance(text, str) else []
    if len(literals) != len(given) + 1:
        return []
    return [part for pair in zip(literals, given, strict=False) for part in pair]


def _get_text(node: ast.expr) -> str | ast.expr:
    return node.value if isinstance(node, ast.Constant) and isinstance(node.value, str) else node


def writes_file(roots: Iterable[Element], name: str) -> bool:
    """Whether a command in the attributes of an XML launch file writes a file of this name: ``xacro … -o path``."""
    written = re.compile(
        rf"(?:>|\s-o|--output)[\s=]*[\"']?(?:\$\([^()]*\)|[^\s\"'<>|;&])*/{re.escape(name)}(?=$|[\s\"'|;&])"
    )
    values = (attribute.value for root in roots for element in root.walk() for attribute in element.attributes.values())
    return any(name in value and written.search(f" {value}") is not None for value in values)
