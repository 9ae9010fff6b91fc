"""XML001: text that is not XML, or XML that must not be read."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.model.launch_context import LaunchContext
from urdfcheck.source.load import Source
from urdfcheck.source.package.finder import Package
from urdfcheck.source.ros.srdf import find_broken_srdfs
from urdfcheck.source.text.problems import Problem
from urdfcheck.source.text.xml import SourceFile, find_unbound_prefix

_KINDS = ("malformed", "encoding", "utf-16", "instruction", "doctype", "prefix", "unreadable")
# How a file that was never XML begins, and what that tells.
_CAUSES = (("version https://git-lfs", "git_lfs"), ("<!doctype html", "web_page"), ("<html", "web_page"))
# What we refuse and ROS may read.
_OUR_CHOICE = "doctype"


def check(subject: Source | LaunchContext | Package, rule: Rule) -> Iterator[Finding]:
    if isinstance(subject, Source):
        yield from _check_model(subject, rule)
    elif isinstance(subject, LaunchContext):
        yield from _check_companion_file(subject.launch.problems, subject.launch.files, "launch", rule)
    else:
        files = {} if subject.file is None else {subject.file.name: subject.file}
        yield from _check_companion_file(subject.problems, files, "manifest", rule)
        for problem, file in find_broken_srdfs(subject.path):
            yield from _check_companion_file([problem], {} if file is None else {file.name: file}, "srdf", rule)


def _check_model(source: Source, rule: Rule) -> Iterator[Finding]:
    for problem in source.find_problems(*_KINDS):
        location = replace(problem.location, subject=problem.location.subject or "robot")
        file = _find_source_file(problem, source.files)
        if problem.kind == "prefix" and not source.is_xacro:
            if not _is_xacro_prefix(source):
                yield rule.finding("prefix", at=location, severity=Severity.WARNING, error=problem.message)
        else:
            cause = _classify_cause(problem, file)
            message = "other" if cause in {"git_lfs", "web_page"} else _choose_message(problem, file)
            yield rule.finding(message, at=location, cause=cause, error=problem.message)


def _check_companion_file(
    problems: Sequence[Problem], files: Mapping[str, SourceFile], message: str, rule: Rule
) -> Iterator[Finding]:
    """A launch file or a package.xml that could not be read."""
    for problem in problems:
        if problem.kind not in _KINDS:
            continue
        at, cause = problem.location, _classify_cause(problem, _find_source_file(problem, files))
        if problem.kind == _OUR_CHOICE and cause is None:
            yield rule.finding("unread", at=at, severity=Severity.WARNING, error=problem.message)
        else:
            yield rule.finding(message, at=at, cause=cause, error=problem.message)


def _find_source_file(problem: Problem, files: Mapping[str, SourceFile]) -> SourceFile | None:
    span = problem.location.span
    return None if span is None else files.get(span.file)


def _choose_message(problem: Problem, file: SourceFile | None) -> str:
    if problem.kind != "malformed" or file is None:
        return problem.kind
    return "empty" if not file.text.strip() else "binary" if "\0" in file.text else "malformed"


def _is_xacro_prefix(source: Source) -> bool:
    """A plain URDF with xacro's own prefix was meant to be expanded: XML009 says so."""
    found = find_unbound_prefix(source.main_tree) if source.main_tree is not None else None
    return found is not None and found[1] == "xacro"


def _classify_cause(problem: Problem, file: SourceFile | None) -> str | None:
    if file is None:
        return None
    text = file.text.lstrip("\ufeff \t\r\n")
    for beginning, cause in _CAUSES:
        if text[:80].lower().startswith(beginning):
            return cause
    if "\n<<<<<<< " in "\n" + file.text:
        return "merge_conflict"
    if problem.kind == "malformed" and "declaration not at start" in problem.message:
        return "before_declaration"
    return None
