"""XAC001 reports why xacro cannot expand the file."""

from __future__ import annotations

import math
import os
import re
import shlex
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from urdfcheck.core import Edit, Finding, Location, Rule, Severity
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import (
    SLIP_LIKENESS,
    find_nearest_name,
    find_only_near_name,
    format_argument_option,
    format_choices,
    format_name_hint,
    join_names,
)
from urdfcheck.source.launch.built_files import find_origin, may_be_built
from urdfcheck.source.load import Source, expand_edited, locate_expression
from urdfcheck.source.model_file import compile_includes, may_compute_name
from urdfcheck.source.package.file_kinds import MODEL_SUFFIXES
from urdfcheck.source.package.finder import Package, PackageFinder, format_path
from urdfcheck.source.package.similar_files import (
    describe_uninstalled_file,
    find_slashed_file,
    find_uninstalled_file,
    index_files,
    propose_checkout_around,
    read_defined_macros,
    read_defined_properties,
)
from urdfcheck.source.path_arguments import (
    find_missing_part,
    is_name_cut_off,
    list_full_names,
    list_named_values,
    list_names_between,
    list_other_values,
    list_path_arguments,
    select_guilty,
)
from urdfcheck.source.resources import find_package_address
from urdfcheck.source.ros.distributions import is_only_before
from urdfcheck.source.text.grammar import CHILDREN
from urdfcheck.source.text.problems import IN_EXPRESSION, MISSING_FILE, Problem
from urdfcheck.source.text.tokens import build_rename_edits
from urdfcheck.source.text.values import parse_number
from urdfcheck.source.text.xml import Attribute, Element, SourceFile, XmlError, parse_xml, quote_attribute
from urdfcheck.source.uses_elsewhere import find_used_copy, is_kept_unused, is_no_robot, is_orphan, is_unused
from urdfcheck.source.xacro.file_contents import has_parts
from urdfcheck.source.xacro.usage import (
    ARGUMENT,
    Condition,
    Macro,
    collect_called_macros,
    collect_macros,
    collect_properties,
    defines_itself,
    find_conditions,
    find_unprefixed_tags,
    iter_elements_by_tag,
    list_condition_arguments,
    read_macro,
)
from urdfcheck.system.files import read_text_or_nothing

_PATH = re.compile(r"(?<![\w./])/[^\s'\",:]+")
# The error of an empty file name: xacro then opens its folder as a file.
_LITERAL = re.compile(r"""(['"])([^'"]+)\1""")
# So many files that define the macro that is called are named in place of a missing one.
_MOST_PROPOSED = 3
# What stops an expansion with some values of its arguments, and not with others.
_OF_VALUES = frozenset(
    {"undefined-name", "macro-conditional", "file-name-empty", "argument-empty", "argument-leads-nowhere"}
)
# What an argument without a value stops: a template gets its values from what starts it.
_OF_EMPTY_VALUES = frozenset({"argument-empty", "file-name-empty"})
# The name of an argument in the options of the command.
_OPTION = re.compile(r"--arg '?([\w.-]+):=")
# A folder of a path that is an argument or a property as a whole.
_FOLDER_NAME = re.compile(r"(?<=/)(?:\$\(arg\s+([\w.-]+)\s*\)|\$\{\s*(\w+)\s*\})(?=/)")
_FOLDER = re.compile(r"\[Errno 21\] Is a directory|\[Errno 13\] Permission denied: '[^']*[/\\]'")
# The start tag of a macro inside a comment.
_COMMENTED_MACRO = re.compile(
    r"""<!--(?:(?!-->).)*?(?P<macro><xacro:macro\s(?:(?!-->)[^>])*?\bparams\s*=\s*["'](?P<params>[^"']*)["'])""",
    re.DOTALL,
)
# What launch files of ROS 2 write in place of xacro's own substitutions.
_OF_LAUNCH_FILES = re.compile(r"Unknown substitution command \[(find-pkg-share|var) +([^\s\]]+)\]")
# A substitution that is typed as an expression: `${find arm}`.
_AS_EXPRESSION = re.compile(r"\s*(find|find-pkg-share|arg|var|env) +([\w.-]+)\s*")
_ALONE = re.compile(r"Unknown substitution command \[([A-Za-z_]\w*)\]")
_OWN_WORDS = {"find-pkg-share": "find", "var": "arg"}
_SYNTAX_REPAIR = (
    "correct the expression; xacro ends `${…}` at the first closing brace and `$(…)` at the first closing parenthesis"
)
_NEGATED = re.compile(r"\$\{\s*not\s+\w+\s*\}")
_CONDITION_REPAIR = "write an expression that is true or false, such as `${value == 'name'}`"
# What is proposed for a missing file if nothing explains it.
_PATH_REPAIR = "correct the path"
# Kinds of problems that end an expansion because of what is written.
_STOPS = frozenset({"expansion-failed", "include-cycle"})
_CONDITIONS = frozenset({"xacro:if", "xacro:unless"})
_BUILT_IN_NAMES = {n.lower(): n for n in (*dir(math), "True", "False") if not n.startswith("_")}
# Names of pi in other languages: xacro has it as `pi`.
_NAMES_OF_PI = frozenset({"pi", "m_pi"})
_DELETION = "delete this file if nothing needs it; else"
_FILE_NAME_REPAIR = (
    "give the file name a default that exists, or read the file only when a name is given (`<xacro:if>`)"
)
_RELATIVE_HINT = "a relative path starts at the folder of the file that contains it"


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class _ExpansionFailure:
    """What stopped the expansion."""

    source: Source
    problem: Problem
    reason: str
    """The message of xacro."""
    expression: str
    """The innermost expression that failed, or empty."""

    @property
    def macro(self) -> str:
        """The macro that was being called."""
        calls = self.problem.data.get("macros") or ("",)
        return str(calls[-1]).split(".")[-1]


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class _FailureReport:
    """The contents of the finding."""

    message: str
    at: Location
    related: tuple[Location, ...]
    data: dict[str, Any]


def check(source: Source, rule: Rule) -> Iterator[Finding]:
    for problem in source.find_problems("value-lost"):
        data = {key: problem.data[key] for key in ("name", "value")}
        yield rule.finding("value-lost", at=problem.location, severity=Severity.WARNING, **data)
    for problem in source.find_problems("expansion-failed"):
        reason, *expressions = problem.message.split(IN_EXPRESSION)
        typed = expressions[0].rstrip().removesuffix("'") if expressions else ""
        expression = problem.data.get("evaluated") or typed
        failure = _ExpansionFailure(source=source, problem=problem, reason=reason, expression=expression)
        report = _classify_failure(failure)
        remedy = str(report.data.get("remedy", "")) if report.message in _OF_VALUES else ""
        passing = _describe_passing_launch(source, remedy)
        if passing:
            report.data["repair" if "repair" in report.data else "there"] += passing
        is_aside = is_no_robot(source) or find_used_copy(source) is not None
        if is_aside and not str(report.data.get("repair", _DELETION)).startswith(_DELETION):
            report.data["repair"] = f"{_DELETION} {report.data['repair']}"
        unprefixed = _find_unprefixed_tags(failure, report)
        finding = rule.finding(
            report.message,
            at=report.at,
            related=report.related,
            macros=list(problem.data.get("macros") or ()),
            between=unprefixed,
            **report.data,
        )
        # A piece that lacks what another file of its package defines was left out of the model: no program loads it.
        is_left_out = bool(report.data.get("defining")) and _is_unused(source)
        is_left_out |= report.message == "parameter-foreign"  # the program that reads it expands the file
        is_left_out |= is_kept_unused(source)
        is_left_out |= passing != ""  # where it is started, the model has a value
        is_left_out |= is_aside
        is_left_out |= bool(report.data.get("origin"))  # where the package is built, the file is there
        is_left_out |= report.message == "environment-unread"  # only here it has no value
        is_left_out |= report.message in _OF_EMPTY_VALUES and bool(remedy) and _is_started_from_outside(source)
        # The xacro of the project's ROS executes tags without the prefix, and reads all macros first.
        is_left_out |= bool(unprefixed) and is_only_before("noetic", source.finder)
        is_left_out |= report.message == "macro-later" and is_only_before("melodic", source.finder)
        yield replace(finding, severity=Severity.WARNING, blocks_check=True) if is_left_out else finding


