"""XAC001 reports why xacro cannot expand the file."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from urdfcheck.core import Finding, Location, Rule
from urdfcheck.core.text import find_nearest_name, format_name_hint, join_names
from urdfcheck.source.load import Source, locate_expression
from urdfcheck.source.package.finder import format_path
from urdfcheck.source.text.problems import Problem
from urdfcheck.source.text.xml import Element
from urdfcheck.source.xacro.usage import collect_macros, collect_properties, find_unprefixed_tags, iter_elements_by_tag

_EXPRESSIONS = " when evaluating expression '"
_PATH = re.compile(r"(?<![\w./])/[^\s'\",:]+")
# What an empty file name ends in: the folder that is put before it is opened as a file.
_FOLDER = re.compile(r"\[Errno 21\] Is a directory|\[Errno 13\] Permission denied: '[^']*[/\\]'")


@dataclass(frozen=True, slots=True, eq=False)
class _ExpansionFailure:
    """What stopped the expansion. ``expression`` is the innermost one that failed, empty when it was none."""

    source: Source
    problem: Problem
    reason: str
    expression: str

    @property
    def macro(self) -> str:
        """The macro that was being called."""
        calls = self.problem.data.get("macros") or ("",)
        return str(calls[-1]).split(".")[-1]


@dataclass(frozen=True, slots=True, eq=False)
class _FailureReport:
    message: str
    at: Location
    related: tuple[Location, ...]
    data: dict[str, Any]


def check(source: Source, rule: Rule) -> Iterator[Finding]:
    for problem in source.find_problems("expansion-failed"):
        reason, *expressions = problem.message.split(_EXPRESSIONS)
        typed = expressions[0].rstrip().removesuffix("'") if expressions else ""
        failure = _ExpansionFailure(source, problem, reason, problem.data.get("evaluated") or typed)
        verdict = _classify_failure(failure)
        yield rule.finding(
            verdict.message,
            at=verdict.at,
            related=verdict.related,
            macros=list(problem.data.get("macros") or ()),
            between=_find_unprefixed_tags(failure, verdict),
            **verdict.data,
        )


def _find_unprefixed_tags(failure: _ExpansionFailure, verdict: _FailureReport) -> list[str]:
    """The tags that would define what is missing if they had xacro's prefix: then that is the cause, and told by its rule."""
    if verdict.message not in {"undefined-name", "unknown-macro", "undefined-block"}:
        return []
    found = find_unprefixed_tags(failure.source.trees)
    return [e.subject for e in found if e.tag == "include" or e.get("name") == verdict.data["name"]]


def _classify_failure(failure: _ExpansionFailure) -> _FailureReport:
    reader, file = failure.problem.data.get("reader"), failure.problem.data.get("file")
    if reader is not None:
        return _build_report(failure, "yaml", failure.problem.location, (reader,), file=file, reason=failure.reason)
    for pattern, explain in _EXPLANATIONS:
        match = re.search(pattern, failure.reason)
        if match:
            return explain(failure, match)
    reason = _PATH.sub(lambda m: format_path(Path(m.group(0))), failure.reason).strip().rstrip(".")
    if failure.expression.startswith("xacro.fatal("):
        return _build_report_at_expression(failure, "refused", reason=reason)
    if failure.expression:
        return _build_report_at_expression(failure, "expression-failed", reason=reason)
    return _build_report(failure, "failed", failure.problem.location, reason=reason)


def _explain_undefined_name(failure: _ExpansionFailure, match: re.Match[str]) -> _FailureReport:
    name, trees = match.group(1), failure.source.trees
    defined = collect_properties(trees)
    arguments = {e.get("name") for e in iter_elements_by_tag(trees, "xacro:arg")}
    parameters = {p for m in collect_macros(trees).values() for p in m.parameters}
    known = {*defined, *arguments, *parameters}
    extra: tuple[Location, ...] = ()
    if failure.expression.startswith("$(eval "):
        return _explain_undefined_argument(failure, name, arguments)
    if name in arguments:
        why, repair = f"; an argument has this name, and arguments are read as $(arg {name})", f"write `$(arg {name})`"
    elif name in defined:
        place = defined[name][0]
        where = "" if place.span is None else f" (line {place.span.line} of {place.span.file})"
        why = f"; the property of this name{where} comes later, or belongs to another macro or branch"
        repair = "define the property before its first use and outside of macros, or hand the value over as a parameter"
        extra = tuple(a.location for a in defined[name])
    else:
        near = _find_built_in_name(name) or find_nearest_name(name, known)
        why = f" (did you mean {near!r}?)" if near else ""
        define = f'define it before this line: `<xacro:property name="{name}" value="…"/>`'
        repair = f"write `{near}`, or {define}" if near else define
    return _build_report_at_expression(failure, "undefined-name", extra, name=name, hint=why, repair=repair)


