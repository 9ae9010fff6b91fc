"""Substitutions of XML launch files, as far as they are known without running anything."""

from __future__ import annotations

import ast
import fnmatch
import glob
import operator
import re
import shlex
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from urdfcheck.core.records import dataclass
from urdfcheck.source.launch.python_texts import MAX_LENGTH
from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.source.text.xml import Attribute, Element

_SUBSTITUTION = re.compile(r"\$\(([^()]*)\)")
_NESTED = re.compile(r"\$\([^()]*(?:\([^()]*\)[^()]*)*\)")
_ARGUMENT = re.compile(r"^\s*\$\((?:arg|var)\s+([^\s()]+)\s*\)\s*$")

_ANY_ARGUMENT = re.compile(r"\$\((?:arg|var)\s+([^\s()]+)\s*\)")
# An argument that is a word of a command line by itself.
_WORD = re.compile(r"(?<!\S)\$\((?:arg|var)\s+([^\s()]+)\s*\)(?!\S)")
# What roslaunch evaluates: the whole value, without other substitutions in it.
_EVALUATION = re.compile(r"\$\(eval\s+([^$]*)\)")
_LONGEST_CONDITION = 500
_COMPARISONS: dict[type[ast.cmpop], Callable[[Any, Any], Any]] = {
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.In: lambda one, other: one in other,
    ast.NotIn: lambda one, other: one not in other,
}


@dataclass(frozen=True, slots=True)
class UnresolvedReason:
    """Why a path of a launch file could not be resolved.

    ``kind``: package (``name`` is not found) | argument (``name`` has no value) |
    empty (``name``, which is to be the name of a file, is empty) | file (the path ``name`` does not exist) |
    relative (the path ``name`` leads to a file only from the folder of the launch file) |
    written (the path ``name`` is where programs and the setup of a computer write files, and may not be opened) |
    circle (the arguments refer to each other) | launch-time (the substitution ``name`` is only known at launch).
    """

    kind: str
    name: str = ""


# Arguments whose values refer to each other, one within the other: Python's stack ends at some 300.
MAX_NESTED = 100
# The value of an argument, or the reason why it is unknown.
Value = tuple[str | None, UnresolvedReason | None]


class SubstitutionResolver:
    """Resolves the substitutions of one launch file with the arguments that it gets."""

    def __init__(self, root: Element, path: Path, finder: PackageFinder, *, passed: Mapping[str, Value]) -> None:
        self.path = path
        self.finder = finder
        self.obstacle: UnresolvedReason | None = None
        self.values: dict[str, Attribute] = {}
        self.known: dict[str, Value] = dict(passed)
        self.pending: list[str] = []
        for element in root.walk():
            if element.tag in {"arg", "let"} and (element.parent is None or element.parent.tag != "include"):
                value = element.attributes.get("value") or element.attributes.get("default")
                if value is not None and element.get("name") not in passed and self.is_active(element):
                    self.values.setdefault(element.get("name"), value)

    def is_active(self, element: Element | None) -> bool:
        """Whether no ``if`` or ``unless`` on the element and around it excludes it, as far as their values are known."""
        while element is not None:
            for name, excluded in (("if", {"false", "0"}), ("unless", {"true", "1"})):
                if (self.resolve_condition(element.get(name)) or "").strip().lower() in excluded:
                    return False
            element = element.parent
        return True

    def has_known_conditions(self, element: Element | None) -> bool:
        """Whether the value of every ``if`` and ``unless`` on the element and around it is known."""
        while element is not None:
            if any(self.resolve_condition(element.get(name)) is None for name in ("if", "unless")):
                return False
            element = element.parent
        return True

    def resolve_condition(self, text: str) -> str | None:
        """Return the value of an ``if`` or ``unless``, or None if only the launch decides it.

        A comparison in ``$(eval …)`` is decided where all that it reads is known.
        """
        expression = _EVALUATION.fullmatch(text.strip())
        if expression is None:
            return self.resolve_text(text)
        value = evaluate_condition(expression[1], lambda name: self.resolve_text(f"$(arg {name})"))
        if value is None:
            self.obstacle = UnresolvedReason("launch-time", text.strip()[2:-1])
        return None if value is None else str(value)

    def resolve_value(self, text: str) -> Value:
        """Return the text with its substitutions resolved, or None and the reason."""
        self.obstacle = None
        value = self.resolve_text(text)
        return value, None if value is not None else self.obstacle

    def find_definition(self, attribute: Attribute) -> Attribute:
        """Return the attribute in which the value is typed, for one that only reads an argument."""
        for _ in range(len(self.values)):
            match = _ARGUMENT.match(attribute.value)
            if match is None or match.group(1) not in self.values:
                break
            attribute = self.values[match.group(1)]
        return attribute

    def inline_words(self, text: str) -> str:
        """Return a command line with those of its words that are arguments of several words as these are typed, and with those
        of its arguments whose values have quotes.

        The line is split, as a shell does it, after its arguments are substituted: the quotes of a value are taken away then.
        """
        return _ANY_ARGUMENT.sub(self._inline_quoted, _WORD.sub(self._inline_word, text))

    def _inline_word(self, word: re.Match[str]) -> str:
        name = word[1]
        typed = self.values[name].value if name in self.values else self.known.get(name, ("", None))[0]
        return typed if typed and len(typed.split()) > 1 and len(typed) <= MAX_LENGTH else word[0]

    def _inline_quoted(self, argument: re.Match[str]) -> str:
        value = self.resolve_text(argument[0]) or ""
        return value if ('"' in value or "'" in value) and len(value) <= MAX_LENGTH else argument[0]

    def find_empty_argument(self, text: str) -> str | None:
        """Return the first argument in a text whose value is empty, or the one that its value consists of; None without one."""
        for name in _ANY_ARGUMENT.findall(text):
            value, _ = self.resolve_value(f"$(arg {name})")
            if value is not None and not value.strip():
                return str(name)
        return None

    def resolve_text(self, text: str) -> str | None:
        """Return the text with its substitutions resolved, or None; then ``obstacle`` is the reason."""
        for _ in range(MAX_LENGTH):
            match = _SUBSTITUTION.search(text)
            if match is None or len(text) > MAX_LENGTH:
                break
            value = self._resolve_substitution(match.group(1).split())
            if value is None:
                return None
            text = text[: match.start()] + value + text[match.end() :]
        _, opened, rest = text.partition("$(")
        if opened:  # an expression that contains parentheses, or a text that grows without end
            self.obstacle = UnresolvedReason("launch-time", rest[:80])
            return None
        return text

    def _resolve_substitution(self, words: list[str]) -> str | None:
        verb, rest = (words[0], words[1:]) if words else ("", [])
        if verb in {"find", "find-pkg-share"} and len(rest) == 1:
            folder = self.finder.find(rest[0])
            if folder is None:
                self.obstacle = UnresolvedReason("package", rest[0])
            return None if folder is None else str(folder)
        if verb in {"arg", "var"} and len(rest) == 1:
            return self._resolve_argument(rest[0])
        if verb == "dirname":
            return str(self.path.absolute().parent)
        self.obstacle = UnresolvedReason("launch-time", " ".join(words))
        return None

    def _resolve_argument(self, name: str) -> str | None:
        if name not in self.values and name not in self.known:
            self.obstacle = UnresolvedReason("argument", name)
            return None
        if name in self.pending:
            self.obstacle = UnresolvedReason("circle")
            return None
        if name not in self.known and len(self.pending) >= MAX_NESTED:
            self.obstacle = UnresolvedReason("launch-time", f"arg {name}")
            return None
        if name not in self.known:  # once each: arguments that contain each other several times would never end
            self.pending.append(name)
            value = self.resolve_text(self.values[name].value)
            self.pending.pop()
            self.known[name] = (value, None if value is not None else self.obstacle)
        value, obstacle = self.known[name]
        self.obstacle = obstacle or self.obstacle
        return value