def _is_started_from_outside(source: Source) -> bool:
    """Whether a model of a package is one that no launch file which must know it starts."""
    from urdfcheck.source.launch.loaded_files import is_named_by_launch  # only what fails asks for it

    return source.package is not None and not is_named_by_launch(source.path, source.finder)


def _describe_passing_launch(source: Source, remedy: str) -> str:
    """Name a launch file that passes the arguments of a ``remedy``: values that only the launch knows, or one in place of that of
    another launch file, which was tried here. Empty if there is none, or one of them was given here."""
    names = _OPTION.findall(remedy)
    if not names:
        return ""
    given = {name: source.arguments[name] for name in names if name in source.arguments}
    # Only what is missing asks for these.
    from urdfcheck.source.launch.around.passing_files import find_overriding_launch
    from urdfcheck.source.launch.loaded_files import find_passing_launch

    found = [
        find_overriding_launch(source.path, name, given[name], source.finder)
        if name in given
        else find_passing_launch(source.path, name, source.finder)
        for name in names
    ]
    if found[0] is None or None in found:
        return ""
    return f"; {format_path(found[0])} passes {'another' if given else 'one, known only at launch'}"


def _find_unprefixed_tags(failure: _ExpansionFailure, report: _FailureReport) -> list[str]:
    """Return the tags that would define what is missing if they had xacro's prefix: XAC007 reports that cause."""
    if report.message not in {"undefined-name", "unknown-macro", "undefined-block"}:
        return []
    tags = (tag for tag in find_unprefixed_tags(failure.source.trees) if not defines_itself(tag))
    return [e.subject for e in tags if e.tag == "include" or e.get("name") == report.data["name"]]


def _classify_failure(failure: _ExpansionFailure) -> _FailureReport:
    reader, file = failure.problem.data.get("reader"), failure.problem.data.get("file")
    if reader is not None:
        return _build_report(failure, "yaml", extra=(reader,), file=file, reason=failure.reason)
    for pattern, explain in _EXPLANATIONS:
        match = re.search(pattern, failure.reason)
        if match:
            return explain(failure, match)
    reason = _PATH.sub(lambda m: format_path(Path(m.group(0))), failure.reason).strip().rstrip(".")
    if failure.expression.startswith("xacro.fatal("):
        return _build_report_at_expression(failure, "refused", reason=reason)
    if failure.expression:
        return _build_report_at_expression(
            failure, "expression-failed", reason=reason, given=_describe_arguments(failure)
        )
    return _build_report(failure, "failed", reason=reason, repair=_describe_substitution(failure.source, reason))


def _describe_substitution(source: Source, reason: str) -> str:
    """Say what to write for a ``$(…)`` that xacro does not know: one of launch files, or a name alone."""
    launch, alone = _OF_LAUNCH_FILES.search(reason), _ALONE.search(reason)
    if launch is not None:
        return _describe_own_words(launch)
    if alone is None:
        return "correct what the message names"
    name = alone[1]
    if name in {e.get("name") for e in iter_elements_by_tag(source.trees, "xacro:arg")}:
        return f"write `$(arg {name})`"
    macros = collect_macros(source.trees).values()
    is_known = name in collect_properties(source.trees) or any(name in macro.parameters for macro in macros)
    return (
        f"write `${{{name}}}`"
        if is_known
        else f"write the text that is meant, or `${{{name}}}` and define {name} before it"
    )


def _describe_own_words(match: re.Match[str]) -> str:
    word, name = match.groups()
    return f"write `$({_OWN_WORDS.get(word, word)} {name})`"


def _explain_undefined_name(failure: _ExpansionFailure, match: re.Match[str]) -> _FailureReport:
    name, trees = match.group(1), failure.source.trees
    defined = collect_properties(trees)
    arguments = {e.get("name") for e in iter_elements_by_tag(trees, "xacro:arg")}
    parameters = {p for m in collect_macros(trees).values() for p in m.parameters}
    known = {*defined, *arguments, *parameters}
    extra: tuple[Location, ...] = ()
    options, defining = "", list[str]()
    if failure.expression.startswith("$(eval "):
        return _explain_undefined_argument(failure, name, arguments)
    if _is_in_start_tag(failure):
        why, repair = (
            "",
            "write a fixed text here: xacro evaluates the attributes of <robot> before it reads any definition",
        )
    elif name in arguments:
        why, repair = f"; an argument has this name, which is read as $(arg {name})", _describe_reading(failure, name)
    elif name in defined:
        place = defined[name][0]
        where = "" if place.span is None else f" (line {place.span.line} of {place.span.file})"
        why = f"; the property with this name{where} comes later, or belongs to another macro or branch"
        repair = "define the property before its first use and outside macros, or pass the value as a parameter"
        conditions = find_conditions(trees, name, failure.problem.location.span)
        if _is_guard(failure, defined[name]):
            why = f"; it is set only inside this condition{where}"
            written = f'<xacro:property name="{name}" default="false"/>'
            repair = f"write `{written}` before this line: it sets the property only where nothing has set it"
        elif conditions:
            why = f"; it is only defined {' or '.join(map(str, conditions))}"
            options = _choose_values(failure.source, conditions)
            repair = "define it in all other cases"
            repair = f"give a value for which it is defined: `{options}`; or {repair}" if options else repair
        extra = tuple(a.location for a in defined[name])
    else:
        near = _find_built_in_name(name) or find_nearest_name(name, known)
        is_pi = name.lower() in _NAMES_OF_PI
        near = near if near and (is_pi or _gets_past_with(failure, _list_renamings(failure, name, near))) else None
        defining = [] if near else _find_defining_files(failure.source, name, read_defined_properties)
        why = f" (did you mean {near!r}?)" if near else ""
        define = f'define it before this line: `<xacro:property name="{name}" value="…"/>`'
        macro = _find_macro_around(failure)
        define += f", or add it to the params of macro {macro}" if macro else ""
        repair = _describe_near_name(failure, near, define) if near else define
        if defining:
            why = f"; {' and '.join(defining)} of the package {'define' if len(defining) > 1 else 'defines'} it"
            repair = _describe_include(failure, defining, define)
    return _build_report_at_expression(
        failure, "undefined-name", extra=extra, name=name, hint=why, repair=repair, remedy=options, defining=defining
    )


def _describe_reading(failure: _ExpansionFailure, name: str) -> str:
    """Say how an expression reads an argument: xacro puts the value into its text, where only a number stands as it is. In quotes
    `false` would count as true, and a property makes it a truth value."""
    declared = iter_elements_by_tag(failure.source.trees, "xacro:arg")
    default = next((e.get("default") for e in declared if e.get("name") == name), "")
    value = failure.source.arguments.get(name, default).strip()
    is_bare = failure.expression.strip() == name or parse_number(value) is not None
    if not is_bare and value.lower() in {"true", "false"}:
        return f'define it before this line: `<xacro:property name="{name}" value="$(arg {name})"/>`'
    return f"write `$(arg {name})`" if is_bare else f"write `'$(arg {name})'`, in quotes: its value is a text"


def _describe_near_name(failure: _ExpansionFailure, near: str, define: str) -> str:
    """Say what to do with a name that resembles a defined one: a condition that the file has under that name may be left over."""
    element = _find_failing_element(failure)
    if element is None or element.tag not in _CONDITIONS or near in _BUILT_IN_NAMES.values():
        return f"write `{near}`, or {define}"
    return f"write `{near}` if that is meant, delete the condition and what is in it if it is left over, or {define}"


