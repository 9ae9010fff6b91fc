"""XML001: text that is not XML, or XML that must not be read."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.source.load import Source
from urdfcheck.source.problems import Problem
from urdfcheck.source.xml import unbound_prefix

_KINDS = ("malformed", "encoding", "doctype", "depth", "prefix", "unreadable")
# How a file that was never XML begins, and what that tells.
_CAUSES = (("version https://git-lfs", "git_lfs"), ("<!doctype html", "web_page"), ("<html", "web_page"))


def check(source: Source, rule: Rule) -> Iterator[Finding]:
    for problem in source.problems_of(*_KINDS):
        location = replace(problem.location, subject=problem.location.subject or "robot")
        if problem.kind != "prefix" or source.is_xacro:
            yield rule.finding(problem.kind, at=location, cause=_cause(source, problem), error=problem.message)
        elif not _is_xacro_prefix(source):
            yield rule.finding("prefix", at=location, severity=Severity.WARNING, error=problem.message)


def _is_xacro_prefix(source: Source) -> bool:
    """A plain URDF with xacro's own prefix was meant to be expanded: XML009 says so."""
    found = unbound_prefix(source.main) if source.main is not None else None
    return found is not None and found[1] == "xacro"


def _cause(source: Source, problem: Problem) -> str | None:
    span = problem.location.span
    file = source.files.get(span.file) if span is not None else None
    if file is None or span is None:
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
