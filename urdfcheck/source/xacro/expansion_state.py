"""The state of an expansion: the place that is evaluated, the definitions that it reads, and the problems found there."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Any
from xml.dom import minidom

from urdfcheck.core import Location, Span
from urdfcheck.core.records import dataclass
from urdfcheck.source.text.problems import Problem
from urdfcheck.source.text.xml import Definition, SourceFile, XmlError, flatten_definitions
from urdfcheck.source.text.yaml.values import YamlKeyRead
from urdfcheck.source.xacro.expressions.compile_expression import ExpressionRefusedError
from urdfcheck.source.xacro.origins import get_origin

if TYPE_CHECKING:
    from yaml.nodes import MappingNode, ScalarNode

# The types of values that are shown to readers, and the longest such text.
_SHOWN_TYPES, _LONGEST_SHOWN = frozenset({str, int, float, bool}), 1_000
CYCLE = "include cycle"
# The kind of a definition that stands for a variable of the environment.
ENVIRONMENT = "environment"
# The attributes that decide what becomes part of the model.
_DECIDING = {"xacro:if": "value", "xacro:unless": "value", "xacro:include": "filename", "xacro:call": "macro"}
# Limit on elements, texts and comments that are visited, those of a macro once for each call: in a hundred robots the maximum
# is 21,000. Reading a file counts for several.
MAX_NODES = 200_000
NODES_OF_FILE = 100
# How much of a refused expression goes into the problem, and how much of xacro's message is read.
_MAX_EXPRESSION_SHOWN = 1_000
_MAX_MESSAGE_READ = 20_000


def describe_value(value: Any) -> str:
    """Return the value of a property or argument as a text for readers; empty for values that have no short one."""
    if type(value) not in _SHOWN_TYPES or (isinstance(value, int) and value.bit_length() > _LONGEST_SHOWN):
        return ""
    return str(value)[:_LONGEST_SHOWN]


class ExpansionStoppedError(Exception):
    """Ends the expansion with a problem of this kind and data."""

    def __init__(self, kind: str, message: str, **data: Any) -> None:
        super().__init__(message)
        self.kind = kind
        self.data = data


class YamlFileError(Exception):
    """A yaml file that cannot be read, and the place that yaml names; ``tag`` is set if this place asks for Python."""

    def __init__(self, file: str, reason: str, span: Span, *, tag: str = "") -> None:
        super().__init__(reason)
        self.file = file
        self.span = span
        self.tag = tag


class UnknownPackageError(Exception):
    """``$(find p)`` of an unknown package."""

    def __init__(self, name: str) -> None:
        super().__init__(f"package {name!r} is not found")
        self.name = name


@dataclass(slots=True)
class ActiveCall:
    """A macro call or an include that is being expanded."""

    node: minidom.Element
    span: Span | None
    name: str
    via: tuple[Span, ...]
    """The places of the calls and includes around it and its own, outermost first."""


class _FailureMemory:
    """Notes each exception that leaves a ``with`` block: there are ten thousand, and a generator takes three times as long."""

    def __init__(self, trace: ExpansionTrace) -> None:
        self.trace = trace

    def __enter__(self) -> None:
        pass

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is not None:
            self.trace.note_failure()


class ExpansionTrace:
    """The state of one expansion."""

    def __init__(self) -> None:
        self.problems: list[Problem] = []
        self._reported: set[tuple[str, Location, str]] = set()
        self.arguments_read: set[str] = set()
        self.argument_definitions: dict[str, Definition] = {}
        # The places of what conditions, texts and names of files read.
        self.loose_reads: set[Span] = set()
        self._loose_definitions: set[Definition] = set()
        # The attribute or element that is being evaluated, and the macro calls and includes around it.
        self.node: minidom.Element | None = None
        self.attribute: str | None = None
        self.calls: list[ActiveCall] = []
        # The keys of yaml files that texts read, by the text and the node of the key.
        self.key_reads: dict[tuple[Span, int], YamlKeyRead] = {}
        # The definitions that each evaluation in progress has read; the properties that are evaluated at their first use.
        self.readers: list[list[Definition]] = []
        self.has_read_environment = False
        self.resolving: list[Definition | None] = []
        # The state at the first failure.
        self.failed_at: Location | None = None
        self.failed_calls: list[ActiveCall] = []
        self.failed_reads: list[Definition] = []
        self.failed_extension = ""
        self._failure_memory = _FailureMemory(self)
        self.visited_nodes = 0
        self.times_called: Counter[str] = Counter()

    # -- place -------------------------------------------------------------------------------------------------

    def set_position(self, node: minidom.Element, attribute: str | None = None) -> None:
        """Note the element or attribute that is evaluated next."""
        self.node, self.attribute = node, attribute

    def set_text_position(self, text: str, parent: minidom.Element) -> None:
        """Note where a text comes from that is not an attribute of an ordinary element: a xacro tag, or between tags."""
        node = self.node
        if node is not None and node.attributes is not None:
            for name, value in node.attributes.items():
                if value == text:
                    self.set_position(node, name)
                    return
        self.set_position(parent)

    def list_call_spans(self) -> tuple[Span, ...]:
        """Return the macro calls and includes around the place, outermost first."""
        return self.calls[-1].via if self.calls else ()

    def begin_call(self, node: minidom.Element, name: str) -> None:
        """Note that a macro call or an include is expanded now."""
        origin = get_origin(node)
        around = self.list_call_spans()
        span = None if origin is None else origin.raw.span
        self.calls.append(ActiveCall(node, span, name, around if span is None else (*around, span)))

    def locate_current(self) -> Location:
        """Return the attribute or element that is being evaluated."""
        origin = get_origin(self.node)
        via = self.list_call_spans()
        if origin is None:
            return Location("", None, via)
        if via and self.calls[-1].node is self.node:
            via = via[:-1]  # the call itself is outside of the macro
        raw = origin.raw
        attribute = raw.attributes.get(self.attribute or "")
        if attribute is not None:
            return Location(attribute.location.subject, attribute.span, via)
        return Location(raw.subject, raw.span, via)

    def locate_cause(self) -> Location:
        """Return the current place; for a property that is evaluated at its first use, the place of its definition."""
        lazy = self.resolving[-1] if self.resolving else None
        return self.locate_current() if lazy is None or lazy.span is None else lazy.location

    def count_nodes(self, nodes: int) -> None:
        """Count visited nodes, of which a few macros that call each other twice make endlessly many.

        :raises ExpansionStoppedError: beyond :data:`MAX_NODES`.
        """
        self.visited_nodes += nodes
        if self.visited_nodes > MAX_NODES:
            name, times = self._find_busiest_macro()
            often = f"; macro {name} alone was called {times:,} times" if times > 1 else ""
            message = f"the model expands to more than {MAX_NODES:,} elements, texts and comments{often}"
            raise ExpansionStoppedError(
                "too-large", message, what="expansion", limit=MAX_NODES, found=self.visited_nodes
            )

    def _find_busiest_macro(self) -> tuple[str, int]:
        return next(iter(self.times_called.most_common(1)), ("", 0))

    # -- reads -------------------------------------------------------------------------------------------------

    def record_loose_reads(self, reads: Iterable[Definition]) -> None:
        """Note what something other than an attribute of the model was computed from."""
        queue = [definition for definition in reads if definition not in self._loose_definitions]
        while queue:
            definition = queue.pop()
            self._loose_definitions.add(definition)
            if definition.span is not None:
                self.loose_reads.add(definition.span)
            queue += [inner for inner in definition.reads if inner not in self._loose_definitions]

    def record_read(self, definition: Definition) -> None:
        """Note that the innermost evaluation reads a definition."""
        self.has_read_environment = self.has_read_environment or definition.kind == ENVIRONMENT
        if self.readers:
            self.readers[-1].append(definition)

    def record_key(self, source: SourceFile, mapping: MappingNode, key: ScalarNode) -> None:
        """Note that the text that is evaluated reads the value of a key of a yaml file."""
        lazy = self.resolving[-1] if self.resolving else None
        origin = get_origin(self.node)
        typed = None if origin is None else origin.raw.attributes.get(self.attribute or "")
        text = lazy.span if lazy is not None else None if typed is None else typed.span
        if text is not None:
            self.key_reads[text, id(key)] = YamlKeyRead(text, source, mapping, key)

    def record_argument_read(self, name: str, value: Any) -> None:
        """Note that an argument is read."""
        self.arguments_read.add(name)
        definition = self.argument_definitions.get(name)
        if definition is not None:
            if not definition.value:
                definition = self.argument_definitions[name] = replace(definition, value=describe_value(value))
            self.record_read(definition)

    def record_failed_read(self, definition: Definition) -> None:
        """Note for the evaluation around this one what it tried to read."""
        if len(self.readers) > 1:
            self.readers[-2].append(definition)
        else:
            self.failed_reads.append(definition)

    # -- failures ----------------------------------------------------------------------------------------------

    def remember_failure(self) -> _FailureMemory:
        """Remember the place of the first exception of the expansion."""
        return self._failure_memory

    def note_failure(self) -> None:
        """Note that the first exception of the expansion passes here."""
        if self.failed_at is None:
            self.failed_at = self.locate_current()
            self.failed_calls = list(self.calls)
            self.failed_reads += [d for reader in self.readers for d in reader]

    def forget_failure(self) -> None:
        """Forget a failure that did not end the expansion."""
        self.failed_at, self.failed_calls, self.failed_reads, self.failed_extension = None, [], [], ""

    def list_failed_calls(self) -> tuple[str, ...]:
        """Return the names of the macros and includes around the failure, outermost first."""
        return tuple(c.name for c in self.failed_calls)

    def report_problem(self, kind: str, message: str, location: Location, **data: Any) -> None:
        """Record a problem, with the definitions that led to the failure."""
        related = tuple(d.location for d in flatten_definitions(self.failed_reads) if d.span is not None)
        self.problems.append(Problem(kind=kind, message=message, location=location, data=data, related=related))

    def report_once(self, kind: str, message: str, location: Location, **data: Any) -> None:
        """Record a problem unless it was recorded at this place."""
        key = (kind, location, message)
        if key not in self._reported:
            self._reported.add(key)
            self.report_problem(kind, message, location, **data)

    def is_condition(self) -> bool:
        """Whether the value that is evaluated decides if something is part of the model."""
        return self.node is not None and _DECIDING.get(self.node.tagName) == self.attribute is not None

    def report_environment_decision(self, reads: Iterable[Definition]) -> None:
        """Record the variables of ROS by which the value that was just computed from ``reads`` decides."""
        if not self.has_read_environment:
            return
        seen: set[Definition] = set()
        queue = list(reads)
        while queue:
            definition = queue.pop()
            if definition.kind == ENVIRONMENT:
                self.report_once("environment-decides", definition.name, self.locate_cause(), variable=definition.name)
            elif definition not in seen:
                seen.add(definition)
                queue += definition.reads

    def report_limit(self, kind: str) -> None:
        """Record that the model's time or memory was used up, and what was being evaluated."""
        name, times = self._find_busiest_macro()
        doing = f"macro {name} was called repeatedly" if times > 1 else "one expression takes this long"
        self.report_problem(kind, doing, self.failed_at or self.locate_current(), macros=self.list_failed_calls())

    def report_failure(self, error: BaseException) -> None:
        """Record what ended the expansion, at the place where it was first raised."""
        import xacro.substitution_args as substitution

        at = self.failed_at or self.locate_current()
        message = _format_error(error)
        missing_argument: str | None = None
        cause: BaseException | None = error
        while cause is not None:
            if self._report_known_cause(cause, at):
                return
            if isinstance(cause, RecursionError):
                at, message = self._find_first_repetition(str(cause)) or (at, message)
            if isinstance(cause, substitution.ArgException):
                missing_argument = str(cause)
            if isinstance(cause, KeyError) and message.startswith(_format_error(cause)):
                message = f"there is no key {message}"  # Python's message is the key alone
            cause = getattr(cause, "exc", None) or cause.__cause__
        kind = "include-cycle" if message == CYCLE else "expansion-failed"
        self.report_problem(
            "argument-missing" if missing_argument else kind,
            message,
            at,
            argument=missing_argument,
            macros=self.list_failed_calls(),
            evaluated=self.failed_extension,
        )

    def _report_known_cause(self, cause: BaseException, at: Location) -> bool:
        """Record a failure that has its own kind of problem; return whether it has one."""
        via = tuple(c.span for c in self.failed_calls if c.span is not None)
        if isinstance(cause, ExpressionRefusedError):
            expression = cause.expression[:_MAX_EXPRESSION_SHOWN]
            self.report_problem("unsafe-expression", str(cause), at, expression=expression, refusal=cause.kind)
        elif isinstance(cause, ExpansionStoppedError):
            self.report_problem(cause.kind, str(cause), at, macros=self.list_failed_calls(), **cause.data)
        elif isinstance(cause, MemoryError):
            self.report_limit("memory-limit")
        elif isinstance(cause, UnknownPackageError):
            self.report_problem("package-not-found", str(cause), at, package=cause.name)
        elif isinstance(cause, XmlError):
            self.report_problem(cause.reason, str(cause), Location("", cause.span, via), **cause.data)
        elif isinstance(cause, YamlFileError):
            kind, data = "expansion-failed", {"reader": at, "file": cause.file}
            if cause.tag:
                kind, data = "unsafe-expression", {"reader": at, "expression": cause.tag, "refusal": "tag"}
            self.report_problem(kind, str(cause), Location("yaml", cause.span, via), **data)
        else:
            return False
        return True

    def _find_first_repetition(self, message: str) -> tuple[Location, str] | None:
        """Return the call that first closes the circle of an endless recursion, not the hundredth one; and the message."""
        spans = [c.span for c in self.failed_calls]
        again = next((i for i, span in enumerate(spans) if span in spans[:i]), None)
        if again is None:
            return None
        origin = get_origin(self.failed_calls[again].node)
        via = tuple(span for span in spans[:again] if span is not None)
        self.failed_calls = self.failed_calls[: again + 1]
        if message != CYCLE:
            message = "the expansion never ends: a macro calls itself"
        return Location("" if origin is None else origin.raw.subject, spans[again], via), message


def _format_error(error: BaseException) -> str:
    """Return xacro's message in one line, without the parts that the location repeats."""
    text = " ".join(str(error).split())[:_MAX_MESSAGE_READ] or repr(error)
    match = re.match(r"^<class '[^']+'>: (.*)$", text)
    text = match.group(1) if match else text
    # An exception that is wrapped in another repeats its whole message.
    half = len(text) // 2
    return text[:half] if text[:half] == text[half + 1 :] else text