def _is_in_start_tag(failure: _ExpansionFailure) -> bool:
    """Whether an attribute of <robot> failed, in the file itself: xacro evaluates none of those of an included file."""
    root, span = failure.source.main_tree, failure.problem.location.span
    return root is not None and span is not None and any(a.span == span for a in root.attributes.values())


def _is_guard(failure: _ExpansionFailure, definitions: Sequence[Attribute]) -> bool:
    """Whether a condition asks for a property that all definitions set inside it: whether its content has been read before."""
    condition = _find_failing_element(failure)
    if condition is None or not (condition.tag == "xacro:unless" or _NEGATED.fullmatch(condition.get("value"))):
        return False
    inside = {id(element) for element in condition.walk()}
    return all(id(definition.owner) in inside for definition in definitions)


def _choose_values(source: Source, conditions: Iterable[Condition]) -> str:
    """Return the options of the command that give the arguments of conditions other values: those that the conditions name."""
    conditions = tuple(conditions)
    literals = {value for c in conditions for _, value in _LITERAL.findall(c.element.get("value"))}
    from urdfcheck.source.xacro.argument_values import find_argument_choices  # only what is missing asks for it

    known = {choice.name: choice for choice in find_argument_choices(source.path, source.finder)}
    options = []
    for name in list_condition_arguments(source.trees, conditions):
        choice = known.get(name)
        values = () if choice is None else choice.values
        now = source.arguments.get(name, None if choice is None else choice.default)
        value = next((v for v in values if v in literals and v != now), None)
        options.append(format_argument_option(name, value))
    return " ".join(options)


def _explain_undefined_argument(failure: _ExpansionFailure, name: str, declared: Iterable[str]) -> _FailureReport:
    """Explain a name in ``$(eval …)``, which reads arguments but not properties."""
    define = f'declare it before this line: `<xacro:arg name="{name}" default="…"/>`'
    defined = collect_properties(failure.source.trees).get(name, ())
    if defined:
        why = "; a property has this name, but `$(eval …)` reads only arguments"
        repair = "write the expression as `${…}`, which reads properties"
    elif name in declared:
        why, repair = "; the argument with this name is declared later, or in another branch", define
    else:
        near = _find_built_in_name(name) or find_nearest_name(name, declared)
        why = f" (did you mean {near!r}?)" if near else ""
        repair = f"write `{near}`, or {define}" if near else define
    places = tuple(a.location for a in defined)
    return _build_report_at_expression(failure, "undefined-name", extra=places, name=name, hint=why, repair=repair)


def _find_built_in_name(name: str) -> str | None:
    """Return the built-in name of xacro that differs only in case: ``True`` for ``true``, ``pi`` for ``PI``, or ``M_PI``."""
    return "pi" if name.lower() in _NAMES_OF_PI else _BUILT_IN_NAMES.get(name.lower())


def _explain_unknown_macro(failure: _ExpansionFailure, match: re.Match[str]) -> _FailureReport:
    name = match.group(1).removeprefix("xacro:")
    later = _find_later_definition(failure, name)
    if later is not None:
        assert later.span is not None  # it was compared
        others = join_names(_list_macros_called_early(failure.source, later, name), 3)
        return _build_report(
            failure,
            "macro-later",
            extra=(later.location,),
            name=name,
            line=later.span.line,
            others=f", as those of {others}, which are called early too" if others else "",
        )
    known = collect_macros(failure.source.trees)
    near = find_nearest_name(name, known)
    extra = (known[near].element.location,) if near else ()
    conditions = find_conditions(failure.source.trees, name, failure.problem.location.span, "xacro:macro")
    if conditions:
        return _explain_conditional_macro(failure, name, conditions)
    if name in known and (inside := _find_macro_that_defines(failure, known[name].element)) is not None:
        return _explain_local_macro(failure, name, known[name].element, inside)
    defining = _find_defining_files(failure.source, name, read_defined_macros)
    repair = "include the file that defines the macro before this line, or delete the call if it is left over"
    renamed = None if near else _find_renamed_macro(failure, name)
    if renamed is not None:
        extra = (renamed[0].element.location,)
    if near or renamed is not None:
        repair = "correct the name, or include the file that defines the macro before this line"
    elif not defining and (namesake := _find_read_namesake(failure.source, name)) is not None:
        file, package = namesake
        repair = (
            f"use a release or fork of {package} whose {file} defines the macro, or delete the call if it is left over"
        )
    if defining and all(_defines_in_part(failure.source, file, name) for file in defining):
        where = "under a condition, or in another macro"
        repair = f"define the macro before this line ({' and '.join(defining)} may: it is there {where}), or correct the name"
    elif defining:
        defining = [file for file in defining if not _defines_in_part(failure.source, file, name)]
        repair = _describe_include(failure, defining, "correct the name", ", which defines the macro,")
    below = [e for e in iter_elements_by_tag(failure.source.trees, "xacro:include") if _is_after_failure(failure, e)]
    if below and not defining and near is None and renamed is None:
        listed = join_names((_describe_include_place(element) for element in below), 3)
        repair = f"move the include that defines the macro above this line, if that is {listed}; otherwise {repair}"
    return _build_report(
        failure,
        "unknown-macro",
        extra=extra,
        name=name,
        files=(count := len(failure.source.trees)),
        read="the file" if count == 1 else f"the {count} files read so far",
        hint=f" (did you mean {renamed[0].name!r} of {renamed[1]}?)"
        if renamed is not None
        else format_name_hint(name, known)
        if known
        else ""
        if defining or below
        else ", nor any other",
        repair=repair,
        defining=defining,
    )


def _find_macro_that_defines(failure: _ExpansionFailure, definition: Element) -> Element | None:
    """Return the definition of a macro within another one, or else the include that reads its file, if that is within one: what
    a call defines is gone where the call ends. None if it may be known outside."""
    here, around = _find_macro_at(_find_failing_element(failure)), _find_macro_at(definition.parent)
    if around is not None:
        return None if around is here else definition
    file = "" if definition.span is None else Path(definition.span.file).name
    includes = iter_elements_by_tag(failure.source.trees, "xacro:include")
    reading = [e for e in includes if e.get("filename").rpartition("/")[2] == file]
    return reading[0] if reading and all(_find_macro_at(e) not in (None, here) for e in reading) else None


def _explain_local_macro(failure: _ExpansionFailure, name: str, definition: Element, inside: Element) -> _FailureReport:
    file = "" if definition.span is None else Path(definition.span.file).name
    moved = f"move the definition of {name} out of it, above this call"
    included = f"include {file} before this line, outside any macro"
    outer = _find_macro_at(inside.parent)
    return _build_report(
        failure,
        "macro-local",
        extra=(definition.location, *(() if inside is definition else (inside.location,))),
        name=name,
        outer="" if outer is None else outer.get("name"),
        repair=moved if inside is definition else included,
    )


def _find_renamed_macro(failure: _ExpansionFailure, name: str) -> tuple[Macro, str] | None:
    """Return the only macro of the file that is included just before a call, with the place of the include, if nothing calls it
    and it shares a word with the name; or the only uncalled one of the files included anywhere before, if it has all words of the
    name. Then the expansion gets past the call by its name."""
    call = _find_failing_element(failure)
    before = [] if call is None or call.parent is None else call.parent.children[: call.parent.children.index(call)]
    includes, words = [e for e in before if e.tag == "xacro:include"], set(name.split("_"))
    if call is None or not includes:
        return None
    last = _list_uncalled_macros(failure, includes[-1]) if before[-1] is includes[-1] else []
    found = [(macro, includes[-1]) for macro in last] if len(last) == 1 and set(last[0].name.split("_")) & words else []
    if not found:
        uncalled = [(macro, include) for include in includes for macro in _list_uncalled_macros(failure, include)]
        found = [(macro, include) for macro, include in uncalled if words <= set(macro.name.split("_"))]
    if len({macro.name for macro, _ in found}) != 1:
        return None
    edits = build_rename_edits([call], f"xacro:{found[0][0].name}", failure.source.files)
    return (found[0][0], _describe_inclusion(found[0][1])) if _gets_past_with(failure, edits) else None


