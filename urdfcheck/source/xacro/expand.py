"""Expanding xacro without ROS, with a record of where everything was typed.

The PyPI package ``xacro`` does the expansion; its functions are wrapped while one file is expanded, so that each
element of the result carries its :class:`Origin` and each property, argument and macro parameter its
:class:`~urdfcheck.source.text.xml.Definition`. The expanded document is the one that plain xacro gives, to the byte.

xacro keeps its state in module globals: one expansion at a time in a process.
"""

from __future__ import annotations

import builtins
import fnmatch
import os
import re
import sys
import warnings
from collections import ChainMap, Counter
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, field, replace
from glob import has_magic
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from xml.dom import UserDataHandler, minidom
from xml.parsers import expat

from urdfcheck.core import Location, Span
from urdfcheck.core.errors import ModelTimeout
from urdfcheck.source.package.finder import PackageFinder, format_path
from urdfcheck.source.text.problems import Problem
from urdfcheck.source.text.xml import (
    Attribute,
    Definition,
    Element,
    SourceFile,
    XmlError,
    find_unbound_prefix,
    flatten_definitions,
    parse_xml,
)
from urdfcheck.source.xacro.expressions import FORBIDDEN_BUILTINS, ExpressionRefusedError, compile_expression
from urdfcheck.source.xacro.guards import Guards
from urdfcheck.source.xacro.macro_parameters import parse_next_parameter

_USER_DATA_KEY = "urdfcheck"
# Each frame of xacro's own recursion comes with one or two of ours: a chain of macros that plain xacro expands must fit.
_RECURSION_FACTOR = 3
# A file that is included by what it includes itself is a circle; a few times around, its own conditions may still end it.
_MAX_INCLUDED = 4
_CYCLE = "include cycle"
# Elements, texts and comments that are gone through, those of a macro once for each call: of a hundred robots none has
# more than 21,000. Reading a file counts for several.
MAX_NODES = 200_000
_NODES_OF_FILE = 100
# What ends a name where a document is read again.
_INVALID_NAME = re.compile(r"""[\s<>&"'=/]""")
# How much of an expression that is refused goes into the problem, and how much of xacro's words is looked at.
_MAX_EXPRESSION_SHOWN = 1_000
_MAX_MESSAGE_READ = 20_000
# What a file may read of the environment: the same for everybody who builds it for one distribution of ROS.
READABLE_ENVIRONMENT = frozenset({"ROS_DISTRO", "ROS_PYTHON_VERSION", "ROS_VERSION"})


@dataclass(slots=True, eq=False)
class Origin:
    """Where a node of the document was typed. ``via`` is set when the node is evaluated."""

    raw: Element
    via: tuple[Span, ...] | None = None
    reads: dict[str, tuple[Definition, ...]] = field(default_factory=dict)
    added: dict[str, Attribute] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Expansion:
    """The outcome: ``root`` is None when it failed, and ``problems`` says why."""

    root: Element | None
    document: minidom.Document | None
    files: Mapping[str, SourceFile]
    trees: Mapping[str, Element]
    problems: tuple[Problem, ...]
    arguments_read: frozenset[str]


class _ExpansionStoppedError(Exception):
    """What ends the expansion as a problem of its own kind, with its data."""

    def __init__(self, kind: str, message: str, **data: Any) -> None:
        super().__init__(message)
        self.kind = kind
        self.data = data


class _YamlFileError(Exception):
    """A yaml file that cannot be read, at the place in it that yaml names; ``tag`` when this asks for Python."""

    def __init__(self, file: str, reason: str, span: Span, tag: str = "") -> None:
        super().__init__(reason)
        self.file = file
        self.span = span
        self.tag = tag


class _InvalidOutputError(Exception):
    """What would be expanded cannot be written as XML."""

    def __init__(self, message: str, location: Location) -> None:
        super().__init__(message)
        self.location = location


class _UnknownPackageError(Exception):
    """``$(find p)`` of an unknown package."""

    def __init__(self, name: str) -> None:
        super().__init__(f"package {name!r} is not found")
        self.name = name


def expand_xacro(
    path: Path, arguments: Mapping[str, str], finder: PackageFinder, extra_environment: frozenset[str] = frozenset()
) -> Expansion:
    """Expand a xacro file with the given arguments. Never raises for what the file contains.

    ``environment`` names the variables that the file may read beside those of ROS.
    """
    tracer = _Tracer(path, finder, extra_environment)
    document: minidom.Document | None = None
    root: Element | None = None
    with tracer.install_wrappers():
        import xacro

        try:
            document = xacro.process_file(str(path), mappings=_TracedArguments(arguments, tracer.record_argument_read))
            assert document is not None
            assert document.documentElement is not None
            root = _convert_node(document.documentElement, None)
        except ModelTimeout:
            tracer.report_limit("time-limit")
        except _InvalidOutputError as error:
            tracer.report_problem(
                "expansion-failed", str(error), error.location, macros=(), argument=None, evaluated=""
            )
        except Exception as error:  # whatever a stranger's expression raises is a finding, not a crash
            tracer.report_failure(tracer.format_error(error), error)
    return Expansion(
        root=root,
        document=document if root is not None else None,
        files=tracer.files,
        trees=tracer.trees,
        problems=tuple(tracer.problems),
        arguments_read=frozenset(tracer.arguments_read),
    )


