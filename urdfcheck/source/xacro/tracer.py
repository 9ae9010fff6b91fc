"""Wrappers around xacro's functions that record where each value was typed and what it was computed from."""

from __future__ import annotations

import builtins
import operator
import os
import re
import sys
import warnings
from collections import ChainMap
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import replace
from functools import cache, lru_cache
from types import SimpleNamespace
from typing import Any
from xml.dom import minidom

from urdfcheck.core import Location, Span
from urdfcheck.core.records import dataclass
from urdfcheck.source.text.xml import Attribute, Definition
from urdfcheck.source.xacro.document_nodes import replace_node
from urdfcheck.source.xacro.element_evaluation import evaluate_attributes, evaluate_content
from urdfcheck.source.xacro.expansion_state import CYCLE, ExpansionTrace, describe_value
from urdfcheck.source.xacro.expressions.compile_expression import (
    FORBIDDEN_BUILTINS,
    ExpressionRefusedError,
    compile_expression,
)
from urdfcheck.source.xacro.expressions.guards import Guards
from urdfcheck.source.xacro.expressions.order_variants import OrderVariants, VariantNames
from urdfcheck.source.xacro.macro_parameters import parse_next_parameter
from urdfcheck.source.xacro.origins import get_origin
from urdfcheck.source.xacro.outside_access import FileAccess
from urdfcheck.source.xacro.patches import (
    ConvertedArguments,
    SubstitutionContext,
    limit_property_names,
    make_silent,
    make_text_type,
    replace_attribute,
)

# Each frame of xacro's own recursion comes with one or two of ours: a chain of macros that plain xacro expands must fit.
_RECURSION_FACTOR = 3
# A file that includes itself through others makes a circle, but its conditions may end it after a few rounds.
_MAX_INCLUDED = 4
# Functions of xacro with a wrapper ``wrap_…`` below.
_WRAPPED = (
    *("eval_all", "eval_text", "handle_macro_call", "process_include", "check_attrs", "reqd_attrs"),
    *("import_xml_namespaces", "eval_extension", "safe_eval", "grab_property", "grab_macro", "eval_default_arg"),
)


@dataclass(slots=True)
class _ElementFrame:
    """An element whose attributes are being evaluated: their names in the order in which xacro takes them."""

    node: minidom.Element
    pending: list[str]