def _list_uncalled_macros(failure: _ExpansionFailure, include: Element) -> list[Macro]:
    """List the macros of an included file that nothing calls."""
    trees, file = failure.source.trees, include.get("filename").rpartition("/")[2]
    macros = collect_macros({read: tree for read, tree in trees.items() if Path(read).name == file})
    called = collect_called_macros(trees)
    return [macro for macro in macros.values() if macro.name not in called]


def _describe_inclusion(include: Element) -> str:
    file = include.get("filename").rpartition("/")[2]
    return file if include.span is None else f"{file}, which line {include.span.line} includes"


def _describe_include_place(include: Element) -> str:
    """Return the name of an included file, with the line of the include."""
    name = include.get("filename").rpartition("/")[2]
    return name if include.span is None else f"{name} (line {include.span.line})"


def _find_read_namesake(source: Source, macro: str) -> tuple[str, str] | None:
    """Return the file of another package that is called like a macro and was read, and that package: there it may be defined in
    another version."""
    own = source.finder.find_package_of(source.path.absolute())
    for file in source.files.values():
        if file.path.name.partition(".")[0].removesuffix("_macro").lower() != macro.lower():
            continue
        package = source.finder.find_package_of(file.path.absolute())
        if package is not None and own is not None and package.path != own.path:
            return file.path.name, package.name
    return None


def _explain_conditional_macro(
    failure: _ExpansionFailure, name: str, conditions: tuple[Condition, ...]
) -> _FailureReport:
    """Explain a macro that the files that were read define for other values."""
    options = _choose_values(failure.source, conditions)
    otherwise = "define it in all other cases"
    return _build_report(
        failure,
        "macro-conditional",
        extra=tuple(condition.element.location for condition in conditions),
        name=name,
        where=" or ".join(map(str, conditions)),
        repair=f"give a value for which it is defined: `{options}`; or {otherwise}" if options else otherwise,
        remedy=options,
    )


def _defines_in_part(source: Source, name: str, macro: str) -> bool:
    """Whether a file of the package, by its name, defines a macro only under conditions or in other macros.

    Then to include the file may not define it.
    """
    for place in _find_in_package(source, name):
        root = _read_root(source, place, name)
        found = [] if root is None else [e for e in root.walk() if e.tag == "xacro:macro"]
        named = [e for e in found if e.get("name").removeprefix("xacro:") == macro]
        if not named or not all(map(_is_in_part, named)):
            return False
    return True


def _is_in_part(definition: Element) -> bool:
    outer = definition.parent
    while outer is not None and outer.tag not in {*_CONDITIONS, "xacro:macro"}:
        outer = outer.parent
    return outer is not None


def _find_in_package(source: Source, name: str) -> Sequence[Path]:
    package = source.finder.find_package_of(source.path.absolute())
    return [] if package is None else index_files([package.path]).get(name.lower(), [])


def _read_root(source: Source, place: Path, name: str) -> Element | None:
    """Return the root of a file; None if it may not be opened, or is not XML."""
    try:
        return parse_xml(SourceFile.read(place, name)) if source.finder.can_open(place) else None
    except (OSError, XmlError):
        return None


def _is_unused(source: Source) -> bool:
    """Whether a file is such a piece, or no file names it where the others of its package name other models."""
    return is_orphan(source) or is_unused(source)


def _describe_include(failure: _ExpansionFailure, files: Sequence[str], otherwise: str, clause: str = "") -> str:
    """Say where what is missing comes from: a piece of a robot gets it from the file that includes both.

    A whole robot is not proposed, nor a file with which the expansion gets no further.
    """
    source = failure.source
    robots = [name for name in files if _is_robot(source, name)]
    pieces = [name for name in files if name not in robots]
    if not is_orphan(source):
        pieces = [name for name in pieces if _gets_past_with_included(failure, name)]
    listed = " or ".join(pieces)
    if is_orphan(source):
        place = f"in the model, after {listed}" if listed else f"in a model, such as {' or '.join(robots)}"
        return f"{_DELETION} include it {place}"
    repair = f"include {listed}{clause} before this line, or {otherwise}" if listed else otherwise
    return f"{_DELETION} {repair}" if _is_unused(source) else repair


def _gets_past_with_included(failure: _ExpansionFailure, name: str) -> bool:
    """Whether the expansion gets further with a file of the package, by its name, included before the element at fault."""
    element = _find_failing_element(failure)
    while element is not None and element.parent is not None and element.parent.parent is not None:
        element = element.parent
    if element is None or element.span is None:
        return False
    start = replace(element.span, end=element.span.start)
    for place in _find_in_package(failure.source, name):
        file = quote_attribute(str(place.absolute()).replace("$(", "$$(").replace("${", "$${"))
        if _gets_past_with(failure, [Edit(start, "", f"<xacro:include filename={file}/>")]):
            return True
    return False


def _list_renamings(failure: _ExpansionFailure, name: str, near: str) -> list[Edit]:
    """Return the edit that writes another name in the text that was evaluated."""
    span = locate_expression(failure.source, failure.problem, failure.expression).span
    if span is None or span.file not in failure.source.files:
        return []
    typed = failure.source.files[span.file].text[span.start : span.end]
    written = re.sub(rf"\b{re.escape(name)}\b", near, typed)
    return [Edit(span, typed, written)] if written != typed else []


def _gets_past_with(failure: _ExpansionFailure, edits: Sequence[Edit]) -> bool:
    """Whether the expansion gets past what stopped it with these edits, and is not stopped in a file that they include."""
    if not edits:
        return False
    stops = [p for p in expand_edited(failure.source, edits).problems if p.kind in _STOPS]
    return not any(p.kind != failure.problem.kind or _is_held_up(failure, p) for p in stops)


def _is_held_up(failure: _ExpansionFailure, later: Problem) -> bool:
    """Whether what stops the expansion after an edit is the same, at the same place, or in a file that was not read before."""
    before, after = failure.problem.location.span, later.location.span
    if later.message == failure.problem.message or before is None or after is None:
        return True
    return (after.file, after.start) == (before.file, before.start) or after.file not in failure.source.trees


def _is_robot(source: Source, name: str) -> bool:
    """Whether a file of the package, by its name, makes links or joints by itself."""
    for place in _find_in_package(source, name):
        root = _read_root(source, place, name)
        if root is not None and "name" in root.attributes and has_parts(root):
            return True
    return False


def _find_defining_files(
    source: Source, name: str, read_defined: Callable[[Iterable[Path], PackageFinder], dict[str, set[str]]]
) -> list[str]:
    """Return the names of the few files of the package that define a name and are not read; nothing if there are many."""
    package = source.finder.find_package_of(source.path.absolute())
    if package is None:
        return []
    paths = [path for paths in index_files([package.path]).values() for path in paths]
    defined = read_defined(paths, source.finder)
    read = {Path(file).name for file in source.trees}
    found = {file for file, names in defined.items() if name in names and file not in read}
    # What includes a file that makes links or joints is another robot, which that file cannot include.
    including = compile_includes(
        [source.path.name, *(Path(file).name for file, tree in source.trees.items() if has_parts(tree))]
    )
    robots = {path.name for path in paths if path.name in found and including.search(read_text_or_nothing(path))}
    return sorted(found - robots) if len(found - robots) <= _MOST_PROPOSED else []


def _find_later_definition(failure: _ExpansionFailure, name: str) -> Element | None:
    """Return the first definition of a macro if xacro, which reads each file in order, reaches all of them after the call."""
    definitions = [e for e in iter_elements_by_tag(failure.source.trees, "xacro:macro") if e.get("name") == name]
    later = [e for e in definitions if _is_after_failure(failure, e)]
    return later[0] if later and len(later) == len(definitions) else None


