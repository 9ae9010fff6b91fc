"""XAC001: xacro can expand the file."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from urdfcheck.core import Finding, Location, Rule
from urdfcheck.core.text import hint, listed, nearest
from urdfcheck.source.load import Source
from urdfcheck.source.package.finder import display_name
from urdfcheck.source.text.problems import Problem
from urdfcheck.source.text.xml import Element
from urdfcheck.source.xacro.usage import elements, macros, properties, typed_at, unprefixed

_EXPRESSIONS = " when evaluating expression '"
_PATH = re.compile(r"(?<![\w./])/[^\s'\",:]+")
# What an empty file name ends in: the folder that is put before it is opened as a file.
_FOLDER = re.compile(r"\[Errno 21\] Is a directory|\[Errno 13\] Permission denied: '[^']*[/\\]'")


@dataclass(frozen=True, slots=True, eq=False)
class _Failure:
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
class _Verdict:
    message: str
    at: Location
    related: tuple[Location, ...]
    data: dict[str, Any]


def check(source: Source, rule: Rule) -> Iterator[Finding]:
    for problem in source.problems_of("expansion-failed"):
        reason, *expressions = problem.message.split(_EXPRESSIONS)
        typed = expressions[0].rstrip().removesuffix("'") if expressions else ""
        failure = _Failure(source, problem, reason, problem.data.get("evaluated") or typed)
        verdict = _verdict(failure)
        yield rule.finding(
            verdict.message,
            at=verdict.at,
            related=verdict.related,
            macros=list(problem.data.get("macros") or ()),
            between=_without_prefix(failure, verdict),
            **verdict.data,
        )


def _without_prefix(failure: _Failure, verdict: _Verdict) -> list[str]:
    """The tags that would define what is missing if they had xacro's prefix: then that is the cause, and told by its rule."""
    if verdict.message not in {"undefined-name", "unknown-macro", "undefined-block"}:
        return []
    found = unprefixed(failure.source.trees)
    return [e.subject for e in found if e.tag == "include" or e.get("name") == verdict.data["name"]]


def _verdict(failure: _Failure) -> _Verdict:
    reader, file = failure.problem.data.get("reader"), failure.problem.data.get("file")
    if reader is not None:
        return _verdict_at(failure, "yaml", failure.problem.location, (reader,), file=file, reason=failure.reason)
    for pattern, explain in _KINDS:
        match = re.search(pattern, failure.reason)
        if match:
            return explain(failure, match)
    reason = _PATH.sub(lambda m: display_name(Path(m.group(0))), failure.reason).strip().rstrip(".")
    if failure.expression.startswith("xacro.fatal("):
        return _at_expression(failure, "refused", reason=reason)
    if failure.expression:
        return _at_expression(failure, "expression-failed", reason=reason)
    return _verdict_at(failure, "failed", failure.problem.location, reason=reason)


def _undefined_name(failure: _Failure, match: re.Match[str]) -> _Verdict:
    name, trees = match.group(1), failure.source.trees
    defined = properties(trees)
    arguments = {e.get("name") for e in elements(trees, "xacro:arg")}
    parameters = {p for m in macros(trees).values() for p in m.parameters}
    known = {*defined, *arguments, *parameters}
    extra: tuple[Location, ...] = ()
    if failure.expression.startswith("$(eval "):
        return _undefined_argument(failure, name, arguments)
    if name in arguments:
        why, repair = f"; an argument has this name, and arguments are read as $(arg {name})", f"write `$(arg {name})`"
    elif name in defined:
        place = defined[name][0]
        where = "" if place.span is None else f" (line {place.span.line} of {place.span.file})"
        why = f"; the property of this name{where} comes later, or belongs to another macro or branch"
        repair = "define the property before its first use and outside of macros, or hand the value over as a parameter"
        extra = tuple(a.location for a in defined[name])
    else:
        near = _built_in(name) or nearest(name, known)
        why = f" (did you mean {near!r}?)" if near else ""
        define = f'define it before this line: `<xacro:property name="{name}" value="…"/>`'
        repair = f"write `{near}`, or {define}" if near else define
    return _at_expression(failure, "undefined-name", extra, name=name, hint=why, repair=repair)


