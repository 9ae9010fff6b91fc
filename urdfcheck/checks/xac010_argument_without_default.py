"""XAC010 reports arguments that the model reads and that have no value."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from urdfcheck.core import Finding, Location, Rule, Severity, Span
from urdfcheck.core.text import SLIP_LIKENESS, find_only_near_name, format_argument_option, format_choices, join_names
from urdfcheck.source.load import Source, locate_expression
from urdfcheck.source.package.finder import format_path
from urdfcheck.source.uses_elsewhere import is_certainly_left_aside, is_named_nowhere
from urdfcheck.source.xacro.file_contents import hangs_on_another
from urdfcheck.source.xacro.usage import collect_macros, find_unprefixed_tags, iter_elements_by_tag

_READ = re.compile(r"\$\(arg\s+([^\s()]+)\s*\)")


def check(source: Source, rule: Rule) -> Iterator[Finding]:
    yield from _check_early_defaults(source, rule)
    for problem in source.find_problems("argument-missing"):
        name = str(problem.data["argument"])
        at = locate_expression(source, problem, f"$(arg {name})")
        declared = [e for e in iter_elements_by_tag(source.trees, "xacro:arg") if e.get("name") == name]
        macro = _find_macro_with_parameter(source, at, name)
        if macro is not None:  # its parameter was meant: an argument of this name in another file says nothing of it
            declared = []
        missing = [name, *(n for n in _find_undeclared_arguments(source) if n != name)]
        # Both are loaded only if an argument is missing.
        from urdfcheck.source.launch.loaded_files import (
            describe_handing,
            find_handing_launch,
            find_naming_launch,
            find_passing_launch,
            is_named_by_launch,
        )
        from urdfcheck.source.xacro.argument_values import find_argument_choices

        known = {choice.name: choice.existing_values for choice in find_argument_choices(source.path, source.finder)}
        options = " ".join(format_argument_option(n, known[n][0] if n in known else None) for n in missing)
        passing = find_passing_launch(source.path, name, source.finder)
        handed = find_handing_launch(source.path, source.finder) if passing is None else None
        starting = find_naming_launch(source.path, source.finder) if passing is None and handed is None else None
        give = _describe_giving(missing, options, starting)
        repair = _describe_repair(source, at, name, give, macro=macro, is_declared=bool(declared))
        defaults = [e.attributes["default"] for e in declared if "default" in e.attributes]
        is_circular = any(_is_within(at.span, default.span) for default in defaults)
        if is_circular:
            repair = f"write a default that does not read it, or {give}"
        if passing is not None:
            repair += f"; {format_path(passing)} passes one, known only at launch"
        is_part = handed is not None or hangs_on_another(source.main_tree)
        if handed is not None:
            repair = f"{describe_handing(*handed)}; else {repair}"
        elif is_part:
            repair = (
                f"nothing if only a robot that has the links and gives the argument includes the file; else {repair}"
            )
        finding = rule.finding(
            "circular" if is_circular else "too-late" if declared else "missing",
            at=at,
            related=[*declared, *(r for r in (problem.location, *problem.related) if r.span != at.span)],
            argument=name,
            missing=missing,
            repair=repair,
            remedy=options,
            choices=format_choices(known.get(name, ()) if macro is None else ()),
            default=declared[0].get("default") if declared else "",
            between=[
                e.subject for e in find_unprefixed_tags(source.trees) if e.tag == "include" or e.get("name") == name
            ],
        )
        # Where it, or what includes it, is started the model has a value: only here nothing is known of it. What nothing starts
        # needs none, nor does a piece of a robot, which the file that includes it gives one.
        is_error = passing is None and not is_part and not _is_nameless(source)
        is_error = is_error and not (is_named_nowhere(source) and is_certainly_left_aside(source))
        # A template: no package that must know it shows a start of it without the values, and so no start that fails.
        is_error = is_error and (source.package is None or is_named_by_launch(source.path, source.finder))
        severity = Severity.INFO if is_part else Severity.WARNING
        yield finding if is_error else replace(finding, severity=severity, blocks_check=True)


def _check_early_defaults(source: Source, rule: Rule) -> Iterator[Finding]:
    """Report the arguments that attributes of ``<robot>`` read, and that had only the default of the file itself."""
    root = source.main_tree
    for name, declared in source.found_arguments.items():
        if root is None or declared.span is None or declared.span.file != source.name:
            continue
        attribute = next(a for a in root.attributes.values() if name in _READ.findall(a.value))
        default = source.arguments[name]
        yield rule.finding(
            "early", at=attribute, related=[declared], severity=Severity.INFO, argument=name, default=default
        )


def _is_nameless(source: Source) -> bool:
    """Whether no program takes a file for a robot: its <robot> has no name."""
    root = source.main_tree
    return root is not None and root.tag == "robot" and "name" not in root.attributes


def _describe_giving(missing: Sequence[str], options: str, starting: Path | None) -> str:
    """Say where a model gets values: the option reaches urdfcheck alone, and not the launch file that names the model."""
    if starting is None:
        return f"give a value: `{options}`"
    return f"pass {join_names(missing, 3)} in {starting.name}, which names the file (here: `{options}`)"


def _describe_repair(
    source: Source, at: Location, name: str, give: str, *, macro: str | None, is_declared: bool
) -> str:
    """Say which value to give; in a ``macro`` that has a parameter of this name, that one was meant."""
    if macro is not None:
        return f"write `${{{name}}}`: {name} is a parameter of the macro {macro} around it, and not an argument of the file"
    if _is_in_root_tag(source, at):
        return f"{give}; or write a fixed text here, because no default can precede it"
    if is_declared:
        return f"move its `<xacro:arg>` up, before what reads it; or {give}"
    slip = find_only_near_name(
        name, {e.get("name") for e in iter_elements_by_tag(source.trees, "xacro:arg")}, SLIP_LIKENESS
    )
    if slip is not None:
        return f"write `$(arg {slip})` if that is meant; else {give}"
    return f'{give}; or declare a default before the first use: `<xacro:arg name="{name}" default="…"/>`'


def _is_in_root_tag(source: Source, at: Location) -> bool:
    """Whether an attribute of ``<robot>`` is at a place: xacro evaluates it before any default."""
    root = source.main_tree
    return root is not None and any(_is_within(at.span, attribute.span) for attribute in root.attributes.values())


def _find_macro_with_parameter(source: Source, at: Location, name: str) -> str | None:
    """Return the macro with a parameter of this name in whose content a place is."""
    for macro in collect_macros(source.trees).values():
        inside = (element for child in macro.element.children for element in child.walk())
        spans = (attribute.span for element in inside for attribute in element.attributes.values())
        if name in macro.parameters and any(_is_within(at.span, span) for span in spans):
            return macro.name
    return None


def _is_within(inner: Span | None, outer: Span | None) -> bool:
    return (
        inner is not None
        and outer is not None
        and inner.file == outer.file
        and outer.start <= inner.start
        and inner.end <= outer.end
    )


def _find_undeclared_arguments(source: Source) -> list[str]:
    """Return the arguments that the included files read and that are neither given nor declared."""
    declared = {e.get("name") for e in iter_elements_by_tag(source.trees, "xacro:arg")}
    read = {
        name: None
        for tree in source.trees.values()
        for element in tree.walk()
        for text in (*(a.value for a in element.attributes.values()), element.text)
        for name in _READ.findall(text)
    }
    # What a macro computes (`$(arg ${side}_angle)`) is not the name of one argument.
    return [n for n in read if "${" not in n and n not in declared and n not in source.arguments]