def _list_macros_called_early(source: Source, later: Element, name: str) -> list[str]:
    """List the other macros that the file of a definition calls, outside macros and conditions, before it defines them."""
    tree = None if later.span is None else source.trees.get(later.span.file)
    found: dict[str, None] = {}
    defined: set[str] = set()
    tops = [] if tree is None else tree.children
    own = {top.get("name") for top in tops if top.tag == "xacro:macro"}
    for top in tops:
        if top.tag == "xacro:macro":
            defined.add(top.get("name"))
        elif (called := top.tag.removeprefix("xacro:")) != top.tag and called in own - defined - {name}:
            found[called] = None
    return list(found)


def _is_after_failure(failure: _ExpansionFailure, element: Element) -> bool:
    """Whether an element outside conditions and macros comes after the place that the expansion has reached in its file."""
    at, span, outer = failure.problem.location, element.span, element.parent
    while outer is not None:
        if outer.tag.startswith("xacro:"):
            return False
        outer = outer.parent
    # The outermost call or include in that file: a macro that is called below the definition may be typed above it.
    reached = next((s for s in (*at.via, at.span) if s is not None and span is not None and s.file == span.file), None)
    return reached is not None and span is not None and reached.start < span.start


def _explain_missing_parameters(failure: _ExpansionFailure, match: re.Match[str]) -> _FailureReport:
    names = [n.strip() for n in match.group(1).split(",")]
    call = _find_call(failure)
    return _build_report(
        failure,
        "parameters-missing",
        at=None if call is None else _locate_in_call(failure, call.location),
        extra=_locate_macro_definition(failure),
        macro=failure.macro,
        names=names,
        listed=", ".join(names),
        have="has" if len(names) == 1 else "have",
        written=" ".join(f'{n}="…"' for n in names),
        plural="" if len(names) == 1 else "s",
        version=_describe_version(failure, "does not need " + ("it" if len(names) == 1 else "them")),
    )


def _explain_unknown_parameter(failure: _ExpansionFailure, match: re.Match[str]) -> _FailureReport:
    name, call = match.group(1), _find_call(failure)
    typed = None if call is None else call.attributes.get(name)
    macro = collect_macros(failure.source.trees).get(failure.macro)
    parameters = () if macro is None else macro.parameters
    owner = None if call is None else _find_foreign_namespace(call, name)
    if owner is not None:
        prefix = name.partition(":")[0]
        at = None if typed is None or call is None else _locate_in_call(failure, typed.location)
        return _build_report(
            failure, "parameter-foreign", at=at, macro=failure.macro, name=name, prefix=prefix, owner=owner
        )
    other = None if macro is None else _find_file_with_parameter(failure.source, macro, name)
    added = f"add {name} to the macro's params"
    return _build_report(
        failure,
        "parameter-unknown",
        at=None if typed is None else _locate_in_call(failure, typed.location),
        extra=_locate_macro_definition(failure),
        macro=failure.macro,
        name=name,
        takes=join_names(parameters) or "none",
        hint=format_name_hint(name, set(parameters) - (set() if call is None else call.attributes.keys())),
        repair=f"correct or remove the attribute {name}, or {added}{_describe_version(failure, 'has it')}"
        if macro is None or other is None
        else f"{added}; {other.name} of the package defines a macro {macro.name} that has it, and the name of the file is "
        "computed: the call serves both",
    )


def _find_file_with_parameter(source: Source, macro: Macro, name: str) -> Path | None:
    """Return another file of a macro's package that defines a macro of the same name with this parameter, where an include
    computes a name that may be its own: the include chooses one of them."""
    span, read = macro.element.span, {file.path.absolute() for file in source.files.values()}
    included = [e.get("filename") for e in iter_elements_by_tag(source.trees, "xacro:include")]
    package = None if span is None else source.finder.find_package_of(source.files[span.file].path.absolute())
    paths = [] if package is None else [path for paths in index_files([package.path]).values() for path in paths]
    defined = read_defined_macros(paths, source.finder)
    for path in paths:
        is_other = macro.name in defined.get(path.name, ()) and path.absolute() not in read
        is_other = is_other and any(may_compute_name(typed, path.name) for typed in included)
        root = _read_root(source, path, path.name) if is_other else None
        found = () if root is None else root.walk()
        named = (e for e in found if e.tag == "xacro:macro" and e.get("name").removeprefix("xacro:") == macro.name)
        if any(name in read_macro(element).parameters for element in named):
            return path
    return None


def _describe_version(failure: _ExpansionFailure, what: str) -> str:
    """Name the other way for a macro of another package than its call: that package may be of another version."""
    source, macro = failure.source, collect_macros(failure.source.trees).get(failure.macro)
    call = _find_call(failure)
    if macro is None or macro.element.span is None or call is None or call.span is None:
        return ""
    called, defined = (
        source.finder.find_package_of(source.files[span.file].path.absolute())
        for span in (call.span, macro.element.span)
    )
    if defined is None or called is None or called.path == defined.path:
        return ""
    return f", or use a version of {defined.name} whose macro {what}"


def _find_foreign_namespace(call: Element, name: str) -> str | None:
    """Return the namespace of an attribute whose prefix is declared and is not xacro's: another program reads it."""
    prefix, colon, _ = name.partition(":")
    around: Element | None = call if colon and prefix not in {"xacro", "xml", "xmlns"} else None
    while around is not None:
        declared = around.get(f"xmlns:{prefix}").strip()
        if declared:
            return None if "xacro" in declared else declared
        around = around.parent
    return None


def _explain_block_mismatch(failure: _ExpansionFailure, match: re.Match[str]) -> _FailureReport:
    definition = _locate_macro_definition(failure)
    return _build_report(failure, "blocks", extra=definition, macro=failure.macro, reason=match.group(0))


def _explain_undefined_block(failure: _ExpansionFailure, match: re.Match[str]) -> _FailureReport:
    trees = failure.source.trees
    known = {*collect_properties(trees), *(p for m in collect_macros(trees).values() for p in m.parameters)}
    name = match.group(1)
    macro, near = _find_macro_around(failure), find_only_near_name(name, known, SLIP_LIKENESS)
    define = (
        f"add `*{name}` to the params of macro {macro} and the element to its calls"
        if macro
        else f'define the block before it: `<xacro:property name="{name}">…`'
    )
    repair = _describe_leftover_block(failure, name) or f"delete the line if it is left over; else {define}"
    repair = repair if near is None else f"write `{near}` if that is meant; else {repair}"
    return _build_report(failure, "undefined-block", name=name, hint=format_name_hint(name, known), repair=repair)


def _describe_leftover_block(failure: _ExpansionFailure, name: str) -> str:
    """Say what to do with an inserted block that a macro has left behind: where the element has one of its kind, or, outside any
    macro, below the macro's start tag in a comment. Empty for another."""
    element, span = _find_failing_element(failure), failure.problem.location.span
    if element is None or element.parent is None or span is None:
        return ""
    parent, text = element.parent.tag, failure.source.files[span.file].text
    is_in_macro = _find_macro_around(failure) != ""
    macros = [
        comment
        for comment in _COMMENTED_MACRO.finditer(text, 0, span.start)
        if not is_in_macro
        and name in (parameter.lstrip("*") for parameter in comment["params"].split() if parameter.startswith("*"))
    ]
    if element.parent.find_child(name) is None and not macros:
        return ""
    repair = "delete the line" + (f": the <{parent}> has its own <{name}>" if element.parent.find_child(name) else "")
    if macros:
        line = text.count("\n", 0, macros[-1].start("macro")) + 1
        repair += f"; or take the <xacro:macro> of line {line} and its end tag out of their comments, and call it"
    return repair


