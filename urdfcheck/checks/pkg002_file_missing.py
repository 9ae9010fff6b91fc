"""PKG002: every mesh file that a model names exists."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from urdfcheck.core import Finding, Rule
from urdfcheck.core.text import listed, nearest
from urdfcheck.source.load import Source
from urdfcheck.source.package.finder import display_name
from urdfcheck.source.resources import ResourceUse, is_misspelt, machine_part, resource_uses
from urdfcheck.source.text.shape_roles import compiled
from urdfcheck.system.files import walk

# Files beyond this many are not looked through for one of the same name: a suggestion is not worth seconds.
_MOST_FILES = 20_000


@dataclass(slots=True, eq=False)
class _Gap:
    """What is missing for one cause: one file, or all files below a folder that does not exist."""

    folder: Path | None
    files: dict[Path, str] = field(default_factory=dict)
    uses: list[ResourceUse] = field(default_factory=list)


def check(source: Source, rule: Rule) -> Iterator[Finding]:
    meshes = [use for use in resource_uses(source) if use.attribute.owner.tag == "mesh" and _is_missing(use, source)]
    there = [use for use in meshes if _exists(use)]
    for path, uses in _by_path(there).items():
        what = "a folder" if path.is_dir() else "no regular file (a pipe, a socket or a device)"
        told = compiled(use.attribute.owner for use in uses)
        yield rule.finding("kind", at=uses[0], related=uses[1:], consequences=told, path=display_name(path), what=what)
    missing = [use for use in meshes if use not in there]
    if not missing:
        return
    index = _index({_root(use, source) for use in missing})
    for gap in _gaps(missing):
        yield _finding(gap, index, source, rule)


def _is_missing(use: ResourceUse, source: Source) -> bool:
    resource = use.resource
    if resource.path is None or resource.exists or resource.actual is not None or not resource.allowed:
        return False
    return machine_part(use, source) is None and not is_misspelt(use)


def _exists(use: ResourceUse) -> bool:
    return use.resource.path is not None and use.resource.path.exists()


def _by_path(uses: list[ResourceUse]) -> dict[Path, list[ResourceUse]]:
    found: dict[Path, list[ResourceUse]] = {}
    for use in uses:
        found.setdefault(_path(use), []).append(use)
    return found


def _path(use: ResourceUse) -> Path:
    """Two spellings of one file are one cause."""
    assert use.resource.path is not None
    return Path(os.path.normpath(use.resource.path))


def _gaps(missing: list[ResourceUse]) -> list[_Gap]:
    """One gap for each missing folder or file; files that one text names through a macro belong together."""
    by_cause: dict[Path, _Gap] = {}
    by_span: dict[object, _Gap] = {}
    gaps: list[_Gap] = []
    for use in missing:
        path = _path(use)
        folder = _missing_folder(path)
        cause, span = folder or path, use.attribute.span
        gap = by_cause.get(cause) or (by_span.get(span) if span is not None else None)
        if gap is None:
            gap = _Gap(folder)
            gaps.append(gap)
        by_cause[cause] = by_span[span] = gap
        gap.files.setdefault(path, use.resource.text)
        gap.uses.append(use)
    return gaps


def _missing_folder(path: Path) -> Path | None:
    """The outermost folder of a path that does not exist."""
    return next((folder for folder in reversed(path.parents) if not folder.is_dir()), None)


def _finding(gap: _Gap, index: dict[str, list[Path]], source: Source, rule: Rule) -> Finding:
    first = gap.uses[0]
    path = first.resource.path
    assert path is not None
    related = {u.attribute.span: u for u in gap.uses if u.attribute.span != first.attribute.span}
    near = _near(path, index)
    data = {
        "files": list(gap.files.values()),
        "amount": "1 mesh file" if len(gap.files) == 1 else f"{len(gap.files)} mesh files",
        "path": display_name(path),
        "name": path.name,
        "listed": listed([p.name for p in gap.files], 4),
        "links": list(dict.fromkeys(_link(u) for u in gap.uses)),
        "near": [display_name(p) for p in near],
        "hint": f" (did you mean {listed([display_name(p) for p in near], 2)}?)" if near else "",
        "folder": display_name(gap.folder or path.parent),
    }
    message = "folder" if gap.folder is not None else "file" if len(gap.files) == 1 else "several"
    return rule.finding(
        message,
        at=first,
        related=list(related.values()),
        consequences=compiled(use.attribute.owner for use in gap.uses),
        **data,  # type: ignore[arg-type]
    )


def _near(path: Path, index: dict[str, list[Path]]) -> list[Path]:
    """A file of the same name elsewhere in the package, else one of a similar name beside the missing one."""
    same = [p for p in index.get(path.name.lower(), []) if p != path]
    if same:
        return same[:2]
    try:
        beside = os.listdir(path.parent)
    except OSError:
        return []
    close = nearest(path.name, beside)
    return [path.parent / close] if close else []


def _link(use: ResourceUse) -> str:
    element = use.attribute.owner
    while element.parent is not None and element.tag != "link":
        element = element.parent
    return element.get("name")


def _root(use: ResourceUse, source: Source) -> Path:
    """Where files of the same name are looked for: the package that the path names, or the model's own."""
    package = use.resource.package
    folder = source.finder.find(package) if package else None
    if folder is not None:
        return folder
    return source.path.parent if source.package is None else source.package.path


def _index(roots: Iterable[Path]) -> dict[str, list[Path]]:
    found: dict[str, list[Path]] = {}
    count = 0
    for root in sorted(roots):
        for folder, folders, files in walk(root):
            folders[:] = [f for f in folders if not f.startswith(".")]
            count += len(files)
            if count > _MOST_FILES:
                return found
            for name in files:
                found.setdefault(name.lower(), []).append(Path(folder, name))
    return found