def _undefined_argument(failure: _Failure, name: str, declared: Iterable[str]) -> _Verdict:
    """A name in ``$(eval …)``, which reads arguments and no properties."""
    define = f'declare it before this line: `<xacro:arg name="{name}" default="…"/>`'
    defined = properties(failure.source.trees).get(name, ())
    if defined:
        why = "; a property has this name, and `$(eval …)` reads arguments only"
        repair = "write the expression as `${…}`, which reads properties"
    elif name in declared:
        why, repair = "; the argument of this name is declared later, or in another branch", define
    else:
        near = _built_in(name) or nearest(name, declared)
        why = f" (did you mean {near!r}?)" if near else ""
        repair = f"write `{near}`, or {define}" if near else define
    places = tuple(a.location for a in defined)
    return _at_expression(failure, "undefined-name", places, name=name, hint=why, repair=repair)


def _built_in(name: str) -> str | None:
    """What xacro defines itself under a name spelled otherwise: ``True`` for ``true``, ``pi`` for ``PI``."""
    built_in = {n.lower(): n for n in (*dir(math), "True", "False") if not n.startswith("_")}
    return built_in.get(name.lower())


def _unknown_macro(failure: _Failure, match: re.Match[str]) -> _Verdict:
    name = match.group(1).removeprefix("xacro:")
    known = macros(failure.source.trees)
    near = nearest(name, known)
    extra = (known[near].element.location,) if near else ()
    return _verdict_at(
        failure,
        "unknown-macro",
        failure.problem.location,
        extra,
        name=name,
        files=len(failure.source.trees),
        hint=hint(name, known) if known else "; no file defines any macro",
    )


def _missing_parameters(failure: _Failure, match: re.Match[str]) -> _Verdict:
    names = [n.strip() for n in match.group(1).split(",")]
    call = _element_at(failure)
    at = failure.problem.location if call is None else _in_call(failure, call.location)
    written = " ".join(f'{n}="…"' for n in names)
    return _verdict_at(
        failure, "parameters-missing", at, _definition(failure), macro=failure.macro, names=names,
        listed=", ".join(names), written=written,
    )  # fmt: skip


def _unknown_parameter(failure: _Failure, match: re.Match[str]) -> _Verdict:
    name, call = match.group(1), _element_at(failure)
    typed = None if call is None else call.attributes.get(name)
    macro = macros(failure.source.trees).get(failure.macro)
    taken = () if macro is None else macro.parameters
    return _verdict_at(
        failure,
        "parameter-unknown",
        failure.problem.location if typed is None else _in_call(failure, typed.location),
        _definition(failure),
        macro=failure.macro,
        name=name,
        takes=listed(taken) or "none",
        hint=hint(name, taken),
    )


def _blocks(failure: _Failure, match: re.Match[str]) -> _Verdict:
    return _verdict_at(
        failure, "blocks", failure.problem.location, _definition(failure), macro=failure.macro, reason=match.group(0)
    )


def _undefined_block(failure: _Failure, match: re.Match[str]) -> _Verdict:
    trees = failure.source.trees
    known = {*properties(trees), *(p for m in macros(trees).values() for p in m.parameters)}
    name = match.group(1)
    return _verdict_at(
        failure, "undefined-block", failure.problem.location, name=name, hint=hint(name, known)
    )  # fmt: skip


def _missing_file(failure: _Failure, match: re.Match[str]) -> _Verdict:
    path = Path(match.group(1))
    try:
        beside = [p.name for p in path.parent.iterdir()]
    except OSError:
        beside = []
    near = hint(path.name, beside) if beside else f"; nor does its folder{_folders_beside(failure.source, path)}"
    data: dict[str, Any] = {"file": display_name(path), "hint": near}
    if failure.expression:
        return _at_expression(failure, "file-missing", **data)
    return _verdict_at(failure, "file-missing", failure.problem.location, **data)


def _folders_beside(source: Source, path: Path) -> str:
    """The folders beside the outermost one of a path that is not there: often a part of its name came from an argument."""
    missing = next((folder for folder in reversed(path.parents) if not folder.is_dir()), path)
    try:
        names = sorted(f.name for f in missing.parent.iterdir() if f.is_dir()) if source.finder.allows(missing) else []
    except OSError:
        names = []
    return f" (beside it: {listed(names, 4)})" if names else ""