def _explain_missing_file(failure: _ExpansionFailure, match: re.Match[str]) -> _FailureReport:
    path = Path(match.group(1))
    argued = _explain_argument_of_path(failure, path)
    if argued is not None:
        return argued
    try:
        beside = [p.name for p in path.parent.iterdir()]
    except OSError:
        beside = []
    near = (
        _format_file_hint(failure, path, beside)
        if beside or path.parent.is_dir()
        else f", nor does its folder{_describe_sibling_folders(failure.source, path)}"
    )
    # That the folder does not exist says where the path ends, and not why.
    without_cause = near if not beside else ""
    package = failure.source.finder.find_package_of(Path(os.path.normpath(path.absolute())))
    files = {} if package is None else index_files([package.path])
    elsewhere = find_uninstalled_file(path, package, files)
    read = set(map(os.path.abspath, failure.source.files))
    namesakes = [f for f in files.get(path.name.lower(), []) if f.name == path.name and os.path.abspath(f) not in read]
    correction = _describe_correction(failure, package)
    origin = None if package is None or elsewhere is not None else find_origin(path, package.path)
    if origin is not None and origin.name.startswith(path.name):
        near = f"; the build makes it of {format_path(origin)}"
    if package is not None and elsewhere is None and len(namesakes) == 1:
        place = namesakes[0].relative_to(package.path).as_posix()
        near = f" ({package.name} has a file of this name: {place})"
        correction = f"write `$(find {package.name})/{place}` if that is the one, or {_PATH_REPAIR}"
    twin = None if package is None else _find_in_namesake(failure.source, package, path)
    if package is not None and twin is not None:
        near = f", but another package {package.name} has it: {format_path(twin)}"
        correction = f"keep only the package {package.name} with {format_path(twin)}, or rename one of the two (PKG013)"
    root_file = _find_above_python_package(failure.source, path) if package is None else None
    if root_file is not None:
        module, file = map(format_path, root_file)
        near = f", but {file} does: {module} is a Python package, and the folder around it has no package.xml"
        correction = f"keep the path, and add the package.xml of {root_file[0].name} beside {module}"
    same = next((name for name in beside if name != path.name and name.lower() == path.name.lower()), None)
    if same is not None:
        correction = f"write `{same}`, or rename the file: on Linux a capital letter is another one"
    start = _find_other_start(failure)
    if start is not None:
        folder, wanted = start
        near = f": xacro starts at the folder of the file, and the path leads to it only from {format_path(folder)}"
        correction = f"write `{wanted}`"
    repair = correction
    if find_slashed_file(path, failure.source.finder) is not None:
        repair = "write `/` for each backslash"
        near = "; with `/` in place of each backslash, which only Windows reads as a separator, it exists"
    if (typed := find_package_address(str(path))) is not None:
        repair, near = f"write `{typed}`", "; xacro does not know package://, which it takes for a folder"
    is_unexplained = near in ("", without_cause)
    near = near if elsewhere is None else describe_uninstalled_file(elsewhere)
    if elsewhere is not None:
        repair = f"install its folder (CMakeLists.txt or setup.py), or {correction}"
    elif checkout := propose_checkout_around(path, failure.source.finder):
        repair = checkout
    elif package is not None and (origin or (is_unexplained and may_be_built(path, package.path, MODEL_SUFFIXES))):
        repair = f"build {package.name} first, which may make the file; if it does not, {correction}"
    data: dict[str, Any] = {"file": format_path(path), "hint": near, "repair": repair}
    data |= {} if origin is None else {"origin": format_path(origin)}
    if failure.expression:
        return _build_report_at_expression(failure, "file-missing", **data)
    return _build_report(failure, "file-missing", **data)


def _describe_correction(failure: _ExpansionFailure, package: Package | None) -> str:
    """Say what to do with a path that leads nowhere and that nothing explains: its package may be of another version."""
    root = failure.source.finder.find_repository()
    if package is not None and root is not None and not package.path.absolute().is_relative_to(root):
        return f"{_PATH_REPAIR}, or use a release of {package.name} that has the file"
    if package is not None and _is_of_another_package(failure, package):
        return f"{_PATH_REPAIR}, add the file, or use a version of {package.name} that has it"
    return f"{_PATH_REPAIR}, or add the file" + (f"; {_RELATIVE_HINT}" if _is_relative(failure) else "")


def _is_of_another_package(failure: _ExpansionFailure, package: Package) -> bool:
    """Whether a package is another one than that of the file in which the problem is."""
    span = failure.problem.location.span
    if span is None or span.file not in failure.source.files:
        return False
    own = failure.source.finder.find_package_of(failure.source.files[span.file].path.absolute())
    return own is not None and own.path != package.path


def _find_above_python_package(source: Source, path: Path) -> tuple[Path, Path] | None:
    """Return the folder that was taken for a package by its name, and the missing file in the folder around it.

    A package of Python has in it a folder of the same name with its modules: without its package.xml that one is found.
    """
    normal = Path(os.path.normpath(path.absolute()))
    for module in normal.parents:
        file = module.parent / normal.relative_to(module)
        if (module / "__init__.py").is_file() and source.finder.can_open(file) and file.is_file():
            return module, file
    return None


def _find_in_namesake(source: Source, package: Package, path: Path) -> Path | None:
    """Return the missing file in another known package of the same name."""
    inside = os.path.relpath(os.path.normpath(path.absolute()), package.path.absolute())
    others = source.finder.list_meant(package.name, source.path)
    files = (folder / inside for folder in others if folder.absolute() != package.path.absolute())
    return next((file for file in files if source.finder.can_open(file) and file.is_file()), None)


def _find_other_start(failure: _ExpansionFailure) -> tuple[Path, str] | None:
    """Return the folder from which a relative path of an include leads to a file, and the path from the folder of its own file.

    Some programs start where they run, and so did early releases of xacro.
    """
    element = _find_failing_element(failure)
    typed = "" if element is None or element.tag != "xacro:include" else element.get("filename")
    span, finder = failure.problem.location.span, failure.source.finder
    if not typed or "$" in typed or os.path.isabs(typed) or span is None or span.file not in failure.source.files:
        return None
    own = failure.source.files[span.file].path.absolute().parent
    for folder in own.parents:
        if not finder.can_open(folder):
            return None
        if finder.can_open(folder / typed) and (folder / typed).is_file():
            return folder, Path(os.path.relpath(folder / typed, own)).as_posix()
    return None


def _is_relative(failure: _ExpansionFailure) -> bool:
    """Whether the path that leads nowhere is typed without the name of a package, and does not start at the root."""
    typed = _read_typed(failure).strip("\"' ")
    return "$(find" not in typed and not typed.startswith("/")


def _read_typed(failure: _ExpansionFailure) -> str:
    """Return the text that failed as it is typed."""
    return _read_text_at(failure, failure.problem.location)


def _iter_typed(failure: _ExpansionFailure) -> Iterator[str]:
    """Yield the text that failed and those of the definitions that it was made of, as they are typed."""
    return (_read_text_at(failure, place) for place in (failure.problem.location, *failure.problem.related))


def _read_text_at(failure: _ExpansionFailure, place: Location) -> str:
    span = place.span
    file = None if span is None else failure.source.files.get(span.file)
    return "" if span is None or file is None else file.text[span.start : span.end]