def _explain_undefined_argument(failure: _ExpansionFailure, name: str, declared: Iterable[str]) -> _FailureReport:
    """A name in ``$(eval …)``, which reads arguments and no properties."""
    define = f'declare it before this line: `<xacro:arg name="{name}" default="…"/>`'
    defined = collect_properties(failure.source.trees).get(name, ())
    if defined:
        why = "; a property has this name, and `$(eval …)` reads arguments only"
        repair = "write the expression as `${…}`, which reads properties"
    elif name in declared:
        why, repair = "; the argument of this name is declared later, or in another branch", define
    else:
        near = _find_built_in_name(name) or find_nearest_name(name, declared)
        why = f" (did you mean {near!r}?)" if near else ""
        repair = f"write `{near}`, or {define}" if near else define
    places = tuple(a.location for a in defined)
    return _build_report_at_expression(failure, "undefined-name", places, name=name, hint=why, repair=repair)


def _find_built_in_name(name: str) -> str | None:
    """What xacro defines itself under a name spelled otherwise: ``True`` for ``true``, ``pi`` for ``PI``."""
    built_in = {n.lower(): n for n in (*dir(math), "True", "False") if not n.startswith("_")}
    return built_in.get(name.lower())


def _explain_unknown_macro(failure: _ExpansionFailure, match: re.Match[str]) -> _FailureReport:
    name = match.group(1).removeprefix("xacro:")
    known = collect_macros(failure.source.trees)
    near = find_nearest_name(name, known)
    extra = (known[near].element.location,) if near else ()
    return _build_report(
        failure,
        "unknown-macro",
        failure.problem.location,
        extra,
        name=name,
        files=len(failure.source.trees),
        hint=format_name_hint(name, known) if known else "; no file defines any macro",
    )


def _explain_missing_parameters(failure: _ExpansionFailure, match: re.Match[str]) -> _FailureReport:
    names = [n.strip() for n in match.group(1).split(",")]
    call = _find_failing_element(failure)
    at = failure.problem.location if call is None else _locate_in_call(failure, call.location)
    written = " ".join(f'{n}="…"' for n in names)
    return _build_report(
        failure, "parameters-missing", at, _locate_macro_definition(failure), macro=failure.macro, names=names,
        listed=", ".join(names), written=written,
    )  # fmt: skip


def _explain_unknown_parameter(failure: _ExpansionFailure, match: re.Match[str]) -> _FailureReport:
    name, call = match.group(1), _find_failing_element(failure)
    typed = None if call is None else call.attributes.get(name)
    macro = collect_macros(failure.source.trees).get(failure.macro)
    taken = () if macro is None else macro.parameters
    return _build_report(
        failure,
        "parameter-unknown",
        failure.problem.location if typed is None else _locate_in_call(failure, typed.location),
        _locate_macro_definition(failure),
        macro=failure.macro,
        name=name,
        takes=join_names(taken) or "none",
        hint=format_name_hint(name, taken),
    )


def _explain_block_mismatch(failure: _ExpansionFailure, match: re.Match[str]) -> _FailureReport:
    return _build_report(
        failure,
        "blocks",
        failure.problem.location,
        _locate_macro_definition(failure),
        macro=failure.macro,
        reason=match.group(0),
    )


def _explain_undefined_block(failure: _ExpansionFailure, match: re.Match[str]) -> _FailureReport:
    trees = failure.source.trees
    known = {*collect_properties(trees), *(p for m in collect_macros(trees).values() for p in m.parameters)}
    name = match.group(1)
    return _build_report(
        failure, "undefined-block", failure.problem.location, name=name, hint=format_name_hint(name, known)
    )  # fmt: skip


def _explain_missing_file(failure: _ExpansionFailure, match: re.Match[str]) -> _FailureReport:
    path = Path(match.group(1))
    try:
        beside = [p.name for p in path.parent.iterdir()]
    except OSError:
        beside = []
    near = (
        format_name_hint(path.name, beside)
        if beside
        else f"; nor does its folder{_describe_sibling_folders(failure.source, path)}"
    )
    data: dict[str, Any] = {"file": format_path(path), "hint": near}
    if failure.expression:
        return _build_report_at_expression(failure, "file-missing", **data)
    return _build_report(failure, "file-missing", failure.problem.location, **data)


def _describe_sibling_folders(source: Source, path: Path) -> str:
    """The folders beside the outermost one of a path that is not there: often a part of its name came from an argument."""
    missing = next((folder for folder in reversed(path.parents) if not folder.is_dir()), path)
    try:
        names = (
            sorted(f.name for f in missing.parent.iterdir() if f.is_dir()) if source.finder.can_open(missing) else []
        )
    except OSError:
        names = []
    return f" (beside it: {join_names(names, 4)})" if names else ""