def _empty_file_name(failure: _Failure, match: re.Match[str]) -> _Verdict:
    # The last definition in the chain is the one that gives the empty text.
    origin = failure.problem.related[-1].subject if failure.problem.related else ""
    kind, _, name = origin.partition("[")
    given = f": {kind} {name.rstrip(']')} is empty" if name and kind != "property" else ""
    return _at_expression(failure, "file-name-empty", given=given)


def _no_key(failure: _Failure, match: re.Match[str]) -> _Verdict:
    return _at_expression(failure, "key-missing", key=match.group(1))


def _condition(failure: _Failure, match: re.Match[str]) -> _Verdict:
    return _verdict_at(failure, "condition", failure.problem.location, typed=match.group(1), value=match.group(2))


def _environment(failure: _Failure, match: re.Match[str]) -> _Verdict:
    message = "environment" if match.group(2) == "set" else "environment-unread"
    return _at_expression(failure, message, name=match.group(1))


def _missing_attribute(failure: _Failure, match: re.Match[str]) -> _Verdict:
    return _verdict_at(failure, "attribute-missing", failure.problem.location, tag=match.group(1), name=match.group(2))


def _endless(failure: _Failure, match: re.Match[str]) -> _Verdict:
    return _verdict_at(failure, "endless", failure.problem.location, reason=failure.reason.split(" Consider ")[0])


def _syntax(failure: _Failure, match: re.Match[str]) -> _Verdict:
    reason = re.sub(r" \(<(?:expression|string)>, line \d+\)", "", failure.reason)
    shown = f"`{failure.expression}`" if failure.expression else "this"
    return _at_expression(failure, "syntax", shown=shown, reason=reason)


_KINDS: tuple[tuple[str, Callable[[_Failure, re.Match[str]], _Verdict]], ...] = (
    (r"name '([^']+)' is not defined", _undefined_name),
    (r"unknown macro name: (\S+)", _unknown_macro),
    (r"Undefined parameters \[([^\]]*)\]", _missing_parameters),
    (r'Invalid parameter "([^"]*)"', _unknown_parameter),
    (r'Not enough blocks|Unused block "[^"]*"', _blocks),
    (r'Undefined block "([^"]*)"', _undefined_block),
    (r"No such file or directory: '?([^'\n]+?)'?(?: \[Errno.*)?$", _missing_file),
    (_FOLDER.pattern, _empty_file_name),
    (r"The yaml dictionary has no key '([^']*)'", _no_key),
    (r'Xacro conditional "(.*)" evaluated to "(.*)", which', _condition),
    (r"environment variable '([^']*)' is not (set|read)", _environment),
    (r"(\S+): missing attribute '([^']+)'", _missing_attribute),
    (r"never ends|circular variable definition", _endless),
    (r"\(<(?:expression|string)>, line \d+\)|^invalid expression", _syntax),
)


def _at_expression(failure: _Failure, message: str, extra: tuple[Location, ...] = (), **data: Any) -> _Verdict:
    """A finding where the failing expression is typed, which may be in a property that is read somewhere else."""
    at = typed_at(failure.source, failure.problem, failure.expression)
    extra = extra if at is failure.problem.location else (failure.problem.location, *extra)
    return _verdict_at(failure, message, at, extra, expression=failure.expression, **data)


def _verdict_at(
    failure: _Failure, message: str, at: Location, extra: tuple[Location, ...] = (), **data: Any
) -> _Verdict:
    related = (*extra, *failure.problem.related)
    return _Verdict(message, at, tuple(r for r in dict.fromkeys(related) if r.span != at.span), data)


def _element_at(failure: _Failure) -> Element | None:
    """The element that the problem stands in, as typed."""
    span = failure.problem.location.span
    tree = None if span is None else failure.source.trees.get(span.file)
    if span is None or tree is None:
        return None
    around = [e for e in tree.walk() if e.span is not None and e.span.start <= span.start and span.end <= e.span.end]
    return around[-1] if around else None


def _in_call(failure: _Failure, location: Location) -> Location:
    return Location(location.subject, location.span, failure.problem.location.via)


def _definition(failure: _Failure) -> tuple[Location, ...]:
    macro = macros(failure.source.trees).get(failure.macro)
    return () if macro is None else (macro.element.location,)