def _format_file_hint(failure: _ExpansionFailure, path: Path, beside: Sequence[str]) -> str:
    """Return `` (did you mean 'x'?)`` for a file beside the missing one: of a similar name, unless others define a macro that the
    files call and that is not known, and it does not. A file that is included elsewhere, or that does not help, is not meant."""
    source = failure.source
    unknown = collect_called_macros(source.trees) - collect_macros(source.trees).keys()
    tops = (child.tag for tree in source.trees.values() for child in tree.children)
    unknown |= {tag for tag in tops if tag not in CHILDREN["robot"] and ":" not in tag}
    defined = read_defined_macros([path.parent / name for name in beside], source.finder)
    # The files that are read or included anyway, and what they define, are not what is missing.
    included = {e.get("filename").rpartition("/")[2] for e in iter_elements_by_tag(source.trees, "xacro:include")}
    included |= {Path(name).name for name in source.trees}
    unknown = unknown.difference(*(defined.get(name, ()) for name in included))
    others = [name for name in beside if path.suffix and Path(name).suffix == path.suffix]
    beside = [name for name in beside if name not in included]
    defined = {name: macros for name, macros in defined.items() if name not in included}
    # A file is called like its macro: one that defines what another include is called like is meant there.
    named = {macro for macro in unknown if _is_called_like(path.name, macro)}
    elsewhere = {macro for macro in unknown if any(_is_called_like(file, macro) for file in included - {path.name})}
    defining = [name for name in sorted(defined) if defined[name] & (named or unknown - elsewhere)]
    near = find_nearest_name(path.name, beside)
    if defining and near not in defining:
        return f" (did you mean {' or '.join(map(repr, defining[:_MOST_PROPOSED]))}?)"
    if near and (near in defining or not unknown or not defined.get(near)) and _may_be_meant(failure, path, near):
        return f" (did you mean {near!r}?)"
    # One beside that only defines other macros than those that are missing is none of the two.
    is_meant = len(others) == 1 and others[0] in beside and not defined.get(others[0])
    is_meant = is_meant and _may_be_meant(failure, path, others[0])
    return f" (the only other {path.suffix} file there is {others[0]!r})" if is_meant else ""


def _is_called_like(file: str, macro: str) -> bool:
    """Whether a file has the name of a macro, with or without other words: ``wheel_macro.xacro`` for ``wheel``."""
    return set(macro.lower().split("_")) <= set(file.lower().partition(".")[0].split("_"))


def _may_be_meant(failure: _ExpansionFailure, path: Path, name: str) -> bool:
    """Whether the expansion gets past the include of a missing file with another file beside it; so too where its name is
    computed, which is not tried."""
    element = _find_failing_element(failure)
    typed = None if element is None or element.tag != "xacro:include" else element.attributes.get("filename")
    if typed is None or typed.span is None or not typed.typed.endswith(path.name):
        return True
    return _gets_past_with(failure, [Edit(typed.span, typed.typed, typed.typed.removesuffix(path.name) + name)])


def _explain_argument_of_path(failure: _ExpansionFailure, path: Path) -> _FailureReport | None:
    """Report the arguments that lead to a missing file: those whose value its first missing part contains, else empty ones."""
    source = failure.source
    arguments = list_path_arguments(source, [*failure.problem.related, *_list_read_arguments(failure)])
    missing = find_missing_part(source, path)
    guilty = select_guilty(arguments, missing)
    empty = [argument for argument in arguments if not argument.value]
    folders = _list_folder_arguments(failure)
    lacks_folder = any(argument.name in folders for argument in empty)
    in_name = {argument.name: _list_left_out(failure, path, argument.name) for argument in empty}
    is_cut = lacks_folder or is_name_cut_off(path) or any(in_name.values())
    empty = [argument for argument in empty if in_name[argument.name]] or empty
    if not guilty and (not empty or (path.parent.is_dir() and not is_cut)):
        return None
    told = guilty or empty
    choices = (
        []
        if len(told) > 1
        else list_other_values(source, told[0], missing)
        if guilty
        else list_full_names(source, path)
        or in_name[told[0].name]
        or (list_named_values(source, told[0]) if lacks_folder else [])
    )
    options = " ".join(format_argument_option(argument.name, choices[0] if choices else None) for argument in told)
    is_whole = len(told) == 1 and not choices and Path(told[0].value).name == path.name
    near, there = _describe_only_namesake(source, path) if is_whole else ("", "")
    return _build_report(
        failure,
        "argument-leads-nowhere" if guilty else "argument-empty",
        at=told[0].location,
        extra=(failure.problem.location, *(argument.location for argument in told[1:])),
        file=format_path(path),
        argument=told[0].name,
        given=" and ".join(map(str, told)),
        lead="leads" if len(told) == 1 else "lead",
        noun="argument" if len(told) == 1 else "arguments",
        choices=near or format_choices(choices),
        there=there,
        options=options,
        remedy=options,
    )


def _list_folder_arguments(failure: _ExpansionFailure) -> set[str]:
    """Return the arguments that are the whole name of a folder in the path as typed, ``arms/$(arg arm)/arm.xacro``, or the value
    of a property that is."""
    text, properties = "\n".join(_iter_typed(failure)), collect_properties(failure.source.trees)
    names = {name or prop for name, prop in _FOLDER_NAME.findall(text)}
    definitions = (a.owner for name in names for a in properties.get(name, ()) if a.owner is not None)
    values = (definition.get("value").strip() for definition in definitions)
    return names | {match[1] for value in values if (match := ARGUMENT.fullmatch(value))}


def _list_left_out(failure: _ExpansionFailure, path: Path, name: str) -> list[str]:
    """Return what the names of the files beside a missing one have where it reads an argument, ``base$(arg type).xacro``, that is
    empty."""
    for text in _iter_typed(failure):
        before, read, after = text.rpartition("/")[2].strip("\"' ").partition(f"$(arg {name})")
        if read and before + after == path.name:
            return list_names_between(failure.source, path, before, after)
    return []


def _list_read_arguments(failure: _ExpansionFailure) -> list[Location]:
    """Return the arguments that the failing text, or a definition it was made of, reads and no file declares.

    Their values were given, or passed by a launch file.
    """
    places = (failure.problem.location, *failure.problem.related)
    declared = {place.subject for place in places}
    read = ((name, place.span) for place in places for name in ARGUMENT.findall(_read_text_at(failure, place)))
    return [Location(subject, span) for name, span in read if (subject := f"argument[{name}]") not in declared]


def _describe_only_namesake(source: Source, path: Path) -> tuple[str, str]:
    """Return what to say about the one file of the package that is called so, and the end of a repair; nothing where it has none,
    or several."""
    package = source.finder.find_package_of(Path(os.path.normpath(path.absolute())))
    named = [] if package is None else index_files([package.path]).get(path.name.lower(), [])
    found = [file for file in named if file.name == path.name]
    if package is None or len(found) != 1:
        return "", ""
    place = found[0].relative_to(package.path).as_posix()
    return (
        f" ({package.name} has a file of this name: {place})",
        f": `$(find {package.name})/{place}`, if that is the one",
    )


def _describe_sibling_folders(source: Source, path: Path) -> str:
    """List the folders beside the outermost missing one: an argument may have given a part of its name."""
    missing = next((folder for folder in reversed(path.parents) if not folder.is_dir()), path)
    try:
        names = (
            sorted(f.name for f in missing.parent.iterdir() if f.is_dir()) if source.finder.can_open(missing) else []
        )
    except OSError:
        names = []
    return f" (beside it: {join_names(names, 4)})" if names else ""


def _explain_empty_file_name(failure: _ExpansionFailure, _match: re.Match[str]) -> _FailureReport:
    # The last definition in the chain gives the empty text.
    origin = failure.problem.related[-1] if failure.problem.related else None
    kind, _, name = ("" if origin is None else origin.subject.removesuffix("]")).partition("[")
    given = f": {kind} {name} is empty" if name and kind != "property" else ""
    data: dict[str, Any] = {"given": given}
    if origin is None or kind != "argument":
        return _build_report_at_expression(failure, "file-name-empty", repair=_FILE_NAME_REPAIR, **data)
    # The argument is what must be given: the expression is as it should be.
    options = format_argument_option(name)
    repair = f"give a value: `{options}`; or {_FILE_NAME_REPAIR}"
    extra = (failure.problem.location,)
    data |= {"expression": failure.expression, "repair": repair, "remedy": options}
    return _build_report(failure, "file-name-empty", at=origin, extra=extra, **data)


def _has_arguments(failure: _ExpansionFailure) -> bool:
    return any(True for _ in iter_elements_by_tag(failure.source.trees, "xacro:arg"))