def _explain_empty_file_name(failure: _ExpansionFailure, match: re.Match[str]) -> _FailureReport:
    # The last definition in the chain is the one that gives the empty text.
    origin = failure.problem.related[-1].subject if failure.problem.related else ""
    kind, _, name = origin.partition("[")
    given = f": {kind} {name.rstrip(']')} is empty" if name and kind != "property" else ""
    return _build_report_at_expression(failure, "file-name-empty", given=given)


def _explain_missing_key(failure: _ExpansionFailure, match: re.Match[str]) -> _FailureReport:
    return _build_report_at_expression(failure, "key-missing", key=match.group(1))


def _explain_bad_condition(failure: _ExpansionFailure, match: re.Match[str]) -> _FailureReport:
    return _build_report(failure, "condition", failure.problem.location, typed=match.group(1), value=match.group(2))


def _explain_environment(failure: _ExpansionFailure, match: re.Match[str]) -> _FailureReport:
    message = "environment" if match.group(2) == "set" else "environment-unread"
    return _build_report_at_expression(failure, message, name=match.group(1))


def _explain_missing_attribute(failure: _ExpansionFailure, match: re.Match[str]) -> _FailureReport:
    return _build_report(
        failure, "attribute-missing", failure.problem.location, tag=match.group(1), name=match.group(2)
    )


def _explain_endless_expansion(failure: _ExpansionFailure, match: re.Match[str]) -> _FailureReport:
    return _build_report(failure, "endless", failure.problem.location, reason=failure.reason.split(" Consider ")[0])


def _explain_syntax_error(failure: _ExpansionFailure, match: re.Match[str]) -> _FailureReport:
    reason = re.sub(r" \(<(?:expression|string)>, line \d+\)", "", failure.reason)
    shown = f"`{failure.expression}`" if failure.expression else "this"
    return _build_report_at_expression(failure, "syntax", shown=shown, reason=reason)


_EXPLANATIONS: tuple[tuple[str, Callable[[_ExpansionFailure, re.Match[str]], _FailureReport]], ...] = (
    (r"name '([^']+)' is not defined", _explain_undefined_name),
    (r"unknown macro name: (\S+)", _explain_unknown_macro),
    (r"Undefined parameters \[([^\]]*)\]", _explain_missing_parameters),
    (r'Invalid parameter "([^"]*)"', _explain_unknown_parameter),
    (r'Not enough blocks|Unused block "[^"]*"', _explain_block_mismatch),
    (r'Undefined block "([^"]*)"', _explain_undefined_block),
    (r"No such file or directory: '?([^'\n]+?)'?(?: \[Errno.*)?$", _explain_missing_file),
    (_FOLDER.pattern, _explain_empty_file_name),
    (r"The yaml dictionary has no key '([^']*)'", _explain_missing_key),
    (r'Xacro conditional "(.*)" evaluated to "(.*)", which', _explain_bad_condition),
    (r"environment variable '([^']*)' is not (set|read)", _explain_environment),
    (r"(\S+): missing attribute '([^']+)'", _explain_missing_attribute),
    (r"never ends|circular variable definition", _explain_endless_expansion),
    (r"\(<(?:expression|string)>, line \d+\)|^invalid expression", _explain_syntax_error),
)


def _build_report_at_expression(
    failure: _ExpansionFailure, message: str, extra: tuple[Location, ...] = (), **data: Any
) -> _FailureReport:
    """A finding where the failing expression is typed, which may be in a property that is read somewhere else."""
    at = locate_expression(failure.source, failure.problem, failure.expression)
    extra = extra if at is failure.problem.location else (failure.problem.location, *extra)
    return _build_report(failure, message, at, extra, expression=failure.expression, **data)


def _build_report(
    failure: _ExpansionFailure, message: str, at: Location, extra: tuple[Location, ...] = (), **data: Any
) -> _FailureReport:
    related = (*extra, *failure.problem.related)
    return _FailureReport(message, at, tuple(r for r in dict.fromkeys(related) if r.span != at.span), data)


def _find_failing_element(failure: _ExpansionFailure) -> Element | None:
    """The element that the problem stands in, as typed."""
    span = failure.problem.location.span
    tree = None if span is None else failure.source.trees.get(span.file)
    if span is None or tree is None:
        return None
    around = [e for e in tree.walk() if e.span is not None and e.span.start <= span.start and span.end <= e.span.end]
    return around[-1] if around else None


def _locate_in_call(failure: _ExpansionFailure, location: Location) -> Location:
    return Location(location.subject, location.span, failure.problem.location.via)


def _locate_macro_definition(failure: _ExpansionFailure) -> tuple[Location, ...]:
    macro = collect_macros(failure.source.trees).get(failure.macro)
    return () if macro is None else (macro.element.location,)