class Tracer:
    """The wrappers of one expansion, with the state that they share."""

    def __init__(self, trace: ExpansionTrace, access: FileAccess) -> None:
        self.trace = trace
        self.access = access
        self.guards: Guards
        self.symbols: dict[str, Any]
        self.orders = OrderVariants()
        self.frames: list[_ElementFrame] = []
        self.evaluating = 0
        # The definitions that the last evaluation read.
        self.last_reads: tuple[Definition, ...] = ()
        # The property that is being defined, the parameters whose default is taken, and the attribute that is being added.
        self.defining: tuple[str, Span | None, str] | None = None
        self.defaulting: Attribute | None = None
        self.adding: tuple[minidom.Element, list[str]] | None = None

    @contextmanager
    def install_wrappers(self) -> Iterator[None]:
        """Replace xacro's functions for the duration of one expansion."""
        import xacro

        with ExitStack() as stack:

            def patch(target: Any, name: str, replacement: Any) -> None:
                stack.enter_context(replace_attribute(target, name, replacement))

            self._patch_functions(patch)
            self._patch_state(patch)
            self.guards = Guards(
                xacro.Table,
                places=self.access.places,
                notify=self.report_decision,
                set_order=self.access.set_order,
            )
            patch(xacro, "str", make_text_type(self.guards.make_text))
            self.symbols = xacro.create_global_symbols()
            dict.__setitem__(self.symbols["xacro"], "arg", self.get_argument)
            self.guards.guard_symbols(self.symbols)
            patch(xacro, "_global_symbols", self.symbols)
            # Python's warnings about a stranger's expression (`1 is 1`, "\\d") do not belong on the terminal.
            stack.enter_context(warnings.catch_warnings())
            warnings.simplefilter("ignore")
            stack.callback(sys.setrecursionlimit, sys.getrecursionlimit())
            sys.setrecursionlimit(_RECURSION_FACTOR * sys.getrecursionlimit())
            yield

    def _patch_functions(self, patch: Callable[[Any, str, Any], None]) -> None:
        import xacro
        import xacro.substitution_args as substitution

        # xacro exposes these two to expressions under their own names.
        def warning(*args: Any, **_: Any) -> None:
            self.report_warning(*args)

        def load_yaml(filename: str) -> Any:
            return self.access.load_yaml(filename, self.evaluate_yaml_number)

        for name in _WRAPPED:
            patch(xacro, name, getattr(self, f"wrap_{name}")(getattr(xacro, name)))
        for name in ("message", "error", "print_location"):
            patch(xacro, name, make_silent(name))
        patch(xacro, "warning", warning)
        patch(xacro, "load_yaml", load_yaml)
        patch(xacro, "parse", self.access.wrap_parse(xacro.parse))
        patch(xacro, "glob", SimpleNamespace(glob=self.access.find_matching_files))
        patch(xacro, "parse_macro_arg", parse_next_parameter)
        patch(xacro, "replace_node", replace_node)
        patch(xacro, "deepcopy", list)  # of the list of the files around a macro
        patch(xacro, "is_valid_name", limit_property_names(xacro.is_valid_name))
        patch(xacro.Table, "_setitem", self.wrap_set_item(xacro.Table._setitem))
        patch(xacro.Table, "_resolve_", self.wrap_resolve(xacro.Table._resolve_))
        patch(substitution, "_eval_dirname", lambda _file: self.access.get_current_folder())
        patch(xacro, "abs_filename_spec", self.access.wrap_abs_filename(xacro.abs_filename_spec))
        patch(substitution, "_eval_find", self.access.find_package)
        patch(substitution, "_eval_env", self.access.read_environment)
        patch(substitution, "_eval_optenv", self.access.read_optional_environment)
        patch(substitution, "_eval", self.evaluate_extension)

    def _patch_state(self, patch: Callable[[Any, str, Any], None]) -> None:
        import xacro

        patch(xacro, "root_dir", os.curdir)
        patch(xacro, "filestack", None)
        patch(xacro, "macrostack", None)
        patch(xacro, "all_includes", [])
        # $(dirname) of the file that is being read; plain xacro's command line leaves it unset.
        patch(xacro, "substitution_args_context", SubstitutionContext(self.access.get_current_file))

    # -- elements --------------------------------------------------------------------------------------------------

    def wrap_eval_all(self, _original: Callable[..., Any]) -> Callable[..., Any]:
        """Replace ``eval_all``, which evaluates an element: note its calls and the attributes that follow."""

        def trace_element(node: minidom.Element, macros: Any, symbols: Any) -> None:
            # The blocks inside a macro call are the caller's own text, not the macro's.
            is_own_call = bool(self.trace.calls) and self.trace.calls[-1].node is node
            inner = self.trace.calls.pop() if is_own_call else None
            origin = get_origin(node)
            self.trace.count_nodes(1 + len(node.childNodes))
            if origin is not None and origin.via is None:
                origin.via = self.trace.list_call_spans()
            frame = _ElementFrame(node, [])
            self.frames.append(frame)
            self.trace.set_position(node)
            is_plain = self.guards.is_plain
            try:
                with self.trace.remember_failure():
                    last = evaluate_attributes(node, symbols, is_plain=is_plain, pending=frame.pending)
                    self.trace.set_position(node, last)
                    evaluate_content(node, macros, symbols, is_plain=is_plain)
                    self.orders.note_other_use()
            finally:
                self.frames.pop()
                if inner is not None:
                    self.trace.calls.append(inner)

        return trace_element

    def wrap_eval_text(self, original: Callable[..., Any]) -> Callable[..., Any]:
        """Wrap ``eval_text``: note what the text of an attribute reads."""

        def evaluate_bounded(text: Any, symbols: Any) -> Any:
            if self.guards.is_plain(text):
                return text
            try:
                if isinstance(text, str):  # xacro copies the rest of the text at each of its parts
                    self.guards.charge(text.count("$") * len(text) // 4096)
                result = self.evaluate_parts(text, symbols, original)
                if isinstance(result, str):
                    self.guards.measure(result)
            except ExpressionRefusedError as refused:
                refused.expression = refused.expression or str(text)
                raise
            return result

        def trace_text(text: Any, symbols: Any) -> Any:
            if self.evaluating:
                return evaluate_bounded(text, symbols)
            self.orders.note_other_use()
            frame = self.frames[-1] if self.frames else None
            is_attribute = bool(frame and frame.pending)
            if is_attribute and frame is not None:
                self.trace.set_position(frame.node, frame.pending.pop(0))
            elif frame is not None and isinstance(text, str) and "$" in text:
                self.trace.set_text_position(text, frame.node)
            if self.guards.is_plain(text):
                result, self.last_reads = text, ()
            else:
                self.evaluating += 1
                self.trace.readers.append([])
                try:
                    with self.trace.remember_failure():
                        result = evaluate_bounded(text, symbols)
                finally:
                    self.evaluating -= 1
                    self.last_reads = tuple(dict.fromkeys(self.trace.readers.pop()))
            self.note_text(result, is_attribute=is_attribute)
            return result

        return trace_text

    def note_text(self, result: Any, *, is_attribute: bool) -> None:
        """Note what the text was computed from that was just evaluated, for the attribute or argument that it is of."""
        if self.last_reads and self.trace.is_condition():
            self.trace.report_environment_decision(self.last_reads)
        origin = get_origin(self.trace.node)
        if is_attribute and origin is not None and self.trace.attribute is not None:
            # A block is evaluated by the caller and again where it is inserted, when nothing is left to read.
            before = origin.reads.setdefault(self.trace.attribute, self.last_reads)
            if before is not self.last_reads and self.last_reads:
                origin.reads[self.trace.attribute] = tuple(dict.fromkeys((*before, *self.last_reads)))
        elif self.adding is not None:
            self.add_attribute(*self.adding, result=result if isinstance(result, str) else "")
        elif self.last_reads and self.trace.node is not None and self.trace.node.tagName == "xacro:arg":
            name = self.trace.node.getAttribute("name")
            self.trace.argument_definitions[name] = replace(
                self.trace.argument_definitions[name], reads=self.last_reads
            )
        elif self.last_reads:
            self.trace.record_loose_reads(self.last_reads)

    def evaluate_parts(self, text: Any, symbols: Any, original: Callable[..., Any]) -> Any:
        """Do what ``eval_text`` does, which takes a text apart each time that it is evaluated."""
        import xacro

        def evaluate_inner(part: str) -> Any:
            return part if self.guards.is_plain(part) else xacro.eval_text(part, symbols)

        try:
            parts = _split_text(text)
        except (xacro.XacroException, TypeError):  # it is not a text, or its parts are evaluated up to the broken one
            return original(text, symbols)
        values = []
        for kind, part in parts:
            if kind is None:
                values.append(part)
            elif kind == "extension":
                values.append(xacro.eval_extension(f"$({evaluate_inner(part)})"))
            else:
                try:
                    values.append(xacro.safe_eval(evaluate_inner(part), symbols))
                except Exception as error:
                    suffix = f"{os.linesep}when evaluating expression '{part}'"
                    raise xacro.XacroException(exc=error, suffix=suffix) from None
        return values[0] if len(values) == 1 else "".join(map(xacro.str, values))

    def add_attribute(self, node: minidom.Element, values: list[str], *, result: str) -> None:
        """Take one of the two values of ``<xacro:attribute name= value=/>``: the second completes the attribute."""
        values.append(result)
        if len(values) < 2:
            return
        self.adding = None
        raw, parent = get_origin(node), get_origin(node.parentNode)
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

    def wrap_handle_macro_call(self, original: Callable[..., Any]) -> Callable[..., Any]:
        """Wrap ``handle_macro_call``: note the call."""

        def trace_macro_call(node: minidom.Element, macros: Any, symbols: Any) -> Any:
            if not node.tagName.startswith("xacro:") or node.tagName == "xacro:call":
                if node.tagName == "xacro:call":
                    self.trace.set_position(node)
                return original(node, macros, symbols)
            self.trace.set_position(node)
            self.trace.begin_call(node, node.tagName[6:])
            self.trace.times_called[node.tagName[6:]] += 1
            self.frames.append(_ElementFrame(node, list(node.attributes.keys())))
            depth = len(self.trace.calls)
            try:
                with self.trace.remember_failure():
                    return original(node, macros, symbols)
            finally:
                self.frames.pop()
                del self.trace.calls[depth - 1 :]

        return trace_macro_call

    def wrap_process_include(self, original: Callable[..., Any]) -> Callable[..., Any]:
        """Wrap ``process_include``: note the include, and end circles of includes."""
        import xacro

        resolve = cache(os.path.realpath)  # the files around the outer includes are around all inner ones too

        def trace_include(node: minidom.Element, macros: Any, symbols: Any, func: Any) -> None:
            self.trace.set_position(node)
            self.trace.begin_call(node, f"include {node.getAttribute('filename')}")
            try:
                with self.trace.remember_failure():
                    around = [f for f in xacro.filestack if f]
                    stack = list(map(resolve, around)) if len(around) >= _MAX_INCLUDED else []
                    if stack and stack.count(stack[-1]) >= _MAX_INCLUDED:
                        raise RecursionError(CYCLE)
                    try:
                        original(node, macros, symbols, func)
                    except xacro.XacroException as error:
                        # Its name was the last text that was evaluated before the file could not be opened.
                        if self.trace.failed_at is None and isinstance(error.exc, OSError):
                            self.trace.failed_reads += self.last_reads
                        raise
            finally:
                self.trace.calls.pop()
            self.trace.forget_failure()  # of an optional include, which did not end the expansion

        return trace_include

    def wrap_check_attrs(self, original: Callable[..., Any]) -> Callable[..., Any]:
        """Wrap ``check_attrs``: note where arguments are declared and conditions are typed."""

        def trace_attributes(tag: minidom.Element, required: list[str], optional: list[str]) -> Any:
            self.trace.set_position(tag)
            with self.trace.remember_failure():
                values = original(tag, required, optional)
            raw = getattr(get_origin(tag), "raw", None)
            if tag.tagName == "xacro:arg" and raw is not None and values[0] not in self.trace.argument_definitions:
                default = raw.attributes.get("default")
                span = default.span if default is not None else raw.span
                self.trace.argument_definitions[values[0]] = Definition("argument", values[0], span)
            elif tag.tagName in {"xacro:if", "xacro:unless"}:
                self.trace.set_position(tag, "value")
            return values

        return trace_attributes

    def wrap_reqd_attrs(self, original: Callable[..., Any]) -> Callable[..., Any]:
        """Wrap ``reqd_attrs``: note that ``xacro:attribute`` adds an attribute."""

        def trace_required_attributes(tag: minidom.Element, names: list[str]) -> Any:
            self.trace.set_position(tag)
            with self.trace.remember_failure():
                values = original(tag, names)
            if tag.tagName == "xacro:attribute":
                self.adding = (tag, [])
            return values

        return trace_required_attributes

    def wrap_import_xml_namespaces(self, original: Callable[..., Any]) -> Callable[..., Any]:
        """Wrap ``import_xml_namespaces``: note where the imported ``xmlns:`` attributes are typed."""

        def trace_namespaces(parent: minidom.Element, attributes: minidom.NamedNodeMap) -> None:
            before = set(parent.attributes.keys())
            original(parent, attributes)
            target = get_origin(parent)
            for name in set(parent.attributes.keys()) - before:
                source = get_origin(attributes[name].ownerElement)
                if target is not None and source is not None and name in source.raw.attributes:
                    target.added[name] = source.raw.attributes[name]

        return trace_namespaces

    # -- expressions -----------------------------------------------------------------------------------------------

    def wrap_eval_extension(self, original: Callable[..., Any]) -> Callable[..., Any]:
        """Wrap ``eval_extension``, which replaces ``$(…)`` in a text: limit the size of the result."""
        import xacro

        def evaluate_charged(text: str) -> Any:
            commands = text.count("$(")
            if commands > 1:  # a property brought them in: the value of each is put into the text
                longest = max((len(str(v)) for v in xacro.substitution_args_context["arg"].values()), default=0)
                self.guards.charge(commands * (longest + len(text)))
            result = original(text)
            self.guards.measure(result)
            return result

        return evaluate_charged

    def wrap_safe_eval(self, _original: Callable[..., Any]) -> Callable[..., Any]:
        """Replace ``safe_eval``: evaluate expressions with guards."""

        def evaluate_guarded(expression: str, symbols: Any, _local: Any = None) -> Any:
            try:
                return self.evaluate(expression, symbols)
            except NameError as error:
                unknown = re.search(r"name '([^']+)' is not defined", str(error))
                # Only a call is meant for Python: `${type}` is a property that was not defined.
                if (
                    unknown
                    and unknown.group(1) in FORBIDDEN_BUILTINS
                    and re.search(rf"\b{unknown.group(1)}\s*\(", expression)
                ):
                    raise ExpressionRefusedError(
                        "outside", f"{unknown.group(1)} is not a function of xacro", expression
                    ) from error
                raise

        return evaluate_guarded

    def evaluate(self, expression: str, symbols: Any) -> Any:
        """Return the value of an expression, within xacro's language.

        :raises ExpressionRefusedError: if it leads out of the language or takes too much.
        """
        try:
            code = compile_expression(expression)
            self.orders.begin_expression()
            try:
                value = self.guards.evaluate(code, symbols)
            finally:
                varies = self.orders.end_expression()
            if varies:
                self.orders.compare_orders(
                    expression,
                    value,
                    lambda order: self.guards.evaluate_again(code, VariantNames(symbols, order), order),
                )
        except ExpressionRefusedError as refused:
            # A new exception, because compile_expression's cache keeps the old one and may raise it again.
            raise ExpressionRefusedError(refused.kind, str(refused), refused.expression or expression) from refused
        if not expression.strip().isidentifier():
            self.trace.report_environment_decision(self.trace.readers[-1] if self.trace.readers else ())
        return value

    def evaluate_extension(self, expression: str, context: Mapping[str, Any]) -> str:
        """Return the value of ``$(eval …)``; takes the place of ``substitution_args._eval``."""
        with suppress(SyntaxError):
            compile_expression(expression)
        if "__" in expression:  # xacro looks for it in the text, whether or not the text is an expression
            raise ExpressionRefusedError("outside", "xacro refuses names with two underscores in $(eval …)", expression)
        try:
            return self.guards.make_text(self.evaluate(expression, self.list_extension_names(context)))
        except Exception:
            self.trace.failed_extension = self.trace.failed_extension or f"$(eval {expression})"
            raise

    def list_extension_names(self, context: Mapping[str, Any]) -> Mapping[str, Any]:
        """Return the names that ``$(eval …)`` knows: arguments, some functions, and Python's harmless builtins.

        Plain xacro also offers all other builtins of Python, ``open`` and ``exec`` included.
        """
        import xacro.substitution_args as substitution

        def convert_argument(name: str) -> Any:
            return substitution.convert_value(substitution._eval_arg(name, context["arg"]), "auto")

        commands: dict[str, Callable[..., Any]] = {
            "arg": convert_argument,
            "dirname": self.access.get_current_folder,
            "env": self.access.read_environment,
            "optenv": self.access.read_optional_environment,
            "find": self.access.find_package,
        }
        functions: dict[str, Any] = {"true": True, "false": False, "True": True, "False": False, **self.symbols["math"]}
        functions |= {name: self.guards.guard_function(name, function) for name, function in commands.items()}
        builtin = {name: self.guards.make_forbidden_function(name) for name in dir(builtins)} | dict(
            self.symbols["python"]
        )
        return ChainMap(functions, ConvertedArguments(context["arg"]), builtin)

    def get_argument(self, name: str) -> Any:
        """Return an argument: ``xacro.arg(name)``, for which plain xacro raises a bare KeyError if it is unknown."""
        import xacro
        import xacro.substitution_args as substitution

        values = xacro.substitution_args_context["arg"]
        if name not in values:
            raise substitution.ArgException(name)
        return values[name]

    def evaluate_yaml_number(self, text: str) -> float:
        """Return the number of a yaml value with a unit, which may be an expression."""
        import xacro

        try:
            return float(xacro.safe_eval(text, self.symbols))
        except SyntaxError:
            raise xacro.XacroException(f"invalid expression: {text}") from None

    # -- definitions -----------------------------------------------------------------------------------------------

    def wrap_grab_property(self, original: Callable[..., Any]) -> Callable[..., Any]:
        """Wrap ``grab_property``: note where a property is defined."""

        def trace_property(node: minidom.Element, table: Any) -> Any:
            self.trace.set_position(node)
            raw = getattr(get_origin(node), "raw", None)
            value = None if raw is None else raw.attributes.get("value") or raw.attributes.get("default")
            self.last_reads = ()
            if value is not None:
                self.defining = ("property", value.span, value.typed)
            else:
                self.defining = ("property", None if raw is None else raw.span, "")
            try:
                with self.trace.remember_failure():
                    return original(node, table)
            finally:
                self.defining = None

        return trace_property

    def wrap_grab_macro(self, original: Callable[..., Any]) -> Callable[..., Any]:
        """Wrap ``grab_macro``: note the place of a macro that cannot be defined."""

        def trace_macro(node: minidom.Element, macros: Any) -> Any:
            self.trace.set_position(node)
            with self.trace.remember_failure():
                return original(node, macros)

        return trace_macro

    def wrap_eval_default_arg(self, original: Callable[..., Any]) -> Callable[..., Any]:
        """Wrap ``eval_default_arg``: note what the default of a parameter reads."""

        def trace_default(forward: Any, default: Any, symbols: Any, macro: Any) -> Any:
            self.last_reads = ()
            self.trace.readers.append([])
            try:
                value = original(forward, default, symbols, macro)
            except BaseException:
                # The call names the macro alone: what cannot be evaluated is typed in the parameters.
                definition = self._find_default_definition(macro, (forward, default))
                if definition is not None:
                    self.trace.failed_reads.append(definition)
                raise
            finally:
                forwarded = self.trace.readers.pop()
            self.last_reads = (*forwarded, *self.last_reads)
            raw = getattr(get_origin(macro.body), "raw", None)
            self.defaulting = None if raw is None else raw.attributes.get("params")
            return value

        return trace_default

    def _find_default_definition(self, macro: Any, default: tuple[Any, Any]) -> Definition | None:
        """Return the parameter of a macro that has a default."""
        raw = getattr(get_origin(macro.body), "raw", None)
        params = None if raw is None else raw.attributes.get("params")
        # By identity: another parameter, for which the call has a value, may have the same default.
        name = next((name for name, typed in macro.defaultmap.items() if all(map(operator.is_, typed, default))), None)
        if params is None or name is None:
            return None
        return Definition("parameter", name, self.find_parameter_span(params, name))

    def find_parameter_span(self, params: Attribute, name: str) -> Span | None:
        """Return the place of ``name:=default`` in the parameters of a macro, which may take many lines."""
        place = _find_parameter(params.typed, name)
        if place is None or params.span is None:
            return params.span
        start = params.span.start
        return self.access.files[params.span.file].make_span(start + place[0], start + place[1])

    def wrap_set_item(self, original: Callable[..., Any]) -> Callable[..., Any]:
        """Wrap ``Table._setitem``: record the definition of a property or parameter."""

        def set_traced_item(table: Any, key: str, value: Any, unevaluated: bool) -> Any:
            origin = get_origin(self.trace.node)
            text = ""
            if self.defaulting is not None:
                kind, span = "parameter", self.find_parameter_span(self.defaulting, key)
                self.defaulting = None
            elif self.defining is not None:
                kind, span, text = self.defining
            elif self.trace.calls and origin is not None and self.trace.calls[-1].node is self.trace.node:
                typed = origin.raw.attributes.get(key)
                kind, span = "parameter", None
                if typed is not None:
                    span, text = typed.span, typed.typed
            else:
                kind, span = "property", None
            if not dict.__contains__(table, key):  # it was removed
                _get_unread_properties(table).pop(key, None)
            result = original(table, key, value, unevaluated)
            self.orders.note_definition(table, key, dict.__getitem__(table, key), table._eval_literal)
            self.record_definition(table, key, span if kind == "property" else None)
            reads = () if unevaluated else self.last_reads
            _get_definitions(table)[key] = Definition(kind, key, span, reads=reads, text=text)
            return result

        return set_traced_item

    def record_definition(self, table: Any, key: str, span: Span | None) -> None:
        """Note where a property is defined, and report a previous value that nothing has read."""
        unread = _get_unread_properties(table)
        lost = unread.pop(key, None)
        if span is not None:
            unread[key] = at = Location(f"xacro:property[{key}]", span, self.trace.list_call_spans())
            if lost is not None and lost.span != span:
                self.trace.report_problem("property-lost", "", at, name=key, lost=lost)

    def wrap_resolve(self, original: Callable[..., Any]) -> Callable[..., Any]:
        """Wrap ``Table._resolve_``: record the read of a property, which may be evaluated at its first use."""

        def resolve_traced(table: Any, key: str) -> Any:
            lazy = key in table.unevaluated
            _get_unread_properties(table).pop(key, None)
            if lazy:
                self.trace.readers.append([])
                self.trace.resolving.append(_get_definitions(table).get(key))
            try:
                value = original(table, key)
            except BaseException:
                # The failed definition, and what it had read until then, lead to the cause.
                definition = _get_definitions(table).get(key)
                if definition is not None and lazy and self.trace.failed_at is None:
                    reads = tuple(dict.fromkeys(self.trace.readers[-1]))
                    self.trace.record_failed_read(replace(definition, reads=reads))
                raise
            finally:
                if lazy:
                    self.trace.resolving.pop()
                reads = tuple(dict.fromkeys(self.trace.readers.pop())) if lazy else ()
            if lazy:
                self.orders.note_definition(table, key, value, table._eval_literal)
            self.orders.note_read(table, key, value)
            definition = _get_definitions(table).get(key)
            if definition is not None:
                if lazy or not definition.value:
                    known = definition  # `replace` takes three times as long
                    reads, shown = reads if lazy else known.reads, describe_value(value)
                    definition = Definition(known.kind, known.name, known.span, reads, known.text, shown)
                    _get_definitions(table)[key] = definition
                self.trace.record_read(definition)
            return value

        return resolve_traced

    def report_decision(self, kind: str) -> None:
        """Record that an expression depends on where files are, or on the order of a set."""
        if kind == "order-decides":
            self.orders.note_order()
        self.trace.report_once(kind, "", self.trace.locate_cause())

    def report_warning(self, *args: Any) -> None:
        """Record a warning of xacro."""
        text = " ".join(" ".join(map(str, args)).split())
        self.trace.report_problem("xacro-warning", text, self.trace.locate_cause())


@lru_cache(maxsize=1024)
def _find_parameter(parameters: str, name: str) -> tuple[int, int] | None:
    """Return where ``name:=default`` begins and ends in the parameters of a macro."""
    import xacro

    match = re.search(rf"(?<!\S){re.escape(name)}\s*:?=\s*(\^\|?)?({xacro.default_value})", parameters)
    return None if match is None else match.span()


@lru_cache(maxsize=4096)
def _split_text(text: str) -> tuple[tuple[str | None, str], ...]:
    """Return the parts of a text as xacro takes it apart: an ``expression``, an ``extension``, or (None) what stays as it is.

    :raises xacro.XacroException: where it finds none.
    """
    import xacro

    lexer = xacro.QuickLexer(xacro.LEXER)
    lexer.lex(text)
    parts: list[tuple[str | None, str]] = []
    while lexer.peek():
        kind, part = lexer.next()
        if kind == lexer.EXPR:
            parts.append(("expression", part[2:-1]))
        elif kind == lexer.EXTENSION:
            parts.append(("extension", part[2:-1]))
        else:
            parts.append((None, part[1:] if kind == lexer.DOLLAR_DOLLAR_BRACE else part))
    return tuple(parts)


def _get_definitions(table: Any) -> dict[str, Definition]:
    """Return the definitions of the names in one of xacro's tables."""
    definitions: dict[str, Definition] = table.__dict__.setdefault("_urdfcheck", {})
    return definitions


def _get_unread_properties(table: Any) -> dict[str, Location]:
    """Return the definitions of those properties of a table that nothing has read since."""
    unread: dict[str, Location] = table.__dict__.setdefault("_urdfcheck_unread", {})
    return unread