@dataclass(slots=True)
class _ActiveCall:
    """A macro call or an include that is being expanded."""

    node: minidom.Element
    span: Span | None
    name: str


@dataclass(slots=True)
class _ElementFrame:
    """An element whose attributes are being evaluated: their names in the order in which xacro takes them."""

    node: minidom.Element
    pending: list[str]


class _Tracer:
    """The wrappers around xacro's functions, and what they learn."""

    def __init__(self, path: Path, finder: PackageFinder, environment: frozenset[str]) -> None:
        self.path = path
        self.finder = finder
        self.environment = environment
        self.files: dict[str, SourceFile] = {}
        self.trees: dict[str, Element] = {}
        self.problems: list[Problem] = []
        self.arguments_read: set[str] = set()
        self.calls: list[_ActiveCall] = []
        self.frames: list[_ElementFrame] = []
        self.readers: list[list[Definition]] = []
        self.resolving: list[Definition | None] = []
        self.argument_definitions: dict[str, Definition] = {}
        self.node: minidom.Element | None = None
        self.attribute: str | None = None
        self.evaluating = 0
        self.last_reads: tuple[Definition, ...] = ()
        self.defining: tuple[str, Span | None] | None = None
        self.defaulting: Attribute | None = None
        self.adding: tuple[minidom.Element, list[str]] | None = None
        self.failed_at: Location | None = None
        self.failed_calls: list[_ActiveCall] = []
        self.failed_reads: list[Definition] = []
        self.failed_extension = ""
        self.guards: Guards
        self.symbols: dict[str, Any]
        self.nodes = 0
        self.called: Counter[str] = Counter()
        self.ignored: set[tuple[str, Location]] = set()

    # -- reporting ---------------------------------------------------------------------------------------------

    def report_problem(self, kind: str, message: str, location: Location, **data: Any) -> None:
        related = tuple(d.location for d in flatten_definitions(self.failed_reads) if d.span is not None)
        self.problems.append(Problem(kind=kind, message=message, location=location, data=data, related=related))

    def list_call_spans(self) -> tuple[Span, ...]:
        return tuple(c.span for c in self.calls if c.span is not None)

    def locate_current(self) -> Location:
        """The attribute or element that is being evaluated."""
        origin = _get_origin(self.node)
        via = self.list_call_spans()
        if origin is None:
            return Location("", None, via)
        if via and self.calls[-1].node is self.node:
            via = via[:-1]  # the call itself stands outside of what it calls
        raw = origin.raw
        attribute = raw.attributes.get(self.attribute or "")
        if attribute is not None:
            return Location(attribute.location.subject, attribute.span, via)
        return Location(raw.subject, raw.span, via)

    def locate_cause(self) -> Location:
        """Like :meth:`locate_current`, but of a property that is evaluated at its first use: where it is defined."""
        lazily = self.resolving[-1] if self.resolving else None
        return self.locate_current() if lazily is None or lazily.span is None else lazily.location

    def report_limit(self, kind: str) -> None:
        """Record that the time or the memory for the model was over, and what was going on."""
        name, times = next(iter(self.called.most_common(1)), ("", 0))
        doing = f"macro {name} was called over and over" if times > 1 else "an expression takes that long"
        self.report_problem(kind, doing, self.failed_at or self.locate_current(), macros=self.list_failed_calls())

    def report_failure(self, message: str, error: BaseException) -> None:
        """Record what stopped the expansion, at the place where it was first raised."""
        at = self.failed_at or self.locate_current()
        import xacro.substitution_args as substitution

        missing: str | None = None
        cause: BaseException | None = error
        while cause is not None:
            if isinstance(cause, ExpressionRefusedError):
                self.report_problem(
                    "unsafe-expression",
                    str(cause),
                    at,
                    expression=cause.expression[:_MAX_EXPRESSION_SHOWN],
                    refusal=cause.kind,
                )
                return
            if isinstance(cause, _ExpansionStoppedError):
                self.report_problem(cause.kind, str(cause), at, macros=self.list_failed_calls(), **cause.data)
                return
            if isinstance(cause, MemoryError):
                self.report_limit("memory-limit")
                return
            if isinstance(cause, _UnknownPackageError):
                self.report_problem("package-not-found", str(cause), at, package=cause.name)
                return
            if isinstance(cause, XmlError):
                via = tuple(c.span for c in self.failed_calls if c.span is not None)
                self.report_problem(cause.reason, str(cause), Location("", cause.span, via), **cause.data)
                return
            if isinstance(cause, _YamlFileError):
                via = tuple(c.span for c in self.failed_calls if c.span is not None)
                kind, data = "expansion-failed", {"reader": at, "file": cause.file}
                if cause.tag:
                    kind, data = "unsafe-expression", {"reader": at, "expression": cause.tag, "refusal": "tag"}
                self.report_problem(kind, str(cause), Location("yaml", cause.span, via), **data)
                return
            if isinstance(cause, RecursionError):
                at, message = self.find_first_repetition(str(cause)) or (at, message)
            if isinstance(cause, substitution.ArgException):
                missing = str(cause)
            cause = getattr(cause, "exc", None) or cause.__cause__
        failed = "include-cycle" if message == _CYCLE else "expansion-failed"
        self.report_problem(
            "argument-missing" if missing else failed,
            message,
            at,
            argument=missing,
            macros=self.list_failed_calls(),
            evaluated=self.failed_extension,
        )

    def list_failed_calls(self) -> tuple[str, ...]:
        return tuple(c.name for c in self.failed_calls)

    def find_first_repetition(self, message: str) -> tuple[Location, str] | None:
        """Of a recursion without end: the call that closes the circle for the first time, not the hundredth."""
        spans = [c.span for c in self.failed_calls]
        again = next((i for i, span in enumerate(spans) if span in spans[:i]), None)
        if again is None:
            return None
        origin = _get_origin(self.failed_calls[again].node)
        via = tuple(span for span in spans[:again] if span is not None)
        self.failed_calls = self.failed_calls[: again + 1]
        if message != _CYCLE:
            message = "the expansion never ends: a macro calls itself"
        return Location("" if origin is None else origin.raw.subject, spans[again], via), message

    def format_error(self, error: BaseException) -> str:
        """xacro's own words in one line, without what the location already says."""
        text = " ".join(str(error).split())[:_MAX_MESSAGE_READ] or repr(error)
        match = re.match(r"^<class '[^']+'>: (.*)$", text)
        text = match.group(1) if match else text
        # An exception wrapped in another says everything twice.
        half = len(text) // 2
        return text[:half] if text[:half] == text[half + 1 :] else text

    # -- installation ------------------------------------------------------------------------------------------

    @contextmanager
    def install_wrappers(self) -> Iterator[None]:
        """xacro with our wrappers, for the duration of one expansion."""
        import xacro
        import xacro.substitution_args as substitution

        with ExitStack() as stack:

            def patch(target: Any, name: str, wrapper: Any) -> None:
                stack.enter_context(_replace_attribute(target, name, wrapper))

            for name in (
                "parse",
                "eval_all",
                "eval_text",
                "eval_extension",
                "safe_eval",
                "handle_macro_call",
                "process_include",
                "grab_property",
                "grab_macro",
                "import_xml_namespaces",
                "eval_default_arg",
                "check_attrs",
                "reqd_attrs",
            ):
                patch(xacro, name, getattr(self, name)(getattr(xacro, name)))
            patch(xacro, "warning", self.warning)
            patch(xacro, "message", _make_silent("message"))
            patch(xacro, "error", _make_silent("error"))
            patch(xacro, "print_location", _make_silent("print_location"))
            patch(xacro, "load_yaml", self.load_yaml)
            patch(xacro, "parse_macro_arg", parse_next_parameter)
            patch(xacro, "is_valid_name", _limit_property_names(xacro.is_valid_name))
            patch(xacro, "glob", SimpleNamespace(glob=self.find_matching_files))
            patch(xacro.Table, "_setitem", self.wrap_set_item(xacro.Table._setitem))
            patch(xacro.Table, "_resolve_", self.wrap_resolve(xacro.Table._resolve_))
            patch(substitution, "_eval_find", self.find_package)
            patch(substitution, "_eval_env", self.read_environment)
            patch(substitution, "_eval_optenv", self.read_optional_environment)
            patch(substitution, "_eval", self.evaluate_extension)
            patch(xacro, "root_dir", os.curdir)
            patch(xacro, "filestack", None)
            patch(xacro, "macrostack", None)
            patch(xacro, "all_includes", [])
            # $(dirname) of the file that is being read; plain xacro's command line leaves it unset.
            patch(xacro, "substitution_args_context", _SubstitutionContext(lambda: self.get_current_file()))
            self._xacro = xacro
            self.guards = Guards(xacro.Table)
            self.symbols = xacro.create_global_symbols()
            dict.__setitem__(self.symbols["xacro"], "arg", self.get_argument)
            self.guards.guard_symbols(self.symbols)
            patch(xacro, "_global_symbols", self.symbols)
            # What Python thinks of a stranger's expression (`1 is 1`, "\\d") is nothing for the terminal.
            stack.enter_context(warnings.catch_warnings())
            warnings.simplefilter("ignore")
            stack.callback(sys.setrecursionlimit, sys.getrecursionlimit())
            sys.setrecursionlimit(_RECURSION_FACTOR * sys.getrecursionlimit())
            yield

    def get_current_file(self) -> str:
        stack = self._xacro.filestack
        return str(stack[-1] if stack else self.path)

    def get_argument(self, name: str) -> Any:
        """``xacro.arg(name)`` of expressions, which plain xacro answers with a bare KeyError when there is none."""
        import xacro.substitution_args as substitution

        values = self._xacro.substitution_args_context["arg"]
        if name not in values:
            raise substitution.ArgException(name)
        return values[name]

    # -- files -------------------------------------------------------------------------------------------------

    def parse(self, original: Callable[..., Any]) -> Callable[..., Any]:
        def parse_located(inp: Any, filename: str | None = None) -> Any:
            if inp is not None or filename is None:
                return original(inp, filename)
            path = Path(filename)
            name = format_path(path)
            self.count_nodes(_NODES_OF_FILE)
            self.ensure_reach(path)
            try:
                source = SourceFile.read(path, name)
            except OSError as error:
                self._xacro.filestack.pop()
                raise self._xacro.XacroException(f"{error.strerror}: {error.filename}", exc=error) from error
            tree = parse_xml(source)
            prefixed = find_unbound_prefix(tree)
            if prefixed is not None:
                element, prefix = prefixed
                assert element.span is not None
                raise XmlError("prefix", f"the prefix {prefix!r} is not declared (xmlns:{prefix}=…)", element.span)
            self.files[name] = source
            self.trees[name] = tree
            try:
                document = minidom.parseString(source.text)
            except expat.ExpatError as error:  # namespaces, which the located tree leaves alone
                at = source.locate_character(error.lineno, error.offset + 1)
                raise XmlError("malformed", expat.ErrorString(error.code), at) from error
            assert document.documentElement is not None
            _attach_origins(document.documentElement, tree)
            return document

        return parse_located

    def ensure_reach(self, path: Path) -> None:
        if not self.finder.can_open(path):
            name = format_path(path)
            raise _ExpansionStoppedError("out-of-reach", f"{name} lies outside of what may be read", path=name)

    def find_matching_files(self, pattern: str) -> list[str]:
        """The files that a pattern names, as glob finds them; in no folder that is out of reach is looked at all."""
        found = [""]
        for part in Path(pattern).parts:
            inner: list[str] = []
            for folder in found:
                if not has_magic(part):
                    inner.append(os.path.join(folder, part))
                    continue
                self.ensure_reach(Path(folder or os.curdir))
                names = [
                    n for n in _list_file_names(folder or os.curdir) if part.startswith(".") or not n.startswith(".")
                ]
                self.count_nodes(len(names))
                inner += [os.path.join(folder, n) for n in fnmatch.filter(names, part)]
            found = inner
        for path in found:
            self.ensure_reach(Path(path))  # before it is looked whether it exists
        return [path for path in found if os.path.lexists(path)]

    def load_yaml(self, filename: str) -> Any:
        """A yaml file's content in xacro's wrappers, which report what is read of it."""

        from urdfcheck.source.text.yaml import YamlReadError
        from urdfcheck.source.xacro.yaml_values import read_yaml

        path = Path(self._xacro.abs_filename_spec(filename))
        self.count_nodes(_NODES_OF_FILE)
        self.ensure_reach(path)
        name = format_path(path)
        self._xacro.filestack.append(filename)
        try:
            return read_yaml(SourceFile.read(path, name), self.record_read, self.evaluate_yaml_number)
        except YamlReadError as problem:
            raise _YamlFileError(name, str(problem), problem.span, problem.tag) from problem
        except XmlError as error:
            if error.reason == "too-large":
                raise
            raise _YamlFileError(name, str(error), error.span) from error
        except (self._xacro.XacroException, ExpressionRefusedError):
            raise
        except Exception as error:
            # yaml's message names line and column, and spans several lines.
            text = " ".join(str(error).split())
            raise self._xacro.XacroException(f"yaml file {filename}: {text}") from error
        finally:
            self._xacro.filestack.pop()

    def evaluate_yaml_number(self, text: str) -> float:
        """The number of a value with a unit, which may be an expression."""
        try:
            return float(self._xacro.safe_eval(text, self.symbols))
        except SyntaxError:
            raise self._xacro.XacroException(f"invalid expression: {text}") from None

    def find_package(self, package: str) -> str:
        folder = self.finder.find(package)
        if folder is None:
            raise _UnknownPackageError(package)
        return str(folder)

    # -- environment -------------------------------------------------------------------------------------------

    def read_environment(self, name: str) -> str:
        """``$(env NAME)``; a variable that a file must not read counts as one that is not set."""
        import xacro.substitution_args as substitution

        if name not in READABLE_ENVIRONMENT | self.environment:
            raise substitution.SubstitutionException(f"environment variable {name!r} is not read")
        if name not in os.environ:
            raise substitution.SubstitutionException(f"environment variable {name!r} is not set")
        return os.environ[name]

    def read_optional_environment(self, name: str, default: Any = "") -> Any:
        """``$(optenv NAME default)``."""
        if name in READABLE_ENVIRONMENT | self.environment:
            return os.environ.get(name, default)
        at = self.locate_cause()
        if (name, at) not in self.ignored:
            self.ignored.add((name, at))
            self.report_problem("environment-ignored", f"{name} is not read", at, variable=name)
        return default

    # -- evaluation --------------------------------------------------------------------------------------------

    def eval_all(self, original: Callable[..., Any]) -> Callable[..., Any]:
        def trace_element(node: minidom.Element, macros: Any, symbols: Any) -> None:
            # The blocks inside a macro call are the caller's own text, not the macro's.
            own_call = bool(self.calls) and self.calls[-1].node is node
            inner = self.calls.pop() if own_call else None
            origin = _get_origin(node)
            self.count_nodes(1 + len(node.childNodes))
            if origin is not None and origin.via is None:
                origin.via = self.list_call_spans()
            pending = [name for name in node.attributes.keys() if not name.startswith("xacro:")]  # noqa: SIM118
            self.frames.append(_ElementFrame(node, pending))
            self.set_position(node)
            try:
                with self.remember_failure():
                    original(node, macros, symbols)
            finally:
                self.frames.pop()
                if inner is not None:
                    self.calls.append(inner)

        return trace_element

    def count_nodes(self, nodes: int) -> None:
        """Count what is gone through, which a few macros that call each other twice make endless."""
        self.nodes += nodes
        if self.nodes > MAX_NODES:
            name, times = next(iter(self.called.most_common(1)), ("", 0))
            often = f"; macro {name} alone was called {times:,} times" if times > 1 else ""
            message = f"the model expands to more than {MAX_NODES:,} elements, texts and comments{often}"
            raise _ExpansionStoppedError("too-large", message, what="expansion", limit=MAX_NODES, found=self.nodes)

    def eval_text(self, original: Callable[..., Any]) -> Callable[..., Any]:
        def evaluate_bounded(text: Any, symbols: Any) -> Any:
            try:
                if isinstance(text, str):  # xacro copies what is left of the text at each of its parts
                    self.guards.charge(text.count("$") * len(text) // 4096)
                result = original(text, symbols)
                if isinstance(result, str):
                    self.guards.measure(result)
            except ExpressionRefusedError as refused:
                refused.expression = refused.expression or str(text)
                raise
            return result

        def trace_text(text: Any, symbols: Any) -> Any:
            if self.evaluating:
                return evaluate_bounded(text, symbols)
            frame = self.frames[-1] if self.frames else None
            own = bool(frame and frame.pending)
            if own and frame is not None:
                self.set_position(frame.node, frame.pending.pop(0))
            elif frame is not None and isinstance(text, str) and "$" in text:
                self.set_text_position(text, frame.node)
            self.evaluating += 1
            self.readers.append([])
            try:
                with self.remember_failure():
                    result = evaluate_bounded(text, symbols)
            finally:
                self.evaluating -= 1
                self.last_reads = tuple(dict.fromkeys(self.readers.pop()))
            origin = _get_origin(self.node)
            if own and origin is not None and self.attribute is not None:
                # A block is evaluated by the caller and, where it is inserted, once more: nothing is left to read then.
                before = origin.reads.get(self.attribute, ())
                origin.reads[self.attribute] = tuple(dict.fromkeys((*before, *self.last_reads)))
            elif self.adding is not None:
                self.add_attribute(str(result))
            elif self.last_reads and self.node is not None and self.node.tagName == "xacro:arg":
                name = self.node.getAttribute("name")
                self.argument_definitions[name] = replace(self.argument_definitions[name], reads=self.last_reads)
            return result

        return trace_text

    def add_attribute(self, result: str) -> None:
        """One of the two values of ``<xacro:attribute name= value=/>``: the second completes the attribute."""
        assert self.adding is not None
        node, values = self.adding
        values.append(result)
        if len(values) < 2:
            return
        self.adding = None
        raw, parent = _get_origin(node), _get_origin(node.parentNode)
        if raw is None or parent is None:
            return
        typed = raw.raw.attributes["value"]
        parent.added[values[0]] = Attribute(
            name=values[0],
            value=values[1],
            owner=parent.raw,
            span=typed.span,
            typed=typed.typed,
            literal=typed.literal,
            reads=self.last_reads,
        )

    def eval_extension(self, original: Callable[..., Any]) -> Callable[..., Any]:
        def evaluate_charged(text: str) -> Any:
            commands = text.count("$(")
            if commands > 1:  # those that a property brought in: each one's value is put into the text
                longest = max((len(str(v)) for v in self._xacro.substitution_args_context["arg"].values()), default=0)
                self.guards.charge(commands * (longest + len(text)))
            result = original(text)
            self.guards.measure(result)
            return result

        return evaluate_charged

    def safe_eval(self, _original: Callable[..., Any]) -> Callable[..., Any]:
        def evaluate_guarded(expression: str, symbols: Any, _local: Any = None) -> Any:
            try:
                return self.evaluate(expression, symbols)
            except NameError as error:
                unknown = re.search(r"name '([^']+)' is not defined", str(error))
                # Only a call is meant for Python: `${type}` is a property that somebody forgot.
                if (
                    unknown
                    and unknown.group(1) in FORBIDDEN_BUILTINS
                    and re.search(rf"\b{unknown.group(1)}\s*\(", expression)
                ):
                    raise ExpressionRefusedError(
                        "outside", f"{unknown.group(1)} is no function of xacro", expression
                    ) from error
                raise

        return evaluate_guarded

    def evaluate(self, expression: str, symbols: Any) -> Any:
        """The value of an expression, in which nothing leads out of xacro's language."""
        try:
            return self.guards.evaluate(compile_expression(expression), symbols)
        except ExpressionRefusedError as refused:
            # What is refused is kept with the code of the expression, and may be raised once more.
            raise ExpressionRefusedError(refused.kind, str(refused), refused.expression or expression) from refused

    def evaluate_extension(self, expression: str, context: Mapping[str, Any]) -> str:
        """``$(eval …)``, in the place of ``substitution_args._eval``."""
        with suppress(SyntaxError):
            compile_expression(expression)
        if "__" in expression:  # xacro looks for it in the text, whether or not the text is an expression
            raise ExpressionRefusedError("outside", "xacro takes no name with two underscores in $(eval …)", expression)
        try:
            return str(self.evaluate(expression, self.list_extension_names(context)))
        except Exception:
            self.failed_extension = self.failed_extension or f"$(eval {expression})"
            raise

    def list_extension_names(self, context: Mapping[str, Any]) -> Mapping[str, Any]:
        """What an expression in ``$(eval …)`` may name: arguments, some functions, and Python's harmless ones.

        xacro leaves all of Python's builtins in its reach, ``open`` and ``exec`` as well.
        """
        import xacro.substitution_args as substitution

        def convert_argument(name: str) -> Any:
            return substitution.convert_value(substitution._eval_arg(name, context["arg"]), "auto")

        own: dict[str, Callable[..., Any]] = {
            "arg": convert_argument,
            "dirname": lambda: substitution._eval_dirname(self.get_current_file()),
            "env": self.read_environment,
            "optenv": self.read_optional_environment,
            "find": self.find_package,
        }
        functions: dict[str, Any] = {"true": True, "false": False, "True": True, "False": False, **self.symbols["math"]}
        functions |= {name: self.guards.guard_function(name, function) for name, function in own.items()}
        builtin = {name: self.guards.make_forbidden_function(name) for name in dir(builtins)} | dict(
            self.symbols["python"]
        )
        return ChainMap(functions, _ConvertedArguments(context["arg"]), builtin)

    def handle_macro_call(self, original: Callable[..., Any]) -> Callable[..., Any]:
        def trace_macro_call(node: minidom.Element, macros: Any, symbols: Any) -> Any:
            if not node.tagName.startswith("xacro:") or node.tagName == "xacro:call":
                if node.tagName == "xacro:call":
                    self.set_position(node)
                return original(node, macros, symbols)
            self.set_position(node)
            origin = _get_origin(node)
            span = None if origin is None else origin.raw.span
            self.calls.append(_ActiveCall(node, span, node.tagName[6:]))
            self.called[node.tagName[6:]] += 1
            self.frames.append(_ElementFrame(node, list(node.attributes.keys())))
            depth = len(self.calls)
            try:
                with self.remember_failure():
                    return original(node, macros, symbols)
            finally:
                self.frames.pop()
                del self.calls[depth - 1 :]

        return trace_macro_call

    def process_include(self, original: Callable[..., Any]) -> Callable[..., Any]:
        def trace_include(node: minidom.Element, macros: Any, symbols: Any, func: Any) -> None:
            self.set_position(node)
            origin = _get_origin(node)
            name = node.getAttribute("filename")
            self.calls.append(_ActiveCall(node, None if origin is None else origin.raw.span, f"include {name}"))
            try:
                with self.remember_failure():
                    stack = [os.path.realpath(f) for f in self._xacro.filestack if f]
                    if stack.count(stack[-1]) >= _MAX_INCLUDED:
                        raise RecursionError(_CYCLE)
                    original(node, macros, symbols, func)
            finally:
                self.calls.pop()
            # An optional include that failed stopped nothing.
            self.failed_at, self.failed_calls, self.failed_reads, self.failed_extension = None, [], [], ""

        return trace_include

    def grab_property(self, original: Callable[..., Any]) -> Callable[..., Any]:
        def trace_property(node: minidom.Element, table: Any) -> Any:
            self.set_position(node)
            raw = getattr(_get_origin(node), "raw", None)
            value = None if raw is None else raw.attributes.get("value") or raw.attributes.get("default")
            self.last_reads = ()
            self.defining = ("property", None if raw is None else value.span if value is not None else raw.span)
            try:
                with self.remember_failure():
                    return original(node, table)
            finally:
                self.defining = None

        return trace_property

    def grab_macro(self, original: Callable[..., Any]) -> Callable[..., Any]:
        def trace_macro(node: minidom.Element, macros: Any) -> Any:
            self.set_position(node)
            with self.remember_failure():
                return original(node, macros)

        return trace_macro

    def import_xml_namespaces(self, original: Callable[..., Any]) -> Callable[..., Any]:
        def trace_namespaces(parent: minidom.Element, attributes: minidom.NamedNodeMap) -> None:
            had = set(parent.attributes.keys())
            original(parent, attributes)
            target = _get_origin(parent)
            for name in set(parent.attributes.keys()) - had:
                source = _get_origin(attributes[name].ownerElement)
                if target is not None and source is not None and name in source.raw.attributes:
                    target.added[name] = source.raw.attributes[name]

        return trace_namespaces

    def eval_default_arg(self, original: Callable[..., Any]) -> Callable[..., Any]:
        def trace_default(forward: Any, default: Any, symbols: Any, macro: Any) -> Any:
            self.last_reads = ()
            self.readers.append([])
            try:
                value = original(forward, default, symbols, macro)
            finally:
                forwarded = self.readers.pop()
            self.last_reads = (*forwarded, *self.last_reads)
            raw = getattr(_get_origin(macro.body), "raw", None)
            self.defaulting = None if raw is None else raw.attributes.get("params")
            return value

        return trace_default

    def find_parameter_span(self, params: Attribute, name: str) -> Span | None:
        """Where ``name:=default`` stands in the parameters of a macro, which may go over many lines."""
        spec = rf"(?<!\S){re.escape(name)}\s*:?=\s*(\^\|?)?({self._xacro.default_value})"
        match = re.search(spec, params.typed)
        if match is None or params.span is None:
            return params.span
        start = params.span.start
        return self.files[params.span.file].make_span(start + match.start(), start + match.end())

    def check_attrs(self, original: Callable[..., Any]) -> Callable[..., Any]:
        def trace_attributes(tag: minidom.Element, required: list[str], optional: list[str]) -> Any:
            self.set_position(tag)
            with self.remember_failure():
                values = original(tag, required, optional)
            raw = getattr(_get_origin(tag), "raw", None)
            if tag.tagName == "xacro:arg" and raw is not None and values[0] not in self.argument_definitions:
                default = raw.attributes.get("default")
                span = default.span if default is not None else raw.span
                self.argument_definitions[values[0]] = Definition("argument", values[0], span)
            elif tag.tagName in {"xacro:if", "xacro:unless"}:
                self.set_position(tag, "value")
            return values

        return trace_attributes

    def reqd_attrs(self, original: Callable[..., Any]) -> Callable[..., Any]:
        def trace_required_attributes(tag: minidom.Element, names: list[str]) -> Any:
            self.set_position(tag)
            with self.remember_failure():
                values = original(tag, names)
            if tag.tagName == "xacro:attribute":
                self.adding = (tag, [])
            return values

        return trace_required_attributes

    # -- definitions -------------------------------------------------------------------------------------------

    def record_read(self, definition: Definition) -> None:
        if self.readers:
            self.readers[-1].append(definition)

    def record_argument_read(self, name: str) -> None:
        self.arguments_read.add(name)
        definition = self.argument_definitions.get(name)
        if definition is not None:
            self.record_read(definition)

    def wrap_set_item(self, original: Callable[..., Any]) -> Callable[..., Any]:
        def set_traced_item(table: Any, key: str, value: Any, unevaluated: bool) -> Any:
            origin = _get_origin(self.node)
            if self.defaulting is not None:
                kind, span = "parameter", self.find_parameter_span(self.defaulting, key)
                self.defaulting = None
            elif self.defining is not None:
                kind, span = self.defining
            elif self.calls and origin is not None and self.calls[-1].node is self.node:
                typed = origin.raw.attributes.get(key)
                kind, span = "parameter", None if typed is None else typed.span
            else:
                kind, span = "property", None
            if not dict.__contains__(table, key):  # it was removed
                _get_unread_properties(table).pop(key, None)
            result = original(table, key, value, unevaluated)
            self.record_definition(table, key, span if kind == "property" else None)
            reads = () if unevaluated else self.last_reads
            _get_definitions(table)[key] = Definition(kind, key, span, reads)
            return result

        return set_traced_item

    def record_definition(self, table: Any, key: str, span: Span | None) -> None:
        """Note where a property is defined, and whether nothing has read the value that it had before."""
        unread = _get_unread_properties(table)
        lost = unread.pop(key, None)
        if span is not None:
            unread[key] = at = Location(f"xacro:property[{key}]", span, self.list_call_spans())
            if lost is not None and lost.span != span:
                self.report_problem("property-lost", "", at, name=key, lost=lost)

    def wrap_resolve(self, original: Callable[..., Any]) -> Callable[..., Any]:
        def resolve_traced(table: Any, key: str) -> Any:
            lazy = key in table.unevaluated
            _get_unread_properties(table).pop(key, None)
            if lazy:
                self.readers.append([])
                self.resolving.append(_get_definitions(table).get(key))
            try:
                value = original(table, key)
            except BaseException:
                # What could not be computed leads to the cause, and so does what it had read until then.
                definition = _get_definitions(table).get(key)
                if definition is not None and lazy and self.failed_at is None:
                    reads = tuple(dict.fromkeys(self.readers[-1]))
                    self.record_failed_read(Definition(definition.kind, definition.name, definition.span, reads))
                raise
            finally:
                if lazy:
                    self.resolving.pop()
                reads = tuple(dict.fromkeys(self.readers.pop())) if lazy else ()
            definition = _get_definitions(table).get(key)
            if definition is not None:
                if lazy:
                    definition = Definition(definition.kind, definition.name, definition.span, reads)
                    _get_definitions(table)[key] = definition
                self.record_read(definition)
            return value

        return resolve_traced

    def record_failed_read(self, definition: Definition) -> None:
        """Note for the reader around this one what it tried to read."""
        if len(self.readers) > 1:
            self.readers[-2].append(definition)
        else:
            self.failed_reads.append(definition)

    # -- helpers -----------------------------------------------------------------------------------------------

    def set_position(self, node: minidom.Element, attribute: str | None = None) -> None:
        self.node, self.attribute = node, attribute

    def set_text_position(self, text: str, parent: minidom.Element) -> None:
        """Where a text comes from that is no attribute of an ordinary element: of a xacro tag, or between tags."""
        node = self.node
        if node is not None and node.attributes is not None:
            for name, value in node.attributes.items():
                if value == text:
                    self.set_position(node, name)
                    return
        self.set_position(parent)

    @contextmanager
    def remember_failure(self) -> Iterator[None]:
        """Remember where the first exception of the expansion came from."""
        try:
            yield
        except BaseException:
            if self.failed_at is None:
                self.failed_at = self.locate_current()
                self.failed_calls = list(self.calls)
                self.failed_reads += [d for reader in self.readers for d in reader]
            raise

    def warning(self, *args: Any, **_: Any) -> None:
        text = " ".join(" ".join(map(str, args)).split())
        self.report_problem("xacro-warning", text, self.locate_cause())


@contextmanager
def _replace_attribute(target: Any, name: str, value: Any) -> Iterator[None]:
    """An attribute with another value for a while (unittest.mock would load asyncio for this).

    A builtin that a module uses (``eval``) is no attribute of the module, and is none again afterwards.
    """
    own = name in vars(target)
    original = getattr(target, name, None)
    setattr(target, name, value)
    try:
        yield
    finally:
        if own:
            setattr(target, name, original)
        else:
            delattr(target, name)


class _SubstitutionContext(dict[str, Any]):
    """xacro's substitution context, in which ``filename`` is always the file that is being read."""

    def __init__(self, current_file: Callable[[], str]) -> None:
        super().__init__()
        self.current_file = current_file

    def get(self, key: str, default: Any = None) -> Any:
        return self.current_file() if key == "filename" else super().get(key, default)

    def __getitem__(self, key: str) -> Any:
        return self.current_file() if key == "filename" else super().__getitem__(key)


class _TracedArguments(dict[str, Any]):
    """xacro's arguments, which tell when one is read: by ``$(arg)``, by ``$(eval)`` or by ``xacro.arg()``."""

    def __init__(self, values: Mapping[str, str], on_read: Callable[[str], None]) -> None:
        super().__init__(values)
        self.read = on_read

    def __getitem__(self, name: str) -> Any:
        value = super().__getitem__(name)
        self.read(name)
        return value


class _ConvertedArguments(dict[str, Any]):
    """xacro's arguments as ``$(eval …)`` reads them: numbers and truth values where they look like such."""

    def __init__(self, arguments: Mapping[str, str]) -> None:
        super().__init__()
        self.arguments = arguments

    def __missing__(self, name: str) -> Any:
        import xacro.substitution_args as substitution

        return substitution.convert_value(self.arguments[name], "auto")


def _list_file_names(folder: str) -> list[str]:
    try:
        return sorted(os.listdir(folder))
    except OSError:
        return []


def _limit_property_names(original: Callable[[str], bool]) -> Callable[[str], bool]:
    """xacro parses the name as an expression, however long and nested it is."""
    return lambda name: str.isidentifier(name) and original(name)


def _make_silent(name: str) -> Callable[..., None]:
    def print_nothing(*_: Any, **__: Any) -> None:
        """xacro prints; findings speak for us."""

    print_nothing.__name__ = name  # xacro exposes these functions to expressions under their own names
    return print_nothing


def _get_definitions(table: Any) -> dict[str, Definition]:
    found: dict[str, Definition] = table.__dict__.setdefault("_urdfcheck", {})
    return found


def _get_unread_properties(table: Any) -> dict[str, Location]:
    """Where those properties of a table were defined that nothing has read since."""
    found: dict[str, Location] = table.__dict__.setdefault("_urdfcheck_unread", {})
    return found


class _OriginCopier(UserDataHandler):
    """Copies an origin to a clone, so that each use of a macro's body keeps its own chain of calls."""

    def handle(self, operation: int, key: str, data: Origin, src: Any, dst: Any) -> None:
        # A clone below a node that an include brought in counts as an import from the other document.
        if operation in (self.NODE_CLONED, self.NODE_IMPORTED):
            clone = Origin(data.raw, data.via, dict(data.reads), dict(data.added))
            dst.setUserData(key, clone, self)


_ORIGIN_COPIER = _OriginCopier()


def _attach_origins(node: minidom.Element, raw: Element) -> None:
    """Give each node of a freshly parsed document the located element of the same place."""
    stack = [(node, raw)]
    while stack:
        node, raw = stack.pop()
        node.setUserData(_USER_DATA_KEY, Origin(raw), _ORIGIN_COPIER)
        children = [c for c in node.childNodes if c.nodeType == c.ELEMENT_NODE]
        stack.extend(zip(children, raw.children, strict=True))


def _get_origin(node: Any) -> Origin | None:
    return None if node is None else node.getUserData(_USER_DATA_KEY)


def _convert_node(node: minidom.Element, parent: Element | None) -> Element:
    """The expanded document as located elements."""
    origin = _get_origin(node)
    raw = None if origin is None else origin.raw
    via = (origin.via or ()) if origin is not None else ()
    element = Element(tag=node.tagName, span=None if raw is None else raw.span, parent=parent, via=via)
    for name in (node.tagName, *node.attributes.keys()):
        if _INVALID_NAME.search(name) or not name:  # of xacro:element and xacro:attribute, which take any text
            place = Location("robot" if parent is None else parent.subject, element.span, via)
            raise _InvalidOutputError(
                f"{name!r} is no name of an element or attribute: what xacro writes is no XML", place
            )
    for name, value in node.attributes.items():
        typed = None if raw is None else raw.attributes.get(name)
        if typed is None and raw is not None and name == "xmlns":
            typed = raw.attributes.get("xacro:targetNamespace")
        reads = () if origin is None else origin.reads.get(name, ())
        if origin is not None and name in origin.added:
            typed, reads = origin.added[name], origin.added[name].reads
        if typed is None:
            element.attributes[name] = Attribute(
                name=name, value=value, owner=element, span=None, typed="", literal=False, reads=reads
            )
        else:
            literal = typed.literal and typed.value == value
            element.attributes[name] = Attribute(
                name=name, value=value, owner=element, span=typed.span, typed=typed.typed, literal=literal, reads=reads
            )
    for child in node.childNodes:
        if child.nodeType == child.ELEMENT_NODE:
            element.children.append(_convert_node(child, element))
        elif child.nodeType in (child.TEXT_NODE, child.CDATA_SECTION_NODE):
            element.text += child.data
    return element