def _describe_arguments(failure: _ExpansionFailure) -> str:
    """Say that other arguments may be what is missing: the defaults of a file need not be those with which it is started."""
    return (
        "; if arguments give them, first pass those with which the robot is started (`--arg`)"
        if _has_arguments(failure)
        else ""
    )


def _explain_missing_key(failure: _ExpansionFailure, match: re.Match[str]) -> _FailureReport:
    # An argument may choose the file, and another one what is read of it.
    chosen = "; if arguments choose the file, first give those that go together (`--arg`)"
    repair = "correct the key, or add it to the yaml file" + (chosen if _has_arguments(failure) else "")
    return _build_report_at_expression(failure, "key-missing", key=match.group(1), repair=repair)


def _explain_bad_condition(failure: _ExpansionFailure, match: re.Match[str]) -> _FailureReport:
    typed, value = match.groups()
    data: dict[str, Any] = {"typed": typed, "value": value}
    named = ARGUMENT.fullmatch(typed.strip())
    if named is None:
        return _build_report(failure, "condition", repair=_CONDITION_REPAIR, **data)
    # The condition is as conditions are: what the argument has is neither.
    declared = [e for e in iter_elements_by_tag(failure.source.trees, "xacro:arg") if e.get("name") == named[1]]
    defaults = tuple(e.attributes["default"].location for e in declared if e.get("default") == value)
    repair = f"give {named[1]} the value true or false"
    if defaults:
        lines = " and ".join(str(place.span.line) for place in defaults if place.span is not None)
        repair = f"write true or false as the default of {named[1]} (line {lines})"
    return _build_report(failure, "condition", extra=defaults, repair=f"{repair}, or compare it here", **data)


def _explain_environment(failure: _ExpansionFailure, match: re.Match[str]) -> _FailureReport:
    message = "environment" if match.group(2) == "set" else "environment-unread"
    name = match.group(1)
    remedy = f"--env {shlex.quote(name)}" if message == "environment-unread" else ""
    return _build_report_at_expression(failure, message, name=name, remedy=remedy)


def _explain_missing_attribute(failure: _ExpansionFailure, match: re.Match[str]) -> _FailureReport:
    return _build_report(failure, "attribute-missing", tag=match.group(1), name=match.group(2))


def _explain_endless_expansion(failure: _ExpansionFailure, _match: re.Match[str]) -> _FailureReport:
    return _build_report(failure, "endless", reason=failure.reason.split(" Consider ")[0])


def _explain_syntax_error(failure: _ExpansionFailure, _match: re.Match[str]) -> _FailureReport:
    reason = re.sub(r" \(<(?:expression|string)>, line \d+\)", "", failure.reason)
    shown = f"`{failure.expression}`" if failure.expression else "this"
    misplaced = _AS_EXPRESSION.fullmatch(failure.expression)
    repair = _SYNTAX_REPAIR if misplaced is None else f"{_describe_own_words(misplaced)}: it is not an expression"
    return _build_report_at_expression(failure, "syntax", shown=shown, reason=reason, repair=repair)


def _explain_property_name(failure: _ExpansionFailure, match: re.Match[str]) -> _FailureReport:
    name = match.group(1)
    return _build_report(failure, "property-name", name=name, other=f"_{name.lstrip('_')}")


def _explain_value_without_text(failure: _ExpansionFailure, match: re.Match[str]) -> _FailureReport:
    return _build_report(failure, "not-text", name=match.group(1), kind=match.group(2))


_EXPLANATIONS: tuple[tuple[str, Callable[[_ExpansionFailure, re.Match[str]], _FailureReport]], ...] = (
    (r"^<xacro:attribute> gives (\S+) a value of the type (\S+),", _explain_value_without_text),
    (r"name '([^']+)' is not defined", _explain_undefined_name),
    (r"unknown macro name: (\S+)", _explain_unknown_macro),
    (r"Undefined parameters \[([^\]]*)\]", _explain_missing_parameters),
    (r'Invalid parameter "([^"]*)"', _explain_unknown_parameter),
    (r'Not enough blocks|Unused block "[^"]*"', _explain_block_mismatch),
    (r'Undefined block "([^"]*)"', _explain_undefined_block),
    (MISSING_FILE.pattern, _explain_missing_file),
    (_FOLDER.pattern, _explain_empty_file_name),
    (r"The yaml dictionary has no key '([^']*)'", _explain_missing_key),
    (r'Xacro conditional "(.*)" evaluated to "(.*)", which', _explain_bad_condition),
    (r"environment variable '([^']*)' is not (set|read)", _explain_environment),
    (r"(\S+): missing attribute '([^']+)'", _explain_missing_attribute),
    (r"Property names must not start with double underscore:(\S+)", _explain_property_name),
    (r"never ends|circular variable definition", _explain_endless_expansion),
    (r"\(<(?:expression|string)>, line \d+\)|^invalid expression", _explain_syntax_error),
)


def _build_report_at_expression(
    failure: _ExpansionFailure, message: str, *, extra: tuple[Location, ...] = (), **data: Any
) -> _FailureReport:
    """Report where the failing expression is typed, possibly in a property that another place reads."""
    at = locate_expression(failure.source, failure.problem, failure.expression)
    extra = extra if at is failure.problem.location else (failure.problem.location, *extra)
    return _build_report(failure, message, at=at, extra=extra, expression=failure.expression, **data)


def _build_report(
    failure: _ExpansionFailure,
    message: str,
    *,
    at: Location | None = None,
    extra: tuple[Location, ...] = (),
    **data: Any,
) -> _FailureReport:
    """Report ``at`` a place, by default that of the problem."""
    at = failure.problem.location if at is None else at
    places = dict.fromkeys((*extra, *failure.problem.related))
    related = tuple(place for place in places if place.span != at.span)
    return _FailureReport(message=message, at=at, related=related, data=data)


def _find_failing_element(failure: _ExpansionFailure) -> Element | None:
    """Return the innermost typed element that contains the problem."""
    span = failure.problem.location.span
    tree = None if span is None else failure.source.trees.get(span.file)
    if span is None or tree is None:
        return None
    around = [e for e in tree.walk() if e.span is not None and e.span.start <= span.start and span.end <= e.span.end]
    return around[-1] if around else None


def _find_call(failure: _ExpansionFailure) -> Element | None:
    """Return the call of the macro that failed: xacro evaluates the blocks in it first, and the place may be the last of them.

    A block that another macro hands on is typed in the call of that one, and the call that failed is a step on the way.
    """
    innermost = element = _find_failing_element(failure)
    name = failure.macro.removeprefix("xacro:")
    while element is not None and element.tag.removeprefix("xacro:") not in {name, "call"}:
        element = element.parent
    if element is None:
        element = _find_step(failure, name)
    return innermost if element is None else element


def _find_step(failure: _ExpansionFailure, name: str) -> Element | None:
    """Return the innermost step on the way to the problem, if that is a call of this macro."""
    via = failure.problem.location.via
    tree = failure.source.trees.get(via[-1].file) if via else None
    typed = () if tree is None else iter_elements_by_tag({via[-1].file: tree}, f"xacro:{name}")
    return next((e for e in typed if e.span == via[-1]), None)


def _find_macro_around(failure: _ExpansionFailure) -> str:
    """Return the name of the macro in whose definition the problem is, or nothing."""
    macro = _find_macro_at(_find_failing_element(failure))
    return "" if macro is None else macro.get("name")


def _find_macro_at(element: Element | None) -> Element | None:
    """Return the innermost macro that an element is, or that is around it."""
    while element is not None and element.tag != "xacro:macro":
        element = element.parent
    return element


def _locate_in_call(failure: _ExpansionFailure, location: Location) -> Location:
    via = failure.problem.location.via
    # The call is not a step on the way to itself.
    return Location(location.subject, location.span, tuple(step for step in via if step != location.span))


def _locate_macro_definition(failure: _ExpansionFailure) -> tuple[Location, ...]:
    macro = collect_macros(failure.source.trees).get(failure.macro)
    return () if macro is None else (macro.element.location,)
