"""Which Python expressions a xacro file may contain, and their code with a guard around each step.

xacro forbids names that begin with ``__`` only in the outermost code object: a lambda or a comprehension is a code
object of its own and reaches ``().__class__.__base__.__subclasses__()`` and from there the operating system. So every
expression is parsed here first, and only a tree made of the nodes below is evaluated. The type and size of values are only
known at run time: each operation is a call of a guard (:mod:`urdfcheck.source.xacro.expressions.guards`), under a name that no
expression can spell.
"""

from __future__ import annotations

import ast
import warnings
from collections.abc import Iterator
from functools import lru_cache
from types import CodeType
from typing import TypeVar

# Of 6,000 expressions of published robots the longest has 166 characters.
MAX_TEXT = 20_000
MAX_DEPTH = 150

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

# Attributes that lead from a value to the interpreter's own objects. The guards refuse all of them; here they are refused
# even in branches that are not evaluated.
_ATTRIBUTES = frozenset(
    {"format_map", "mro", "createDOMBuilder"}
    | {f"{kind}_{part}" for kind in ("gi", "cr", "ag") for part in ("frame", "code", "yieldfrom", "await", "running")}
    | {"f_back", "f_builtins", "f_code", "f_globals", "f_locals", "tb_frame", "tb_next"}
)

# Builtins that lead out of an expression. xacro does not offer them, but a file may define a property of such a name.
FORBIDDEN_BUILTINS = frozenset(
    {"breakpoint", "compile", "delattr", "eval", "exec", "exit", "getattr", "globals", "hasattr", "help", "input"}
    | {"locals", "memoryview", "object", "open", "quit", "setattr", "super", "type", "vars"}
)

_CONSTANTS = (str, int, float, complex, bool, type(None), type(...))
_TARGETS = (ast.Name, ast.Tuple, ast.List, ast.Starred)
_GUARDED = {
    ast.Add: "@add",
    ast.Mult: "@multiply",
    ast.Pow: "@power",
    ast.LShift: "@shift",
    ast.Mod: "@modulo",
    ast.Sub: "@subtract",
    ast.BitOr: "@either",
    ast.BitAnd: "@both",
    ast.BitXor: "@differ",
}
_Node = TypeVar("_Node", bound=ast.AST)


class ExpressionRefusedError(Exception):
    """An expression that must not be evaluated, or not further.

    ``kind``: ``unsafe`` if it leads out of the language, ``construct`` for a harmless part of Python that is not supported,
    ``method`` for a method that is not known to be harmless, ``outside`` for a function that xacro does not offer,
    ``too_large`` if it would take unbounded memory or time, ``varies`` if its value is another in each process.
    """

    def __init__(self, kind: str, reason: str, expression: str = "") -> None:
        super().__init__(reason)
        self.kind = kind
        self.expression = expression


@lru_cache(maxsize=4096)
def compile_expression(expression: str) -> CodeType:
    """Return the code of an expression, in which every step goes through a guard.

    :raises ExpressionRefusedError: if it must not be evaluated.
    :raises SyntaxError: if it is not an expression.
    """
    tree = _parse_expression(expression)
    refusal = _find_refusal(tree)
    if refusal is not None:
        raise refusal
    try:
        return compile(ast.fix_missing_locations(_GuardInserter().visit(tree)), "<expression>", "eval")
    except (RecursionError, MemoryError):
        raise _make_depth_error() from None


def _parse_expression(expression: str) -> ast.Expression:
    text = expression.strip()
    if len(text) > MAX_TEXT:
        raise ExpressionRefusedError("too_large", f"it has {len(text):,} characters, more than {MAX_TEXT:,}")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # such as that of `1if x else 2`: not for the terminal
            tree = ast.parse(text, "<expression>", mode="eval")
    except (RecursionError, MemoryError):  # Python's parser has its own limits
        raise _make_depth_error() from None
    except ValueError as error:  # a zero byte, or a number of more digits than Python reads
        raise SyntaxError(str(error)) from None
    level: list[ast.AST] = [tree]
    depth = 0
    while level:
        if depth == MAX_DEPTH:
            raise _make_depth_error()
        level = [child for node in level for child in ast.iter_child_nodes(node)]
        depth += 1
    return tree


