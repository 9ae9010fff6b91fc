"""XAC010 reports arguments that the model reads and that have no value."""

from __future__ import annotations

import re
from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.core.text import format_argument_option, format_choices
from urdfcheck.source.load import Source, locate_expression
from urdfcheck.source.xacro.usage import find_unprefixed_tags, iter_elements_by_tag

_READ = re.compile(r"\$\(arg\s+([^\s()]+)\s*\)")


def check(source: Source, rule: Rule) -> Iterator[Finding]:
    for problem in source.find_problems("argument-missing"):
        name = str(problem.data["argument"])
        at = locate_expression(source, problem, f"$(arg {name})")
        declared = [e for e in iter_elements_by_tag(source.trees, "xacro:arg") if e.get("name") == name]
        missing = [name, *(n for n in _find_undeclared_arguments(source) if n != name)]
        from urdfcheck.source.xacro.argument_values import (
            find_argument_choices,
        )  # loaded only if an argument is missing

        known = {choice.name: choice.existing_values for choice in find_argument_choices(source.path, source.finder)}
        options = " ".join(format_argument_option(n, known[n][0] if n in known else None) for n in missing)
        yield rule.finding(
            "too-late" if declared else "missing",
            at=at,
            related=[*declared, *(r for r in (problem.location, *problem.related) if r.span != at.span)],
            argument=name,
            missing=missing,
            options=options,
            remedy=options,
            choices=format_choices(known.get(name, ())),
            default=declared[0].get("default") if declared else "",
            between=[
                e.subject for e in find_unprefixed_tags(source.trees) if e.tag == "include" or e.get("name") == name
            ],
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
    return [n for n in read if n not in declared and n not in source.arguments]