def evaluate_condition(expression: str, get_argument: Callable[[str], str | None]) -> bool | None:
    """Return whether the expression of ``$(eval …)`` is true, or None if that is not known: of comparisons of texts, numbers and
    arguments, joined by ``and``, ``or`` and ``not``. Nothing is executed.

    ``get_argument``: returns the value of an argument of the launch file, or None.
    """
    try:
        tree = ast.parse(expression, mode="eval") if len(expression) <= _LONGEST_CONDITION else None
        return None if tree is None else bool(_evaluate(tree.body, get_argument))
    except (SyntaxError, ValueError, TypeError, RecursionError, MemoryError):
        return None


def _evaluate(node: ast.expr, get_argument: Callable[[str], str | None]) -> Any:
    """Return the value of an expression.

    :raises ValueError: if it is not known.
    """
    match node:
        case ast.Constant(value=str() | int() | float() | bool()):
            return node.value
        case ast.Name():
            return _convert_argument(get_argument(node.id))
        case ast.Call(func=ast.Name(id="arg"), args=[ast.Constant(value=str() as name)], keywords=[]):
            return _convert_argument(get_argument(name))
        case ast.UnaryOp(op=ast.Not()):
            return not _evaluate(node.operand, get_argument)
        case ast.BoolOp():
            values = [bool(_evaluate(value, get_argument)) for value in node.values]
            return all(values) if isinstance(node.op, ast.And) else any(values)
        case ast.List() | ast.Tuple():
            return [_evaluate(element, get_argument) for element in node.elts]
        case ast.Compare():
            values = [_evaluate(value, get_argument) for value in (node.left, *node.comparators)]
            if all(type(comparison) in _COMPARISONS for comparison in node.ops):
                pairs = zip(node.ops, values[:-1], values[1:], strict=True)
                return all(_COMPARISONS[type(comparison)](one, other) for comparison, one, other in pairs)
    raise ValueError


def _convert_argument(text: str | None) -> str | int | float | bool:
    """Return the value of an argument as roslaunch hands it to an expression: ``1`` is a number, and ``true`` is True.

    :raises ValueError: if it is not known.
    """
    if text is None:
        raise ValueError
    text = text.strip()
    try:
        return float(text) if "." in text else int(text)
    except ValueError:
        return text.lower() == "true" if text.lower() in {"true", "false"} else text


def split_substitutions(text: str) -> list[str]:
    """Return what is typed of a text around its substitutions."""
    return re.split(r"\$\([^()]*\)", text)


def may_become(typed: str, text: str) -> bool:
    """Whether a text may be what is left of a typed one when its substitutions have values: ``$(arg robot)_ip``."""
    # A regular expression takes exponential time for many of them.
    return fnmatch.fnmatchcase(text, "*".join(map(glob.escape, split_substitutions(typed))))


def split_command(text: str) -> tuple[str, ...]:
    """Return the words of a command line; a substitution is part of one word."""
    # $(find pkg) contains a blank: each substitution stays together while the shell's quotes are parsed.
    protected = _NESTED.sub(lambda m: m.group(0).replace(" ", "\0"), text)
    try:
        words = shlex.split(protected)
    except ValueError:
        words = protected.split()
    return tuple(w.replace("\0", " ") for w in words)
