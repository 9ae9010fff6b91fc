"""PKG011 reports spellings of mesh and texture paths that some programs or systems cannot read."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from urdfcheck.core import Edit, Finding, Rule, Severity
from urdfcheck.core.text import find_nearest_name, join_names
from urdfcheck.source.load import Source
from urdfcheck.source.resources import (
    ResourceUse,
    find_machine_path,
    is_misspelt,
    list_resource_uses,
    normalize_spelling,
)

_SCHEMES = ("package", "model", "file")
# What libcurl fetches, and with it RViz.
_REMOTE = frozenset({"http", "https", "ftp", "ftps"})
_SCHEME = re.compile(r"^([A-Za-z][A-Za-z0-9+.-]+)://")
_ONE_SLASH = re.compile(rf"^(?:{'|'.join(_SCHEMES)}):/?[^/]")


@dataclass(frozen=True, slots=True, eq=False)
class _PathProblem:
    """What is wrong with a path. ``message``: blank | backslash | letters | remote | scheme | slashes; ``part`` what several
    paths of one cause share; ``plain`` how it should be written, None where nobody knows."""

    message: str
    part: str
    suggestion: str | None
    uses: list[ResourceUse] = field(default_factory=list)


def check(source: Source, rule: Rule) -> Iterator[Finding]:
    found: dict[tuple[str, str], _PathProblem] = {}
    for use in list_resource_uses(source):
        spelling = _classify_path_problem(use)
        if spelling is not None and find_machine_path(use, source) is None:
            found.setdefault((spelling.message, spelling.part), spelling).uses.append(use)
    for spelling in found.values():
        yield _build_finding(spelling, source, rule)


def _classify_path_problem(use: ResourceUse) -> _PathProblem | None:
    text = use.resource.text
    scheme = _SCHEME.match(text.strip())
    if use.resource.kind == "other" and scheme is not None:
        name = scheme.group(1)
        if name.lower() in _REMOTE:
            return _PathProblem("remote", name, None)
        near = find_nearest_name(name, _SCHEMES)
        return _PathProblem("scheme", name, None if near is None else near + text.strip()[len(name) :])
    if _ONE_SLASH.match(text.strip()):
        return _PathProblem("slashes", "", normalize_spelling(text))
    if "\\" in text:
        return _PathProblem("backslash", "", normalize_spelling(text))
    if re.search(r"\s", text):
        return _PathProblem(
            "blank", _truncate_at_problem(text, r"\s"), text.strip() if not re.search(r"\s", text.strip()) else None
        )
    if not text.isascii():
        return _PathProblem("letters", _truncate_at_problem(text, r"[^\x00-\x7f]"), None)
    return None


def _truncate_at_problem(text: str, wrong: str) -> str:
    """The path as far as its first part with something wrong in it: below one such folder all paths have one cause."""
    match = re.search(rf"^.*?{wrong}[^/]*", text, re.DOTALL)
    return text if match is None else match.group(0)


def _build_finding(spelling: _PathProblem, source: Source, rule: Rule) -> Finding:
    first, *others = spelling.uses
    files = list(dict.fromkeys(use.resource.text for use in spelling.uses))
    lost = [use for use in spelling.uses if is_misspelt(use)]
    there = any(
        source.finder.resolve_resource(normalize_spelling(u.resource.text), source.path.parent).exists for u in lost
    )
    edits = [edit for use in spelling.uses for edit in _propose_edits(use)]
    return rule.finding(
        spelling.message,
        at=first,
        related=[use for use in others if use.attribute.span != first.attribute.span],
        edits={edit.span: edit for edit in edits}.values(),
        severity=Severity.ERROR if lost else None,
        file=files[0],
        files=files,
        part=spelling.part,
        scheme=spelling.part,
        letters="".join(sorted({c for c in spelling.part if not c.isascii()})[:10]),
        plain=spelling.suggestion or "",
        hint=f" (did you mean {spelling.suggestion!r}?)"
        if spelling.suggestion and spelling.message == "scheme"
        else "",
        more=f", and {join_names(files[1:], 2)}" if len(files) > 1 else "",
        lost=": the file is there and is not found under this name" if there else "",
    )


def _propose_edits(use: ResourceUse) -> Iterator[Edit]:
    spelling, attribute = _classify_path_problem(use), use.attribute
    if spelling is not None and spelling.suggestion is not None and attribute.literal and attribute.span is not None:
        yield Edit(attribute.span, attribute.typed, spelling.suggestion)
