"""Which Python expressions a xacro file may contain.

xacro forbids names that begin with ``__`` only in the outermost code object: a lambda or a comprehension is a code
object of its own and reaches ``().__class__.__base__.__subclasses__()`` and from there the operating system. So every
expression is parsed here first, and only a tree made of the nodes below is evaluated at all.
"""

from __future__ import annotations

import ast
from dataclasses import dataclass

_NODES = (
    ast.Expression,
    ast.BoolOp,
    ast.BinOp,
    ast.UnaryOp,
    ast.Compare,
    ast.IfExp,
    ast.Constant,
    ast.Name,
    ast.Attribute,
    ast.Subscript,
    ast.Slice,
    ast.Call,
    ast.keyword,
    ast.Starred,
    ast.List,
    ast.Tuple,
    ast.Dict,
    ast.Set,
    ast.ListComp,
    ast.SetComp,
    ast.DictComp,
    ast.GeneratorExp,
    ast.comprehension,
    ast.expr_context,
    ast.operator,
    ast.unaryop,
    ast.boolop,
    ast.cmpop,
)

# Attributes that lead from a value to the interpreter's own objects, the string methods that read attributes by their
# name, and what opens files and addresses from a block of XML, which an included file's namespace hands out.
_ATTRIBUTES = frozenset(
    {"format", "format_map", "mro", "createDOMBuilder"}
    | {f"{kind}_{part}" for kind in ("gi", "cr", "ag") for part in ("frame", "code", "yieldfrom", "await", "running")}
    | {"f_back", "f_builtins", "f_code", "f_globals", "f_locals", "tb_frame", "tb_next"}
)
# `vars` hands out a class's own dictionary, in which dunder names are plain keys; `type` hands out the classes. xacro
# exposes both in its namespace `python`; there they are replaced by a refusal, whatever expression leads to them.
FORBIDDEN_FUNCTIONS = ("vars", "type")


# Builtins that lead out of an expression. xacro offers none of them, but a file may define a property of such a name.
OUTSIDE = frozenset(
    {"breakpoint", "compile", "delattr", "eval", "exec", "exit", "getattr", "globals", "hasattr", "help", "input"}
    | {"locals", "memoryview", "object", "open", "quit", "setattr", "super", "type", "vars"}
)


@dataclass(frozen=True, slots=True)
class Refusal:
    """Why an expression is not evaluated. ``kind``: ``unsafe`` for what leads out of the language, ``construct`` for a part
    of Python that harms nobody by itself but is not looked into, ``outside`` for a function that xacro does not offer."""

    kind: str
    reason: str


def refusal(expression: str) -> Refusal | None:
    """Why an expression must not be evaluated, or None when it is harmless.

    A text that is no Python expression at all is not refused here: evaluating it only fails.
    """
    try:
        tree = ast.parse(expression.strip(), mode="eval")
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return None
    construct: Refusal | None = None
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and (node.attr.startswith("_") or node.attr in _ATTRIBUTES):
            return Refusal("unsafe", f"the attribute .{node.attr} leads out of xacro's language")
        if isinstance(node, ast.Name) and node.id.startswith("__"):
            return Refusal("unsafe", f"the name {node.id} leads out of xacro's language")
        if not isinstance(node, _NODES):
            construct = construct or Refusal("construct", _called(node))
    return construct


def names_in(expression: str) -> set[str]:
    """Every identifier that an expression mentions; of text that is no expression, every word in it."""
    try:
        tree = ast.parse(expression.strip(), mode="eval")
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return set(_words(expression))
    found = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
    found |= {node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute)}
    # An expression inside a string of an expression (xacro evaluates nested ${…}) counts as well.
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            found |= set(_words(node.value))
    return found


def _words(text: str) -> list[str]:
    word, words = "", []
    for character in text + " ":
        if character.isidentifier() or (word and character.isalnum()):
            word += character
        elif word:
            words.append(word)
            word = ""
    return words


def _called(node: ast.AST) -> str:
    names = {"Lambda": "a lambda", "JoinedStr": "an f-string", "NamedExpr": "an assignment (:=)", "Await": "await"}
    return names.get(type(node).__name__, f"a Python {type(node).__name__}")