def _make_depth_error() -> ExpressionRefusedError:
    return ExpressionRefusedError("too_large", f"it is nested more than {MAX_DEPTH} deep")


def _find_refusal(tree: ast.Expression) -> ExpressionRefusedError | None:
    """Return why a tree must not be evaluated; a way out of the language takes precedence over an unsupported construct."""
    construct: ExpressionRefusedError | None = None
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and (node.attr.startswith("_") or node.attr in _ATTRIBUTES):
            return ExpressionRefusedError("unsafe", f"the attribute .{node.attr} is not part of xacro's language")
        if isinstance(node, ast.Name) and node.id.startswith("__"):
            return ExpressionRefusedError("unsafe", f"the name {node.id} is not part of xacro's language")
        unsupported = _describe_unsupported(node)
        if unsupported:
            construct = construct or ExpressionRefusedError("construct", unsupported)
    return construct


def _describe_unsupported(node: ast.AST) -> str:
    """Describe a node that is not part of xacro's language; return an empty text for one that is."""
    if (
        isinstance(node, ast.Compare)
        and len(node.ops) > 1
        and any(isinstance(op, (ast.Is, ast.IsNot)) for op in node.ops)
    ):
        return "`is` in a chain of comparisons"
    if not isinstance(node, _NODES):
        names = {"Lambda": "a lambda", "JoinedStr": "an f-string", "NamedExpr": "an assignment (:=)", "Await": "await"}
        return names.get(type(node).__name__, f"a Python {type(node).__name__}")
    if isinstance(node, ast.Constant) and not isinstance(node.value, _CONSTANTS):
        return f"a {type(node.value).__name__}"
    if isinstance(node, ast.comprehension):
        if node.is_async:
            return "async"
        if not all(isinstance(n, (*_TARGETS, ast.expr_context)) for n in ast.walk(node.target)):
            return "a loop that assigns to something other than names"
    return ""


