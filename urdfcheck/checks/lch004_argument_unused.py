"""LCH004 reports launch arguments that are never read, or that are read but have no value."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from urdfcheck.core import Finding, Rule
from urdfcheck.core.text import join_names
from urdfcheck.model.launch_context import LaunchContext
from urdfcheck.source.launch.around.passing_files import find_passing_files
from urdfcheck.source.launch.launch_file import Launch, is_included_by_sibling
from urdfcheck.source.package.finder import format_path
from urdfcheck.source.text.tokens import build_removal_edits
from urdfcheck.source.text.xml import Element

_READ = re.compile(r"\$\((?:arg|var)\s+([^\s)]+)")
_EVAL = re.compile(r"\$\(eval\s")
_NAME = re.compile(r"\w+")


def check(context: LaunchContext, rule: Rule) -> Iterator[Finding]:
    launch = context.launch
    if launch.root is None:
        return
    read = _collect_read_names(launch.root)
    passes_all = _has_pass_all_include(launch)
    verb = "var" if launch.dialect == "ros2" else "arg"
    included: bool | None = None
    for argument in launch.arguments:
        name = argument.get("name")
        if not name:
            continue
        if name not in read:
            if not passes_all:
                passing = find_passing_files(launch, name) if launch.dialect == "ros1" else []
                yield rule.finding(
                    "unused",
                    at=argument,
                    edits=() if passing else build_removal_edits(argument, launch.files),
                    argument=name,
                    repair=_describe_repair(name, verb, passing),
                )
        elif not any(key in argument.attributes for key in ("default", "value", "doc", "description")):
            included = is_included_by_sibling(launch.path) if included is None else included
            if not included and not _has_comment(argument, launch):
                yield rule.finding("required", at=argument, argument=name)


def _describe_repair(name: str, verb: str, passing: Sequence[Path]) -> str:
    """Say to delete the declaration, where other launch files pass the argument (``passing``) with the lines that do."""
    use = f"use `$({verb} {name})` where the value is meant"
    if not passing:
        return f"delete the line, or {use}"
    places = join_names(map(format_path, passing), 2)
    return f"{use}; or delete the line and those that pass {name} to it ({places}): roslaunch refuses one that is not declared"


def _has_comment(argument: Element, launch: Launch) -> bool:
    """Whether a comment is directly before an argument: it says what to pass, as in MoveIt's files."""
    file = None if argument.span is None else launch.files.get(argument.span.file)
    if argument.span is None or file is None:
        return False
    _, comment, gap = file.text[: argument.span.start].rpartition("-->")
    return bool(comment) and not gap.strip() and gap.count("\n") <= 1


def _collect_read_names(root: Element) -> set[str]:
    """Return the names in `$(arg x)` and `$(var x)`, and every word of a text with `$(eval …)`, which has several syntaxes."""
    texts = [text for e in root.walk() for text in (e.text, *(a.value for a in e.attributes.values()))]
    read = {name for text in texts for name in _READ.findall(text)}
    return read.union(*(_NAME.findall(text) for text in texts if _EVAL.search(text)))


def _has_pass_all_include(launch: Launch) -> bool:
    """Whether an include gets all arguments: in ROS 2 each does, in ROS 1 on request."""
    includes = [] if launch.root is None else [e for e in launch.root.walk() if e.tag == "include"]
    return any(launch.dialect == "ros2" or e.get("pass_all_args") in {"true", "1"} for e in includes)
