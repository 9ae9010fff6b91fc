"""PKG011: paths of meshes and textures are spelled so that every program and system reads them alike."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from urdfcheck.core import Edit, Finding, Rule, Severity
from urdfcheck.core.text import listed, nearest
from urdfcheck.source.load import Source
from urdfcheck.source.resources import ResourceUse, is_misspelt, machine_part, plain_spelling, resource_uses

_SCHEMES = ("package", "model", "file")
# What libcurl fetches, and with it RViz.
_REMOTE = frozenset({"http", "https", "ftp", "ftps"})
_SCHEME = re.compile(r"^([A-Za-z][A-Za-z0-9+.-]+)://")
_ONE_SLASH = re.compile(rf"^(?:{'|'.join(_SCHEMES)}):/?[^/]")


@dataclass(frozen=True, slots=True, eq=False)
class _Spelling:
    """What is wrong with a path. ``message``: blank | backslash | letters | remote | scheme | slashes; ``part`` what several
    paths of one cause share; ``plain`` how it should be written, None where nobody knows."""

    message: str
    part: str
    plain: str | None
    uses: list[ResourceUse] = field(default_factory=list)


def check(source: Source, rule: Rule) -> Iterator[Finding]:
    found: dict[tuple[str, str], _Spelling] = {}
    for use in resource_uses(source):
        spelling = _spelling(use)
        if spelling is not None and machine_part(use, source) is None:
            found.setdefault((spelling.message, spelling.part), spelling).uses.append(use)
    for spelling in found.values():
        yield _finding(spelling, source, rule)


def _spelling(use: ResourceUse) -> _Spelling | None:
    text = use.resource.text
    scheme = _SCHEME.match(text.strip())
    if use.resource.kind == "other" and scheme is not None:
        name = scheme.group(1)
        if name.lower() in _REMOTE:
            return _Spelling("remote", name, None)
        near = nearest(name, _SCHEMES)
        return _Spelling("scheme", name, None if near is None else near + text.strip()[len(name) :])
    if _ONE_SLASH.match(text.strip()):
        return _Spelling("slashes", "", plain_spelling(text))
    if "\\" in text:
        return _Spelling("backslash", "", plain_spelling(text))
    if re.search(r"\s", text):
        return _Spelling("blank", _up_to(text, r"\s"), text.strip() if not re.search(r"\s", text.strip()) else None)
    if not text.isascii():
        return _Spelling("letters", _up_to(text, r"[^\x00-\x7f]"), None)
    return None


def _up_to(text: str, wrong: str) -> str:
    """The path as far as its first part with something wrong in it: below one such folder all paths have one cause."""
    match = re.search(rf"^.*?{wrong}[^/]*", text, re.DOTALL)
    return text if match is None else match.group(0)


def _finding(spelling: _Spelling, source: Source, rule: Rule) -> Finding:
    first, *others = spelling.uses
    files = list(dict.fromkeys(use.resource.text for use in spelling.uses))
    lost = [use for use in spelling.uses if is_misspelt(use)]
    there = any(source.finder.resolve(plain_spelling(u.resource.text), source.path.parent).exists for u in lost)
    edits = [edit for use in spelling.uses for edit in _edits(use)]
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
        plain=spelling.plain or "",
        hint=f" (did you mean {spelling.plain!r}?)" if spelling.plain and spelling.message == "scheme" else "",
        more=f", and {listed(files[1:], 2)}" if len(files) > 1 else "",
        lost=": the file is there and is not found under this name" if there else "",
    )


def _edits(use: ResourceUse) -> Iterator[Edit]:
    spelling, attribute = _spelling(use), use.attribute
    if spelling is not None and spelling.plain is not None and attribute.literal and attribute.span is not None:
        yield Edit(attribute.span, attribute.typed, spelling.plain)