class _GuardInserter(ast.NodeTransformer):
    """Replaces each operation whose effect depends on the values by a call of a guard."""

    def visit_BinOp(self, node: ast.BinOp) -> ast.AST:
        guard = _GUARDED.get(type(node.op))
        node = self._visit_children(node)
        return node if guard is None else _make_guard_call(guard, node.left, node.right)

    def visit_Attribute(self, node: ast.Attribute) -> ast.AST:
        node = self._visit_children(node)
        return _make_guard_call("@attribute", node.value, ast.Constant(node.attr))

    def visit_Subscript(self, node: ast.Subscript) -> ast.AST:
        node = self._visit_children(node)
        return _make_guard_call("@item", node.value, node.slice)

    def visit_Slice(self, node: ast.Slice) -> ast.AST:
        node = self._visit_children(node)
        return _make_guard_call("@slice", *(part or ast.Constant(None) for part in (node.lower, node.upper, node.step)))

    def visit_Call(self, node: ast.Call) -> ast.AST:
        node = self._visit_children(node)
        for keyword in node.keywords:
            if keyword.arg is None:
                keyword.value = _make_guard_call("@mapping", keyword.value)
        return ast.Call(_make_name("@call"), [node.func, *node.args], node.keywords)

    def visit_Compare(self, node: ast.Compare) -> ast.AST:
        node = self._visit_children(node)
        if len(node.ops) == 1 and isinstance(node.ops[0], (ast.Is, ast.IsNot)):
            same = _make_guard_call("@identical", node.left, node.comparators[0])
            return same if isinstance(node.ops[0], ast.Is) else ast.UnaryOp(ast.Not(), same)
        if len(node.ops) == 1 and isinstance(node.ops[0], (ast.Eq, ast.NotEq)):
            # No path of a file is equal to such a word: the comparison says nothing of the place.
            if _is_bare_word(node.comparators[0]):
                node.left = _make_guard_call("@comparable", node.left)
                return node
            if _is_bare_word(node.left):
                node.comparators = [_make_guard_call("@comparable", node.comparators[0])]
                return node
        sides = zip([None, *node.ops], [*node.ops, None], [node.left, *node.comparators], strict=True)
        node.left, *node.comparators = [_guard_compared(operand, before, after) for before, after, operand in sides]
        return node

    def visit_Starred(self, node: ast.Starred) -> ast.AST:
        node = self._visit_children(node)
        if isinstance(node.ctx, ast.Load):
            node.value = _make_guard_call("@iterable", node.value)
        return node

    def visit_comprehension(self, node: ast.comprehension) -> ast.AST:
        spread = not isinstance(node.target, ast.Name)
        node = self._visit_children(node)
        node.iter = _make_guard_call("@unpacked" if spread else "@iterable", node.iter)
        return node

    def visit_Set(self, node: ast.Set) -> ast.AST:
        node = self._visit_children(node)
        node.elts = [e if isinstance(e, ast.Starred) else _guard_operand(e) for e in node.elts]
        return node

    def visit_SetComp(self, node: ast.SetComp) -> ast.AST:
        node = self._visit_children(node)
        node.elt = _guard_operand(node.elt)
        return node

    def visit_Dict(self, node: ast.Dict) -> ast.AST:
        node = self._visit_children(node)
        node.values = [
            value if key is not None else _make_guard_call("@mapping", value)
            for key, value in zip(node.keys, node.values, strict=True)
        ]
        node.keys = [None if key is None else _guard_operand(key) for key in node.keys]
        return node

    def visit_DictComp(self, node: ast.DictComp) -> ast.AST:
        node = self._visit_children(node)
        node.key = _guard_operand(node.key)
        return node

    def _visit_children(self, node: _Node) -> _Node:
        self.generic_visit(node)
        return node


def _make_name(name: str) -> ast.Name:
    return ast.Name(name, ast.Load())


def _make_guard_call(guard: str, *arguments: ast.expr) -> ast.Call:
    return ast.Call(_make_name(guard), list(arguments), [])


def _guard_operand(node: ast.expr) -> ast.expr:
    return node if isinstance(node, ast.Constant) else _make_guard_call("@measured", node)


def _is_bare_word(node: ast.expr) -> bool:
    """Whether it is a literal text without a separator of folders, such as the empty one."""
    return isinstance(node, ast.Constant) and isinstance(node.value, str) and not set("/\\") & set(node.value)


def _guard_compared(node: ast.expr, before: ast.cmpop | None, after: ast.cmpop | None) -> ast.expr:
    """Guard an operand of a comparison by the operators on both sides; a container on the right of ``in`` may be an iterator."""
    # A path that xacro has put into the expression is a constant too.
    if isinstance(node, ast.Constant) and not (isinstance(node.value, str) and "/" in node.value):
        return node
    contains = isinstance(before, (ast.In, ast.NotIn)) and after is None
    return _make_guard_call("@measured" if contains else "@compared", node)


@lru_cache(maxsize=4096)  # several rules read the same files
def find_names(expression: str) -> frozenset[str]:
    """Return every identifier that an expression mentions; if the text is not an expression, every word in it."""
    try:
        tree = _parse_expression(expression)
    except (SyntaxError, ExpressionRefusedError):
        return frozenset(_iter_identifiers(expression))
    names: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Name):
            names.add(node.id)
        elif isinstance(node, ast.Attribute):
            names.add(node.attr)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            # An expression inside a string of an expression (xacro evaluates nested ${…}) counts as well.
            names.update(_iter_identifiers(node.value))
    return frozenset(names)


def _iter_identifiers(text: str) -> Iterator[str]:
    word = ""
    for character in text + " ":
        if character.isidentifier() or (word and character.isalnum()):
            word += character
        elif word:
            yield word
            word = ""
